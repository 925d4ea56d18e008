"""Measured holes beside the prediction of the same plan: whether each lies in the range that was predicted.

What is predicted is the hole of a free tip, an upper bound: a hole that is better than its range does not refute it,
one that is worse does. Predicted roundness is half the ovality, since roundness is a difference of radii and ovality
one of diameters.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Literal, NamedTuple

from zerorev.cell.ensemble import ENDS, Band, HoleStudy, band
from zerorev.cell.motions import MotionName
from zerorev.errors import InputError
from zerorev.model.measured_hole import MeasuredHole
from zerorev.model.plan import Plan

__all__ = ["FIGURES", "Basis", "Beside", "Comparison", "FigureName", "Place", "beside_prediction", "check_of_plan"]

FigureName = Literal["position", "tilt", "roundness_entry", "roundness_exit"]
FIGURES: tuple[FigureName, ...] = ("position", "tilt", "roundness_entry", "roundness_exit")
Place = Literal["below", "inside", "above"]
NEAR_END = 0.25  # of the depth: a section as near as that to an end speaks for it
DEEPER = 0.5e-3  # [m] that a section may lie below the planned depth: depths are measured from a face


class Beside(NamedTuple):
    """One figure of a hole.

    Attributes:
        measured: [m] or [rad]; None where it was not measured.
        predicted: range over the sets.
    """

    measured: float | None
    predicted: Band

    @property
    def place(self) -> Place | None:
        """Where the measured value lies from the predicted 5th to 95th percentile."""
        if self.measured is None:
            return None
        if self.measured < self.predicted.low:
            return "below"
        return "inside" if self.measured <= self.predicted.high else "above"


class Basis(NamedTuple):
    """What a prediction rests on.

    Attributes:
        motion: that is simulated.
        sets: how many sets of parameters.
        seed: of them.
        thrust: of the drill [N].
        cell: name of the cell file, or None.
        study: name of the study that was read, or None.
    """

    motion: MotionName
    sets: int
    seed: int
    thrust: float
    cell: str | None = None
    study: str | None = None


@dataclass(frozen=True)
class Comparison:
    """Measured holes beside predicted ones.

    Attributes:
        basis: of the prediction.
        holes: figures of those that can be compared, by id, in the plan's order.
        left_out: why others cannot, by id.
        not_measured: ids of the plan's holes that are in no row of the table.
    """

    basis: Basis
    holes: Mapping[str, Mapping[FigureName, Beside]]
    left_out: Mapping[str, str]
    not_measured: tuple[str, ...]

    def count(self, place: Place) -> int:
        """How many figures of all holes lie there."""
        return sum(each.place == place for hole in self.holes.values() for each in hole.values())


def check_of_plan(measured: Sequence[MeasuredHole], plan: Plan, source: str) -> None:
    """Refuse measured holes that cannot be those of a plan.

    Args:
        measured: holes.
        plan: that was drilled.
        source: of the measured holes, for the message.

    Raises:
        InputError: a hole that the plan does not have, or one that is deeper than planned.
    """
    planned = {each.hole.id: each.hole for each in plan.holes}
    for hole in measured:
        if hole.id not in planned:
            ids = ", ".join(list(planned)[:8]) + (", ..." if len(planned) > 8 else "")
            raise InputError(f"no hole '{hole.id}' in the plan {plan.name}".rstrip(), where=source, accepted=ids)
        depth = planned[hole.id].depth
        if hole.depth[-1] > depth + DEEPER:
            raise InputError(
                f"hole {hole.id}: a section at {hole.depth[-1] * 1e3:g} mm, but it is planned {depth * 1e3:g} mm deep",
                where=source,
                accepted="holes of the plan that is given; depths from the entry",
            )


def beside_prediction(
    measured: Sequence[MeasuredHole],
    plan: Plan,
    predicted: Mapping[str, HoleStudy],
    why_not: Mapping[str, str],
    basis: Basis,
) -> Comparison:
    """Set measured holes of a plan beside the prediction of it.

    Args:
        measured: holes, each of the plan.
        plan: that was drilled.
        predicted: studies, by hole.
        why_not: why there is no study of other holes, by hole.
        basis: of the studies; its motion is the one that drilled the holes.
    """
    by_id = {hole.id: hole for hole in measured}
    found: dict[str, dict[FigureName, Beside]] = {}
    left_out: dict[str, str] = {}
    for planned in plan.holes:
        hole = by_id.get(planned.hole.id)
        if hole is None:
            continue
        study = predicted.get(hole.id)
        if study is None:
            left_out[hole.id] = why_not.get(hole.id, "the study does not have it")
        elif basis.motion not in study.motions:
            left_out[hole.id] = f"the motion '{basis.motion}' of it was not simulated"
        elif hole.centre is None and hole.roundness is None:
            left_out[hole.id] = "neither places nor roundness were measured"
        else:
            found[hole.id] = _figures(hole, study, basis.motion, planned.hole.depth)
    missing = tuple(each.hole.id for each in plan.holes if each.hole.id not in by_id)
    return Comparison(basis, found, left_out, missing)


def _figures(hole: MeasuredHole, study: HoleStudy, motion: MotionName, depth: float) -> dict[FigureName, Beside]:
    row = study.of(motion)
    ends: list[float | None] = [None, None]
    if hole.roundness is not None:
        first, last = hole.depth[[0, -1]]
        ends[0] = float(hole.roundness[0]) if first <= NEAR_END * depth else None
        ends[1] = float(hole.roundness[-1]) if last >= (1 - NEAR_END) * depth else None
    rounds = [Beside(ends[k], band(study.ovality[row, k] / 2)) for k in range(len(ENDS))]
    return {
        "position": Beside(hole.position, band(study.position[row])),
        "tilt": Beside(hole.tilt, band(study.tilt[row])),
        "roundness_entry": rounds[0],
        "roundness_exit": rounds[1],
    }
