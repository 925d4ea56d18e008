"""What is proven of the joint moves at the corner, beside the directions of the joints: how near the tool stays.

The tip may leave the drill axis, and the tool tilt against it, by what the job allows, or by what the plan states where
that is more.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np
from flint import arb

from zerorev.model.corner import MOST_TILT
from zerorev.model.plan import Certificate, HolePlan
from zerorev.model.robot import Robot
from zerorev.model.settings import Settings
from zerorev.model.tool import Tool
from zerorev.verify.certificate.joint_corner import axis_of, bound_corner, drill_of
from zerorev.verify.certificate.path import JointLeg, Motion
from zerorev.verify.joint_corner import corner_figures

__all__ = ["joint_corners", "near_the_axis", "planned_corner"]

ABOVE, OVER, TURNED = 1.1, 1e-6, math.radians(1e-4)  # a bound may be so much above what is met, [m], [rad]


def planned_corner(
    robot: Robot, tool: Tool, settings: Settings, hole_plan: HolePlan, certificate: Certificate
) -> Certificate:
    """A certificate of a plan's hole, and what the joint moves at its corner do to it.

    Args:
        robot: the arm.
        tool: the drill.
        settings: as planned.
        hole_plan: what is claimed.
        certificate: of its legs.
    """
    motion, corner = hole_plan.motion, hole_plan.corner
    if motion is None or corner is None or corner.kind not in ("joint", "spin") or certificate.verdict == "refuted":
        return certificate
    joints = corner_figures(robot, tool, hole_plan.hole, motion, corner.reach, corner.spin_moves or 0).joints
    if not np.isfinite(joints).all():
        return _with(certificate, ["the joint moves at the corner could not be followed"], proven=False)
    exact = [[arb(float(angle)) for angle in row] for row in joints]
    corners = [("", exact[k : k + 3]) for k in range(len(exact) - 2)]
    return near_the_axis(robot, tool, settings, hole_plan, corners, 0.0, certificate)


def near_the_axis(
    robot: Robot,
    tool: Tool,
    settings: Settings,
    hole_plan: HolePlan,
    corners: Sequence[tuple[str, Sequence[Sequence[arb]]]],
    slack: float,
    certificate: Certificate,
) -> Certificate:
    """A certificate, and what some pairs of joint moves do to it that meet.

    Args:
        robot: the arm.
        tool: the drill.
        settings: as planned.
        hole_plan: with the drill axis, and what is stated of its corner.
        corners: where they meet, in words, and the joints [rad] where each pair begins, meets and ends, 3 times 6.
        slack: of the tip and of the angle for printed digits [m], [rad].
        certificate: of the rest of the motion.
    """
    stated = hole_plan.corner
    tolerance = max(settings.corner_tolerance, 0.0 if stated is None else stated.off_axis) + slack
    tilt = max(MOST_TILT, 0.0 if stated is None else stated.tilt) + slack
    refuted, undecided = list[str](), list[str]()
    reversing = () if hole_plan.score is None else hole_plan.score.reversals_per_joint
    for place, joints in corners:
        found = bound_corner(robot, drill_of(tool), axis_of(hole_plan.hole), joints)
        where = f"at the corner{place}"
        if found.off_axis_met > tolerance or found.tilt_met > tilt:
            refuted.append(f"the tool leaves the drill axis by {_by(found.off_axis_met, found.tilt_met)} {where}")
        elif found.off_axis > ABOVE * tolerance + OVER or found.tilt > ABOVE * tilt + TURNED:
            undecided.append(
                f"whether the tool stays within {_by(tolerance, tilt)} of the axis was not decided {where}"
            )
        for name, turned in _reversing(robot, found.signs):
            if not (reversing and reversing[turned]):
                refuted.append(f"{name} turns round {where}")
    return _with(_with(certificate, undecided, proven=False), refuted, proven=True)


def joint_corners(motion: Motion) -> list[tuple[str, list[tuple[arb, ...]]]]:
    """Where joint moves of a motion meet, in words, and the joints at the ends of each two [rad], 3 times 6.

    Args:
        motion: of a program; the turns of its joint moves are those that are printed.
    """
    return [
        (f" ({leg.where})", [leg.begin, leg.end, after.end])
        for leg, after in pairwise(motion.legs)
        if isinstance(leg, JointLeg) and isinstance(after, JointLeg)
    ]


def _reversing(robot: Robot, signs: tuple[tuple[int, ...], tuple[int, ...]]) -> Iterator[tuple[str, int]]:
    for joint, (first, last) in enumerate(zip(*signs, strict=True)):
        if first * last < 0:
            yield robot.joint_names[joint], joint


def _with(certificate: Certificate, reasons: Sequence[str], *, proven: bool) -> Certificate:
    if not reasons:
        return certificate
    verdict = "refuted" if proven else certificate.verdict if certificate.verdict == "refuted" else "undecided"
    return replace(certificate, verdict=verdict, reasons=(*certificate.reasons, *reasons))


def _by(length: float, angle: float) -> str:
    return f"{length * 1e3:.3g} mm and {np.rad2deg(angle):.2g} deg"
