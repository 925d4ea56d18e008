"""Possible arms for a plan: drawn from what is known of its arm, and near what was measured of its baselines."""

from __future__ import annotations

from collections.abc import Generator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TypeVar

import numpy as np

from zerorev.cell.ensemble import BLOCK, HoleStudy, study
from zerorev.cell.parameters import ParameterSet, drawn
from zerorev.cell.reference import Manner
from zerorev.errors import InputError
from zerorev.model.plan import Plan
from zerorev.model.ranges import HELD, Cell
from zerorev.model.tool import Tool
from zerorev.workers import HERE, Machines

__all__ = ["Arms", "check_robot", "conditioned", "finished", "held_for", "possible_arms"]

Result = TypeVar("Result")
Steps = Generator[None, None, Result]
"""Work that pauses after each step, where it can be dropped; `finished` does all of it."""


@dataclass(frozen=True)
class Arms:
    """Possible arms.

    Attributes:
        sets: of parameters, one per arm.
        drawn: how many sets were drawn, with those that are far from what was measured.
        measured: of how many holes of the plan the baselines were measured; None: the cell file states none.
    """

    sets: tuple[ParameterSet, ...]
    drawn: int
    measured: int | None = None


def check_robot(cell: Cell, robot: str, where: str) -> None:
    """Make sure that a cell file is of the robot of a plan.

    Args:
        cell: of the file.
        robot: name of the plan's.
        where: name of the file.

    Raises:
        InputError: it is of another one.
    """
    if cell.robot not in ("", robot):
        what = f"is of the robot {cell.robot}, the plan of {robot}"
        raise InputError(what, where=where, accepted="a cell file of the plan's robot")


def held_for(tool: Tool, cell: Cell) -> tuple[str, ...]:
    """Parameters of the tool that its file states: held, but for those that were fitted to recordings since."""
    if tool.load is None:
        return ()
    return tuple(name for name in ("tool_mass", "tool_lever") if cell.ranges[name].basis == "prior")


def possible_arms(
    plan: Plan, cell: Cell, count: int, seed: int, *, vary: bool = False, block: int = BLOCK, machines: Machines = HERE
) -> Steps[Arms]:
    """Draw arms, and drop those of which the baselines are far from what the cell file says was measured.

    Args:
        plan: whose arm it is.
        cell: what is known of the arm.
        count: how many sets are drawn.
        seed: of the sets.
        vary: whether what is held by itself is varied, too: corner, acceleration, smoothing, tool centre point.
        block: sets in a step.
        machines: where.

    Raises:
        InputError: no sets, or none that fits.
    """
    sets = drawn(count, seed, cell.ranges, vary=HELD if vary else (), held=held_for(plan.tool, cell))
    known = cell.conditioning
    if known is None:
        return Arms(tuple(sets), count)
    ids = {hole.hole.id for hole in plan.holes}
    of_plan = {hole: deviation for hole, deviation in known.baseline.items() if hole in ids}
    if of_plan:
        manner = Manner(feed=known.feed, corner=known.corner)
        sets = yield from _near(plan, sets, of_plan, manner, known.factor, block, machines)
    return Arms(tuple(sets), count, len(of_plan))


def conditioned(
    plan: Plan,
    sets: Sequence[ParameterSet],
    measured: Mapping[str, float],
    manner: Manner,
    *,
    factor: float = 2.0,
    machines: Machines = HERE,
) -> list[ParameterSet]:
    """The sets of which the baseline, by the encoders, is near what was measured.

    Args:
        plan: whose holes were measured.
        sets: to choose among.
        measured: deviation of the baseline of some holes [m], by id.
        manner: in which it was measured.
        factor: by which it may be off at each hole.
        machines: where.

    Raises:
        InputError: a hole that the plan does not have, or no set that fits.
    """
    return finished(_near(plan, sets, measured, manner, factor, BLOCK, machines))


def _near(
    plan: Plan,
    sets: Sequence[ParameterSet],
    measured: Mapping[str, float],
    manner: Manner,
    factor: float,
    block: int,
    machines: Machines,
) -> Steps[list[ParameterSet]]:
    ids = {hole.hole.id for hole in plan.holes}
    for name in measured:
        if name not in ids:
            raise InputError(f"no hole '{name}' in the plan", where="baseline_mm", accepted=", ".join(sorted(ids)))
    kept = replace(plan, holes=tuple(hole for hole in plan.holes if hole.hole.id in measured))
    fits = np.ones(len(sets), dtype=bool)
    for found in study(kept, sets, manner=manner, motions=("baseline",), machines=machines, block=block, growing=True):
        if isinstance(found, HoleStudy) and found.sets == len(sets):
            ratio = found.deviation[found.of("baseline"), 0] / measured[found.id]
            fits &= (ratio < factor) & (ratio > 1 / factor)
        yield
    if not fits.any():
        raise InputError(
            f"none of {len(sets)} sets has a baseline within a factor of {factor:g} of what was measured",
            where="baseline_mm",
            accepted="more sets, wider ranges, or what was measured in another manner",
        )
    return [each for each, fit in zip(sets, fits, strict=True) if fit]


def finished(steps: Steps[Result]) -> Result:
    """What work in steps comes to."""
    while True:
        try:
            next(steps)
        except StopIteration as end:
            found: Result = end.value
            return found
