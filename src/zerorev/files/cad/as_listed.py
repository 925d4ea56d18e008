"""From a CAD file to the holes of a job, as a job file has them, and to what a user should know of them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from zerorev.errors import InputError
from zerorev.files.cad.chosen import ALL, SIDE, chosen, unlikely_unit
from zerorev.files.cad.dxf import dxf_holes, found_in_dxf
from zerorev.files.cad.found import BLIND, COUNTERBORED, COUNTERSUNK, TIP, FoundHole, FoundHoles
from zerorev.files.cad.select_form import SelectForm
from zerorev.files.cad.step import found_in_step, step_holes
from zerorev.files.hole_meaning import Meaning, as_in_a_job
from zerorev.files.schema import HoleForm, JobFile
from zerorev.files.table_units import Unit
from zerorev.files.units import mm, plain
from zerorev.files.values import MOST_HOLES
from zerorev.model._arrays import Array
from zerorev.model.finding import Finding
from zerorev.model.plan import named_holes
from zerorev.model.robot import Robot

__all__ = ["ENDINGS", "Asked", "CadHoles", "asked_of", "cad_holes", "is_cad", "read_cad", "robot_in"]

STEP, DXF = (".step", ".stp"), (".dxf",)
ENDINGS = STEP + DXF
OF_A_TABLE = ("columns", "decimal", "normals", "point")


@dataclass(frozen=True)
class Asked:
    """What a user says of the holes of a CAD file; as the keys of a job.

    Attributes:
        select: which of them are drilled.
        unit: of the file's numbers, in place of the one that it states.
        depth_mm: of each hole that the file gives none, or None.
        breakthrough_mm: how far the tip runs beyond the bottom of holes that are not blind.
        branch: the only IK branch, or None.
    """

    select: SelectForm = ALL
    unit: Unit | None = None
    depth_mm: float | None = None
    breakthrough_mm: float = 0.0
    branch: int | None = None


@dataclass(frozen=True)
class CadHoles:
    """The holes that a job drills of a CAD file.

    Attributes:
        holes: as the file has them, each with one entry.
        forms: the same as a job file has them; a depth that neither file nor job gives is None.
        said: what was assumed, and what is probably wrong.
        notes: what was left out, in words.
    """

    holes: tuple[FoundHole, ...]
    forms: tuple[HoleForm, ...]
    said: tuple[Finding, ...]
    notes: tuple[str, ...]


def is_cad(name: str | Path) -> bool:
    """Whether a file's name says that it is a CAD file with holes: STEP or DXF."""
    return Path(name).suffix.casefold() in ENDINGS


def asked_of(form: JobFile) -> Asked:
    """What a job says of the holes of its CAD file.

    Args:
        form: the job.

    Raises:
        InputError: a key that goes with a table alone.
    """
    for key in OF_A_TABLE:
        if key in form.model_fields_set:
            accepted = "holes: the path of a CSV file; or without this key"
            raise InputError("goes with a CSV file of holes", where=key, accepted=accepted)
    return Asked(form.select or ALL, form.unit, form.depth_mm, form.breakthrough_mm, form.branch)


def read_cad(content: bytes, name: str, asked: Asked, *, here: bool = False) -> FoundHoles:
    """All holes of a CAD file, found in a process of its own.

    Args:
        content: of the file.
        name: of the file, whose ending says which kind it is.
        asked: what the user says.
        here: in this process, which is one of its own already.

    Raises:
        InputError: as `step_holes` and `dxf_holes`; what the user says goes with another kind of file.
    """
    drawing, select = Path(name).suffix.casefold() in DXF, asked.select
    for key in ("solid", "face_mm") if drawing else ("layers",):
        if getattr(select, key) is not None:
            other = "a STEP file" if drawing else "a DXF file"
            raise InputError(f"goes with {other}", where=f"select.{key}", accepted=f"{other}; or without this key")
    if drawing:
        return (found_in_dxf if here else dxf_holes)(content, asked.unit)
    return (found_in_step if here else step_holes)(content, asked.unit, select.face_mm or ())


def robot_in(T_base_part: Array, robot: Robot) -> Array:
    """The shoulder of a robot in the part frame [mm], shape (3,): from there a hole is drilled that says no side.

    Args:
        T_base_part: part frame, shape (4, 4), translation [m].
        robot: of the job.
    """
    shoulder = np.array([0.0, 0.0, robot.arm.c1])
    return np.asarray(mm(T_base_part[:3, :3].T @ (shoulder - T_base_part[:3, 3])))


def cad_holes(found: FoundHoles, asked: Asked, robot: Array | None) -> CadHoles:
    """The holes of a CAD file that are drilled.

    Args:
        found: all holes of the file.
        asked: what the user says.
        robot: a point of the robot [mm], part frame, shape (3,); None: not known.

    Raises:
        InputError: as `chosen`.
    """
    holes = chosen(found, asked.select, robot)
    if len(holes) > MOST_HOLES:
        raise InputError(f"has {len(holes):,} holes", accepted=f"{MOST_HOLES:,} or less: select")
    unit = unlikely_unit(found) if asked.unit is None else None
    said = [] if unit is None else [Finding("warning", "units", unit)]
    return CadHoles(holes, tuple(_form(hole, asked) for hole in holes), (*said, *_assumed(holes, asked)), found.notes)


def _form(hole: FoundHole, asked: Asked) -> HoleForm:
    """The hole as a job file has it."""
    beyond = 0.0 if BLIND in hole.kinds else asked.breakthrough_mm
    meaning = Meaning(point="entry", depth_mm=asked.depth_mm, breakthrough_mm=beyond, branch=asked.branch)
    listed = HoleForm(
        id=hole.id,
        target_mm=list(plain(hole.entry)),
        direction=list(plain(hole.direction)),
        depth_mm=hole.depth,
        group=None if hole.diameter is None else f"{hole.diameter:.4g} mm",
    )
    if listed.depth_mm is None and asked.depth_mm is None:
        return listed
    return as_in_a_job(listed, meaning)


def _assumed(holes: Sequence[FoundHole], asked: Asked) -> list[Finding]:
    """What was assumed of the holes, each with the key that says otherwise."""
    said = []
    for side in dict.fromkeys(note for hole in holes for note in hole.notes if note.startswith(SIDE)):
        why = "nothing says from which side, so they are drilled"
        said.append(f"{_named(holes, side)}: {why} {side} (select: {{side: [x, y, z]}})")
    if tips := _named(holes, TIP):
        said.append(f"{tips}: the depth is to the tip of the drill point of the model")
    wide = [hole.id for hole in holes if COUNTERSUNK in hole.kinds or COUNTERBORED in hole.kinds]
    if wide:
        said.append(f"{named_holes(wide)}: countersunk or counterbored in the model; the plan drills the narrow part")
    blind = [hole.id for hole in holes if BLIND in hole.kinds]
    if asked.breakthrough_mm and blind:
        said.append(f"{named_holes(blind)}: blind, so drilled without breakthrough_mm")
    return [Finding("info", "cad", message) for message in said]


def _named(holes: Sequence[FoundHole], begins: str) -> str:
    """The holes of which a note begins so, in words; empty where there are none."""
    ids = [hole.id for hole in holes if any(note.startswith(begins) for note in hole.notes)]
    return named_holes(ids) if ids else ""
