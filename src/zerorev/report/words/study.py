"""What the terminal and a JSON show of a study of a plan."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import Any, get_args

from rich import box
from rich.table import Table
from rich.text import Text

from zerorev.cell.ensemble import ENDS, SIDES, Band, HoleStudy, band
from zerorev.cell.motions import MotionName
from zerorev.cell.possible import Arms, held_for
from zerorev.model.ranges import HELD, Basis, Cell
from zerorev.model.tool import Tool
from zerorev.report.words.lost_motion import WHERE_IT_HOLDS

__all__ = [
    "NAMES",
    "answer",
    "band_data",
    "holes_table",
    "kept_words",
    "lines",
    "range_text",
    "rests_on",
    "table",
    "thrust_words",
]

DEG = math.degrees(1.0)

NAMES: dict[MotionName, str] = {
    "baseline": "constant spin",
    "plan": "plan",
    "twin": "its twin",
    "compensated": "constant spin, lost motion compensated",
    "biased": "constant spin, gears laid on one flank",
}


def answer(
    studied: Sequence[HoleStudy], left_out: Mapping[str, str], *, sets: int, seed: int, cell: str | None
) -> dict[str, Any]:
    """The study as plain data.

    Args:
        studied: holes.
        left_out: why others are not, by id.
        sets: how many were drawn.
        seed: of them.
        cell: name of the cell file, or None.
    """
    return {
        "holes": [_hole(hole) for hole in studied],
        "left_out": [{"id": hole, "why": why} for hole, why in left_out.items()],
        "sets": sets,
        "seed": seed,
        "cell": cell,
    }


def _hole(hole: HoleStudy) -> dict[str, Any]:
    return {
        "id": hole.id,
        "gain_percent": {side: band_data(band(hole.gain()[k]), 100, 1) for k, side in enumerate(SIDES)},
        "gain_percent_of": {
            motion: {side: band_data(band(hole.gain(motion)[k]), 100, 1) for k, side in enumerate(SIDES)}
            for motion in hole.motions
            if motion not in ("baseline", "plan")
        },
        "deviation_mm": {
            motion: {side: band_data(band(hole.deviation[hole.of(motion), k]), 1e3, 4) for k, side in enumerate(SIDES)}
            for motion in hole.motions
        },
        "hole": {motion: _estimate(hole, motion) for motion in hole.motions},
        "feed_mm_s": {motion: round(float(hole.speed[hole.of(motion)]) * 1e3, 3) for motion in hole.motions},
    }


def _estimate(hole: HoleStudy, motion: MotionName) -> dict[str, Any]:
    row = hole.of(motion)
    return {
        "position_mm": band_data(band(hole.position[row]), 1e3, 4),
        "tilt_deg": band_data(band(hole.tilt[row]), DEG, 5),
        "ovality_mm": {end: band_data(band(hole.ovality[row, k]), 1e3, 4) for k, end in enumerate(ENDS)},
    }


def band_data(values: Band, scale: float, digits: int) -> dict[str, float]:
    """A band as plain data.

    Args:
        values: in SI units.
        scale: by which they are multiplied.
        digits: behind the point.
    """
    return {
        "median": round(values.median * scale, digits),
        "p05": round(values.low * scale, digits),
        "p95": round(values.high * scale, digits),
    }


def table(studied: Sequence[HoleStudy]) -> Table:
    """One row for each hole and motion: deviation by the encoders and at the tool, gain, speed reached."""
    shown = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    shown.add_column(Text("hole"), no_wrap=True)
    shown.add_column(Text("motion"))
    for head in ("encoders\n[mm]", "gain\n[%]", "tool\n[mm]", "gain\n[%]"):
        shown.add_column(Text(head), justify="right")
    shown.add_column(Text("speed\n[mm/s]"), justify="right")
    for hole in studied:
        for motion in hole.motions:
            row, cells = hole.of(motion), []
            for k in range(len(SIDES)):
                cells.append(range_text(band(hole.deviation[row, k]), 1e3, 3))
                cells.append("" if motion == "baseline" else range_text(band(hole.gain(motion)[k]), 100, 0))
            first = hole.id if motion == hole.motions[0] else ""
            shown.add_row(*(Text(cell) for cell in (first, NAMES[motion], *cells, f"{hole.speed[row] * 1e3:.0f}")))
    return shown


def holes_table(studied: Sequence[HoleStudy]) -> Table:
    """One row for each hole and motion: the hole that a free tip leaves."""
    shown = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    shown.add_column(Text("hole"), no_wrap=True)
    shown.add_column(Text("motion"))
    for head in ("position\n[mm]", "tilt\n[deg]", "ovality at\nentry [mm]", "ovality at\nexit [mm]"):
        shown.add_column(Text(head), justify="right")
    for hole in studied:
        for row, motion in enumerate(hole.motions):
            cells = (
                hole.id if row == 0 else "", NAMES[motion], range_text(band(hole.position[row]), 1e3, 3),
                range_text(band(hole.tilt[row]), DEG, 3),
                *(range_text(band(hole.ovality[row, k]), 1e3, 3) for k in range(len(ENDS))),
            )  # fmt: skip
            shown.add_row(*map(Text, cells))
    return shown


def range_text(values: Band, scale: float, digits: int) -> str:
    """A band as a median and, in brackets, the 5th and 95th percentile.

    Args:
        values: in SI units.
        scale: by which they are multiplied.
        digits: behind the point.
    """
    median, low, high = (f"{value * scale:.{digits}f}" for value in values)
    return f"{median} [{low}, {high}]"


def lines(
    studied: Sequence[HoleStudy], left_out: Mapping[str, str], thrust: float, cell: Cell, tool: Tool
) -> Iterator[Text]:
    """What to know beside the table.

    Args:
        studied: holes.
        left_out: why others are not, by id.
        thrust: of the drill [N].
        cell: what is known of the arm.
        tool: of the plan.
    """
    for hole, why in left_out.items():
        yield Text(f"left out: hole {hole}: {why}")
    if studied:
        yield Text(f"median [5th, 95th percentile] over the sets. {rests_on(cell, tool)}")
        yield Text("the hole is that of a free tip, which no hole guides: position, tilt and ovality are upper bounds")
    if thrust > 0:
        yield Text(f"{thrust_words(thrust)} {WHERE_IT_HOLDS}")


def kept_words(arms: Arms) -> str | None:
    """How many arms are near what was measured; None where nothing was."""
    if arms.measured is None:
        return None
    if not arms.measured:
        return "the plan has none of the holes whose baselines were measured: no set is dropped"
    return f"{len(arms.sets):,} of {arms.drawn:,} sets have baselines near those that were measured"


def rests_on(cell: Cell, tool: Tool) -> str:
    """How much of a study rests on guesses: which ranges are priors, and which come from recordings.

    Args:
        cell: what is known of the arm.
        tool: whose mass may be stated.
    """
    held = held_for(tool, cell)
    of = {basis: [name for name, each in cell.ranges.items() if each.basis == basis] for basis in get_args(Basis)}
    guessed = [name for name in of["prior"] if name not in (*HELD, *held)]
    if not of["fitted"] and not of["conditioned"]:
        return (
            f"All {len(guessed)} ranges are guesses: friction, stiffness and lost motion of the gears and the gains of "
            "the controller are not facts of the robot, and nothing of them was measured."
        )
    parts = [
        f"{what}: {', '.join(_grouped(names))}."
        for what, names in (("Fitted to recordings", of["fitted"]), ("Narrowed by a recording", of["conditioned"]))
        if names
    ]
    count = len(guessed) + len(of["fitted"]) + len(of["conditioned"])
    return " ".join([*parts, f"The other {len(guessed)} of {count} ranges are guesses."])


def thrust_words(thrust: float) -> str:
    """What thrust does to a gain.

    Args:
        thrust: of the drill [N], above 0.
    """
    return (
        f"With {thrust:g} N of thrust on a free tip the arm gives way while it drills and springs back before the "
        "retract: the gain may be lost. No hole guides the tip here, so the deviation is an upper bound."
    )


def _grouped(names: Sequence[str]) -> list[str]:
    """Names of parameters; the six of the joints as one where all are there."""
    found: dict[str, None] = {}
    for name in names:
        stem = name[:-2] if name[-2:-1] == "_" and name[-1:].isdigit() else name
        six = [f"{stem}_{joint}" for joint in range(1, 7)]
        found[f"{stem}_1 to {stem}_6" if stem != name and set(six) <= set(names) else name] = None
    return list(found)
