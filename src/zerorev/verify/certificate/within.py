"""Certified for every placement of the part within a tolerance: of a plan, a given tolerance or the largest.

The motion is fixed to the part, as a program's points are in `$BASE`. What is certified under every placement error
within the tolerance is what the certificate says without one: no joint reverses, no limit is passed, every pose is in
reach and clear of singularities, also where breakpoints are blended. The motion threshold is not, and of the room at
the joint limits (`limit_margin`) nothing need be left: it is kept for such errors.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from zerorev.errors import InputError
from zerorev.model._arrays import Array
from zerorev.model.finding import Finding, Level
from zerorev.model.job import Settings
from zerorev.model.plan import HolePlan, Plan, Within
from zerorev.model.robot import Robot
from zerorev.model.strokes import stroke_by_stroke
from zerorev.model.tool import Tool
from zerorev.verify.certificate.arm import Setting, posture_of
from zerorev.verify.certificate.certify import certify_hole
from zerorev.verify.certificate.legs import planned_motion
from zerorev.verify.certificate.misplaced import failure
from zerorev.verify.certificate.piece import ball_arithmetic
from zerorev.verify.certificate.tolerance import Cause, Margin, Tolerated

__all__ = ["RATIO", "Tolerance", "certify_plan_again", "certify_plan_within", "certify_within", "largest_within"]

RATIO = 1e-2 / math.radians(1)  # [m/rad]: 10 mm per deg, as in 1 mm and 0.1 deg
FIRST = 1e-3  # [m]: the first tolerance that is tried
SMALLEST, LARGEST = 1e-7, 0.1  # [m]: none below counts, none above is sought
MOST_TURN = math.radians(20)
CLOSE = 1.01  # how far the tolerance that is proven and one that is not may lie apart
STEP = 1 + (CLOSE - 1) / 4  # a trial is put so much beyond where the share is expected to be used up
TRIALS = 20
GROWTH = 10.0  # of the step from one trial to the next, at most
# of the error at which a tolerance that is not proven is expected to fail: where a failure is sought
BEYOND = (1.0, 1.01, 1.02, 1.05, 1.1, 1.2, 1.35, 1.5, 2.0, 3.0)
DIGITS = 4  # significant, of the largest tolerance in mm; rounded down


@dataclass(frozen=True)
class Tolerance:
    """What is proven of a hole under placement errors.

    Attributes:
        within: every placement error within these bounds is certified; None where nothing is.
        decides: by what a larger tolerance fails, or the given one, as a sentence: joint and stand-off; empty where the
            given one is certified.
        error: a placement error under which the motion is proven to fail: shift along the axes of the part frame [m]
            and rotation vector along them [rad], shape (6,); None where none was found.
    """

    within: Within | None
    decides: str = ""
    error: Array | None = None


def certify_plan_within(plan: Plan, within: Within | None = None, ratio: float = RATIO) -> Plan:
    """The plan with `certificate` and `certified_within` filled in for each hole that has a motion.

    What decides, and where nothing is proven, is said in a finding of kind `tolerance`.

    Args:
        plan: any plan, also a wrong one.
        within: the tolerance; None: the largest that can be proven of each hole.
        ratio: of position to rotation in the largest [m/rad].

    Raises:
        InputError: a tolerance or a ratio that is none.
    """
    if within is not None:
        _sensible(within)
    elif not (math.isfinite(ratio) and ratio > 0):
        raise InputError(f"the ratio is {ratio}", where="tolerance", accepted="a finite length per angle above 0")

    def answer(plan: Plan, hole: HolePlan) -> Tolerance:
        if within is None:
            return largest_within(plan.robot, plan.tool, plan.settings, plan.T_base_part, hole, ratio)
        return certify_within(plan.robot, plan.tool, plan.settings, plan.T_base_part, hole, within)

    return stroke_by_stroke(plan, partial(_all_proven, answer=answer))


def certify_plan_again(plan: Plan) -> Plan:
    """The plan with `certificate` filled in, and each `certified_within` that it states proven again or taken out.

    Args:
        plan: any plan, also a wrong one.
    """

    def answer(plan: Plan, hole: HolePlan) -> Tolerance:
        stated = hole.certified_within
        if stated is None:
            return Tolerance(None)
        found = certify_within(plan.robot, plan.tool, plan.settings, plan.T_base_part, hole, stated)
        if found.within is None:
            return found
        said = (finding.message for finding in hole.findings if finding.kind == "tolerance")
        return replace(found, decides=next(said, ""))

    return stroke_by_stroke(plan, partial(_all_proven, answer=answer))


def _all_proven(plan: Plan, answer: Callable[[Plan, HolePlan], Tolerance]) -> Plan:
    return replace(plan, holes=tuple(_proven(plan, hole, answer) for hole in plan.holes))


def _proven(plan: Plan, hole: HolePlan, answer: Callable[[Plan, HolePlan], Tolerance]) -> HolePlan:
    """A hole with its certificate and, where it is certified, an answer's tolerance and finding."""
    if hole.motion is None:
        return hole
    certificate = certify_hole(plan.robot, plan.tool, plan.settings, hole)
    hole = replace(hole, certificate=certificate)
    tolerance = answer(plan, hole) if certificate.verdict == "certified" else Tolerance(None)
    found = tuple(finding for finding in hole.findings if finding.kind != "tolerance")
    if tolerance.decides:
        level: Level = "warning" if tolerance.within is None else "info"
        found += (Finding(level, "tolerance", tolerance.decides, hole.hole.id),)
    return replace(hole, findings=found, certified_within=tolerance.within)


def certify_within(
    robot: Robot, tool: Tool, settings: Settings, T_base_part: Array, hole_plan: HolePlan, within: Within
) -> Tolerance:
    """Prove that a certified motion stays so under every placement error within a tolerance, or say what decides.

    Args:
        robot: the arm.
        tool: the drill.
        settings: blends as planned.
        T_base_part: part frame, shape (4, 4), translation [m].
        hole_plan: whose `certificate` is certified.
        within: the tolerance.

    Raises:
        InputError: the hole is not certified, or the tolerance is none.
    """
    _sensible(within)
    with ball_arithmetic():
        placements = _Placements(robot, tool, settings, T_base_part, hole_plan)
        margin = placements.margin(within)
        if margin.share > 0:
            return Tolerance(within)
        decides, error = placements.verdict(margin.cause, BEYOND[:1])
        return Tolerance(None, f"not certified within {_bounds(within)}: {decides}", error)


def largest_within(
    robot: Robot, tool: Tool, settings: Settings, T_base_part: Array, hole_plan: HolePlan, ratio: float = RATIO
) -> Tolerance:
    """The largest tolerance, but for 1 %, within which a certified motion can be proven to stay so.

    Args:
        robot: the arm.
        tool: the drill.
        settings: blends as planned.
        T_base_part: part frame, shape (4, 4), translation [m].
        hole_plan: whose `certificate` is certified.
        ratio: of position to rotation [m/rad].

    Raises:
        InputError: the hole is not certified.
    """
    largest = min(LARGEST, MOST_TURN * ratio)
    with ball_arithmetic():
        placements = _Placements(robot, tool, settings, T_base_part, hole_plan)
        proven, failed = _bracket(placements, ratio, largest)
        within = _rounded(proven, ratio)
        decides, error = ("", None) if failed is None else placements.verdict(failed.cause, BEYOND)
    if within is None:
        return Tolerance(None, f"certified as the part is modelled, but within no tolerance: {decides}", error)
    beyond = f"beyond, {decides}" if decides else "no larger tolerance is sought"
    return Tolerance(within, f"certified within {_bounds(within)}; {beyond}", error)


class _Placements:
    """The motion of a hole, and what can be said of it under placement errors; in ball arithmetic."""

    def __init__(self, robot: Robot, tool: Tool, settings: Settings, T_base_part: Array, hole_plan: HolePlan) -> None:
        motion, certificate = hole_plan.motion, hole_plan.certificate
        if motion is None or certificate is None or certificate.verdict != "certified":
            raise InputError("is not certified", where=f"hole {hole_plan.hole.id}", accepted="a certified motion")
        posture = posture_of(robot.arm, motion.joints[0])
        assert posture is not None
        self._robot, self._setting, self._T_base_part = robot, Setting(robot.arm, posture), T_base_part
        self._joints = motion.joints[[0, -1]]
        settings = settings.of(hole_plan.hole)
        path = planned_motion(
            robot.arm, tool, hole_plan.hole, motion.profile, settings.corner_blend, settings.passing_blend
        )
        self._tolerated = Tolerated(robot, self._setting, path, self._joints, T_base_part)

    def margin(self, within: Within) -> Margin:
        """What is left within a tolerance."""
        return self._tolerated.margin(within)

    def verdict(self, cause: Cause, factors: Sequence[float]) -> tuple[str, Array | None]:
        """What fails, with the placement error under which it is proven to; or what could not be proven.

        Args:
            cause: what decides, and the error at which it is expected to fail.
            factors: by which this error is multiplied, one after the other, until the failure is proven.
        """
        arcs = self._tolerated.arcs
        for factor in factors:
            error = cause.error * factor
            found = failure(self._robot, self._setting, arcs, self._joints, self._T_base_part, cause, error)
            if found is not None:
                return f"{found} with the part {_error(error)}", error
        name, place = self._robot.joint_names[cause.joint], arcs[cause.arc].place(cause.t)
        what = {
            "rate": f"that {name} keeps its direction",
            "limit": f"that {name} stays within its limits",
            "reach": "that the pose stays in reach and clear of singularities",
        }[cause.what]
        return f"it could not be proven {what} {place}", None


def _bracket(placements: _Placements, ratio: float, largest: float) -> tuple[float, Margin | None]:
    """A position tolerance [m] that is proven, 0 for none, and what is left at one a little larger that is not.

    Args:
        placements: of which it is sought.
        ratio: of position to rotation [m/rad].
        largest: none larger is sought [m].

    Returns:
        The tolerance, and the margin of the larger one; None where the largest is proven.
    """
    good, bad, failed = [(0.0, 1.0)], largest, None
    trial = min(FIRST, largest)
    for _ in range(TRIALS):
        margin = placements.margin(Within(trial, trial / ratio))
        if margin.share > 0:
            good.append((trial, margin.share))
        else:
            bad, failed = trial, margin
        if good[-1][0] >= largest or bad < max(SMALLEST, good[-1][0] * CLOSE):
            break
        trial = _next_trial(good, bad, None if failed is None else failed.share)
    return good[-1][0] if good[-1][0] >= SMALLEST else 0.0, failed


def _next_trial(good: Sequence[tuple[float, float]], bad: float, left: float | None) -> float:
    """The tolerance to try next.

    The share that is left falls ever faster as the tolerance grows. So the chord through two that are proven meets 0
    too far out, and the chord from there to one that is not, too near.

    Args:
        good: tolerances that are proven, growing, and the shares left; 0 and 1 the first.
        bad: one that is not proven, or the largest.
        left: the share left there; None: it was not tried.
    """
    here, share = good[-1]
    far = bad
    if len(good) > 1:
        before, more = good[-2]
        far = here + (here - before) * min(share / max(more - share, 1e-9), GROWTH)
    if left is None or far * STEP < bad / STEP:
        return min(far * STEP, bad)
    near = here + (bad - here) * share / (share - left) if math.isfinite(left) else here
    if near < 1.1 * here and bad > 1.3 * here:
        near = math.sqrt(here * bad)
    elif near <= here:
        near = (here + bad) / 4 if here == 0 else math.sqrt(here * bad)
    return min(max(near * STEP, here * STEP), bad / STEP)


def _rounded(position: float, ratio: float) -> Within | None:
    """A tolerance in mm and deg with few digits, no larger; None for none."""
    if position <= 0:
        return None
    length_mm = position * 1e3
    scale = 10.0 ** (DIGITS - 1 - math.floor(math.log10(length_mm)))
    length = math.floor(length_mm * scale) / scale * 1e-3
    return Within(length, length / ratio)


def _sensible(within: Within) -> None:
    for name, value in (("position", within.position), ("rotation", within.rotation)):
        if not (math.isfinite(value) and value >= 0):
            raise InputError(f"the tolerance of {name} is {value}", where="tolerance", accepted="0 or more, finite")


def _bounds(within: Within) -> str:
    return f"{within.position * 1e3:.4g} mm and {math.degrees(within.rotation):.4g} deg"


def _error(error: Array) -> str:
    """Shifted by (..) mm and turned by (..) deg along the axes of the part frame."""
    shift, turn = (
        ", ".join(f"{part + 0.0:.4g}" for part in parts) for parts in (error[:3] * 1e3, np.rad2deg(error[3:]))
    )
    return f"shifted by ({shift}) mm and turned by ({turn}) deg"
