"""The verifier's own arm: published joint targets, a slow twin, and back and forth on every robot."""

import numpy as np
import pytest

from oracles.check_arm import forward
from zerorev.verify.arm import Posture, branch_of, hand, posture_of, skeleton, solve, with_turns


def random_joints(robot, count, seed):
    rng = np.random.default_rng(seed)
    return rng.uniform(robot.limits.lower, robot.limits.upper, (count, 6))


@pytest.mark.parametrize("position", [1, 2, 3])
def test_the_joint_targets_of_appendix_b_put_the_tip_where_the_program_says(kuka, drill, appendix_b, position):
    target, stroke, spins, joints = appendix_b[position]
    body = skeleton(kuka.arm, np.deg2rad(joints))
    tip = body.flange + np.einsum("ijn,j->in", body.R_base_flange, drill.T_flange_tcp[:3, 3])
    R = np.einsum("ijn,jk->ikn", body.R_base_flange, drill.T_flange_tcp[:3, :3])
    places = np.array(target)[:, None] - np.array([[stroke, 0, stroke], [0, 0, 0], [0, 0, 0]])
    assert np.linalg.norm(tip * 1e3 - places, axis=0).max() < 0.002
    np.testing.assert_allclose(R[:, 2], np.array([[-1.0, 0, 0]] * 3).T, atol=2e-6)  # Z_tcp against the plunge, +X
    # psi = 0 with Y_tcp along Y_base; psi turns it about Z_tcp = -X_base, towards -Z_base
    psi = np.rad2deg(np.arctan2(-R[2, 1], R[1, 1]))
    np.testing.assert_allclose((psi - spins + 180) % 360 - 180, 0, atol=2e-4)


def sums(R, wrist):
    """A pose that depends on neither stand-off nor spin, as `solve` takes it."""
    return tuple(tuple((value, 0.0, 0.0, 0.0) for value in column) for column in [*R.T.tolist(), wrist.tolist()])


def solved(arm, joints, posture):
    """The joints in a posture of the pose that joints (6,) reach, shape (6,)."""
    x, y, z, wrist = hand(arm, joints[None])[:, :, 0]
    return solve(arm, sums(np.stack([x, y, z], axis=-1), wrist), posture, np.zeros(1), np.zeros(1))[0]


def test_the_skeleton_ends_at_the_flange(robot):
    joints = random_joints(robot, 50, 1)
    body = skeleton(robot.arm, joints)
    poses = np.array([forward(robot.arm, row) for row in joints])
    np.testing.assert_allclose(body.flange.T, poses[:, :3, 3], atol=1e-14)
    np.testing.assert_allclose(np.moveaxis(body.R_base_flange, -1, 0), poses[:, :3, :3], atol=1e-14)
    elbows = np.linalg.norm(body.elbow - body.shoulder, axis=0)
    np.testing.assert_allclose(elbows, robot.arm.c2, atol=1e-14)
    forearms = np.linalg.norm(body.wrist - body.elbow, axis=0)
    np.testing.assert_allclose(forearms, np.linalg.norm([robot.arm.a2, robot.arm.b, robot.arm.c3]), atol=1e-14)


def test_inverse_gives_back_the_joints_it_came_from(robot):
    joints = random_joints(robot, 2_000, 2)
    back = np.array([solved(robot.arm, row, posture_of(robot.arm, row)) for row in joints])
    off = np.abs(np.angle(np.exp(1j * (back - joints)))).max(axis=1)
    # within a hair of a singular posture the angles are ill-conditioned, not wrong
    assert np.mean(off < 1e-10) > 0.999
    body, again = skeleton(robot.arm, joints), skeleton(robot.arm, back)
    np.testing.assert_allclose(again.flange, body.flange, atol=1e-10)
    np.testing.assert_allclose(again.R_base_flange, body.R_base_flange, atol=1e-10)


def test_all_eight_postures_reach_the_same_pose_on_eight_branches(robot):
    joints = random_joints(robot, 200, 3)
    body = skeleton(robot.arm, joints)
    branches = []
    for signs in np.ndindex(2, 2, 2):
        posture = Posture(*(1.0 - 2.0 * s for s in signs))
        back = np.array([solved(robot.arm, row, posture) for row in joints])
        found = np.isfinite(back).all(axis=1)
        again = skeleton(robot.arm, back[found])
        np.testing.assert_allclose(again.flange, body.flange[:, found], atol=1e-9)
        np.testing.assert_allclose(again.R_base_flange, body.R_base_flange[:, :, found], atol=1e-9)
        branches.append([branch_of(robot.arm, row) if ok else -1 for row, ok in zip(back, found, strict=True)])
    whole = [column for column in np.array(branches).T if (column >= 0).all()]
    assert len(whole) > 20
    assert all(sorted(column) == list(range(8)) for column in whole)


@pytest.mark.parametrize(
    ("joints_deg", "branch"),
    [
        ((0, -120, 120, 0, 60, 0), 0),  # upper arm leans back, forearm level: elbow above, reaching ahead
        ((0, -120, 120, 0, -60, 0), 1),
        ((0, 30, -100, 0, 60, 0), 2),  # upper arm below the level, forearm up: elbow below
        ((0, 30, -100, 0, -60, 0), 3),
        ((0, -150, -60, 0, 60, 0), 4),  # the arm leans over backwards, upper arm above the line
        ((0, -150, -60, 0, -60, 0), 5),
    ],
)
def test_branch_follows_the_conventions(kuka, joints_deg, branch):
    joints = np.deg2rad(np.array(joints_deg, dtype=float))
    assert branch_of(kuka.arm, joints) == branch
    assert branch_of(kuka.arm, joints + 2 * np.pi * np.array([0, 0, 0, 0, 0, 1])) == branch


def test_elbow_below_is_mirrored_behind_axis_1(kuka):
    """Half a turn of axis 1 with a mirrored arm reaches the same place: the elbow is above in both or below in both."""
    joints = np.deg2rad(np.array([10.0, -120, 120, 20, 60, 0]))
    heights = {}
    for reach in (1.0, -1.0):
        for elbow in (1.0, -1.0):
            back = solved(kuka.arm, joints, Posture(reach, elbow, 1.0))
            heights[branch_of(kuka.arm, back) & 6] = skeleton(kuka.arm, back[None]).elbow[2, 0]
    assert heights[0] > heights[2]
    assert heights[4] > heights[6]


def test_out_of_reach_and_singular_are_nan_without_a_warning(robot):
    ahead, level, none = Posture(1.0, 1.0, 1.0), np.eye(3), np.zeros(1)
    assert np.isnan(solve(robot.arm, sums(level, np.array([9.0, 0.0, 1.0])), ahead, none, none)).any()
    upright = np.array([robot.arm.a1, robot.arm.b, robot.arm.c1 + robot.arm.c2 + robot.arm.c3])
    assert solve(robot.arm, sums(level, upright), ahead, none, none).shape == (1, 6)


def test_turns_are_continued_and_whole():
    smooth = np.linspace(0, 40, 1000)[:, None] * np.array([1.0, -1, 0.5, 0, 0.1, -0.3])
    start = smooth[0] + 2 * np.pi * np.array([1, 0, -1, 0, 2, 0])
    wrapped = np.angle(np.exp(1j * smooth))
    np.testing.assert_allclose(with_turns(wrapped.copy(), start), smooth + start, atol=1e-12)
    holed = wrapped.copy()
    holed[500] = np.nan
    np.testing.assert_allclose(with_turns(holed, start)[-1], (smooth + start)[-1], atol=1e-12)
