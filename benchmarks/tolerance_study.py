"""What the tolerance of placement has to do with the margin: `python -m benchmarks.tolerance_study`.

Random holes are planned for the least travel, with the motion threshold and without, and for the greatest margin; of
each motion without a reversal, the largest certified tolerance of the part's placement is found. Writes
docs/img/tolerance.png and out/tolerance.json, and prints the tables of docs/explanation/check.md.
"""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.lines import Line2D
from scipy.stats import spearmanr

import zerorev as zr
from benchmarks.cases import NO_THRESHOLD, certified
from zerorev.files.output import write_bytes, write_text
from zerorev.model._arrays import Array
from zerorev.report.figures import style
from zerorev.verify.certificate.within import largest_within

ROOT = Path(__file__).parents[1]
WAYS = {
    "least travel, no threshold": NO_THRESHOLD,
    "least travel, 0.01 deg/mm": zr.Settings(),
    "greatest margin": zr.Settings(objective="margin"),
}
WITH_ROOM = {
    "least travel, 1 deg to the limits": zr.Settings(limit_margin=np.deg2rad(1.0)),
    "greatest margin, 3 deg to the limits": zr.Settings(objective="margin", limit_margin=np.deg2rad(3.0)),
}


def studied(seed: int, ways: dict[str, zr.Settings]) -> dict[str, Any] | None:
    """Margin and tolerance of one hole, planned in each way; None where one of them leaves it uncertified."""
    out: dict[str, Any] = {"seed": seed}
    for name, settings in ways.items():
        plan = certified(seed, settings)
        if plan is None:
            return None
        (hole,) = plan.holes
        assert hole.score is not None
        tolerance = largest_within(plan.robot, plan.tool, plan.settings, plan.T_base_part, hole)
        out[name] = {
            "margin_deg_per_mm": float(np.rad2deg(hole.score.min_rate.min()) / 1e3),
            "within_mm": 0.0 if tolerance.within is None else tolerance.within.position * 1e3,
            "failure_at": None if tolerance.error is None else _share(tolerance.error, tolerance.within),
            "decides": "limit"
            if "limits" in tolerance.decides
            else "reach"
            if "reach" in tolerance.decides
            else "rate",
        }
    return out


def _share(error: Any, within: Any) -> float | None:
    """How many times the certified tolerance the error is that is proven to fail."""
    if within is None:
        return None
    return float(max(np.abs(error[:3]).max() / within.position, np.linalg.norm(error[3:]) / within.rotation))


def judged(found: list[dict[str, Any]], name: str) -> dict[str, float]:
    """One way of planning."""
    each = [hole[name] for hole in found]
    margin, within = (np.array([one[key] for one in each]) for key in ("margin_deg_per_mm", "within_mm"))
    by_rate = np.array([one["decides"] == "rate" for one in each])
    failures = np.array([one["failure_at"] for one in each if one["failure_at"] is not None])
    return {
        "holes": len(each),
        "median margin [deg/mm]": float(np.median(margin)),
        "certified within, 10 % [mm]": float(np.quantile(within, 0.1)),
        "certified within, median [mm]": float(np.median(within)),
        "certified within, 90 % [mm]": float(np.quantile(within, 0.9)),
        "at least 1 mm": float(np.mean(within >= 1)),
        "a limit decides": float(np.mean([one["decides"] == "limit" for one in each])),
        "rank correlation": correlation(margin, within),
        "rank correlation where a rate decides": correlation(margin[by_rate], within[by_rate]),
        "a failing frame was found": len(failures) / (within > 0).sum() if within.any() else np.nan,
        "in the median at": float(np.median(failures)) if len(failures) else np.nan,
    }


def correlation(margin: Array, within: Array) -> float:
    """Of the ranks; NaN where all margins are the same, or all tolerances."""
    if max(np.ptp(margin) / margin.max(), np.ptp(within)) < 1e-3 or min(np.ptp(margin), np.ptp(within)) == 0:
        return np.nan
    return float(spearmanr(margin, within).statistic)


def markdown(found: list[dict[str, Any]]) -> Iterator[str]:
    """The table as docs/explanation/check.md shows it."""
    columns = {name: judged(found, name) for name in found[0] if name != "seed"}
    yield "| | " + " | ".join(columns) + " |"
    yield "|---" * (1 + len(columns)) + "|"
    for key in next(iter(columns.values())):
        shares = key in ("at least 1 mm", "a limit decides", "a failing frame was found")
        cells = (
            "–" if np.isnan(column[key]) else f"{column[key]:.0%}" if shares else f"{column[key]:.3g}"
            for column in columns.values()
        )
        yield f"| {key} | " + " | ".join(cells) + " |"


def picture(found: list[dict[str, Any]]) -> bytes:
    """Tolerance against margin, one dot per hole and way of planning."""
    figure = style.headed_figure(
        "How far the part may stand off, against the margin",
        f"{len(found)} random holes, 10 mm deep; 10 mm per deg",
        4.6,
    )
    axes = figure.subplots()
    style.bare_axes(axes)
    handles = []
    for k, name in enumerate(WAYS):
        colour = style.JOINT_COLOURS[2 * k]
        each = [hole[name] for hole in found if hole[name]["within_mm"] > 0]
        for rate, mark in ((True, "o"), (False, "x")):
            pairs = [(one["margin_deg_per_mm"], one["within_mm"]) for one in each if (one["decides"] == "rate") == rate]
            if pairs:
                axes.loglog(
                    *np.array(pairs).T, mark, color=colour, markersize=3.4, alpha=0.6, markeredgewidth=0.8 * (not rate)
                )
        if each:
            handles.append(Line2D([], [], marker="o", linestyle="none", markersize=5, color=colour, label=name))
    handles.append(
        Line2D([], [], marker="x", linestyle="none", markersize=5, color=style.MUTED, label="a limit decides")
    )
    style.label(axes, "margin: slowest joint [deg/mm]", "certified within [mm]")
    style.legend_below(figure, handles, columns=4)
    return style.png(figure)


def main(arguments: list[str] | None = None, say: Callable[[str], None] = print) -> int:
    """Run the study."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--holes", type=int, default=200, help="how many random holes")
    parser.add_argument("--seed", type=int, default=3000, help="of the first; the others count up from it")
    parser.add_argument("--out", type=Path, default=ROOT / "out", help="folder of tolerance.json")
    parser.add_argument("--figure", type=Path, default=ROOT / "docs" / "img" / "tolerance.png")
    parser.add_argument("--room", action="store_true", help="plan with room at the joint limits, too")
    asked = parser.parse_args(arguments)
    ways = WAYS | (WITH_ROOM if asked.room else {})
    found, seed = list[dict[str, Any]](), asked.seed
    while len(found) < asked.holes:
        if (hole := studied(seed, ways)) is not None:
            found.append(hole)
            if len(found) % 20 == 0:
                sys.stderr.write(f"{len(found)} of {asked.holes} holes\n")
        seed += 1
    asked.out.mkdir(parents=True, exist_ok=True)
    write_text(
        asked.out / "tolerance.json", json.dumps({"first": asked.seed, "past": seed, "found": found}, indent=1) + "\n"
    )
    write_bytes(asked.figure, picture(found))
    say("\n".join(markdown(found)))
    say(f"{len(found)} holes that are certified in all ways, of {seed - asked.seed}")
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
