"""plan(robot, tool, hole) and plan_job(job): the story."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from zerorev.evaluation import Evaluation, evaluate, meets_threshold, thesis_objective
from zerorev.kinematics import wrist_offset
from zerorev.model.hole import Hole
from zerorev.model.job import Job, Settings
from zerorev.model.plan import Baseline, Finding, HolePlan, Plan
from zerorev.model.profile import Profile
from zerorev.model.robot import Robot
from zerorev.model.tool import Tool
from zerorev.search.exact import can_run, search
from zerorev.verify.check import verify_hole

__all__ = ["plan", "plan_job"]

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
    offset = wrist_offset(robot, tool)
    given = hole.profile is not None
    best = _given(robot, tool, hole, settings) if given else _searched(robot, tool, hole, settings)
    if best is None:
        return HolePlan(hole, "infeasible", offset, findings=_why_infeasible(robot, tool, hole, settings))
    profile, branch, evaluation = best
    if evaluation.motion is None or evaluation.score is None:
        return HolePlan(hole, "infeasible", offset, findings=evaluation.findings)
    answer = HolePlan(
        hole=hole,
        status="evaluated" if given else "planned",
        wrist_offset=offset,
        motion=evaluation.motion,
        score=evaluation.score,
        baseline=_baseline(robot, tool, hole, profile, branch, settings),
    )
    verified = verify_hole(robot, tool, settings, answer)
    answer = replace(answer, verified=verified)
    return replace(answer, findings=_findings(robot, settings, answer))


def plan_job(job: Job, progress: Callable[[int, int], None] | None = None) -> Plan:
    """Plan every hole of a job; what is wrong with one hole is a finding, and the others are still planned.

    Args:
        job: robot, tool, holes, settings.
        progress: called with (holes done, holes in all) before the first and after each hole.
    """
    answers: list[HolePlan] = []
    for hole in job.holes:
        if progress:
            progress(len(answers), len(job.holes))
        answers.append(plan(job.robot, job.tool, hole, job.settings))
    if progress:
        progress(len(answers), len(job.holes))
    return Plan(
        robot=job.robot,
        tool=job.tool,
        settings=job.settings,
        holes=tuple(answers),
        T_base_part=job.T_base_part,
        name=job.name,
        findings=_lever_findings(job.robot, job.tool),
    )


_Best = tuple[Profile, int, Evaluation]


def _searched(robot: Robot, tool: Tool, hole: Hole, settings: Settings) -> _Best | None:
    """The best motion, its stand-off counted from the hole's own target where the corner is placed deeper."""
    corner = settings.corner
    deeper = replace(hole, target=hole.target - corner * hole.direction, depth=hole.depth - corner)
    found = search(robot, tool, deeper, settings)
    if found is None:
        return None
    profile = Profile(found.profile.standoff + corner, found.profile.psi)
    return profile, found.branch, evaluate(robot, tool, hole, profile, found.branch, settings)


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


def _lever_findings(robot: Robot, tool: Tool) -> tuple[Finding, ...]:
    """A drill axis through the wrist centre, or close to it, leaves the spin no lever (theory §1)."""
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
