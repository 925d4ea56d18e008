"""The columns of the table of holes: what stands in them, how they sort, how wide they are."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from zerorev.report.words.hole_rows import HoleRow
from zerorev.report.words.tables import NO_BASELINE

__all__ = ["options", "widths"]

WIDEST = 360  # [px] of the column of ids; a longer one takes two lines

# the grid's own language; a row's values are data to all of these
REVERSALS = """p => p.data.after === null ? (p.data.standing === 'unplanned' ? '–' : 'no motion')
    : (p.data.before === null ? '?' : p.data.before) + ' → ' + p.data.after"""
BY_REVERSALS = """(a, b, m, n) => {
    const rank = d => d.standing === 'unplanned' ? 1e3 : d.after === null ? 1e2 : d.after;
    return rank(m.data) - rank(n.data) || (m.data.before ?? 99) - (n.data.before ?? 99);
}"""
DIGITS = "p => p.value === null || p.value === undefined ? '–' : p.value.toFixed({digits}).replace('-', '−')"
COUNT = "p => p.value || ''"
STEP = """p => {
    const to = p.nextCellPosition;
    if (to && to.rowIndex !== p.previousCellPosition.rowIndex && to.rowPinned == null)
        p.api.getDisplayedRowAtIndex(to.rowIndex)?.setSelected(true, true, 'rowClicked');
    return to;
}"""


def widths(rows: Mapping[str, HoleRow]) -> dict[str, int]:
    """How wide the columns of text have to be, so that none of it is cut [px].

    Args:
        rows: of the table, by the ids of their holes.
    """
    return {
        "id": min(max((_pixels(row.id) for row in rows.values()), default=0) + 30, WIDEST),
        "target": max((_pixels(row.target) for row in rows.values()), default=0) + 30,
        "direction": max((_pixels(row.direction) for row in rows.values()), default=0) + 30,
    }


def _pixels(text: str) -> int:
    """About how long a text is in the letters of the table, and not less [px]."""
    wide = sum(letter in "mwMW@%" or ord(letter) > 0x2000 for letter in text)
    return round(7.5 * len(text) + 1.5 * sum(map(str.isupper, text)) + 5 * wide)


def options(wide: Mapping[str, int]) -> dict[str, Any]:
    """The grid's options, its columns among them.

    Args:
        wide: what `widths` says of the rows.
    """
    number = {"type": "rightAligned", "width": 80}
    one = DIGITS.format(digits=1)
    return {
        "columnDefs": [
            {"headerName": "Hole", "field": "id", "width": max(112, wide["id"]), "tooltipField": "id",
             "pinned": "left", "wrapText": wide["id"] == WIDEST, "autoHeight": wide["id"] == WIDEST},
            {"headerName": "Reversals", "field": "after", ":valueFormatter": REVERSALS, ":comparator": BY_REVERSALS,
             "width": 92, "headerTooltip": f"with constant spin → as planned; {NO_BASELINE}",
             "cellClass": "zr-cell-count",
             "cellClassRules": {"zr-good": "data.standing === 'zero'", "zr-warn": "data.standing === 'reversals'",
                                "zr-bad": "data.standing === 'infeasible' || data.standing === 'failed'"}},
            {**number, "headerName": "Travel [deg]", "field": "travel", ":valueFormatter": one, "width": 94},
            {**number, "headerName": "Margin [mm]", "field": "margin", ":valueFormatter": one, "width": 98,
             "headerTooltip": "by how much the hole could be deeper without a reversal"},
            {**number, "headerName": "Time [s]", "field": "time", ":valueFormatter": one, "width": 76,
             "headerTooltip": "of the hole's own moves at their feeds; the moves between holes come on top"},
            {**number, "headerName": "Findings", "field": "findings", ":valueFormatter": COUNT, "width": 78},
            {**number, "headerName": "Depth [mm]", "field": "depth", "width": 90},
            {"headerName": "Target [mm]", "field": "target", "flex": 3, "minWidth": max(124, wide["target"]),
             "sortable": False},
            {"headerName": "Direction", "field": "direction", "flex": 2, "minWidth": max(84, wide["direction"]),
             "sortable": False},
        ],
        ":getRowId": "p => p.data.id",
        "rowSelection": {"mode": "singleRow", "checkboxes": False, "enableClickSelection": True},
        ":navigateToNextCell": STEP,
        ":isExternalFilterPresent": "() => true",
        ":doesExternalFilterPass": "() => true",
        "rowHeight": 28,
        "headerHeight": 32,
        "animateRows": False,
        "suppressColumnMoveAnimation": True,
        "suppressCellFocus": False,
        "suppressColumnVirtualisation": True,
        "tooltipShowDelay": 500,
        "overlayNoRowsTemplate": "<span>no hole is as the filter asks</span>",
    }  # fmt: skip
