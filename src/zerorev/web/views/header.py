"""The line on top: what is opened, and what can be done with the page as a whole."""

from __future__ import annotations

import json
from collections.abc import Callable

from nicegui import ui

from zerorev.model.job import Job
from zerorev.motion.kinematics import wrist_offset
from zerorev.web.of_tools import tool_names, with_tool
from zerorev.web.session import Session
from zerorev.web.state import State
from zerorev.web.views.fields import built_when_opened
from zerorev.web.views.opener import open_button
from zerorev.web.views.settings_form import settings_dialog

__all__ = ["header"]

THEMES = ((None, "brightness_auto", "as the system"), (False, "light_mode", "light"), (True, "dark_mode", "dark"))


def header(session: Session) -> None:
    """Draw the header.

    Args:
        session: whose job is named.
    """
    with ui.element("header").classes("zr-header"):
        ui.html('<span class="zr-mark" aria-hidden="true"></span><span class="zr-word">zerorev</span>', sanitize=False)
        if session.state.job is None:
            ui.element("span").classes("zr-spring")
        else:
            _of_a_job(session)
            open_button(session, "open", "zr-quiet")
        _theme_button(session)


def _of_a_job(session: Session) -> None:
    with ui.element("div").classes("zr-job"):
        name, machine = ui.label().classes("zr-job-name"), ui.label().classes("zr-job-machine")
    _tools(session)
    ui.element("span").classes("zr-spring")
    settings = built_when_opened(settings_dialog, session)
    back = _step("undo", "Undo the last edit or drag (Ctrl-Z)", session.undo)
    forth = _step("redo", "Redo (Ctrl-Shift-Z or Ctrl-Y)", session.redo)
    change = ui.button("Settings", icon="tune", on_click=settings, color=None).classes("zr-quiet").props("flat no-caps")
    change.props('data-testid="settings"')

    def draw(job: Job) -> None:
        name.set_text(job.name)
        robot = f"{job.robot.manufacturer} {job.robot.model}".strip() or job.robot.name
        offset = wrist_offset(job.robot, job.tool) * 1e3
        machine.set_text(f"{robot}  ·  {job.tool.name}, {offset:.4g} mm off the wrist  ·  {job.settings.legs} legs")

    def enable() -> None:
        back.set_enabled(session.can_undo)
        forth.set_enabled(session.can_redo)

    def changed(before: State, after: State) -> None:
        if after.job is not None and before.job is not after.job:
            draw(after.job)
        enable()

    if session.state.job is not None:
        draw(session.state.job)
    enable()
    session.watch(changed)


def _tools(session: Session) -> None:
    """Which tool is shown, where the job has several."""

    def chosen(number: int | None) -> None:
        if number is not None and number != session.state.tool:
            session.start_over(with_tool(session.state, number))

    choice = ui.select({0: ""}, on_change=lambda event: chosen(event.value)).classes("zr-choice")
    choice.props('outlined dense options-dense aria-label="tool that is shown" data-testid="tool"')

    def draw(state: State) -> None:
        names = tool_names(state)
        choice.set_visibility(bool(names))
        if names:
            choice.set_options(dict(enumerate(names)), value=state.tool)

    draw(session.state)
    session.watch(lambda before, after: draw(after) if before.tools is not after.tools else None)


def _step(name: str, words: str, do: Callable[[], None]) -> ui.button:
    button = ui.button(icon=name, on_click=do, color=None).classes("zr-quiet").props("flat round dense")
    return button.props(f'aria-label="{words}" data-testid="{name}"').tooltip(words)


def _theme_button(session: Session) -> None:
    """Goes round: as the system, light, dark."""
    page = ui.context.client
    button = ui.button(color=None).classes("zr-quiet").props('flat round dense data-testid="theme"')

    def draw() -> None:
        _, icon, words = next(theme for theme in THEMES if theme[0] is session.theme)
        # `ui.dark_mode` would say so again, and have the whole page styled again, whenever any part of it changes
        page.run_javascript(f"setDark({json.dumps(session.theme)})")
        button.props(f'icon={icon} aria-label="theme: {words}; press for another" title="theme: {words}"')

    def turn() -> None:
        at = [theme[0] for theme in THEMES].index(session.theme)
        session.theme = THEMES[(at + 1) % len(THEMES)][0]
        draw()

    button.on_click(turn)
    draw()
