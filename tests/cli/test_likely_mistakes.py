"""What users probably got wrong is said at the command line, with the cure; inputs of tests/data/practice."""

from __future__ import annotations

import json
import os
import shutil

import numpy as np
import pytest

from oracles.places import ROOT
from zerorev import cli
from zerorev.cli import main
from zerorev.files.io import read_job

PRACTICE = ROOT / "tests/data/practice"


def warnings(capsys, job, code=cli.FINE):
    assert main(["plan", str(job), "--proof-boxes", "0", "--json"]) == code
    plan = json.loads(capsys.readouterr().out)
    return [f"{each['kind']}: {each['message']}" for each in plan["findings"] if each["level"] == "warning"], plan


def refused(capsys, *command):
    assert main([*map(str, command)]) == cli.BAD_INPUT
    said = capsys.readouterr()
    assert said.out == ""
    return said.err


@pytest.mark.parametrize(
    ("case", "code", "kinds"),
    [
        ("c09_tool_back/tool_back.yaml", cli.FOUND, {"tool_direction"}),
        ("c10_units/job_metres.yaml", cli.FINE, {"units"}),
        ("c10_units/job_opw_m.yaml", cli.FOUND, {"units"}),
        ("c10_units/job_good.yaml", cli.FINE, set()),
        ("c20_duplicates/dup.yaml", cli.FINE, {"duplicate"}),
        ("c20_duplicates/duppos.yaml", cli.FINE, {"duplicate"}),
        ("c23_feed/ms.yaml", cli.FINE, {"units"}),
        ("c08_normals/okdir.yaml", cli.FINE, set()),
        ("c11_maker/job_kr4.yaml", cli.FINE, set()),
    ],
)
def test_a_warning_of_its_kind_and_of_no_other(capsys, case, code, kinds):
    found, _ = warnings(capsys, PRACTICE / case, code)
    assert {each.partition(":")[0] for each in found} == kinds, found


def test_reversed_normals_are_tried_turned_round(capsys, tmp_path):
    target = tmp_path / "plan.json"
    assert (
        main(["plan", str(PRACTICE / "c08_normals/reversed.yaml"), "--proof-boxes", "0", "-o", str(target)])
        == cli.FOUND
    )
    shown = capsys.readouterr().out
    assert "with the directions turned round 3 of 3 are drilled without a reversal" in shown
    written = [each["message"] for each in json.loads(target.read_text())["findings"] if each["kind"] == "normals"]
    assert any("turned round 3 of 3" in each for each in written)
    assert not target.with_name("plan.json.part").exists()


def test_the_cure_stands_in_the_message(capsys):
    found, _ = warnings(capsys, PRACTICE / "c09_tool_back/tool_back.yaml", cli.FOUND)
    assert "rpy_deg [0, -90, 0]?" in found[0]
    found, _ = warnings(capsys, PRACTICE / "c10_units/job_opw_m.yaml", cli.FOUND)
    assert any("are they in metres? geometry_mm takes millimetres" in each for each in found)
    assert any("joint limits" in each and "in radians?" in each for each in found)


def test_a_maker_as_data_sheets_write_it_is_exported(capsys, tmp_path):
    plan = tmp_path / "plan.json"
    assert main(["plan", str(PRACTICE / "c11_maker/job_kr4.yaml"), "--proof-boxes", "0", "-o", str(plan)]) == cli.FINE
    assert main(["export", str(plan), "--controller", "krl", "-o", str(tmp_path / "p.src")]) == cli.FINE
    capsys.readouterr()


@pytest.mark.parametrize(
    ("written", "meant"),
    [
        ("KR 6 R700-2", "kuka_kr6_r700_2"),
        ("KR 120 R2700-2", "kuka_kr120_r2700_2"),
        ("KUKA KR6 R700-2", "kuka_kr6_r700_2"),
        ("GP8", "yaskawa_gp8"),
        ("kuka_kr6_r700", "kuka_kr6_r700_2"),
        ("IRB 4600-60/2.05", None),  # a path
    ],
)
def test_a_robot_by_its_name_on_the_data_sheet(capsys, tmp_path, written, meant):
    text = (PRACTICE / "c23_feed/ms.yaml").read_text(encoding="utf-8")
    (tmp_path / "job.yaml").write_text(text.replace("kuka_kr6_r700_2", written))
    said = refused(capsys, "plan", tmp_path / "job.yaml")
    assert (f"did you mean '{meant}'?" in said) if meant else ("no such file" in said)


def test_another_kind_of_file_as_a_job(capsys, tmp_path):
    plan = tmp_path / "plan.json"
    assert main(["plan", str(PRACTICE / "c23_feed/ms.yaml"), "--proof-boxes", "0", "-o", str(plan)]) == cli.FINE
    capsys.readouterr()
    for command in ("plan", "depth", "place"):
        assert "is a plan, not a job" in refused(capsys, command, plan)
    assert "is a map file, not a job" in refused(capsys, "plan", ROOT / "examples/maps/table5_plane.yaml")
    assert "is a robot file, not a job" in refused(capsys, "plan", PRACTICE / "c10_units/good.yaml")
    (tmp_path / "map.zarr").mkdir()
    (tmp_path / "map.zarr/zarr.json").write_text("{}")
    assert "is a workspace map, not a job" in refused(capsys, "plan", tmp_path / "map.zarr")


def test_a_robot_description_as_a_robot(capsys, tmp_path):
    for name in ("kr6.urdf", "kr6.xacro"):
        shutil.copy(PRACTICE / "c12_urdf/kr6_support" / name, tmp_path / name)
        text = (PRACTICE / "c23_feed/ms.yaml").read_text(encoding="utf-8")
        (tmp_path / "job.yaml").write_text(text.replace("kuka_kr6_r700_2", name))
        said = refused(capsys, "plan", tmp_path / "job.yaml")
        assert "is a robot description (URDF), not a robot file" in said


def test_meshes_in_the_package_of_a_description(tmp_path):
    """As the package lies on a disk: urdf/ beside meshes/, named by package://."""
    pytest.importorskip("trimesh", reason="meshes need trimesh (pip install 'zerorev[view]')")
    from zerorev.errors import InputError
    from zerorev.files.io import read_robot
    from zerorev.report.scene.urdf_meshes import read_meshes

    robot = read_robot("kuka_kr6_r700_2")
    there = shutil.copytree(PRACTICE / "c12_urdf/kr6_support", tmp_path / "ws/src/kr6_support")
    links = read_meshes(there / "urdf/kr6.urdf", robot)
    assert [len(link) for link in links] == [1] * 7
    other = there.rename(there.with_name("kr6_support-1.0"))  # a folder of another name is not the package
    with pytest.raises(InputError, match="called as its package"):
        read_meshes(other / "urdf/kr6.urdf", robot)


def test_no_mesh_is_read_beside_the_package(tmp_path):
    from zerorev.errors import InputError
    from zerorev.files.urdf import read_urdf

    there = shutil.copytree(PRACTICE / "c12_urdf/kr6_support", tmp_path / "kr6_support")
    (tmp_path / "secret.stl").write_bytes(b"solid")
    (there / "meshes/link.stl").symlink_to(tmp_path / "secret.stl")
    text = (there / "urdf/kr6.urdf").read_text(encoding="utf-8")
    for name in ("kr6_support/../secret.stl", "kr6_support/meshes/link.stl", "../secret.stl", "/secret.stl",
                 f"{tmp_path.name}/../secret.stl"):  # fmt: skip
        (there / "urdf/kr6.urdf").write_text(text.replace("kr6_support/meshes/kr6/base_link.stl", name))
        with pytest.raises(InputError, match="mesh"):
            read_urdf(there / "urdf/kr6.urdf")


def test_xacro_says_how_to_expand_it():
    from zerorev.errors import InputError
    from zerorev.files.urdf import read_urdf

    with pytest.raises(InputError, match=r"is xacro.*expand it first \(xacro kr6\.xacro > kr6\.urdf\)"):
        read_urdf(PRACTICE / "c12_urdf/kr6_support/kr6.xacro")


@pytest.mark.parametrize(("axis", "direction"), [("x", [0, 0, -1]), ("z", [1, 0, 0])])
def test_angles_of_a_hole(capsys, tmp_path, axis, direction):
    """A frame has three axes: the one that drills has to be said."""
    said = refused(capsys, "plan", PRACTICE / "c18_abc/euler.yaml")
    assert "drill_axis (hole 'a'): 'not given' is not among the choices" in said
    assert "which axis of the frame of abc_deg points into the material" in said
    text = (PRACTICE / "c18_abc/euler.yaml").read_text(encoding="utf-8")
    (tmp_path / "job.yaml").write_text(text.replace("abc_deg: [0, 90, 0]", f"abc_deg: [0, 90, 0], drill_axis: {axis}"))
    _, plan = warnings(capsys, tmp_path / "job.yaml")
    assert plan["holes"][0]["direction"] == pytest.approx(direction, abs=1e-12)


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ("abc_deg: [0, 90, 0], direction: [1, 0, 0]", "drill_axis (hole 'a'): 'beside direction' is not among"),
        ("drill_axis: x, direction: [1, 0, 0]", "drill_axis (hole 'a'): 'beside direction' is not among"),
        ("drill_axis: x", "drill_axis (hole 'a'): 'without abc_deg' is not among"),
        ("abc_deg: [0, 90], drill_axis: x", "abc_deg (hole 'a'): has 2 entries"),
        ("abc_deg: [0, ninety, 0], drill_axis: x", "abc_deg[1] (hole 'a'): 'ninety' is not a number"),
        ("abc_deg: [0, 90, 0], drill_axis: y", "drill_axis (hole 'a'): 'y' is not among the choices"),
    ],
)
def test_angles_of_a_hole_that_cannot_be_read(capsys, tmp_path, given, said):
    text = (PRACTICE / "c18_abc/euler.yaml").read_text(encoding="utf-8")
    (tmp_path / "job.yaml").write_text(text.replace("abc_deg: [0, 90, 0]", given))
    assert said in refused(capsys, "plan", tmp_path / "job.yaml")


def test_any_angles_of_a_hole(tmp_path):
    """Against three turns one after the other: A about Z, B about the new Y, C about the new X."""
    rng = np.random.default_rng(1)
    text = (PRACTICE / "c18_abc/euler.yaml").read_text(encoding="utf-8")
    for _ in range(10):
        A, B, C = (float(angle) for angle in rng.uniform(-180, 180, 3).round(6))
        a, b, c = np.deg2rad([A, B, C])
        R = np.array([[np.cos(a), -np.sin(a), 0], [np.sin(a), np.cos(a), 0], [0, 0, 1]])
        R = R @ np.array([[np.cos(b), 0, np.sin(b)], [0, 1, 0], [-np.sin(b), 0, np.cos(b)]])
        R = R @ np.array([[1, 0, 0], [0, np.cos(c), -np.sin(c)], [0, np.sin(c), np.cos(c)]])
        for axis, column in (("x", 0), ("z", 2)):
            given = f"abc_deg: [{A}, {B}, {C}], drill_axis: {axis}"
            (tmp_path / "job.yaml").write_text(
                text.replace("abc_deg: [0, 90, 0]", given) + "psi_reference: [0.3, 0.4, 0.5]\n"
            )
            (hole,) = read_job(tmp_path / "job.yaml").holes
            np.testing.assert_allclose(hole.direction, R[:, column], rtol=0, atol=1e-12)


def test_pecking_is_not_planned_and_said_so(capsys):
    said = refused(capsys, "plan", PRACTICE / "c19_peck/peck.yaml")
    assert "pecking, in and out of a hole in steps, is not planned as one motion" in said


def test_frames_as_kuka_has_them(capsys, tmp_path):
    """`{x, y, z, a, b, c}` for a frame, and TOOL_DATA as it stands in $config.dat, its X along the drill."""
    text = (PRACTICE / "c18_abc/abc.yaml").read_text(encoding="utf-8")
    _, plan = warnings(capsys, PRACTICE / "c18_abc/abc.yaml")
    assert plan["part_frame"] == {"xyz_mm": [500, 300, 800], "rpy_deg": [0, 0, 5]}
    assert plan["tool"]["rpy_deg"] == [0, -90, 0]
    for old, new in (("tool: {tcp_mm: [100, 0, 65], abc_deg: [0, -90, 0]}",
                      "tool: {X 100.0,Y 0.0,Z 65.0,A 0.0,B 0.0,C 0.0, tool_x: drill}"),
                     ("part_frame: {x: 500, y: 300, z: 800, a: 5, b: 0, c: 0}",
                      "part_frame: {X 500.0,Y 300.0,Z 800.0,A 5.0,B 0.0,C 0.0}")):  # fmt: skip
        assert old in text
        (tmp_path / "job.yaml").write_text(text.replace(old, new))
        _, other = warnings(capsys, tmp_path / "job.yaml")
        assert other["part_frame"] == plan["part_frame"]
        assert other["tool"]["tcp_mm"] == [100, 0, 65]
        assert other["tool"]["rpy_deg"] == pytest.approx([0, -90, 0], abs=1e-9)
    said = refused(capsys, "plan", PRACTICE / "c18_abc/tooldata.yaml")
    assert "tool_x" in said
    assert "X of the tool points along the drill" in said
    (tmp_path / "job.yaml").write_text(text.replace("{x: 500,", "{x: 500, xyz_mm: [1, 2, 3],"))
    assert "unknown key 'x'" in refused(capsys, "plan", tmp_path / "job.yaml")


def test_a_controller_of_another_maker(capsys, tmp_path):
    text = (PRACTICE / "c18_abc/abc.yaml").read_text(encoding="utf-8")
    (tmp_path / "job.yaml").write_text(text + "controller: rapid\n")
    found, _ = warnings(capsys, tmp_path / "job.yaml")
    assert any("controller rapid is ABB's" in each and "is by KUKA" in each for each in found), found


def test_a_robot_description_in_place_of_a_job_says_where_it_belongs(tmp_path, capsys):
    (tmp_path / "arm.xacro").write_text('<?xml version="1.0"?><robot name="arm"/>')
    assert main(["plan", str(tmp_path / "arm.xacro"), "-o", str(tmp_path / "p.json")]) == 2
    said = capsys.readouterr().err
    assert "is a robot description (URDF, xacro), not a job" in said
    assert "zerorev robots import" in said


def test_a_pipe_in_place_of_a_xacro_file_is_refused(tmp_path, capsys):
    os.mkfifo(tmp_path / "arm.xacro")
    assert main(["robots", "import", str(tmp_path / "arm.xacro")]) == 2
    assert "is not a regular file" in capsys.readouterr().err


def test_a_name_that_no_robot_file_may_have_is_refused_when_it_is_imported(tmp_path, capsys):
    shutil.copy(PRACTICE / "c12_urdf/kr6_support/kr6.urdf", tmp_path / "arm.urdf")
    assert main(["robots", "import", str(tmp_path / "arm.urdf"), "--name", "x" * 200]) == 2
    assert "name" in capsys.readouterr().err
    assert main(["robots", "import", str(tmp_path / "arm.urdf"), "-o", str(tmp_path / "arm.yaml")]) == 0
    assert "200 random joint angles" in capsys.readouterr().out
    assert main(["robots", str(tmp_path / "arm.yaml")]) == 0
