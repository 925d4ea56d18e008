"""Room at the joint limits: kept by every motion, as if the limits of the robot were narrower; and what is said there.

The joints of each motion are followed by Newton's method (`oracles.arm.trace`), which knows no limits.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import zerorev as zr
from oracles.arm import trace
from oracles.holes import random_hole
from zerorev.errors import InputError
from zerorev.model.corner import CONTROLLERS
from zerorev.model.job import Job
from zerorev.model.map_task import Question
from zerorev.motion.drilling import Drilling
from zerorev.placement.margins import Asked, Look
from zerorev.placement.sharing import share
from zerorev.placement.tool_offset import offset_curve
from zerorev.planning.hole import plan, plan_deepest
from zerorev.planning.job import plan_job
from zerorev.planning.proof_check import check_proofs
from zerorev.planning.restated import check_plan
from zerorev.program.lead_in import find_lead_in
from zerorev.program.neutral import build_program
from zerorev.program.preflight import preflight
from zerorev.search.deepest import deepest_stroke
from zerorev.verify.certificate.certify import certify_hole
from zerorev.verify.check import verify_hole
from zerorev.verify.figures import figures

MARGIN = np.deg2rad(12.0)
SEEDS = (0, 1, 4, 5, 10, 11)  # holes whose best motion comes within 12 deg of a limit
PANEL = "examples/jobs/panel.yaml"


def asked(seed, margin=MARGIN, **settings):
    drilled = random_hole(seed, legs=settings.pop("legs", "straight"))
    settings.setdefault("proof_boxes", 0)
    return drilled.asking(limit_margin=margin, **settings)


def narrowed(drilled):
    """The same hole on a robot whose file has narrower limits, and no margin."""
    margin, limits = drilled.settings.limit_margin, drilled.robot.limits
    robot = replace(drilled.robot, limits=replace(limits, lower=limits.lower + margin, upper=limits.upper - margin))
    return replace(drilled, robot=robot).asking(limit_margin=0.0)


def room_along(robot, tool, hole, motion, length=0.0):
    """Least distance of each joint to the limits of the robot [rad], lead-in and all."""
    profile = motion.profile
    distance = np.linspace(0.0, profile.distance[-1], 400)
    standoff, psi = profile.at(distance)
    if length:
        back = np.linspace(0.0, length, 50)
        standoff = np.concatenate([profile.standoff[0] + back[::-1], standoff])
        psi = np.concatenate([profile.psi[0] + profile.twist_rate[0] * back[::-1], psi])
        start = trace(robot, tool, hole, standoff[49::-1], psi[49::-1], motion.joints[0])[-1]
    else:
        start = motion.joints[0]
    joints = trace(robot, tool, hole, standoff, psi, start)
    limits = robot.limits
    return np.minimum(joints - limits.lower, limits.upper - joints).min(axis=0)


@pytest.mark.parametrize(
    ("seed", "settings"),
    [
        *((seed, {}) for seed in SEEDS),
        (1, {"legs": "free"}),
        (10, {"legs": "free"}),
        pytest.param(5, {"weights": (("travel", 1.0), ("margin", 1.0))}, marks=pytest.mark.long),
        (0, {"keep_lead_in": True}),
    ],
)
def test_a_motion_is_that_of_a_robot_with_narrower_limits(seed, settings):
    drilled = asked(seed, **settings)
    kept, there = plan(*drilled.all), plan(*narrowed(drilled).all)
    assert (kept.status, kept.deepest) == (there.status, there.deepest)
    if kept.motion is None:
        assert "limit_margin_deg" in kept.findings[0].message
        return
    assert kept.motion.branch == there.motion.branch
    np.testing.assert_array_equal(kept.motion.joints, there.motion.joints)
    np.testing.assert_array_equal(kept.motion.profile.psi, there.motion.profile.psi)
    assert kept.baseline == there.baseline
    assert kept.verified.passed
    # the figures are those of the robot's own limits
    np.testing.assert_allclose(kept.score.limit_distance, there.score.limit_distance + MARGIN, rtol=0, atol=1e-12)
    assert kept.verified.min_limit_distance == pytest.approx(kept.score.limit_distance.min(), abs=1e-9)
    lead_in = find_lead_in(drilled.both[0], kept.motion, drilled.settings.lead_in)
    room = room_along(drilled.robot, drilled.tool, drilled.hole, kept.motion, lead_in.length)
    assert room.min() >= MARGIN - 1e-9


@pytest.mark.parametrize(("seed", "legs"), [(0, "straight"), (1, "straight"), (5, "straight"), (1, "free")])
def test_a_deepest_stroke_is_that_of_a_robot_with_narrower_limits(seed, legs):
    drilled = asked(seed, legs=legs)
    kept, there = plan_deepest(*drilled.all), plan_deepest(*narrowed(drilled).all)
    assert kept.deepest == there.deepest == plan(*drilled.all).deepest
    if seed == 1:
        alone = (deepest_stroke(*each.all).depth for each in (drilled, narrowed(drilled)))
        assert len(set(alone)) == 1
    if kept.motion is not None:
        room = room_along(drilled.robot, drilled.tool, kept.hole, kept.motion)
        assert room.min() >= MARGIN - 1e-9


def test_some_of_these_holes_come_nearer_without_a_margin():
    """Else the tests above could not fail."""
    least = [plan(*asked(seed, 0.0).all).score.limit_distance.min() for seed in SEEDS]
    assert max(least) < MARGIN


def test_the_proof_is_of_the_motions_that_keep_it():
    drilled = asked(1, proof_boxes=20_000)
    kept, there = plan(*drilled.all), plan(*narrowed(drilled).all)
    assert kept.optimality == there.optimality
    assert kept.deepest_at_most == there.deepest_at_most
    job = Job(drilled.robot, drilled.tool, (drilled.hole,), drilled.settings)
    checks = check_proofs(plan_job(job), sample=20)
    assert checks
    assert all(check.confirmed for check in checks)


@pytest.fixture(scope="module")
def near():
    """A motion that comes nearer to a limit than 12 deg, planned without a margin; and the settings with one."""
    drilled = asked(4, 0.0)
    return drilled, plan(*drilled.all), replace(drilled.settings, limit_margin=MARGIN)


def test_whoever_asks_how_deep_asks_with_it():
    """Placement, sharing and the tool's offset have the strokes of a robot with narrower limits."""
    drilled = asked(5)
    narrow = narrowed(drilled)
    jobs = [Job(each.robot, each.tool, (each.hole,), each.settings) for each in (drilled, narrow)]
    here = Look(np.zeros(4), (0,), -np.inf)
    placed = [Asked(job)(here)[0] for job in jobs]
    shared = [share([job, job]).margins[0, 0] for job in jobs]
    offset = [
        offset_curve(each.robot, each.tool, [each.hole], each.settings, [0.1]).deepest.item()
        for each in (drilled, narrow)
    ]
    for kept, there in (placed, shared, offset):
        assert kept == there
    wide = Asked(Job(drilled.robot, drilled.tool, (drilled.hole,), replace(drilled.settings, limit_margin=0.0)))
    assert wide(here)[0] > placed[0] + 1e-3


def test_the_way_to_a_hole_and_between_holes_keeps_it():
    job = zr.read_job(PANEL)
    margin = np.deg2rad(10.0)
    settings = replace(
        job.settings, proof_boxes=0, limit_margin=margin, approach=0.03, retract=0.05, safe_height=0.1, clearance=0.01
    )
    made = plan_job(replace(job, holes=job.holes[5:40:4], settings=settings))
    limits = made.robot.limits
    joints = np.concatenate([move.joints for move in made.transitions])
    assert len(joints) > 2 * len(made.transitions)
    assert np.minimum(joints - limits.lower, limits.upper - joints).min() >= margin - 1e-9
    without = plan_job(replace(job, holes=job.holes[5:40:4], settings=replace(settings, limit_margin=0.0)))
    joints = np.concatenate([move.joints for move in without.transitions])
    assert np.minimum(joints - limits.lower, limits.upper - joints).min() < margin


class TestWhoeverChecks:
    def test_check_and_certificate_hold_the_motion_to_it(self, near):
        drilled, answer, stricter = near
        distance = np.rad2deg(answer.score.limit_distance.min())
        assert answer.verified.passed
        said = f"{distance:.3g} deg, and not 12 deg, from its limits"
        verified = verify_hole(drilled.robot, drilled.tool, stricter, answer)
        assert any(said in failure for failure in verified.failures)
        assert certify_hole(drilled.robot, drilled.tool, drilled.settings, answer).verdict == "certified"
        certificate = certify_hole(drilled.robot, drilled.tool, stricter, answer)
        assert certificate.verdict == "refuted"
        assert any("deg, and not 12 deg, from its limits" in reason for reason in certificate.reasons)

    def test_no_program_is_made_of_it(self, near):
        drilled, _, stricter = near
        whole = plan_job(Job(drilled.robot, drilled.tool, (drilled.hole,), drilled.settings))
        program = build_program(whole)
        assert not [finding for finding in preflight(program, whole, CONTROLLERS["krl"]) if finding.kind == "limit"]
        (found,) = (
            each
            for each in preflight(program, replace(whole, settings=stricter), CONTROLLERS["krl"])
            if each.kind == "limit"
        )
        assert found.level == "error"
        assert "limit_margin_deg" in found.message

    def test_a_plan_that_keeps_it_is_checked_with_it(self):
        job = zr.read_job(PANEL)
        settings = replace(job.settings, proof_boxes=0, limit_margin=np.deg2rad(3.0))
        made = plan_job(replace(job, holes=job.holes[40:44], settings=settings))
        assert not check_plan(made).wrong
        certificates = [certify_hole(made.robot, made.tool, made.settings, hole) for hole in made.holes]
        assert all(each.verdict == "certified" for each in certificates)
        assert all(each.limit_distance.min() >= np.deg2rad(3.0) for each in certificates)

    def test_the_baseline_is_checked_within_it(self, near):
        """At constant spin the joints come nearer to a limit than the motion may."""
        drilled, answer, _ = near
        own = figures(drilled.robot, drilled.tool, drilled.settings, answer)
        assert own.answer.baseline is not None
        wide = replace(drilled.settings, limit_margin=np.deg2rad(60.0))
        assert figures(drilled.robot, drilled.tool, wide, answer).answer.baseline is None


class TestWhatIsSaid:
    def test_a_motion_near_a_limit(self):
        drilled = asked(0, 0.0)
        answer = plan(*drilled.all)
        distance = answer.score.limit_distance
        said = [finding for finding in answer.findings if finding.kind == "near_limit"]
        near = [name for name, room in zip(drilled.robot.joint_names, distance, strict=True) if room < np.deg2rad(1)]
        assert [finding.message.split()[0] for finding in said] == near
        assert all(finding.level == "warning" and "limit_margin_deg" in finding.message for finding in said)
        assert not [
            finding for finding in plan(*asked(0, np.deg2rad(1.001)).all).findings if finding.kind == "near_limit"
        ]

    @pytest.mark.parametrize(
        ("joint", "beside", "words"),
        [(0, 0.4, "within 0.40 deg"), (3, 0.004, "nearer than 0.01 deg"), (5, 0.99, "within 0.99 deg")],
    )
    @pytest.mark.parametrize("end", ["lower", "upper"])
    def test_joint_place_and_distance(self, joint, beside, words, end, robot, tool):
        """A limit is put so near to the extreme of one joint, which is where the lead-in begins or the retract ends."""
        hole = zr.read_job("examples/jobs/thesis_positions.yaml").holes[0]
        settings = zr.Settings(proof_boxes=0)
        answer = plan(robot, tool, hole, settings)
        lead_in = find_lead_in(Drilling(robot, tool, hole), answer.motion, settings.lead_in)
        joints = np.vstack([lead_in.joints, answer.motion.joints])
        places = ["where the lead-in begins", "where the plunge begins", "at the target", "where the retract ends"]
        k = int(joints[:, joint].argmin() if end == "lower" else joints[:, joint].argmax())
        away = -np.deg2rad(beside) if end == "lower" else np.deg2rad(beside)
        limit = getattr(robot.limits, end).copy()
        limit[joint] = joints[k, joint] + away
        tight = replace(robot, limits=replace(robot.limits, **{end: limit}))
        given = replace(hole, profile=answer.motion.profile, branch=answer.motion.branch)
        on_these_turns = replace(settings, near_joints=tuple(answer.motion.joints[1]))
        (said,) = (f for f in plan(tight, tool, given, on_these_turns).findings if f.kind == "near_limit")
        name = robot.joint_names[joint]
        assert said.message.startswith(
            f"{name} comes {words} of its limit of {np.rad2deg(limit[joint]):g} deg, {places[k]}:"
        )

    def test_where_a_joint_turns_round_next_to_a_limit(self, robot, tool):
        hole = zr.read_job("examples/jobs/thesis_positions.yaml").holes[2]
        answer = plan(robot, tool, hole, zr.Settings(proof_boxes=0))
        still = answer.motion.profile.at_constant_spin()
        given = replace(hole, profile=still, branch=answer.motion.branch)
        before = plan(robot, tool, given, zr.Settings(proof_boxes=0))
        inner = [event for event in before.score.events if event.leg != "target"]
        assert inner
        event = inner[0]
        profile, joint = before.motion.profile, event.joint - 1
        standoff, psi = profile.at(np.linspace(0, profile.distance[-1], 401))
        path = trace(robot, tool, hole, standoff, psi, before.motion.joints[0])[:, joint]
        k = int(path.argmax() if path.max() > max(path[0], path[200], path[-1]) + 1e-6 else path.argmin())
        assert k not in (0, 200, 400)
        end, away = ("upper", 1) if k == path.argmax() else ("lower", -1)
        limit = getattr(robot.limits, end).copy()
        limit[joint] = path[k] + away * np.deg2rad(0.5)
        tight = replace(robot, limits=replace(robot.limits, **{end: limit}))
        (said,) = (f for f in plan(tight, tool, given, zr.Settings(proof_boxes=0)).findings if f.kind == "near_limit")
        assert f"within 0.50 deg of its limit of {np.rad2deg(limit[joint]):g} deg, in the " in said.message

    def test_narrowed_to_nothing(self, robot, tool):
        hole = zr.read_job(PANEL).holes[0]
        narrow = int(np.argmin(robot.limits.upper - robot.limits.lower))
        half = np.rad2deg(robot.limits.upper - robot.limits.lower)[narrow] / 2
        settings = zr.Settings(limit_margin=np.deg2rad(half))
        for refused in (
            lambda: plan(robot, tool, hole, settings),
            lambda: Job(robot, tool, (hole,), settings),
            lambda: Question(robot, tool, settings=settings),
        ):
            with pytest.raises(InputError) as error:
                refused()
            assert error.value.where == "limit_margin_deg"
            assert robot.joint_names[narrow] in error.value.what
            assert f"less than {half:g}" in error.value.accepted

    def test_a_given_motion_that_does_not_keep_it(self):
        drilled = asked(4, 0.0)
        best = plan(*drilled.all).motion
        given = replace(drilled.hole, profile=best.profile, branch=best.branch)
        answer = plan(drilled.robot, drilled.tool, given, replace(drilled.settings, limit_margin=MARGIN))
        assert answer.status == "infeasible"
        assert "12 deg within its limits" in answer.findings[0].message
