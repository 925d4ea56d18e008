"""Straight ways out of a hole along its drill axis: how far the arm can follow one, and with which joints it ends."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from zerorev.collision.arms import Setting
from zerorev.collision.poses import poses_keep
from zerorev.model._arrays import Array
from zerorev.motion.drilling import Drilling
from zerorev.motion.joint_path import FULL_TURN, joints_along, outward_rates

__all__ = ["Line", "Outward", "outward"]

SAMPLES = 201  # per look
# lengths for an arm of size 1 (`Robot.size`)
CLOSE_ENOUGH = 1e-8  # [m] to which the end of a shortened way is located
STEP = 1e-6  # [m] down to a multiple of which it is shortened, so that the last bits of the arithmetic are not written
KEPT = 0.75  # of the way to the trouble: at its end a joint may stand still, and the printed digits would turn it round


class _Trouble(NamedTuple):
    """The first sample that breaks a rule."""

    sample: int
    why: str


@dataclass(frozen=True)
class Line:
    """A way out of a hole along its drill axis, the spin linear along it.

    Attributes:
        drilling: robot, tool and hole.
        branch: 0..7.
        standoff: where it begins [m].
        psi: spin there [rad].
        slope: change of the spin per stand-off [rad/m].
        joints: controller angles with turns there [rad], shape (6,).
        directions: signs that the joints' rates must keep, shape (6,), 0 for one that must rest; None: they need not.
        setting: what the arm must keep clear of; None: nothing is known to stand around.
    """

    drilling: Drilling
    branch: int
    standoff: float
    psi: float
    slope: float
    joints: Array
    directions: Array | None = None
    setting: Setting | None = None

    def beyond(self, way: Outward) -> Line:
        """The line from the end of a way along it."""
        standoff = self.standoff + way.length
        return replace(self, standoff=standoff, psi=self.psi + self.slope * way.length, joints=way.joints)

    def rates(self, standoff: Array) -> Array:
        """Outward rates [rad/m], shape (N, 6), at stand-offs [m], shape (N,)."""
        return outward_rates(self.drilling, self.branch, standoff, self._spin(standoff), float(self.slope))

    def signs(self, rates: Array) -> Array:
        """Which way the joints move; 0 for one that does not."""
        return np.asarray(np.where(np.abs(rates) <= self.drilling.robot.nil_rate, 0.0, np.sign(rates)))

    def path(self, standoff: Array, anchor: Array) -> Array:
        """Joints with turns [rad], shape (N, 6), the first row nearest to `anchor`."""
        joints = joints_along(self.drilling, self.branch, standoff, self._spin(standoff))
        return np.asarray(joints + FULL_TURN * np.round((anchor - joints[0]) / FULL_TURN))

    def trouble(self, standoff: Array, joints: Array) -> _Trouble | None:
        """The first of the samples, shape (N,), that breaks a rule."""
        rates, limits, names = self.rates(standoff), self.drilling.limits, self.drilling.robot.joint_names
        margin = np.rad2deg(self.drilling.limit_margin)
        at_limit = f"{{}} comes within {margin:g} deg of its limit" if margin else "{} reaches its limit"
        steps = np.abs(np.diff(joints, axis=0, prepend=joints[:1]))
        # by the mean value theorem a joint cannot step further than its greatest rate allows, unless it jumps
        fastest = np.maximum(np.abs(rates), np.abs(np.roll(rates, 1, axis=0)))
        may_step = 2 * fastest * np.abs(np.diff(standoff, prepend=standoff[:1]))[:, None] + 1e-6
        kept = self.signs(rates) if self.directions is None else self.directions
        checks = (
            (np.isnan(joints), "{} is out of reach"),
            (np.isnan(rates), "{} comes to a singularity"),
            (steps > may_step, "{} jumps"),
            (self.signs(rates) != kept, "{} would turn the other way"),
            ((joints < limits.lower) | (joints > limits.upper), at_limit),
            (self._too_near(standoff), "{} comes too near to what stands around it"),
        )
        firsts = [
            (int(np.argmax(broken.any(axis=1))), order, text.format(" ".join(_names(names, broken))))
            for order, (broken, text) in enumerate(checks)
            if broken.any()
        ]
        if not firsts:
            return None
        index, _, why = min(firsts)
        return _Trouble(index, why)

    def _too_near(self, standoff: Array) -> npt.NDArray[np.bool_]:
        """Whether the arm does not keep the clearance, shape (N, 6), the same for all joints."""
        if self.setting is None:
            return np.zeros((standoff.size, 6), dtype=np.bool_)
        keeps = poses_keep(self.setting, self.drilling, self.branch, standoff, self._spin(standoff))
        return np.repeat(~keeps[:, None], 6, axis=1)

    def _spin(self, standoff: Array) -> Array:
        return self.psi + self.slope * (standoff - self.standoff)


@dataclass(frozen=True)
class Outward:
    """How far a way out goes.

    Attributes:
        length: [m].
        joints: controller angles with turns at its end [rad], shape (6,).
        why: what ends it before the length that was asked for; empty where nothing does.
    """

    length: float
    joints: Array
    why: str = ""


def outward(line: Line, wanted: float, shortest: float) -> Outward:
    """A way out, as long as asked for, or as long as possible.

    Args:
        line: which.
        wanted: length [m].
        shortest: a shorter one is left out [m].
    """
    if wanted <= 0:
        return Outward(0.0, line.joints)
    size = line.drilling.robot.size
    standoff = line.standoff + np.linspace(0.0, wanted, SAMPLES)
    joints = line.path(standoff, line.joints)
    trouble = line.trouble(standoff, joints)
    if trouble is None:
        return Outward(wanted, joints[-1])
    why = trouble.why
    # search between the last good sample and the first bad one, until they meet: bisection, 200 parts at a time
    while trouble is not None and trouble.sample > 0 and standoff[1] - standoff[0] > CLOSE_ENOUGH * size:
        good = trouble.sample - 1
        standoff, anchor = np.linspace(standoff[good], standoff[good + 1], SAMPLES), joints[good]
        joints = line.path(standoff, anchor)
        trouble = line.trouble(standoff, joints) or _Trouble(SAMPLES - 1, why)
    located = float(standoff[max(trouble.sample - 1, 0)] - line.standoff) if trouble else 0.0
    length = float(np.floor(KEPT * located / (STEP * size)) * STEP * size)
    if length < shortest:
        return Outward(0.0, line.joints, why)
    return Outward(length, line.path(line.standoff + np.linspace(0.0, length, SAMPLES), line.joints)[-1], why)


def _names(names: tuple[str, ...], broken: Array) -> list[str]:
    """The joints that break a rule at the first sample where any does; the whole arm where all of them do."""
    row = broken[int(np.argmax(broken.any(axis=1)))]
    return ["the arm"] if row.all() else [name for name, bad in zip(names, row, strict=True) if bad]
