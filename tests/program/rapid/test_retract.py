"""Out of a hole in which an ABB has stopped: the module is run by a small interpreter, from places in the hole."""

import re
from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from oracles import rapid_reader
from oracles.makers import position_plan, stand_in
from zerorev.cli import main
from zerorev.errors import NotExportableError
from zerorev.files.io import write_plan
from zerorev.motion.kinematics import tcp_pose
from zerorev.program.export import retract_program

AS_WRITTEN = np.diag([1.0, -1.0, -1.0, 1.0])


def run(text, T_base_tool):
    """Where the tool goes, of a robot whose tool stands somewhere [mm]; None: it stops."""
    module = rapid_reader.Module(re.match(r"MODULE (\w+)", text)[1])
    lines = [line.strip() for line in text.split("\n") if not line.lstrip().startswith("!")]
    for line in lines[1:4]:
        rapid_reader.declare(module, line[:-1])
    assert lines[4:6] == [f"PROC {module.name}_run()", "VAR robtarget here;"]
    assert [line[:-1] for line in lines[6:13]] == list(rapid_reader.SET)
    used = f"{module.name}_tool\\WObj:={module.name}_part"
    asked, test, written, stop, otherwise, move, *rest = lines[13:]
    assert (asked, otherwise) == (f"here:=CRobT(\\Tool:={used});", "ELSE")
    assert (stop, rest) == ("Stop;", ["ENDIF", "ConfL\\On;", "ENDPROC", "ENDMODULE", ""])
    assert re.fullmatch(r'TPWrite "[^"]{1,80}";', written)
    here = np.linalg.inv(module.part) @ T_base_tool
    q1, q2, q3, q4 = np.roll(Rotation.from_matrix(here[:3, :3]).as_quat(), 1)
    x, y, z = here[:3, 3]
    condition = re.sub(r"here\.\w+\.", "", re.fullmatch(r"IF (.*) THEN", test)[1]).replace(" OR ", " or ")
    names = {"x": x, "y": y, "z": z, "q1": q1, "q2": q2, "q3": q3, "q4": q4}
    assert set(re.findall(r"[a-z]\w*", condition)) <= {*names, "or"}
    if eval(condition, {}, names):
        return None
    way = re.fullmatch(rf"MoveL RelTool\(here,0,0,(-[\d.]+)-here\.trans\.x\),out_speed,fine,{re.escape(used)};", move)
    assert module.speeds["out_speed"][0] == 5.0
    out = np.eye(4)
    out[2, 3] = float(way[1]) - x
    return T_base_tool @ out


def standing(hole, standoff, psi, off=(0, 0, 0), turn=(0, 0, 0)):
    """Pose of the tool in the robot's base [mm], somewhat beside the hole's axis [mm, deg]."""
    T = tcp_pose(hole, standoff, psi) @ AS_WRITTEN
    T[:3, 3] *= 1e3
    beside = np.eye(4)
    beside[:3, :3], beside[:3, 3] = Rotation.from_euler("xyz", turn, degrees=True).as_matrix(), off
    return T @ beside


@pytest.fixture(scope="module", params=["base", "tilted"])
def plan(request):
    T = np.eye(4)
    if request.param == "tilted":
        T[:3, :3], T[:3, 3] = Rotation.from_euler("ZYX", (25, -40, 15), degrees=True).as_matrix(), (0.3, 0.2, 0.1)
    return replace(position_plan(stand_in("ABB"), 1), T_base_part=T, name="panel")


@pytest.mark.parametrize("share", [0.0, 0.3, 0.7, 1.0])
@pytest.mark.parametrize("beside", [((0, 0, 0), (0, 0, 0)), ((0.6, -0.6, 0), (0.3, -0.3, 3))])
def test_the_drill_comes_out_straight_from_anywhere(share, beside, plan):
    (answer,) = plan.holes
    depth, psi = answer.hole.depth, float(np.interp(share, [0, 1], answer.motion.profile.psi[:2]))
    T = standing(answer.hole, depth * share, psi, *beside)
    end = run(retract_program(plan, answer.hole.id).text, T)
    np.testing.assert_allclose(end[:3, :3], T[:3, :3], atol=1e-9)
    out = (answer.hole.target * 1e3 - end[:3, 3]) @ answer.hole.direction
    assert depth * 1e3 + 5 - 0.1 < out < depth * 1e3 + 6


ELSEWHERE = {
    "beside the axis": {"off": (0, 1.2, 0)}, "tilted": {"turn": (0, 0.7, 0)}, "turned about": {"turn": (0.7, 0, 0)},
    "behind the hole": {"standoff": -0.002}, "before the hole": {"standoff": 0.08}, "far away": {"off": (0, 300, 0)},
    "the other way": {"turn": (0, 180, 0)},
}  # fmt: skip


@pytest.mark.parametrize("place", ELSEWHERE.values(), ids=ELSEWHERE)
def test_where_the_tool_is_not_in_the_hole_nothing_moves(place, plan):
    hole = plan.holes[0].hole
    text = retract_program(plan, hole.id).text
    assert run(text, standing(hole, **{"standoff": 0.02, "psi": 0.2} | place)) is None
    assert run(text, standing(hole, 0.02, 0.2)) is not None


def test_what_is_not_known_of_the_tool_is_refused_here_too(plan):
    with pytest.raises(NotExportableError, match="mass_kg"):
        retract_program(replace(plan, tool=replace(plan.tool, load=None)), "position 1")


def test_the_command_writes_it(plan, tmp_path, capsys):
    path = tmp_path / "panel.json"
    write_plan(plan, path)
    assert main(["export", str(path), "--retract", "position 1"]) == 0
    text = (tmp_path / "panel_out_1.mod").read_text()
    assert text.isascii()
    assert "program panel_out_1 written" in capsys.readouterr().out
    assert "Out of hole 1 of 1: position 1" in text
