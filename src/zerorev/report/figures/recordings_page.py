"""Two recordings of one hole side by side, as one page that needs no network."""

from __future__ import annotations

import html
from collections.abc import Sequence

import numpy as np

from zerorev.cell.recordings.metrics import Metrics
from zerorev.cell.recordings.run import DrillingRun
from zerorev.report.figures.page import html_page, picture
from zerorev.report.figures.recordings import Compared, deviations, joints, paths, postures, profiles, torques
from zerorev.report.figures.style import png, signed
from zerorev.report.words.recordings import ALIGNED, findings_of

__all__ = ["comparison_rows", "recordings_page"]

SAME_FEED = 0.05
ENCODERS = (
    "All of it is what the encoders of the arm see. Play and give behind them do not show here: for these the tip has "
    "to be measured from outside."
)

Row = tuple[str, str, str, str]


def recordings_page(compared: Compared) -> str:
    """The page as HTML; the same recordings make the same bytes."""
    sections = [("Figures", _feeds(compared) + ENCODERS, _table(comparison_rows(compared)))]
    for head, hint, figure in (
        ("Postures", "Thesis Figures 30, 31, 37, 41. The plan's robot in the joints that were recorded.",
         postures(compared)),
        ("Joint angles", "Thesis Figures 32, 38, 42. Path distance is 0 at the turn.", joints(compared)),
        ("Path distance", "Thesis Figure 33: both runs are compared by it, never by time.", paths(compared)),
        ("Joint torques", "Thesis Figures 28, 34, 39, 43: as the controller logs them.", torques(compared)),
        ("Profile of the tip", "Thesis Figures 35, 40, 44. Where plunge and retract lie apart, joints have turned back "
         "between them.", profiles(compared)),
        ("Distance from the mean", "Thesis Figure 36.", deviations(compared)),
    ):  # fmt: skip
        if figure is None:
            unplanned = head == "Postures" and compared.planned is None
            sections.append((head, "Not known without a plan." if unplanned else "Not recorded.", ""))
        else:
            sections.append((head, hint, picture(png(figure), head)))
    sections.append(("Findings", "", _findings(compared)))
    hole = f" of hole {compared.planned.drilling.hole.id}" if compared.planned else ""
    names = (compared.baseline[0].recording.source, compared.optimised[0].recording.source)
    return html_page(f"Recorded runs{hole}", f"baseline {names[0]}, optimised {names[1]}", sections, moving=False)


def comparison_rows(compared: Compared) -> list[Row]:
    """What, of the baseline, of the optimised run, and the change."""
    (before, first), (after, second) = compared.baseline, compared.optimised
    rows: list[Row] = [
        ("recording", before.recording.source, after.recording.source, ""),
        ("aligned at its", ALIGNED[before.alignment.by], ALIGNED[after.alignment.by], ""),
        _row("feed [mm/s]", before.feed, after.feed, "{:.1f}"),
        _row("path [mm]", first.path_length, second.path_length, "{:.1f}"),
        ("window [mm]", f"±{first.window * 1e3:.4g}", f"±{second.window * 1e3:.4g}", ""),
        _row("precision: greatest deviation from the mean [mm]", first.deviation_max, second.deviation_max),
        _row("its rms [mm]", first.deviation_rms, second.deviation_rms),
        _row("greatest horizontal part [mm]", first.deviation_parts[0], second.deviation_parts[0]),
        _row("greatest vertical part [mm]", first.deviation_parts[1], second.deviation_parts[1]),
        ("accuracy: offset of the mean [mm]", _or_unknown(first.offset), _or_unknown(second.offset), ""),
        ("reversals A1 to A6", _counts(first), _counts(second), ""),
    ]
    swings = _swing(before, first), _swing(after, second)
    if swings[0] is not None and swings[1] is not None:
        pairs = zip(compared.names, swings[0], swings[1], strict=True)
        rows += [_row(f"swing of the torque of {name} in the window [Nm]", one, other, "{:.3g}", 1.0)
                 for name, one, other in pairs]  # fmt: skip
    return rows


def _row(what: str, before: float, after: float, form: str = "{:.3f}", scale: float = 1e3) -> Row:
    change = f"{signed(100 * (after / before - 1), 0)} %" if before > 0 else ""
    return what, form.format(before * scale), form.format(after * scale), change


def _or_unknown(value: float | None) -> str:
    return "unknown" if value is None else f"{value * 1e3:.3f}"


def _counts(found: Metrics) -> str:
    return "unknown" if found.reversals_per_joint is None else " ".join(map(str, found.reversals_per_joint))


def _swing(run: DrillingRun, found: Metrics) -> Sequence[float] | None:
    """Greatest less least torque of each joint in the window [Nm]."""
    if run.recording.torque is None:
        return None
    inside = run.recording.torque[run.rows][np.abs(run.path) <= found.window]
    return list(np.ptp(inside, axis=0)) if len(inside) else None


def _feeds(compared: Compared) -> str:
    before, after = compared.baseline[0].feed, compared.optimised[0].feed
    if abs(after / before - 1) <= SAME_FEED:
        return ""
    return (
        f"The runs were at different speeds, {before * 1e3:.3g} and {after * 1e3:.3g} mm/s, and a part of the "
        "difference may come from that. "
    )


def _table(rows: Sequence[Row]) -> str:
    body = "".join(
        f"<tr><th>{html.escape(what)}</th>{''.join(f'<td>{html.escape(cell)}</td>' for cell in cells)}</tr>\n"
        for what, *cells in rows
    )
    head = "<tr><th></th><th>baseline</th><th>optimised</th><th>change</th></tr>"
    return f"<table><thead>{head}</thead><tbody>\n{body}</tbody></table>"


def _findings(compared: Compared) -> str:
    lines = [
        f"<li>{name}: {finding.level}: {html.escape(finding.message)}</li>"
        for name, (run, found) in (("baseline", compared.baseline), ("optimised", compared.optimised))
        for finding in findings_of(run, found)
    ]
    return f"<ul>{''.join(lines)}</ul>" if lines else "<p>None.</p>"
