"""Holes from a table: pasted, out of a CSV or a CAD file, shown row by row, and taken only when the user says so."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from html import escape
from typing import Any

from nicegui import background_tasks, events, ui

from zerorev.errors import InputError
from zerorev.files.cad.as_listed import ENDINGS, robot_in
from zerorev.files.hole_list import MOST_PASTED, HoleList, ListedHole, in_base_frame, read_hole_list, text_of_list
from zerorev.files.hole_meaning import Meaning
from zerorev.files.table_layout import COLUMNS, KNOWN, Given
from zerorev.model.hole import Hole
from zerorev.model.job import Job
from zerorev.web import files
from zerorev.web.aside import aside
from zerorev.web.job_edits import with_holes
from zerorev.web.session import Session
from zerorev.web.throttle import throttled
from zerorev.web.views.fields import Fields, ends, form, number, said
from zerorev.web.views.hole_form import reference_of
from zerorev.web.views.opener import file_picker
from zerorev.web.views.waiting import do_apart

__all__ = ["paste_dialog"]

LARGEST = 4 * 2**20  # [bytes] of a CSV file, which is shown as text: more than its rows may be
MOST_DEPTH = 1e6  # [mm]
SHOWN = 200  # rows of the preview; all are taken
EXAMPLE = "B1\t0\t40\t0\t1\t0\t0\t40"
CHOICES: dict[str, tuple[str, dict[str | None, str]]] = {
    "unit": ("lengths", {None: "mm", "in": "inches", "m": "metres"}),
    "decimal": ("decimal sign", {None: "as found", "point": "point", "comma": "comma"}),
    "normals": ("directions point", {"in": "into the material", "out": "out of the material"}),
    "point": ("points are", {"bottom": "bottoms of the strokes", "entry": "where the drill enters"}),
}


def paste_dialog(session: Session) -> Callable[[], None]:
    """A form for holes out of a table.

    Args:
        session: into whose job they go.
    """
    dialog, card, _ = form("Holes from a table or a model", "paste-form", wide=True)
    good: list[Hole] = []
    newest: object = None  # of what was pasted, that which is being understood
    with card:
        ui.label(
            f"Copy rows there and paste them here, with the cells {', '.join(COLUMNS)}, or with a header that names "
            "them. Tabs, semicolons or commas between cells; decimal point or comma. Below they stand as understood: "
            "bottom of the stroke [mm], direction into the material, stroke [mm]. The holes of a STEP or DXF file "
            "become such rows, to be looked through and edited."
        ).classes("zr-muted")
        pasted = (
            ui.textarea(placeholder=EXAMPLE)
            .classes("zr-paste")
            .props('outlined dense rows=6 aria-label="rows of holes" data-testid="paste-text" debounce=200')
        )
        fields = Fields()
        with ui.element("div").classes("zr-group zr-three"):
            for key, (label, options) in CHOICES.items():
                fields.choice((key,), label, f"paste-{key}", options)
            fields.text(("depth_mm",), "depth where none is given [mm]", "paste-depth").props('inputmode="decimal"')
            fields.text(("columns",), "other names of columns", "paste-columns", placeholder="x_mm=LOCX, y_mm=LOCY")
        with ui.element("div").classes("zr-between"):
            csv = ui.button("Open a CSV file …", icon="folder_open").props(
                'flat no-caps dense data-testid="paste-file"'
            )
            model = ui.button("Open a STEP or DXF file …", icon="view_in_ar").props(
                'flat no-caps dense data-testid="paste-cad"'
            )
            verdict = ui.label().props('role="status" data-testid="paste-verdict"')
        assumed = ui.label().classes("zr-muted zr-lines").props('data-testid="paste-assumed"')
        preview = ui.html(sanitize=False).classes("zr-sheet-box").props('tabindex="0" aria-label="rows as understood"')
        preview.props('data-testid="paste-rows"')

    def judge() -> None:
        """Understand the rows in a thread; what was pasted since then is waited for instead."""
        nonlocal newest
        newest = asked = object()
        job, text = session.state.job, str(pasted.value or "")
        good.clear()
        take.set_enabled(False)
        fields.show([])
        if job is None or not text.strip():
            show(HoleList(()))
            return
        try:
            understand = partial(_understood, text, job, *_meant(fields))
        except InputError as error:
            fields.show([((error.where,), error)])
            show(HoleList(()))
            return

        async def understood() -> None:
            listed: HoleList | InputError
            try:
                listed = await aside(understand)
            except InputError as error:
                listed = error
            if newest is asked and not dialog.is_deleted:
                show(listed)

        verdict.set_text("reading …")
        background_tasks.create(understood())

    def show(listed: HoleList | InputError) -> None:
        if isinstance(listed, InputError):
            preview.set_content(f'<p class="zr-problem">{escape(str(listed))}</p>')
            verdict.set_text("nothing can be taken")
        else:
            good.extend(row.hole for row in listed.rows if row.hole is not None)
            preview.set_content(_table(listed.rows))
            verdict.set_text("; ".join([_verdict(listed.rows), *listed.notes]))
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
            pasted.set_value(text_of_list(await event.file.read()))
        except InputError as error:
            verdict.set_text(f"{event.file.name} {said(error)}")

    async def read_model(event: events.UploadEventArguments) -> None:
        job, name, unit = session.state.job, event.file.name, fields["unit",].value
        if job is None:
            return
        robot = robot_in(job.T_base_part, job.robot)

        def listed(found: list[Any]) -> None:
            if not dialog.is_deleted:
                fields["unit",].set_value(None)  # the list is in millimetres
                pasted.set_value(found[0])
                assumed.set_text("\n".join(found[1]))

        given = [name, unit, robot, *files.cut(await event.file.read())]
        do_apart(f"Finding the holes of {name} …", files.read_cad_file, given, list, listed)

    with card:
        take = ends(dialog, "Take", taken)
        file_picker(model, read_model, ",".join(ENDINGS), verdict.set_text)
        file_picker(csv, read, ".csv,.txt,.tsv", verdict.set_text, LARGEST)
    for field in (pasted, *fields.values()):
        field.on_value_change(throttled(judge))

    def opened() -> None:
        pasted.set_value("")
        assumed.set_text("")
        judge()
        dialog.open()

    return opened


def _meant(fields: Fields) -> tuple[Given, Meaning]:
    """What the user says of the rows.

    Raises:
        InputError: what stands in a field of text is not what belongs there; `where` is the field.
    """
    columns: dict[str, str] = {}
    for each in str(fields["columns",].value or "").split(","):
        known, equals, name = (part.strip() for part in each.partition("="))
        if each.strip() and (known not in KNOWN or not equals or not name):
            accepted = f"NAME=COLUMN with commas between them; names: {', '.join(KNOWN)}"
            raise InputError(f"{each.strip()!r} names no column", where="columns", accepted=accepted)
        if each.strip():
            columns[known] = name
    depth = number(fields["depth_mm",].value)
    if depth != "" and (not isinstance(depth, float) or not 0 < depth <= MOST_DEPTH):
        raise InputError(f"{depth!r} is not a depth", where="depth_mm", accepted="a number above 0 [mm], or nothing")
    given = Given(columns, fields["unit",].value, fields["decimal",].value, header=False)
    return given, Meaning(fields["normals",].value, fields["point",].value, depth or None)


def _understood(text: str, job: Job, given: Given, meaning: Meaning) -> HoleList:
    """The rows as holes of the job."""
    taken = {hole.id for hole in job.holes}
    listed = read_hole_list(text, given, meaning, most=MOST_PASTED, taken=taken)
    return in_base_frame(listed, reference_of(job), job.tool, job.T_base_part)


def _verdict(rows: Sequence[ListedHole]) -> str:
    bad = sum(row.problem is not None for row in rows)
    if not rows:
        return ""
    if not bad:
        return f"{len(rows)} row{'s' if len(rows) > 1 else ''}, all good"
    return f"{len(rows) - bad} good, {bad} not; only the good ones are taken"


def _table(rows: Sequence[ListedHole]) -> str:
    """The rows as they were understood; those that are not good come first."""
    if not rows:
        return ""
    head = "".join(f"<th scope=col>{name}</th>" for name in ("line", *COLUMNS))
    order = sorted(rows, key=lambda row: row.problem is None)
    body = "".join(_row(row) for row in order[:SHOWN])
    more = f'<p class="zr-muted">… and {len(rows) - SHOWN} rows more</p>' if len(rows) > SHOWN else ""
    return f'<table class="zr-sheet"><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>{more}'


def _row(row: ListedHole) -> str:
    if row.form is not None:
        numbers = (*row.form.target_mm, *row.form.direction, row.form.depth_mm or 0.0)
        cells = "".join(f"<td>{escape(each)}</td>" for each in (row.form.id, *(f"{value:.10g}" for value in numbers)))
        return f'<tr><td>{row.line} <b class="zr-good" title="good">✓</b></td>{cells}</tr>'
    assert row.problem is not None
    cells = f'<td colspan="{len(COLUMNS)}">{escape(" · ".join(row.cells))}</td>'
    where = row.problem.where.removeprefix(f"line {row.line}").lstrip(", ")
    words = escape(f"{where}: {said(row.problem)}" if where else said(row.problem))
    return (
        f'<tr><td>{row.line} <b class="zr-bad" title="not good">✕</b></td>{cells}</tr>'
        f'<tr class="zr-row-problem"><td></td><td colspan="{len(COLUMNS)}" class="zr-problem">{words}</td></tr>'
    )
