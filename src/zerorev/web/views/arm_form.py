"""What a simulation is asked for: how many arms, which seed, feed, thrust, and what is known of the arm."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from nicegui import events, ui

from zerorev.cell.possible import check_robot
from zerorev.errors import InputError
from zerorev.files.units import m, mm
from zerorev.model.job import Settings
from zerorev.model.ranges import Cell
from zerorev.web import files
from zerorev.web.computing import Work
from zerorev.web.real_arm import Asked, RealArm
from zerorev.web.session import Session
from zerorev.web.simulating import simulate
from zerorev.web.state import State, shown
from zerorev.web.views.arm_ranges import ranges_dialog
from zerorev.web.views.fields import built_when_opened, number, said
from zerorev.web.views.notices import failed
from zerorev.web.views.opener import file_picker
from zerorev.web.views.waiting import do_apart

__all__ = ["ask", "asked_of"]

ARMS, MOST_ARMS, MOST_SEED, MOST_THRUST = 40, 1_000, 2**32 - 1, 1e5
FIELDS = {
    "arms": (
        "Possible arms",
        str(ARMS),
        "how many sets of parameters are drawn; more give surer ranges and take longer",
    ),
    "seed": ("Seed", "0", "of the draw: the same seed gives the same arms"),
    "feed": ("Feed [mm/s]", "", "of both legs; empty: as planned"),
    "thrust": ("Thrust [N]", "", "of the drill while it cuts, on a free tip; empty: the job's"),
}
ACCEPTED = {
    "arms": f"a whole number from 1 to {MOST_ARMS:,}",
    "seed": f"a whole number from 0 to {MOST_SEED:,}",
    "feed": "a number above 0 [mm/s], or nothing: as planned",
    "thrust": f"a number from 0 to {MOST_THRUST:,.0f} [N], or nothing: the job's",
}


def ask(session: Session, work: Work) -> Mapping[str, ui.input]:
    """Draw the fields and the button.

    Args:
        session: whose motion is simulated.
        work: what it is simulated in.

    Returns:
        the fields by their names.
    """
    with ui.element("div").classes("zr-arm-ask").props('role="group" aria-label="what is simulated"'):
        form = {name: ui.input(label, value=value).tooltip(words) for name, (label, value, words) in FIELDS.items()}
        for name, field in form.items():
            field.props(f'dense outlined stack-label hide-bottom-space data-testid="arm-{name}"')
        button = ui.button("Simulate", icon="query_stats").props('unelevated no-caps data-testid="simulate"')
        wrong = ui.label().classes("zr-problem").props('role="alert" data-testid="arm-problem"')
        _cell_file(session)

    def start() -> None:
        job = session.state.job
        if job is None:
            return
        asked, problems = asked_of({name: field.value for name, field in form.items()}, job.settings)
        for name, field in form.items():
            field.error = said(problems[name]) if name in problems else None
        begun = asked is None or simulate(work, asked)
        wrong.set_text("" if begun else "something else is under way; wait for it, or cancel it")

    def draw(state: State) -> None:
        button.set_enabled(state.progress is None and shown(state) is not None)
        if state.job is not None:
            settings = state.job.settings
            feeds = dict.fromkeys(f"{mm(feed):g}" for feed in (settings.feed_plunge, settings.feed_retract))
            form["feed"].props(f'placeholder="as planned: {", ".join(feeds)}"')
            form["thrust"].props(f'placeholder="as the job: {settings.thrust:g}"')

    def changed(before: State, after: State) -> None:
        if any(getattr(before, name) is not getattr(after, name) for name in ("progress", "job", "steered", "answer")):
            draw(after)

    button.on_click(start)
    draw(session.state)
    session.watch(changed)
    return form


def asked_of(values: Mapping[str, Any], settings: Settings) -> tuple[Asked | None, dict[str, InputError]]:
    """What the fields ask for, and what is wrong with them, by their names.

    Args:
        values: of the fields, as they are typed.
        settings: of the job, whose thrust is meant where none is given.
    """
    found = {name: number(values[name]) for name in FIELDS}
    given = {name: value for name, value in found.items() if value != "" or name in ("arms", "seed")}
    fits = {
        "arms": lambda value: value.is_integer() and 1 <= value <= MOST_ARMS,
        "seed": lambda value: value.is_integer() and 0 <= value <= MOST_SEED,
        "feed": lambda value: 0 < value < math.inf,
        "thrust": lambda value: 0 <= value <= MOST_THRUST,
    }
    wrong = {
        name: InputError("cannot be used", where=name, accepted=ACCEPTED[name])
        for name, value in given.items()
        if not (isinstance(value, float) and fits[name](value))
    }
    if wrong:
        return None, wrong
    feed = float(m(given["feed"])) if "feed" in given else None
    return Asked(int(given["arms"]), int(given["seed"]), feed, given.get("thrust", settings.thrust)), {}


def _cell_file(session: Session) -> None:
    """What is known of the arm, and the way to open another cell file."""

    def know(cell: Cell, file: str) -> None:
        session.change(replace(session.state, arm=replace(session.state.arm, cell=cell, file=file)))

    async def opened(event: events.UploadEventArguments) -> None:
        file, content = event.file.name, await event.file.read()

        def take(cell: Cell) -> None:
            if session.state.job is not None:
                check_robot(cell, session.state.job.robot.name, file)
                know(cell, file)

        do_apart(f"Reading {file} …", files.read_cell, [file, *files.cut(content)], next, take)

    def draw(arm: RealArm) -> None:
        name.set_text(arm.file or "no cell file: all of it is guessed")
        away.set_visibility(bool(arm.file))

    with ui.element("div").classes("zr-arm-file"):
        opens = ui.button("Cell file", icon="folder_open").props('outline no-caps dense data-testid="arm-open"')
        opens.tooltip("what is known of your arm, as zerorev identify writes it")
        ranges = built_when_opened(ranges_dialog, session)
        button = ui.button("Ranges", on_click=lambda: ranges()).props('flat no-caps dense data-testid="arm-ranges"')
        button.tooltip("what each parameter may be, and what that rests on")
        name = ui.label().props('data-testid="arm-file"')
        away = ui.button(icon="close", on_click=lambda: know(Cell(), ""))
        away.props('flat round dense aria-label="without a cell file" data-testid="arm-away"')
        file_picker(opens, opened, ".yaml,.yml", failed)
    draw(session.state.arm)
    session.watch(lambda before, after: draw(after.arm) if before.arm.cell is not after.arm.cell else None)
