"""plan(robot, tool, hole) and plan_deepest(robot, tool, hole): the story."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from zerorev.kernels._ahead import expect
from zerorev.model.cycle import Cycle
from zerorev.model.finding import Finding
from zerorev.model.hole import Hole
from zerorev.model.job import Settings, check_robot
from zerorev.model.plan import HolePlan, Optimality
from zerorev.model.profile import Profile
from zerorev.model.robot import Robot
from zerorev.model.tool import Tool
from zerorev.motion.criteria import thesis_objective
from zerorev.motion.drilling import Drilling
from zerorev.motion.evaluation import evaluated
from zerorev.motion.kinematics import wrist_offset
from zerorev.planning.answered import answered, motion_findings
from zerorev.planning.clearance import none_clear
from zerorev.planning.pecks import pecked
from zerorev.planning.why_none import why_none, why_too_short
from zerorev.search.bounds.proof import MOST_REVERSALS
from zerorev.search.chip_break import chip_breaking, straight_motions
from zerorev.search.clear import clear_of
from zerorev.search.cut_short import cut_short
from zerorev.search.cycles import chip_breaks, deepest_in_cycle, motions_that_break, raised, shallower
from zerorev.search.deepest import Deepest
from zerorev.search.optimum import alternatives, optimum, too_short
from zerorev.search.rank import Candidate, Order
from zerorev.search.spin import TIMES, spinning
from zerorev.search.twins import gentlest_first

__all__ = ["evaluated_stroke", "lever_findings", "plan", "plan_deepest"]

PASSING = 6  # motions of which the best that passes the check is taken, for each time that the tool spins on
SHARES = (1.0, 0.999, 0.99, 0.97, 0.9, 0.8, 0.5, 0.25)  # of the deepest stroke, until one passes the check
# lengths for an arm of size 1 (`Robot.size`)
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
    settings = (settings or Settings()).of(hole)
    drilling = Drilling(robot, tool, hole, settings.limit_margin)
    expect(f"plan with {settings.legs} legs")
    check_robot(robot, settings)
    if too_short(drilling):
        return HolePlan(hole, "infeasible", drilling.wrist_offset, findings=(why_too_short(robot, hole),))
    cycle = hole.drilled_by(settings.cycle)
    if hole.profile is None and settings.turning.kind == "spin":
        return _spinning(drilling, settings, cycle)
    if hole.profile is None and cycle.kind == "chip_break":
        return _chip_breaking(drilling, settings, cycle, deepest_in_cycle(drilling, settings))
    if hole.profile is None and len(cycle.strokes(hole.depth)) > 1:
        return _with_deepest(pecked(drilling, settings, cycle), settings, deepest_in_cycle(drilling, settings))
    if hole.profile is None:
        found = optimum(drilling, settings)
        best = () if found.motion is None else gentlest_first(drilling, settings, found.motion)
        best, hit = clear_of(drilling, settings, best)
        if hit is not None and not best:
            return _with_deepest(none_clear(drilling, settings, hit), settings, found.deepest)
        answer = _planned(drilling, settings, *best)
        if found.optimality is not None:
            answer = _with_optimality(drilling, settings, answer, best, found.optimality)
        return _with_deepest(answer, settings, found.deepest)
    answer = _evaluated(drilling, settings, hole.profile)
    return _with_deepest(answer, settings, deepest_in_cycle(drilling, settings))


def evaluated_stroke(robot: Robot, tool: Tool, hole: Hole, settings: Settings) -> HolePlan:
    """The answer of a stroke whose motion is given; of its hole nothing else is asked.

    Args:
        robot: the arm.
        tool: the drill.
        hole: which ends where the stroke does, with the motion and its branch.
        settings: how.
    """
    assert hole.profile is not None
    return _evaluated(Drilling(robot, tool, hole, settings.limit_margin), settings, hole.profile)


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
        the motion as `plan` has it, its hole as deep as it goes; of a hole that is drilled in several strokes that of
        one, which goes all the way. Where every stroke has a reversal, however short, the status is `infeasible` and
        the hole is as it was.
    """
    cycle = hole.drilled_by((settings or Settings()).cycle)
    hole = hole if cycle.of_one_stroke is cycle else replace(hole, cycle=cycle.of_one_stroke)
    settings = (settings or Settings()).of(hole)
    drilling = Drilling(robot, tool, hole, settings.limit_margin)
    expect(f"deepest stroke with {settings.legs} legs")
    check_robot(robot, settings)
    if settings.turning.kind == "spin":
        message = "the deepest stroke is not sought where the tool spins on at the target: ask for it without moving"
        said = Finding("error", "deepest", message, hole.id)
        return HolePlan(hole, "infeasible", drilling.wrist_offset, findings=(said,))
    deepest = deepest_in_cycle(drilling, settings)
    drilling = drilling.without_motion()
    hole = drilling.hole
    if deepest.profile is None or deepest.branch is None:
        findings = why_none(drilling, settings)
        answer = HolePlan(hole, "infeasible", drilling.wrist_offset, findings=findings)
        return _with_deepest(answer, settings, deepest)
    why = None
    for share in SHARES:
        shorter = drilling.deep(share * deepest.depth)
        answer = _passing(shorter, settings, _as_deep(shorter, settings, deepest))
        if answer.verified is not None and answer.verified.passed:
            found = () if why is None else (_rejected("a deeper motion without a reversal", why, hole),)
            answer = replace(answer, findings=(*answer.findings, *found))
            return _with_deepest(answer, settings, replace(deepest, depth=shorter.hole.depth))
        why = why or (answer.verified.failures[0] if answer.verified else "it cannot be run")
    none = _none_passes(
        drilling, f"no stroke without a reversal was found that passes the check; of the deepest one: {why}"
    )
    return replace(none, deepest=0.0)


def _as_deep(drilling: Drilling, settings: Settings, deepest: Deepest) -> tuple[Candidate, ...]:
    """The deepest motion made as short as the hole, and the one of its likes that its gears disturb least."""
    assert deepest.profile is not None
    assert deepest.branch is not None
    if chip_breaks(drilling, settings) is not None:
        found = shallower(drilling, settings, deepest)
        return () if found is None else (found,)
    cut = Order(drilling, settings).candidate(cut_short(deepest.profile, drilling.hole.depth), deepest.branch)
    return () if cut is None else gentlest_first(drilling, settings, cut)


def _rejected(what: str, why: str, hole: Hole) -> Finding:
    """That something better was found which does not pass the check."""
    return Finding("warning", "rejected", f"{what} was found, but does not pass the check: {why}", hole.id)


def _passing(drilling: Drilling, settings: Settings, motions: Sequence[Candidate]) -> HolePlan:
    """The answer that the first of some motions makes which passes the check, or else the last one."""
    answer = None
    for motion in motions:
        answer = answered(drilling, settings, "planned", motion)
        if answer.verified is not None and answer.verified.passed:
            break
    return answer or answered(drilling, settings, "planned", None)


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
        tried = answered(drilling, settings, "planned", other)
        if tried.verified is not None and tried.verified.passed:
            assert answer.score is not None
            rejected = _rejected(f"a motion with {answer.score.reversals} reversals", why, drilling.hole)
            return replace(tried, findings=(*tried.findings, rejected))
    return _none_passes(drilling, f"no motion was found that passes the check; of the best one: {why}")


def _chip_breaking(drilling: Drilling, settings: Settings, cycle: Cycle, deepest: Deepest) -> HolePlan:
    """The answer with the best motion found that breaks chips and passes the check."""
    answer = _passing(drilling, settings, motions_that_break(drilling, settings, cycle, deepest))
    if answer.verified is not None and not answer.verified.passed:
        why = answer.verified.failures[0]
        answer = _none_passes(
            drilling, f"no motion that breaks chips was found that passes the check; of the last one: {why}"
        )
    found = None if answer.motion is None else answer.motion.profile
    return _with_deepest(answer, settings, raised(drilling, settings, cycle, deepest, found))


def _spinning(drilling: Drilling, settings: Settings, cycle: Cycle) -> HolePlan:
    """The answer with the best motion found that spins on at the target as long as it can, and passes the check."""
    if cycle.kind == "chip_break":
        known = chip_breaking(drilling, settings, cycle)
    else:
        known = list(straight_motions(drilling, settings))
    if not known:
        return answered(drilling, settings, "planned", None)
    why = "none can be run"
    for share in TIMES:
        answer = _passing(drilling, settings, spinning(drilling, settings, known, share * cycle.dwell)[:PASSING])
        if answer.verified is not None and answer.verified.passed:
            return answer
        if answer.verified is not None:
            why = answer.verified.failures[0]
    return _none_passes(
        drilling, f"no motion was found on which the tool spins on at the target and that passes the check: {why}"
    )


def _none_passes(drilling: Drilling, message: str) -> HolePlan:
    """The answer of a hole of which no motion passes the check."""
    findings = (Finding("error", "verification", message, drilling.hole.id),)
    return HolePlan(drilling.hole, "infeasible", drilling.wrist_offset, findings=findings)


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
        return answered(drilling, settings, "evaluated", best)
    return HolePlan(drilling.hole, "infeasible", drilling.wrist_offset, findings=evaluations[branch].findings)


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
    if answer.hole.drilled_by(settings.cycle).kind == "chip_break" and deepest.depth > 0:
        message = "the deepest stroke that breaks chips is what was found: that none is deeper is not proven"
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
