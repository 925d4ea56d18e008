"""What the command `rates` shows: critical rates and what they predict, as plain data and as a table."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from rich import box
from rich.table import Table
from rich.text import Text

from zerorev.files.units import deg, deg_per_mm, mm, plain
from zerorev.model.hole import Hole
from zerorev.model.job import Job
from zerorev.motion.critical import CriticalRates
from zerorev.search.prediction import Prediction

__all__ = ["predicted_data", "predicted_table", "rates_data", "rates_table"]


def rates_data(rates: CriticalRates) -> dict[str, Any]:
    """Critical rates at one spin as plain data; null where the branch cannot reach, or a joint has none."""
    data = {
        "branch": rates.branch,
        "psi_deg": deg(rates.psi),
        "critical_rates_deg_per_mm": deg_per_mm(rates.kappa),
        "twist_spread_deg_per_mm": deg_per_mm(rates.spread),
    }
    return dict(plain(data))


def predicted_data(hole: Hole, predicted: Prediction) -> dict[str, Any]:
    """A hole's prediction as plain data; null where there is nothing to predict."""
    least = None if predicted.cheapest is None else deg(predicted.cheapest.width * hole.depth)
    data = {
        "id": hole.id,
        "cheapest": None if predicted.cheapest is None else rates_data(predicted.cheapest),
        "twist_bound_deg": least,
        "least_twist_deg": deg(predicted.least_twist),
        "deepest_mm": mm(predicted.deepest),
        "deepest_at": None if predicted.deepest_at is None else rates_data(predicted.deepest_at),
    }
    return dict(plain(data))


def predicted_table(job: Job, predicted: Sequence[Prediction]) -> Table:
    """One row per hole: where zero reversals are cheapest, the critical rates there, and what is predicted."""
    table = _table(job, "hole", "least twist\npredicted [deg]", "deepest\npredicted [mm]")
    for hole, each in zip(job.holes, predicted, strict=True):
        if each.cheapest is None:
            table.add_row(Text(hole.id), Text("out of reach", style="red"))
            continue
        twist = "none" if np.isinf(each.least_twist) else f"{deg(each.least_twist):.1f}"
        table.add_row(Text(hole.id), *_cells(each.cheapest), Text(twist), Text(f"{mm(each.deepest):.1f}"))
    return table


def rates_table(job: Job, rates: Sequence[tuple[Hole, CriticalRates]]) -> Table:
    """One row per hole and branch in reach: the critical rates at one spin."""
    table = _table(job, "hole")
    for hole, each in rates:
        if each.branch % 2 == 0:  # the two wrist flips share their critical rates
            _, *cells = _cells(each)
            table.add_row(Text(hole.id), Text(f"{each.branch}, {each.branch + 1}"), *cells)
    return table


def _table(job: Job, *headings: str) -> Table:
    first, *last = headings
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    table.add_column(Text(first), no_wrap=True)
    joints = (f"{name}\n[deg/mm]" for name in job.robot.joint_names)
    for heading in ("branch", "spin\n[deg]", *joints, "spread\n[deg/mm]", *last):
        table.add_column(Text(heading), justify="right")
    return table


def _cells(rates: CriticalRates) -> list[Text]:
    numbers = [*deg_per_mm(rates.kappa), deg_per_mm(rates.spread)]
    cells = ["–" if not np.isfinite(number) else f"{round(float(number), 3) + 0.0:.3f}" for number in numbers]
    return [Text(cell) for cell in (str(rates.branch), f"{deg(rates.psi) + 0.0:.2f}", *cells)]
