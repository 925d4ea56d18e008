"""Jobs whose holes are in CAD files: holes in the base frame, what was assumed as findings, and what is refused."""

from __future__ import annotations

import io

import ezdxf
import numpy as np
import pytest
import yaml
from OCP.gp import gp_Pnt, gp_Trsf

import zerorev as zr
from oracles import made_steps as made
from oracles.made_steps import box, cut, moved, rod, taper, written
from zerorev.cli import main
from zerorev.cli.common import BAD_INPUT, FINE
from zerorev.errors import InputError
from zerorev.files.io import read_cad_holes
from zerorev.files.moved_job import write_job
from zerorev.planning.job import unanswered

pytestmark = pytest.mark.usefixtures("here")

Z = (0.0, 0.0, 1.0)
JOB = {
    "robot": "kuka_kr6_r700_2",
    "tool": "thesis_drill",
    # Z of the part points away from the robot: along X of its base
    "part_frame": {"xyz_mm": [500, 300, 800], "rpy_deg": [0, 90, 0]},
    "proof_boxes": 0,
}


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """With a plate of 12 mm as STEP and DXF: a through hole of 6 mm, a countersunk one of 5, a blind one of 4 mm."""
    folder = tmp_path_factory.mktemp("cad")
    tools = (
        rod((20, 30, -5), Z, 3, 30),
        rod((50, 30, -5), Z, 2.5, 30), taper((50, 30, 0), Z, 5, 2.5, 2.5),
        rod((80, 30, -5), Z, 2, 13),
    )  # fmt: skip
    plate = cut(box((100, 60, 12)), *tools)
    written(plate, folder / "plate.step")
    scale = gp_Trsf()
    scale.SetScale(gp_Pnt(0, 0, 0), 25.4)
    written(moved(plate, scale), folder / "inches.stp", "INCH")
    document = ezdxf.new("R2018")
    document.header["$INSUNITS"] = 4
    for n, layer in enumerate(("DRILL", "DRILL", "NOTES")):
        document.modelspace().add_circle((20 + 30 * n, 30), radius=3, dxfattribs={"layer": layer})
    stream = io.StringIO()
    document.write(stream)
    (folder / "plate.dxf").write_text(stream.getvalue())
    return folder


def job(folder, holes="plate.step", **keys):
    path = folder / "job.yaml"
    path.write_text(yaml.safe_dump(JOB | {"holes": holes} | keys))
    return path


def in_base(*place) -> np.ndarray:
    """A place of the part [mm] in the base frame [m]: X of the part is -Z of the base, its Z is X."""
    x, y, z = place
    return np.array([500 + z, 300 + y, 800 - x]) / 1e3


def test_the_holes_of_a_step_file(folder):
    read = zr.read_job(job(folder))
    through, sunk, blind = sorted(read.holes, key=lambda hole: -hole.target[2])
    for hole, x, bottom, depth in ((through, 20, 12, 12), (sunk, 50, 12, 12), (blind, 80, 8, 8)):
        assert np.allclose(hole.target, in_base(x, 30, bottom), atol=1e-12)
        assert np.allclose(hole.direction, [1, 0, 0], atol=1e-12)
        assert hole.depth == pytest.approx(depth / 1e3)
    assert [hole.group for hole in (through, sunk, blind)] == ["6 mm", "5 mm", "4 mm"]
    assert read.notes == ()


def test_what_is_assumed_is_a_finding_of_the_plan(folder):
    read = zr.read_job(job(folder, breakthrough_mm=2))
    said = {finding.message for finding in unanswered(read, "asked").findings if finding.kind == "cad"}
    names = {round(-hole.target[2] * 1e3): hole.id for hole in read.holes}
    through, sunk, blind = (names[n] for n in (-780, -750, -720))
    assert said == {
        f"hole {through}: nothing says from which side, so they are drilled from the side of the robot "
        "(select: {side: [x, y, z]})",
        f"hole {sunk}: countersunk or counterbored in the model; the plan drills the narrow part",
        f"hole {blind}: blind, so drilled without breakthrough_mm",
    }
    depths = {hole.id: round(hole.depth * 1e3, 9) for hole in read.holes}
    assert depths == {through: 14, sunk: 14, blind: 8}
    assert all(finding.level == "info" for finding in read.said)


def test_the_side_of_the_robot_is_where_it_stands(folder):
    behind = {"xyz_mm": [500, 300, 800], "rpy_deg": [0, -90, 0]}  # Z of the part points at the robot
    for frame, way in ((JOB["part_frame"], 1), (behind, -1)):
        read = zr.read_job(job(folder, part_frame=frame, select={"diameter_mm": [6, 6]}))
        (hole,) = read.holes
        assert np.allclose(hole.direction, [1, 0, 0], atol=1e-12)
        other = zr.read_job(job(folder, part_frame=frame, select={"diameter_mm": [6, 6], "side": [0, 0, way]}))
        assert np.allclose(other.holes[0].direction, [-1, 0, 0], atol=1e-12)


def test_a_unit_that_is_probably_wrong_is_a_warning(folder):
    read = zr.read_job(job(folder, "inches.stp"))
    (warning,) = (finding for finding in read.said if finding.level == "warning")
    assert (warning.kind, warning.message.endswith("unit: mm")) == ("units", True)
    right = zr.read_job(job(folder, "inches.stp", unit="mm"))
    assert not [finding for finding in right.said if finding.level == "warning"]
    assert sorted(round(hole.depth * 1e3, 6) for hole in right.holes) == [8, 12, 12]


def test_the_holes_of_a_dxf_file(folder):
    with pytest.raises(InputError, match=r"plate.dxf, hole P1: its file does not say how deep it is"):
        zr.read_job(job(folder, "plate.dxf"))
    layers = {"layers": {"DRILL": {"depth_mm": 12}}}
    read = zr.read_job(job(folder, "plate.dxf", select=layers, breakthrough_mm=1))
    assert [hole.id for hole in read.holes] == ["P1", "P2"]
    for hole, x in zip(read.holes, (20, 50), strict=True):
        assert np.allclose(hole.target, in_base(x, 30, 13), atol=1e-12)  # the points are where the drill enters
        assert hole.depth == pytest.approx(13e-3)
    assert len(zr.read_job(job(folder, "plate.dxf", depth_mm=5)).holes) == 3


@pytest.mark.parametrize(
    ("holes", "keys", "says"),
    [
        ("plate.step", {"columns": {"id": "NAME"}}, "columns: goes with a CSV file"),
        ("plate.step", {"normals": "out"}, "normals: goes with a CSV file"),
        ("plate.step", {"point": "entry"}, "point: goes with a CSV file"),
        ("plate.step", {"select": {"layers": {"A": {}}}}, "select.layers: goes with a DXF file"),
        ("plate.dxf", {"select": {"face_mm": [[0, 0, 0]]}}, "select.face_mm: goes with a STEP file"),
        ("plate.step", {"select": {"diameter": 5}}, "unknown key 'diameter'.*did you mean 'diameter_mm'"),
        ("plate.step", {"select": {"diameter_mm": [50, 60]}}, "has no such holes.*1 of 6 mm"),
        ("plate.step", {"select": {"face_mm": [[0, 0, 500]]}}, "face_mm: 0, 0, 500: the nearest face is 488 mm away"),
        ("absent.step", {}, "absent.step: no such file"),
        ("job.yaml", {"select": {"kind": ["blind"]}}, "select: goes with a CAD file"),
        ([{"id": "a", "target_mm": [0, 0, 0], "direction": [0, 0, 1]}], {"select": {}}, "goes with a CAD"),
    ],
)  # fmt: skip
def test_what_cannot_be_used_is_refused(holes, keys, says, folder):
    with pytest.raises(InputError, match=says):
        zr.read_job(job(folder, holes, **keys))


def test_a_job_that_is_moved_keeps_its_holes(folder, tmp_path):
    """Also where the robot comes to stand on the other side: the side was chosen before."""
    source = job(folder, breakthrough_mm=2)
    before = zr.read_job(source)
    turned = np.diag([1.0, -1.0, -1.0, 1.0]) @ before.T_base_part
    turned[:3, 3] = before.T_base_part[:3, 3]
    write_job(tmp_path / "moved.yaml", source, T_base_part=turned)
    after = zr.read_job(tmp_path / "moved.yaml")
    assert [hole.id for hole in after.holes] == [hole.id for hole in before.holes]
    for one, other in zip(before.holes, after.holes, strict=True):
        there = turned @ np.linalg.inv(before.T_base_part)
        assert np.allclose(other.target, there[:3, :3] @ one.target + there[:3, 3], atol=1e-9)
        assert np.allclose(other.direction, there[:3, :3] @ one.direction, atol=1e-9)
        assert other.depth == pytest.approx(one.depth)
    write_job(tmp_path / "some.yaml", source, ids=["H1"])
    assert [hole.id for hole in zr.read_job(tmp_path / "some.yaml").holes] == ["H1"]


# --- the list ---------------------------------------------------------------------------------------------------------


def run(capsys, *arguments, code=FINE):
    assert main(["holes", *map(str, arguments)]) == code
    return capsys.readouterr()


def test_the_list_says_what_was_found_and_what_was_assumed(folder, capsys):
    out, err = run(capsys, folder / "plate.step")
    assert "through countersunk" in out
    assert "from the side +Z" in out
    assert "1 blind, 4 mm" in out
    assert err == ""


def test_the_list_of_a_job_knows_the_robot(folder, capsys):
    out, _ = run(capsys, job(folder), "--json")
    (through,) = (hole for hole in yaml.safe_load(out)["holes"] if hole["kind"] == "through")
    assert through["assumed"] == "from the side of the robot"
    assert [through[name] for name in ("entry_x_mm", "entry_y_mm", "entry_z_mm", "k")] == [20.0, 30.0, 0.0, 1.0]


def test_the_table_is_read_as_the_same_holes(folder, capsys):
    """What `-o` writes is a list that a job takes without another key."""
    source = job(folder, breakthrough_mm=2)
    out, _ = run(capsys, source, "-o", folder / "holes.csv")
    assert "3 holes written to" in out
    direct, listed = zr.read_job(source), zr.read_job(job(folder, "holes.csv"))
    for one, other in zip(direct.holes, listed.holes, strict=True):
        assert (one.id, one.group) == (other.id, other.group)
        assert np.allclose(one.target, other.target, atol=1e-11)
        assert np.allclose(one.direction, other.direction, atol=1e-11)
        assert one.depth == pytest.approx(other.depth, abs=1e-11)


def test_what_is_listed_can_be_selected(folder, capsys):
    out, _ = run(capsys, folder / "plate.step", "--select", "{kind: [blind], side: [0, 0, 1]}", "--json")
    (hole,) = yaml.safe_load(out)["holes"]
    assert (hole["kind"], hole["diameter_mm"], hole["depth_mm"]) == ("blind", 4.0, 8.0)
    _, err = run(capsys, folder / "plate.step", "--select", "{kind: [square]}", code=BAD_INPUT)
    assert "'square' is not among the choices" in err
    _, err = run(capsys, folder / "plate.step", "--select", "{kind: [", code=BAD_INPUT)
    assert err.count("error: ") == 1


@pytest.mark.parametrize("holes", ["holes.csv", [{"id": "a", "target_mm": [0, 0, 0], "direction": [0, 0, 1]}]])
def test_a_job_without_a_cad_file_is_refused(holes, folder, capsys):
    _, err = run(capsys, job(folder, holes), code=BAD_INPUT)
    assert "its holes are not in a CAD file" in err


@pytest.mark.parametrize("name", ["cut.step", "cut.stp", "cut.dxf"])
def test_files_cut_short_are_refused_with_one_message(name, folder, capfd):
    kind = "dxf" if name.endswith("dxf") else "step"
    whole = (folder / f"plate.{kind}").read_bytes()
    for share in (0.0, 0.3, 0.9, 0.999):
        (folder / name).write_bytes(whole[: int(share * len(whole))])
        out, err = run(capfd, folder / name, code=BAD_INPUT)
        assert (out, err.count("error: ")) == ("", 1)
        assert name in err


def test_targets_are_the_bottoms(tmp_path):
    """Of the panel on which all kinds are."""
    path = written(made.with_holes(made.curved_panel(), made.twenty_holes()), tmp_path / "panel.STEP")
    listed = read_cad_holes(path)
    assert len(listed.forms) == 20
    for hole, form in zip(listed.holes, listed.forms, strict=True):
        assert np.allclose(np.array(form.target_mm), hole.entry + hole.depth * hole.direction)


# --- points on a surface ----------------------------------------------------------------------------------------------


@pytest.fixture
def dome(tmp_path):
    """Part of a ball of 200 mm about the origin as STL, and a table of points on it; the last one at its rim."""
    import trimesh

    ball = trimesh.creation.uv_sphere(radius=200.0, count=[60, 60])
    cap = trimesh.Trimesh(*_kept(ball.vertices, ball.faces, ball.triangles_center[:, 2] > 100))
    cap.export(tmp_path / "dome.stl")
    rng = np.random.default_rng(0)
    places = rng.normal(0, 1, (20, 3)) * [1, 1, 0.3] + [0, 0, 2.5]
    places *= 200 / np.linalg.norm(places, axis=1)[:, None]
    rows = [f"P{n},{x!r},{y!r},{z!r},8" for n, (x, y, z) in enumerate(places.tolist(), 1)]
    (tmp_path / "points.csv").write_text("\n".join(["id,x_mm,y_mm,z_mm,depth_mm", *rows]) + "\n")
    return tmp_path, places


def _kept(vertices, faces, some):
    return vertices, faces[some]


def test_points_are_drilled_against_the_normals(dome, capsys):
    folder, places = dome
    out, _ = run(capsys, folder / "points.csv", "--surface", folder / "dome.stl", "-o", folder / "holes.csv", "--json")
    listed = yaml.safe_load(out)
    for hole, place in zip(listed["holes"], places, strict=True):
        direction = [hole[name] for name in "ijk"]
        # 3 deg between the triangles of the ball: their normals are off by half of it in each of two directions
        assert np.rad2deg(np.arccos(-place @ direction / 200)) < 3
        assert [hole[f"entry_{name}_mm"] for name in "xyz"] == pytest.approx(place)
        assert hole["depth_mm"] == 8
    assert any("bend by more than 2 deg" in finding["message"] for finding in listed["findings"])
    assert {finding["kind"] for finding in listed["findings"]} == {"normals"}
    read = zr.read_job(job(folder, "holes.csv"))
    assert len(read.holes) == 20
    assert all(hole.depth == pytest.approx(8e-3) for hole in read.holes)


def test_points_elsewhere_are_refused(dome, capsys):
    folder, _ = dome
    _, err = run(capsys, folder / "points.csv", "--surface", folder / "dome.stl", "--unit", "m", code=BAD_INPUT)
    assert "names of its columns say mm" in err
    (folder / "far.csv").write_text("id,x_mm,y_mm,z_mm\nA,0,0,200\nB,0,0,900\n")
    _, err = run(capsys, folder / "far.csv", "--surface", folder / "dome.stl", code=BAD_INPUT)
    assert "hole B: more than 20 mm from the surface" in err
    for name in ("absent.stl", "points.csv", "far.png"):
        _, err = run(capsys, folder / "points.csv", "--surface", folder / name, code=BAD_INPUT)
        assert err.count("error: ") == 1


def test_points_on_a_step_file(folder, tmp_path, capsys):
    (tmp_path / "points.csv").write_text("id;x_mm;y_mm;z_mm\nA;10;10;12\nB;10;0,2;12\n")
    out, _ = run(capsys, tmp_path / "points.csv", "--surface", folder / "plate.step", "--json")
    listed = yaml.safe_load(out)
    assert [[hole[name] for name in "ijk"] for hole in listed["holes"]] == [[0, 0, -1]] * 2
    assert [hole["depth_mm"] for hole in listed["holes"]] == [None, None]
    (finding,) = listed["findings"]
    assert finding["message"].startswith("hole B: at an edge of the part")
