"""The twist map says what the arm's own functions say at any point of it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from oracles.published import POSITIONS
from zerorev.files.io import read_robot
from zerorev.model.tool import Tool
from zerorev.motion.critical import kappa_of
from zerorev.motion.drilling import Drilling, joint_rates
from zerorev.motion.kinematics import inverse, jacobian, tcp_pose
from zerorev.report.scene.twist_map import LIMITED, NEAR_SINGULAR, OPEN, SINGULAR_BELOW, UNREACHED, twist_map

BRANCHES = [(0, 4), (1, 0), (2, 4), (0, 0), (0, None), (1, None), (2, None)]
IDS = [f"{POSITIONS[n].name}, {'all' if branch is None else branch}" for n, branch in BRANCHES]


@pytest.fixture(scope="module")
def maps(robot, tool):
    return {
        case: twist_map(Drilling(robot, tool, POSITIONS[case[0]].hole), case[1], shape=(31, 91)) for case in BRANCHES
    }


def joints_at(robot, tool, hole, s, p):
    """All eight branches at points (N,), shape (N, 8, 6)."""
    return inverse(robot, tcp_pose(hole, s, p) @ np.linalg.inv(tool.T_flange_tcp))


def zone_of(robot, joints):
    """Zone of one pose by the plain words of the definition: turn by turn, and the angles between the links."""
    if np.isnan(joints).any():
        return UNREACHED
    for angle, low, high in zip(joints, robot.limits.lower, robot.limits.upper, strict=True):
        if not any(low <= angle + turn * 2 * np.pi <= high for turn in range(-3, 4)):
            return LIMITED
    arm = robot.arm
    q = joints * np.array(arm.sign) - np.array(arm.offset)
    shoulder = np.array([arm.a1, arm.c1])
    elbow = shoulder + arm.c2 * np.array([np.sin(q[1]), np.cos(q[1])])
    bend = q[1] + q[2]
    wrist = elbow + arm.a2 * np.array([np.cos(bend), -np.sin(bend)]) + arm.c3 * np.array([np.sin(bend), np.cos(bend)])
    upper, fore = elbow - shoulder, wrist - elbow
    across = abs(upper[0] * fore[1] - upper[1] * fore[0]) / np.linalg.norm(upper) / np.linalg.norm(fore)
    ahead = abs(wrist[0]) / (abs(arm.a1) + np.linalg.norm(upper) + np.linalg.norm(fore))
    return NEAR_SINGULAR if min(across, ahead, abs(np.sin(q[4]))) < SINGULAR_BELOW else OPEN


@pytest.mark.parametrize("case", BRANCHES, ids=IDS)
def test_zones_are_those_of_the_inverse_kinematics(robot, tool, maps, case):
    found, hole = maps[case], POSITIONS[case[0]].hole
    random = np.random.default_rng(case[0])
    s, p = (random.integers(0, n, 300) for n in found.zone.shape)
    joints = joints_at(robot, tool, hole, found.standoff[s], found.psi[p])
    branches = range(8) if case[1] is None else [case[1]]
    zones = np.array([[zone_of(robot, pose[branch]) for branch in branches] for pose in joints])
    assert (found.zone[s, p] == zones.min(axis=1)).all()
    shown = zones[np.arange(300), [list(branches).index(branch) for branch in found.best[s, p]]]
    assert (shown == found.zone[s, p]).all()


@pytest.mark.parametrize("case", BRANCHES, ids=IDS)
def test_spread_is_that_of_the_best_branch(robot, tool, maps, case):
    found, hole = maps[case], POSITIONS[case[0]].hole
    random = np.random.default_rng(case[0])
    s, p = (random.integers(0, n, 200) for n in found.zone.shape)
    kappa = np.rad2deg(kappa_of(*joint_rates(Drilling(robot, tool, hole), found.standoff[s], found.psi[p]))) * 1e-3
    spread = np.ptp(kappa, axis=-1)  # (N, 8)
    here = found.spread[s, p]
    known = np.isfinite(here)
    assert known.sum() > 50
    assert here[known] == pytest.approx(spread[np.arange(200), found.best[s, p]][known])
    assert np.isnan(here[found.zone[s, p] == UNREACHED]).all()
    if case[1] is None:
        joints = joints_at(robot, tool, hole, found.standoff[s], found.psi[p])
        zones = np.array([[zone_of(robot, pose[branch]) for branch in range(8)] for pose in joints])
        as_good = np.where(zones == found.zone[s, p][:, None], spread, np.inf).min(axis=1)
        assert here[known] == pytest.approx(as_good[known])


@pytest.mark.parametrize("case", BRANCHES, ids=IDS)
def test_a_line_is_where_spin_does_not_move_its_joint(robot, tool, maps, case):
    found, hole = maps[case], POSITIONS[case[0]].hole
    assert found.lines
    for line in found.lines:
        s, p = line.points.T
        assert (np.diff(np.sign(np.diff(s))) == 0).all() or len(s) > 2
        rates = [
            joint_rates(Drilling(robot, tool, hole), s, p + side)[1][:, line.branch, line.joint - 1]
            for side in (-1e-5, 0, 1e-5)
        ]
        assert np.abs(rates[1]).max() < 1e-8
        crossing = ~np.isnan(rates[0] * rates[2])  # one side of a line along the edge of reach is nothing
        assert (rates[0] * rates[2] < 0)[crossing].mean() > 0.95  # a line may touch without crossing at its vertex


def test_no_sign_change_is_missed(robot, tool, maps):
    """Where theta_psi changes sign between neighbouring spins, a line of that joint runs between them."""
    found, hole = maps[0, 4], POSITIONS[0].hole
    s = found.standoff[15]
    theta = joint_rates(Drilling(robot, tool, hole), np.full(found.psi.size, s), found.psi)[1][:, 4]
    for i in range(6):
        rate = theta[:, i]
        for n in np.flatnonzero(rate[:-1] * rate[1:] < 0):
            ours = [line.points for line in found.lines if line.joint == i + 1]
            crossed = [np.interp(s, *points[np.argsort(points[:, 0])].T) for points in ours if np.ptp(points[:, 0]) > 0]
            assert any(found.psi[n] <= psi <= found.psi[n + 1] for psi in crossed), (i, n)


@pytest.mark.parametrize("case", BRANCHES, ids=IDS)
def test_edges_lie_where_the_zone_changes(robot, tool, maps, case):
    found, hole = maps[case], POSITIONS[case[0]].hole
    branches = range(8) if case[1] is None else [case[1]]

    def zones(s, p):
        joints = joints_at(robot, tool, hole, s, p)
        return np.array([min(zone_of(robot, pose[branch]) for branch in branches) for pose in joints])

    ds, dp = found.standoff[1] - found.standoff[0], found.psi[1] - found.psi[0]
    for region in found.regions:
        for edge in region.edges:
            s, p = edge[:: max(1, len(edge) // 25)].T
            around = [
                zones(np.clip(s + a * ds / 200, found.standoff[0], found.standoff[-1]), p + b * dp / 200) >= region.zone
                for a, b in ((1, 0), (-1, 0), (0, 1), (0, -1))
            ]
            assert (np.any(around, axis=0) & ~np.all(around, axis=0)).all()


@pytest.mark.parametrize("case", BRANCHES, ids=IDS)
def test_regions_cover_their_zones(maps, case):
    """By area: what the rings enclose, holes taken off, is the share of the grid with such a zone."""
    found = maps[case]
    whole = np.ptp(found.standoff) * np.ptp(found.psi)
    for region in found.regions:
        # contourpy winds holes the other way round, so that signed areas add up
        area = abs(sum(0.5 * np.sum(r[:-1, 0] * r[1:, 1] - r[1:, 0] * r[:-1, 1]) for r in region.rings))
        assert area / whole == pytest.approx((found.zone >= region.zone).mean(), abs=0.02)
        for ring in region.rings:
            assert (ring[0] == ring[-1]).all()


def test_the_bits_say_which_joints_and_which_singularity(robot, tool, maps):
    for found in maps.values():
        assert (found.limited[found.zone == LIMITED] > 0).all()
        assert (found.limited[found.zone < LIMITED] == 0).all()
        assert (found.singular[found.zone == NEAR_SINGULAR] > 0).all()
        assert (found.singular[found.zone == OPEN] == 0).all()
    found = maps[0, 4]
    near = np.argwhere(found.zone == NEAR_SINGULAR)
    assert set(found.singular[found.zone == NEAR_SINGULAR].tolist()) == {2}  # the elbow, at the edge of its reach
    for s, p in near:
        pose = joints_at(robot, tool, POSITIONS[0].hole, found.standoff[s : s + 1], found.psi[p : p + 1])[0, 4]
        assert np.linalg.cond(jacobian(robot, tool, pose)) > 20


def test_a_tool_without_lever_has_joints_that_spin_never_moves(robot):
    straight = Tool("straight", np.array([[1.0, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0.1], [0, 0, 0, 1]]))
    hole = replace(POSITIONS[0].hole, target=np.array([0.4, 0.1, 0.6]))
    found = twist_map(Drilling(robot, straight, hole), 4, shape=(11, 31))
    assert (found.zone < UNREACHED).any()
    assert {1, 2, 3} <= set(found.stuck)
    assert not {1, 2, 3} & {line.joint for line in found.lines}


@pytest.mark.parametrize("name", ["abb_irb4600_60_205", "staubli_tx2_90l", "yaskawa_gp8"])
def test_other_robots(tool, name):
    robot = read_robot(name)
    found = twist_map(Drilling(robot, tool, POSITIONS[0].hole), None, corner=-1e-3, shape=(11, 31))
    assert found.standoff[0] == -1e-3
    assert (found.zone < UNREACHED).any()
    assert np.isfinite(found.spread[found.zone < UNREACHED]).mean() > 0.9
