"""From the form of a plan's file to the plan; millimetres and degrees end here. `plan_data` goes the other way."""

from __future__ import annotations

import json
from collections.abc import Sequence
from typing import Any

import numpy as np

from zerorev.errors import InputError
from zerorev.files.conversion import (
    frame_from,
    given_profile,
    robot_data,
    robot_from,
    settings_from,
    tool_data,
    tool_from,
)
from zerorev.files.plan_data import MOTION, SCORE, twist_spread
from zerorev.files.plan_schema import (
    BaselineForm,
    CertificateForm,
    DepthFile,
    DepthHole,
    FindingForm,
    GivenForm,
    JointsDegForm,
    OptimalityForm,
    PlanFile,
    PlanHole,
    VerifiedForm,
    WithinForm,
)
from zerorev.files.stated_forms import noun_from
from zerorev.files.units import m, rad, rad_per_m
from zerorev.files.validation import inside
from zerorev.model._arrays import UNIT_TOLERANCE, Array
from zerorev.model.hole import Hole
from zerorev.model.measures import Measures
from zerorev.model.plan import (
    Baseline,
    Certificate,
    Event,
    Finding,
    HolePlan,
    Motion,
    Optimality,
    Plan,
    Score,
    Verification,
    Within,
)
from zerorev.model.profile import Profile

__all__ = ["answer_from", "plan_from"]


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
    holes: Sequence[PlanHole | DepthHole] = form.holes
    ids = [hole.id for hole in holes]
    if len(set(ids)) < len(ids):
        raise InputError("two holes have the same id", where="holes", accepted="ids that differ")
    return Plan(
        robot=robot,
        tool=tool,
        settings=settings,
        holes=tuple(answer_from(hole, f"holes[{i}] (hole {hole.id})") for i, hole in enumerate(holes)),
        T_base_part=frame_from(form.part_frame),
        name=form.name,
        findings=_findings_from(form.findings),
        strokes="asked" if isinstance(form, PlanFile) else "deepest",
    )


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
        _agree("id", form.id, form.plan.id)
        _agree("deepest_mm", form.deepest_mm, form.plan.deepest_mm)
    return _hole_plan_from(form.plan, f"{where}, plan")


def _hole_plan_from(form: PlanHole, where: str) -> HolePlan:
    with inside(where):
        for name, vector in (("direction", form.direction), ("psi_zero", form.psi_zero)):
            length = float(np.linalg.norm(vector))
            _agree(f"{name}, its length", length, 1.0, UNIT_TOLERANCE)
        given = form.given or GivenForm(standoff_mm=None, psi_deg=None, branch=None)
        hole = Hole(
            id=form.id,
            target=m(form.target_mm),
            direction=np.array(form.direction),
            depth=float(m(form.depth_mm)),
            psi_zero=np.array(form.psi_zero),
            profile=given_profile(given.standoff_mm, given.psi_deg, form.depth_mm),
            branch=given.branch,
        )
        return HolePlan(
            hole=hole,
            status=form.status,
            wrist_offset=float(m(form.wrist_offset_mm)),
            motion=_motion_from(form),
            score=_score_from(form),
            baseline=_baseline_from(form.baseline),
            verified=_verified_from(form.verified),
            findings=_findings_from(form.findings),
            certificate=_certificate_from(form.certificate) if form.certificate else None,
            certified_within=_within_from(form.certified_within) if form.certified_within else None,
            measures=noun_from(Measures, form.criteria) if form.criteria else None,
            deepest=None if form.deepest_mm is None else float(m(form.deepest_mm)),
            deepest_at_most=None if form.deepest_at_most_mm is None else float(m(form.deepest_at_most_mm)),
            optimality=_optimality_from(form.optimality) if form.optimality else None,
            critical_rates=_critical_from(form),
        )


def _optimality_from(form: OptimalityForm) -> Optimality:
    travel, gap = form.travel_at_least_deg, form.gap_percent
    return Optimality(
        form.reversals_at_least,
        None if travel is None else float(rad(travel)),
        None if gap is None else gap / 100,
        form.proven,
    )


def _agree(name: str, stated: Any, found: Any, tolerance: float = 0.0) -> None:
    """A field must be what it has to be beside the others."""
    if stated == found or (isinstance(found, float) and isinstance(stated, float) and abs(stated - found) <= tolerance):
        return
    what = f"contradicts the fields beside it: stated {json.dumps(stated)}, found {json.dumps(found)}"
    raise InputError(what, where=name, accepted="a plan file as zerorev wrote it")


def _motion_from(form: PlanHole) -> Motion | None:
    match [getattr(form, name) for name in MOTION]:
        case [None, None, None, None]:
            return None
        case [int(branch), list(standoff_mm), list(psi_deg), JointsDegForm() as joints]:
            for name, entries in (("psi_deg", psi_deg), ("joints_deg.breakpoints", joints.breakpoints)):
                _agree(f"{name}, its entries", len(entries), len(standoff_mm))
            profile = Profile(m(standoff_mm), rad(psi_deg))
            for name, i in (("start", 0), ("target", profile.corner), ("end", -1)):
                _agree(f"joints_deg.{name}", getattr(joints, name), joints.breakpoints[i])
            return Motion(profile, branch, rad(joints.breakpoints))
    raise InputError("some are null", where=", ".join(MOTION), accepted="all or none of them null")


def _score_from(form: PlanHole) -> Score | None:
    match [getattr(form, name) for name in SCORE]:
        case [None, None, None, None, None, None, None]:
            return None
        case [int(count), list(counts), list(events), float(travel_deg), list(least), list(mean), list(distance)]:
            _agree("reversals", count, sum(counts))
            return Score(
                reversals_per_joint=tuple(counts),
                events=tuple(Event(event.joint, event.leg, float(m(event.standoff_mm))) for event in events),
                travel=float(rad(travel_deg)),
                min_rate=rad_per_m(_measured(least)),
                mean_rate=rad_per_m(_measured(mean)),
                limit_distance=rad(_measured(distance)),
            )
    raise InputError("some are null", where=", ".join(SCORE), accepted="all or none of them null")


def _critical_from(form: PlanHole) -> Array | None:
    values = form.critical_rates_deg_per_mm
    _agree("twist_spread_deg_per_mm", form.twist_spread_deg_per_mm, twist_spread(values))
    return None if values is None else rad_per_m(_measured(values))


def _measured(values: Any) -> Array:
    """Numbers, with NaN where the file has null."""
    return np.array(values, dtype=np.float64)


def _baseline_from(form: BaselineForm | None) -> Baseline | None:
    if form is None:
        return None
    _agree("baseline.reversals", form.reversals, sum(form.reversals_per_joint))
    return Baseline(tuple(form.reversals_per_joint), float(rad(form.travel_deg)))


def _verified_from(form: VerifiedForm | None) -> Verification | None:
    if form is None:
        return None
    return Verification(
        passed=form.passed,
        samples=form.samples,
        blend_samples=form.blend_samples,
        reversals_per_joint=tuple(form.reversals_per_joint),
        max_position_error=float(m(_measured(form.max_position_error_mm))),
        max_rotation_error=float(rad(_measured(form.max_rotation_error_deg))),
        max_joint_step=float(rad(_measured(form.max_joint_step_deg))),
        min_limit_distance=float(rad(_measured(form.min_limit_distance_deg))),
        failures=tuple(form.failures),
    )


def _certificate_from(form: CertificateForm) -> Certificate:
    return Certificate(
        verdict=form.verdict,
        pieces=form.pieces,
        min_rate=rad_per_m(_measured(form.min_rate_deg_per_mm)),
        blend_min_rate=rad_per_m(_measured(form.blend_min_rate_deg_per_mm)),
        limit_distance=rad(_measured(form.limit_distance_deg)),
        reasons=tuple(form.reasons),
    )


def _within_from(form: WithinForm) -> Within:
    return Within(float(m(form.mm)), float(rad(form.deg)))


def _findings_from(forms: list[FindingForm]) -> tuple[Finding, ...]:
    return tuple(Finding(form.level, form.kind, form.message, form.hole) for form in forms)
