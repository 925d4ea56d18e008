"""What fits a RAPID program to its controller: load, frames, outer axes, calls, names, parts; and what is refused."""

import re
from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from oracles import rapid_reader
from oracles.makers import panel_plan, position_plan, stand_in
from zerorev.cli import main
from zerorev.errors import InputError, NotExportableError
from zerorev.files.io import read_robot, write_plan
from zerorev.model.controller import Call, Calls, ExternalAxis
from zerorev.model.dynamics import Load
from zerorev.model.job import Settings
from zerorev.program.as_exported import as_exported
from zerorev.program.dialects import read_program
from zerorev.program.export import export
from zerorev.program.neutral import build_program
from zerorev.program.rapid import write
from zerorev.program.rapid.dialect import RAPID
from zerorev.program.rapid.examine import examine
from zerorev.program.rapid.names import RAPID_NAMES
from zerorev.verify.certificate.program import certify_program

CALLS = Calls((Call.parse("CLAMP(TRUE)"),), (Call.parse('SPINDLE_ON(6000, -2.5, "a ! b")'), Call("RUN")),
              (Call("SPINDLE_OFF"),), (Call.parse("CLAMP(FALSE)"),))  # fmt: skip


@pytest.fixture(scope="module")
def plan():
    return position_plan(stand_in("ABB"), 1)


@pytest.fixture(scope="module")
def five():
    return panel_plan(stand_in("ABB"), 5, min_rate=Settings().min_rate)


def with_settings(plan, **settings):
    """The plan with settings that do not move the robot otherwise."""
    return replace(plan, settings=replace(plan.settings, **settings))


def with_tool(plan, load):
    return replace(plan, tool=replace(plan.tool, load=load))


def written(exported, folder):
    for file in exported.files:
        (folder / file.name).write_text(file.text)
    return folder / exported.files[0].name


def proven(plan, program, name=""):
    drilled = as_exported(plan, program, RAPID, name)
    return [hole.certificate for hole in certify_program(plan, program, drilled).holes]


# --- load -------------------------------------------------------------------------------------------------------------


def test_the_load_is_that_of_the_tool(plan):
    R = Rotation.from_euler("xyz", (20, -30, 50), degrees=True).as_matrix()
    inertia = R @ np.diag([0.01, 0.02, 0.025]) @ R.T
    load = Load(2.5, np.array([0.04, -0.01, 0.05]), inertia)
    text = export(with_tool(plan, load)).text
    mass, x, y, z, *quaternion = rapid_reader.read(text).load
    assert (mass, x, y, z) == (2.5, 40.0, -10.0, 50.0)
    axes = Rotation.from_quat(np.roll(quaternion[:4], -1)).as_matrix()
    np.testing.assert_allclose(axes @ np.diag(quaternion[4:]) @ axes.T, inertia, atol=2e-6)


@pytest.mark.parametrize(
    ("load", "what"),
    [
        (None, "mass_kg and com_mm in the tool file"),
        (Load(2e-5, np.array([0.05, 0, 0]), np.zeros((3, 3))), "which RAPID writes as 0"),
        (Load(2.0, np.zeros(3), np.zeros((3, 3))), "state com_mm"),
    ],
)
def test_a_load_of_zero_or_an_unknown_one_is_refused_with_the_cure(load, what, plan, tmp_path, capsys):
    spoiled = with_tool(plan, load)
    with pytest.raises(NotExportableError, match=what):
        export(spoiled)
    path = tmp_path / "plan.json"
    write_plan(spoiled, path)
    assert main(["export", str(path), "--controller", "rapid"]) == 1
    assert re.search(what, " ".join(capsys.readouterr().err.split()))
    assert not list(tmp_path.glob("*.mod"))


def test_a_mass_of_zero_is_refused_in_the_tool_file():
    with pytest.raises(InputError, match="mass_kg"):
        Load(0.0, np.array([0.05, 0, 0]), np.zeros((3, 3)))


# --- frames, outer axes, settings of other makers ---------------------------------------------------------------------


def test_a_robot_that_stands_elsewhere_in_the_world(plan):
    root = (0.1, -0.2, 0.4, float(np.pi), 0.3, -1.1)
    moved = with_settings(plan, robroot=root)
    exported = export(moved)
    T = np.eye(4)
    T[:3, :3], T[:3, 3] = Rotation.from_euler("xyz", root[3:]).as_matrix(), np.array(root[:3]) * 1e3
    module, own = rapid_reader.read(exported.text), rapid_reader.read(export(plan).text)
    np.testing.assert_allclose(module.part, T @ own.part, rtol=0, atol=2e-4)
    assert [proof.reasons for proof in proven(moved, RAPID.read(exported.files))] == [()]
    assert proven(plan, RAPID.read(exported.files))[0].verdict == "refuted"


def test_a_controller_that_counts_from_elsewhere_in_the_arm():
    robot = replace(read_robot("abb_irb1200_5_90"), base_in_root=(0.1, -0.05, 0.3, 0.1, -0.2, 0.4))
    plan = position_plan(robot, 1)
    exported = export(plan)
    T = np.eye(4)
    T[:3, :3], T[:3, 3] = Rotation.from_euler("xyz", (0.1, -0.2, 0.4)).as_matrix(), (100, -50, 300)
    np.testing.assert_allclose(rapid_reader.read(exported.text).part, np.linalg.inv(T), rtol=0, atol=1e-4)
    assert [proof.reasons for proof in proven(plan, RAPID.read(exported.files))] == [()]


def test_every_target_names_the_external_axes(plan):
    outer = with_settings(plan, external_axes=(ExternalAxis("E3", -90.0), ExternalAxis("E1", 1500.0)))
    exported = export(outer)
    module = rapid_reader.read(exported.text)
    assert {move.external for move in module.moves} == {("1500.0000", "9E9", "-90.0000", "9E9", "9E9", "9E9")}
    assert "eax_c -90.0000" in exported.text
    assert [proof.reasons for proof in proven(outer, RAPID.read(exported.files))] == [()]
    assert proven(plan, RAPID.read(exported.files))[0].verdict == "refuted"


def test_settings_without_a_form_in_rapid_are_refused_together(plan):
    spoiled = with_settings(plan, tool_number=3, base_number=2, header=("&REL 1",), robroot="$ROBROOT")
    with pytest.raises(NotExportableError) as refused:
        export(spoiled)
    (reason,) = refused.value.reasons
    assert "tool_number, base_number, header, robroot: $ROBROOT" in reason
    assert "leave them out" in reason


@pytest.mark.parametrize("maker", ["KUKA", "FANUC", "Yaskawa", ""])
def test_another_makers_robot_is_refused(maker, plan):
    with pytest.raises(NotExportableError, match="RAPID runs on ABB controllers alone"):
        export(replace(plan, robot=replace(plan.robot, manufacturer=maker)), "rapid")


# --- calls ------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("most", [None, 2])
@pytest.mark.parametrize("home", [None, (0.0, -1.5, 1.5, 0.0, 0.5, 0.0)])
def test_calls_stand_where_the_robot_does(most, home, five, tmp_path):
    called = with_settings(five, calls=CALLS, home_joints=home, holes_per_program=most)
    exported = export(called)
    modules = [rapid_reader.read(file.text) for file in exported.files]
    names = [call for module in modules for _, call in module.calls]
    each = ['SPINDLE_ON 6000,-2.5,"a ! b"', "RUN", "SPINDLE_OFF"]
    parts = ["panel_1_run", "panel_2_run", "panel_3_run"] if most else []
    if most:
        assert names == ["CLAMP TRUE", *parts, "CLAMP FALSE", *each * 5]
    else:
        assert names == ["CLAMP TRUE", *each * 5, "CLAMP FALSE"]
    path = written(exported, tmp_path)
    assert [proof.reasons for proof in proven(called, read_program(path))] == [()] * 5
    for part in ("before_job", "before_hole", "after_hole", "after_job"):
        other = with_settings(called, calls=replace(CALLS, **{part: ()}))
        assert "refuted" in [proof.verdict for proof in proven(other, read_program(path))]


@pytest.mark.parametrize(
    "name", ["STOP", "MoveL", "ENDPROC", "wait_me_run", "PDispOn", "position_1_run", "POSITION_1_RUN"]
)
def test_a_call_that_would_be_something_else(name, plan):
    spoiled = with_settings(plan, calls=Calls(after_hole=(Call(name),)))
    if name == "wait_me_run":
        assert f"{name};" in export(spoiled).text
        return
    with pytest.raises(NotExportableError, match=name):
        export(spoiled)


@pytest.mark.parametrize("argument", ["#FAST", '"C:\\x"'])
def test_an_argument_that_rapid_does_not_read(argument, plan):
    spoiled = with_settings(plan, calls=Calls(after_hole=(Call("DO_IT", (argument,)),)))
    with pytest.raises(NotExportableError, match="is nothing that RAPID reads"):
        export(spoiled)


# --- names and parts --------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "name", ["MoveL", "tool0", "main", "COM1", "1st", "a" * 28, "wing left", "MODULE", "\u00e4\u00f6"]
)
def test_names_that_cannot_stand_are_made_others(name):
    made = RAPID_NAMES.of(name)
    assert RAPID_NAMES.fits(made)
    assert made.upper() != name.upper()
    assert len(f"{RAPID_NAMES.part(made, 999)}_part") <= 32


def test_long_names_that_are_alike_where_they_are_cut():
    first, second = (RAPID_NAMES.of(f"panel_of_the_upper_left_wing_{side}") for side in ("a", "b"))
    assert first != second


@pytest.mark.parametrize("most", [1, 2, 4, 5])
def test_any_split_of_a_plan_is_its_program(most, five, tmp_path):
    exported = export(five, holes_per_program=most, name="called_otherwise")
    assert len(exported.files) == (1 if most >= 5 else 1 + -(-5 // most))
    path = written(exported, tmp_path)
    proofs = proven(five, read_program(path), path.stem)
    assert [proof.reasons for proof in proofs] == [()] * 5
    whole = [move.line for file in exported.files for move in rapid_reader.read(file.text).moves]
    assert len(whole) == len(rapid_reader.read(export(five).text).moves)


FAULTS = [
    ("panel.mod", "panel_2_run;\n", "\n"),
    ("panel.mod", "  panel_2_run;\n  panel_3_run;\n", "  panel_3_run;\n  panel_2_run;\n"),
    ("panel_2.mod", "AccSet 100,100", "AccSet 100,99"),
    ("panel_2.mod", "feed_20_000:=[20.000,", "feed_20_000:=[30.000,"),
    ("panel_3.mod", "MODULE panel_3\n", "MODULE panel_4\n"),
    ("panel_3.mod", "PERS tooldata panel_3_tool:=[TRUE,[[100.0000", "PERS tooldata panel_3_tool:=[TRUE,[[100.0010"),
]


@pytest.mark.parametrize(("name", "old", "new"), FAULTS)
def test_a_fault_in_any_file_is_found(name, old, new, five, tmp_path):
    path = written(export(five, holes_per_program=2), tmp_path)
    text = (tmp_path / name).read_text()
    assert old in text
    (tmp_path / name).write_text(text.replace(old, new, 1))
    try:
        reasons = [reason for each in proven(five, read_program(path)) for reason in each.reasons]
    except InputError as refused:
        reasons = [str(refused)]
    assert reasons


def test_a_long_program_is_split_between_holes(five, monkeypatch):
    assert len(export(five).files) == 1
    monkeypatch.setattr(write, "LONGEST", 240)
    parts = [file.text.count("\n") for file in export(five).files]
    assert len(parts) == 4
    assert max(parts) <= 240


# --- the command line -------------------------------------------------------------------------------------------------


def test_the_command_writes_and_certifies(tmp_path, capsys):
    plan, program = tmp_path / "wing.json", tmp_path / "wing.mod"
    write_plan(replace(position_plan(read_robot("abb_irb1200_5_90"), 1), name="wing"), plan)
    assert main(["export", str(plan), "--controller", "rapid"]) == 0
    assert main(["check", "--certify", str(plan), "--program", str(program)]) == 0
    assert "yes, certified" in " ".join(capsys.readouterr().out.split())
    program.write_text(program.read_text().replace("\\T:=0.200000", "\\T:=0.100000"))
    assert main(["check", "--certify", str(plan), "--program", str(program)]) == 1
    assert "refuted" in capsys.readouterr().out


def test_findings_of_a_plan_without_joint_moves(plan):
    hole = plan.holes[0]
    with pytest.raises(NotExportableError, match="plan it again"):
        export(replace(plan, holes=(replace(hole, corner=None),)))
    program = build_program(plan)
    assert not [finding for finding in examine(program) if finding.kind == "controller"]
