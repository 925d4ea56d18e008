"""The table of the holes: sorted, filtered, and the way to every one of them; below it what was found of the one."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping, Sequence
from html import escape
from typing import Any

import numpy as np
from nicegui import events, ui

from zerorev.errors import InputError
from zerorev.model.hole import Hole
from zerorev.model.plan import HolePlan, Transition
from zerorev.report.words.hole_rows import QUICK, HoleRow, hole_row, matching
from zerorev.report.words.lost_motion import GUESSED, WHERE_IT_HOLDS, lost_motion_words
from zerorev.report.words.tables import hole_findings
from zerorev.web.job_edits import without_hole
from zerorev.web.of_tools import check_own_holes
from zerorev.web.session import Session
from zerorev.web.state import State, selected
from zerorev.web.throttle import throttled
from zerorev.web.views.fields import built_when_opened
from zerorev.web.views.hole_columns import options, widths
from zerorev.web.views.hole_form import hole_dialog
from zerorev.web.views.notices import failed, note
from zerorev.web.views.paste_form import paste_dialog

__all__ = ["holes"]

WORDS = {"infeasible": "no motion", "unplanned": "–"}
MARKS = {"error": "✕", "warning": "!", "info": "i"}

PICKED = """e => {
    const row = e.api.getSelectedRows()[0];
    if (row && e.source !== 'api') getElement(%d).$emit('picked', row.id);
}"""
SHOW = """(api => {
    const node = api?.getRowNode(%s);
    if (!node) return;
    if (!node.isSelected()) node.setSelected(true, true, 'api');
    api.ensureNodeVisible(node);
})(getElement(%d)?.api)"""


def holes(session: Session) -> None:
    """Draw the table with what can be done to the holes.

    Args:
        session: whose job's holes are shown.
    """
    table = _Table(session)
    _tools(session, table)
    table.draw()
    _findings(session, table)


class _Grid(ui.aggrid):
    """A grid whose options stay as they are; its rows come by `run_grid_method`, as Vue would watch each of them."""

    def __init__(self, *arguments: Any, **options: Any) -> None:
        super().__init__(*arguments, **options)
        self._update_method = None  # it would be called as soon as the grid is there, and build it once more


class _Table:
    """The grid; of a change it is sent the rows that are others than before, and no more."""

    def __init__(self, session: Session) -> None:
        self._session = session
        self.rows: dict[str, HoleRow] = _rows(session.state, {}, None)
        self._wanted: Callable[[HoleRow], bool] | None = None
        self._ids: list[str] | None = None
        self.show_count: Callable[[str], object] = lambda text: None

    def draw(self) -> None:
        self._widths = widths(self.rows)
        self._grid = _Grid(options(self._widths), auto_size_columns=False)
        self._grid.classes("zr-grid").props('data-testid="holes"')
        self._grid.options[":onSelectionChanged"] = PICKED % self._grid.id
        self._grid.on("picked", self._picked)
        self._grid.on("firstDataRendered", self._show_selected, [])
        self._refilter = throttled(self._filter, 0.3)
        self._send_rows()
        self._tell()
        self._session.watch(self._changed)

    def filter(self, wanted: Callable[[HoleRow], bool] | None) -> None:
        self._wanted = wanted
        self._filter()

    def _filter(self) -> None:
        wanted = self._wanted
        ids = None if wanted is None else [row.id for row in self.rows.values() if wanted(row)]
        self._tell(ids)
        if ids == self._ids:
            return
        self._ids = ids
        passes = "() => true" if ids is None else f"(ids => node => ids.has(node.data.id))(new Set({json.dumps(ids)}))"
        self._grid.run_grid_method("updateGridOptions", {":doesExternalFilterPass": passes})
        self._grid.run_grid_method("onFilterChanged")

    def _tell(self, ids: list[str] | None = None) -> None:
        count = len(self.rows)
        self.show_count(f"{count} hole{'s' if count > 1 else ''}" if ids is None else f"{len(ids)} of {count}")

    def _picked(self, event: events.GenericEventArguments) -> None:
        if event.args in self.rows:
            self._session.change(selected(self._session.state, event.args))

    def _show_selected(self) -> None:
        chosen = self._session.state.selected
        if chosen in self.rows:
            self._grid.client.run_javascript(SHOW % (json.dumps(chosen), self._grid.id))

    def _changed(self, before: State, after: State) -> None:
        if before.job is not after.job or before.answers is not after.answers:
            self._update(_rows(after, self.rows, before))
        if before.selected != after.selected:
            self._show_selected()

    def _send_rows(self) -> None:
        self._grid.run_grid_method("setGridOption", "rowData", [row._asdict() for row in self.rows.values()])

    def _widen(self, changed: Mapping[str, HoleRow]) -> None:
        """Make columns wider for rows whose texts are longer than any before."""
        wider = {name: width for name, width in widths(changed).items() if width > self._widths[name]}
        if wider:
            self._widths |= wider
            change = [{"key": name, "newWidth": width} for name, width in wider.items()]
            self._grid.run_grid_method("setColumnWidths", change)

    def _update(self, rows: dict[str, HoleRow]) -> None:
        old, self.rows = self.rows, rows
        self._widen({key: row for key, row in rows.items() if old.get(key) is not row})
        added = [key for key in rows if key not in old]
        if [*(key for key in old if key in rows), *added] != list(rows):  # in another order, as after an undo
            self._send_rows()
            self._refilter()
            return
        change: dict[str, Any] = {
            "add": [rows[key]._asdict() for key in added],
            "update": [row._asdict() for key, row in rows.items() if key in old and old[key] is not row],
            "remove": [{"id": key} for key in old if key not in rows],
        }
        if any(change.values()):
            self._grid.run_grid_method("applyTransaction", change)
            self._refilter()


def _rows(state: State, old: Mapping[str, HoleRow], before: State | None) -> dict[str, HoleRow]:
    """The rows by their ids; those of holes that are as they were are the same objects."""
    if state.job is None:
        return {}
    T = state.job.T_base_part
    was: Mapping[str, Hole] = {}
    if before is not None and before.job is not None and np.array_equal(before.job.T_base_part, T):
        was = {hole.id: hole for hole in before.job.holes}
    answers, known = state.answers, {} if before is None else before.answers
    rows = {}
    for hole in state.job.holes:
        key = hole.id
        answer = answers.get(key)
        same = was.get(key) is hole and known.get(key) is answer and key in old
        rows[key] = old[key] if same else hole_row(hole, answer, T)
    return rows


def _tools(session: Session, table: _Table) -> None:
    """Filter, and what can be done to the holes."""
    edit, paste = (built_when_opened(dialog, session) for dialog in (hole_dialog, paste_dialog))

    def own(change: Callable[[], object]) -> Callable[[], None]:
        """Where the holes are those of this tool alone."""

        def checked() -> None:
            try:
                check_own_holes(session.state)
            except InputError as error:
                failed(f"{error.what} (accepted: {error.accepted})")
            else:
                change()

        return checked

    with ui.element("div").classes("zr-tools"):
        find = ui.input(placeholder="filter: id, or reversals>0").without_auto_validation()
        find.props('dense outlined clearable debounce=200 aria-label="filter the holes" data-testid="filter"')
        quick = ui.select(list(QUICK), value="all").props(
            'dense outlined options-dense aria-label="which holes" data-testid="quick-filter"'
        )
        shown = ui.label().classes("zr-muted").props('role="status" data-testid="holes-shown"')
        ui.element("span").classes("zr-spring")
        for icon, words, name, do in (
            ("add", "add a hole", "add-hole", own(lambda: edit(None))),
            ("edit", "edit this hole", "edit-hole", own(lambda: edit(session.state.hole))),
            ("content_paste", "paste from a spreadsheet, or open a CSV file", "paste", own(paste)),
            ("delete_outline", "take this hole out", "take-out", lambda: _take_out(session)),
        ):
            button = ui.button(icon=icon, on_click=do, color=None).classes("zr-quiet").props("flat round dense")
            button.props(f'aria-label="{words}" data-testid="{name}"').tooltip(words)
    table.show_count = shown.set_text

    def filter_again() -> None:
        wanted, of = find.value or "", quick.value or "all"
        try:
            table.filter(matching(wanted, of) if wanted.strip() or of != "all" else None)
        except InputError as error:
            find.error = f"{error.what}; {error.accepted}"
        else:
            find.error = None

    find.on_value_change(filter_again)
    quick.on_value_change(filter_again)


def _take_out(session: Session) -> None:
    hole = session.state.selected
    if hole is None:
        return
    try:
        session.change(without_hole(session.state, hole))
    except InputError as error:
        failed(f"{error.what} (accepted: {error.accepted})")
    else:
        note(f"{hole} is taken out; Ctrl-Z brings it back")


def _findings(session: Session, table: _Table) -> None:
    """What was found of the selected hole, in words, and on how many others there is something, too."""
    listed = (
        ui.html(sanitize=False)
        .classes("zr-findings")
        .props('role="status" aria-label="findings of the selected hole" data-testid="findings" tabindex="0"')
    )

    def draw() -> None:
        state = session.state
        listed.set_content(_words(state.hole, state.answer, state.transitions) + _others(table.rows, state.selected))

    soon = throttled(draw, 0.3)

    def changed(before: State, after: State) -> None:
        if before.answer is not after.answer or before.selected != after.selected or before.moves is not after.moves:
            draw()
        elif before.answers is not after.answers or before.job is not after.job:
            soon()

    draw()
    session.watch(changed)


def _words(hole: Hole | None, answer: HolePlan | None, moves: Sequence[Transition] = ()) -> str:
    if hole is None or answer is None:
        return '<p class="zr-muted">not planned yet</p>'
    between = (finding for move in moves for finding in move.findings if finding.hole == hole.id)
    found = sorted((*hole_findings(answer), *between), key=lambda finding: list(MARKS).index(finding.level))
    if not found:
        return f'<p class="zr-muted">no findings for this hole</p>{_lost_motion(answer)}'
    lines = "".join(
        f'<p><span class="zr-level zr-{finding.level}" title="{finding.level}">{MARKS[finding.level]}</span>'
        f"{escape(finding.message)}</p>"
        for finding in found
    )
    return lines + _lost_motion(answer)


def _lost_motion(answer: HolePlan) -> str:
    """What the gears are predicted to do to the tip, and how much that says."""
    if answer.lost_motion is None:
        return ""
    here, swapped = lost_motion_words(answer.lost_motion)
    figures = f"Lost motion at the tip: {here} mm, with the legs swapped {swapped} mm."
    return f'<p class="zr-muted" data-testid="lost-motion">{figures} {GUESSED} {WHERE_IT_HOLDS}</p>'


def _others(rows: Mapping[str, HoleRow], chosen: str | None) -> str:
    """On how many other holes there are warnings or errors; the quick filter shows them."""
    count = sum(row.findings > 0 for row in rows.values()) - (
        chosen is not None and chosen in rows and rows[chosen].findings > 0
    )
    if not count:
        return ""
    have = "other hole has" if count == 1 else "other holes have"
    return f'<p class="zr-others">{count:,} {have} warnings or errors: choose “with findings” above</p>'
