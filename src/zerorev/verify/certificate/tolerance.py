"""A proof for every placement of the part within a tolerance, by Taylor models in place of balls.

Under every placement error within bounds, on every piece of the legs and of the blends, the rate of each joint must
have the sign that it has without one, and the pose must be in reach and clear of singularities. Then each joint moves
one way throughout, and lies between its angles at the two ends: there alone are the limits checked. The motion without
an error is proven by the certificate proper (`certificate`), on whose turns this rests.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal, NamedTuple

import numpy as np

from zerorev.model._arrays import Array
from zerorev.model.plan import Within
from zerorev.model.robot import Robot
from zerorev.verify.certificate.arm import Setting, angles, body_at, rates
from zerorev.verify.certificate.path import Arc, Motion
from zerorev.verify.certificate.placed import Pieces, placed
from zerorev.verify.certificate.range import least, lowest_at
from zerorev.verify.certificate.taylor import Taylor

__all__ = ["Cause", "Margin", "Tolerated"]

TURN_A_PIECE = float(np.deg2rad(2.0))  # [rad] of the tool in the first pieces
PATH_A_PIECE = 8e-3  # [m] of path in the first pieces
HALVINGS = 5  # of one piece at most
PIECES = 400  # of one motion at most, and four times the first ones
TINY = 1e-6  # least share of a quantity in the middle of a piece that counts as what there is without an error
WIDER = 1 + 1e-12  # more than the rounding of bounds that come from a file

What = Literal["rate", "reach", "limit"]


class Cause(NamedTuple):
    """What decides a margin.

    Attributes:
        what: the rate of a joint, the reach (of a pose, or its distance from a singularity), or a joint's limit.
        joint: counted from 0; of no meaning for the reach.
        arc: index of the arc: legs first, then blends.
        t: parameter of the arc.
        error: the placement error at which the quantity is least, or about there: shift [m] along the axes of the part
            frame, then rotation vector [rad] with its components along them; shape (6,).
    """

    what: What
    joint: int
    arc: int
    t: float
    error: Array


class Margin(NamedTuple):
    """What is left under a placement error.

    Attributes:
        share: of the least of all rates, distances to limits and to the edge of reach, each in proportion to what it is
            without an error; above 0: all of them are proven to be.
        cause: which one that is.
    """

    share: float
    cause: Cause


NOTHING = Cause("reach", 0, 0, 0.0, np.zeros(6))


class Tolerated:
    """The motion of one hole, and what is left of it under placement errors."""

    def __init__(self, robot: Robot, setting: Setting, motion: Motion, ends: Array, T_base_part: Array) -> None:
        """Cut the motion into its first pieces.

        Args:
            robot: the arm.
            setting: arm and posture.
            motion: legs and blends.
            ends: joints at begin and end with their turns, proven but for far less than a turn [rad], shape (2, 6).
            T_base_part: part frame, shape (4, 4), translation [m].
        """
        self.robot, self.setting, self.T_base_part = robot, setting, T_base_part
        self.arcs = [leg for leg in motion.legs if isinstance(leg, Arc)]  # of a plan all are
        self.arcs += [blend.arc for blend in motion.blends]
        self._joints, self._direction = ends, np.sign(ends[1] - ends[0])
        self._ends = Pieces(np.array([0, len(motion.legs) - 1]), np.array([0.0, 1.0]), np.array([0.0, 1.0]))
        counts = [_power_of_two(arc.turn() / TURN_A_PIECE, float(arc.length) / PATH_A_PIECE) for arc in self.arcs]
        self._budget = PIECES + 4 * sum(counts)
        self._finest = np.array([1 / n for n in counts]) / 2**HALVINGS
        self._pieces = Pieces(
            np.repeat(np.arange(len(counts)), counts),
            np.concatenate([np.arange(n) / n for n in counts]),
            np.concatenate([np.arange(1, n + 1) / n for n in counts]),
        )

    def margin(self, within: Within) -> Margin:
        """What is left under every placement error within bounds.

        Pieces that fail are halved, unless that cannot help; the halves are kept for the next tolerance.

        Args:
            within: the bounds.
        """
        within = Within(within.position * WIDER, within.rotation * WIDER)
        with np.errstate(all="ignore"):
            margin, done, todo = Margin(np.inf, NOTHING), list[Pieces](), self._pieces
            while margin.share > 0 and todo.arc.size:
                found = self._along(todo, within)
                failed = ~(found.share.min(axis=0) > 0)
                fine = todo.end - todo.begin < 1.5 * self._finest[todo.arc]
                many = sum(part.arc.size for part in done) + todo.arc.size + failed.sum() > self._budget
                lost = failed & (fine | np.asarray(many) | found.hopeless())
                margin = min(margin, found.worst(lost if lost.any() else ~failed), key=lambda one: one.share)
                done.append(_chosen(todo, ~failed | lost))
                todo = _halved(_chosen(todo, failed & ~lost))
            if np.isfinite(margin.share):  # else the tolerance is far too large, and the halves would be of no use
                self._pieces = Pieces(*(np.concatenate(parts) for parts in zip(*done, todo, strict=True)))
            if margin.share > 0:
                margin = min(margin, self._at_limits(within).worst(), key=lambda one: one.share)
        return margin

    def _along(self, pieces: Pieces, within: Within) -> _Found:
        """The rates on pieces, and the squares that say how far the edge of reach and singularities are."""
        at = placed(self.arcs, pieces, self.T_base_part, within)
        body = body_at(self.setting, at.pose)
        turning = rates(self.setting, body, at.twist)
        named: list[tuple[What, int, Taylor]] = [("rate", i, turning[i] * float(self._direction[i])) for i in range(6)]
        return _Found(pieces, within, named + [("reach", 0, square) for square in body.squares])

    def _at_limits(self, within: Within) -> _Found:
        """The distances to the limits at the two ends of the motion."""
        at = placed(self.arcs, self._ends, self.T_base_part, within)
        named: list[tuple[What, int, Taylor]] = []
        for i, angle in enumerate(angles(self.setting, body_at(self.setting, at.pose), at.flange)):
            turns = np.rint((self._joints[:, i] - angle.c) / (2 * np.pi))
            joint = angle + Taylor.constant(turns * 2 * np.pi)
            limits = self.robot.limits
            named += [("limit", i, joint - float(limits.lower[i])), ("limit", i, float(limits.upper[i]) - joint)]
        return _Found(self._ends, within, named)


class _Found:
    """Quantities on n pieces, which all must be above 0.

    Attributes:
        share: what is left of each, in proportion to what there is without a placement error; shape (quantities, n),
            -inf for nothing.
    """

    def __init__(self, pieces: Pieces, within: Within, quantities: Sequence[tuple[What, int, Taylor]]) -> None:
        self._pieces, self._within, self._quantities = pieces, within, quantities
        models = Taylor.side_by_side([model for *_, model in quantities])
        self._models, self._least = models, least(models)
        assert models.terms is not None
        along, bend = models.terms[0, 0], models.terms[1, 0]
        without = np.maximum(models.c - np.abs(along) + np.minimum(bend, 0), models.c * TINY)
        share = np.where(models.c > 0, self._least / without, -np.inf)
        self.share = np.where(np.isnan(share), -np.inf, share).reshape(len(quantities), -1)

    def hopeless(self) -> Array:
        """Where a quantity would fail on the smallest piece, too, as far as its polynomial shows; shape (n,)."""
        assert self._models.terms is not None
        along, bent = np.abs(self._models.terms[0, 0]), np.abs(self._models.terms[1]).sum(axis=0)
        beyond = self._least + along + 2 * bent + self._models.rest <= 0
        return np.asarray(beyond.reshape(self.share.shape).any(axis=0))

    def worst(self, chosen: Array | None = None) -> Margin:
        """The least share, on chosen pieces."""
        share = self.share if chosen is None else np.where(chosen, self.share, np.inf)
        row, k = (int(index) for index in np.unravel_index(int(np.argmin(share)), share.shape))
        what, joint, _ = self._quantities[row]
        x = lowest_at(self._models, row * share.shape[1] + k)
        begin, end = self._pieces.begin[k], self._pieces.end[k]
        error = np.concatenate([self._within.position * x[1:4], self._within.rotation * x[4:]])
        t = float(begin + (end - begin) * (1 + x[0]) / 2)
        return Margin(float(share[row, k]), Cause(what, joint, int(self._pieces.arc[k]), t, error))


def _power_of_two(*least: float) -> int:
    """The least power of two that is no less than numbers."""
    return 1 << max(0, *(int(np.ceil(np.log2(number))) if number > 0 else 0 for number in least))


def _chosen(pieces: Pieces, mask: Array) -> Pieces:
    return Pieces(*(values[mask] for values in pieces))


def _halved(pieces: Pieces) -> Pieces:
    middle = (pieces.begin + pieces.end) / 2
    return Pieces(
        np.repeat(pieces.arc, 2),
        np.stack([pieces.begin, middle], axis=1).ravel(),
        np.stack([middle, pieces.end], axis=1).ravel(),
    )
