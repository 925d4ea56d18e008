"""Holes of DXF drawings that the tests make by ezdxf: exact, also on a tilted plane and within blocks."""

from __future__ import annotations

import io

import ezdxf
import numpy as np
import pytest
from ezdxf.math import UCS, Vec3

from zerorev.errors import InputError
from zerorev.files.cad import dxf, needed
from zerorev.files.cad.dxf import MOST_NESTED, dxf_holes, found_in_dxf

TILTED = UCS(origin=(500, 300, 800), ux=(0, 1, 0), uz=(-1, 0, 0))


def drawing(units: int = 4):
    document = ezdxf.new("R2018")
    document.header["$INSUNITS"] = units
    return document, document.modelspace()


def content(document) -> bytes:
    stream = io.StringIO()
    document.write(stream)
    return stream.getvalue().encode()


def found(document, unit=None):
    return found_in_dxf(content(document), unit)


def test_points_circles_and_blocks_on_a_tilted_plane():
    document, space = drawing()
    block = document.blocks.new("H8")
    block.add_circle((1, 2), radius=4)
    outer = document.blocks.new("PAIR")
    outer.add_blockref("H8", (10, 0), dxfattribs={"rotation": 90, "layer": "INNER"})
    rng, truth = np.random.default_rng(0), []
    for n in range(20):
        u, v = (float(each) for each in rng.uniform(-100, 100, 2))
        if n % 4 == 0:
            space.add_point((u, v)).transform(TILTED.matrix)
            at, width = (u, v), None
        elif n % 4 == 1:
            space.add_circle((u, v), radius=3).transform(TILTED.matrix)
            at, width = (u, v), 6
        elif n % 4 == 2:
            space.add_blockref("H8", (u, v)).transform(TILTED.matrix)
            at, width = (u + 1, v + 2), 8
        else:
            space.add_blockref("PAIR", (u, v)).transform(TILTED.matrix)
            at, width = (u + 10 - 2, v + 1), 8
        truth.append((np.array([500.0, 300 + at[0], 800 - at[1]]), width))  # x of the plane along Y, y along -Z
    listed = found(document)
    assert len(listed.holes) == 20
    for (place, width), hole in zip(truth, listed.holes, strict=True):
        assert np.abs(hole.entry - place).max() < 1e-9
        assert hole.diameter == (None if width is None else pytest.approx(width))
        assert np.abs(hole.direction @ [1, 0, 0]) == pytest.approx(1) or width is None
        assert hole.depth is None
        assert np.array_equal(hole.entry, hole.other_entry)


def test_a_point_without_an_axis_says_so():
    document, space = drawing()
    space.add_point((1, 2, 3))
    space.add_point((5, 2, 3), dxfattribs={"extrusion": (0, 1, 0)})
    first, second = found(document).holes
    assert first.notes == ("along Z, as a point has no axis",)
    assert np.array_equal(first.direction, (0, 0, -1))
    assert second.notes == ()
    assert np.array_equal(second.direction, (0, -1, 0))


def test_circles_around_each_other_are_one_hole():
    document, space = drawing()
    for radius in (5, 2.5, 4):
        space.add_circle((10, 20), radius=radius)
    space.add_point((10, 20))
    space.add_circle((10, 20.5), radius=2.5)
    first, second = found(document).holes
    assert (first.diameter, first.mouth) == (5, "circle of 8 mm around it, circle of 10 mm around it")
    assert (second.diameter, second.mouth) == (5, "")


def test_layers_that_are_hidden_are_left_out():
    document, space = drawing()
    document.layers.add("OFF").off()
    document.layers.add("COLD").freeze()
    for n, layer in enumerate(("OFF", "COLD", "SEEN")):
        space.add_circle((n, 0), radius=1, dxfattribs={"layer": layer})
    listed = found(document)
    assert [hole.of for hole in listed.holes] == ["SEEN"]
    assert [note.partition(": ")[2] for note in listed.notes] == [
        "on the layer COLD, which is off or frozen", "on the layer OFF, which is off or frozen",
    ]  # fmt: skip


def test_a_block_on_layer_0_is_on_the_layer_of_its_place():
    document, space = drawing()
    block = document.blocks.new("B")
    block.add_circle((0, 0), radius=1, dxfattribs={"layer": "0"})
    block.add_circle((5, 0), radius=1, dxfattribs={"layer": "OWN"})
    space.add_blockref("B", (0, 0), dxfattribs={"layer": "PLACE"})
    assert [hole.of for hole in found(document).holes] == ["PLACE", "OWN"]


def test_a_block_in_rows_and_columns():
    document, space = drawing()
    document.blocks.new("B").add_circle((0, 0), radius=1)
    grid = {"row_count": 3, "column_count": 4, "row_spacing": 10, "column_spacing": 20}
    space.add_blockref("B", (1, 2), dxfattribs=grid)
    places = {tuple(np.round(hole.entry, 9)) for hole in found(document).holes}
    assert places == {(1 + 20 * column, 2 + 10 * row, 0) for row in range(3) for column in range(4)}


def test_blocks_that_are_stretched_or_mirrored():
    document, space = drawing()
    document.blocks.new("B").add_circle((3, 0), radius=1)
    space.add_blockref("B", (0, 0), dxfattribs={"xscale": -1})
    space.add_blockref("B", (0, 50), dxfattribs={"xscale": 2, "yscale": 2, "zscale": 2})
    space.add_blockref("B", (0, 90), dxfattribs={"xscale": 2, "yscale": 1})  # an oval: no hole
    first, second = found(document).holes
    assert np.allclose(first.entry, (-3, 0, 0), atol=1e-12)
    assert (first.diameter, second.diameter) == (pytest.approx(2), pytest.approx(4))
    assert np.allclose(second.entry, (6, 50, 0))


@pytest.mark.parametrize(("units", "scale"), [(1, 25.4), (2, 304.8), (4, 1.0), (5, 10.0), (6, 1000.0)])
def test_units_that_a_drawing_states(units, scale):
    document, space = drawing(units)
    space.add_circle((1, 2, 3), radius=0.5)
    (hole,) = found(document).holes
    assert hole.diameter == pytest.approx(scale)
    assert np.allclose(hole.entry, scale * np.array([1, 2, 3]))


@pytest.mark.parametrize(
    ("units", "says"), [(0, "does not say its unit"), (3, "INSUNITS is 3"), (99, "INSUNITS is 99")]
)
def test_a_drawing_without_a_unit_asks(units, says):
    document, space = drawing(units)
    space.add_circle((1, 2, 3), radius=0.5)
    with pytest.raises(InputError, match=says) as error:
        found(document)
    assert "unit: mm, m or in" in error.value.accepted
    assert found(document, "in").holes[0].diameter == pytest.approx(25.4)


def test_the_same_in_a_process_of_its_own():
    document, space = drawing()
    space.add_circle((1, 2, 3), radius=0.5)
    (here,), (there,) = found(document).holes, dxf_holes(content(document)).holes
    assert (here.id, here.diameter, tuple(here.entry)) == (there.id, there.diameter, tuple(there.entry))


def test_foreign_and_damaged_files_are_refused():
    document, space = drawing()
    space.add_circle((1, 2, 3), radius=0.5)
    whole = content(document)
    for damaged, says in (
        (b"", "is not a DXF file"),
        (b"ISO-10303-21;", "is not a DXF file"),
        (whole[: len(whole) // 2], "is cut short"),
        (whole[:5000].replace(b"SECTION", b"SECTION\nx", 1) + b"\nEOF\n", "cannot be read as DXF"),
    ):
        with pytest.raises(InputError, match=says):
            found_in_dxf(damaged, None)


def test_blocks_without_end_are_refused(monkeypatch):
    """A block of ten that are blocks of ten, and so on: a file of some kilobytes with a billion circles."""
    document, space = drawing()
    document.blocks.new("B0").add_circle((0, 0), radius=1)
    for n in range(1, 10):
        block = document.blocks.new(f"B{n}")
        for k in range(10):
            block.add_blockref(f"B{n - 1}", (k, n))
    space.add_blockref("B9", (0, 0))
    monkeypatch.setattr(dxf, "MOST_IN_BLOCKS", 2_000)
    with pytest.raises(InputError, match="more than 2,000 entities within blocks"):
        found(document)


def test_blocks_nested_too_deep_are_refused():
    document, space = drawing()
    document.blocks.new("B0").add_circle((0, 0), radius=1)
    for n in range(1, MOST_NESTED + 2):
        document.blocks.new(f"B{n}").add_blockref(f"B{n - 1}", (1, 1))
    space.add_blockref(f"B{MOST_NESTED + 1}", (0, 0))
    with pytest.raises(InputError, match="blocks in blocks"):
        found(document)


def test_hostile_names_are_made_visible():
    document, space = drawing()
    text = content(document)
    space.add_circle((1, 2, 3), radius=0.5, dxfattribs={"layer": "LAYERNAME"})
    text = content(document).replace(b"LAYERNAME", "a\x1b[2J\u202eb<b>".encode())
    (hole,) = found_in_dxf(text, None).holes
    assert hole.of == "a\\x1b[2J\\u202eb<b>"


def test_a_missing_library_is_named_with_its_extra(monkeypatch):
    monkeypatch.setattr(needed, "find_spec", lambda name: None)
    with pytest.raises(InputError, match=r"ezdxf, which is not installed.*zerorev\[cad\]"):
        found_in_dxf(b"", None)


def test_the_plane_of_the_test_is_as_it_says():
    assert TILTED.to_wcs(Vec3(1, 2, 0)).isclose((500, 301, 798))
