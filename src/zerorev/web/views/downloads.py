"""What can be taken away: the plan, the program with what its preflight found, figures, the replay, the job."""

from __future__ import annotations

import io
import re
import zipfile
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import nullcontext
from dataclasses import replace
from functools import partial
from typing import Any

from nicegui import ui

from zerorev.errors import NotExportableError, ZerorevError
from zerorev.model.finding import Finding
from zerorev.model.plan import Plan
from zerorev.program.export import Exported, exporting, retract_program
from zerorev.program.selection import number_of, selection
from zerorev.web import files
from zerorev.web.computing import Work
from zerorev.web.session import Session
from zerorev.web.state import State, plan_of
from zerorev.web.views.fields import form
from zerorev.web.views.notices import failed, note
from zerorev.web.views.waiting import do_apart

__all__ = ["downloads"]


def downloads(session: Session, work: Work) -> None:
    """Draw the menu.

    Args:
        session: whose plan is taken away.
        work: of the session, for what takes long to make.
    """
    with (
        ui.button("Download", icon="download").classes("zr-take").props('outline no-caps dense data-testid="download"'),
        ui.menu().props('aria-label="download"'),
    ):
        _entry("Plan (JSON)", "download-plan", lambda: _whole(session, "plan", lambda: _plan(session)))
        _entry("Robot program (KRL) …", "download-krl", lambda: _program(session, work))
        _entry("Robot program from this hole on (KRL) …", "download-krl-from", lambda: _part(session, work, rest=True))
        _entry("Robot program of this hole (KRL) …", "download-krl-only", lambda: _part(session, work, rest=False))
        _entry("Way out of this hole after a stop (KRL) …", "download-krl-out", lambda: _way_out(session, work))
        _entry("Figures of this hole (zip)", "download-figures", lambda: _figures(session, work, one=True))
        _entry(
            "Figures of all holes (zip)",
            "download-all-figures",
            lambda: _whole(session, "figures", lambda: _figures(session, work, one=False)),
        )
        _entry(
            "Replay (HTML, opens anywhere)",
            "download-replay",
            lambda: _whole(session, "replay", lambda: _replay(session, work)),
        )
        ui.separator()
        _entry("Job (YAML)", "download-job", lambda: _job(session))


def _entry(text: str, name: str, wish: Callable[[], None]) -> None:
    def asked() -> None:
        try:
            wish()
        except ZerorevError as error:
            failed(str(error))

    ui.menu_item(text, on_click=asked).props(f'data-testid="{name}"')


def _whole(session: Session, what: str, go: Callable[[], None]) -> None:
    """Make something of all holes; where some have no answer, only once the user has been asked and agrees."""
    plan = plan_of(session.state)
    missing = [finding for finding in plan.findings if finding.kind == "unfinished"]
    if not missing:
        go()
        return

    def agreed() -> None:
        dialog.close()
        try:
            go()
        except ZerorevError as error:
            failed(str(error))

    count, of = len(plan.holes), len(plan.holes) + len(session.state.unplanned)
    dialog, inside, _ = form(f"The {what} will not have all holes", "incomplete")
    with inside:
        _list(missing)
        with ui.element("div").classes("zr-ends"):
            ui.button("Close", on_click=dialog.close, color=None).classes("zr-quiet").props("flat no-caps")
            words = f"Download with {_of(count, of)}" if count < of else "Download all the same"
            ui.button(words, icon="download", on_click=agreed).props('unelevated no-caps data-testid="save-incomplete"')
    dialog.on("hide", dialog.delete)
    dialog.open()


# --- at once ----------------------------------------------------------------------------------------------------------


def _plan(session: Session) -> None:
    plan = plan_of(session.state)
    ending = "plan" if plan.strokes == "asked" else "depths"
    name = f"{_stem(plan.name)}.{ending}.json"
    save = partial(ui.download.content, filename=name, media_type="application/json")
    do_apart(f"Writing {name} …", files.plan_written, files.pieces(plan), b"".join, save)


def _job(session: Session) -> None:
    job = session.state.job
    if job is None:
        return

    def save(made: dict[str, str]) -> None:
        _handed_out(made, "application/yaml", job.name)

    do_apart("Writing the job …", files.job_written, files.pieces(job), dict, save)


# --- in a while -------------------------------------------------------------------------------------------------------


def _program(
    session: Session,
    work: Work,
    *,
    skip_failed: bool = False,
    start: str | None = None,
    only: Sequence[str] | None = None,
) -> None:
    """Make the program of all holes, or of a part, then show what its preflight found, or why there is none."""
    plan, unplanned = plan_of(session.state), session.state.unplanned
    selection(plan, start, only)  # says what is wrong with it before anything is made

    def run() -> Iterator[Exported | NotExportableError | None]:
        try:
            yield (yield from exporting(plan, skip_failed=skip_failed, start=start, only=only, workers=None))
        except NotExportableError as error:
            yield error

    def ready(made: Exported | NotExportableError) -> None:
        if isinstance(made, Exported):
            _offer(made, len(plan.holes) + len(unplanned))
        else:
            again = partial(_program, session, work, skip_failed=True, start=start, only=only)
            _refused(made, again, can_skip=not skip_failed)

    _make(session, work, "checking for the program", len(plan.holes) + 1, run, ready, each="hole")


def _part(session: Session, work: Work, *, rest: bool) -> None:
    """The program of the selected hole, or of it and those that are drilled after it."""
    hole = _selected(session)
    _program(session, work, **({"start": hole} if rest else {"only": [hole]}))


def _way_out(session: Session, work: Work) -> None:
    """The program that pulls the drill out of the selected hole."""
    plan, hole = plan_of(session.state), _selected(session)
    number_of(plan, hole, "retract")  # says where there is none

    def run() -> Iterator[Exported | NotExportableError]:
        try:
            yield retract_program(plan, hole)
        except NotExportableError as error:
            yield error

    def ready(made: Exported | NotExportableError) -> None:
        if isinstance(made, Exported):
            _offer(made, 1)
        else:
            _refused(made, lambda: None, can_skip=False)

    _make(session, work, "checking for the program", 1, run, ready, each="hole")


def _selected(session: Session) -> str:
    if session.state.selected is None:
        raise ZerorevError("no hole is selected")
    return session.state.selected


def _figures(session: Session, work: Work, *, one: bool) -> None:
    plan = plan_of(session.state)
    if one:
        plan = _only(plan, session.state)

    from zerorev.report.figures import FIGURES, drawn

    def run() -> Iterator[bytes | None]:
        pictures = []
        for picture in drawn(plan):
            pictures.append(picture)
            yield None
        yield _zipped(pictures)

    count = len(FIGURES) * sum(hole.motion is not None for hole in plan.holes)
    save = partial(ui.download.content, filename=f"{_stem(plan.name)}.figures.zip", media_type="application/zip")
    _make(session, work, "drawing", count + 1, run, save, each="figure")


def _replay(session: Session, work: Work) -> None:
    from zerorev.report.scene.replay import replay_page

    plan, meshes = plan_of(session.state), session.state.meshes
    save = partial(ui.download.content, filename=f"{_stem(plan.name)}.replay.html", media_type="text/html")
    _make(session, work, "making the replay", 1, lambda: iter([replay_page(plan, meshes=meshes)]), save)


def _make(
    session: Session,
    work: Work,
    title: str,
    total: int,
    run: Callable[[], Iterator[Any]],
    ready: Callable[[Any], None],
    each: str = "file",
) -> None:
    """Make something in a thread; its last result is handed to the page."""

    def take(state: State, found: Sequence[Any]) -> State:
        if found[-1] is not None:
            if session.page is nullcontext:
                raise ZerorevError(f"{title}: ready while the page was away; ask for it again")
            with session.page():
                ready(found[-1])
        return state

    if not work.start(title, total, run, take, each=each):
        note("Something else is under way; wait for it, or cancel it.")


# --- the program's dialog ---------------------------------------------------------------------------------------------


def _offer(program: Exported, of: int) -> None:
    """Show what the preflight found, and which of so many holes are missing, then hand the program out."""
    name = program.files[0].name
    lacking = ""
    if program.holes < of:
        lacking = f"The program drills {_of(program.holes, of)}."
    elif any(finding.kind == "unfinished" for finding in program.findings):
        lacking = "The program does not have all holes of the job."

    def save() -> None:
        _handed_out({file.name: file.text for file in program.files}, "text/plain", program.name)
        dialog.close()

    dialog, inside, _ = form(f"Before {name} runs", "preflight", wide=True)
    with inside:
        if lacking:
            ui.label(lacking).classes("zr-lacking").props('role="alert"')
        if program.findings:
            ui.label("The preflight found:")
            _list(program.findings)
        else:
            ui.label("The preflight found nothing to say.")
        ui.label("The program has not run on a robot yet: try it in T1 first.").classes("zr-muted")
        with ui.element("div").classes("zr-ends"):
            ui.button("Close", on_click=dialog.close, color=None).classes("zr-quiet").props("flat no-caps")
            words = f"Download {name} with {_of(program.holes, of)}" if program.holes < of else f"Download {name}"
            ui.button(words, icon="download", on_click=save).props(
                f'unelevated no-caps {"" if lacking else "autofocus"} data-testid="save-program"'
            )
    dialog.on("hide", dialog.delete)
    dialog.open()


def _refused(error: NotExportableError, leave_out: Callable[[], None], *, can_skip: bool) -> None:
    """Say why there is no program, and offer one without these holes."""

    def without() -> None:
        dialog.close()
        leave_out()

    dialog, inside, _ = form("This plan must not become a program", "refused", wide=True)
    with inside:
        with ui.element("ul").classes("zr-reasons"):
            for reason in error.reasons:
                with ui.element("li"):
                    ui.label(reason)
        with ui.element("div").classes("zr-ends"):
            ui.button("Close", on_click=dialog.close, color=None).classes("zr-quiet").props("flat no-caps")
            if can_skip and not any(reason.startswith("the plan:") for reason in error.reasons):
                ui.button("Leave these out", on_click=without).props('unelevated no-caps data-testid="leave-out"')
    dialog.on("hide", dialog.delete)
    dialog.open()


def _of(count: int, of: int) -> str:
    return f"{count:,} of {of:,} holes"


def _list(findings: Sequence[Finding]) -> None:
    with ui.element("ul").classes("zr-reasons"):
        for finding in findings:
            with ui.element("li").classes(f"zr-{finding.level}"):
                ui.icon(finding.level).props('aria-hidden="true"')
                where = "" if finding.hole is None else f"{finding.hole}: "
                ui.label(f"{finding.level}: {where}{finding.message}")


# --- files ------------------------------------------------------------------------------------------------------------


def _only(plan: Plan, state: State) -> Plan:
    holes = tuple(hole for hole in plan.holes if hole.hole.id == state.selected)
    if not holes:
        raise ZerorevError("this hole is not planned yet")
    return replace(plan, holes=holes)


def _handed_out(made: Mapping[str, str], media_type: str, name: str) -> None:
    """One text as it is, several in an archive."""
    if len(made) == 1:
        ((file, text),) = made.items()
        ui.download.content(text, file, media_type)
    else:
        ui.download.content(_zipped((file, text.encode()) for file, text in made.items()), f"{_stem(name)}.zip")


def _zipped(named: Iterable[tuple[str, bytes]]) -> bytes:
    held = io.BytesIO()
    with zipfile.ZipFile(held, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in named:
            archive.writestr(name, content)
    return held.getvalue()


def _stem(name: str) -> str:
    """A file name's beginning, in letters that every file system takes."""
    return re.sub(r"[^A-Za-z0-9.-]+", "_", name).strip("._") or "zerorev"
