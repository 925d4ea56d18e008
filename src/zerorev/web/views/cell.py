"""The cell: robot, part and holes in three dimensions, the motion to be played; a click selects a hole."""

from __future__ import annotations

from contextlib import suppress
from functools import partial
from pathlib import Path
from time import monotonic
from typing import Any

import nicegui
import numpy as np
from nicegui import background_tasks, ui
from nicegui.element import Element
from nicegui.events import GenericEventArguments

from zerorev.errors import InputError
from zerorev.model.job import Job
from zerorev.motion.drilling import Drilling
from zerorev.report import scene
from zerorev.report.scene.cell_data import arm_data, holes_data, reversals_data, slice_data, track_data
from zerorev.report.scene.clearance_data import nearest_data
from zerorev.report.scene.motion_look import held
from zerorev.report.scene.solids_data import solids_data
from zerorev.web.aside import aside
from zerorev.web.session import Session
from zerorev.web.state import State, selected, shown
from zerorev.web.throttle import throttled

__all__ = ["CellView", "cell"]

PLAYER = Path(scene.__file__).parent / "static"
THREE = Path(nicegui.__file__).parent / "elements" / "scene" / "dist"
UNANSWERED = 1.0  # [s] after which a browser that said nothing is taken to be ready for more
HOLES_APART = 0.4  # [s] between two drawings of the holes, which a running plan answers one after the other
MOTIONS_APART = 0.05  # [s]


class CellView(
    Element,
    component=Path(__file__).parents[1] / "static" / "cell_view.js",
    esm={"nicegui-scene": str(THREE), "zerorev-cell": str(PLAYER)},
):
    """The browser's half: `zerorev/report/scene/static/cell.js`."""


def cell(session: Session) -> CellView:
    """Draw the cell in the current slot.

    It tells `pick_cell` (the number of the cell of the map that was clicked), and both hears and tells `seek` (see
    `Session.hear`).

    Args:
        session: what is shown.
    """
    ui.add_css(PLAYER / "cell.css")
    view = CellView().classes("zr-cell-view").props('data-testid="cell"')
    sender = _Sender(session, view)
    session.watch(sender.changed)
    session.hear("seek", sender.sought)
    view.on("ready", sender.ready)
    view.on("drawn", sender.drawn)
    view.on("pick_hole", sender.picked)
    view.on("pick_cell", lambda event: session.tell("pick_cell", int(event.args["index"])))
    view.on("seek", sender.receive)
    return view


class _Sender:
    """Sends what has changed, and no faster than the browser draws it."""

    def __init__(self, session: Session, view: CellView) -> None:
        self._session, self._view = session, view
        self._is_ready = self._telling = False
        self._waits_since: float | None = None
        self._held: tuple[Any, ...] | None = None
        self._sent: object = None  # the holes that the browser has
        self._around: object = None  # the robot of whose bodies distances are computed at once
        self._holes = throttled(self._send_holes, HOLES_APART)
        self._reversals = throttled(self._send_reversals, HOLES_APART)
        self._motion = throttled(self._send_motion, MOTIONS_APART)

    def ready(self) -> None:
        """The browser has built its half: send it all."""
        self._is_ready, self._held, self._waits_since = True, None, None
        job = self._session.state.job
        if job is not None:
            self._scene(arm=arm_data(job.robot, job.tool, self._session.state.meshes))
            self._send_holes()
            self._send_motion()
            self._send_cells()
            background_tasks.create(self._send_solids(job))

    def changed(self, before: State, after: State) -> None:
        """Send what is another object than before."""
        old, new = before.job, after.job
        if not self._is_ready or new is None:
            return
        if old is None or old.robot is not new.robot or old.tool is not new.tool:
            self.ready()
            return
        if old.holes is not new.holes or old.T_base_part is not new.T_base_part:
            self._holes()
        elif before.answers is not after.answers:
            self._reversals()
        if before.cells is not after.cells:
            self._send_cells()
        if before.selected != after.selected:
            self._scene(selected=after.selected)
        same_hole = before.hole is after.hole and before.stroke == after.stroke and old.settings is new.settings
        if not same_hole or before.steered is not after.steered or before.answer is not after.answer:
            self._motion()

    def drawn(self) -> None:
        """The browser has drawn the last motion, and may have the next."""
        self._waits_since = None

    def picked(self, event: GenericEventArguments) -> None:
        """A hole was clicked."""
        with suppress(InputError):  # gone meanwhile
            self._session.change(selected(self._session.state, event.args["id"]))

    def receive(self, event: GenericEventArguments) -> None:
        """The browser has gone to another place of the motion."""
        self._telling = True
        self._session.tell("seek", float(event.args["x"]))
        self._telling = False

    def sought(self, x: float) -> None:
        """Another view has gone to another place of the motion."""
        if not self._telling:
            self._view.run_method("seek", x)

    def _scene(self, **data: Any) -> None:
        self._view.run_method("show_scene", data)

    def _send_holes(self) -> None:
        state = self._session.state
        if state.job is not None:
            holes = holes_data(
                state.job.holes, state.job.T_base_part, state.answers,
                shaped=state.job.settings.surroundings.part is not None,
            )  # fmt: skip
            self._scene(holes=holes, selected=state.selected)
            self._sent = state.job.holes

    async def _send_solids(self, job: Job) -> None:
        """Bodies and surroundings: large meshes take a second or two to be made ready."""
        data = await aside(partial(_solids, job))
        now = self._session.state.job
        if data is None or now is None or now.robot is not job.robot or self._view.is_deleted:
            return
        self._around = job.robot
        self._scene(solids=data)
        self._motion()

    def _send_reversals(self) -> None:
        state = self._session.state
        if state.job is not None and state.job.holes is self._sent:  # others are on their way, with theirs
            self._scene(reversals=reversals_data(state.job.holes, state.answers))

    def _send_cells(self) -> None:
        """The cells of the map, or that there is none."""
        cells = self._session.state.cells
        if cells is None:
            self._view.run_method("show_slice", None)
            return
        words = [cells.words(n) for n in range(len(cells.value))]
        data = slice_data(cells.position, cells.edges, cells.colours, words, cells.quantity.label)
        self._view.run_method("show_slice", data)

    def _send_motion(self) -> None:
        if self._waits_since is not None and monotonic() - self._waits_since < UNANSWERED:
            self._motion()
            return
        state = self._session.state
        hole, motion, job = state.hole, shown(state), state.job
        data: dict[str, Any] = {"hole": state.selected, "planned": None, "held": None}
        if hole is not None and motion is not None and job is not None:
            profile, branch, drilling = motion.profile, motion.branch, Drilling.of(job, hole)
            near = self._around is job.robot
            data["planned"] = track_data(drilling, profile, branch, job.settings, near=near)
            still = held(profile)
            made_of = (id(hole), id(job.settings), branch, still.standoff.tobytes(), float(still.psi[0]))
            if made_of == self._held:
                del data["held"]  # the baseline is as it was
            else:
                data["held"] = track_data(drilling, still, branch, job.settings)
            self._held = made_of
        else:
            self._held = None
        self._waits_since = monotonic()
        self._view.run_method("show_motion", data)


def _solids(job: Job) -> dict[str, Any] | None:
    """Bodies and surroundings as they are sent; the distances between them are made ready, too."""
    data = solids_data(job.robot, job.tool, job.settings)
    if data is not None:
        zero = np.zeros(1)
        nearest_data(Drilling.of(job, job.holes[0]), job.settings, 0, zero, zero)
    return data
