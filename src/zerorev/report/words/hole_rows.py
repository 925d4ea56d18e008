"""What a table shows of many holes, a row each: plain values, in mm and degrees, to be sorted and filtered."""

from __future__ import annotations

import operator
import re
from collections.abc import Callable, Iterable
from typing import Literal, NamedTuple

from zerorev.errors import InputError
from zerorev.files.units import deg, mm
from zerorev.model._arrays import Array
from zerorev.model.hole import Hole
from zerorev.model.plan import HolePlan
from zerorev.report.words.tables import hole_findings

__all__ = ["QUICK", "HoleRow", "Standing", "hole_row", "matching", "part_data", "standing"]

Standing = Literal["zero", "reversals", "infeasible", "failed", "unplanned"]
GRAVE = ("error", "warning")


class HoleRow(NamedTuple):
    """One hole in a table; None where a value is not known.

    Attributes:
        id: of the hole.
        target: bottom of the stroke, part frame, as text [mm].
        direction: of the plunge, part frame, as text.
        depth: stroke [mm].
        standing: what became of it.
        before: reversals of the baseline.
        after: reversals of the motion.
        travel: of all joints [deg].
        margin: by how much the deepest stroke without a reversal is deeper than the hole [mm].
        findings: how many warnings and errors.
        time: of the hole's own moves [s].
    """

    id: str
    target: str
    direction: str
    depth: float
    standing: Standing
    before: int | None = None
    after: int | None = None
    travel: float | None = None
    margin: float | None = None
    findings: int = 0
    time: float | None = None


def hole_row(hole: Hole, answer: HolePlan | None, T_base_part: Array) -> HoleRow:
    """The row of a hole.

    Args:
        hole: of the job.
        answer: what was found for it, or None.
        T_base_part: part frame, shape (4, 4), translation [m].
    """
    target_mm, direction, depth_mm = part_data(hole, T_base_part)
    row = HoleRow(hole.id, _listed(target_mm, 3), _listed(direction, 4), round(depth_mm, 6), standing(answer))
    if answer is None:
        return row
    score, baseline = answer.score, answer.baseline
    return row._replace(
        before=None if baseline is None else baseline.reversals,
        after=None if score is None else score.reversals,
        travel=None if score is None else float(deg(score.travel)),
        margin=None if answer.deepest is None else float(mm(answer.deepest - hole.depth)),
        findings=sum(finding.level in GRAVE for finding in hole_findings(answer)),
        time=answer.cycle_time,
    )


def part_data(hole: Hole, T_base_part: Array) -> tuple[list[float], list[float], float]:
    """Target [mm] and direction in the part frame, and depth [mm], as a job file has them, free of rounding noise."""
    R = T_base_part[:3, :3]
    target = R.T @ (hole.target - T_base_part[:3, 3])
    cleaned = (mm(target).round(6) + 0.0).tolist(), ((R.T @ hole.direction).round(9) + 0.0).tolist()
    return *cleaned, round(float(mm(hole.depth)), 6)


def standing(answer: HolePlan | None) -> Standing:
    """What became of a hole."""
    if answer is None:
        return "unplanned"
    if answer.score is None:
        return "infeasible"
    if any(finding.level == "error" for finding in hole_findings(answer)):
        return "failed"
    return "reversals" if answer.score.reversals else "zero"


def _listed(values: Iterable[float], digits: int) -> str:
    return ", ".join(f"{round(value, digits) + 0.0:g}" for value in values)


# --- which rows are wanted --------------------------------------------------------------------------------------------

QUICK: dict[str, Callable[[HoleRow], bool]] = {
    "all": lambda row: True,
    "with reversals": lambda row: bool(row.after),
    "infeasible": lambda row: row.standing == "infeasible",
    "not planned": lambda row: row.standing == "unplanned",
    "with findings": lambda row: row.findings > 0,
}
FIELDS = {"reversals": "after", "before": "before", "travel": "travel", "margin": "margin", "depth": "depth",
          "findings": "findings"}  # fmt: skip
COMPARED = {">": operator.gt, "<": operator.lt, ">=": operator.ge, "<=": operator.le, "=": operator.eq}
CONDITION = re.compile(r"(?P<name>[a-z]+)(?P<compared>>=|<=|>|<|=)(?P<value>.*)")


def matching(wanted: str, quick: str = "all") -> Callable[[HoleRow], bool]:
    """Which rows a user asks for.

    Args:
        wanted: words, all to be met: a piece of the id, or a condition as `reversals>0`.
        quick: one of `QUICK`.

    Raises:
        InputError: a condition on something that is not there, or without a number.
    """
    conditions = [_condition(word) for word in wanted.lower().split()] + [QUICK[quick]]
    return lambda row: all(condition(row) for condition in conditions)


def _condition(word: str) -> Callable[[HoleRow], bool]:
    parts = CONDITION.fullmatch(word)
    if parts is None:
        return lambda row: word in row.id.lower()
    accepted = f"a piece of an id, or one of {', '.join(FIELDS)} with > < >= <= = and a number, as reversals>0"
    field, compared = FIELDS.get(parts["name"]), COMPARED[parts["compared"]]
    if field is None:
        raise InputError(f"nothing is called '{parts['name']}'", where="filter", accepted=accepted)
    try:
        value = float(parts["value"].replace(",", "."))
    except ValueError:
        raise InputError(f"'{parts['value']}' is not a number", where="filter", accepted=accepted) from None

    def meets(row: HoleRow) -> bool:
        known = getattr(row, field)
        return known is not None and bool(compared(known, value))

    return meets
