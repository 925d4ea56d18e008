"""The holes of a CAD file that are to be drilled, each from one side: what a user chooses, and what is assumed."""

from __future__ import annotations

from collections import Counter
from dataclasses import replace

import numpy as np

from zerorev.errors import InputError
from zerorev.files.cad.found import FoundHole, FoundHoles
from zerorev.files.cad.select_form import LayerForm, SelectForm
from zerorev.files.table_units import MILLIMETRES
from zerorev.model._arrays import Array, unit

__all__ = ["ALL", "SIDE", "chosen", "unlikely_unit"]

ALL = SelectForm.model_construct()  # all of its defaults
ACROSS = 0.05  # cosine between a side and an axis, below which the side does not say which way
UP = ((0.0, 0.0, 1.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0))  # sides where neither the job nor the user names one
LIKELY = (0.8, 50.0)  # [mm] that a robot drills with a twist drill
MOST_SHOWN = 8
SIDE = "from the side"  # begins a note of the side that was assumed
SAME = 1e-6  # [mm] between diameters


def chosen(found: FoundHoles, select: SelectForm, robot: Array | None) -> tuple[FoundHole, ...]:
    """The holes that are to be drilled, each with one entry; their notes say what was assumed.

    Args:
        found: of a file.
        select: what the user says.
        robot: a point of the robot [mm], in the frame of the file, shape (3,); None: not known.

    Raises:
        InputError: none is left; a layer or a solid that the file does not have; a side along no axis.
    """
    _check_names(found, select)
    holes = [_as_on_layer(hole, select) for hole in found.holes]
    holes = [hole for hole in holes if _is_chosen(hole, select, found.picked)]
    if not holes:
        what = "has no holes" if not found.holes else "has no such holes"
        raise InputError(what, where="select" if found.holes else "", accepted=_there(found))
    return tuple(_drilled(hole, select, found.picked, robot) for hole in holes)


def unlikely_unit(found: FoundHoles) -> str | None:
    """What is probably wrong with the unit of a file, by the diameters of its holes, in words; or None.

    Args:
        found: of a file.
    """
    widths = sorted(hole.diameter for hole in found.holes if hole.diameter is not None)
    if not widths or LIKELY[0] <= widths[len(widths) // 2] <= LIKELY[1]:
        return None
    between = f"{widths[0]:.4g} mm" if widths[0] == widths[-1] else f"{widths[0]:.4g} to {widths[-1]:.4g} mm"
    middle = widths[len(widths) // 2]
    likely = [name for name, scale in MILLIMETRES.items() if LIKELY[0] <= middle / found.scale * scale <= LIKELY[1]]
    cure = f"unit: {' or '.join(likely)}" if likely else "unit: mm, m or in"
    return (
        f"the holes are {between} wide, by a file that states the unit {found.unit or 'of nothing'}: are its numbers "
        f"in another one? {cure}"
    )


def _check_names(found: FoundHoles, select: SelectForm) -> None:
    there = list(dict.fromkeys(hole.of for hole in found.holes))
    for key, names in (("solid", select.solid), ("layers", list(select.layers or ()))):
        for name in names or ():
            if name not in there:
                shown = ", ".join(there[:MOST_SHOWN]) + (" ..." if len(there) > MOST_SHOWN else "")
                raise InputError(f"'{name}' has no holes", where=f"select.{key}", accepted=shown)
    if select.id is not None:
        known = {hole.id for hole in found.holes}
        if absent := next((each for each in select.id if each not in known), None):
            raise InputError(f"no hole '{absent}'", where="select.id", accepted="ids that zerorev holes shows")


def _as_on_layer(hole: FoundHole, select: SelectForm) -> FoundHole:
    """The hole with what the job says of its layer."""
    layer = (select.layers or {}).get(hole.of, LayerForm())
    if layer.diameter_mm is not None:
        hole = replace(hole, diameter=layer.diameter_mm)
    if layer.depth_mm is not None:
        hole = replace(hole, depth=layer.depth_mm)
    if layer.direction is not None:
        direction = unit(layer.direction, f"select.layers.{hole.of}.direction")
        hole = replace(hole, direction=direction, other_entry=None)
    return hole


def _is_chosen(hole: FoundHole, select: SelectForm, picked: frozenset[int]) -> bool:
    least, most = select.diameter_mm or (0.0, np.inf)
    opens_in = hole.faces[0] | (hole.faces[1] if hole.other_entry is not None else frozenset())
    return (
        (select.id is None or hole.id in select.id)
        and (select.kind is None or bool(set(select.kind) & set(hole.kinds)))
        and (select.diameter_mm is None or least - SAME <= (hole.diameter or -1.0) <= most + SAME)
        and (select.solid is None or hole.of in select.solid)
        and (select.layers is None or hole.of in select.layers)
        and (select.face_mm is None or bool(picked & opens_in))
    )


def _drilled(hole: FoundHole, select: SelectForm, picked: frozenset[int], robot: Array | None) -> FoundHole:
    """The hole with one entry; where nobody named it, a note says which side was assumed."""
    if hole.other_entry is None:
        return hole
    if picked & (hole.faces[0] ^ hole.faces[1]):
        return _from(hole, same=bool(picked & hole.faces[0]))
    if isinstance(select.side, list):
        towards = unit(select.side, "select.side")
        if abs(towards @ hole.direction) < ACROSS:
            what = f"it lies across the axis of hole {hole.id}"
            raise InputError(what, where="select.side", accepted="a vector along the axes")
        return _from(hole, same=bool(towards @ hole.direction < 0))
    if robot is not None:
        ahead = (hole.entry + hole.other_entry) / 2 - robot
        side = "" if select.side == "robot" else "of the robot"
        return _from(hole, same=bool(ahead @ hole.direction >= 0), side=side)
    if select.side == "robot":
        raise InputError("the robot is not known here", where="select.side", accepted="a job; or three numbers")
    towards = next(axis for axis in np.array(UP) if abs(axis @ hole.direction) >= ACROSS)
    return _from(hole, same=bool(towards @ hole.direction < 0), side=f"+{'XYZ'[int(np.argmax(towards))]}")


def _from(hole: FoundHole, *, same: bool, side: str = "") -> FoundHole:
    assert hole.other_entry is not None
    notes = (*hole.notes, f"{SIDE} {side}") if side else hole.notes
    if same:
        return replace(hole, other_entry=None, notes=notes)
    return replace(
        hole, entry=hole.other_entry, direction=-hole.direction + 0.0, other_entry=None, notes=notes,
        faces=hole.faces[::-1],
    )  # fmt: skip


def _there(found: FoundHoles) -> str:
    """What there is to choose from, in words."""
    if not found.holes:
        return "a file with holes: cylinders in solids (STEP), points and circles (DXF)"
    widths = Counter(f"{hole.diameter:.4g} mm" for hole in found.holes if hole.diameter is not None)
    kinds = Counter(kind for hole in found.holes for kind in hole.kinds)
    return f"there are {_counted(widths)}; {_counted(kinds)}" if widths else f"there are {_counted(kinds)}"


def _counted(counts: Counter[str]) -> str:
    shown = [f"{count} of {name}" if name.endswith("mm") else f"{count} {name}" for name, count in counts.most_common()]
    return ", ".join([*shown[:MOST_SHOWN], *(["..."] if len(shown) > MOST_SHOWN else [])])
