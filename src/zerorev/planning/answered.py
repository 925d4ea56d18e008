"""The answer that a motion makes: checked, with its baseline, its corner, and what a user should know of it."""

from __future__ import annotations

from dataclasses import replace
from typing import Literal

import numpy as np

from zerorev.model._arrays import Array
from zerorev.model.corner import known_controller
from zerorev.model.finding import Finding
from zerorev.model.job import Settings
from zerorev.model.plan import Baseline, Corner, HolePlan, Motion
from zerorev.model.profile import Profile
from zerorev.motion.criteria import measure
from zerorev.motion.critical import critical
from zerorev.motion.drilling import Drilling
from zerorev.motion.evaluation import evaluated, meets_threshold
from zerorev.motion.loads import lost_motion_of
from zerorev.planning.clearance import clearance_findings, clearance_of
from zerorev.planning.corner import corner_findings, corner_of, countersink_findings
from zerorev.planning.limit_findings import limit_findings
from zerorev.planning.load_findings import load_findings
from zerorev.planning.tool_turn import hole_turn
from zerorev.planning.why_none import why_infeasible
from zerorev.program.joint_speeds import pieces_of, too_fast, turns_fast
from zerorev.program.stroke_points import moves_of
from zerorev.program.ways import Way
from zerorev.search.rank import Candidate
from zerorev.verify.check import verify_hole

__all__ = ["answered", "cycle_time", "motion_findings", "with_another_motion"]


def answered(
    drilling: Drilling,
    settings: Settings,
    status: Literal["planned", "evaluated"],
    best: Candidate | None,
) -> HolePlan:
    """The answer that the best motion makes, with its baseline, checked, and with what a user should know of it."""
    robot, tool, hole, offset = drilling.robot, drilling.tool, drilling.hole, drilling.wrist_offset
    if best is None:
        return HolePlan(hole, "infeasible", offset, findings=why_infeasible(drilling, settings))
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
    corner = corner_of(drilling, settings, answer.motion)
    answer = replace(
        answer,
        corner=corner,
        cycle_time=cycle_time(drilling, settings, answer.motion, corner),
        feeds=(settings.feed_plunge, settings.feed_retract),
        clearance=clearance_of(drilling, settings, answer.motion),
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
    settings = settings.of(drilling.hole)
    again = answered(drilling, settings, "planned", motion)
    of_the_motion = motion_findings(drilling, settings, answer)
    optimality = answer.optimality
    if optimality is not None and optimality.travel_at_least is not None and optimality.gap is not None:
        gap = 1 - optimality.travel_at_least / motion.score.travel if motion.score.travel > 0 else optimality.gap
        optimality = replace(optimality, gap=gap)
    again = replace(again, optimality=optimality, deepest=answer.deepest, deepest_at_most=answer.deepest_at_most)
    others = tuple(finding for finding in answer.findings if finding not in of_the_motion)
    return replace(again, findings=(*motion_findings(drilling, settings, again), *others))


def cycle_time(drilling: Drilling, settings: Settings, motion: Motion, corner: Corner) -> float:
    """Time of the hole's own moves at their feeds [s], from the approach to the retract, and of the dwell.

    What speeding up and stopping take is left out.

    Args:
        drilling: what is drilled.
        settings: with the feeds.
        motion: of the hole.
        corner: how it turns round.
    """
    way, own = Way.of(drilling, motion, settings), settings.of(drilling.hole)
    moves = moves_of(own, motion, corner, way)
    return sum(abs(end.standoff - begin.standoff) / feed for begin, end, feed in moves) + own.standing


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
    settings = settings.of(hole)
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
    pieces = pieces_of(settings, answer.motion, answer.corner, way)
    found += too_fast(drilling, answer.motion.branch, pieces, "warning")
    found += turns_fast(hole.id, pieces, known_controller(settings.controller).turn_speed)
    found += countersink_findings(settings, answer)
    found += clearance_findings(drilling, settings, answer)
    found += [Finding("error", "verification", failure, hole.id) for failure in answer.verified.failures]
    return tuple(found)
