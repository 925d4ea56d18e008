"""The joint angles of a certified motion, with their turns, and how near they come to their limits."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from flint import arb

from zerorev.model._arrays import Array
from zerorev.model.robot import Robot
from zerorev.verify.certificate.arm import Setting, angles, body_at
from zerorev.verify.certificate.path import Arc, JointLeg
from zerorev.verify.certificate.piece import bounds
from zerorev.verify.certificate.walk import LostError, Stretch
from zerorev.verify.claims import JOINT_TOLERANCE
from zerorev.verify.sound import too_near

__all__ = ["Joints"]


class Joints:
    """Angles followed from the stated ones at the start.

    At the ends of arcs they are enclosed to the last digit; between two ends a joint that keeps its direction stays
    between these, and another one within the walk's bounds.

    Attributes:
        margin: room that every joint has to keep to its limits [rad].
        refuted: what is proven to be wrong, one sentence each.
        low: the joints are nowhere below [rad], shape (6,).
        high: the joints are nowhere above [rad], shape (6,).
        least: the least angles that are met, or a little more [rad], shape (6,).
        greatest: the greatest angles that are met, or a little less [rad], shape (6,).
    """

    def __init__(self, robot: Robot, setting: Setting, stated: Array, margin: float) -> None:
        self.robot, self.setting, self.stated, self.margin = robot, setting, stated, margin
        self.refuted: list[str] = []
        self.low, self.high = np.full(6, np.inf), np.full(6, -np.inf)
        self.least, self.greatest = np.full(6, np.inf), np.full(6, -np.inf)
        self._beyond: set[int] = set()

    def begin(self, arc: Arc) -> list[arb]:
        """The joints where an arc begins, on the turns of the first stated ones [rad].

        Raises:
            LostError: they are not what is stated, so the motion is another one; or they are undecided.
        """
        found = self._angles(arc, 0.0)
        turns = [
            (float(stated) - float(angle)) / (2 * np.pi) if angle.is_finite() else np.nan
            for stated, angle in zip(self.stated[0], found, strict=True)
        ]
        if not np.isfinite(turns).all():
            raise LostError(f"the joints could not be computed {arc.place(0.0)}", proven=False)
        start = [angle + 2 * arb.pi() * round(turn) for angle, turn in zip(found, turns, strict=True)]
        if wrong := list(self._off(start, 0, arc.place(0.0))):
            raise LostError("; ".join(wrong), proven=True)
        self._note(start, arc.place(0.0))
        return start

    def end(self, arc: Arc, stretch: Stretch) -> list[arb]:
        """The joints where an arc ends, on the turns to which the walk along it has led [rad].

        Raises:
            LostError: the turns are undecided.
        """
        joints = []
        for angle, led in zip(self._angles(arc, 1.0), stretch.end, strict=True):
            turns = ((led - angle) / (2 * arb.pi())).unique_fmpz()
            if turns is None:
                raise LostError(f"the turns of the joints could not be decided {arc.place(1.0)}", proven=False)
            joints.append(angle + 2 * arb.pi() * turns)
        self.low, self.high = np.minimum(self.low, stretch.low), np.maximum(self.high, stretch.high)
        self._note(joints, arc.place(1.0))
        if arc.knot is not None and arc.knot < len(self.stated):
            self.refuted += self._off(joints, arc.knot, arc.place(1.0))
        return joints

    def after(self, leg: JointLeg, before: list[arb]) -> list[arb]:
        """The joints where a move of all joints ends, on the turns of those with which it begins [rad].

        Args:
            leg: the move.
            before: where the motion has come to [rad].

        Raises:
            LostError: it begins elsewhere, or the turns are undecided.
        """
        joints = []
        for name, began, end, here in zip(self.robot.joint_names, leg.begin, leg.end, before, strict=True):
            turns = round(float(here - began) / (2 * np.pi)) if (here - began).is_finite() else 0
            apart = abs(here - began - 2 * arb.pi() * turns)
            if apart > JOINT_TOLERANCE:
                raise LostError(f"{name} is elsewhere where the move begins {leg.place(0.0)}", proven=True)
            if not apart <= JOINT_TOLERANCE:
                raise LostError(f"the turns of the joints could not be decided {leg.place(0.0)}", proven=False)
            if leg.printed and turns != 0:
                raise LostError(f"{name} is sent whole turns away {leg.place(1.0)}", proven=True)
            joints.append(end + 2 * arb.pi() * turns)
        self._note(joints, leg.place(1.0))
        if leg.knot is not None and leg.knot < len(self.stated):
            self.refuted += self._off(joints, leg.knot, leg.place(1.0))
        return joints

    def limit_distance(self) -> Array:
        """No distance to a limit is less [rad], shape (6,); negative where a limit may be passed."""
        limits = self.robot.limits
        room = np.minimum(self.low - limits.lower, limits.upper - self.high)
        return np.asarray(np.nextafter(room, -np.inf))

    def limit_distance_met(self) -> Array:
        """A distance to a limit that is met, or a little more [rad], shape (6,)."""
        limits = self.robot.limits
        room = np.minimum(self.least - limits.lower, limits.upper - self.greatest)
        return np.asarray(np.nextafter(room, np.inf))

    def _angles(self, arc: Arc, t: float) -> list[arb]:
        pose, flange = arc.at(t)
        return angles(self.setting, body_at(self.setting, pose), flange)

    def _off(self, joints: list[arb], knot: int, place: str) -> Iterator[str]:
        for name, found, stated in zip(self.robot.joint_names, joints, self.stated[knot], strict=True):
            off = abs(found - float(stated))
            if not off <= JOINT_TOLERANCE:
                yield (
                    f"{name} at breakpoint {knot + 1} is given as {np.rad2deg(stated):.8g} deg, "
                    f"{np.rad2deg(float(off)):.4g} deg off {place}"
                )

    def _note(self, joints: list[arb], place: str) -> None:
        """Widen the extents, and see whether a limit is passed."""
        below, above = (values[0] for values in bounds([joints]))
        self.low, self.high = np.minimum(self.low, below), np.maximum(self.high, above)
        self.least, self.greatest = np.minimum(self.least, above), np.maximum(self.greatest, below)
        limits = self.robot.limits
        for i, (name, joint) in enumerate(zip(self.robot.joint_names, joints, strict=True)):
            lower, upper = float(limits.lower[i]), float(limits.upper[i])
            above, below = joint - lower, upper - joint
            if i not in self._beyond and (above < self.margin or below < self.margin):
                self._beyond.add(i)
                nearest = float(above if above < self.margin else below)
                self.refuted.append(
                    f"{name} is {too_near(nearest, self.margin)} its limits "
                    f"({np.rad2deg(lower):g} to {np.rad2deg(upper):g} deg) {place}"
                )
