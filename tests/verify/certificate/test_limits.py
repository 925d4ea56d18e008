"""The certificate at the edges: limits, reach, singular postures, and claims that are not true."""

from dataclasses import replace

import numpy as np
import pytest

import zerorev.verify.certificate.proof as proof
from zerorev.model.hole import Hole
from zerorev.model.profile import Profile
from zerorev.verify.certificate.certify import certify_motion


def score(plan, **changes):
    return replace(plan, score=replace(plan.score, **changes))


@pytest.mark.parametrize("joint", range(6))
@pytest.mark.parametrize("by", [1e-6, 1e-9, 1e-11])
@pytest.mark.parametrize("end", ["lower", "upper"])
def test_a_limit_passed_by_a_hair(kuka, modest, prove, joint, by, end):
    plan = modest(1)
    joints = plan.motion.joints[:, joint]
    extreme = joints.min() if end == "lower" else joints.max()
    outwards = -1 if end == "lower" else 1

    def with_limit(value):
        limits = getattr(kuka.limits, end).copy()
        limits[joint] = value
        return replace(kuka, limits=replace(kuka.limits, **{end: limits}))

    passed = prove(score(plan, limit_distance=np.full(6, -1.0)), robot=with_limit(extreme - outwards * by))
    assert passed.verdict == "refuted"
    assert any(reason.startswith(f"A{joint + 1} is") and "beyond its limits" in reason for reason in passed.reasons)
    kept = prove(score(plan, limit_distance=np.full(6, -1.0)), robot=with_limit(extreme + outwards * by))
    assert kept.verdict == "certified"
    assert 0 <= kept.limit_distance[joint] <= by * 1.001


def test_out_of_reach(kuka, drill, modest):
    """The start lies beyond the outstretched arm."""
    plan = modest(1)
    hole = replace(plan.hole, target=plan.hole.target + np.array([0.0, 0.0, 0.35]))
    answer = certify_motion(kuka, drill, hole, plan.motion.profile, plan.motion.joints[:1])
    assert answer.verdict != "certified"
    assert np.isnan(answer.min_rate).all()


def test_out_of_reach_half_way(kuka, drill, random_hole):
    """The arm reaches the start, and not the target."""
    hole, _, start = random_hole(kuka, drill, 0, joints_deg=(20, -60, 12, 20, 40, 30), depth=0.01)
    away = Hole("away", hole.target + hole.direction * 0.05, hole.direction, 0.06, hole.psi_zero)
    answer = certify_motion(kuka, drill, away, Profile.straight(0.06, 0.0, 0.1, 0.0), start[None])
    towards = Hole("back", hole.target - hole.direction * 0.05, hole.direction, 0.06, hole.psi_zero)
    other = certify_motion(kuka, drill, towards, Profile.straight(0.06, 0.0, 0.1, 0.0), start[None])
    assert {answer.verdict, other.verdict} <= {"refuted", "undecided"}


def test_through_a_singular_posture(kuka, drill, random_hole):
    hole, profile, start = random_hole(kuka, drill, 0, joints_deg=(10, -80, 60, 20, 0.0005, 30), depth=0.01)
    answer = certify_motion(kuka, drill, hole, profile, start[None])
    assert answer.verdict in ("refuted", "undecided")


def test_a_singular_start(kuka, drill, modest):
    joints = np.zeros((1, 6))
    answer = certify_motion(kuka, drill, modest(1).hole, modest(1).motion.profile, joints)
    assert answer.verdict == "undecided"
    assert "singular" in answer.reasons[0]


def test_a_spin_beyond_all_measure(kuka, drill, modest):
    plan = modest(1)
    profile = Profile.straight(0.05, float(plan.motion.profile.psi[0]), 1e12, 0.0)
    answer = certify_motion(kuka, drill, plan.hole, profile, plan.motion.joints[:1])
    assert answer.reasons == ("too long a way on the plunge, stand-off 50 mm",)


def test_it_says_when_it_gives_up(prove, modest, monkeypatch):
    monkeypatch.setattr(proof, "PIECES", 20)
    answer = prove(modest(1))
    assert answer.verdict == "undecided"
    assert answer.reasons[0].startswith("given up after 20 pieces on the ")


# --- claims -----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("joint", range(6))
@pytest.mark.parametrize("breakpoint", range(3))
def test_joints_that_are_not_on_the_path(prove, modest, joint, breakpoint):
    plan = modest(1)
    joints = plan.motion.joints.copy()
    joints[breakpoint, joint] += 3e-6
    answer = prove(replace(plan, motion=replace(plan.motion, joints=joints)))
    assert answer.verdict == "refuted"
    assert any(f"A{joint + 1} at breakpoint {breakpoint + 1} is given as" in reason for reason in answer.reasons)


def test_another_turn(prove, modest):
    plan = modest(1)
    joints = plan.motion.joints.copy()
    joints[1:, 5] -= 2 * np.pi
    assert prove(replace(plan, motion=replace(plan.motion, joints=joints))).verdict == "refuted"
    joints[0, 5] -= 2 * np.pi  # all of them: a motion of its own
    moved = replace(plan, motion=replace(plan.motion, joints=joints))
    assert prove(score(moved, limit_distance=np.full(6, -1.0))).verdict == "certified"


def test_another_branch(prove, modest):
    plan = modest(1)
    answer = prove(replace(plan, motion=replace(plan.motion, branch=5)))
    assert answer.verdict == "refuted"
    assert "branch" in answer.reasons[0]


@pytest.mark.parametrize(
    ("change", "word"),
    [
        (lambda s: {"travel": s.travel * 1.001}, "travel"),
        (lambda s: {"min_rate": s.min_rate * 2.5}, "slows down"),
        (lambda s: {"mean_rate": s.mean_rate * 1.01}, "mean rate"),
        (lambda s: {"limit_distance": s.limit_distance + 1e-4}, "within"),
        (lambda s: {"travel": float("nan")}, "travel"),
    ],
)
def test_claims_that_are_too_good(prove, modest, change, word):
    plan = modest(2)
    answer = prove(score(plan, **change(plan.score)))
    assert answer.verdict == "refuted"
    assert word in answer.reasons[0]


def test_no_score(prove, modest):
    assert prove(replace(modest(1), score=None)).verdict == "refuted"
