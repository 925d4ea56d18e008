"""Programs that are written, read back, held to the plan by an independent reader, and certified."""

import re
from dataclasses import replace

import numpy as np
import pytest

from oracles import arm, urscript_reader
from oracles.makers import position_plan
from zerorev import cli
from zerorev.cli import main
from zerorev.files.io import write_plan
from zerorev.model.controller import Call, Calls
from zerorev.model.cycle import Cycle
from zerorev.program.as_exported import as_exported
from zerorev.program.dialects import read_program
from zerorev.program.export import export
from zerorev.program.urscript.dialect import URSCRIPT
from zerorev.verify.certificate.program import certify_program

NAMES = ("position 1", "position 2", "position 3", "free leg", pytest.param("panel", marks=pytest.mark.long))
AXES = np.diag([1.0, -1.0, -1.0, 1.0])  # the tool as written in the tcp frame: Z along the plunge


def certificates(plan, files):
    program = URSCRIPT.read(files)
    return [hole.certificate for hole in certify_program(plan, program, as_exported(plan, program, URSCRIPT)).holes]


def assert_certified(plan, files):
    found = certificates(plan, files)
    assert [(each.verdict, each.reasons) for each in found] == [("certified", ())] * len(plan.holes)


def moved(plan, **part):
    """The plan with its part in another frame: the holes stay where they are."""
    T = np.eye(4)
    T[:3, :3] = arm.rotation(np.array([0.6, 0.0, 0.8]), 0.7)[:3, :3]
    T[:3, 3] = 0.4, -0.1, 0.3
    return replace(plan, T_base_part=T)


def hold(plan, script):
    """Every move of a script to the plan: where it goes, how fast, how it is blended."""
    robot, tool, settings = plan.robot, plan.tool, plan.settings
    np.testing.assert_allclose(script.T_flange_tool, tool.T_flange_tcp @ AXES, rtol=0, atol=3e-9)
    np.testing.assert_allclose(script.T_base_part, plan.T_base_part, rtol=0, atol=3e-9)
    assert script.payload == (tool.load.mass, *np.round(tool.load.com, 5))
    for answer, moves in zip(plan.in_order, script.holes(), strict=True):
        hole, profile = answer.hole, answer.motion.profile
        tips = []
        for move in moves:
            T = move.T_base_tool
            if T is None:
                T = arm.forward(robot, move.joints) @ script.T_flange_tool
            tips.append(T @ AXES.T)
        standoff = np.array([(hole.target - T[:3, 3]) @ hole.direction for T in tips])
        corner = int(np.argmin(standoff))
        distance = np.where(np.arange(len(tips)) <= corner, hole.depth - standoff, hole.depth + standoff)
        psi = np.interp(distance, profile.distance, profile.psi)
        psi += np.minimum(distance, 0) * -profile.twist_rate[0]
        for T, s, spin in zip(tips, standoff, psi, strict=True):
            np.testing.assert_allclose(T, arm.drill_pose(hole, s, spin), rtol=0, atol=5e-8)
        assert standoff[corner] == pytest.approx(0, abs=1e-8)
        assert standoff[-1] == pytest.approx(hole.depth, abs=1e-8)
        lengths = np.abs(np.diff(standoff))
        for k, (move, length) in enumerate(zip(moves[1:], lengths, strict=True)):
            feed = move.feed or length / move.time
            assert feed == pytest.approx(settings.feed_plunge if k < corner else settings.feed_retract, rel=1e-6)
        radii = np.array([move.radius for move in moves])
        assert radii[0] == radii[-1] == 0
        assert (radii[1:-1] > 0).all()
        # blends that met would make the controller leave the move out
        assert (radii[:-1] + radii[1:] <= 0.9 * lengths + 1e-7).all()
        kinds = [move.kind for move in moves]
        assert kinds[corner : corner + 2] == ["jointly", "jointly"]
        assert kinds.count("jointly") == 2
        assert 0 < standoff[corner - 1] <= settings.blend + 1e-9


@pytest.mark.parametrize("name", NAMES)
def test_written_read_back_and_certified(name, plan_called):
    plan = plan_called(name)
    exported = export(plan)
    scripts = [urscript_reader.read(file.text) for file in exported.files]
    starts = scripts[1:] or scripts
    assert [script.name for script in scripts] == [file.name.removesuffix(".script") for file in exported.files]
    assert sum(len(script.holes()) for script in starts) == len(plan.holes)
    whole = replace(starts[0], moves=[move for script in starts for move in script.moves])
    hold(plan, whole)
    assert_certified(plan, exported.files)


@pytest.mark.parametrize("name", ["position 1", "free leg"])
def test_on_a_tilted_part(name, plan_called):
    plan = moved(plan_called(name))
    exported = export(plan)
    hold(plan, urscript_reader.read(exported.text))
    assert_certified(plan, exported.files)


@pytest.mark.parametrize("corner", ["blend", "stop"])
def test_other_corners(corner, plan_called):
    plan = plan_called("position 2", corner=corner)
    exported = export(plan)
    script = urscript_reader.read(exported.text)
    assert [move.kind for move in script.moves] == ["go", "straight", "straight", "straight"]
    assert (script.moves[2].radius > 0) == (corner == "blend")
    assert_certified(plan, exported.files)


def test_a_deeper_corner(plan_called):
    plan = plan_called("position 3", deepen_corner=True, lead_in=0.0, approach=5e-3, retract=8e-3)
    exported = export(plan)
    assert "corner, 0.225 mm below the target" in exported.text
    assert_certified(plan, exported.files)


def test_a_controller_that_counts_from_a_turned_base(robot):
    """As UR's base is turned against the base_link of ROS: the part frame is given in the former."""
    turned = replace(robot, name="turned", base_in_root=(0.0, 0.0, 0.0, 0.0, 0.0, np.pi))
    plan = moved(position_plan(turned, 1))
    exported = export(plan)
    script = urscript_reader.read(exported.text)
    half_a_turn = np.diag([-1.0, -1.0, 1.0, 1.0])
    np.testing.assert_allclose(script.T_base_part, half_a_turn @ plan.T_base_part, rtol=0, atol=3e-9)
    assert_certified(plan, exported.files)
    # a program for a base that is not turned is not this plan's
    other = export(replace(plan, robot=replace(turned, base_in_root=None)))
    assert {each.verdict for each in certificates(plan, other.files)} == {"refuted"}


def test_a_feed_of_its_own_for_the_last_of_the_way_in(plan_called):
    plan = plan_called("position 1", breakthrough_length=3e-3, breakthrough_feed=2e-3)
    exported = export(plan)
    script = urscript_reader.read(exported.text)
    assert [move.feed for move in script.moves if move.kind == "straight"] == [0.005, 0.005, 0.002, 0.02]
    assert [move.time for move in script.moves if move.kind == "jointly"] == [0.5, 0.05]
    assert_certified(plan, exported.files)


def test_chips_are_broken(plan_called):
    plan = plan_called("position 1", cycle=Cycle("chip_break", 10e-3, 0.3e-3))
    exported = export(plan)
    script = urscript_reader.read(exported.text)
    assert sum(move.kind == "jointly" for move in script.moves) > 2
    assert {move.radius > 0 for move in script.moves[1:-1]} == {True}
    assert_certified(plan, exported.files)


CALLS = Calls((Call("CLAMP", ("TRUE",)),), (Call("spin", ("6000",)),), (Call("rest"),), (Call("say", ('"done"',)),))


def test_calls_where_the_robot_stands(plan_called):
    plan = plan_called("position 1", calls=CALLS)
    exported = export(plan)
    script = urscript_reader.read(exported.text)
    assert script.calls == [(0, "CLAMP(True)"), (1, "spin(6000)"), (6, "rest()"), (6, 'say("done")')]
    assert_certified(plan, exported.files)
    for call in ("CLAMP(True)", "spin(6000)", "rest()", 'say("done")'):
        (file,) = exported.files
        without = replace(file, text=file.text.replace(f"  {call}\n", ""))
        assert {each.verdict for each in certificates(plan, (without,))} == {"refuted"}


def test_the_way_home(plan_called):
    plan = plan_called("position 1", home_joints=(0.0, -1.5, 1.5, 0.0, 0.5, 0.0))
    exported = export(plan)
    script = urscript_reader.read(exported.text)
    np.testing.assert_allclose(script.moves[0].joints, plan.settings.home_joints, atol=1e-9)
    np.testing.assert_allclose(script.moves[-1].joints, plan.settings.home_joints, atol=1e-9)
    assert_certified(plan, exported.files)


def test_a_panel_is_split_between_holes(plan_called):
    plan = plan_called("panel")
    exported = export(plan)
    assert [file.name for file in exported.files] == ["panel.script", "panel_1.script", "panel_2.script"]
    starter, *parts = (urscript_reader.read(file.text) for file in exported.files)
    assert [call for _, call in starter.calls] == ["panel_1()", "panel_2()"]
    assert not starter.moves
    assert sum(len(part.holes()) for part in parts) == 60
    assert all(len(part.moves) <= 250 for part in parts)


@pytest.fixture
def on_file(plan_called, tmp_path):
    """A plan of three holes and its program in two parts, by the command line."""
    write_plan(plan_called("panel", count=3), tmp_path / "panel.json")
    options = ["--controller", "urscript", "--holes-per-program", "2"]
    assert main(["export", str(tmp_path / "panel.json"), *options]) == cli.FINE
    return tmp_path / "panel.json", tmp_path / "panel.script"


def test_by_the_command_line(on_file, capsys):
    plan, program = on_file
    assert len(read_program(program).holes) == 3
    assert main(["check", "--certify", str(plan), "--program", str(program)]) == cli.FINE
    part = program.with_name("panel_2.script")
    part.write_text(re.sub(r"v=0\.0200000", "v=0.0300000", part.read_text(), count=1))
    capsys.readouterr()
    assert main(["check", "--certify", str(plan), "--program", str(program)]) == cli.FOUND
    assert "panel_2.script" in capsys.readouterr().out
