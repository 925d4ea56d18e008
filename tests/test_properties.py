"""What holds for any hole, spin and branch: laws of the arm and of the twist plane."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from oracles import arm as twin
from robots import TRIED
from zerorev.files.io import read_robot, read_tool
from zerorev.model.hole import Hole
from zerorev.model.profile import Profile
from zerorev.model.robot import JointLimits, Robot
from zerorev.model.tool import Tool
from zerorev.motion import kinematics
from zerorev.motion.critical import kappa_of
from zerorev.motion.drilling import Drilling, joint_rates
from zerorev.motion.evaluation import evaluate
from zerorev.motion.joint_path import joints_along, sample_distances

TOOL = read_tool("thesis_drill")
ROBOTS = {name: read_robot(name) for name in TRIED}
WITHOUT_LATERAL_OFFSET = [name for name, robot in ROBOTS.items() if robot.arm.b == 0]
NO_LIMITS = JointLimits(np.full(6, -20.0), np.full(6, 20.0), np.ones(6))


@dataclass(frozen=True)
class Drilled:
    """A random hole in front of a random robot, drilled on a random branch with random spins."""

    robot: Robot
    hole: Hole
    profile: Profile
    branch: int

    def score(self):
        return evaluate(self.robot, TOOL, self.hole, self.profile, self.branch).score


def angles(limit_deg):
    return st.floats(-limit_deg, limit_deg).map(np.deg2rad)


ONE, ONE_TO_THREE = st.just(1), st.integers(1, 3)


@st.composite
def profiles(draw, depth, legs=ONE_TO_THREE, spin=60.0):
    """A motion of one to three segments a leg, its spins within +- `spin` [deg] of the one at the target."""
    inwards, outwards = draw(legs), draw(legs)
    standoff = np.concatenate([np.linspace(1, 0, inwards + 1), np.linspace(0, 1, outwards + 1)[1:]]) * depth
    psi = draw(angles(180)) + np.array([draw(angles(spin)) for _ in standoff])
    return Profile(standoff, psi)


@st.composite
def drillings(draw, names=tuple(ROBOTS), **shape):
    robot = ROBOTS[draw(st.sampled_from(names))]
    reach = robot.arm.c2 + robot.arm.c3
    across, ahead, up = draw(st.floats(-0.4, 0.4)), draw(st.floats(0.5, 0.8)), draw(st.floats(-0.2, 0.4))
    target = np.array([ahead * reach, across * reach, robot.arm.c1 + up * reach])
    direction = np.array([1.0, draw(st.floats(-0.8, 0.8)), draw(st.floats(-0.8, 0.8))])
    depth = draw(st.floats(0.01, 0.05))
    hole = Hole("random", target, direction, depth)
    return Drilled(replace(robot, limits=NO_LIMITS), hole, draw(profiles(depth, **shape)), draw(st.integers(0, 7)))


def running(drilling):
    """The score of a motion that can be run."""
    score = drilling.score()
    assume(score is not None)
    return score


@given(name=st.sampled_from(list(ROBOTS)), joints=st.tuples(*[angles(179)] * 6))
def test_inverse_undoes_forward(name, joints):
    joints = np.array(joints)
    T = kinematics.forward(ROBOTS[name], joints)
    solutions = kinematics.inverse(ROBOTS[name], T)
    reached = solutions[~np.isnan(solutions[:, 0])]
    np.testing.assert_allclose(kinematics.forward(ROBOTS[name], reached), np.tile(T, (len(reached), 1, 1)), atol=1e-9)
    J = twin.jacobian(ROBOTS[name], joints, T[:3, 3])
    if np.linalg.cond(J) < 1e6:  # elsewhere the joints are not known so well
        away = np.abs((reached - joints + np.pi) % (2 * np.pi) - np.pi).max(axis=1)
        assert away.min() < 1e-8


@given(drillings(WITHOUT_LATERAL_OFFSET))
def test_mirrored_about_the_xz_plane_the_same_joints_turn(drilling):
    """The hole at -y with -psi (base_y) on the same branch: joints 1, 4 and 6 run the other way, none of it counts."""
    score = running(drilling)
    flip = np.array([1.0, -1.0, 1.0])
    hole = replace(
        drilling.hole, target=drilling.hole.target * flip, direction=drilling.hole.direction * flip, psi_zero=twin.Y
    )
    profile = Profile(drilling.profile.standoff, -drilling.profile.psi)
    mirrored = replace(drilling, hole=hole, profile=profile).score()
    assert mirrored.reversals_per_joint == score.reversals_per_joint
    assert mirrored.travel == pytest.approx(score.travel, abs=1e-9)
    np.testing.assert_allclose(mirrored.min_rate, score.min_rate, rtol=1e-6, atol=1e-8)

    def joints(hole, profile):
        return joints_along(Drilling(drilling.robot, TOOL, hole), drilling.branch, profile.standoff, profile.psi)

    there, here = joints(hole, profile), joints(drilling.hole, drilling.profile)
    turned = there - here * [-1, 1, 1, -1, 1, -1]
    assert np.abs((turned + np.pi) % (2 * np.pi) - np.pi).max() < 1e-8


@given(drillings())
def test_run_backwards_the_same_joints_turn(drilling):
    """The mirror law (thesis eq. 4.12)."""
    score = running(drilling)
    back = replace(drilling, profile=drilling.profile.reversed()).score()
    assert back.reversals_per_joint == score.reversals_per_joint
    assert back.travel == pytest.approx(score.travel, abs=1e-9)
    for joint in range(1, 7):
        there, here = ([e.standoff for e in events if e.joint == joint] for events in (back.events, score.events))
        np.testing.assert_allclose(there[::-1], here, atol=1e-9)


@given(drillings(), angles(180))
def test_turned_about_the_base_axis_the_same_joints_turn(drilling, turn):
    score = running(drilling)
    R = twin.rotation(twin.Z, turn)[:3, :3]
    hole = drilling.hole
    turned = replace(hole, target=R @ hole.target, direction=R @ hole.direction, psi_zero=R @ hole.psi_zero)
    elsewhere = replace(drilling, hole=turned).score()
    assert elsewhere.reversals_per_joint == score.reversals_per_joint
    assert elsewhere.travel == pytest.approx(score.travel, abs=1e-9)


@given(drillings(legs=ONE))
def test_a_joint_reverses_at_the_target_unless_its_critical_rate_is_bracketed(drilling):
    """Theory §2: the slopes of the two legs lie on either side of kappa."""
    score = running(drilling)
    psi = drilling.profile.psi[drilling.profile.corner]
    kappa = kappa_of(*joint_rates(Drilling(drilling.robot, TOOL, drilling.hole), 0.0, psi))[drilling.branch]
    low, high = sorted(drilling.profile.twist_rate)
    assume(np.abs(kappa[:, None] - [low, high]).min() > 1e-6 * (1 + np.abs(kappa).max()))
    at_target = {event.joint for event in score.events if event.leg == "target"}
    assert at_target == {i + 1 for i in range(6) if not low < kappa[i] < high}


@given(drillings(legs=ONE))
def test_with_held_spin_every_joint_that_moves_reverses_at_the_target(drilling):
    """Theory §2: nothing lies between two equal slopes."""
    held = replace(drilling, profile=Profile.straight(drilling.hole.depth, *drilling.profile.psi[:1].repeat(3)))
    score = running(held)
    theta_s, _ = joint_rates(Drilling(held.robot, TOOL, held.hole), 0.0, held.profile.psi[0])
    moving = {i + 1 for i in range(6) if abs(theta_s[held.branch, i]) > 1e-6}
    assert {event.joint for event in score.events if event.leg == "target"} >= moving


@given(drillings())
@settings(max_examples=30)
def test_reversals_are_those_of_a_naive_counter(drilling):
    score = running(drilling)
    distance = sample_distances(drilling.profile, 20_000)
    whole = Drilling(drilling.robot, TOOL, drilling.hole)
    joints = joints_along(whole, drilling.branch, *drilling.profile.at(distance))
    knots = np.searchsorted(distance, drilling.profile.distance[:-1] - 1e-12)
    moved = np.add.reduceat(np.abs(np.diff(joints, axis=0)), knots)  # on each segment
    assume(((moved > 1e-4) | (moved < 1e-12)).all())  # of less than that, spread over a segment, a counter sees nothing
    assert score.reversals_per_joint == tuple(map(len, twin.reversals(joints)))
    assert score.travel == pytest.approx(np.abs(np.diff(joints, axis=0)).sum(), abs=1e-5)


@given(drillings(legs=ONE))
def test_without_reversals_travel_depends_on_the_outer_ends_alone(drilling):
    """Theory §2."""
    evaluation = evaluate(drilling.robot, TOOL, drilling.hole, drilling.profile, drilling.branch)
    assume(evaluation.score is not None)
    steady = np.array(evaluation.score.reversals_per_joint) == 0
    start, *_, end = evaluation.motion.joints
    legs = np.abs(np.diff(evaluation.motion.joints, axis=0)).sum(axis=0)
    np.testing.assert_allclose(legs[steady], np.abs(end - start)[steady], atol=1e-9)


@given(
    name=st.sampled_from(list(ROBOTS)),
    joints=st.tuples(*[angles(170)] * 6),
    lengths=st.tuples(*[st.floats(-200, 200)] * 3),
)
def test_any_tool_has_the_rates_of_the_twin(name, joints, lengths):
    robot, joints = ROBOTS[name], np.array(joints)
    tool = Tool.from_mm_deg(lengths, (20, -70, 130))
    T = kinematics.forward(robot, joints) @ tool.T_flange_tcp
    J = twin.jacobian(robot, joints, T[:3, 3])
    assume(np.linalg.cond(J) < 1e4)
    hole = Hole("here", T[:3, 3], -T[:3, 2], 0.01, psi_zero=T[:3, 1])
    solutions = kinematics.inverse(robot, kinematics.forward(robot, joints))
    branch = int(np.nanargmin(np.abs((solutions - joints + np.pi) % (2 * np.pi) - np.pi).max(axis=1)))
    for ours, theirs in zip(
        joint_rates(Drilling(robot, tool, hole), 0.0, 0.0),
        twin.rates(robot, tool, hole.direction, joints),
        strict=True,
    ):
        np.testing.assert_allclose(ours[branch], theirs, rtol=1e-6, atol=1e-6)
