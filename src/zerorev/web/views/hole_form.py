"""Adding a hole and editing one: each field with its unit, and what is wrong with it beside it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from zerorev.errors import InputError
from zerorev.files.conversion import hole_from
from zerorev.files.schema import HoleForm
from zerorev.files.text import Document, FieldPath
from zerorev.files.validation import problems
from zerorev.model.hole import Hole
from zerorev.model.job import Job
from zerorev.report.words.hole_rows import part_data
from zerorev.web.job_edits import with_hole
from zerorev.web.session import Session
from zerorev.web.views.fields import Fields, ends, form, group, number

__all__ = ["hole_dialog", "hole_of", "reference_of"]

ROUNDED = 2e-9  # [m], [1]: what the fields leave out of a hole that is not changed
AXES = ("x", "y", "z"), ("i", "j", "k")


def hole_dialog(session: Session) -> Callable[[Hole | None], None]:
    """A form that is opened with the hole to edit, or with None to add one.

    Args:
        session: whose job the hole is of.
    """
    dialog, card, title = form("", "hole-form")
    fields, edited = Fields(), list[Hole | None]([None])
    with card:
        fields.text(("id",), "id", "hole-id")
        with group("Target: the bottom of the stroke, part frame [mm]", "zr-three"):
            for n, axis in enumerate(AXES[0]):
                fields.text(("target_mm", n), f"{axis} [mm]", f"hole-{axis}").props('inputmode="decimal"')
        fields.note("target_mm")
        with group("Direction: into the material, part frame, of any length", "zr-three"):
            for n, axis in enumerate(AXES[1]):
                fields.text(("direction", n), axis, f"hole-{axis}").props('inputmode="decimal"')
        fields.note("direction")
        fields.text(("depth_mm",), "depth: the stroke [mm]", "hole-depth").props('inputmode="decimal"')
        fields.line()

    def take() -> None:
        job, old = session.state.job, edited[0]
        if job is None:
            return
        hole, wrong = hole_of(_data(fields), job, old)
        if fields.show(wrong) or hole is None:
            return
        try:
            session.change(with_hole(session.state, hole, None if old is None else old.id))
        except InputError as error:
            fields.show([(("id",) if "twice" in error.what else (), error)])
        else:
            dialog.close()

    with card:
        ends(dialog, "Take", take)
    for field in fields.values():
        field.on("keydown.enter", take)

    def opened(hole: Hole | None) -> None:
        job = session.state.job
        if job is None:
            return
        edited[0] = hole
        title.set_text("Add a hole" if hole is None else f"Edit hole {hole.id}")
        like = hole or session.state.hole or job.holes[-1]
        target, direction, depth = part_data(like, job.T_base_part)
        values: dict[FieldPath, str] = {("id",): hole.id if hole else _new_id(job), ("depth_mm",): f"{depth:.10g}"}
        values |= {("target_mm", n): f"{value:.10g}" for n, value in enumerate(target)}
        values |= {("direction", n): f"{value:.10g}" for n, value in enumerate(direction)}
        for path, field in fields.items():
            field.set_value(values[path])
        fields.show([])
        dialog.open()

    return opened


def _data(fields: Fields) -> dict[str, Any]:
    """What stands in the fields, as a job file would have it."""
    data: dict[str, Any] = {"id": str(fields["id",].value or "").strip(), "depth_mm": number(fields["depth_mm",].value)}
    for name in ("target_mm", "direction"):
        data[name] = [number(fields[name, n].value) for n in range(3)]
    return data


def hole_of(data: dict[str, Any], job: Job, old: Hole | None) -> tuple[Hole | None, list[tuple[FieldPath, InputError]]]:
    """The hole that a user asks for, or what is wrong with it, field by field.

    Args:
        data: as a hole stands in a job file.
        job: that it is of.
        old: the hole whose place it takes; its branch stays, its given motion where the depth does, and where its
            psi = 0 is where the direction does.
    """
    if wrong := problems(HoleForm, Document("", data)):
        return None, wrong
    try:
        hole = hole_from(HoleForm.model_validate(data), reference_of(job), job.tool, job.T_base_part)
    except InputError as error:
        return None, [(("direction",), error)]  # of zero length, or along the reference of the spin
    if old is not None:
        given = old.profile if abs(hole.depth - old.depth) < 1e-9 else None
        hole = replace(hole, branch=old.branch, profile=given)
        if np.allclose(hole.target, old.target, rtol=0, atol=ROUNDED):
            hole = replace(hole, target=old.target)
        if np.allclose(hole.direction, old.direction, rtol=0, atol=ROUNDED):
            hole = replace(hole, direction=old.direction, psi_zero=old.psi_zero)
    return hole, []


def reference_of(job: Job) -> str | list[float]:
    """What the spin of a new hole is counted from: the job's own reference, or that of jobs that name none."""
    given = job.psi_reference
    return "base_y" if given is None else given if isinstance(given, str) else list(given)


def _new_id(job: Job) -> str:
    taken = {hole.id for hole in job.holes}
    return next(f"hole_{n}" for n in range(len(taken) + 1, 2 * len(taken) + 3) if f"hole_{n}" not in taken)
