"""STEP files as triangles: the surface that was made, closed, normals outwards, in metres; anything else is refused."""

from __future__ import annotations

from collections import Counter

import numpy as np
import pytest
from OCP.BRepBuilderAPI import BRepBuilderAPI_Transform
from OCP.gp import gp_Ax1, gp_Ax2, gp_Dir, gp_Pnt, gp_Trsf, gp_Vec

from oracles.made_steps import box, cut, rod, written
from zerorev.errors import InputError
from zerorev.files.cad import needed, step
from zerorev.files.cad.step import triangles

EXACT = 100 * 60 * 20 - np.pi * 8**2 * 20  # [mm3] of the plate


@pytest.fixture(scope="module")
def plate():
    """A plate with a hole of 16 mm, 100 x 60 x 20 mm."""
    return cut(box((100, 60, 20)), rod((50, 30, -5), (0, 0, 1), 8, 30))


def volume(vertices, faces) -> float:
    a, b, c = vertices[faces].transpose(1, 0, 2)
    return float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6)


def moved(shape, move):
    return BRepBuilderAPI_Transform(shape, move, True).Shape()


@pytest.mark.usefixtures("here")
@pytest.mark.parametrize("unit", ["MM", "INCH", "M"])
def test_a_plate_with_a_hole(plate, unit, tmp_path):
    vertices, faces = triangles(written(plate, tmp_path / "plate.step", unit), 1e-5)
    assert np.allclose([vertices.min(axis=0), vertices.max(axis=0)], [[0, 0, 0], [0.1, 0.06, 0.02]], atol=1e-9)
    # a hole of N flats is narrower by no more than the deflection
    lost = 2 * np.pi * 8 * 20 * 0.01
    assert EXACT < volume(vertices, faces) * 1e9 < EXACT + lost
    edges = Counter((int(a), int(b)) for face in faces for a, b in zip(face, np.roll(face, -1), strict=True))
    assert set(edges.values()) == {1}
    assert all((b, a) in edges for a, b in edges)
    wall = np.abs(np.hypot(*(vertices[:, :2] - [0.05, 0.03]).T) - 0.008) < 1e-9
    assert wall.sum() >= 2 * np.pi / (2 * np.arccos(1 - 0.01 / 8))


@pytest.mark.usefixtures("here")
def test_a_part_that_is_moved_or_mirrored_keeps_its_normals(plate, tmp_path):
    turn, mirror = gp_Trsf(), gp_Trsf()
    turn.SetRotation(gp_Ax1(gp_Pnt(1, 2, 3), gp_Dir(1, 1, 1)), 1.0)
    turn.SetTranslationPart(gp_Vec(500, 300, 800))
    mirror.SetMirror(gp_Ax2(gp_Pnt(0, 0, 0), gp_Dir(1, 0, 0)))
    for move in (turn, mirror):
        found = triangles(written(moved(plate, move), tmp_path / "moved.step"), 1e-5)
        assert 0 < volume(*found) * 1e9 - EXACT < 2 * np.pi * 8 * 20 * 0.01


@pytest.mark.usefixtures("here")
def test_a_finer_deflection_comes_nearer(plate, tmp_path):
    path = written(plate, tmp_path / "plate.step")
    coarse, fine = (volume(*triangles(path, deflection)) * 1e9 - EXACT for deflection in (1e-3, 1e-6))
    assert coarse > 20 * fine > 0


@pytest.mark.parametrize(
    ("spoil", "says"),
    [
        (lambda content: content[: len(content) // 2], "cut short"),
        (lambda content: content[:-40], "cut short"),
        (lambda content: content.replace(b"PLANE", b"PLNAE"), "6 of its faces cannot be read"),
        (
            lambda content: content[: len(content) // 2] + b"\nENDSEC;\nEND-ISO-10303-21;\n",
            "damaged|holds no s|reader fails",
        ),
        (lambda content: content.replace(b"#1", b"#9"), "damaged|holds no s|reader fails"),
        (lambda content: b"", "is not a STEP file"),
        (lambda content: b"solid stl", "is not a STEP file"),
        (lambda content: content[:300] + b"\nENDSEC;\nEND-ISO-10303-21;\n", "damaged|holds no s|reader fails"),
        (
            lambda content: content.replace(b"ADVANCED_FACE", b"ADVANCED_FACE ADVANCED_FACE"),
            "damaged|holds no s|reader fails",
        ),
    ],
)
def test_a_damaged_or_foreign_file_is_refused_with_its_name(spoil, says, plate, tmp_path, capfd):
    path = written(plate, tmp_path / "plate.step")
    path.write_bytes(spoil(path.read_bytes()))
    capfd.readouterr()
    with pytest.raises(InputError, match=says) as error:
        triangles(path, 1e-4)
    assert error.value.where.endswith("plate.step")
    assert capfd.readouterr() == ("", "")


def test_too_many_faces_are_refused_before_they_are_read(monkeypatch, plate, tmp_path):
    monkeypatch.setattr(step, "MOST_FACES", 6)
    with pytest.raises(InputError, match="has 7 faces"):
        triangles(written(plate, tmp_path / "plate.step"), 1e-4)


def test_a_missing_library_is_named_with_its_extra(monkeypatch, tmp_path):
    monkeypatch.setattr(needed, "find_spec", lambda name: None)
    with pytest.raises(InputError, match=r"OCP, which is not installed.*zerorev\[cad\]"):
        triangles(tmp_path / "plate.step", 1e-4)


@pytest.mark.parametrize("found", ["7.9.3.1", "8.1.0"])
def test_another_version_is_named_with_the_one_that_is_read_with(found, monkeypatch, tmp_path):
    monkeypatch.setattr(needed, "version", lambda wheel: found)
    with pytest.raises(InputError, match=rf"OCP 8\.0, and OCP {found} is installed.*zerorev\[cad\]"):
        triangles(tmp_path / "plate.step", 1e-4)
