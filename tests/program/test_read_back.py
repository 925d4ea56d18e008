"""Holes in any direction on tilted parts: the file's poses, rotations and axis values are the plan's."""

import itertools

import numpy as np
import pytest

from zerorev.kinematics import forward, tcp_pose
from zerorev.model.hole import Hole
from zerorev.model.profile import Profile
from zerorev.motion import joint_path
from zerorev.program.export import export

DIRECTIONS = {
    "up": (0, 0, 1),
    "down": (0, 0, -1),
    "ahead": (1, 0, 0),
    "back": (-1, 0, 0),
    "left": (0, 1, 0),
    "oblique": (1, -2, -3),
    "nearly down": (1e-7, -2e-7, -1),
    "hardly off down": (1e-12, 1e-12, -1),
}
SPINS = {"small": (20, -10, -35), "across 180": (170, 200, 230), "wide": (70, 10, -80)}
TARGETS = [(0.45, 0.1, 0.6), (0.4, -0.2, 0.75), (0.35, 0.25, 0.45), (0.3, 0.0, 0.9)]
DEPTH = 0.012
AS_WRITTEN = np.array([[0, 0, 1], [0, 1, 0], [-1, 0, 0]])  # X = -Z_tcp, Y = Y_tcp, Z = X_tcp


def rotation(*rpy_deg):
    from scipy.spatial.transform import Rotation

    return Rotation.from_euler("ZYX", rpy_deg, degrees=True).as_matrix()


PARTS = {
    "base": (np.eye(3), (0, 0, 0)),
    "tilted": (rotation(25, -40, 15), (0.3, 0.2, 0.1)),
    "on its side": (rotation(0, 90, 0), (0.5, 0, 0.5)),
    "upside down": (rotation(180, 0, 180), (0, -0.4, 0.2)),
}


def runnable(kuka, drill, direction, spins):
    """A hole in a direction, and a motion of the given spins from wherever the robot can begin it."""
    for target in TARGETS:
        axis = np.array(direction, dtype=float)
        across = np.cross(axis, [0.3, 0.9, 0.31])
        hole = Hole("h", np.array(target), axis, DEPTH, across)
        for start in range(0, 360, 30):
            profile = Profile.straight(DEPTH, *np.deg2rad(np.array(spins) + start))
            for branch in range(8):
                if joint_path(kuka, drill, hole, profile, branch, samples=400).runs:
                    return hole, profile
    pytest.fail("no target can be drilled")


@pytest.mark.parametrize("spins", SPINS.values(), ids=SPINS)
@pytest.mark.parametrize("direction", DIRECTIONS.values(), ids=DIRECTIONS)
def test_any_direction_on_any_part(direction, spins, krl, kuka, drill, planned, plan_of):
    hole, profile = runnable(kuka, drill, direction, spins)
    hole_plan = planned(hole, profile)
    for R, p in PARTS.values():
        T_base_part = np.eye(4)
        T_base_part[:3, :3], T_base_part[:3, 3] = R, p
        plan = plan_of(hole_plan, T_base_part=T_base_part, lead_in=2e-3, feed_retract=5e-4, feed_plunge=1e-4)
        ptp, *moves = krl.read(export(plan).text).moves
        check_poses(plan, hole_plan, ptp, moves)
        check_angles(moves, profile)


def check_poses(plan, hole_plan, ptp, moves):
    """Against the poses of the plan, made here from its spins."""
    profile, hole = hole_plan.motion.profile, hole_plan.hole
    T_part_base = np.linalg.inv(plan.T_base_part)
    for move, s, psi in zip(moves, profile.standoff, profile.psi, strict=True):
        wanted = T_part_base @ tcp_pose(hole, s, psi)
        np.testing.assert_allclose(move.T_part_tool[:3, 3], wanted[:3, 3] * 1e3, rtol=0, atol=5e-4)
        assert angle(move.T_part_tool[:3, :3], wanted[:3, :3] @ AS_WRITTEN) < 5e-4
        # and through the $BASE and $TOOL of the file, where the flange must be
        T_flange_tcp = plan.tool.T_flange_tcp.copy()
        T_flange_tcp[:3, 3] *= 1e3
        T_flange_tcp[:3, :3] = T_flange_tcp[:3, :3] @ AS_WRITTEN
        np.testing.assert_allclose(move.state["$TOOL"], T_flange_tcp, rtol=0, atol=1e-4)
        np.testing.assert_allclose(move.T_base_tool[:3, 3], tcp_pose(hole, s, psi)[:3, 3] * 1e3, rtol=0, atol=1e-3)
    # the axis values lead to a point of the plunge leg's line, behind the start, turned as the leg goes on
    reached = forward(plan.robot, np.deg2rad(ptp.axes))
    reached[:3, 3] *= 1e3
    reached = reached @ ptp.state["$TOOL"]
    behind = -(reached[:3, 3] - hole.target * 1e3) @ hole.direction - profile.standoff[0] * 1e3
    assert -1e-3 < behind < plan.settings.lead_in * 1e3 + 1e-3
    lead_in = tcp_pose(
        hole, profile.standoff[0] + behind * 1e-3, profile.psi[0] + profile.twist_rate[0] * behind * 1e-3
    )
    np.testing.assert_allclose(reached[:3, 3], lead_in[:3, 3] * 1e3, rtol=0, atol=1e-3)
    assert angle(reached[:3, :3], lead_in[:3, :3] @ AS_WRITTEN) < 1e-3


def check_angles(moves, profile):
    """A and B constant, C alone turns, by what the spin does and the short way round."""
    assert len({(move.values["A"], move.values["B"]) for move in moves}) == 1
    C = np.array([move.values["C"] for move in moves])
    assert ((C > -180) & (C <= 180)).all()
    steps = (np.diff(C) + 180) % 360 - 180
    assert (np.abs(steps) <= 120).all()
    for a, b in itertools.pairwise(moves):
        turned = angle(a.T_part_tool[:3, :3], b.T_part_tool[:3, :3])
        assert turned == pytest.approx(abs((b.values["C"] - a.values["C"] + 180) % 360 - 180), abs=1e-3)
    assert steps.sum() == pytest.approx(-np.rad2deg(profile.psi[-1] - profile.psi[0]), abs=1e-3)


def angle(a, b):
    """[deg], from the skew part, which keeps its digits near 0, and the trace near 180 deg."""
    R = a.T @ b
    skew = np.linalg.norm([R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]])
    return float(np.rad2deg(np.arctan2(skew, np.trace(R) - 1)))


@pytest.mark.parametrize(("direction", "B"), [((0, 0, 1), -90), ((0, 0, -1), 90)])
def test_straight_up_and_down_take_A_as_zero(direction, B, krl, kuka, drill, planned, plan_of):
    hole, profile = runnable(kuka, drill, direction, SPINS["small"])
    moves = krl.read(export(plan_of(planned(hole, profile))).text).moves[1:]
    assert {(move.values["A"], move.values["B"]) for move in moves} == {(0.0, float(B))}
    assert len({move.values["C"] for move in moves}) == len(moves)


def test_more_than_three_breakpoints(krl, published, planned, plan_of):
    first = published(1)
    standoff, psi = np.array([50, 30, 10, 0, 20, 50]), np.array([14.16, 5.0, -1.0, -5.94, -15.0, -30.46])
    profile = Profile(standoff * 1e-3, np.deg2rad(psi))
    hole = planned(first.hole, profile, near=np.rad2deg(first.motion.joints[0]))
    plan = plan_of(hole, feed_plunge=5e-3, feed_retract=20e-3)
    ptp, *moves = krl.read(export(plan).text).moves
    assert [move.blended for move in moves] == [True] * 5 + [False]
    assert [move.state["$VEL.CP"] for move in moves] == [0.005] * 4 + [0.02] * 2
    check_poses(plan, hole, ptp, moves)
    check_angles(moves, profile)
