"""Which holes of a CAD file are drilled, and from where: what the job says, and what is assumed where it is silent."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from zerorev.errors import InputError
from zerorev.files.cad.chosen import chosen, unlikely_unit
from zerorev.files.cad.found import FoundHole, FoundHoles
from zerorev.files.cad.select_form import SelectForm

UP, DOWN = np.array([0.0, 0.0, 1.0]), np.array([0.0, 0.0, -1.0])


def hole(name: str, kinds=("through",), diameter=5.0, of="solid 1", **how) -> FoundHole:
    """At the origin, 12 mm deep; its two ends alike if it is not said otherwise."""
    how = {"entry": np.array([0.0, 0.0, 12.0]), "direction": DOWN, "depth": 12.0, "other_entry": np.zeros(3)} | how
    return FoundHole(name, kinds, how.pop("entry"), how.pop("direction"), diameter, how.pop("depth"), of=of, **how)


FILE = FoundHoles(
    (
        hole("H1", faces=(frozenset({1}), frozenset({2}))),
        hole("H2", ("blind",), 4.0, other_entry=None, faces=(frozenset({2}), frozenset({7}))),
        hole("H3", ("through", "countersunk"), 6.0, "LUG", other_entry=None),
        hole("P4", ("circle",), None, "L1", depth=None, other_entry=np.array([0.0, 0.0, 12.0])),
    ),
    "millimetre",
    1.0,
)


def ids(select: dict, found: FoundHoles = FILE) -> list[str]:
    return [each.id for each in chosen(found, SelectForm(**select), None)]


@pytest.mark.parametrize(
    ("select", "there"),
    [
        ({}, ["H1", "H2", "H3", "P4"]),
        ({"id": ["H3", "H1"]}, ["H1", "H3"]),
        ({"kind": ["through"]}, ["H1", "H3"]),
        ({"kind": ["countersunk", "blind"]}, ["H2", "H3"]),
        ({"diameter_mm": [4.0, 5.0]}, ["H1", "H2"]),
        ({"diameter_mm": [5.5, 9.0]}, ["H3"]),
        ({"solid": ["LUG"]}, ["H3"]),
        ({"layers": {"L1": {}}}, ["P4"]),
        ({"kind": ["through"], "diameter_mm": [6.0, 6.0]}, ["H3"]),
    ],
)
def test_holes_are_chosen(select, there):
    assert ids(select) == there


@pytest.mark.parametrize(("picked", "there"), [({1}, ["H1"]), ({2}, ["H1", "H2"]), ({7}, [])])
def test_holes_are_chosen_by_the_face_in_which_they_open(picked, there):
    """A blind hole does not open in its bottom."""
    found = replace(FILE, picked=frozenset(picked))
    if there:
        assert ids({"face_mm": [[0.0, 0.0, 0.0]]}, found) == there
        return
    with pytest.raises(InputError, match="no such holes"):
        ids({"face_mm": [[0.0, 0.0, 0.0]]}, found)


@pytest.mark.parametrize(
    ("select", "where", "says", "accepted"),
    [
        ({"diameter_mm": [20.0, 30.0]}, "select", "no such holes", "1 of 5 mm"),
        ({"solid": ["BOX"]}, "select.solid", "'BOX' has no holes", "solid 1, LUG"),
        ({"layers": {"L2": {}}}, "select.layers", "'L2' has no holes", "L1"),
        ({"id": ["H9"]}, "select.id", "no hole 'H9'", "zerorev holes"),
    ],
)
def test_what_is_not_there_is_named_with_what_is(select, where, says, accepted):
    with pytest.raises(InputError, match=says) as error:
        ids(select)
    assert error.value.where == where
    assert accepted in error.value.accepted


def test_a_file_without_holes_says_so():
    with pytest.raises(InputError, match="has no holes"):
        ids({}, FoundHoles((), "millimetre", 1.0))


@pytest.mark.parametrize(
    ("select", "robot", "picked", "direction", "note"),
    [
        ({}, None, (), DOWN, ("from the side +Z",)),
        ({}, np.array([50.0, 0.0, 500.0]), (), DOWN, ("from the side of the robot",)),
        ({}, np.array([50.0, 0.0, -500.0]), (), UP, ("from the side of the robot",)),
        ({"side": "robot"}, np.array([50.0, 0.0, -500.0]), (), UP, ()),
        ({"side": [0.0, 0.0, -3.0]}, np.array([50.0, 0.0, 500.0]), (), UP, ()),
        ({"side": [1.0, 0.0, 1.0]}, None, (), DOWN, ()),
        ({}, np.array([50.0, 0.0, 500.0]), (2,), UP, ()),
        ({"side": [0.0, 0.0, -3.0]}, None, (1,), DOWN, ()),
    ],
)
def test_two_ends_alike_are_drilled_from_one_side(select, robot, picked, direction, note):
    found = replace(FILE, holes=FILE.holes[:1], picked=frozenset(picked))
    (drilled,) = chosen(found, SelectForm(**select), robot)
    assert np.array_equal(drilled.direction, direction)
    assert np.array_equal(drilled.entry, [0.0, 0.0, 12.0 if direction is DOWN else 0.0])
    assert drilled.notes == note
    assert drilled.other_entry is None


def test_a_side_across_the_axis_is_refused():
    with pytest.raises(InputError, match="across the axis of hole H1"):
        ids({"side": [1.0, 0.0, 0.01]})
    with pytest.raises(InputError, match="robot is not known"):
        ids({"side": "robot"})


def test_where_no_side_is_known_it_is_that_of_an_axis_along_the_hole():
    flat = hole("H1", direction=np.array([1.0, 0.0, 0.0]), entry=np.zeros(3), other_entry=np.array([12.0, 0.0, 0.0]))
    (drilled,) = chosen(replace(FILE, holes=(flat,)), SelectForm(), None)
    assert np.array_equal(drilled.direction, [-1.0, 0.0, 0.0])
    assert np.array_equal(drilled.entry, [12.0, 0.0, 0.0])
    assert drilled.notes == ("from the side +X",)


def test_a_layer_says_what_the_drawing_does_not():
    means = {"diameter_mm": 3.0, "depth_mm": 9.0, "direction": [0.0, 3.0, 4.0]}
    (drilled,) = chosen(FILE, SelectForm(layers={"L1": means}), None)
    assert (drilled.diameter, drilled.depth) == (3.0, 9.0)
    assert np.allclose(drilled.direction, [0.0, 0.6, 0.8])
    assert drilled.notes == ()
    (turned,) = chosen(FILE, SelectForm(layers={"L1": {}}, side=[0.0, 0.0, -1.0]), None)
    assert np.array_equal(turned.direction, UP)
    assert np.array_equal(turned.entry, [0.0, 0.0, 12.0])


@pytest.mark.parametrize(
    ("diameter", "unit", "scale", "cure"),
    [
        (5.0, "millimetre", 1.0, None),
        (25.0, "INCH", 25.4, None),
        (254.0, "INCH", 25.4, "unit: mm"),  # the file of a well-known assembly
        (5000.0, "metre", 1000.0, "unit: mm"),
        (0.25, "millimetre", 1.0, "unit: in"),
        (0.005, "millimetre", 1.0, "unit: m"),
    ],
)
def test_diameters_that_no_drill_has_are_asked_about(diameter, unit, scale, cure):
    found = unlikely_unit(FoundHoles((hole("H1", diameter=diameter),), unit, scale))
    assert (found is None) == (cure is None)
    if found is not None:
        assert found.endswith(cure)
        assert f"{diameter:.4g} mm wide, by a file that states the unit {unit}" in found
