"""The lead-in: as long as asked for, or as far as the joints keep the way they go when the drill enters."""

import numpy as np
import pytest
from scipy.optimize import brentq

from zerorev.model.hole import Hole
from zerorev.model.profile import Profile
from zerorev.motion.drilling import Drilling
from zerorev.motion.joint_path import joints_along
from zerorev.motion.kinematics import forward, tcp_pose
from zerorev.program.export import export
from zerorev.program.lead_in import find_lead_in
from zerorev.program.outward import KEPT


def along(plan, hole, back):
    """Joints at distances back from the start of the stroke, on the continued plunge leg; no turns."""
    profile = hole.motion.profile
    s = profile.standoff[0] + back
    return joints_along(
        Drilling(plan.robot, plan.tool, hole.hole), hole.motion.branch, s, profile.psi[0] + profile.twist_rate[0] * back
    )


def test_full_length(published, plan_of):
    plan = plan_of(published(1))
    found = find_lead_in(Drilling(plan.robot, plan.tool, plan.holes[0].hole), plan.holes[0].motion, 5e-3)
    assert found.length == 5e-3
    assert found.findings == ()
    wanted = tcp_pose(plan.holes[0].hole, 55e-3, np.deg2rad(14.1646 + 20.1034 / 10))
    reached = forward(plan.robot, found.joints) @ plan.tool.T_flange_tcp
    np.testing.assert_allclose(reached, wanted, atol=1e-6)
    # the turn of joint 6, 217 deg, is kept
    np.testing.assert_allclose(found.joints, plan.holes[0].motion.joints[0], atol=np.deg2rad(3))


def test_none_asked_for(published, plan_of):
    plan = plan_of(published(1))
    found = find_lead_in(Drilling(plan.robot, plan.tool, plan.holes[0].hole), plan.holes[0].motion, 0.0)
    assert (found.length, found.findings) == (0.0, ())
    np.testing.assert_array_equal(found.joints, plan.holes[0].motion.joints[0])


@pytest.fixture(scope="module")
def turning(published, planned, plan_of):
    """Position 3 with a stroke that begins just before joint 1 turns round: how far back, and a maker of such plans."""
    plan = plan_of(published(3))
    hole = plan.holes[0]

    def rate(back):
        ahead, behind = along(plan, hole, np.array([back - 1e-7, back + 1e-7]))[:, 0]
        return (behind - ahead) / 2e-7

    where = 30e-3 + brentq(rate, 0.0, 5e-3, xtol=1e-12)

    def begin(before):
        """A stroke that begins this far before the place."""
        depth = where - before
        h = hole.hole
        profile = hole.motion.profile
        start = profile.psi[1] + profile.twist_rate[0] * depth
        shorter = Hole(h.id, h.target, h.direction, depth, h.psi_zero)
        near = np.rad2deg(hole.motion.joints[0])
        return plan_of(planned(shorter, Profile.straight(depth, start, *profile.psi[1:]), near=near))

    return begin


@pytest.mark.parametrize("before_mm", [4.0, 2.0, 0.5])
def test_shortened_where_a_joint_would_turn_the_other_way(before_mm, turning, krl):
    plan = turning(before_mm * 1e-3)
    found = find_lead_in(Drilling(plan.robot, plan.tool, plan.holes[0].hole), plan.holes[0].motion, 5e-3)
    assert found.length * 1e3 == pytest.approx(KEPT * before_mm, abs=1.1e-3)
    (finding,) = found.findings
    assert (finding.level, finding.kind, finding.hole) == ("warning", "lead_in", "position 3")
    assert "A1 would turn the other way" in finding.message
    assert f"lead-in of {found.length * 1e3:.3f} mm instead of 5 mm" in finding.message
    # the finding is in the export and in the file, and every joint goes one way from the lead-in point to the start
    exported = export(plan)
    assert finding in exported.findings
    assert "warning:  hole position 3: lead-in of" in exported.text
    start = krl.read(exported.text).moves[0].axes
    steps = np.diff(along(plan, plan.holes[0], np.linspace(found.length, -5e-3, 100)), axis=0)
    assert (np.sign(steps) == np.sign(steps[-1])).all()
    np.testing.assert_allclose(start, np.rad2deg(found.joints), atol=1e-5)


def test_just_at_the_turning_point_there_is_none(turning, krl):
    plan = turning(0.0)
    found = find_lead_in(Drilling(plan.robot, plan.tool, plan.holes[0].hole), plan.holes[0].motion, 5e-3)
    assert found.length == 0
    assert len(found.findings) == 1
    moves = krl.read(export(plan).text).moves
    assert [move.kind for move in moves] == ["PTP", "LIN", "LIN"]


def test_shortened_at_a_joint_limit(published, plan_of, spoil):
    plan = plan_of(published(1))
    hole = plan.holes[0]
    at_2mm = along(plan, hole, np.array([0.0, 2e-3]))
    limit = hole.motion.joints[0, 3] + at_2mm[1, 3] - at_2mm[0, 3]
    limits = plan.robot.limits
    upper = limits.upper.copy()
    upper[3] = limit
    robot = spoil(plan.robot, limits=spoil(limits, upper=upper))
    found = find_lead_in(Drilling(robot, plan.tool, hole.hole), hole.motion, 5e-3)
    assert found.length * 1e3 == pytest.approx(KEPT * 2.0, abs=1.1e-3)
    assert "A4 reaches its limit" in found.findings[0].message


def test_shortened_at_the_edge_of_reach(planned, plan_of):
    # drilled inwards from the side, so that further back the arm is stretched; a lead-in longer than any in practice
    hole = Hole("far", np.array([0.0, 0.2, 0.8]), np.array([0, -1.0, 0]), 0.01, np.array([0, 0, 1.0]))
    plan = plan_of(
        planned(hole, Profile.straight(0.01, *np.deg2rad([3, 0, -3])), near=(116.5, -91.7, -75.4, 80.4, 115.0, -15.7))
    )
    found = find_lead_in(Drilling(plan.robot, plan.tool, plan.holes[0].hole), plan.holes[0].motion, 0.4)
    assert "the arm is out of reach" in found.findings[0].message
    edge = along(plan, plan.holes[0], found.length / KEPT + np.array([0.0, 2e-6]))
    assert np.isfinite(edge[0]).all()
    assert np.isnan(edge[1]).all()


def test_a_joint_that_rests_all_along_may_rest_in_the_lead_in(published, planned, plan_of):
    # position 2 at a constant 180 deg: joint 4 does not turn (theory §6)
    hole = published(2).hole
    plan = plan_of(planned(hole, Profile.straight(0.02, np.pi, np.pi, np.pi), near=(-78.7, -87, 87.7, 0, 89.3, 101.3)))
    found = find_lead_in(Drilling(plan.robot, plan.tool, plan.holes[0].hole), plan.holes[0].motion, 2e-3)
    assert found.joints[3] == pytest.approx(plan.holes[0].motion.joints[0, 3], abs=1e-9)
    assert not any("A4" in finding.message for finding in found.findings)
