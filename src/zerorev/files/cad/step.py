"""STEP files: their holes, or their shape as triangles; each is read in a process of its own, with limits."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from zerorev.apart import Apart
from zerorev.errors import InputError
from zerorev.files.cad.found import FoundHole, FoundHoles
from zerorev.files.cad.needed import need_ocp
from zerorev.files.table_units import MILLIMETRES, Unit
from zerorev.files.text import read_bytes
from zerorev.files.validation import inside
from zerorev.model._arrays import Array

__all__ = ["MOST_FACES", "check_step", "found_in_step", "step_holes", "triangles"]

ACCEPTED = "a STEP file (.step, .stp)"
HEAD = b"ISO-10303-21"
MOST_FACES = 200_000  # of one file
NEAR_FACE = 1.0  # [mm] from a face to the place by which it is named

# what the reader calls a unit of length, in millimetres
UNITS = {
    "micrometre": 1e-3, "millimetre": 1.0, "centimetre": 10.0, "decimetre": 100.0, "metre": 1e3, "kilometre": 1e6,
    "INCH": 25.4, "FOOT": 304.8, "FEET": 304.8,
}  # fmt: skip


def step_holes(content: bytes, unit: Unit | None = None, places: Sequence[Sequence[float]] = ()) -> FoundHoles:
    """The holes of a STEP file, found in a process of its own.

    Args:
        content: of the file.
        unit: of its numbers, in place of the one that it states.
        places: whose faces are wanted [mm].

    Raises:
        InputError: the extra `cad` is not installed; not a STEP file, cut short, without a solid, too large.
    """
    (found,) = Apart(_holes).results([content, unit, list(places)])
    assert isinstance(found, FoundHoles)
    return found


def triangles(path: str | Path, deflection: float) -> tuple[Array, npt.NDArray[np.uint32]]:
    """The surface of the shape in a STEP file, in the file's own frame.

    Args:
        path: of the file.
        deflection: how far a triangle may be from the surface [m], as it is asked of the mesher.

    Returns:
        vertices [m], shape (N, 3); faces as numbers of vertices, shape (M, 3), their normals out of the material.

    Raises:
        InputError: the extra `cad` is not installed; not a STEP file, cut short, without a surface, too large.
    """
    need_ocp()
    content = read_bytes(Path(path), ACCEPTED)
    with inside(str(path)):
        check_step(content)
        ((vertices, faces),) = Apart(_triangles).results([content, deflection * 1e3])
    return vertices / 1e3, faces


def check_step(content: bytes) -> None:
    """Refuse what is not a whole STEP file, or has too many faces, before it is read.

    Raises:
        InputError: which of these.
    """
    if not content.lstrip().startswith(HEAD):
        raise InputError("is not a STEP file", accepted=ACCEPTED)
    if b"END-ISO-10303-21" not in content[-1000:]:
        raise InputError("is cut short: its last line is missing", accepted="the whole STEP file")
    if (count := content.count(b"ADVANCED_FACE")) > MOST_FACES:
        raise InputError(f"has {count:,} faces", accepted=f"{MOST_FACES:,} or less: export the part without the rest")


def found_in_step(content: bytes, unit: Unit | None, places: Sequence[Sequence[float]]) -> FoundHoles:
    """As `step_holes` in this process: only where it may crash."""
    need_ocp()
    check_step(content)
    from zerorev.files.cad import occ
    from zerorev.files.cad.step_holes import holes_of

    file = occ.read_step(content)
    stated = file.units()
    scale = 1.0 if unit is None else _scale(unit, stated)
    holes, left, count = list[FoundHole](), Counter[str](), 0
    for solid in file.solids(scale):
        found, others = holes_of(solid)
        holes += found
        left += others
        count += 1
    if not count:
        raise InputError("holds no solid", accepted="a STEP file of a solid, not of surfaces or curves alone")
    picked = [file.face_at([value / scale for value in place]) for place in places]
    for place, (_, away) in zip(places, picked, strict=True):
        if away * scale > NEAR_FACE:
            where = f"face_mm: {', '.join(f'{value:g}' for value in place)}"
            raise InputError(f"the nearest face is {away * scale:.3g} mm away", where=where, accepted="a point on it")
    notes = [f"left out, {n} time{'s' * (n > 1)}: {why}" for why, n in sorted(left.items())]
    if lost := file.faces_lost():
        notes.append(f"{lost} of its faces cannot be read: holes may be missing")
    numbered = tuple(replace(hole, id=f"H{n}") for n, hole in enumerate(holes, 1))
    millimetres = scale * UNITS.get(stated[0], 1.0) if len(stated) == 1 else scale
    faces = frozenset(number for number, _ in picked)
    return FoundHoles(numbered, ", ".join(stated), millimetres, tuple(notes), faces)


def _scale(unit: Unit, stated: Sequence[str]) -> float:
    """By what the places of a shape are multiplied where the numbers of its file have another unit than it states."""
    if len(stated) != 1 or stated[0] not in UNITS:
        what = f"states the units {', '.join(stated) or 'of nothing'}, and the job another one"
        raise InputError(what, where="unit", accepted="no unit, or a file with one unit of length")
    return MILLIMETRES[unit] / UNITS[stated[0]]


# --- tasks of `zerorev.apart` -----------------------------------------------------------------------------------------


def _holes(given: Iterator[Any]) -> Iterator[FoundHoles]:
    yield found_in_step(*given)


def _triangles(given: Iterator[Any]) -> Iterator[Any]:
    from zerorev.files.cad import occ

    content, deflection = given
    file = occ.read_step(content)
    if lost := file.faces_lost():
        raise InputError(f"{lost} of its faces cannot be read", accepted="a sound STEP file: a body without gaps")
    yield file.triangles(deflection)
