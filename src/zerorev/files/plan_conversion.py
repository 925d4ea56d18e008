"""From the form of a plan's file to the plan; millimetres and degrees end here. `plan_data` goes the other way."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace
from typing import Any, TypeVar

import numpy as np

from zerorev.errors import InputError
from zerorev.files.conversion import (
    cycle_from,
    frame_from,
    given_profile,
    robot_data,
    robot_from,
    settings_from,
    tool_data,
    tool_from,
)
from zerorev.files.plan_data import MOTION, SCORE, answer_data, twist_spread
from zerorev.files.plan_schema import (
    CornerForm,
    DepthFile,
    DepthHole,
    GivenForm,
    JointsDegForm,
    LostMotionForm,
    PlanFile,
    PlanHole,
    ToolPlanForm,
)
from zerorev.files.solids import surroundings_from
from zerorev.files.stated_forms import Form, agree, noun_from
from zerorev.files.strokes_agree import further_strokes_agree, same_axis, stroke_differs
from zerorev.files.text import Document
from zerorev.files.units import deg, m, mm, plain, rad, rad_per_m
from zerorev.files.validation import checked, inside
from zerorev.model._arrays import UNIT_TOLERANCE, Array
from zerorev.model.finding import Finding
from zerorev.model.hole import Hole
from zerorev.model.measures import Measures
from zerorev.model.plan import (
    Baseline,
    Certificate,
    Clearance,
    Corner,
    Event,
    HolePlan,
    LostMotion,
    LostMotionEvent,
    Motion,
    Optimality,
    Plan,
    Score,
    Stroke,
    Transition,
    Verification,
    Within,
)
from zerorev.model.profile import Profile
from zerorev.model.strokes import stroke_id

__all__ = ["answer_from", "as_written", "plan_from", "written_motion"]

N = TypeVar("N")


def plan_from(form: PlanFile | DepthFile) -> Plan:
    """The plan of a plan file or of a depth file.

    Raises:
        InputError: numbers that were altered or that contradict each other, or that no noun accepts.
    """
    with inside("robot"):
        robot = robot_from(form.robot)
        _same_numbers(form.robot.sha256, robot_data(robot)["sha256"])
    with inside("tool"):
        tool = tool_from(form.tool)
        _same_numbers(form.tool.sha256, tool_data(tool)["sha256"])
    with inside("settings"):
        settings = settings_from(form.settings, before=True)
    settings = replace(settings, surroundings=surroundings_from(form.surroundings))
    holes: Sequence[PlanHole | DepthHole] = form.holes
    ids = [hole.id for hole in holes]
    if len(set(ids)) < len(ids):
        raise InputError("two holes have the same id", where="holes", accepted="ids that differ")
    plan = Plan(
        robot=robot,
        tool=tool,
        settings=settings,
        holes=tuple(answer_from(hole, f"holes[{i}] (hole {hole.id})") for i, hole in enumerate(holes)),
        T_base_part=frame_from(form.part_frame),
        name=form.name,
        findings=_nouns_from(Finding, form.findings),
        strokes="asked" if isinstance(form, PlanFile) else "deepest",
        **_sequence_from(form),
    )
    further = tuple(_further_from(plan, each, f"tools[{n}]") for n, each in enumerate(form.tools or ()))
    further_strokes_agree([hole if isinstance(hole, PlanHole) else hole.plan for hole in holes], form.tools or [])
    return replace(plan, further=further)


def _further_from(plan: Plan, form: ToolPlanForm, where: str) -> Plan:
    """The plan of a further tool."""
    with inside(where):
        with inside("tool"):
            tool = tool_from(form.tool)
            _same_numbers(form.tool.sha256, tool_data(tool)["sha256"])
        with inside("settings"):
            settings = settings_from(form.settings, before=True)
        ids, own = [hole.id for hole in form.holes], [hole.hole.id for hole in plan.holes]
        agree("holes, their ids", ids, own)
        return replace(
            plan,
            tool=tool,
            settings=settings,
            holes=tuple(answer_from(hole, f"holes[{i}] (hole {hole.id})") for i, hole in enumerate(form.holes)),
            name=form.name,
            findings=_nouns_from(Finding, form.findings),
            **({"order": (), "transitions": (), "cycle_time": None} | _sequence_from(form)),
        )


def _sequence_from(form: PlanFile | DepthFile | ToolPlanForm) -> dict[str, Any]:
    """The order of the holes and the moves between them.

    Raises:
        InputError: an order that names a hole twice, or one that there is none of; only a part of it is there.
    """
    missing = {each is None for each in (form.order, form.transitions, form.cycle_time_s)}
    if form.order is None or form.transitions is None or form.cycle_time_s is None:
        if missing != {True}:
            raise InputError(
                "some are null", where="order, transitions, cycle_time_s", accepted="all or none of them null"
            )
        return {}
    ids = [hole.id for hole in form.holes]
    if len(set(form.order)) < len(form.order) or not set(form.order) <= set(ids):
        raise InputError(
            "names a hole twice, or one that is not there", where="order", accepted="ids of the holes, each once"
        )
    moves = tuple(
        noun_from(
            Transition, each, start=each.start, to=each.to, joints=rad(each.joints_deg),
            findings=_nouns_from(Finding, each.findings), around=_noun_from(Clearance, each.around),
        )
        for each in form.transitions
    )  # fmt: skip
    return {"order": tuple(form.order), "transitions": moves, "cycle_time": form.cycle_time_s}


def _same_numbers(written: str, computed: str) -> None:
    if written != computed:
        raise InputError(
            "the numbers do not match their sha256, so they were altered after planning",
            where="sha256",
            accepted="a plan file as zerorev wrote it; to change the robot or tool, plan again",
        )


def answer_from(form: PlanHole | DepthHole, where: str) -> HolePlan:
    """One hole's answer of the file.

    Raises:
        InputError: numbers that contradict each other, or that no noun accepts.
    """
    if isinstance(form, PlanHole):
        return _hole_plan_from(form, where)
    with inside(where):
        agree("id", form.id, form.plan.id)
        agree("deepest_mm", form.deepest_mm, form.plan.deepest_mm)
    return _hole_plan_from(form.plan, f"{where}, plan")


def written_motion(motion: Motion) -> Motion:
    """A motion as it is read again from a plan file: with the digits that are written.

    Args:
        motion: of a hole.
    """
    profile = motion.profile
    digits = plain(mm(profile.standoff)), plain(deg(profile.psi)), plain(deg(motion.joints))
    return Motion(Profile(m(digits[0]), rad(digits[1])), motion.branch, rad(digits[2]))


def as_written(answer: HolePlan) -> HolePlan:
    """An answer as it is read again from a plan file: with the digits that are written.

    Args:
        answer: of a hole.
    """
    form = checked(PlanHole, Document(f"hole {answer.hole.id}", answer_data(answer, "asked")))
    return _hole_plan_from(form, f"hole {answer.hole.id}")


def _hole_plan_from(form: PlanHole, where: str) -> HolePlan:
    with inside(where):
        for name, vector in (("direction", form.direction), ("psi_zero", form.psi_zero)):
            length = float(np.linalg.norm(vector))
            agree(f"{name}, its length", length, 1.0, UNIT_TOLERANCE)
        given = form.given or GivenForm(standoff_mm=None, psi_deg=None, branch=None)
        hole = Hole(
            id=form.id,
            target=m(form.target_mm),
            direction=np.array(form.direction),
            depth=float(m(form.depth_mm)),
            psi_zero=np.array(form.psi_zero),
            profile=given_profile(given.standoff_mm, given.psi_deg, form.depth_mm),
            branch=given.branch,
            group=form.group or "",
            cycle=None if form.cycle is None else cycle_from(form.cycle),
        )
        return noun_from(
            HolePlan,
            form,
            hole=hole,
            status=form.status,
            motion=_motion_from(form),
            score=_score_from(form),
            baseline=_noun_from(Baseline, form.baseline, "baseline."),
            verified=_noun_from(Verification, form.verified),
            findings=_nouns_from(Finding, form.findings),
            certificate=_noun_from(Certificate, form.certificate),
            certified_within=_noun_from(Within, form.certified_within),
            measures=_noun_from(Measures, form.criteria),
            optimality=_noun_from(Optimality, form.optimality),
            lost_motion=_lost_motion_from(form.lost_motion),
            corner=_corner_from(form.corner),
            clearance=_noun_from(Clearance, form.clearance),
            critical_rates=_critical_from(form),
            **_strokes_from(form, hole, where),
        )


def _strokes_from(form: PlanHole, hole: Hole, where: str) -> dict[str, Any]:
    """The strokes of a hole, where it has several; the feeds of the first one, and what contradicts the rest.

    Raises:
        InputError: strokes that are not of this hole, or of which the answer is missing.
    """
    if form.strokes is None:
        return {}
    strokes, unlike = [], list[str]()
    of_the_first = [each for each in form.strokes if getattr(each, "tool") == 0]  # noqa: B009
    if not of_the_first:
        raise InputError("is that of a further tool", where="strokes[0].tool", accepted="0, the first one")
    feeds = [(float(m(each.feeds_mm_s.plunge)), float(m(each.feeds_mm_s.retract))) for each in of_the_first]
    for n, each in enumerate(of_the_first):
        at, own = f"strokes[{n}]", each.answer or form
        if (each.answer is None) != (len(of_the_first) == 1):
            accepted = "null for the only stroke, and for none of several"
            raise InputError("is null, or not", where=f"{at}.answer", accepted=accepted)
        if each.answer is not None:
            agree(f"{at}.answer.id", each.answer.id, stroke_id(form.id, n + 1))
            answer = replace(_hole_plan_from(each.answer, f"{where}, {at}.answer"), feeds=feeds[n])
            same_axis(f"{at}.answer", answer.hole, hole)
            strokes.append(noun_from(Stroke, each, answer=answer))
        else:
            agree(f"{at}.reversals_in_air", getattr(each, "reversals_in_air"), 0)  # noqa: B009
        unlike += stroke_differs(at, each, own, form.depth_mm - own.depth_mm)
    as_read = tuple(each.model_dump(exclude={"answer"}) for each in of_the_first) if unlike else ()
    return {
        "feeds": feeds[0], "strokes": tuple(strokes), "unlike": tuple(unlike), "strokes_as_read": as_read
    }  # fmt: skip


def _motion_from(form: PlanHole) -> Motion | None:
    match [getattr(form, name) for name in MOTION]:
        case [None, None, None, None]:
            return None
        case [int(branch), list(standoff_mm), list(psi_deg), JointsDegForm() as joints]:
            for name, entries in (("psi_deg", psi_deg), ("joints_deg.breakpoints", joints.breakpoints)):
                agree(f"{name}, its entries", len(entries), len(standoff_mm))
            profile = Profile(m(standoff_mm), rad(psi_deg))
            for name, i in (("start", 0), ("target", profile.corner), ("end", -1)):
                agree(f"joints_deg.{name}", getattr(joints, name), joints.breakpoints[i])
            return Motion(profile, branch, rad(joints.breakpoints))
    raise InputError("some are null", where=", ".join(MOTION), accepted="all or none of them null")


def _score_from(form: PlanHole) -> Score | None:
    undefined = {getattr(form, name) is None for name in SCORE}
    if len(undefined) > 1:
        raise InputError("some are null", where=", ".join(SCORE), accepted="all or none of them null")
    return None if form.events is None else noun_from(Score, form, events=_nouns_from(Event, form.events))


def _lost_motion_from(form: LostMotionForm | None) -> LostMotion | None:
    return None if form is None else noun_from(LostMotion, form, events=_nouns_from(LostMotionEvent, form.events))


def _corner_from(form: CornerForm | None) -> Corner | None:
    if form is None:
        return None
    least, most = m(form.interval_mm)
    return noun_from(Corner, form, interval=(float(least), float(most)))


def _critical_from(form: PlanHole) -> Array | None:
    values = form.critical_rates_deg_per_mm
    agree("twist_spread_deg_per_mm", form.twist_spread_deg_per_mm, twist_spread(values))
    return None if values is None else rad_per_m(_measured(values))


def _measured(values: Any) -> Array:
    """Numbers, with NaN where the file has null."""
    return np.array(values, dtype=np.float64)


def _nouns_from(noun: type[N], forms: Iterable[Form]) -> tuple[N, ...]:
    return tuple(noun_from(noun, form) for form in forms)


def _noun_from(noun: type[N], form: Form | None, where: str = "") -> N | None:
    return None if form is None else noun_from(noun, form, where=where)
