"""A walk along the motion, piece by piece, that halves a piece wherever its bounds decide too little.

Rates are those of the motion itself, d theta / d path in the order in which it is run: a joint does not reverse if all
its rates have one sign.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
from flint import arb

from zerorev.model._arrays import Array
from zerorev.verify.certificate.arm import Setting, body_at
from zerorev.verify.certificate.path import Arc, JointLeg
from zerorev.verify.certificate.piece import NIL_RATE, Piece, bounds, enclose

__all__ = ["LostError", "Slowest", "Stretch", "Walk"]

TURN_A_PIECE = float(np.deg2rad(2.0))  # [rad] of the tool in the first pieces
PATH_A_PIECE = 8e-3  # [m] of path in the first pieces
HALVINGS = 40  # of one piece at most
FINE_HALVINGS = 10  # at most for a tighter bound alone
OUTWARDS = 1 + 1e-9  # more than the rounding of a product can take
TIGHT = 1e-3  # relative: how far below a rate that is met its bound may lie


class LostError(Exception):
    """The walk cannot continue: the arm is out of reach, or that it is not so cannot be shown.

    Attributes:
        reason: one sentence.
        proven: whether the arm is proven out of reach.
    """

    def __init__(self, reason: str, *, proven: bool) -> None:
        self.reason, self.proven = reason, proven
        super().__init__(reason)


@dataclass
class Slowest:
    """The least |rate| of each joint over some part of the motion [rad/m], shape (6,) each.

    Attributes:
        bound: proven: no rate is less.
        met: a rate that is met, or a little more.
    """

    bound: Array = field(default_factory=lambda: np.full(6, np.inf))
    met: Array = field(default_factory=lambda: np.full(6, np.inf))


class Stretch(NamedTuple):
    """What was found along an arc.

    Attributes:
        end: the six joints at its end [rad].
        low: the joints are nowhere below [rad], shape (6,); inf for one that stays between its angles at the two ends.
        high: the joints are nowhere above [rad], shape (6,); -inf for such a one.
    """

    end: list[arb]
    low: Array
    high: Array


@dataclass
class Walk:
    """What is known so far; joints are counted from 0.

    Attributes:
        setting: arm and posture.
        names: of the joints.
        followed: joints that must keep one direction; one that fails to, or that cannot be decided, leaves.
        budget: how many pieces may be examined.
        pieces: how many were.
        direction: sign of each joint's rate once it is known.
        paused: joints that all but stand still on some piece: the signs that they have there, 0 for none, and where.
        refuted: proven to be wrong, one sentence each.
        undecided: could not be decided, one sentence each.
    """

    setting: Setting
    names: tuple[str, ...]
    followed: set[int]
    budget: int
    pieces: int = 0
    direction: dict[int, int] = field(default_factory=dict)
    paused: dict[int, dict[int, str]] = field(default_factory=dict)
    refuted: list[str] = field(default_factory=list)
    undecided: list[str] = field(default_factory=list)

    def along(self, arc: Arc, start: list[arb], slowest: Slowest) -> Stretch:
        """Walk along one arc.

        Args:
            arc: where.
            start: the six joints at its begin [rad].
            slowest: of the part of the motion that the arc is of; brought up to date.

        Raises:
            LostError: the arc is not proven in reach and free of singularities.
        """
        joints, low, high = start, np.full(6, np.inf), np.full(6, -np.inf)
        rising, falling = np.full(6, True), np.full(6, True)
        for piece in self._pieces(arc, slowest):
            # no farther from where the joint comes than its rates allow
            came = bounds([joints])
            joints = [joint + turned for joint, turned in zip(joints, piece.turned, strict=True)]
            low = np.minimum(low, came[0][0] + OUTWARDS * piece.path * np.minimum(piece.low, 0))
            high = np.maximum(high, came[1][0] + OUTWARDS * piece.path * np.maximum(piece.high, 0))
            rising, falling = rising & (piece.low >= 0), falling & (piece.high <= 0)
        between = rising | falling
        low, high = np.nextafter(low, -np.inf), np.nextafter(high, np.inf)
        low, high = np.where(between, np.inf, low), np.where(between, -np.inf, high)
        return Stretch(joints, low, high)

    def evenly(self, leg: JointLeg, slowest: Slowest) -> None:
        """Walk along a move of all joints, on which each has one direction.

        Args:
            leg: where.
            slowest: of the part of the motion that it is of; brought up to date.
        """
        rates = [(end - begin) / leg.length for begin, end in zip(leg.begin, leg.end, strict=True)]
        below, above = (values[0] for values in bounds([rates]))
        for joint in sorted(self.followed):
            name, sign = self.names[joint], int(below[joint] > 0) - int(above[joint] < 0)
            if below[joint] >= -NIL_RATE and above[joint] <= NIL_RATE:
                self.paused.setdefault(joint, {}).setdefault(sign, leg.place(0.0))
            elif not sign:
                self.undecided.append(f"the direction of {name} could not be decided {leg.place(0.0)}")
                self.followed.discard(joint)
            elif self.direction.setdefault(joint, sign) != sign:
                self.refuted.append(f"{name} turns round: it moves the other way {leg.place(0.0)}")
                self.followed.discard(joint)
        slowest.bound = np.minimum(slowest.bound, np.maximum(np.maximum(below, -above), 0.0))
        slowest.met = np.minimum(slowest.met, np.maximum(np.abs(below), np.abs(above)))

    def settle_pauses(self) -> None:
        """A joint may all but stand still throughout; one that moves elsewhere must keep its direction here too."""
        for joint in sorted(self.followed & self.direction.keys() & self.paused.keys()):
            name, signs = self.names[joint], self.paused[joint]
            if (other := -self.direction[joint]) in signs:
                self.refuted.append(f"{name} turns round: it moves the other way {signs[other]}")
            elif 0 in signs:
                self.undecided.append(f"{name} moves by less than 1e-9 deg/mm, or not at all, {signs[0]}")
            if other in signs or 0 in signs:
                self.followed.discard(joint)

    def _pieces(self, arc: Arc, slowest: Slowest) -> Iterator[Piece]:
        """The pieces of an arc in order, each fine enough."""
        first = 1
        turn, path = arc.turn(), float(arc.length)
        while first * TURN_A_PIECE < turn or first * PATH_A_PIECE < path:
            first *= 2
            if first > self.budget:
                raise LostError(f"too long a way {arc.place(0.0)}", proven=False)
        ahead = [(k / first, (k + 1) / first, 0) for k in reversed(range(first))]
        while ahead:
            begin, end, halvings = ahead.pop()
            if self.pieces >= self.budget:
                raise LostError(f"given up after {self.pieces} pieces {arc.place(begin)}", proven=False)
            self.pieces += 1
            piece = enclose(self.setting, arc, begin, end)
            if piece is None:
                self._must_be_in_reach(arc, (begin + end) / 2)
                if halvings >= HALVINGS:
                    what = "neither in reach and clear of singularities nor out of reach could be shown"
                    raise LostError(f"{what} {arc.place(begin)}", proven=False)
            elif self._is_decided(arc, begin, end, piece, last=halvings >= HALVINGS):
                least = np.maximum(np.maximum(piece.low, -piece.high), 0.0)
                met = np.minimum(*(np.abs(ends).max(axis=0) for ends in (piece.first, piece.last)))
                slowest.met = np.minimum(slowest.met, met)
                loose = least < (1 - TIGHT) * slowest.met
                if halvings >= FINE_HALVINGS or not any(loose[i] and piece.sign(i) for i in self.followed):
                    for joint in range(6):
                        if piece.all_but_still(joint):
                            self.paused.setdefault(joint, {}).setdefault(piece.sign(joint), arc.place(begin))
                    slowest.bound = np.minimum(slowest.bound, least)
                    yield piece
                    continue
            middle = (begin + end) / 2
            ahead += [(middle, end, halvings + 1), (begin, middle, halvings + 1)]

    def _is_decided(self, arc: Arc, begin: float, end: float, piece: Piece, *, last: bool) -> bool:
        """Whether the sign of each joint's rate is known on a piece; a joint proven to turn round is left out."""
        undecided = []
        for joint in sorted(self.followed):
            if piece.all_but_still(joint):
                continue
            for t, ends in ((begin, piece.first), (end, piece.last)):
                sign = int(ends[0, joint] > 0) - int(ends[1, joint] < 0)
                if sign and self.direction.setdefault(joint, sign) != sign:
                    self.refuted.append(f"{self.names[joint]} turns round: it moves the other way {arc.place(t)}")
                    self.followed.discard(joint)
                    break
            if joint in self.followed and not piece.sign(joint):
                undecided.append(joint)
        if last:
            place = arc.place(begin)
            self.undecided += [f"the direction of {self.names[i]} could not be decided {place}" for i in undecided]
            self.followed.difference_update(undecided)
        return last or not undecided

    def _must_be_in_reach(self, arc: Arc, t: float) -> None:
        """Raise where the wrist centre is proven out of reach at the parameter t."""
        ahead_2, height_2, _ = body_at(self.setting, arc.at(t)[0]).squares
        if ahead_2 < 0 or height_2 < 0:
            raise LostError(f"out of reach {arc.place(t)}", proven=True)
