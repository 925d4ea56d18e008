"""A proof of optimality, checked in ball arithmetic: every box that a search has left out, without its code.

The search's tree comes as data. That nothing is missing from it is a comparison of numbers (`optimality_tree`). That no
leg of a dead box keeps the rules, and that two legs of boxes which were left out reach the claimed value, is shown
again here (`optimality_legs`), by other formulas and another arithmetic. Where balls are too wide, a box is cut: if all
its parts are dead, it is (theory §8.4).
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Literal, NamedTuple

import numpy as np
import numpy.typing as npt
from flint import arb

from zerorev.errors import InputError
from zerorev.model.hole import Hole
from zerorev.model.proof_tree import ProofCheck, ProofTree
from zerorev.model.robot import Robot
from zerorev.model.tool import Tool
from zerorev.verify.certificate.piece import ball_arithmetic
from zerorev.verify.optimality.box import Box, Examiner
from zerorev.verify.optimality.legs import MID_SHARES, BoxLegs
from zerorev.verify.optimality.pairs import Weights, least_value, weights_of
from zerorev.verify.optimality.tree import Node, fits, holes_in, most_reversals, node_of

__all__ = ["check_tree"]

Indices = npt.NDArray[np.int64]

MOST_PARTS = 4000  # that a box, or a pair of boxes, is cut into
NARROWEST = 1e-9  # [rad] of spin and of twist, below which a box is not cut
FINE, FINEST = 0.05, 0.003  # [rad] of spin, below which more stand-offs are examined
DENSE = tuple(k / 32 for k in range(1, 32, 2))
MOST_LISTED = 10  # failures


def check_tree(
    robot: Robot, tool: Tool, hole: Hole, tree: ProofTree, *, sample: int | None = None, seed: int = 0
) -> ProofCheck:
    """Check a proof in ball arithmetic.

    Args:
        robot: the arm.
        tool: the drill.
        hole: the drill axis, down to the target of the legs; its depth does not count, the tree's own does.
        tree: what is to be checked; its claim is for the reader to compare with what he wants proven.
        sample: check so many of the boxes, at random; None: all. That nothing is missing is checked of all.
        seed: of the sample.

    Raises:
        InputError: the arrays of the tree do not fit each other.
    """
    if not fits(tree):
        raise InputError("the arrays of the tree do not fit each other", accepted="a tree as it was logged")
    with ball_arithmetic():
        return _Check(robot, tool, hole, tree).run(sample, seed)


class _Doubt(NamedTuple):
    """Something that is not as the tree says."""

    certain: bool
    what: str


class _Task(NamedTuple):
    """A box to be checked: of which node, which of its dead or closed ones."""

    node: int
    dead: bool
    row: int


@dataclass
class _Check:
    robot: Robot
    tool: Tool
    hole: Hole
    tree: ProofTree
    pairs: int = 0
    parts: int = 0
    reasons: Counter[str] = field(default_factory=Counter)

    def __post_init__(self) -> None:
        tree = self.tree
        self.of = {
            posture: Examiner(self.robot, self.tool, self.hole, tree.claim, posture)
            for posture in {int(one) for one in tree.postures}
        }
        count = len(tree.spins)
        self.children: list[list[int]] = [[] for _ in range(count)]
        for number, parent in enumerate(tree.parents):
            if parent >= 0:
                self.children[parent].append(number)
        order = np.argsort(tree.closed_of, kind="stable")
        ends = np.searchsorted(tree.closed_of[order], np.arange(count + 1))
        self.rows: list[Indices] = [order[a:b] for a, b in pairwise(ends.tolist())]
        self.value = arb(tree.claim.value)
        self.legs: dict[Box, BoxLegs] = {}

    def run(self, sample: int | None, seed: int) -> ProofCheck:
        """The structure, then the boxes."""
        failures = [_Doubt(True, hole) for hole in holes_in(self.tree, self.children, self.rows)]
        reach = most_reversals(self.tree, self.robot)
        if reach < 0:
            failures.append(_Doubt(True, "the slopes of the roots end before those that the joints' ranges allow"))
        nodes = [node_of(self.tree, n, self.children[n], self.rows[n]) for n in range(len(self.tree.spins))]
        tasks = [
            _Task(n, dead, row)
            for n, node in enumerate(nodes)
            for dead, boxes in ((True, node.dead), (False, node.closed))
            for row in range(len(boxes))
        ]
        chosen: Iterable[_Task] = tasks
        if sample is not None and sample < len(tasks):
            rng = np.random.default_rng(seed)
            chosen = [tasks[k] for k in sorted(rng.choice(len(tasks), sample, replace=False).tolist())]
        boxes, undecided, last = 0, 0, -1
        for task in chosen:
            if task.node != last:
                self.legs.clear()
                last = task.node
            boxes += 1
            doubt = self.dead(task, nodes[task.node]) if task.dead else self.closed(task, nodes[task.node])
            if doubt is not None:
                failures.append(doubt)
                undecided += not doubt.certain
        verdict: Literal["confirmed", "refuted", "undecided"] = "confirmed"
        if failures:
            verdict = "refuted" if any(doubt.certain for doubt in failures) else "undecided"
        listed = tuple(doubt.what for doubt in sorted(failures, key=lambda doubt: not doubt.certain)[:MOST_LISTED])
        counts = boxes, len(tasks), self.pairs, self.parts, undecided
        return ProofCheck(verdict, *counts, dict(self.reasons), reach, listed)

    def dead(self, task: _Task, node: Node) -> _Doubt | None:
        """Whether no leg of a dead box keeps the rules; None where that is so."""
        low, high = self.tree.spins[task.node].tolist()
        whole = Box(low, high, *node.dead[task.row].tolist())
        rest, parts = [whole], 0
        while rest:
            box = rest.pop()
            parts += 1
            legs = self.legs_of(task.node, box)
            while legs.sample_closer():
                pass
            if legs.dead is not None:
                if box is whole:
                    self.reasons[legs.dead] += 1
                continue
            halves = self.cut(box)
            if halves is None or _now_and_then(parts):
                point = self.middle(task.node, box)
                if point.dead is None:
                    return _Doubt(True, f"{_place(point.box)} is said to be impossible, and was not found to be")
            if halves is None or parts > MOST_PARTS:
                return _Doubt(False, f"whether {_place(box)} is impossible could not be decided")
            rest += halves
        if parts > 1:
            self.reasons["parts"] += 1
        return None

    def closed(self, task: _Task, node: Node) -> _Doubt | None:
        """Whether two legs, one of a box that was left out, reach the value; None where that is so."""
        low, high = self.tree.spins[task.node].tolist()
        one = Box(low, high, *node.closed[task.row].tolist())
        # a pair of two that were left out is checked with the first of them
        others = [*node.closed[task.row :].tolist(), *node.passed.tolist()]
        self.reasons["pairs"] += 1
        for other in others:
            self.pairs += 1
            if doubt := self.pair(task.node, one, Box(low, high, *other)):
                return doubt
        return None

    def pair(self, number: int, box: Box, with_box: Box) -> _Doubt | None:
        """Whether any two legs of two boxes reach the value; None where that is so."""
        rest, parts = [(box, with_box)], 0
        weights = weights_of(self.tree.terms[number], bool(self.tree.of_travel[number]))
        while rest:
            p, r = rest.pop()
            parts += 1
            if self.reached(self.kept(number, p), self.kept(number, r), weights):
                continue
            wide = max((p.high - p.low), (p.most - p.least) * self.depth, (r.most - r.least) * self.depth)
            if wide < NARROWEST or _now_and_then(parts):
                one, other = self.middle(number, p), self.middle(number, r)
                if self.below(one, other):
                    return _Doubt(True, f"{_place(one.box)} and {_place(other.box)} have less than the value")
            if wide < NARROWEST or parts > MOST_PARTS:
                return _Doubt(False, f"whether {_place(p)} and {_place(r)} reach the value could not be decided")
            if p.high - p.low >= wide:
                middle = 0.5 * (p.low + p.high)
                for half in ({"high": middle}, {"low": middle}):
                    rest.append((p._replace(**half), r._replace(**half)))
            elif (p.most - p.least) * self.depth >= wide:
                rest += [(half, r) for half in _halves(p)]
            else:
                rest += [(p, half) for half in _halves(r)]
        return None

    @property
    def depth(self) -> float:
        """Of the legs [m]."""
        return self.tree.claim.depth

    def legs_of(self, number: int, box: Box) -> BoxLegs:
        """The legs of a box on a node."""
        self.parts += 1
        wide, more = box.high - box.low, self.tree.cuts[number].tolist()
        more += [*(MID_SHARES if wide < FINE else ()), *(DENSE if wide < FINEST else ())]
        return BoxLegs(self.of[int(self.tree.postures[number])], box, more)

    def kept(self, number: int, box: Box) -> BoxLegs:
        """The same, kept for the pairs of a node."""
        found = self.legs.get(box)
        if found is None:
            found = self.legs[box] = self.legs_of(number, box)
        return found

    def middle(self, number: int, box: Box) -> BoxLegs:
        """The leg in the middle of a box, examined densely."""
        psi, slope = 0.5 * (box.low + box.high), 0.5 * (box.least + box.most)
        more = [*self.tree.cuts[number].tolist(), *MID_SHARES, *DENSE]
        legs = BoxLegs(self.of[int(self.tree.postures[number])], Box(psi, psi, slope, slope), more)
        while legs.sample_closer():
            pass
        return legs

    def reached(self, one: BoxLegs, other: BoxLegs, weights: Weights) -> bool:
        """Whether any two legs of two boxes surely reach the value; the boxes are examined as far as that takes."""
        while True:
            value = least_value(one, other, weights)
            if value is None or value >= self.value:
                return True
            if not (one.sample_closer() | other.sample_closer()):
                return False

    def below(self, one: BoxLegs, other: BoxLegs) -> bool:
        """Whether the least value of two legs is surely below the one that is claimed."""
        value = least_value(one, other, Weights())
        return value is not None and bool(value < self.value)

    def cut(self, box: Box) -> list[Box] | None:
        """Halves of a box; None where it is too narrow."""
        spin, twist = box.high - box.low, (box.most - box.least) * self.depth
        if max(spin, twist) < NARROWEST:
            return None
        if twist >= spin:
            return _halves(box)
        middle = 0.5 * (box.low + box.high)
        return [box._replace(high=middle), box._replace(low=middle)]


def _now_and_then(parts: int) -> bool:
    """Whether so many parts are a power of two: when to look for a leg that the tree says does not exist."""
    return parts & (parts - 1) == 0


def _halves(box: Box) -> list[Box]:
    middle = 0.5 * (box.least + box.most)
    return [box._replace(most=middle), box._replace(least=middle)]


def _place(box: Box) -> str:
    """Where the legs of a box are, in words."""
    psi, slope = np.rad2deg([box.low, box.high]), np.rad2deg([box.least, box.most]) / 1e3
    if box.low == box.high:
        return f"the leg from {psi[0]:.6f} deg at {slope[0]:.6g} deg/mm"
    return f"the box of {psi[0]:.6f} to {psi[1]:.6f} deg and {slope[0]:.6g} to {slope[1]:.6g} deg/mm"
