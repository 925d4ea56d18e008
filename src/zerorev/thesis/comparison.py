"""What the command `methods` writes and shows: plain data, a file of rows, a table, and a few lines."""

from __future__ import annotations

from collections.abc import Sequence
from statistics import median
from typing import Any

from rich import box
from rich.table import Table
from rich.text import Text

from zerorev.files.conversion import robot_data, tool_data
from zerorev.files.text import csv_text
from zerorev.files.units import deg, mm, plain
from zerorev.thesis.compare import Comparison, Rescored, Summary

__all__ = ["comparison_csv", "comparison_data", "comparison_lines", "comparison_table", "duration"]

NOTHING = "–"
PSI = ("psi_start_deg", "psi_target_deg", "psi_end_deg")


def comparison_data(comparison: Comparison) -> dict[str, Any]:
    """The answer as plain data, in the form of a comparison file (docs/thesis/methods.md)."""
    summaries = comparison.summaries()
    data = {
        "format": "zerorev.comparison/1",
        "name": comparison.job.name,
        "robot": robot_data(comparison.job.robot),
        "tool": tool_data(comparison.job.tool),
        "psi_bound_deg": deg(comparison.bound),
        "samples": comparison.samples,
        "crowded": comparison.crowded,
        "budget": comparison.budget,
        "seeds": list(comparison.seeds),
        "complete": len(comparison.runs) == comparison.expected,
        "methods": [
            {"method": name, "what": method.what, "random": method.random}
            for name, method in comparison.methods.items()
        ],
        "holes": [
            {
                "id": hole.id,
                "target_mm": mm(hole.target),
                "depth_mm": mm(hole.depth),
                "methods": [_summary_data(each) for each in summaries if each.hole == hole.id],
            }
            for hole in comparison.holes
        ],
    }
    return dict(plain(data))


def _summary_data(summary: Summary) -> dict[str, Any]:
    interval = summary.interval
    return {
        "method": summary.method,
        "runs": len(summary.runs),
        "zero": summary.zero,
        "zero_interval": None if interval is None else list(interval),
        "zero_as_sampled": summary.zero_sampled,
        "best_score": min(summary.scores),
        "median_score": median(summary.scores),
        "best_travel_deg": deg(min(summary.travels)) if summary.travels else None,
        "median_travel_deg": deg(median(summary.travels)) if summary.travels else None,
        "median_evaluations_to_first_zero": _median(summary.first_zeros),
        "median_seconds": median(summary.seconds),
        "outcomes": [_run_data(run) for run in summary.runs],
    }


def _run_data(run: Rescored) -> dict[str, Any]:
    found = run.outcome
    return {
        "seed": run.seed,
        "score": run.score,
        "reversals": run.reversals,
        "travel_deg": None if run.travel is None else deg(run.travel),
        "psi_deg": None if found is None else deg(found.spins),
        "branch": None if found is None else found.branch,
        "score_as_sampled": None if found is None else found.score,
        "reversals_as_sampled": None if found is None or found.reversals < 0 else found.reversals,
        "evaluations": None if found is None else found.evaluations,
        "evaluations_to_first_zero": None if found is None else found.first_zero,
        "seconds": run.seconds,
    }


def comparison_csv(comparison: Comparison) -> str:
    """One row per run, as text; what does not apply is left empty."""
    runs = [
        {"hole": run.hole, "method": run.method} | _in_columns(dict(plain(_run_data(run)))) for run in comparison.runs
    ]
    names = list(runs[0]) if runs else ["hole", "method"]
    return csv_text([names, *([run[name] for name in names] for run in runs)])


def _in_columns(data: dict[str, Any]) -> dict[str, Any]:
    """The three spins in a column each, where they stand."""
    spins = dict(zip(PSI, data["psi_deg"] or (None,) * 3, strict=True))
    flat: dict[str, Any] = {}
    for key, value in data.items():
        flat |= spins if key == "psi_deg" else {key: value}
    return flat


def comparison_table(comparison: Comparison) -> Table:
    """One row per method and hole: successes, score, travel, evaluations to the first zero, time."""
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    table.add_column(Text("hole"), no_wrap=True)
    table.add_column(Text("method"), no_wrap=True)
    for heading in (
        "zero reversals\nof runs", "share [95 %]", "as\nsampled", "score\nbest", "\nmedian", "travel [deg]\nbest",
        "\nmedian", "evaluations\nto first zero", "time\nof a run",
    ):  # fmt: skip
        table.add_column(Text(heading), justify="right", no_wrap=True)
    before = ""
    for summary in comparison.summaries():
        if before and summary.hole != before:
            table.add_section()
        table.add_row(Text("" if summary.hole == before else summary.hole), Text(summary.method), *_cells(summary))
        before = summary.hole
    return table


def _cells(summary: Summary) -> list[Text]:
    count, zero, travels = len(summary.runs), summary.zero, [float(deg(travel)) for travel in summary.travels]
    share = "no chance"
    if summary.interval is not None:
        low, high = summary.interval
        share = f"{zero / count:.0%} [{100 * low:.0f}, {100 * high:.0f}]"
    firsts = f"{median(summary.first_zeros):,.0f}" if summary.first_zeros else NOTHING
    if summary.first_zeros and len(summary.first_zeros) < count:
        firsts += f" ({len(summary.first_zeros)} runs)"
    return [
        Text(f"{zero} of {count}", style="green" if zero == count else "yellow" if zero else "red"),
        Text(share),
        Text(str(summary.zero_sampled)),
        Text(f"{min(summary.scores):.5f}"),
        Text(f"{median(summary.scores):.5f}"),
        Text(f"{min(travels):.2f}" if travels else NOTHING),
        Text(f"{median(travels):.2f}" if travels else NOTHING),
        Text(firsts),
        Text(duration(median(summary.seconds))),
    ]


def comparison_lines(comparison: Comparison) -> list[Text]:
    """What the table is of."""
    seeds = len(comparison.seeds)
    crowded = ", crowded at the ends of the legs" if comparison.crowded else ""
    text = (
        f"{seeds} seed{'s' if seeds > 1 else ''}, {comparison.budget:,} evaluations a run at most; eq. 4.7 at"
        f" {comparison.samples:,} samples of the motion{crowded},"
        f" spin within +-{float(deg(comparison.bound)):g} deg, no motion threshold"
    )
    second = (
        "zero reversals, score and travel are of the motion found, evaluated exactly; 'as sampled' counts runs with"
        " zero reversals on the samples; travel is of the runs with zero reversals; medians over the runs"
    )
    return [Text(text, style="dim"), Text(second, style="dim")]


def duration(seconds: float) -> str:
    """A time in words."""
    return f"{seconds:.2f} s" if seconds >= 1 else f"{1e3 * seconds:.3g} ms"


def _median(values: Sequence[float]) -> float | None:
    return median(values) if values else None
