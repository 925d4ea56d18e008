"""The holes of a job: those that stand in it, or those of a CSV file or a CAD file beside it."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from zerorev.errors import InputError
from zerorev.files.cad.as_listed import CadHoles, asked_of, cad_holes, is_cad, read_cad, robot_in
from zerorev.files.conversion import hole_from
from zerorev.files.hole_list import all_of, given_of, in_base_frame, read_hole_list, text_of_list
from zerorev.files.hole_meaning import as_in_a_job, meaning_of
from zerorev.files.schema import HoleForm, JobFile
from zerorev.files.text import Document, read_bytes
from zerorev.files.validation import inside
from zerorev.model._arrays import Array
from zerorev.model.finding import Finding
from zerorev.model.hole import Hole
from zerorev.model.robot import Robot
from zerorev.model.tool import Tool

__all__ = ["cad_holes_of", "holes_of"]


def holes_of(
    form: JobFile,
    document: Document,
    folder: Path | None,
    robot: Robot,
    tool: Tool,
    T_base_part: Array,
    *,
    depth_needed: bool,
) -> tuple[tuple[Hole, ...], tuple[str, ...], tuple[Finding, ...]]:
    """The holes of a job in the base frame.

    Args:
        form: the job.
        document: that it stands in.
        folder: where a relative path starts; None: no other file is opened.
        robot: of the job.
        tool: of the job.
        T_base_part: part frame, shape (4, 4), translation [m].
        depth_needed: whether each hole must have its depth.

    Returns:
        the holes; what was left out, in words; what was assumed, and what is probably wrong.

    Raises:
        InputError: a hole that cannot be used, or a file that cannot be read.
    """
    notes: tuple[str, ...] = ()
    said: tuple[Finding, ...] = ()
    if isinstance(form.holes, str) and is_cad(form.holes):
        listed = cad_holes_of(form, document, folder, robot, T_base_part)
        with inside(form.holes):
            holes = _drilled(listed.forms, form, tool, T_base_part, depth_needed=depth_needed)
        notes, said = listed.notes, listed.said
    elif form.select is not None:
        accepted = "holes: the path of a STEP or DXF file; or without this key"
        raise InputError("goes with a CAD file of holes", where=document.where(("select",)), accepted=accepted)
    elif isinstance(form.holes, str):
        holes, notes = _table(form, document, folder, tool, T_base_part, depth_needed=depth_needed)
    else:
        _check_listed(form, document, depth_needed=depth_needed)
        holes = _holes(form, document, tool, T_base_part)
    return tuple(holes.values()), tuple(f"{form.holes}: {note}" for note in notes), said


def cad_holes_of(form: JobFile, document: Document, folder: Path | None, robot: Robot, T_base_part: Array) -> CadHoles:
    """The holes of a job's CAD file.

    Args:
        form: the job, its `holes` the path of such a file.
        document: that it stands in.
        folder: where a relative path starts; None: no other file is opened.
        robot: of the job.
        T_base_part: part frame, shape (4, 4), translation [m].

    Raises:
        InputError: as `read_cad` and `cad_holes`.
    """
    assert isinstance(form.holes, str)
    content, path = _beside(form.holes, document, folder, "a CAD file of holes: STEP or DXF")
    with inside(str(path)):
        asked = asked_of(form)
        return cad_holes(read_cad(content, form.holes, asked), asked, robot_in(T_base_part, robot))


def _drilled(
    forms: Sequence[HoleForm], form: JobFile, tool: Tool, T_base_part: Array, *, depth_needed: bool
) -> dict[str, Hole]:
    """The holes of a CAD file in the base frame, by their ids."""
    for hole in forms:
        if depth_needed and hole.depth_mm is None:
            accepted = "depth_mm in the job, or select: {layers: {NAME: {depth_mm: ...}}}"
            raise InputError("its file does not say how deep it is", where=f"hole {hole.id}", accepted=accepted)
    return {hole.id: hole_from(hole, form.psi_reference, tool, T_base_part) for hole in forms}


def _check_listed(form: JobFile, document: Document, *, depth_needed: bool) -> None:
    """Refuse what is missing in a list of holes that stands in a job, and keys that are for a CSV alone."""
    for key in ("columns", "unit", "decimal"):
        if getattr(form, key) is not None:
            what, accepted = "goes with a CSV file of holes", "holes: the path of a CSV file; or without this key"
            raise InputError(what, where=document.where((key,)), accepted=accepted)
    for n, hole in enumerate(form.holes):
        assert isinstance(hole, HoleForm)
        if depth_needed and hole.depth_mm is None and form.depth_mm is None:
            accepted = HoleForm.model_fields["depth_mm"].description or ""
            where = f"{document.where(('holes', n))}.depth_mm (hole {hole.id})"
            raise InputError("is missing", where=where, accepted=accepted)


def _holes(form: JobFile, document: Document, tool: Tool, T_base_part: Array) -> dict[str, Hole]:
    """The holes that stand in a job, by their ids."""
    holes: dict[str, Hole] = {}
    meaning = meaning_of(form)
    for n, listed in enumerate(form.holes):
        assert isinstance(listed, HoleForm)
        where = document.where(("holes", n))
        if listed.id in holes:
            raise InputError(f"the id '{listed.id}' is used twice", where=where, accepted="ids that differ")
        with inside(where):
            hole = as_in_a_job(listed, meaning)
            holes[hole.id] = hole_from(hole, form.psi_reference, tool, T_base_part)
    return holes


def _table(
    form: JobFile, document: Document, folder: Path | None, tool: Tool, T_base_part: Array, *, depth_needed: bool
) -> tuple[dict[str, Hole], tuple[str, ...]]:
    """The holes of a job's CSV, by their ids, and what was left out of it."""
    assert isinstance(form.holes, str)
    content, path = _beside(form.holes, document, folder, "a CSV file of holes, or a list of holes")
    with inside(str(path)):
        text = text_of_list(content)
        listed = read_hole_list(text, given_of(form), meaning_of(form), depth_needed=depth_needed)
        rows = all_of(in_base_frame(listed, form.psi_reference, tool, T_base_part))
    return {row.hole.id: row.hole for row in rows if row.hole is not None}, listed.notes


def _beside(name: str, document: Document, folder: Path | None, accepted: str) -> tuple[bytes, Path]:
    """The content of a file that a job names under `holes`, and its path."""
    if folder is None:
        inline = "a list of holes in the job itself"
        raise InputError("another file is not opened from here", where=document.where(("holes",)), accepted=inline)
    path = folder / name
    with inside(document.where(("holes",))):
        return read_bytes(path, accepted), path
