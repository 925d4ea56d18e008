"""Holes from a spreadsheet: pasted or out of a CSV file, shown row by row, and taken only when the user says so."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from html import escape

from nicegui import background_tasks, events, ui

from zerorev.errors import InputError
from zerorev.files.sheet import COLUMNS, SheetRow, sheet_rows
from zerorev.model.hole import Hole
from zerorev.web.aside import aside
from zerorev.web.session import Session
from zerorev.web.state import with_holes
from zerorev.web.throttle import throttled
from zerorev.web.views.fields import ends, form, said
from zerorev.web.views.hole_form import reference_of
from zerorev.web.views.opener import file_picker

__all__ = ["paste_dialog"]

LARGEST = 4 * 2**20  # [bytes] of a CSV file, which is shown as text: more than its rows may be
SHOWN = 200  # rows of the preview; all are taken
EXAMPLE = "B1\t0\t40\t0\t1\t0\t0\t40"


def paste_dialog(session: Session) -> Callable[[], None]:
    """A form for holes out of a table.

    Args:
        session: into whose job they go.
    """
    dialog, card, _ = form("Holes from a spreadsheet", "paste-form", wide=True)
    good: list[Hole] = []
    newest: object = None  # of what was pasted, that which is being understood
    with card:
        ui.label(
            f"Copy rows there and paste them here, with the cells {', '.join(COLUMNS)}, or with a header that names "
            "them. Tabs, semicolons or commas between cells; decimal point or comma."
        ).classes("zr-muted")
        pasted = (
            ui.textarea(placeholder=EXAMPLE)
            .classes("zr-paste")
            .props('outlined dense rows=6 aria-label="rows of holes" data-testid="paste-text" debounce=200')
        )
        with ui.element("div").classes("zr-between"):
            csv = ui.button("Open a CSV file …", icon="folder_open").props(
                'flat no-caps dense data-testid="paste-file"'
            )
            verdict = ui.label().props('role="status" data-testid="paste-verdict"')
        preview = ui.html(sanitize=False).classes("zr-sheet-box").props('tabindex="0" aria-label="rows as understood"')
        preview.props('data-testid="paste-rows"')

    def judge() -> None:
        """Understand the rows in a thread; what was pasted since then is waited for instead."""
        nonlocal newest
        newest = asked = object()
        job, text = session.state.job, str(pasted.value or "")
        good.clear()
        take.set_enabled(False)
        if job is None or not text.strip():
            show([])
            return
        taken = {hole.id for hole in job.holes}
        understand = partial(sheet_rows, text, reference_of(job), job.tool, job.T_base_part, taken)

        async def understood() -> None:
            rows: Sequence[SheetRow] | InputError
            try:
                rows = await aside(understand)
            except InputError as error:
                rows = error
            if newest is asked and not dialog.is_deleted:
                show(rows)

        verdict.set_text("reading …")
        background_tasks.create(understood())

    def show(rows: Sequence[SheetRow] | InputError) -> None:
        if isinstance(rows, InputError):
            preview.set_content(f'<p class="zr-problem">{escape(str(rows))}</p>')
            verdict.set_text("nothing can be taken")
        else:
            good.extend(row.hole for row in rows if row.hole is not None)
            preview.set_content(_table(rows))
            verdict.set_text(_verdict(rows))
        take.set_enabled(bool(good))
        take.set_text(f"Take {len(good)} hole{'s' if len(good) > 1 else ''}" if good else "Take")

    def taken() -> None:
        try:
            session.change(with_holes(session.state, good))
        except InputError as error:
            verdict.set_text(said(error))
        else:
            dialog.close()

    async def read(event: events.UploadEventArguments) -> None:
        try:
            pasted.set_value((await event.file.read()).decode("utf-8-sig"))
        except UnicodeDecodeError:
            verdict.set_text(f"{event.file.name} is not text; accepted: CSV in UTF-8")

    with card:
        take = ends(dialog, "Take", taken)
        file_picker(csv, read, ".csv,.txt,.tsv", verdict.set_text, LARGEST)
    pasted.on_value_change(throttled(judge))

    def opened() -> None:
        pasted.set_value("")
        judge()
        dialog.open()

    return opened


def _verdict(rows: Sequence[SheetRow]) -> str:
    bad = sum(row.problem is not None for row in rows)
    if not rows:
        return ""
    if not bad:
        return f"{len(rows)} row{'s' if len(rows) > 1 else ''}, all good"
    return f"{len(rows) - bad} good, {bad} not; only the good ones are taken"


def _table(rows: Sequence[SheetRow]) -> str:
    """The rows as they were understood; those that are not good come first."""
    if not rows:
        return ""
    head = "".join(f"<th scope=col>{name}</th>" for name in ("line", *COLUMNS))
    order = sorted(rows, key=lambda row: row.problem is None)
    body = "".join(_row(row) for row in order[:SHOWN])
    more = f'<p class="zr-muted">… and {len(rows) - SHOWN} rows more</p>' if len(rows) > SHOWN else ""
    return f'<table class="zr-sheet"><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>{more}'


def _row(row: SheetRow) -> str:
    cells = "".join(f"<td>{escape(cell)}</td>" for cell in row.cells)
    if row.problem is None:
        return f'<tr><td>{row.line} <b class="zr-good" title="good">✓</b></td>{cells}</tr>'
    where = f"{row.problem.where.lstrip(', ')}: " if row.problem.where else ""
    words = escape(f"{where}{said(row.problem)}")
    return (
        f'<tr><td>{row.line} <b class="zr-bad" title="not good">✕</b></td>{cells}</tr>'
        f'<tr class="zr-row-problem"><td></td><td colspan="{len(COLUMNS)}" class="zr-problem">{words}</td></tr>'
    )
