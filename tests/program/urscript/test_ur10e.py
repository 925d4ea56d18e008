"""The writer's numbers on a UR10e: its arm from the published lengths, since none of its class ships yet."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from oracles import urscript_reader
from zerorev.program.neutral import Move, Point, build_program
from zerorev.program.urscript.text import rotation_vector
from zerorev.program.urscript.write import urscript_files

# UniversalRobots/Universal_Robots_ROS2_Description at 2221ec0, config/ur10e: standard Denavit-Hartenberg [m], [rad]
D = (0.1807, 0, 0, 0.17415, 0.11985, 0.11655)
A = (0, -0.6127, -0.57155, 0, 0, 0)
ALPHA = (np.pi / 2, 0, 0, np.pi / 2, -np.pi / 2, 0)
HALF_A_TURN = np.diag([-1.0, -1.0, 1.0, 1.0])  # ROS base_link against the base that the pendant shows
AXES = np.diag([1.0, -1.0, -1.0, 1.0])


def flange(joints):
    """T_base_flange as the pendant shows it, shape (4, 4)."""
    T = np.eye(4)
    for angle, d, a, alpha in zip(joints, D, A, ALPHA, strict=True):
        (c, ca), (s, sa) = (f(np.array([angle, alpha])) for f in (np.cos, np.sin))
        T = T @ np.array([[c, -s * ca, s * sa, a * c], [s, c * ca, -c * sa, a * s], [0, sa, ca, d], [0, 0, 0, 1]])
    return T


def test_the_stretched_arm_is_where_the_pendant_shows_it():
    """All joints at 0: stretched along -X, the flange beside it, its axis along -Y."""
    T = flange(np.zeros(6))
    np.testing.assert_allclose(T[:3, 3], [-1.18425, -0.2907, 0.06085], atol=1e-12)
    np.testing.assert_allclose(rotation_vector(T[:3, :3]), [np.pi / 2, 0, 0], atol=1e-12)


@pytest.mark.parametrize("part", ["base", "tilted"])
def test_poses_and_joints_of_a_program(part, plan_called):
    """Every point once as a pose and once as joints: read from the file, both are one place."""
    T_root_part = np.eye(4)
    if part == "tilted":
        T_root_part[:3, :3] = Rotation.from_euler("ZYX", (25, -40, 15), degrees=True).as_matrix()
        T_root_part[:3, 3] = 0.7, -0.2, 0.3
    program = build_program(plan_called("position 1"))
    robot = replace(program.robot, name="ur10e", base_in_root=(0.0, 0.0, 0.0, 0.0, 0.0, np.pi))
    joints = np.random.default_rng(1).uniform(-2 * np.pi, 2 * np.pi, (40, 6))
    (hole,) = program.holes
    points = [
        Point(np.linalg.inv(T_root_part) @ HALF_A_TURN @ flange(q) @ program.tool.T_flange_tcp, q, 0.0, 0.0)
        for q in joints
    ]
    moves = [Move(point, 1e-2, 5e-3, 0.0, "plunge", "", linear) for point in points for linear in (True, False)]
    hole = replace(hole, way=joints[:1], start=points[0], moves=tuple(moves))
    program = replace(program, robot=robot, T_base_part=T_root_part, holes=(hole,))
    script = urscript_reader.read(urscript_files(program, "ur10e", ())["ur10e"])
    np.testing.assert_allclose(script.T_base_part, HALF_A_TURN @ T_root_part, atol=3e-9)
    np.testing.assert_allclose(script.T_flange_tool, program.tool.T_flange_tcp @ AXES, atol=3e-9)
    straight = [move for move in script.moves if move.kind == "straight"]
    jointly = [move for move in script.moves if move.kind == "jointly"]
    assert len(straight) == len(jointly) == len(joints)
    for q, pose, own in zip(joints, straight, jointly, strict=True):
        np.testing.assert_allclose(own.joints, q, atol=0.51e-9)
        np.testing.assert_allclose(flange(own.joints) @ script.T_flange_tool, pose.T_base_tool, atol=2e-8)
        assert own.time == pytest.approx(2.0)
