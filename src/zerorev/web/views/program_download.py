"""The robot program that is taken away, with what its preflight found, or why there is none."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from functools import partial

from nicegui import ui

from zerorev.errors import NotExportableError, ZerorevError
from zerorev.program.export import Exported, exporting, retract_program
from zerorev.program.selection import number_of, selection
from zerorev.web.computing import Work
from zerorev.web.session import Session
from zerorev.web.state import plan_of
from zerorev.web.views.fields import form
from zerorev.web.views.handing_out import findings_list, handed_out, make

__all__ = ["of_holes", "part_download", "program_download", "way_out_download"]


def program_download(
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
            again = partial(program_download, session, work, skip_failed=True, start=start, only=only)
            _refused(made, again, can_skip=not skip_failed)

    make(session, work, "checking for the program", len(plan.holes) + 1, run, ready, each="hole")


def part_download(session: Session, work: Work, *, rest: bool) -> None:
    """The program of the selected hole, or of it and those that are drilled after it."""
    hole = _selected(session)
    program_download(session, work, **({"start": hole} if rest else {"only": [hole]}))


def way_out_download(session: Session, work: Work) -> None:
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

    make(session, work, "checking for the program", 1, run, ready, each="hole")


def _selected(session: Session) -> str:
    if session.state.selected is None:
        raise ZerorevError("no hole is selected")
    return session.state.selected


def _offer(program: Exported, of: int) -> None:
    """Show what the preflight found, and which of so many holes are missing, then hand the program out."""
    name = program.files[0].name
    lacking = ""
    if program.holes < of:
        lacking = f"The program drills {of_holes(program.holes, of)}."
    elif any(finding.kind == "unfinished" for finding in program.findings):
        lacking = "The program does not have all holes of the job."

    def save() -> None:
        handed_out({file.name: file.text for file in program.files}, "text/plain", program.name)
        dialog.close()

    dialog, inside, _ = form(f"Before {name} runs", "preflight", wide=True)
    with inside:
        if lacking:
            ui.label(lacking).classes("zr-lacking").props('role="alert"')
        if program.findings:
            ui.label("The preflight found:")
            findings_list(program.findings)
        else:
            ui.label("The preflight found nothing to say.")
        ui.label("The program has not run on a robot yet: try it in T1 first.").classes("zr-muted")
        with ui.element("div").classes("zr-ends"):
            ui.button("Close", on_click=dialog.close, color=None).classes("zr-quiet").props("flat no-caps")
            words = f"Download {name} with {of_holes(program.holes, of)}" if program.holes < of else f"Download {name}"
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


def of_holes(count: int, of: int) -> str:
    """So many of so many holes, in words."""
    return f"{count:,} of {of:,} holes"
