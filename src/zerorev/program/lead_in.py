"""The lead-in: the plunge leg continued backwards, so that every joint already moves its way when the drill enters.

A robot at rest has its backlash unloaded in a direction that depends on how it arrived (theory §5). The lead-in belongs
to the program, not to the plan: it is held to the directions in which the joints begin the plunge, to reach, to the
joint limits and to continuity, and shortened where it cannot keep them.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from zerorev.model._arrays import Array
from zerorev.model.finding import Finding
from zerorev.model.plan import Motion
from zerorev.motion.drilling import Drilling
from zerorev.motion.joint_path import FULL_TURN, joints_along, outward_rates

__all__ = ["LeadIn", "find_lead_in"]

SAMPLES = 201  # per look
# lengths for an arm of size 1 (`Robot.size`)
CLOSE_ENOUGH = 1e-8  # [m] to which the end of a shortened lead-in is located
STEP = 1e-6  # [m] down to a multiple of which it is shortened, so that the last bits of the arithmetic are not written
KEPT = 0.75  # of the way to the trouble: at its end a joint may stand still, and the printed digits would turn it round
SHORTEST = 1e-4  # [m] a shorter lead-in loads no backlash and only adds a move


@dataclass(frozen=True)
class LeadIn:
    """Where a hole's program begins.

    Attributes:
        length: of the lead-in [m].
        joints: controller angles with turns at its first point [rad], shape (6,).
        findings: that it was shortened, and why.
    """

    length: float
    joints: Array
    findings: tuple[Finding, ...]


class _Trouble(NamedTuple):
    """The first sample that breaks a rule."""

    sample: int
    why: str


class _Line:
    """The plunge leg of a plan, continued backwards."""

    def __init__(self, drilling: Drilling, motion: Motion) -> None:
        self.drilling, self.robot, self.branch = drilling, drilling.robot, motion.branch
        profile = motion.profile
        self.depth, self.psi, self.slope = float(profile.standoff[0]), float(profile.psi[0]), profile.twist_rate[0]
        self.joints = motion.joints[0]
        self.directions = self._directions(float(profile.standoff[0] - profile.standoff[1]))

    def rates(self, standoff: Array) -> Array:
        """Outward rates [rad/m], shape (N, 6)."""
        psi = self.psi + self.slope * (standoff - self.depth)
        return outward_rates(self.drilling, self.branch, standoff, psi, float(self.slope))

    def path(self, standoff: Array, anchor: Array) -> Array:
        """Joints with turns [rad], shape (N, 6), the first row nearest to `anchor`."""
        psi = self.psi + self.slope * (standoff - self.depth)
        joints = joints_along(self.drilling, self.branch, standoff, psi)
        return np.asarray(joints + FULL_TURN * np.round((anchor - joints[0]) / FULL_TURN))

    def signs(self, rates: Array) -> Array:
        """Which way the joints move; 0 for one that does not."""
        return np.asarray(np.where(np.abs(rates) <= self.robot.nil_rate, 0.0, np.sign(rates)))

    def _directions(self, length: float) -> Array:
        """Outward directions in which the joints begin the plunge, shape (6,); 0 for a joint that rests all along."""
        signs = self.signs(self.rates(self.depth - np.array([0.0, 1e-3, 1e-2]) * length))
        # a least-travel plan may begin just where a joint stands still: then it is the leg that tells its direction
        return np.asarray(np.where(signs[0] != 0, signs[0], np.where(signs[1] != 0, signs[1], signs[2])))

    def trouble(self, standoff: Array, joints: Array) -> _Trouble | None:
        """The first of the samples, shape (N,), that breaks a rule."""
        rates, limits = self.rates(standoff), self.robot.limits
        names = self.robot.joint_names
        steps = np.abs(np.diff(joints, axis=0, prepend=joints[:1]))
        # by the mean value theorem a joint cannot step further than its greatest rate allows, unless it jumps
        fastest = np.maximum(np.abs(rates), np.abs(np.roll(rates, 1, axis=0)))
        may_step = 2 * fastest * np.abs(np.diff(standoff, prepend=standoff[:1]))[:, None] + 1e-6
        checks = (
            (np.isnan(joints), "{} is out of reach"),
            (np.isnan(rates), "{} comes to a singularity"),
            (steps > may_step, "{} jumps"),
            (self.signs(rates) != self.directions, "{} would turn the other way"),
            ((joints < limits.lower) | (joints > limits.upper), "{} reaches its limit"),
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


def find_lead_in(drilling: Drilling, motion: Motion, wanted: float) -> LeadIn:
    """The lead-in of a planned hole: as long as asked for, or as long as possible.

    Args:
        drilling: robot, tool and hole.
        motion: of the hole.
        wanted: length [m].
    """
    line, robot = _Line(drilling, motion), drilling.robot
    if wanted <= 0:
        return LeadIn(0.0, line.joints, ())
    standoff = line.depth + np.linspace(0.0, wanted, SAMPLES)
    joints = line.path(standoff, line.joints)
    trouble = line.trouble(standoff, joints)
    if trouble is None:
        return LeadIn(wanted, joints[-1], ())
    why = trouble.why
    # search between the last good sample and the first bad one, until they meet: bisection, 200 parts at a time
    while trouble is not None and trouble.sample > 0 and standoff[1] - standoff[0] > CLOSE_ENOUGH * robot.size:
        good = trouble.sample - 1
        standoff, anchor = np.linspace(standoff[good], standoff[good + 1], SAMPLES), joints[good]
        joints = line.path(standoff, anchor)
        trouble = line.trouble(standoff, joints) or _Trouble(SAMPLES - 1, why)
    located = float(standoff[max(trouble.sample - 1, 0)] - line.depth) if trouble else 0.0
    step = STEP * robot.size
    length = float(np.floor(KEPT * located / step) * step)
    if length < SHORTEST * robot.size:
        length, first = 0.0, line.joints
    else:
        first = line.path(line.depth + np.linspace(0.0, length, SAMPLES), line.joints)[-1]
    message = f"lead-in of {length * 1e3:.3f} mm instead of {wanted * 1e3:g} mm: further back {why}"
    return LeadIn(length, first, (Finding("warning", "lead_in", message, drilling.hole.id),))


def _names(names: tuple[str, ...], broken: Array) -> list[str]:
    """The joints that break a rule at the first sample where any does; the whole arm where all of them do."""
    row = broken[int(np.argmax(broken.any(axis=1)))]
    return ["the arm"] if row.all() else [name for name, bad in zip(names, row, strict=True) if bad]
