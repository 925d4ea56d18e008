"""The lead-in: the plunge leg continued backwards, so that every joint already moves its way when the drill enters.

A robot at rest has its backlash unloaded in a direction that depends on how it arrived (theory §5). The lead-in belongs
to the program, not to the plan: it is held to the directions in which the joints begin the plunge, to reach, to the
joint limits and to continuity, and shortened where it cannot keep them.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from zerorev.collision.arms import Setting
from zerorev.model._arrays import Array
from zerorev.model.finding import Finding
from zerorev.model.plan import Motion
from zerorev.motion.drilling import Drilling
from zerorev.program.outward import Line, outward

__all__ = ["LeadIn", "find_lead_in"]

SHORTEST = 1e-4  # [m], for an arm of size 1: a shorter lead-in loads no backlash and only adds a move


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


def find_lead_in(drilling: Drilling, motion: Motion, wanted: float, setting: Setting | None = None) -> LeadIn:
    """The lead-in of a planned hole: as long as asked for, or as long as possible.

    Args:
        drilling: robot, tool and hole.
        motion: of the hole.
        wanted: length [m].
        setting: what the arm must keep clear of on it; None: nothing is known to stand around.
    """
    profile = motion.profile
    depth, slope = float(profile.standoff[0]), float(profile.twist_rate[0])
    line = Line(drilling, motion.branch, depth, float(profile.psi[0]), slope, motion.joints[0], setting=setting)
    line = replace(line, directions=_directions(line, float(profile.standoff[0] - profile.standoff[1])))
    way = outward(line, wanted, SHORTEST * drilling.robot.size)
    if not way.why:
        return LeadIn(way.length, way.joints, ())
    message = f"lead-in of {way.length * 1e3:.3f} mm instead of {wanted * 1e3:g} mm: further back {way.why}"
    return LeadIn(way.length, way.joints, (Finding("warning", "lead_in", message, drilling.hole.id),))


def _directions(line: Line, length: float) -> Array:
    """Outward directions in which the joints begin a leg of so much [m], shape (6,); 0 for one that rests all along."""
    signs = line.signs(line.rates(line.standoff - np.array([0.0, 1e-3, 1e-2]) * length))
    # a least-travel plan may begin just where a joint stands still: then it is the leg that tells its direction
    return np.asarray(np.where(signs[0] != 0, signs[0], np.where(signs[1] != 0, signs[1], signs[2])))
