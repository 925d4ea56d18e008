"""The slow twin of the kernels: elementary transforms, axes and cross products, one configuration at a time.

It shares the robot's numbers with `zerorev` and nothing else. Lengths in m, angles in rad.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np

X, Y, Z = np.eye(3)


def rotation(axis, angle):
    """Rodrigues' formula, as a homogeneous transform."""
    K = np.cross(np.eye(3), axis)
    T = np.eye(4)
    T[:3, :3] += np.sin(angle) * K + (1 - np.cos(angle)) * K @ K
    return T


def translation(x, y, z):
    T = np.eye(4)
    T[:3, 3] = x, y, z
    return T


def model_angles(robot, joints):
    return np.array(robot.arm.sign) * joints - np.array(robot.arm.offset)


def joint_frames(robot, joints):
    """(T_base_i, axis): a frame on each joint's axis before the joint turns, and the axis in it; then the flange."""
    a, q = robot.arm, model_angles(robot, joints)
    links = [
        (np.eye(4), Z),
        (translation(a.a1, a.b, a.c1), Y),
        (translation(0, 0, a.c2), Y),
        (translation(a.a2, 0, a.c3), Z),
        (np.eye(4), Y),
        (np.eye(4), Z),
    ]
    T, frames = np.eye(4), []
    for (link, axis), angle in zip(links, q, strict=True):
        T = T @ link
        frames.append((T, axis))
        T = T @ rotation(axis, angle)
    return frames, T @ translation(0, 0, a.c4)


def forward(robot, joints):
    """T_base_flange of six controller angles (Brandstoetter et al. 2014, fig. 1)."""
    return joint_frames(robot, joints)[1]


def points_of_arm(robot, joints):
    """Shoulder, elbow and wrist centre in the plane of the arm: (forward, up) of each, axis 1 at forward = 0."""
    frames, _ = joint_frames(robot, joints)
    ahead = rotation(Z, model_angles(robot, joints)[0])[:3, 0]
    return [np.array([T[:3, 3] @ ahead, T[2, 3]]) for T, _ in (frames[1], frames[2], frames[4])]


def jacobian(robot, joints, point):
    """Geometric Jacobian of a base-frame point on the flange: velocity of the point, then turning; shape (6, 6)."""
    frames, _ = joint_frames(robot, joints)
    columns = []
    for (T, axis), sign in zip(frames, robot.arm.sign, strict=True):
        turning = sign * T[:3, :3] @ axis
        columns.append(np.concatenate([np.cross(turning, point - T[:3, 3]), turning]))
    return np.array(columns).T


def tcp(robot, tool, joints):
    return forward(robot, joints) @ tool.T_flange_tcp


def twists(direction):
    """(v, omega) of moving straight back out, and of spinning about the drill axis (theory §1)."""
    return np.array([*-direction, 0, 0, 0]), np.array([0, 0, 0, *-direction])


def rates(robot, tool, direction, joints):
    """theta_s = J^-1 [-d; 0] and theta_psi = J^-1 [0; Z_tcp] (theory §1)."""
    J = jacobian(robot, joints, tcp(robot, tool, joints)[:3, 3])
    return tuple(np.linalg.solve(J, twist) for twist in twists(direction))


def drill_pose(hole, standoff, psi):
    """T_base_tcp: Z_tcp against the plunge, Y_tcp turned by psi about it out of psi_zero."""
    z = -hole.direction
    y = rotation(z, psi)[:3, :3] @ hole.psi_zero
    T = np.eye(4)
    T[:3, :3] = np.array([np.cross(y, z), y, z]).T
    T[:3, 3] = hole.target - standoff * hole.direction
    return T


def error_twist(T_have, T_want):
    """(translation, rotation vector) from one pose to another, for poses that lie close together."""
    R = T_want[:3, :3] @ T_have[:3, :3].T
    turn = np.array([R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]]) / 2
    return np.concatenate([T_want[:3, 3] - T_have[:3, 3], turn])


def trace(robot, tool, hole, standoff, psi, seed):
    """Joints along points of the twist plane, shape (N, 6): Newton's method from each point to the next.

    Knows neither branches nor closed forms: it only follows the arm from where it stands.
    """
    joints, out = np.array(seed, dtype=float), []
    for s, p in zip(standoff, psi, strict=True):
        T_want = drill_pose(hole, s, p)
        for _ in range(20):
            T_have = tcp(robot, tool, joints)
            error = error_twist(T_have, T_want)
            if np.abs(error).max() < 1e-13:
                break
            joints = joints + np.linalg.solve(jacobian(robot, joints, T_have[:3, 3]), error)
        out.append(joints)
    return np.array(out)


def reversals(joints, nil=1e-9):
    """Rows at which each joint of a densely sampled path changes direction, steps up to `nil` [rad] left out."""
    places = []
    for steps in np.diff(joints, axis=0).T:
        moves = [(row, np.sign(step)) for row, step in enumerate(steps) if abs(step) > nil]
        places.append([row for (_, before), (row, now) in pairwise(moves) if before != now])
    return places


# -- the two DH tables of the thesis, in mm and deg as printed there --------------------------------------------------

TABLE_1 = (  # alpha_{i-1}, a_{i-1}, d_i, offset of theta_i: modified DH
    (180, 0, -400, 0),
    (90, 25, 0, 0),
    (0, 335, 0, -90),
    (90, 25, -365, 0),
    (-90, 0, 0, 0),
    (90, 0, -90, 0),
)
TABLE_2 = (  # offset of theta_i, d_i, a_i, alpha_i: standard DH
    (0, 0, 25, 90),
    (0, 0, 335, 180),
    (-90, 0, -25, 90),
    (0, -365, 0, 90),
    (0, 0, 0, -90),
    (180, -90, 0, 0),
)


def modified_dh(theta):
    """T_0_6 of Table 1 (thesis eq. 3.3, 3.4; row 3, column 4 with the sign of theory §6)."""
    T = np.eye(4)
    for (alpha, a, d, offset), angle in zip(TABLE_1, theta, strict=True):
        al, th = np.deg2rad(alpha), angle + np.deg2rad(offset)
        ca, sa, ct, st = np.cos(al), np.sin(al), np.cos(th), np.sin(th)
        T = T @ np.array(
            [
                [ct, -st, 0, a / 1e3],
                [st * ca, ct * ca, -sa, -d / 1e3 * sa],
                [st * sa, ct * sa, ca, d / 1e3 * ca],
                [0, 0, 0, 1],
            ]
        )
    return T


def standard_dh(theta):
    """T_0_6 of Table 2: turn about z, shift along z, shift along x, turn about x."""
    T = np.eye(4)
    for (offset, d, a, alpha), angle in zip(TABLE_2, theta, strict=True):
        turn, twist = rotation(Z, angle + np.deg2rad(offset)), rotation(X, np.deg2rad(alpha))
        T = T @ turn @ translation(a / 1e3, 0, d / 1e3) @ twist
    return T
