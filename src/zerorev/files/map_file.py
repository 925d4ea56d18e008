"""Reading map files: MAP.yaml to a `MapTask`."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from zerorev.errors import InputError
from zerorev.files.conversion import cycle_from, tool_from
from zerorev.files.io import read_robot, read_tool
from zerorev.files.map_schema import MOST_CELLS, ConesForm, MapFile, RangeForm, SphereForm
from zerorev.files.stated_forms import noun_from
from zerorev.files.text import Document, csv_rows, read_text
from zerorev.files.units import m, rad
from zerorev.files.validation import checked, inside
from zerorev.files.yaml_text import yaml_document
from zerorev.model._arrays import Array, unit
from zerorev.model.job import Settings
from zerorev.model.map_task import SETTINGS, MapTask, Question, cone, sphere
from zerorev.model.quantity import in_words, quantity

__all__ = ["read_map_file"]

Axes = tuple[Array, Array, Array]
DIGITS = 9  # of a millimetre, so that 0.3 is 0.3


def read_map_file(path: str | Path) -> MapTask:
    """The map that a map file asks for; paths in it are relative to it.

    Raises:
        InputError: anything in the file, its CSV, its robot or its tool that cannot be used.
    """
    path = Path(path)
    document = yaml_document(read_text(path, "a map file (YAML)"), str(path))
    form = checked(MapFile, document)
    if (form.targets is None) == (form.points is None):
        what = "neither targets nor points" if form.targets is None else "both targets and points"
        raise InputError(what, where=document.file, accepted="targets (x_mm, y_mm, z_mm), or points (a CSV file)")
    with inside(document.file):
        question = _question(form, document, path.parent)
    with inside(document.where(("directions",))):
        directions = _directions(form)
    axes, ids = _box(form, document) if form.points is None else _points(document, path.parent / form.points)
    cells = len(directions) * (len(ids) if ids is not None else int(np.prod([float(len(axis)) for axis in axes])))
    if cells > MOST_CELLS:
        raise InputError(f"{cells:,} cells", where=document.file, accepted=f"{MOST_CELLS:,} or less")
    with inside(document.file):
        return MapTask(question, axes, directions, ids)


def _question(form: MapFile, document: Document, folder: Path) -> Question:
    with inside(document.place(("robot",))):
        robot = read_robot(form.robot, folder)
    with inside(document.place(("tool",))):
        tool = read_tool(form.tool, folder) if isinstance(form.tool, str) else tool_from(form.tool)
    if form.seed is not None and not quantity(form.quantity).seeded:
        accepted = f"for {in_words(lambda each: each.seeded, 'and')} alone"
        raise InputError(f"is not used by {form.quantity}", where="seed", accepted=accepted)
    settings = noun_from(Settings, form, SETTINGS, cycle=cycle_from(form.cycle))
    depth = None if form.depth_mm is None else float(m(form.depth_mm))
    reference = form.psi_reference if isinstance(form.psi_reference, str) else tuple(form.psi_reference)
    return Question(robot, tool, form.quantity, settings, reference, depth, form.seed or 0)


def _directions(form: MapFile) -> Array:
    given = form.directions
    if isinstance(given, SphereForm):
        return sphere(given.sphere)
    if isinstance(given, ConesForm):
        return cone(np.array(given.cone.axis), float(rad(given.cone.half_angle_deg)), given.cone.count)
    return np.stack([unit(vector, f"[{n}]") for n, vector in enumerate(given)])


def _box(form: MapFile, document: Document) -> tuple[Axes, None]:
    assert form.targets is not None
    axes = []
    for name in ("x_mm", "y_mm", "z_mm"):
        given, where = getattr(form.targets, name), document.where(("targets", name))
        values = _range(given, where) if isinstance(given, RangeForm) else np.array(given, dtype=float)
        if len(np.unique(values)) < len(values):
            raise InputError("a value appears twice", where=where, accepted="values that differ")
        axes.append(values)
    x, y, z = axes
    return (x, y, z), None


def _range(given: RangeForm, where: str) -> Array:
    if given.stop < given.start:
        what = f"stop {given.stop:g} is below start {given.start:g}, so the box is empty"
        raise InputError(what, where=where, accepted="start or more")
    steps = (given.stop - given.start) / given.step
    if steps > MOST_CELLS:
        raise InputError(f"{steps:.0f} steps", where=where, accepted=f"{MOST_CELLS:,} or less")
    values = given.start + given.step * np.arange(int(steps + 1e-9) + 1)
    return np.asarray(values.round(DIGITS))


def _points(document: Document, path: Path) -> tuple[Axes, tuple[str, ...]]:
    with inside(document.where(("points",))):
        text = read_text(path, "a CSV file of points")
    rows = [cells for _, cells in csv_rows(text, str(path), "id", ("x_mm", "y_mm", "z_mm"))]
    if not rows:
        raise InputError("no points", where=str(path), accepted="one row or more below the header")
    ids = tuple(cells["id"] for cells in rows)
    if len(set(ids)) < len(ids):
        twice = next(name for name in ids if ids.count(name) > 1)
        raise InputError(f"the id '{twice}' is used twice", where=str(path), accepted="ids that differ")
    x, y, z = (np.array([cells[name] for cells in rows]) for name in ("x_mm", "y_mm", "z_mm"))
    return (x, y, z), ids
