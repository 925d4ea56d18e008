"""The verifier's own arm: published joint targets, a slow twin, and back and forth on every robot."""

import numpy as np
import pytest

from zerorev.verify.arm import Posture, branch_of, hand, posture_of, skeleton, solve, with_turns


def elementary(axis, angle):
    c, s = np.cos(angle), np.sin(angle)
    i, j = {"y": (2, 0), "z": (0, 1)}[axis]
    T = np.eye(4)
    T[i, i], T[i, j], T[j, i], T[j, j] = c, -s, s, c
    return T


def shift(x, y, z):
    T = np.eye(4)
    T[:3, 3] = x, y, z
    return T


def flange_slowly(arm, joints):
    """The same product, one 4x4 matrix after the other."""
    q = [s * angle - o for s, angle, o in zip(arm.sign, joints, arm.offset, strict=True)]
    T = elementary("z", q[0]) @ shift(arm.a1, 0, arm.c1) @ elementary("y", q[1]) @ shift(0, 0, arm.c2)
    T = T @ elementary("y", q[2]) @ shift(arm.a2, arm.b, arm.c3)
    return T @ elementary("z", q[3]) @ elementary("y", q[4]) @ elementary("z", q[5]) @ shift(0, 0, arm.c4)


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


def test_forward_kinematics_is_the_product_of_elementary_motions(robot):
    joints = random_joints(robot, 50, 1)
    body = skeleton(robot.arm, joints)
    slow = np.array([flange_slowly(robot.arm, row) for row in joints])
    np.testing.assert_allclose(body.flange.T, slow[:, :3, 3], atol=1e-14)
    np.testing.assert_allclose(np.moveaxis(body.R_base_flange, -1, 0), slow[:, :3, :3], atol=1e-14)


def test_inverse_gives_back_the_joints_it_came_from(robot):
    joints = random_joints(robot, 20_000, 2)
    body = skeleton(robot.arm, joints)
    back = solve(robot.arm, hand(robot.arm, joints), posture_of(robot.arm, joints))
    off = np.abs(np.angle(np.exp(1j * (back - joints)))).max(axis=1)
    # within a hair of a singular posture the angles are ill-conditioned, not wrong
    assert np.mean(off < 1e-10) > 0.999
    again = skeleton(robot.arm, back)
    np.testing.assert_allclose(again.flange, body.flange, atol=1e-10)
    np.testing.assert_allclose(again.R_base_flange, body.R_base_flange, atol=1e-10)


def test_all_eight_postures_reach_the_same_pose_on_eight_branches(robot):
    joints = random_joints(robot, 200, 3)
    body = skeleton(robot.arm, joints)
    branches = []
    for signs in np.ndindex(2, 2, 2):
        posture = Posture(*(np.array([1.0 - 2 * s]) for s in signs))
        back = solve(robot.arm, hand(robot.arm, joints), posture)
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
    joints = np.deg2rad(np.array([[10.0, -120, 120, 20, 60, 0]]))
    heights = {}
    for reach in (1.0, -1.0):
        for elbow in (1.0, -1.0):
            posture = Posture(np.array([reach]), np.array([elbow]), np.array([1.0]))
            back = solve(kuka.arm, hand(kuka.arm, joints), posture)
            limb = skeleton(kuka.arm, back)
            heights[branch_of(kuka.arm, back[0]) & 6] = limb.elbow[2, 0]
    assert heights[0] > heights[2]
    assert heights[4] > heights[6]


def test_out_of_reach_and_singular_are_nan_without_a_warning(robot):
    ahead = Posture(*(np.ones(1) for _ in range(3)))
    level = np.eye(3)[:, :, None]
    far = np.concatenate([level, [[[9.0], [0.0], [1.0]]]])
    assert np.isnan(solve(robot.arm, far, ahead)).any()
    stretched = [[[robot.arm.a1], [robot.arm.b], [robot.arm.c1 + robot.arm.c2 + robot.arm.c3]]]
    assert solve(robot.arm, np.concatenate([level, stretched]), ahead).shape == (1, 6)


def test_turns_are_continued_and_whole():
    smooth = np.linspace(0, 40, 1000)[:, None] * np.array([1.0, -1, 0.5, 0, 0.1, -0.3])
    start = smooth[0] + 2 * np.pi * np.array([1, 0, -1, 0, 2, 0])
    wrapped = np.angle(np.exp(1j * smooth))
    np.testing.assert_allclose(with_turns(wrapped.copy(), start), smooth + start, atol=1e-12)
    holed = wrapped.copy()
    holed[500] = np.nan
    np.testing.assert_allclose(with_turns(holed, start)[-1], (smooth + start)[-1], atol=1e-12)
