from __future__ import annotations

import numpy as np
import pytest

from zerorev.model.tool import Tool
from zerorev.motion.kinematics import inverse, tcp_pose
from zerorev.motion.links import chain, link_frames
from zerorev.report.scene.arm_shapes import arm_solids, rings, tool_solids


def test_the_tip_drills_the_hole(robot, tool, position):
    poses = tcp_pose(position.hole, [0.0, 0.02, 0.05], [0.1, 0.0, -0.2])
    joints = inverse(robot, poses @ np.linalg.inv(tool.T_flange_tcp))[:, position.branch]
    assert link_frames(robot, joints)[:, 5] @ tool.T_flange_tcp == pytest.approx(poses, abs=1e-9)


def test_solids_are_solid_and_within_reach(any_robot):
    arm = any_robot.arm
    whole = arm.c1 + arm.c2 + np.hypot(arm.c3, arm.a2) + arm.c4
    links = arm_solids(any_robot)
    assert len(links) == 7
    for solids in links:
        assert solids
        for solid in solids:
            length = np.linalg.norm(np.subtract(solid.end, solid.start))
            assert min(solid.radii) > 0
            assert length > 0 or (solid.kind == "plate" and solid.thickness > 0)
            assert max(np.abs([*solid.start, *solid.end, *solid.radii])) < whole
    paints = {solid.paint for solids in links for solid in solids}
    assert {f"A{n}" for n in range(1, 7)} <= paints


def test_the_upper_arm_ends_at_the_elbow_and_the_wrist_at_the_flange(any_robot):
    """What is drawn meets at the very axes: heights of a link's solids above its frame."""
    links, arm = arm_solids(any_robot), any_robot.arm
    assert max(solid.end[2] for solid in links[2]) == pytest.approx(arm.c2)
    assert max(solid.end[2] for solid in links[6]) == pytest.approx(0.0, abs=1e-12)
    assert max(solid.end[2] for solid in links[5]) < arm.c4
    assert min(solid.start[2] for solid in links[4]) > -arm.c3


def test_rings_go_around_the_housings(any_robot):
    frames = len(chain(any_robot))
    assert len(rings(any_robot)) == frames
    assert all(radius > 0 for _, radius in rings(any_robot))


@pytest.mark.parametrize(
    ("tcp_mm", "rpy_deg"),
    [((100, 0, 65), (0, -90, 0)), ((0, 0, 220), (180, 0, 0)), ((60, 40, 150), (180, 30, 0)), ((0, 0, 1), (0, 0, 0))],
)
def test_the_drill_lies_on_its_axis_and_ends_at_the_tip(robot, tcp_mm, rpy_deg):
    tool = Tool.from_mm_deg(tcp_mm, rpy_deg)
    tip, back = tool.T_flange_tcp[:3, 3], tool.T_flange_tcp[:3, 2]
    solids = [solid for solid in tool_solids(robot, tool) if solid.start != (0.0, 0.0, 0.0)]
    assert len(solids) >= 5
    for solid in solids:
        for place in (solid.start, solid.end):
            assert np.cross(np.subtract(place, tip), back) == pytest.approx(np.zeros(3), abs=1e-12)
            assert np.subtract(place, tip) @ back >= -1e-12
        assert np.subtract(solid.end, solid.start) @ back > 0
    assert min(np.linalg.norm(np.subtract(solid.start, tip)) for solid in solids) < 1e-12
