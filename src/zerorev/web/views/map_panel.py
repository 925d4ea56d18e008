"""A workspace map among the holes: a plane through the selected hole is asked for, or one of an opened map shown."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from html import escape
from pathlib import Path
from typing import Any

from nicegui import ui

from zerorev.errors import InputError, ZerorevError
from zerorev.maps.chunks import Chunks
from zerorev.maps.planes import AXES
from zerorev.model.map_task import MapTask, Question
from zerorev.model.quantity import quantities
from zerorev.report.scene.map_slice import MapSlice, computed, plane_task, slice_of
from zerorev.report.words.workspace_map import heading
from zerorev.web.computing import Work
from zerorev.web.job_edits import with_cell
from zerorev.web.session import Session
from zerorev.web.state import State
from zerorev.web.views.notices import failed
from zerorev.workers import Machines

__all__ = ["map_panel"]

CUTS = {"drill": "across the drill", "x": "across X", "y": "across Y", "z": "across Z"}
EMPTY = (
    "A map asks the same of many places in a plane through the hole; the answers are shown as coloured cells around "
    "the robot. A click on a cell adds it to the holes, and plans it."
)
STATIC = Path(__file__).parents[1] / "static"
LENGTHS = {"width": 600, "height": 600, "spacing": 50}  # [mm], as first offered


def map_panel(session: Session, work: Work) -> None:
    """Draw what a plane is asked for with, and below it the map that is shown.

    Args:
        session: into whose job the cell goes that is clicked.
        work: what a plane is computed in.
    """
    ui.add_css(STATIC / "map_panel.css")
    with ui.element("div").classes("zr-map-panel").props('role="group" aria-label="workspace map"'):
        _ask(session, work)
        shown = ui.element("div").classes("zr-map-shown")

    def draw() -> None:
        cells = session.state.cells
        shown.clear()
        with shown:
            if cells is None:
                ui.label(EMPTY).classes("zr-muted")
            else:
                _shown(session, cells)

    def changed(before: State, after: State) -> None:
        if before.cells is not after.cells:
            draw()

    draw()
    session.watch(changed)
    session.hear("pick_cell", lambda cell: _pick(session, cell))


# --- a plane is asked for ---------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class _Form:
    """The fields, and the line for what is wrong with none of them."""

    quantity: ui.select
    cut: ui.select
    lengths: dict[str, ui.number]
    wrong: ui.label


def _ask(session: Session, work: Work) -> None:
    with ui.element("div").classes("zr-map-ask"):
        quantity = ui.select(_offered(), value="deepest", label="Ask each cell for").props(_look("map-quantity"))
        cut = ui.select(CUTS, value="drill", label="Plane through the hole").props(_look("map-cut"))
        lengths = {
            name: ui.number(f"{name.capitalize()} [mm]", value=value, format="%g").props(_look(f"map-{name}"))
            for name, value in LENGTHS.items()
        }
        button = ui.button("Map", icon="grid_on").props('unelevated no-caps data-testid="map"')
        wrong = ui.label().classes("zr-map-error").props('role="alert" data-testid="map-error"')
    form = _Form(quantity, cut, lengths, wrong)
    button.on_click(lambda: _start(session, work, form))

    def changed(before: State, after: State) -> None:
        if (before.progress is None) != (after.progress is None) or (before.hole is None) != (after.hole is None):
            button.set_enabled(after.progress is None and after.hole is not None)

    button.set_enabled(session.state.progress is None and session.state.hole is not None)
    session.watch(changed)


def _look(name: str) -> str:
    return f'dense outlined options-dense hide-bottom-space data-testid="{name}"'


def _start(session: Session, work: Work, form: _Form) -> None:
    """Begin, or say beside the field what is wrong."""
    for field in form.lengths.values():
        field.error = None
    form.wrong.set_text("")
    try:
        task = _task(session.state, form)
    except InputError as error:
        words = f"{error.what}; {error.accepted}"
        if error.where in form.lengths:
            form.lengths[error.where].error = words
        else:
            form.wrong.set_text(words)
        return
    job = session.state.job

    def take(state: State, found: Sequence[Any]) -> State | None:
        if job is None or state.job is None or state.job.robot is not job.robot or state.job.tool is not job.tool:
            return None
        return replace(state, cells=slice_of(found[-1]))

    title = f"mapping {task.cells:,} cells"
    if not work.start(title, Chunks.of(task).count, lambda: computed(task, Machines()), take):
        form.wrong.set_text("something else is under way; wait for it, or cancel it")


def _task(state: State, form: _Form) -> MapTask:
    """The plane that the form asks for.

    Raises:
        InputError: a field that cannot be used, by its name; or what `MapTask` and `Question` refuse.
    """
    job, hole = state.job, state.hole
    if job is None or hole is None:
        raise InputError("no hole is selected", where="hole", accepted="a hole, through which the plane goes")
    width, height, spacing = (_length(name, field.value) for name, field in form.lengths.items())
    quantity = form.quantity.value
    question = Question(
        job.robot, job.tool, quantity, job.settings, tuple(hole.psi_zero.tolist()),
        hole.depth if quantities()[quantity].needs_depth else None,
    )  # fmt: skip
    return plane_task(question, hole.target, hole.direction, form.cut.value, (width, height), spacing)


def _length(name: str, value: Any) -> float:
    """A length [m] out of a field in mm."""
    if not isinstance(value, int | float) or not math.isfinite(value):
        raise InputError("is not a number", where=name, accepted="a length in mm")
    return value / 1e3


# --- the map that is shown --------------------------------------------------------------------------------------------


def _shown(session: Session, cells: MapSlice) -> None:
    title = cells.quantity.title
    ui.label(title[:1].upper() + title[1:]).classes("zr-map-title").props('data-testid="map-title"')
    ui.label(heading(cells.found)).classes("zr-muted")
    _choices(session, cells)
    keys = "".join(
        f'<li><span class="zr-swatch" style="background:{key.colour}"></span>{escape(key.words)}</li>'
        for key in cells.legend
    )
    ui.html(
        f'<ul class="zr-keys" data-testid="map-legend" aria-label="what the colours mean">{keys}</ul>', sanitize=False
    )
    with ui.element("div").classes("zr-map-choices"):
        if cells.best is not None:
            best = cells.best
            place = ", ".join(f"{value + 0.0:.4g}" for value in cells.position[best] * 1e3)
            words = f"Take the best cell: {cells.words(best)} at ({place}) mm"
            ui.button(words, on_click=lambda: _pick(session, best)).props('outline no-caps data-testid="map-best"')
        else:
            ui.label("No cell has an answer.").props('role="status"')
        away = ui.button("Take the map away", on_click=lambda: session.change(replace(session.state, cells=None)))
        away.props('flat no-caps data-testid="map-away"')
    ui.label("A click on a cell, in the view of the robot, adds it to the holes and plans it.").classes("zr-muted")


def _choices(session: Session, cells: MapSlice) -> None:
    """Of a map that has several directions or planes: which are shown."""
    found = cells.found
    with ui.element("div").classes("zr-map-choices"):
        if found.sizes["direction"] > 1:
            vectors = {n: _vector(found, n) for n in range(found.sizes["direction"])}

            def turn(direction: int) -> MapSlice:
                return slice_of(found, direction, cells.across, cells.at)

            _choice(session, "Direction", vectors, cells.direction, turn)
        if cells.across is not None and sum(found.sizes[axis] > 1 for axis in AXES) > 2:
            across = {axis: CUTS[axis] for axis in AXES}
            _choice(session, "Planes", across, cells.across, lambda axis: slice_of(found, cells.direction, axis))
        if cells.across is not None and found.sizes[cells.across] > 1:
            axis = cells.across
            places = {n: f"{axis.upper()} = {value:g} mm" for n, value in enumerate(found[f"{axis}_mm"].values)}
            _choice(session, "Plane", places, cells.at, lambda at: slice_of(found, cells.direction, axis, at))


def _choice(session: Session, name: str, options: dict[Any, str], value: Any, cut: Callable[[Any], MapSlice]) -> None:
    chosen = ui.select(options, value=value, label=name).props(_look(f"map-shown-{name.lower()}"))

    def show() -> None:
        try:
            session.change(replace(session.state, cells=cut(chosen.value)))
        except InputError as error:
            chosen.error = f"{error.what}; {error.accepted}"

    chosen.on_value_change(show)


def _vector(found: Any, number: int) -> str:
    values = (float(found[f"direction_{axis}"][number]) for axis in AXES)
    return "(" + ", ".join(f"{round(value, 3) + 0.0:g}" for value in values) + ")"


def _pick(session: Session, cell: Any) -> None:
    """A cell becomes a hole of the job; the page plans what is selected."""
    try:
        session.change(with_cell(session.state, int(cell)))
    except ZerorevError as error:
        words = f"{error.what}: no hole is made of it" if isinstance(error, InputError) else str(error)
        failed(words)


def _offered() -> dict[str, str]:
    """The quantities that a plane can be asked for, in words."""
    offered = [each for each in quantities().values() if each.offered]
    return {each.name: each.title + (", as deep as the hole" if each.needs_depth else "") for each in offered}
