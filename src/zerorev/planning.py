"""plan(robot, tool, hole) and plan_deepest(robot, tool, hole): the story."""

from __future__ import annotations

from dataclasses import replace
from typing import Literal

import numpy as np

from zerorev.criteria import measure, objective_of, thesis_objective
from zerorev.critical import critical
from zerorev.depth import Deepest, deepest_stroke
from zerorev.evaluation import Evaluation, evaluate, meets_threshold
from zerorev.kinematics import wrist_offset
from zerorev.model._arrays import Array
from zerorev.model.hole import Hole
from zerorev.model.job import Settings
from zerorev.model.plan import Baseline, Finding, HolePlan
from zerorev.model.profile import Profile
from zerorev.model.robot import Robot
from zerorev.model.tool import Tool
from zerorev.search.exact import can_run, search
from zerorev.search.free import search_free
from zerorev.search.weighted import search_weighted
from zerorev.verify.check import verify_hole

__all__ = ["deepest_as_drilled", "lever_findings", "plan", "plan_deepest"]

SHORT = 1e-3  # [m] a stroke that can be run wherever any can
SMALL_OFFSET = 10e-3  # [m] a wrist offset below which the spin hardly moves joints 1 to 3 (theory §1)


def plan(robot: Robot, tool: Tool, hole: Hole, settings: Settings | None = None) -> HolePlan:
    """Find the best drilling motion of one hole, and check it independently.

    Args:
        robot: the arm.
        tool: the drill on its flange.
        hole: what to drill; a hole with a `profile` is evaluated, not searched.
        settings: how; None for the defaults.

    Returns:
        the motion with its score, the baseline with constant spin, the outcome of the check, and findings. A hole that
        cannot be drilled is an answer, too: its status is `infeasible`.
    """
    settings = settings or Settings()
    given = hole.profile is not None
    best = _given(robot, tool, hole, settings) if given else _searched(robot, tool, hole, settings)
    answer = _answered(robot, tool, hole, settings, "evaluated" if given else "planned", best)
    return replace(answer, deepest=deepest_as_drilled(robot, tool, hole, settings).depth)


def plan_deepest(robot: Robot, tool: Tool, hole: Hole, settings: Settings | None = None) -> HolePlan:
    """Find the deepest stroke of one hole that has no reversal, and the motion that reaches it, and check that.

    Args:
        robot: the arm.
        tool: the drill on its flange.
        hole: where to drill; its depth and a given motion are not looked at, its branch is the only one searched.
        settings: how; None for the defaults. Every joint keeps `min_rate` at every point, whatever the `min_rate_rule`.

    Returns:
        the motion as `plan` has it, its hole as deep as it goes. Where every stroke has a reversal, however short, the
        status is `infeasible` and the hole is as it was.
    """
    settings = settings or Settings()
    hole = replace(hole, profile=None)
    deepest = deepest_as_drilled(robot, tool, hole, settings)
    if deepest.profile is None or deepest.branch is None:
        findings = _why_none(robot, tool, hole, settings)
        return HolePlan(hole, "infeasible", wrist_offset(robot, tool), findings=findings, deepest=0.0)
    hole = replace(hole, depth=deepest.depth)
    evaluation = evaluate(robot, tool, hole, deepest.profile, deepest.branch, settings)
    best = deepest.profile, deepest.branch, evaluation
    return replace(_answered(robot, tool, hole, settings, "planned", best), deepest=deepest.depth)


_Best = tuple[Profile, int, Evaluation]


def _answered(
    robot: Robot,
    tool: Tool,
    hole: Hole,
    settings: Settings,
    status: Literal["planned", "evaluated"],
    best: _Best | None,
) -> HolePlan:
    """The answer that the best motion makes, with its baseline, checked, and with what a user should know of it."""
    offset = wrist_offset(robot, tool)
    if best is None:
        return HolePlan(hole, "infeasible", offset, findings=_why_infeasible(robot, tool, hole, settings))
    profile, branch, evaluation = best
    if evaluation.motion is None or evaluation.score is None:
        return HolePlan(hole, "infeasible", offset, findings=evaluation.findings)
    answer = HolePlan(
        hole=hole,
        status=status,
        wrist_offset=offset,
        motion=evaluation.motion,
        score=evaluation.score,
        measures=measure(robot, tool, hole, evaluation, settings),
        baseline=_baseline(robot, tool, hole, profile, branch, settings),
        critical_rates=_critical_rates(robot, tool, hole, profile, branch),
    )
    verified = verify_hole(robot, tool, settings, answer)
    answer = replace(answer, verified=verified)
    return replace(answer, findings=_findings(robot, settings, answer))


def _searched(robot: Robot, tool: Tool, hole: Hole, settings: Settings) -> _Best | None:
    """The best motion, its stand-off counted from the hole's own target where the corner is placed deeper."""
    drilled = _to_the_corner(hole, settings)
    motions = []
    found = (search_weighted if settings.weights else search)(robot, tool, drilled, settings)
    if found is not None:
        motions.append((found.profile, found.branch))
    free = search_free(robot, tool, drilled, settings) if settings.legs == "free" else None
    if free is not None:
        # what is straight is a free leg, too, within the greatest twist rate
        motions = [free, *(motion for motion in motions if np.abs(motion[0].twist_rate).max() <= settings.max_twist)]
    answers = [_evaluated(robot, tool, hole, settings, *motion) for motion in motions]
    return min(answers, key=lambda best: _rank(robot, tool, hole, settings, best), default=None)


def _evaluated(robot: Robot, tool: Tool, hole: Hole, settings: Settings, profile: Profile, branch: int) -> _Best:
    """A motion that was found for the hole down to the programmed corner, for the hole itself."""
    profile = Profile(profile.standoff + settings.corner, profile.psi)
    return profile, branch, evaluate(robot, tool, hole, profile, branch, settings)


def _rank(robot: Robot, tool: Tool, hole: Hole, settings: Settings, best: _Best) -> tuple[float, bool, float]:
    """The order of motions: fewest reversals, then the motion threshold, then what the settings ask to be least."""
    score = best[2].score
    if score is None:
        return np.inf, True, np.inf
    cost = float(np.dot(settings.reversal_weights, score.reversals_per_joint))
    measures = measure(robot, tool, hole, best[2], settings)
    return cost, not meets_threshold(score, settings), objective_of(settings)(measures)


def deepest_as_drilled(robot: Robot, tool: Tool, hole: Hole, settings: Settings) -> Deepest:
    """The deepest stroke, counted from the hole's own target where the corner is placed deeper."""
    found = deepest_stroke(robot, tool, _to_the_corner(replace(hole, profile=None), settings), settings)
    depth = found.depth + settings.corner
    if found.profile is None or depth <= 0:
        return Deepest(0.0)
    return replace(found, depth=depth, profile=Profile(found.profile.standoff + settings.corner, found.profile.psi))


def _to_the_corner(hole: Hole, settings: Settings) -> Hole:
    """The hole down to the programmed corner."""
    corner = settings.corner
    return replace(hole, target=hole.target - corner * hole.direction, depth=hole.depth - corner)


def _given(robot: Robot, tool: Tool, hole: Hole, settings: Settings) -> _Best:
    """The given motion on its branch, or on the best of all where none is given (by thesis eq. 4.7)."""
    assert hole.profile is not None
    profile = hole.profile
    branches = range(8) if hole.branch is None else (hole.branch,)
    evaluations = [evaluate(robot, tool, hole, profile, branch, settings) for branch in branches]
    best = min(range(len(evaluations)), key=lambda i: thesis_objective(evaluations[i]))
    return profile, branches[best], evaluations[best]


def _baseline(
    robot: Robot, tool: Tool, hole: Hole, profile: Profile, branch: int, settings: Settings
) -> Baseline | None:
    """The same hole drilled with psi = psi_start on the same branch, if that can be run."""
    constant = Profile(profile.standoff[[0, profile.corner, -1]], np.full(3, profile.psi[0]))
    score = evaluate(robot, tool, hole, constant, branch, settings).score
    return None if score is None else Baseline(score.reversals_per_joint, score.travel)


def _critical_rates(robot: Robot, tool: Tool, hole: Hole, profile: Profile, branch: int) -> Array:
    """The critical rates at the corner of the motion, which its legs bracket where no joint reverses there."""
    corner = profile.corner
    return critical(robot, tool, hole, branch, profile.psi[corner], standoff=profile.standoff[corner]).kappa


def _findings(robot: Robot, settings: Settings, answer: HolePlan) -> tuple[Finding, ...]:
    """What a user should know of a motion that can be run."""
    score, hole = answer.score, answer.hole
    assert score is not None
    assert answer.verified is not None
    found = []
    for event in score.events:
        place = "at the target" if event.leg == "target" else f"in the {event.leg}, {event.standoff * 1e3:.2f} mm out"
        found.append(Finding("warning", "reversal", f"{robot.joint_names[event.joint - 1]} reverses {place}", hole.id))
    if not meets_threshold(score, settings):
        steady = np.array(score.reversals_per_joint) == 0
        rates = score.min_rate if settings.min_rate_rule == "pointwise" else score.mean_rate
        slowest = int(np.argmin(np.where(steady, rates, np.inf)))
        what = "its slowest point" if settings.min_rate_rule == "pointwise" else "the average of a leg"
        message = (
            f"{robot.joint_names[slowest]} moves only {np.rad2deg(rates[slowest]) / 1e3:.5f} deg/mm at {what}, below"
            f" the motion threshold of {np.rad2deg(settings.min_rate) / 1e3:g} deg/mm"
        )
        if answer.status == "planned":
            message += "; this is the greatest margin that a motion with so few reversals has"
        found.append(Finding("warning", "threshold", message, hole.id))
    found += [Finding("error", "verification", failure, hole.id) for failure in answer.verified.failures]
    return tuple(found)


def lever_findings(robot: Robot, tool: Tool) -> tuple[Finding, ...]:
    """Findings of a whole job: a drill axis through or near the wrist centre leaves the spin no lever (theory §1).

    Args:
        robot: the arm.
        tool: the drill on its flange.
    """
    offset = wrist_offset(robot, tool)
    names = ", ".join(robot.joint_names[:3])
    if offset < 1e-6:
        message = f"the drill axis passes through the wrist centre (e = 0): spinning cannot move {names}, so it cannot"
        return (Finding("warning", "wrist_offset", message + " keep them from reversing; offset the tool", None),)
    if offset < SMALL_OFFSET:
        message = f"the wrist centre lies only {offset * 1e3:.2f} mm from the drill axis: the spin hardly moves {names}"
        return (Finding("warning", "wrist_offset", message + ", and zero reversals reach only small depths", None),)
    return ()


def _why_infeasible(robot: Robot, tool: Tool, hole: Hole, settings: Settings) -> tuple[Finding, ...]:
    """Which of reach, limits or the bound on the spin leaves no motion at all."""
    wide = replace(robot, limits=replace(robot.limits, lower=np.full(6, -4 * np.pi), upper=np.full(6, 4 * np.pi)))
    if can_run(wide, tool, hole, settings):
        spins = "" if settings.psi_bound is None else f" within +-{np.rad2deg(settings.psi_bound):g} deg of spin"
        message = f"no branch drills it within the joint limits{spins}"
        return (Finding("error", "limit", message, hole.id),)
    where = ", ".join(f"{value:.1f}" for value in hole.target * 1e3)
    message = f"out of reach: no branch and spin brings the tool along the axis at ({where}) mm"
    return (Finding("error", "unreachable", message, hole.id),)


def _why_none(robot: Robot, tool: Tool, hole: Hole, settings: Settings) -> tuple[Finding, ...]:
    """Why no stroke, however short, has zero reversals."""
    short = replace(hole, depth=SHORT)
    if not can_run(robot, tool, short, settings):
        return _why_infeasible(robot, tool, short, settings)
    rate = (
        f" while every joint moves {np.rad2deg(settings.min_rate) / 1e3:g} deg/mm or more" if settings.min_rate else ""
    )
    return (Finding("error", "no_stroke", f"no stroke, however short, is without a reversal{rate}", hole.id),)
