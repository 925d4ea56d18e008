"""Holes of a table that has their points alone: their directions are the normals of a part's surface."""

from __future__ import annotations

import numpy as np

from zerorev.errors import InputError
from zerorev.files.cad.as_listed import CadHoles
from zerorev.files.cad.found import POINT, FoundHole
from zerorev.files.cad.surface import FAR, Faces, Normals, normals_at
from zerorev.files.hole_list import all_of, read_hole_list, text_of_list
from zerorev.files.hole_meaning import AS_IN_A_JOB
from zerorev.files.schema import HoleForm
from zerorev.files.table_layout import Given
from zerorev.files.table_units import Unit
from zerorev.files.units import plain
from zerorev.model._arrays import Array
from zerorev.model.finding import Finding
from zerorev.model.plan import named_holes

__all__ = ["points_on"]

BENT = np.deg2rad(2.0)  # between the triangles of a surface, from which on its normals are coarse
OFF = 0.5  # [mm] from the surface


def points_on(content: bytes, vertices: Array, faces: Faces, unit: Unit | None) -> CadHoles:
    """The holes of a table of points, drilled against the normals of a surface.

    Args:
        content: of a CSV file: ids, points where the drill enters, and depths, if it has them.
        vertices: of the surface [mm], shape (V, 3).
        faces: as numbers of vertices, shape (M, 3), their normals out of the material.
        unit: of the lengths of the table; None: as it says, or mm.

    Raises:
        InputError: a row that cannot be read; a point that is not near the surface.
    """
    given = Given(unit=unit)
    listed = read_hole_list(text_of_list(content), given, AS_IN_A_JOB, depth_needed=False, directions=False)
    forms = [row.form for row in all_of(listed) if row.form is not None]
    at = normals_at(np.array([form.target_mm for form in forms]), vertices, faces)
    lost = [form.id for form, off in zip(forms, at.off, strict=True) if not np.isfinite(off)]
    if lost:
        what = f"{named_holes(lost)}: more than {FAR:g} mm from the surface"
        raise InputError(what, accepted="points in the frame and the unit of the part")
    holes = tuple(_hole(form, n, at) for n, form in enumerate(forms))
    drilled = tuple(
        form.model_copy(update={"direction": list(plain(hole.direction))})
        for form, hole in zip(forms, holes, strict=True)
    )
    return CadHoles(holes, drilled, tuple(_said(forms, at)), listed.notes)


def _hole(form: HoleForm, n: int, at: Normals) -> FoundHole:
    notes = []
    if at.bend[n] > BENT:
        notes.append(f"{np.rad2deg(at.bend[n]):.2g} deg to the next triangle")
    if at.at_edge[n]:
        notes.append("at an edge of the part")
    if at.off[n] > OFF:
        notes.append(f"{at.off[n]:.2g} mm off the surface")
    direction = -at.normals[n] + 0.0
    return FoundHole(form.id, (POINT,), np.array(form.target_mm), direction, None, form.depth_mm, notes=tuple(notes))


def _said(forms: list[HoleForm], at: Normals) -> list[Finding]:
    """What to look at before these directions are drilled."""
    flags = (
        (at.bend > BENT, "the surface is coarse there: its triangles bend by more than 2 deg; export it finer"),
        (at.at_edge, "at an edge of the part, where the normal is one of two"),
        (at.off > OFF, f"more than {OFF:g} mm off the surface"),
    )
    named = [
        (named_holes(form.id for form, flag in zip(forms, flags_of, strict=True) if flag), why)
        for flags_of, why in flags
        if flags_of.any()
    ]
    return [Finding("warning", "normals", f"{ids}: {why}") for ids, why in named]
