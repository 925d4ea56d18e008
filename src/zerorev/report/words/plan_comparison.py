"""What the command `compare` shows of two plans: plain data, a table, and a few lines."""

from __future__ import annotations

from collections import Counter
from typing import Any

import numpy as np
from rich import box
from rich.table import Table
from rich.text import Text

from zerorev.files.units import deg, mm, plain
from zerorev.model.plan import HolePlan, Plan, named_holes
from zerorev.planning.compared import Compared, HolePair
from zerorev.report.words.answer import minutes

__all__ = ["comparison_data", "comparison_lines", "comparison_table"]

ROWS = 60
FIGURES = ("depth_mm", "reversals", "travel_deg", "margin_mm", "deepest_mm", "lost_motion_mm", "cycle_time_s")
COLUMNS = {
    "reversals": ("reversals", 0), "travel_deg": ("travel\n[deg]", 1), "margin_mm": ("margin\n[mm]", 1),
    "deepest_mm": ("deepest\n[mm]", 1), "lost_motion_mm": ("lost motion\n[mm]", 3), "cycle_time_s": ("time\n[s]", 1),
}  # fmt: skip
STYLES = {"first": "yellow", "second": "green", "alike": ""}


def comparison_data(found: Compared, names: tuple[str, str]) -> dict[str, Any]:
    """The answer as plain data.

    Args:
        found: two plans side by side.
        names: what they are called.
    """
    holes = [
        {"id": pair.first.hole.id, "better": pair.better, "same_hole": pair.same_hole, "first": _figures(pair.first),
         "second": _figures(pair.second)}
        for pair in found.pairs
    ]  # fmt: skip
    sides = zip(("first", "second"), names, (found.first, found.second), range(2), strict=True)
    data = {
        "format": "zerorev.plan_comparison/1",
        **{
            side: {
                "name": name,
                "robot": plan.robot.name,
                "tool": plan.tool.name,
                "reversals": found.reversals[n],
                "travel_deg": deg(found.travel[n]),
                "infeasible": found.infeasible[n],
                "cycle_time_s": plan.cycle_time,
            }
            for side, name, plan, n in sides
        },
        "better": found.better,
        "holes": holes,
        "only_first": [hole.hole.id for hole in found.only_first],
        "only_second": [hole.hole.id for hole in found.only_second],
    }
    return dict(plain(data))


def _figures(answer: HolePlan) -> dict[str, float | None]:
    score, lost, deepest = answer.score, answer.lost_motion, answer.deepest
    values: tuple[Any, ...] = (
        mm(answer.hole.depth),
        None if score is None else score.reversals,
        None if score is None else deg(score.travel),
        None if deepest is None else mm(deepest - answer.hole.depth),
        None if deepest is None else mm(deepest),
        None if lost is None else mm(lost.at_tip),
        answer.cycle_time,
    )
    return dict(zip(FIGURES, values, strict=True))


def comparison_table(found: Compared, names: tuple[str, str]) -> Table:
    """A row per hole that both have: each figure in the one and in the other; where they are many, those that differ.

    Args:
        found: two plans side by side.
        names: what they are called.
    """
    pairs = shown_pairs(found)
    figures = [(_figures(pair.first), _figures(pair.second)) for pair in pairs]
    shown = {name: column for name, column in COLUMNS.items()
             if any(side[name] is not None for pair in figures for side in pair)}  # fmt: skip
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    table.add_column(Text("hole"), no_wrap=True)
    for heading, _ in shown.values():
        table.add_column(Text(heading), justify="right")
    table.add_column(Text("better"))
    words = {"first": names[0], "second": names[1], "alike": "alike"}
    for pair, (one, other) in zip(pairs, figures, strict=True):
        cells = [Text(_change(one[name], other[name], digits)) for name, (_, digits) in shown.items()]
        hole = Text(pair.first.hole.id + ("" if pair.same_hole else " *"))
        table.add_row(hole, *cells, Text(words[pair.better], style=STYLES[pair.better]))
    return table


def shown_pairs(found: Compared) -> list[HolePair]:
    """The pairs that a table shows: all, or of many those that differ, the first of them."""
    if len(found.pairs) <= ROWS:
        return list(found.pairs)
    return [pair for pair in found.pairs if pair.better != "alike" or not pair.same_hole][:ROWS]


def _change(one: float | None, other: float | None, digits: int) -> str:
    first, second = ("–" if value is None else f"{value + 0.0:.{digits}f}" for value in (one, other))
    return first if first == second else f"{first} → {second}"


def comparison_lines(found: Compared, names: tuple[str, str]) -> list[Text]:
    """Totals, which is the better and why, and what only one has.

    Args:
        found: two plans side by side.
        names: what they are called.
    """
    lines = []
    if (rest := len(found.pairs) - len(shown_pairs(found))) > 0:
        lines.append(f"{rest:,} more holes, not shown")
    lines += [f"{name}: {_totals(found, n)}" for n, name in enumerate(names)]
    counts = Counter(pair.better for pair in found.pairs)
    common = f"{len(found.pairs):,} common hole{'' if len(found.pairs) == 1 else 's'}"
    lines.append(
        f"of {common} {names[0]} is better at {counts['first']:,}, {names[1]} at "
        f"{counts['second']:,}; {counts['alike']:,} are alike"
    )
    answer = Text(_verdict(found, names), style="bold")
    after = [f"only in {name}: {named_holes(hole.hole.id for hole in holes)}"
             for name, holes in zip(names, (found.only_first, found.only_second), strict=True) if holes]  # fmt: skip
    if others := [pair.first.hole.id for pair in found.pairs if not pair.same_hole]:
        after.append(f"* not the same in both (place in the part, direction or depth): {named_holes(others)}")
    if found.first.settings != found.second.settings:
        after.append(f"the settings differ; which motion is better is judged by those of {names[0]}")
    return [*map(Text, lines), answer, *map(Text, after)]


def _totals(found: Compared, side: int) -> str:
    plan: Plan = (found.first, found.second)[side]
    text = f"{plan.robot.name}, {plan.tool.name}; {found.reversals[side]} reversals, {deg(found.travel[side]):.1f} deg"
    text += f" over the {len(found.drilled):,} holes that both drill"
    if found.infeasible[side]:
        text += f"; {found.infeasible[side]} common holes without a motion"
    return text if plan.cycle_time is None else f"{text}; cycle time of its whole job {minutes(plan.cycle_time)}"


def _verdict(found: Compared, names: tuple[str, str]) -> str:
    if not found.pairs:
        return "they have no hole in common"
    if found.better == "alike":
        return "they are alike in holes drilled, reversals and travel"
    one, other = (0, 1) if found.better == "first" else (1, 0)
    count = found.infeasible[other] - found.infeasible[one]
    if count:
        why = f"it drills {count} more of the common holes"
    elif count := found.reversals[other] - found.reversals[one]:
        why = f"{count} reversal{'' if count == 1 else 's'} fewer"
    else:
        why = f"{float(np.rad2deg(found.travel[other] - found.travel[one])):.1f} deg less travel"
    return f"better: {names[one]} ({why})"
