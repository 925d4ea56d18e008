"""Holes of STEP files that the tests make: all found, on their axes, of the right kind; what is none is left out."""

from __future__ import annotations

import time
from collections import Counter

import numpy as np
import pytest
from OCP.gp import gp_Ax1, gp_Dir, gp_Pnt, gp_Trsf, gp_Vec

from oracles import made_steps as made
from oracles.made_steps import Made, as_splines, box, cut, fused, moved, rod, taper, together, written
from zerorev.files.cad.found import FoundHole, FoundHoles
from zerorev.files.cad.step import found_in_step, step_holes

Z = (0.0, 0.0, 1.0)
DOWN = (0.0, 0.0, -1.0)


def found(shape, tmp_path, unit=None, places=(), stated="MM") -> FoundHoles:
    return found_in_step(written(shape, tmp_path / "part.step", stated).read_bytes(), unit, places)


def only(shape, tmp_path, **how) -> FoundHole:
    (hole,) = found(shape, tmp_path, **how).holes
    return hole


def off_axis(hole: FoundHole, each: Made) -> float:
    """How far the axis of a hole passes a point of that along which it was cut, over 100 mm [mm]."""
    ends = np.array([each.mouth, each.mouth + 100 * each.direction]) - hole.entry
    across = ends - np.outer(ends @ hole.direction, hole.direction)
    return float(np.linalg.norm(across, axis=1).max())


def level_of_mouth(each: Made, radius: float) -> float:
    """How far the surface of the curved panel rises above the mouth within a radius, along the axis [mm]."""
    first = np.cross(each.direction, [1.0, 0.3, 0.2])
    first /= np.linalg.norm(first)
    second = np.cross(each.direction, first)
    highest = -np.inf
    for angle in np.linspace(0, 2 * np.pi, 180):
        place = each.mouth + radius * (np.cos(angle) * first + np.sin(angle) * second)
        up = 0.0
        for _ in range(20):  # along the axis until the surface is met
            at = place - up * each.direction
            up += made.height(at[0], at[1]) - at[2]
        highest = max(highest, up)
    return highest


@pytest.fixture(scope="module")
def panel():
    """The curved panel with its twenty holes."""
    return made.with_holes(made.curved_panel(), made.twenty_holes())


@pytest.mark.parametrize("splines", [False, True], ids=["as made", "as splines"])
def test_twenty_holes_of_a_curved_panel(splines, panel, tmp_path, record_property):
    asked = made.twenty_holes()
    listed = found(as_splines(panel) if splines else panel, tmp_path)
    assert len(listed.holes) == 20
    assert listed.notes == ()
    worst = 0.0
    for each in asked:
        hole = min(listed.holes, key=lambda hole: off_axis(hole, each))
        worst = max(worst, off_axis(hole, each))
        assert hole.kinds == each.kinds
        assert hole.diameter == pytest.approx(each.diameter, abs=1e-6)
        ways = hole.direction @ each.direction
        assert abs(ways) == pytest.approx(1.0, abs=1e-12)
        assert (hole.other_entry is not None) == (each.kinds == ("through",))
        if hole.other_entry is None:
            assert ways > 0
        if each.kinds == ("blind",):
            # the interpolated surface is some micrometres off the formula
            up = level_of_mouth(each, each.diameter / 2)
            assert hole.depth == pytest.approx(each.depth + up, abs=5e-3)
            assert (each.mouth - hole.entry) @ each.direction == pytest.approx(up, abs=5e-3)
    record_property("measured", f"axes of the holes of a curved panel: {worst:.1e} mm off at most ({splines=})")
    assert worst < 1e-6


def test_the_same_in_a_process_of_its_own(panel, tmp_path, capfd):
    content = written(panel, tmp_path / "panel.step").read_bytes()
    capfd.readouterr()
    there, here = step_holes(content), found_in_step(content, None, ())
    assert capfd.readouterr() == ("", "")
    assert [hole.id for hole in there.holes] == [f"H{n}" for n in range(1, 21)] == [hole.id for hole in here.holes]
    assert all(np.array_equal(a.entry, b.entry) for a, b in zip(there.holes, here.holes, strict=True))


# --- what a hole is ---------------------------------------------------------------------------------------------------

PLATE = (100.0, 60.0, 20.0)
AT = (50.0, 30.0)


def plate():
    return box(PLATE)


def test_a_through_hole_has_two_ends(tmp_path):
    hole = only(cut(plate(), rod((*AT, -5), Z, 3, 30)), tmp_path)
    assert hole.kinds == ("through",)
    assert hole.depth == pytest.approx(20)
    assert {round(hole.entry[2], 9), round(hole.other_entry[2], 9)} == {0, 20}


def test_a_flat_bottom_and_a_drill_point(tmp_path):
    flat = only(cut(plate(), rod((*AT, 8), Z, 3, 30)), tmp_path)
    assert (flat.kinds, flat.depth, flat.notes) == (("blind",), pytest.approx(12), ())
    pointed = only(cut(plate(), rod((*AT, 8), Z, 3, 30), taper((*AT, 8), DOWN, 3, 0, 1.8)), tmp_path)
    assert pointed.depth == pytest.approx(13.8)
    assert pointed.notes == ("drill point of 1.8 mm in the depth",)
    for hole in (flat, pointed):
        assert np.allclose(hole.direction, DOWN, atol=1e-12)
        assert np.allclose(hole.entry, (*AT, 20), atol=1e-9)


def test_a_rounded_bottom(tmp_path):
    from OCP.BRepPrimAPI import BRepPrimAPI_MakeSphere

    ball = BRepPrimAPI_MakeSphere(gp_Pnt(*AT, 10), 3.0).Shape()
    hole = only(cut(plate(), rod((*AT, 10), Z, 3, 30), ball), tmp_path)
    assert hole.kinds == ("blind",)
    assert hole.depth == pytest.approx(13, abs=2e-3)
    assert np.allclose(hole.direction, DOWN, atol=1e-12)


def test_mouths_that_are_wider_mark_the_entry(tmp_path):
    drilled = rod((*AT, -5), Z, 3, 30)
    sunk = only(cut(plate(), drilled, taper((*AT, 0), Z, 7, 3, 4)), tmp_path)
    assert sunk.kinds == ("through", "countersunk")
    assert sunk.mouth == "countersink 14 mm, 90 deg"
    bored = only(cut(plate(), drilled, rod((*AT, -1), Z, 6, 6)), tmp_path)
    assert bored.kinds == ("through", "counterbored")
    assert bored.mouth == "counterbore 12 mm, 5 mm deep"
    for hole in (sunk, bored):
        assert hole.other_entry is None
        assert np.allclose(hole.direction, Z, atol=1e-12)
        assert np.allclose(hole.entry, (*AT, 0), atol=1e-9)
        assert hole.depth == pytest.approx(20)
        assert hole.diameter == pytest.approx(6)


def test_a_tapered_floor_of_a_counterbore_is_not_a_countersink(tmp_path):
    hole = only(cut(plate(), rod((*AT, -5), Z, 3, 30), rod((*AT, -1), Z, 6, 6), taper((*AT, 5), Z, 6, 3, 2)), tmp_path)
    assert hole.kinds == ("through", "counterbored")


def test_both_mouths_wider_leave_the_side_open(tmp_path):
    tools = (rod((*AT, -5), Z, 3, 30), taper((*AT, 0), Z, 7, 3, 4), taper((*AT, 20), DOWN, 7, 3, 4))
    hole = only(cut(plate(), *tools), tmp_path)
    assert hole.kinds == ("through", "countersunk")
    assert hole.other_entry is not None
    assert hole.notes == ("wider at both ends",)


def test_half_cylinders_are_one_hole(tmp_path):
    """As many systems write it: two half faces, also where each is a spline."""
    halves = (rod((*AT, -5), Z, 3, 30, np.pi), moved(rod((*AT, -5), Z, 3, 30, np.pi), _turn((*AT, 0), Z, np.pi)))
    shape = cut(plate(), *halves)
    assert len(_cylinders(shape)) == 2
    for each in (shape, as_splines(shape)):
        hole = only(each, tmp_path)
        assert (hole.kinds, hole.diameter) == (("through",), pytest.approx(6, abs=1e-6))


def test_fillets_slots_and_open_sides_are_left_out(tmp_path):
    """A fillet within a pocket, the ends of a slot, a hole that runs out of the side."""
    slot = (rod((40, 30, -5), Z, 3, 30), rod((60, 30, -5), Z, 3, 30), box((20, 6, 30), (40, 27, -5)))
    listed = found(cut(plate(), *slot, rod((100, 30, -5), Z, 5, 30)), tmp_path)
    assert listed.holes == ()
    assert listed.notes == ("left out, 3 times: a slot, or a hole that runs out of the side",)


def test_what_is_convex_is_left_out(tmp_path):
    assert found(fused(plate(), rod((*AT, 20), Z, 8, 10)), tmp_path).holes == ()
    bush = cut(fused(plate(), rod((*AT, 20), Z, 8, 10)), rod((*AT, -5), Z, 3, 50))
    hole = only(bush, tmp_path)
    assert (hole.diameter, hole.depth) == (pytest.approx(6), pytest.approx(30))


def test_a_cavity_is_left_out(tmp_path):
    listed = found(cut(plate(), rod((*AT, 5), Z, 3, 10)), tmp_path)
    assert listed.holes == ()
    assert listed.notes == ("left out, 1 time: closed at both ends",)


def test_a_fork_has_a_hole_in_each_arm(tmp_path):
    fork = cut(box((40, 40, 60)), box((50, 50, 30), (-5, -5, 15)), rod((20, 20, -5), Z, 4, 80))
    first, second = found(fused(fork, box((10, 40, 60))), tmp_path).holes
    assert first.depth == pytest.approx(15)
    assert second.depth == pytest.approx(15)


def test_a_hole_across_another_is_one(tmp_path):
    across = rod((-5, 30, 10), (1, 0, 0), 2, 120)
    holes = found(cut(plate(), rod((*AT, -5), Z, 5, 30), across), tmp_path).holes
    assert sorted(round(hole.diameter, 6) for hole in holes)[-1] == 10
    wide = max(holes, key=lambda hole: hole.diameter)
    assert (wide.kinds, wide.depth) == (("through",), pytest.approx(20))


def test_each_solid_has_holes_of_its_own(tmp_path):
    """Two plates on each other and a screw in them share an axis."""
    lower, upper = cut(plate(), rod((*AT, -5), Z, 3, 30)), cut(box(PLATE, (0, 0, 20)), rod((*AT, 15), Z, 3, 40))
    screw = fused(rod((*AT, 0), Z, 3, 40), rod((*AT, 40), Z, 6, 5))
    listed = found(together(lower, upper, screw), tmp_path)
    assert [(hole.of, round(hole.depth, 9)) for hole in listed.holes] == [("solid 1", 20), ("solid 2", 20)]


def test_a_solid_is_called_as_the_file_calls_it(tmp_path):
    path = written(cut(plate(), rod((*AT, -5), Z, 3, 30)), tmp_path / "part.step")
    name = b"MANIFOLD_SOLID_BREP('PANEL \\X2\\00E4\\X0\\ \x1b[2J<b>\t'"
    (hole,) = found_in_step(path.read_bytes().replace(b"MANIFOLD_SOLID_BREP(''", name), None, ()).holes
    assert hole.of.startswith("PANEL ä")
    assert "\x1b" not in hole.of
    assert "\t" not in hole.of


def test_a_part_that_is_turned_and_placed_somewhere(tmp_path):
    shape = cut(plate(), rod((*AT, 8), Z, 3, 30))
    move = _turn((1, 2, 3), (1, 1, 1), 1.0)
    move.SetTranslationPart(gp_Vec(500, 300, 800))
    for each in (moved(shape, move), together(moved(shape, move))):
        hole = only(each, tmp_path)
        entry, way = gp_Pnt(*AT, 20).Transformed(move), gp_Vec(*DOWN).Transformed(move)
        assert np.allclose(hole.entry, (entry.X(), entry.Y(), entry.Z()), atol=1e-9)
        assert np.allclose(hole.direction, (way.X(), way.Y(), way.Z()), atol=1e-12)


@pytest.mark.parametrize("stated", ["MM", "INCH", "M", "CM"])
def test_units_that_a_file_states(stated, tmp_path):
    hole = only(cut(plate(), rod((*AT, 8), Z, 3, 30)), tmp_path, stated=stated)
    assert (hole.diameter, hole.depth) == (pytest.approx(6), pytest.approx(12))
    assert np.allclose(hole.entry, (*AT, 20), atol=1e-9)


def test_a_unit_that_is_wrong_is_put_right(tmp_path):
    """Numbers in millimetres in a file that states inches."""
    scale = gp_Trsf()
    scale.SetScale(gp_Pnt(0, 0, 0), 25.4)
    shape = moved(cut(plate(), rod((*AT, 8), Z, 3, 30), taper((*AT, 20), DOWN, 7, 3, 4)), scale)
    wrong, right = only(shape, tmp_path, stated="INCH"), only(shape, tmp_path, stated="INCH", unit="mm")
    assert (wrong.diameter, wrong.depth) == (pytest.approx(152.4), pytest.approx(304.8))
    assert (right.diameter, right.depth) == (pytest.approx(6), pytest.approx(12))
    assert np.allclose(right.entry, (*AT, 20), atol=1e-9)
    assert right.mouth == "countersink 14 mm, 90 deg"


def test_faces_are_picked_by_a_point(tmp_path):
    shape = cut(plate(), rod((*AT, -5), Z, 3, 30), rod((-5, 30, 10), (1, 0, 0), 2, 20))
    listed = found(shape, tmp_path, places=[(20, 20, 20)])
    down, side = sorted(listed.holes, key=lambda hole: hole.kinds, reverse=True)
    ends = {20: down.faces[0], 0: down.faces[1]} if down.entry[2] > 10 else {20: down.faces[1], 0: down.faces[0]}
    assert listed.picked == ends[20]
    assert not listed.picked & (ends[0] | side.faces[0] | side.faces[1])


def _turn(place, direction, angle) -> gp_Trsf:
    move = gp_Trsf()
    move.SetRotation(gp_Ax1(gp_Pnt(*map(float, place)), gp_Dir(*map(float, direction))), angle)
    return move


def _cylinders(shape) -> list:
    from OCP.BRepAdaptor import BRepAdaptor_Surface
    from OCP.GeomAbs import GeomAbs_Cylinder
    from OCP.TopAbs import TopAbs_FACE
    from OCP.TopExp import TopExp_Explorer
    from OCP.TopoDS import TopoDS

    faces, explorer = [], TopExp_Explorer(shape, TopAbs_FACE)
    while explorer.More():
        faces.append(TopoDS.Face(explorer.Current()))
        explorer.Next()
    return [face for face in faces if BRepAdaptor_Surface(face).GetType() == GeomAbs_Cylinder]


@pytest.mark.long
def test_a_thousand_holes_within_ten_seconds(panel, tmp_path, record_property):
    """In one plate, and fifty curved panels with all kinds; seconds of a processor, since other tests run besides."""

    def timed(shape) -> tuple[FoundHoles, float]:
        content, began = written(shape, tmp_path / "part.step").read_bytes(), time.process_time()
        return found_in_step(content, None, ()), time.process_time() - began

    plate, seconds = timed(made.perforated(40, 25, 20.0, 3.0, 12.0))
    assert Counter((each.kinds, round(each.depth, 9)) for each in plate.holes) == {(("through",), 12.0): 1000}
    apart = []
    for n in range(50):
        move = gp_Trsf()
        move.SetTranslation(gp_Vec(0, 0, 50.0 * n))
        apart.append(moved(panel, move))
    panels, others = timed(together(*apart))
    assert set(Counter(each.kinds for each in panels.holes).values()) == {250}
    record_property("measured", f"1,000 holes: {seconds:.1f} s in one plate, {others:.1f} s in fifty curved panels")
    assert max(seconds, others) < 10
