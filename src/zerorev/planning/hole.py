"""plan(robot, tool, hole) and plan_deepest(robot, tool, hole): the story."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Literal

import numpy as np

from zerorev.kernels._ahead import expect
from zerorev.model._arrays import Array
from zerorev.model.cycle import Cycle
from zerorev.model.finding import Finding
from zerorev.model.hole import Hole
from zerorev.model.job import Settings, check_robot
from zerorev.model.plan import Baseline, HolePlan, Motion, Optimality
from zerorev.model.profile import Profile
from zerorev.model.robot import Robot
from zerorev.model.tool import Tool
from zerorev.motion.criteria import measure, thesis_objective
from zerorev.motion.critical import critical
from zerorev.motion.drilling import Drilling
from zerorev.motion.evaluation import evaluated, meets_threshold
from zerorev.motion.kinematics import wrist_offset
from zerorev.motion.loads import lost_motion_of
from zerorev.planning.corner import corner_findings, corner_of, countersink_findings
from zerorev.planning.limit_findings import limit_findings
from zerorev.planning.load_findings import load_findings
from zerorev.planning.out_of_reach import shift_into_reach
from zerorev.planning.tool_turn import hole_turn
from zerorev.program.joint_speeds import pieces_of, too_fast
from zerorev.program.ways import Way
from zerorev.search.bounds.proof import MOST_REVERSALS
from zerorev.search.chip_break import chip_breaking
from zerorev.search.cut_short import cut_short
from zerorev.search.deepest import Deepest
from zerorev.search.exact import can_run
from zerorev.search.optimum import LEAST_STROKE, alternatives, deepest_as_drilled, optimum, too_short
from zerorev.search.rank import Candidate, Order
from zerorev.search.twins import gentlest_first
from zerorev.verify.check import verify_hole

__all__ = ["cycle_time", "lever_findings", "motion_findings", "plan", "plan_deepest", "with_another_motion"]

SHARES = (1.0, 0.999, 0.99, 0.97, 0.9, 0.8, 0.5, 0.25)  # of the deepest stroke, until one passes the check
# lengths for an arm of size 1 (`Robot.size`)
SHORT = 1e-3  # [m] a stroke that can be run wherever any can
NO_OFFSET = 1e-6  # [m]
SMALL_OFFSET = 10e-3  # [m] a wrist offset below which the spin hardly moves joints 1 to 3 (theory §1)


def plan(robot: Robot, tool: Tool, hole: Hole, settings: Settings | None = None) -> HolePlan:
    """Find the best drilling motion of one hole, and check it independently.

    Args:
        robot: the arm.
        tool: the drill on its flange.
        hole: what to drill; a hole with a `profile` is evaluated, not searched.
        settings: how; None for the defaults.

    Raises:
        InputError: a criterion weighs that the robot has no masses for.

    Returns:
        the motion with its score, the baseline with constant spin, the outcome of the check, and findings. A hole that
        cannot be drilled is an answer, too: its status is `infeasible`.
    """
    settings = settings or Settings()
    drilling = Drilling(robot, tool, hole, settings.limit_margin)
    expect(f"plan with {settings.legs} legs")
    check_robot(robot, settings)
    if too_short(drilling):
        return HolePlan(hole, "infeasible", drilling.wrist_offset, findings=(_why_too_short(robot, hole),))
    cycle = hole.drilled_by(settings.cycle)
    if hole.profile is None and cycle.kind == "chip_break":
        return _chip_breaking(drilling, settings, cycle)
    if hole.profile is None:
        found = optimum(drilling, settings)
        best = () if found.motion is None else gentlest_first(drilling, settings, found.motion)
        answer = _planned(drilling, settings, *best)
        if found.optimality is not None:
            answer = _with_optimality(drilling, settings, answer, best, found.optimality)
        return _with_deepest(answer, settings, found.deepest)
    answer = _evaluated(drilling, settings, hole.profile)
    return _with_deepest(answer, settings, deepest_as_drilled(drilling, settings))


def plan_deepest(robot: Robot, tool: Tool, hole: Hole, settings: Settings | None = None) -> HolePlan:
    """Find the deepest stroke of one hole that has no reversal, and the motion that reaches it, and check that.

    Args:
        robot: the arm.
        tool: the drill on its flange.
        hole: where to drill; its branch is the only one searched. Where its depth, or the motion that it gives, has no
            reversal, the stroke is no less deep; else neither matters.
        settings: how; None for the defaults. Every joint keeps `min_rate` at every point, regardless of the
            `min_rate_rule`.

    Returns:
        the motion as `plan` has it, its hole as deep as it goes. Where every stroke has a reversal, however short, the
        status is `infeasible` and the hole is as it was.
    """
    settings = settings or Settings()
    drilling = Drilling(robot, tool, hole, settings.limit_margin)
    expect(f"deepest stroke with {settings.legs} legs")
    check_robot(robot, settings)
    deepest = deepest_as_drilled(drilling, settings)
    drilling = drilling.without_motion()
    hole = drilling.hole
    if deepest.profile is None or deepest.branch is None:
        findings = _why_none(drilling, settings)
        answer = HolePlan(hole, "infeasible", drilling.wrist_offset, findings=findings)
        return _with_deepest(answer, settings, deepest)
    why = None
    for share in SHARES:
        shorter = drilling.deep(share * deepest.depth)
        cut = Order(shorter, settings).candidate(cut_short(deepest.profile, shorter.hole.depth), deepest.branch)
        answer = _passing(shorter, settings, () if cut is None else gentlest_first(shorter, settings, cut))
        if answer.verified is not None and answer.verified.passed:
            found = () if why is None else (_rejected("a deeper motion without a reversal", why, hole),)
            answer = replace(answer, findings=(*answer.findings, *found))
            return _with_deepest(answer, settings, replace(deepest, depth=shorter.hole.depth))
        why = why or (answer.verified.failures[0] if answer.verified else "it cannot be run")
    none = _none_passes(
        drilling, f"no stroke without a reversal was found that passes the check; of the deepest one: {why}"
    )
    return replace(none, deepest=0.0)


def _rejected(what: str, why: str, hole: Hole) -> Finding:
    """That something better was found which does not pass the check."""
    return Finding("warning", "rejected", f"{what} was found, but does not pass the check: {why}", hole.id)


def _passing(drilling: Drilling, settings: Settings, motions: Sequence[Candidate]) -> HolePlan:
    """The answer that the first of some motions makes which passes the check, or else the last one."""
    answer = None
    for motion in motions:
        answer = _answered(drilling, settings, "planned", motion)
        if answer.verified is not None and answer.verified.passed:
            break
    return answer or _answered(drilling, settings, "planned", None)


def _planned(drilling: Drilling, settings: Settings, *best: Candidate) -> HolePlan:
    """The answer that the best motions make; where none passes the check, the best one found that does.

    Args:
        drilling: what is drilled.
        settings: how.
        best: motions that cost the same, the one to be preferred first.
    """
    answer = _passing(drilling, settings, best)
    if answer.verified is None or answer.verified.passed:
        return answer
    why = answer.verified.failures[0]
    for other in alternatives(drilling, settings):
        tried = _answered(drilling, settings, "planned", other)
        if tried.verified is not None and tried.verified.passed:
            assert answer.score is not None
            rejected = _rejected(f"a motion with {answer.score.reversals} reversals", why, drilling.hole)
            return replace(tried, findings=(*tried.findings, rejected))
    return _none_passes(drilling, f"no motion was found that passes the check; of the best one: {why}")


def _chip_breaking(drilling: Drilling, settings: Settings, cycle: Cycle) -> HolePlan:
    """The answer with the best motion found that breaks chips and passes the check."""
    found = chip_breaking(drilling, settings, cycle)
    answer = _passing(drilling, settings, found)
    if answer.verified is None or answer.verified.passed:
        return answer
    why = answer.verified.failures[0]
    return _none_passes(
        drilling, f"no motion that breaks chips was found that passes the check; of the last one: {why}"
    )


def _none_passes(drilling: Drilling, message: str) -> HolePlan:
    """The answer of a hole of which no motion passes the check."""
    findings = (Finding("error", "verification", message, drilling.hole.id),)
    return HolePlan(drilling.hole, "infeasible", drilling.wrist_offset, findings=findings)


def _answered(
    drilling: Drilling,
    settings: Settings,
    status: Literal["planned", "evaluated"],
    best: Candidate | None,
) -> HolePlan:
    """The answer that the best motion makes, with its baseline, checked, and with what a user should know of it."""
    robot, tool, hole, offset = drilling.robot, drilling.tool, drilling.hole, drilling.wrist_offset
    if best is None:
        return HolePlan(hole, "infeasible", offset, findings=_why_infeasible(drilling, settings))
    answer = HolePlan(
        hole=hole,
        status=status,
        wrist_offset=offset,
        motion=best.evaluation.motion,
        score=best.score,
        measures=measure(drilling, best.evaluation, settings),
        baseline=_baseline(drilling, best.profile, best.branch, settings),
        critical_rates=_critical_rates(drilling, best.profile, best.branch),
        lost_motion=lost_motion_of(drilling, best.profile, best.branch, settings.thrust),
    )
    assert answer.motion is not None
    answer = replace(
        answer,
        corner=corner_of(drilling, settings, answer.motion),
        cycle_time=cycle_time(drilling, settings, answer.motion),
    )
    answer = replace(answer, verified=verify_hole(robot, tool, settings, answer))
    return replace(answer, findings=motion_findings(drilling, settings, answer))


def with_another_motion(drilling: Drilling, settings: Settings, answer: HolePlan, motion: Candidate) -> HolePlan:
    """The answer of a hole with another of its good motions, checked: what is known of the hole itself stays.

    Args:
        drilling: what is drilled.
        settings: how.
        answer: with the best motion of the hole, planned.
        motion: the other one, counted from the hole's own target.
    """
    again = _answered(drilling, settings, "planned", motion)
    of_the_motion = motion_findings(drilling, settings, answer)
    optimality = answer.optimality
    if optimality is not None and optimality.travel_at_least is not None and optimality.gap is not None:
        gap = 1 - optimality.travel_at_least / motion.score.travel if motion.score.travel > 0 else optimality.gap
        optimality = replace(optimality, gap=gap)
    again = replace(again, optimality=optimality, deepest=answer.deepest, deepest_at_most=answer.deepest_at_most)
    others = tuple(finding for finding in answer.findings if finding not in of_the_motion)
    return replace(again, findings=(*motion_findings(drilling, settings, again), *others))


def cycle_time(drilling: Drilling, settings: Settings, motion: Motion) -> float:
    """Time of the hole's own linear moves at their feeds [s], from the approach to the retract.

    What speeding up and stopping take is left out.

    Args:
        drilling: what is drilled.
        settings: with the feeds.
        motion: of the hole.
    """
    profile, way = motion.profile, Way.of(drilling, motion, settings)
    slow = min(settings.breakthrough_length - float(profile.standoff.min()), float(profile.standoff[0]))
    slow = slow if settings.breakthrough_length > 0 and settings.breakthrough_feed is not None else 0.0
    inwards = way.lead_in.length + float(profile.distance[profile.corner]) - slow
    outwards = float(profile.distance[-1] - profile.distance[profile.corner])
    in_the_air = way.approach.length + way.retract.length
    last = slow / settings.feed_inwards(0.0)
    return inwards / settings.feed_plunge + last + (outwards + in_the_air) / settings.feed_retract


def _evaluated(drilling: Drilling, settings: Settings, profile: Profile) -> HolePlan:
    """The answer to a given motion on its branch; where none is given, on the one that thesis eq. 4.7 prefers.

    Which branch a published motion belongs to does not depend on the motion threshold, so the thesis' own objective
    answers it, and not the order by which motions are searched for.
    """
    branches = range(8) if drilling.hole.branch is None else (drilling.hole.branch,)
    order = Order(drilling, settings)
    evaluations = {branch: evaluated(drilling, profile, branch, settings) for branch in branches}
    branch = min(branches, key=lambda branch: thesis_objective(evaluations[branch]))
    best = order.judged(profile, branch, evaluations[branch])
    if best is not None:
        return _answered(drilling, settings, "evaluated", best)
    return HolePlan(drilling.hole, "infeasible", drilling.wrist_offset, findings=evaluations[branch].findings)


def _baseline(drilling: Drilling, profile: Profile, branch: int, settings: Settings) -> Baseline | None:
    """The same hole drilled with psi = psi_start on the same branch, if that can be run."""
    score = evaluated(drilling, profile.at_constant_spin(), branch, settings).score
    return None if score is None else Baseline(score.reversals_per_joint, score.travel)


def _critical_rates(drilling: Drilling, profile: Profile, branch: int) -> Array:
    """The critical rates at the corner of the motion, which its legs bracket where no joint reverses there."""
    corner = profile.corner
    return critical(drilling, branch, profile.psi[corner], standoff=profile.standoff[corner]).kappa


def motion_findings(drilling: Drilling, settings: Settings, answer: HolePlan) -> tuple[Finding, ...]:
    """What a user should know of a motion that can be run."""
    robot, score, hole = drilling.robot, answer.score, answer.hole
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
            if answer.optimality is not None and answer.optimality.proven:
                message += ", which no motion of straight legs with so few reversals keeps (proven)"
            message += "; no motion with so few reversals was found that keeps more"
        found.append(Finding("warning", "threshold", message, hole.id))
    assert answer.motion is not None
    way = Way.of(drilling, answer.motion, settings)
    found += limit_findings(drilling, answer, way)
    found += hole_turn(answer, way.lead_in)
    found += load_findings(drilling, settings, answer)
    found += corner_findings(settings, answer)
    # export refuses it; here it is known while the feed can still be chosen
    found += too_fast(drilling, answer.motion.branch, pieces_of(settings, answer.motion), "warning")
    found += countersink_findings(settings, answer)
    found += [Finding("error", "verification", failure, hole.id) for failure in answer.verified.failures]
    return tuple(found)


def _with_optimality(
    drilling: Drilling, settings: Settings, answer: HolePlan, best: Sequence[Candidate], optimality: Optimality
) -> HolePlan:
    """The answer with what is proven of it, and with findings that say what of them is proven.

    Of a motion that took the place of the best, which did not pass the check, only the bounds are known.
    """
    if answer.score is not None and not any(answer.score is motion.score for motion in best):
        return replace(answer, optimality=replace(optimality, travel_at_least=None, gap=None, proven=False))
    proven = replace(answer, optimality=optimality)
    if answer.motion is None:
        findings = [
            replace(
                finding,
                message=f"{finding.message} (proven for straight legs with at most {MOST_REVERSALS:g} reversals)",
            )
            if optimality.proven and finding.kind in ("limit", "unreachable")
            else finding
            for finding in answer.findings
        ]
        return replace(proven, findings=tuple(findings))
    before, after = (motion_findings(drilling, settings, each) for each in (answer, proven))
    return replace(proven, findings=(*after, *(each for each in answer.findings if each not in before)))


def _with_deepest(answer: HolePlan, settings: Settings, deepest: Deepest) -> HolePlan:
    """The answer with its deepest stroke, and what a user should know of that."""
    found, hole = list(answer.findings), answer.hole.id
    if settings.min_rate_rule == "mean" and settings.min_rate > 0 and deepest.depth > 0:
        message = "the deepest stroke is a lower bound: it keeps the motion threshold at every point"
        found.append(Finding("info", "deepest", message, hole))
    if deepest.beyond_cap > deepest.depth:
        message = (
            f"straight legs that turn the tool by more than {np.rad2deg(settings.max_twist) / 1e3:g} deg/mm drill"
            f" {deepest.beyond_cap * 1e3:.3f} mm without a reversal, free legs within it {deepest.depth * 1e3:.3f} mm"
        )
        found.append(Finding("info", "deepest", message, hole))
    return replace(answer, deepest=deepest.depth, deepest_at_most=deepest.at_most, findings=tuple(found))


def lever_findings(robot: Robot, tool: Tool) -> tuple[Finding, ...]:
    """Findings of a whole job: a drill axis through or near the wrist centre leaves the spin no lever (theory §1).

    Args:
        robot: the arm.
        tool: the drill on its flange.
    """
    offset = wrist_offset(robot, tool)
    names = ", ".join(robot.joint_names[:3])
    if offset < NO_OFFSET * robot.size:
        message = f"the drill axis passes through the wrist centre (e = 0): spinning cannot move {names}, so it cannot"
        return (Finding("warning", "wrist_offset", message + " keep them from reversing; offset the tool", None),)
    if offset < SMALL_OFFSET * robot.size:
        message = f"the wrist centre lies only {offset * 1e3:.2f} mm from the drill axis: the spin hardly moves {names}"
        return (Finding("warning", "wrist_offset", message + ", and zero reversals reach only small depths", None),)
    return ()


def _why_infeasible(drilling: Drilling, settings: Settings) -> tuple[Finding, ...]:
    """Which of reach, limits or the bound on the spin leaves no motion at all."""
    limits = replace(drilling.robot.limits, lower=np.full(6, -4 * np.pi), upper=np.full(6, 4 * np.pi))
    free = replace(drilling, robot=replace(drilling.robot, limits=limits), limit_margin=0.0)
    if can_run(free, settings):
        spins = "" if settings.psi_bound is None else f" within +-{np.rad2deg(settings.psi_bound):g} deg of spin"
        message = f"no branch drills it within the joint limits{spins}"
        if settings.limit_margin:
            message += f" and {np.rad2deg(settings.limit_margin):g} deg away from them (limit_margin_deg)"
            if can_run(replace(drilling, limit_margin=0.0), settings):
                message += "; nearer to them there is a motion"
        if settings.keep_lead_in and can_run(drilling, settings):
            message = (
                f"no motion was found whose whole lead-in of {settings.lead_in * 1e3:g} mm runs without a reversal"
            )
            return (Finding("error", "lead_in", message, drilling.hole.id),)
        return (Finding("error", "limit", message, drilling.hole.id),)
    where = ", ".join(f"{value:.1f}" for value in drilling.hole.target * 1e3)
    message = f"no branch and spin brings the tool along the axis at ({where}) mm"
    shift = shift_into_reach(drilling)
    if shift is None:
        return (Finding("error", "unreachable", f"out of reach: {message}", drilling.hole.id),)
    way = ", ".join(f"{value:.0f}" for value in (shift * 1e3).round() + 0.0)
    message = f"out of reach by {np.linalg.norm(shift) * 1e3:.0f} mm: {message}; moved by ({way}) mm it is within reach"
    return (Finding("error", "unreachable", message, drilling.hole.id),)


def _why_too_short(robot: Robot, hole: Hole) -> Finding:
    """That a stroke is too short for figures that mean anything."""
    least = np.format_float_positional(LEAST_STROKE * robot.reach * 1e3, 2, fractional=False)
    message = f"a depth of {hole.depth * 1e3:g} mm is too short: on this arm it takes {least} mm or more to be checked"
    return Finding("error", "depth", message, hole.id)


def _why_none(drilling: Drilling, settings: Settings) -> tuple[Finding, ...]:
    """Why no stroke, however short, has zero reversals."""
    short = drilling.deep(SHORT * drilling.robot.size)
    if not can_run(short, settings):
        return _why_infeasible(short, settings)
    rate = (
        f" while every joint moves {np.rad2deg(settings.min_rate) / 1e3:g} deg/mm or more" if settings.min_rate else ""
    )
    return (Finding("error", "no_stroke", f"no stroke, however short, is without a reversal{rate}", drilling.hole.id),)
