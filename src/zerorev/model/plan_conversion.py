"""Between the plan and the form of its file; millimetres and degrees end here."""

from __future__ import annotations

from typing import Any

import numpy as np

from zerorev.errors import InputError
from zerorev.model._arrays import Array
from zerorev.model._units import deg, deg_per_mm, m, mm, plain, rad, rad_per_m
from zerorev.model.conversion import (
    frame_data,
    frame_from,
    given_profile,
    robot_data,
    robot_from,
    settings_data,
    settings_from,
    tool_data,
    tool_from,
)
from zerorev.model.hole import Hole
from zerorev.model.plan import Baseline, Certificate, Event, Finding, HolePlan, Motion, Plan, Score, Verification
from zerorev.model.plan_schema import (
    BaselineForm,
    CertificateForm,
    FindingForm,
    GivenForm,
    JointsDegForm,
    PlanFile,
    PlanHole,
    VerifiedForm,
)
from zerorev.model.profile import Profile
from zerorev.model.validation import inside

__all__ = ["plan_data", "plan_from"]

# --- plan -> file -----------------------------------------------------------------------------------------------------


def plan_data(plan: Plan) -> dict[str, Any]:
    """The plan as plain data, in the form of a plan file."""
    return {
        "format": "zerorev.plan/1",
        "name": plan.name,
        "robot": robot_data(plan.robot),
        "tool": tool_data(plan.tool),
        "part_frame": frame_data(plan.T_base_part),
        "settings": settings_data(plan.settings),
        "holes": [plain(_hole_data(hole)) for hole in plan.holes],
        "findings": [vars(finding) for finding in plan.findings],
    }


def _hole_data(answer: HolePlan) -> dict[str, Any]:
    hole = answer.hole
    return {
        "id": hole.id,
        "target_mm": mm(hole.target),
        "direction": hole.direction,
        "depth_mm": mm(hole.depth),
        "psi_zero": hole.psi_zero,
        "given": _given_data(hole),
        "status": answer.status,
        **_motion_data(answer.motion),
        **_score_data(answer.score),
        "wrist_offset_mm": mm(answer.wrist_offset),
        "baseline": _baseline_data(answer.baseline),
        "verified": _verified_data(answer.verified),
        "certificate": _certificate_data(answer.certificate) if answer.certificate else None,
        "findings": [vars(finding) for finding in answer.findings],
    }


def _given_data(hole: Hole) -> dict[str, Any] | None:
    if hole.profile is None and hole.branch is None:
        return None
    standoff_mm = None if hole.profile is None else mm(hole.profile.standoff)
    psi_deg = None if hole.profile is None else deg(hole.profile.psi)
    return {"standoff_mm": standoff_mm, "psi_deg": psi_deg, "branch": hole.branch}


def _motion_data(motion: Motion | None) -> dict[str, Any]:
    if motion is None:
        return dict.fromkeys(_MOTION)
    joints, corner = deg(motion.joints), motion.profile.corner
    return {
        "branch": motion.branch,
        "standoff_mm": mm(motion.profile.standoff),
        "psi_deg": deg(motion.profile.psi),
        "joints_deg": {"start": joints[0], "target": joints[corner], "end": joints[-1], "breakpoints": joints},
    }


def _score_data(score: Score | None) -> dict[str, Any]:
    if score is None:
        return dict.fromkeys(_SCORE)
    return {
        "reversals": score.reversals,
        "reversals_per_joint": score.reversals_per_joint,
        "events": [{"joint": e.joint, "leg": e.leg, "standoff_mm": mm(e.standoff)} for e in score.events],
        "travel_deg": deg(score.travel),
        "min_rate_deg_per_mm": deg_per_mm(score.min_rate),
        "mean_rate_deg_per_mm": deg_per_mm(score.mean_rate),
        "limit_distance_deg": deg(score.limit_distance),
    }


def _baseline_data(baseline: Baseline | None) -> dict[str, Any] | None:
    if baseline is None:
        return None
    return {
        "reversals": baseline.reversals,
        "reversals_per_joint": baseline.reversals_per_joint,
        "travel_deg": deg(baseline.travel),
    }


def _verified_data(verified: Verification | None) -> dict[str, Any] | None:
    if verified is None:
        return None
    return {
        "passed": verified.passed,
        "samples": verified.samples,
        "blend_samples": verified.blend_samples,
        "reversals_per_joint": verified.reversals_per_joint,
        "max_position_error_mm": mm(verified.max_position_error),
        "max_rotation_error_deg": deg(verified.max_rotation_error),
        "max_joint_step_deg": deg(verified.max_joint_step),
        "min_limit_distance_deg": deg(verified.min_limit_distance),
        "failures": verified.failures,
    }


def _certificate_data(certificate: Certificate) -> dict[str, Any]:
    return {
        "verdict": certificate.verdict,
        "pieces": certificate.pieces,
        "min_rate_deg_per_mm": deg_per_mm(certificate.min_rate),
        "blend_min_rate_deg_per_mm": deg_per_mm(certificate.blend_min_rate),
        "limit_distance_deg": deg(certificate.limit_distance),
        "reasons": certificate.reasons,
    }


# --- file -> plan -----------------------------------------------------------------------------------------------------

_MOTION = ("branch", "standoff_mm", "psi_deg", "joints_deg")
_SCORE = (
    "reversals",
    "reversals_per_joint",
    "events",
    "travel_deg",
    "min_rate_deg_per_mm",
    "mean_rate_deg_per_mm",
    "limit_distance_deg",
)


def plan_from(form: PlanFile) -> Plan:
    """The plan of a plan file.

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
        settings = settings_from(form.settings)
    ids = [hole.id for hole in form.holes]
    if len(set(ids)) < len(ids):
        raise InputError("two holes have the same id", where="holes", accepted="ids that differ")
    return Plan(
        robot=robot,
        tool=tool,
        settings=settings,
        holes=tuple(_hole_plan_from(hole, f"holes[{i}] (hole {hole.id})") for i, hole in enumerate(form.holes)),
        T_base_part=frame_from(form.part_frame),
        name=form.name,
        findings=_findings_from(form.findings),
    )


def _same_numbers(written: str, computed: str) -> None:
    if written != computed:
        raise InputError(
            "the numbers do not match their sha256, so they were altered after planning",
            where="sha256",
            accepted="a plan file as zerorev wrote it; to change the robot or tool, plan again",
        )


def _hole_plan_from(form: PlanHole, where: str) -> HolePlan:
    with inside(where):
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
        )


def _agree(ok: bool, name: str) -> None:
    if not ok:
        raise InputError("contradicts the fields beside it", where=name, accepted="a plan file as zerorev wrote it")


def _motion_from(form: PlanHole) -> Motion | None:
    match [getattr(form, name) for name in _MOTION]:
        case [None, None, None, None]:
            return None
        case [int(branch), list(standoff_mm), list(psi_deg), JointsDegForm() as joints]:
            _agree(len(standoff_mm) == len(psi_deg) == len(joints.breakpoints), "standoff_mm, psi_deg, joints_deg")
            profile = Profile(m(standoff_mm), rad(psi_deg))
            for name, i in (("start", 0), ("target", profile.corner), ("end", -1)):
                _agree(getattr(joints, name) == joints.breakpoints[i], f"joints_deg.{name}")
            return Motion(profile, branch, rad(joints.breakpoints))
    raise InputError("some are null", where=", ".join(_MOTION), accepted="all or none of them null")


def _score_from(form: PlanHole) -> Score | None:
    match [getattr(form, name) for name in _SCORE]:
        case [None, None, None, None, None, None, None]:
            return None
        case [int(count), list(counts), list(events), float(travel_deg), list(least), list(mean), list(distance)]:
            _agree(count == sum(counts), "reversals")
            return Score(
                reversals_per_joint=tuple(counts),
                events=tuple(Event(event.joint, event.leg, float(m(event.standoff_mm))) for event in events),
                travel=float(rad(travel_deg)),
                min_rate=rad_per_m(_measured(least)),
                mean_rate=rad_per_m(_measured(mean)),
                limit_distance=rad(_measured(distance)),
            )
    raise InputError("some are null", where=", ".join(_SCORE), accepted="all or none of them null")


def _measured(values: Any) -> Array:
    """Numbers, with NaN where the file has null."""
    return np.array(values, dtype=np.float64)


def _baseline_from(form: BaselineForm | None) -> Baseline | None:
    if form is None:
        return None
    _agree(form.reversals == sum(form.reversals_per_joint), "baseline.reversals")
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


def _findings_from(forms: list[FindingForm]) -> tuple[Finding, ...]:
    return tuple(Finding(form.level, form.kind, form.message, form.hole) for form in forms)
