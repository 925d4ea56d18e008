"""What can be taken away: the plan, the program with what its preflight found, figures, the replay, the job."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import partial

from nicegui import ui

from zerorev.errors import ZerorevError
from zerorev.model.plan import Plan
from zerorev.web import files
from zerorev.web.computing import Work
from zerorev.web.of_tools import whole_plan
from zerorev.web.session import Session
from zerorev.web.state import State, plan_of
from zerorev.web.views.fields import form
from zerorev.web.views.handing_out import findings_list, handed_out, make, stem, zipped
from zerorev.web.views.notices import failed
from zerorev.web.views.program_download import of_holes, part_download, program_download, way_out_download
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
        _entry("Plan (JSON)", "download-plan", lambda: _whole(session, "plan", lambda: _plan(session), of=whole_plan))
        _entry("Robot program …", "download-program", lambda: program_download(session, work))
        _entry(
            "Robot program from this hole on …",
            "download-program-from",
            lambda: part_download(session, work, rest=True),
        )
        _entry(
            "Robot program of this hole …", "download-program-only", lambda: part_download(session, work, rest=False)
        )
        _entry("Way out of this hole after a stop …", "download-program-out", lambda: way_out_download(session, work))
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


def _whole(session: Session, what: str, go: Callable[[], None], of: Callable[[State], Plan] = plan_of) -> None:
    """Make something of all holes; where some have no answer, only once the user has been asked and agrees."""
    plan = of(session.state)
    found = (finding for each in plan.of_all_tools for finding in each.findings)
    missing = list(dict.fromkeys(finding for finding in found if finding.kind == "unfinished"))
    if not missing:
        go()
        return

    def agreed() -> None:
        dialog.close()
        try:
            go()
        except ZerorevError as error:
            failed(str(error))

    count, total = len(plan.holes), 0 if session.state.job is None else len(session.state.job.holes)
    dialog, inside, _ = form(f"The {what} will not have all holes", "incomplete")
    with inside:
        findings_list(missing)
        with ui.element("div").classes("zr-ends"):
            ui.button("Close", on_click=dialog.close, color=None).classes("zr-quiet").props("flat no-caps")
            words = f"Download with {of_holes(count, total)}" if count < total else "Download all the same"
            ui.button(words, icon="download", on_click=agreed).props('unelevated no-caps data-testid="save-incomplete"')
    dialog.on("hide", dialog.delete)
    dialog.open()


# --- at once ----------------------------------------------------------------------------------------------------------


def _plan(session: Session) -> None:
    plan = whole_plan(session.state)
    ending = "plan" if plan.strokes == "asked" else "depths"
    name = f"{stem(plan.name)}.{ending}.json"
    save = partial(ui.download.content, filename=name, media_type="application/json")
    do_apart(f"Writing {name} …", files.plan_written, files.pieces(plan), b"".join, save)


def _job(session: Session) -> None:
    job = session.state.job
    if job is None:
        return
    if session.state.tools:
        raise ZerorevError("the page writes jobs of one tool; this one has several, and its holes are as in its file")

    def save(made: dict[str, str]) -> None:
        handed_out(made, "application/yaml", job.name)

    do_apart("Writing the job …", files.job_written, files.pieces(job), dict, save)


# --- in a while -------------------------------------------------------------------------------------------------------


def _figures(session: Session, work: Work, *, one: bool) -> None:
    plan = plan_of(session.state)
    if one:
        plan = _only(plan, session.state)

    from zerorev.report.figures import drawn, picture_count

    def run() -> Iterator[bytes | None]:
        pictures = []
        for picture in drawn(plan):
            pictures.append(picture)
            yield None
        yield zipped(pictures)

    save = partial(ui.download.content, filename=f"{stem(plan.name)}.figures.zip", media_type="application/zip")
    make(session, work, "drawing", picture_count(plan) + 1, run, save, each="figure")


def _replay(session: Session, work: Work) -> None:
    from zerorev.report.scene.replay import replay_page

    plan, meshes = plan_of(session.state), session.state.meshes
    save = partial(ui.download.content, filename=f"{stem(plan.name)}.replay.html", media_type="text/html")
    make(session, work, "making the replay", 1, lambda: iter([replay_page(plan, meshes=meshes)]), save)


def _only(plan: Plan, state: State) -> Plan:
    holes = tuple(hole for hole in plan.holes if hole.hole.id == state.selected)
    if not holes:
        raise ZerorevError("this hole is not planned yet")
    return replace(plan, holes=holes)
