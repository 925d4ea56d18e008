"""Holes that are drilled in several strokes: each stroke as a hole of its own, and all of them as one again.

A stroke is planned, checked, certified and written as a program as any hole is: as the hole that ends where it does.
What deals with single motions is given a plan of strokes (`by_stroke`), and what it finds is put together (`together`).
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import replace

import numpy as np

from zerorev.model._arrays import Array
from zerorev.model.cycle import Cycle
from zerorev.model.finding import Finding
from zerorev.model.hole import Hole
from zerorev.model.plan import (
    Baseline,
    Certificate,
    Event,
    HolePlan,
    Motion,
    Plan,
    Score,
    Stroke,
    Verification,
    Within,
)
from zerorev.model.profile import Profile

__all__ = [
    "by_stroke", "each_stroke", "ids_of_strokes", "of_strokes", "shifted", "stroke_by_stroke", "stroke_hole",
    "stroke_id", "together",
]  # fmt: skip


def stroke_hole(hole: Hole, number: int, depth: float, motion: Motion | None = None, dwell: float = 0.0) -> Hole:
    """The hole that ends where a stroke of a hole does.

    Args:
        hole: all of it.
        number: of the stroke, from 1.
        depth: of the stroke [m].
        motion: of the stroke, stand-offs counted from where it ends; None: it is still to be found.
        dwell: of the tool at the target of the hole; only the last stroke gets there [s].
    """
    return replace(
        hole,
        id=stroke_id(hole.id, number),
        target=hole.target + (depth - hole.depth) * hole.direction,
        depth=depth,
        profile=None if motion is None else motion.profile,
        branch=hole.branch if motion is None else motion.branch,
        cycle=Cycle(dwell=dwell if depth == hole.depth else 0.0),
    )


def stroke_id(hole_id: str, number: int) -> str:
    """How a stroke is called, by the id of its hole and its number, from 1."""
    return f"{hole_id}, stroke {number}"


def each_stroke(answer: HolePlan) -> tuple[HolePlan, ...]:
    """The answers of a hole's strokes; of one that has no others the hole's own."""
    return tuple(stroke.answer for stroke in answer.strokes) or (answer,)


def shifted(motion: Motion, by: float) -> Motion:
    """A motion with its stand-offs counted from another place on the same axis.

    Args:
        motion: of a hole.
        by: added to its stand-offs [m].
    """
    return replace(motion, profile=Profile(motion.profile.standoff + by, motion.profile.psi))


def of_strokes(
    hole: Hole,
    strokes: Sequence[Stroke],
    *,
    cycle_time: float | None,
    deepest: float | None = None,
    deepest_at_most: float | None = None,
    findings: Sequence[Finding] = (),
) -> HolePlan:
    """The answer of a hole that is drilled in several strokes.

    Args:
        hole: all of it.
        strokes: in order; each has a motion.
        cycle_time: of strokes and the moves between them [s].
        deepest: stroke without a reversal [m], or None.
        deepest_at_most: no deeper one is without a reversal [m], or None.
        findings: of the hole, besides those of its strokes.
    """
    answers = [stroke.answer for stroke in strokes]
    first = answers[0]
    assert first.motion is not None
    lost = [answer.lost_motion for answer in answers if answer.lost_motion is not None]
    answer = HolePlan(
        hole=hole,
        status="planned",
        wrist_offset=first.wrist_offset,
        motion=shifted(first.motion, hole.depth - first.hole.depth),
        score=_score(hole, answers),
        baseline=_baseline(answers),
        findings=(*findings, *_findings(hole, answers)),
        deepest=deepest,
        deepest_at_most=deepest_at_most,
        critical_rates=first.critical_rates,
        lost_motion=max(lost, key=lambda each: each.at_tip, default=None),
        corner=first.corner,
        feeds=first.feeds,
        cycle_time=cycle_time,
        strokes=tuple(strokes),
    )
    return _with_proofs(answer)


def stroke_by_stroke(plan: Plan, work: Callable[[Plan], Plan]) -> Plan:
    """A plan as what is found of its single strokes makes it.

    Args:
        plan: any.
        work: takes a plan, of one tool, of which each stroke is a hole of its own, and gives it back with what was
            found.
    """
    further = tuple(stroke_by_stroke(each, work) for each in plan.further)
    return replace(together(plan, work(by_stroke(plan))), further=further)


def by_stroke(plan: Plan) -> Plan:
    """A plan of which each stroke of the first tool is a hole of its own; one without holes of several as it is.

    Args:
        plan: any.
    """
    if not any(hole.strokes for hole in plan.holes):
        return plan
    order = [hole.hole.id for answer in plan.in_order if answer.hole.id in plan.order for hole in each_stroke(answer)]
    holes = tuple(each for answer in plan.holes for each in each_stroke(answer))
    return replace(plan, holes=holes, order=tuple(order), transitions=())


def ids_of_strokes(plan: Plan, ids: Iterable[str]) -> list[str]:
    """The ids that holes have in `by_stroke` of their plan; one that names no hole of several strokes stays.

    Args:
        plan: of the holes.
        ids: of holes, or of strokes.
    """
    strokes = {answer.hole.id: [each.hole.id for each in each_stroke(answer)] for answer in plan.holes}
    return [each for hole_id in ids for each in strokes.get(hole_id, [hole_id])]


def together(plan: Plan, strokes: Plan) -> Plan:
    """A plan with what was found of its strokes.

    Args:
        plan: of the holes.
        strokes: the same by stroke, each in place, with other checks, certificates or findings.
    """
    if not any(hole.strokes for hole in plan.holes):
        return strokes
    found = iter(strokes.holes)
    holes = []
    for answer in plan.holes:
        if not answer.strokes:
            holes.append(next(found))
            continue
        own = tuple(replace(stroke, answer=next(found)) for stroke in answer.strokes)
        before = list(_findings(answer.hole, each_stroke(answer)))
        said = [each for each in answer.findings if each not in before]
        whole = replace(answer, strokes=own, findings=(*said, *_findings(answer.hole, [each.answer for each in own])))
        holes.append(_with_proofs(whole))
    return replace(plan, holes=tuple(holes), findings=strokes.findings)


def _with_proofs(answer: HolePlan) -> HolePlan:
    """The answer with what the checks and proofs of its strokes come to."""
    answers = each_stroke(answer)
    return replace(
        answer,
        verified=_verified([each.verified for each in answers]),
        certificate=_certificate([each.certificate for each in answers]),
        certified_within=_within([each.certified_within for each in answers]),
    )


def _score(hole: Hole, answers: Sequence[HolePlan]) -> Score:
    scores = [answer.score for answer in answers if answer.score is not None]
    assert len(scores) == len(answers)
    events = tuple(
        Event(event.joint, event.leg, event.standoff + hole.depth - answer.hole.depth)
        for answer, score in zip(answers, scores, strict=True)
        for event in score.events
    )
    return Score(
        reversals_per_joint=_summed([score.reversals_per_joint for score in scores]),
        events=events,
        travel=sum(score.travel for score in scores),
        min_rate=_least([score.min_rate for score in scores]),
        mean_rate=_least([score.mean_rate for score in scores]),
        limit_distance=_least([score.limit_distance for score in scores]),
    )


def _least(rows: Sequence[Array]) -> Array:
    return np.asarray(np.min(rows, axis=0))


def _summed(counts: Sequence[tuple[int, ...]]) -> tuple[int, ...]:
    return tuple(sum(each) for each in zip(*counts, strict=True))


def _baseline(answers: Sequence[HolePlan]) -> Baseline | None:
    """The same strokes with constant spin; None where one of them cannot be run."""
    found = [answer.baseline for answer in answers if answer.baseline is not None]
    if len(found) < len(answers):
        return None
    return Baseline(_summed([each.reversals_per_joint for each in found]), sum(each.travel for each in found))


def _verified(found: Sequence[Verification | None]) -> Verification | None:
    known = [each for each in found if each is not None]
    if len(known) < len(found):
        return None
    failures = tuple(f"stroke {n}: {each}" for n, one in enumerate(known, 1) for each in one.failures)
    return Verification(
        passed=all(each.passed for each in known),
        samples=sum(each.samples for each in known),
        blend_samples=sum(each.blend_samples for each in known),
        reversals_per_joint=_summed([each.reversals_per_joint for each in known]),
        max_position_error=max(each.max_position_error for each in known),
        max_rotation_error=max(each.max_rotation_error for each in known),
        max_joint_step=max(each.max_joint_step for each in known),
        min_limit_distance=min(each.min_limit_distance for each in known),
        failures=failures,
    )


def _certificate(found: Sequence[Certificate | None]) -> Certificate | None:
    """What is proven of all strokes: the worst verdict, the least bounds, the fewest curves."""
    known = [each for each in found if each is not None]
    if len(known) < len(found):
        return None
    verdicts, curves = ("refuted", "undecided", "certified"), ("parabola", "one_way", "any")
    of_blends = [each.curve for each in known if each.curve is not None]
    return Certificate(
        verdict=min((each.verdict for each in known), key=verdicts.index),
        pieces=sum(each.pieces for each in known),
        min_rate=_least([each.min_rate for each in known]),
        blend_min_rate=_least([each.blend_min_rate for each in known]),
        limit_distance=_least([each.limit_distance for each in known]),
        reasons=tuple(f"stroke {n}: {each}" for n, one in enumerate(known, 1) for each in one.reasons),
        curve=min(of_blends, key=curves.index, default=None),
    )


def _within(found: Sequence[Within | None]) -> Within | None:
    known = [each for each in found if each is not None]
    if len(known) < len(found):
        return None
    return Within(min(each.position for each in known), min(each.rotation for each in known))


def _findings(hole: Hole, answers: Sequence[HolePlan]) -> Iterator[Finding]:
    """What a user should know of the strokes, each said once, with the strokes that it is true of."""
    said: dict[Finding, list[int]] = {}
    for number, answer in enumerate(answers, 1):
        for each in answer.findings:
            said.setdefault(replace(each, hole=hole.id), []).append(number)
    for finding, numbers in said.items():
        if len(numbers) == len(answers):
            yield finding
        else:
            which = f"stroke{'s' if len(numbers) > 1 else ''} {', '.join(map(str, numbers))}"
            yield replace(finding, message=f"{which}: {finding.message}")
