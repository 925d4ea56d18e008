"""The state of a branch and bound, and the rules that it keeps (theory §3)."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from zerorev.kernels import bound_boxes, bound_multipliers, bound_nodes, bound_tree, intervals
from zerorev.kernels.layout import BoundRules, TwistPlane
from zerorev.model._arrays import Array
from zerorev.model.robot import ArmGeometry
from zerorev.motion.drilling import Drilling
from zerorev.search.bounds.rates import Formulas, formulas

__all__ = ["Search", "model_limits"]

SPINS, SLOPES = 32, 8  # intervals to begin with, of spins and of slopes within a turn either way
FAR = 1.4 * np.pi  # [rad] of twist, of intervals beyond a turn: with the spins of a node less than a turn in all
FIRST_ROOM = 4096
LEAST_ASPECT = 0.01  # of boxes: their width in twist over that in spin


class Tree(NamedTuple):
    """Nodes and the heap of those to be examined; a NamedTuple, so that kernels take it whole.

    Attributes:
        heap: numbers of nodes, shape (N,).
        nodes: interval of spins, value, whether the terms are added to the travel (1) or refute (0), shape (N, 4).
        terms: conditions with multipliers, see `kernels.bound_multipliers`, shape (N, MOST_TERMS, TERM).
        shares: where a box is sampled first, as shares of the depth, shape (N, SAMPLES).
        lists: posture, where its slopes start and how many they are, how many cuts, parent or -1, shape (N, 5).
        cuts: more stand-offs to be examined, as shares of the depth, shape (N, MOST_CUTS).
        slopes: intervals, shape (S, 2).
        closed: log of the boxes that are left out: node, interval of slopes, whether no leg of it may exist (1) or no
            pair with it is of interest (0), shape (C, 4); C = 0: none is kept.
        counts: see `kernels.bound_nodes`, shape (9,).
        values: likewise, shape (4,).
        candidate: spin at the target, two slopes, posture, shape (4,).
    """

    heap: npt.NDArray[np.int64]
    nodes: Array
    terms: Array
    shares: Array
    lists: npt.NDArray[np.int64]
    cuts: Array
    slopes: Array
    closed: Array
    counts: npt.NDArray[np.int64]
    values: Array
    candidate: Array


def model_limits(drilling: Drilling) -> tuple[Array, Array]:
    """What the model angles may do [rad], each of shape (6,)."""
    arm, limits = drilling.robot.arm, drilling.limits
    ends = np.stack([limits.lower, limits.upper]) * np.array(arm.sign) - np.array(arm.offset)
    return ends.min(axis=0), ends.max(axis=0)


class Search:
    """One branch and bound; `advance` resumes it.

    Args:
        arm: of the robot.
        plane: of the hole.
        rules: what legs are held to.
        postures: which of the four count.
        twist: greatest twist of a leg [rad].
        gap: what a motion may travel more than the least, relative, and still be proven.
        logged: whether the boxes that are left out are kept, for `search.bounds.log`.
    """

    def __init__(
        self, arm: ArmGeometry, plane: TwistPlane, rules: BoundRules, postures: list[int], twist: float, gap: float,
        *, logged: bool = False,
    ) -> None:  # fmt: skip
        self.rules = rules
        self.models: tuple[Formulas, ...] = tuple(
            formulas(arm, plane, posture, threshold=rules.min_rate > 0) for posture in range(4)
        )
        self.tree = _planted(rules, postures, twist, bound_tree.MOST_CLOSED if logged else 0)
        self.tree.values[bound_nodes.GAP] = gap
        self._work = _room()

    @property
    def passes(self) -> int:
        """Passes so far, each at `rules.samples` stand-offs of one box."""
        return int(self.tree.counts[bound_nodes.PASSES_DONE])

    @property
    def bound(self) -> float:
        """What no motion is better than: reversals x BIG + travel."""
        tree = self.tree
        top = tree.nodes[tree.heap[0], bound_nodes.NODE_VALUE] if tree.counts[bound_nodes.HEAP] else bound_nodes.NOTHING
        return float(min(top, tree.values[bound_nodes.LEFT], bound_nodes.threshold(self.rules, tree)))

    def improve(self, cost: float, travel: float) -> None:
        """Take note of a motion that is better than the best so far."""
        # twists are of the size of the travel, in rad; spins of that of 1
        aspect = min(1.0, max(travel, LEAST_ASPECT)) if travel > 0.0 else self.rules.aspect
        self.rules = self.rules._replace(most_cost=min(cost, self.rules.most_cost), aspect=aspect)
        self.tree.values[bound_nodes.BEST] = bound_nodes.BIG * cost + travel

    def cut(self, shares: Array) -> None:
        """Have more stand-offs examined in the two nodes that the last candidate came from."""
        tree = self.tree
        for node in tree.counts[bound_nodes.LAST_LEFT : bound_nodes.LAST_RIGHT + 1]:
            count = int(tree.lists[node, bound_nodes.CUTS])
            fresh = shares[: bound_tree.MOST_CUTS - count]
            tree.cuts[node, count : count + fresh.size] = fresh
            tree.lists[node, bound_nodes.CUTS] = count + fresh.size

    def advance(self, most_passes: int) -> int:
        """Continue until there is something to report: see `kernels.bound_tree.advance`."""
        while True:
            reason = int(bound_tree.advance(self.models, self.rules, self.tree, most_passes, self._work))
            if reason != bound_tree.FULL:
                return reason
            self.tree = _grown(self.tree)


def _planted(rules: BoundRules, postures: list[int], twist: float, log: int) -> Tree:
    """All spins and slopes, in a few coarse nodes."""
    bound = rules.psi_bound or np.pi
    spins = np.linspace(-bound, bound, max(2, int(np.ceil(SPINS * bound / np.pi))) + 1)
    slopes = _slopes(twist) / rules.depth
    count = slopes.size - 1
    first = len(postures) * (spins.size - 1)
    room = max(FIRST_ROOM, 2 * first)
    tree = Tree(
        heap=np.zeros(room, dtype=np.int64),
        nodes=np.zeros((room, bound_nodes.NODE)),
        terms=np.zeros((room, bound_multipliers.MOST_TERMS, bound_multipliers.TERM)),
        shares=np.zeros((room, bound_boxes.SAMPLES)),
        lists=np.zeros((room, bound_nodes.LISTED), dtype=np.int64),
        cuts=np.zeros((room, bound_tree.MOST_CUTS)),
        slopes=np.zeros((max(4 * FIRST_ROOM, 2 * count), 2)),
        closed=np.zeros((log, bound_nodes.CLOSED)),
        counts=np.zeros(bound_nodes.COUNTS, dtype=np.int64),
        values=np.array([bound_nodes.NOTHING, bound_nodes.NOTHING, bound_nodes.NOTHING, 0.0]),
        candidate=np.zeros(4),
    )
    tree.slopes[:count, 0], tree.slopes[:count, 1] = slopes[:-1], slopes[1:]
    tree.counts[bound_nodes.SLOPES] = count
    samples = rules.samples
    tree.shares[:first, :samples] = [bound_boxes.share(samples, 0, sample) for sample in range(samples)]
    numbers = np.arange(first)
    tree.heap[:first] = numbers
    tree.nodes[:first, :2] = np.tile(np.stack([spins[:-1], spins[1:]], axis=1), (len(postures), 1))
    tree.lists[:first, bound_nodes.POSTURE] = np.repeat(postures, spins.size - 1)
    tree.lists[:first, bound_nodes.COUNT] = count
    tree.lists[:first, bound_nodes.PARENT] = -1
    tree.counts[bound_nodes.HEAP] = tree.counts[bound_nodes.NODES] = first
    return tree


def _slopes(twist: float) -> Array:
    """Ends of the first intervals of twist [rad]: finer within a turn, where nearly all legs of interest lie."""
    within = min(twist, 2 * np.pi)
    inner = np.linspace(0, within, SLOPES // 2 + 1)
    outer = np.linspace(within, twist, int(np.ceil((twist - within) / FAR)) + 1)[1:]
    half = np.append(inner, outer)
    return np.concatenate([-half[:0:-1], half])


def _grown(tree: Tree) -> Tree:
    """The same with twice the room."""

    def doubled(array: Any) -> Any:
        return np.concatenate([array, np.zeros_like(array)])

    return tree._replace(
        heap=doubled(tree.heap), nodes=doubled(tree.nodes), terms=doubled(tree.terms), shares=doubled(tree.shares),
        lists=doubled(tree.lists), cuts=doubled(tree.cuts),
        slopes=doubled(tree.slopes), closed=doubled(tree.closed),
    )  # fmt: skip


def _room() -> tuple[Any, ...]:
    """What the loop works in."""
    most = bound_tree.MOST_LEGS
    return (
        np.zeros((most, bound_boxes.COLUMNS)),
        np.zeros((most, bound_boxes.KNOWN, 6), dtype=np.int64),
        np.zeros((most, bound_boxes.COLUMNS)),
        np.zeros((most, bound_boxes.KNOWN, 6), dtype=np.int64),
        (np.zeros(most, dtype=np.bool_), np.zeros(intervals.LANES), np.zeros(intervals.LANES)),
        (
            np.zeros(most, dtype=np.int64),
            np.zeros(most, dtype=np.int64),
            np.zeros((most, most)),
            np.zeros((most, most), dtype=np.bool_),
        ),
    )
