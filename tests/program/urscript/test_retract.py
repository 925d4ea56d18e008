"""Out of a hole in which the robot has stopped: the program is run by a small interpreter, from places in the hole."""

import re
from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from oracles import arm
from oracles.urscript_reader import pose
from zerorev.program.export import retract_program

AXES = np.diag([1.0, -1.0, -1.0, 1.0])


class HaltError(Exception):
    """The program stopped by itself."""


def as_vector(T):
    return np.array([*T[:3, 3], *Rotation.from_matrix(T[:3, :3]).as_rotvec()])


class P:
    """`p[...]` in Python."""

    def __getitem__(self, numbers):
        return np.array(numbers, dtype=float)


def run(text, T_base_tool):
    """The motions that the program commands, of a robot whose tool stands somewhere: a few lines of Python."""
    moves, lines = [], []
    for line in (line.split("#")[0].rstrip() for line in text.splitlines()):
        inside = "    " if line.startswith("    ") else "  "
        code = line.strip().removeprefix("local ")
        if re.match(r"def |end$", code) or not code:
            continue
        lines.append(inside[2:] * 2 + ("halt()" if code == "halt" else code))

    def halt():
        raise HaltError

    known = {
        "p": P(), "halt": halt, "sync": lambda: None, "popup": lambda *words: None,
        "set_tcp": lambda tool: moves.append(("tool", tool)), "set_payload": lambda mass, centre: None,
        "get_actual_tcp_pose": lambda: as_vector(T_base_tool),
        "pose_inv": lambda a: as_vector(np.linalg.inv(pose(a))),
        "pose_trans": lambda a, b: as_vector(pose(a) @ pose(b)),
        "movel": lambda end, a, v: moves.append(("movel", pose(end))),
    }  # fmt: skip
    exec("\n".join(lines), known)  # a text that was just exported
    return moves


def standing(hole, standoff, psi, off=(0, 0, 0), turn=(0, 0, 0)):
    """Pose of the tool, somewhat beside the hole's axis [m, deg]."""
    T = np.eye(4)
    T[:3, :3], T[:3, 3] = Rotation.from_euler("xyz", turn, degrees=True).as_matrix(), off
    return arm.drill_pose(hole, standoff, psi) @ AXES @ T


@pytest.fixture(params=["base", "tilted", "turned base"])
def case(request, plan_called):
    """A plan, and the pose of the controller's base in the arm's."""
    plan, T = plan_called("position 1"), np.eye(4)
    if request.param == "tilted":
        T[:3, :3], T[:3, 3] = Rotation.from_euler("ZYX", (25, -40, 15), degrees=True).as_matrix(), (0.3, 0.2, 0.1)
        return replace(plan, T_base_part=T), np.eye(4)
    if request.param == "turned base":
        robot = replace(plan.robot, base_in_root=(0.0, 0.0, 0.0, 0.0, 0.0, np.pi))
        return replace(plan, robot=robot), np.diag([-1.0, -1.0, 1.0, 1.0])
    return plan, T


@pytest.mark.parametrize("share", [0.0, 0.5, 1.0])
@pytest.mark.parametrize("beside", [((0, 0, 0), (0, 0, 0)), ((6e-4, -6e-4, 0), (0.3, -0.3, 5))])
def test_the_drill_comes_out_straight_from_anywhere(share, beside, case):
    plan, T_root_base = case
    (answer,) = plan.holes
    hole, text = answer.hole, retract_program(plan, answer.hole.id).text
    T = np.linalg.inv(T_root_base) @ standing(hole, hole.depth * share, 0.1, *beside)
    (_, tool), (_, end) = run(text, T)
    np.testing.assert_allclose(pose(tool), plan.tool.T_flange_tcp @ AXES, atol=3e-9)
    np.testing.assert_allclose(end[:3, :3], T[:3, :3], atol=1e-8)  # the spin stays
    way = T[:3, :3].T @ (end[:3, 3] - T[:3, 3])  # in the tool
    assert way[2] < 0
    np.testing.assert_allclose(way[:2], 0, atol=1e-8)
    out = (hole.target - (T_root_base @ end)[:3, 3]) @ hole.direction
    assert hole.depth + 4.9e-3 < out < hole.depth + 6e-3


ELSEWHERE = {
    "beside the axis": {"off": (1.2e-3, 0, 0)}, "tilted": {"turn": (0, 0.7, 0)}, "behind the hole": {"standoff": -2e-3},
    "before the hole": {"standoff": 0.08}, "far away": {"off": (0, 0.3, 0)}, "the other way": {"turn": (180, 0, 0)},
}  # fmt: skip


@pytest.mark.parametrize("place", ELSEWHERE.values(), ids=ELSEWHERE)
def test_where_the_tool_is_not_in_the_hole_nothing_moves(place, case):
    plan, T_root_base = case
    (answer,) = plan.holes
    T = np.linalg.inv(T_root_base) @ standing(answer.hole, **{"standoff": 0.02, "psi": 0.2} | place)
    with pytest.raises(HaltError):
        run(retract_program(plan, answer.hole.id).text, T)


def test_every_line_is_short_and_ascii(plan_called):
    text = retract_program(plan_called("position 2"), "position 2", version="golden").text
    assert text.isascii()
    assert max(map(len, text.splitlines())) < 140
    assert text.startswith("def position_2_out_1():\n")
