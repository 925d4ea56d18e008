"""The page: which parts it has, how they are framed, and when it is drawn again."""

from __future__ import annotations

import logging
from collections.abc import Callable
from contextlib import suppress
from functools import partial

from nicegui import background_tasks, ui

from zerorev.web.computing import Work, plan_selected
from zerorev.web.session import Session
from zerorev.web.state import State
from zerorev.web.throttle import throttled
from zerorev.web.views.bracket import bracket
from zerorev.web.views.cell import cell
from zerorev.web.views.compute import compute
from zerorev.web.views.curves import curves
from zerorev.web.views.downloads import downloads
from zerorev.web.views.empty import empty
from zerorev.web.views.header import header
from zerorev.web.views.holes import holes
from zerorev.web.views.map_panel import map_panel
from zerorev.web.views.messages import messages
from zerorev.web.views.real_arm import real_arm
from zerorev.web.views.summary import summary
from zerorev.web.views.twist_map import twist_map

__all__ = ["build"]

# what beyond a joint's limit is drawn with
HATCH = """<svg width="0" height="0" style="position:absolute" aria-hidden="true"><defs>
<pattern id="zr-hatch" width="5" height="5" patternUnits="userSpaceOnUse" patternTransform="rotate(45)">
<line x1="0" y1="0" x2="0" y2="5" style="stroke:var(--zr-muted)" stroke-width="1.2"/></pattern></defs></svg>"""

# Ctrl-Z, and Ctrl-Shift-Z or Ctrl-Y, wherever the focus is but in a dialog or a field, which has an undo of its own
KEYS = """document.addEventListener("keydown", event => {
    const key = event.key.toLowerCase();
    if (!(event.ctrlKey || event.metaKey) || event.altKey || (key !== "z" && key !== "y")) return;
    if (event.target.closest?.("input:not([type=range]), textarea") || document.querySelector(".q-dialog")) return;
    event.preventDefault();
    const step = key === "y" || event.shiftKey ? "redo" : "undo";
    document.querySelector(".zr-page")?.dispatchEvent(new Event(step));
})"""

View = Callable[[Session], object]
PICTURES: tuple[tuple[str, str, View], ...] = (
    ("twist-map", "Twist map", twist_map),
    ("cell", "Cell", cell),
    ("bracket", "Bracket", bracket),
    ("curves", "Joint angles along the path", curves),
)

# what was sent so far is drawn; a page that is not shown draws nothing, and is not waited for
ON_SCREEN = "new Promise(done => { requestAnimationFrame(() => setTimeout(done)); setTimeout(done, 300); })"
LONGEST = 5.0  # [s] that a browser is waited for


def build(session: Session, work: Work) -> None:
    """Draw the page of a session in the current slot.

    Args:
        session: what is shown; it may have been shown before, as after a reload.
        work: what its long computations run in.
    """
    ui.html(HATCH, sanitize=False)
    page = ui.element("div").classes("zr-page").props('tabindex="-1" data-testid="page"')
    page.on("undo", session.undo, [])
    page.on("redo", session.redo, [])
    ui.run_javascript(KEYS)

    def draw() -> None:
        session.unwatch()
        session.watch(changed)
        page.clear()
        with page:
            header(session)
            if session.state.job is None:
                empty(session)
            else:
                _workbench(session, work)

    def changed(before: State, after: State) -> None:
        if _machine(before) is not _machine(after):  # another file is opened: no part of the page is as it was
            draw()
        if before.hole is not after.hole:
            soon()

    def plan_the_selected_hole() -> None:
        if session.state.hole is not None and session.state.answer is None:
            plan_selected(work)

    soon = throttled(plan_the_selected_hole, 0.0)  # once all views know the hole
    draw()
    soon()


def _machine(state: State) -> object:
    return state.job and state.job.robot


def _workbench(session: Session, work: Work) -> None:
    with ui.element("div").classes("zr-workbench"):
        with ui.element("section").classes("zr-panel zr-bar").props('aria-label="the selected hole"'):
            summary(session)
            with ui.element("div").classes("zr-doings"):
                compute(session, work)
                downloads(session, work)
            messages(session)
        pictures = [(_panel(name, title), view) for name, title, view in PICTURES]
        with ui.element("section").classes("zr-panel zr-holes").props('aria-label="holes, and a map around them"'):
            _tabs(session, work)
    pictures.append((_panel("arm", "On a real arm"), partial(real_arm, work=work)))
    background_tasks.create(_fill(session, pictures))


async def _fill(session: Session, pictures: list[tuple[ui.element, View]]) -> None:
    """Draw what the browser takes longest over, piece by piece, so that the holes are there and can be used before."""
    for panel, view in pictures:
        with suppress(TimeoutError):
            await panel.client.run_javascript(ON_SCREEN, timeout=LONGEST)
        if panel.is_deleted:  # left, or another file is opened
            return
        with panel:
            try:
                view(session)
            except Exception:
                logging.getLogger("zerorev").exception("a fault in zerorev itself; please report the lines below")
                fault = ui.label("This could not be drawn: a fault in zerorev itself. The terminal says more.")
                fault.classes("zr-none").props('role="alert"')


def _tabs(session: Session, work: Work) -> None:
    """The holes, and behind them the workspace map, from which holes can be taken."""
    with ui.tabs().props("dense no-caps inline-label align=left :breakpoint=0").classes("zr-tabs") as tabs:
        first = ui.tab("holes", "Holes").props('data-testid="tab-holes"')
        second = ui.tab("map", "Workspace map").props('data-testid="tab-map"')
    with ui.tab_panels(tabs, value=first, animated=False, keep_alive=True).classes("zr-tab-panels"):
        with ui.tab_panel(first).classes("zr-tab"):
            holes(session)
        with ui.tab_panel(second).classes("zr-tab zr-scrolls"):
            map_panel(session, work)


def _panel(name: str, title: str) -> ui.element:
    """A framed part of the page, with its name."""
    panel = ui.element("section").classes(f"zr-panel zr-{name}").props(f'aria-labelledby="title-{name}"')
    with panel, ui.element("div").classes("zr-title"):
        ui.html(f'<h2 id="title-{name}">{title}</h2>', sanitize=False)
    return panel
