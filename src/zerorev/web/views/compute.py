"""What can be computed of the job, how far it is, and the way to stop it."""

from __future__ import annotations

import asyncio
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

from nicegui import ui

from zerorev.errors import InputError
from zerorev.model.hole import Hole
from zerorev.model.plan import Strokes
from zerorev.report.words.terminal import duration, rate_text
from zerorev.web import computing
from zerorev.web.computing import Work
from zerorev.web.job_edits import with_hole, with_settings
from zerorev.web.session import Session
from zerorev.web.state import Progress, State
from zerorev.web.views.notices import failed, note

__all__ = ["compute"]

ANY = -1  # branch: the search is free to choose
LEGS = {"straight": "straight legs", "free": "free legs"}
BRANCHES = {ANY: "any branch"} | {branch: f"branch {branch}" for branch in range(8)}


def compute(session: Session, work: Work) -> None:
    """Draw the buttons; a selected hole that has no answer is planned by itself.

    Args:
        session: whose job is computed.
        work: of the session.
    """
    with ui.element("div").classes("zr-compute").props('role="group" aria-label="compute"'):
        _wishes(session, work)
        _under_way(session, work)

    def ask() -> None:
        if session.state.hole is not None and session.state.answer is None:
            computing.plan_selected(work)

    def changed(before: State, after: State) -> None:
        if _settings(before) is not _settings(after):
            asyncio.get_running_loop().call_soon(ask)  # once all views have been called

    session.watch(changed)


def _settings(state: State) -> object:
    return state.job and state.job.settings


def _wishes(session: Session, work: Work) -> None:
    """What can be asked for, while nothing is under way."""
    with ui.element("div").classes("zr-row") as row:
        scope = ui.toggle({"one": "This hole", "all": "All holes"}, value="one").classes("zr-scope")
        scope.props('no-caps unelevated dense aria-label="what to compute" data-testid="scope"')

        def holes() -> Sequence[Hole]:
            state = session.state
            if scope.value == "all":
                return () if state.job is None else state.job.holes
            return () if state.hole is None else (state.hole,)

        words = "the fewest reversals, and then what the settings ask for"
        _button("Plan", "route", words, lambda: _plan(work, holes(), "asked"))
        words = "the deepest stroke without a reversal; the hole becomes as deep"
        _button("Deepest", "vertical_align_bottom", words, lambda: _plan(work, holes(), "deepest"))
        words = "prove the motion between the samples, too"
        _button("Certify", "verified", words, lambda: _certify(work, holes()))
        legs = _choice(LEGS, "legs", lambda value: _legs(session, value))
        branch = _choice(BRANCHES, "branch to search", lambda value: _branch(session, value))
        words = "the edited motion becomes the hole's answer, evaluated and checked"
        keep = _button("Keep this motion", "push_pin", words, lambda: computing.keep(work))

    def draw(state: State) -> None:
        row.set_visibility(state.progress is None)
        keep.set_visibility(state.steered is not None and not (state.answer and state.answer.strokes))
        if state.job is not None and state.hole is not None:
            legs.set_value(state.job.settings.legs)
            branch.set_value(ANY if state.hole.branch is None else state.hole.branch)

    draw(session.state)
    session.watch(lambda before, after: draw(after) if _row(before) != _row(after) else None)


def _row(state: State) -> tuple[object, ...]:
    return (
        state.progress is None,
        state.steered is None,
        _settings(state),
        state.hole and (state.hole.id, state.hole.branch),
    )


def _under_way(session: Session, work: Work) -> None:
    """How far the work is."""
    with ui.element("div").classes("zr-row zr-under-way").props('role="status" data-testid="progress"') as row:
        title = ui.label()
        bar = ui.linear_progress(show_value=False).props('rounded size="8px" aria-label="progress"')
        figures = ui.label().classes("zr-muted")
        ui.button("Cancel", icon="close", on_click=work.cancel).props('flat no-caps dense data-testid="cancel"')

    def draw(progress: Progress | None) -> None:
        row.set_visibility(progress is not None)
        if progress is not None:
            title.set_text(progress.title)
            figures.set_text(_figures(progress))
            bar.set_value(progress.done / progress.total)
            bar.props(
                add="indeterminate" if progress.total == 1 else "",
                remove="" if progress.total == 1 else "indeterminate",
            )

    draw(session.state.progress)
    session.watch(lambda before, after: draw(after.progress) if before.progress is not after.progress else None)


def _figures(progress: Progress) -> str:
    """How far, how fast, how long yet."""
    if progress.total == 1:
        return ""
    counted = f"{progress.done:,} of {progress.total:,}"
    if progress.rate is None or progress.seconds_left is None:
        return counted
    return f"{counted} · {rate_text(progress.rate, progress.each)} · {duration(progress.seconds_left)} left"


def _button(text: str, icon: str, words: str, wish: Callable[[], None]) -> ui.button:
    name = text.lower().replace(" ", "-")
    button = ui.button(text, icon=icon, on_click=wish).props(f'outline no-caps dense data-testid="{name}"')
    return button.tooltip(words)


def _choice(options: dict[Any, str], name: str, chosen: Callable[[Any], None]) -> ui.select:
    select = ui.select(options, on_change=lambda event: chosen(event.value)).classes("zr-choice")
    return select.props(f'outlined dense options-dense aria-label="{name}" data-testid="{name}"')


def _plan(work: Work, holes: Sequence[Hole], strokes: Strokes) -> None:
    state = work.session.state
    if not holes:
        return
    if strokes == "deepest" and state.tools:
        failed("the holes are those of several tools: zerorev depth finds how deep they go with each")
        return
    if len(holes) > 1:  # of many, those that have no such answer yet: a job that was stopped is resumed
        holes = [hole for hole in holes if strokes != state.strokes or hole.id not in state.answers]
        if not holes and (state.order or strokes == "deepest"):
            note("Every hole has its answer already.")
            return
    computing.plan(work, holes, strokes)


def _certify(work: Work, holes: Sequence[Hole]) -> None:
    try:
        computing.certify(work, holes)
    except InputError as error:
        failed(str(error))


def _legs(session: Session, legs: Any) -> None:
    state = session.state
    if state.job is not None and legs != state.job.settings.legs:
        session.change(with_settings(state, replace(state.job.settings, legs=legs)))


def _branch(session: Session, value: int) -> None:
    state, branch = session.state, None if value == ANY else value
    if state.hole is not None and branch != state.hole.branch:
        session.change(with_hole(state, replace(state.hole, branch=branch), instead_of=state.hole.id))
