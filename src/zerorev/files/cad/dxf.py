"""Holes of DXF drawings: points, circles, and those within blocks; the only file that imports ezdxf.

A drawing says where a hole is and along which line, not how deep, nor from which side. Layers stand for that, by a
table of the job.
"""

from __future__ import annotations

import io
import logging
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from zerorev.apart import Apart
from zerorev.errors import InputError
from zerorev.files.cad.found import CIRCLE, POINT, FoundHole, FoundHoles
from zerorev.files.cad.needed import need_ezdxf
from zerorev.files.table_units import MILLIMETRES, Unit
from zerorev.model._arrays import Array
from zerorev.visible import one_line

__all__ = ["dxf_holes", "found_in_dxf"]

ACCEPTED = "a DXF drawing (.dxf)"
MOST_IN_BLOCKS = 100_000  # entities of blocks, at each of their places
KINDS = ("INSERT", "POINT", "CIRCLE", "ELLIPSE")
MOST_NESTED = 20  # blocks within blocks
ROUND = 1e-3  # by which the axes of an ellipse may differ, of a circle in a block that is stretched
SAME = 0.01  # [mm] between the centres of circles that are one hole
PARALLEL = 1e-4  # [1] between the entries of d d^T of two axes that are one
OFF_GRID = 0.3141592  # of a cell: where no drawing has its round numbers
# DXF reference, $INSUNITS: the unit by its number, and millimetres in it
UNITS = {
    1: ("in", 25.4), 2: ("ft", 304.8), 4: ("mm", 1.0), 5: ("cm", 10.0), 6: ("m", 1e3), 8: ("microinch", 25.4e-6),
    9: ("mil", 25.4e-3), 10: ("yd", 914.4), 13: ("micrometre", 1e-3), 14: ("dm", 100.0),
}  # fmt: skip


@dataclass(frozen=True)
class _Mark:
    """A point or a circle.

    Attributes:
        place: its centre, in the unit of the drawing, shape (3,).
        axis: the way out of the drawing, unit, shape (3,).
        diameter: of a circle, in the unit of the drawing; None: a point.
        layer: on which it is; in a block on layer 0 that of the block's place.
        has_axis: whether the drawing says the axis.
    """

    place: Array
    axis: Array
    diameter: float | None
    layer: str
    has_axis: bool = True


def dxf_holes(content: bytes, unit: Unit | None = None) -> FoundHoles:
    """The holes of a DXF drawing, found in a process of its own.

    Args:
        content: of the file.
        unit: of its numbers, in place of the one that it states.

    Raises:
        InputError: the extra `cad` is not installed; not a DXF file, damaged, without a unit, too large.
    """
    (found,) = Apart(_holes).results([content, unit])
    assert isinstance(found, FoundHoles)
    return found


def found_in_dxf(content: bytes, unit: Unit | None) -> FoundHoles:
    """As `dxf_holes` in this process."""
    need_ezdxf()
    _check_whole(content)
    log = logging.getLogger("ezdxf")  # a line for each thing that is damaged, on the terminal
    said, log.disabled = log.disabled, True
    try:
        return _found(content, unit)
    except InputError:
        raise
    except Exception as error:  # any error of its reader
        raise InputError(f"cannot be read as DXF: {error}", accepted=ACCEPTED) from None
    finally:
        log.disabled = said


def _found(content: bytes, unit: Unit | None) -> FoundHoles:
    from ezdxf import recover

    drawing = recover.read(io.BytesIO(content))[0]
    stated, scale = _unit(int(drawing.header.get("$INSUNITS", 0)), unit)
    left = Counter[str]()
    hidden = {layer.dxf.name.casefold() for layer in drawing.layers if layer.is_off() or layer.is_frozen()}
    marks = []
    for mark in _marks(drawing.modelspace(), "", 0, left, [0]):
        if mark.layer.casefold() in hidden:
            left[f"on the layer {one_line(mark.layer)}, which is off or frozen"] += 1
        else:
            marks.append(mark)
    holes = [_hole(n, mark, wider, scale) for n, (mark, wider) in enumerate(_joined(marks, scale), 1)]
    notes = [f"left out, {n} time{'s' * (n > 1)}: {why}" for why, n in sorted(left.items())]
    return FoundHoles(tuple(holes), stated, scale, tuple(notes))


def _check_whole(content: bytes) -> None:
    """Refuse what is not a whole drawing, before what is left of it is recovered."""
    if b"SECTION" not in content[:4096]:
        raise InputError("is not a DXF file", accepted=ACCEPTED)
    if b"EOF" not in content[-64:]:
        raise InputError("is cut short: its last line is missing", accepted="the whole DXF file")


def _unit(stated: int, given: Unit | None) -> tuple[str, float]:
    """The unit of a drawing in words, and millimetres in it.

    Raises:
        InputError: neither the drawing nor the job says it.
    """
    name, scale = UNITS.get(stated, ("", 0.0))
    if given is not None:
        return name or "none", MILLIMETRES[given]
    if not name:
        what = "does not say its unit ($INSUNITS is 0)" if stated == 0 else f"$INSUNITS is {stated}"
        raise InputError(what, where="unit", accepted="unit: mm, m or in in the job (--unit)")
    return name, scale


def _marks(entities: Iterable[Any], layer: str, nested: int, left: Counter[str], count: list[int]) -> Iterator[_Mark]:
    """Points and circles of a space or of a block, those of blocks within it at their places.

    Args:
        entities: of the space or the block.
        layer: on which the block stands; empty: a space.
        nested: how many blocks it is in.
        left: what is left out, and how often.
        count: of the entities within blocks so far, in a list of one.
    """
    for entity in entities:
        count[0] += nested > 0
        if count[0] > MOST_IN_BLOCKS:
            what = f"has more than {MOST_IN_BLOCKS:,} entities within blocks"
            raise InputError(what, accepted="a drawing of the holes alone")
        kind = entity.dxftype()
        if kind not in KINDS:
            continue
        own = str(entity.dxf.get("layer", "0"))
        own = layer if layer and own == "0" else own
        if kind == "INSERT":
            if nested == MOST_NESTED:
                raise InputError(f"has blocks in blocks, {MOST_NESTED} and more", accepted="fewer")
            for place in entity.multi_insert() if entity.mcount > 1 else (entity,):
                yield from _marks(_of_block(place, left), own, nested + 1, left, count)
        elif kind == "POINT":
            place, axis = np.array(entity.dxf.location), _unit_of(entity.dxf.extrusion)
            yield _Mark(place, axis, None, own, entity.dxf.hasattr("extrusion"))
        elif kind == "CIRCLE":
            centre = np.array(entity.ocs().to_wcs(entity.dxf.center))
            yield _Mark(centre, _unit_of(entity.dxf.extrusion), 2 * float(entity.dxf.radius), own)
        elif kind == "ELLIPSE" and abs(entity.dxf.ratio - 1) < ROUND and _is_whole(entity):
            diameter = 2 * float(entity.dxf.major_axis.magnitude)
            yield _Mark(np.array(entity.dxf.center), _unit_of(entity.dxf.extrusion), diameter, own)


def _of_block(insert: Any, left: Counter[str]) -> Iterator[Any]:
    def skipped(entity: Any, why: str) -> None:
        if entity.dxftype() in ("POINT", "CIRCLE", "INSERT"):
            left[f"within a block: {one_line(str(why))}"] += 1

    return iter(insert.virtual_entities(skipped_entity_callback=skipped))


def _is_whole(ellipse: Any) -> bool:
    return bool(abs(abs(ellipse.dxf.end_param - ellipse.dxf.start_param) - 2 * np.pi) < ROUND)


def _unit_of(vector: Any) -> Array:
    found = np.array(vector, dtype=float)
    length = float(np.linalg.norm(found))
    return found / length if length > 0 else np.array([0.0, 0.0, 1.0])


def _joined(marks: Sequence[_Mark], scale: float) -> Iterator[tuple[_Mark, list[_Mark]]]:
    """The marks of one hole on one layer together: the smallest circle, or the point, and what is wider."""
    groups: dict[tuple[object, ...], list[_Mark]] = {}
    for mark in marks:
        if not np.isfinite([*mark.place, mark.diameter or 0.0]).all():
            continue
        cell = np.floor(np.array(mark.place) * scale / SAME + OFF_GRID)
        line = np.floor(np.outer(mark.axis, mark.axis).ravel() / PARALLEL + OFF_GRID)  # the same for both senses
        groups.setdefault((mark.layer, *cell, *line), []).append(mark)
    for group in groups.values():
        circles = sorted((mark for mark in group if mark.diameter), key=lambda mark: mark.diameter or 0.0)
        yield (circles or group)[0], circles[1:]


def _hole(number: int, mark: _Mark, wider: Sequence[_Mark], scale: float) -> FoundHole:
    widths = sorted({round((each.diameter or 0.0) * scale, 6) for each in wider})
    widths = [width for width in widths if mark.diameter and width > mark.diameter * scale * (1 + 1e-6)]
    return FoundHole(
        id=f"P{number}",
        kinds=(POINT if mark.diameter is None else CIRCLE,),
        entry=mark.place * scale,
        direction=-mark.axis + 0.0,
        diameter=None if mark.diameter is None else mark.diameter * scale,
        depth=None,
        other_entry=mark.place * scale,
        of=one_line(mark.layer),
        mouth=", ".join(f"circle of {width:.4g} mm around it" for width in widths),
        notes=() if mark.has_axis else ("along Z, as a point has no axis",),
    )


# --- a task of `zerorev.apart` ----------------------------------------------------------------------------------------


def _holes(given: Iterator[Any]) -> Iterator[FoundHoles]:
    yield found_in_dxf(*given)
