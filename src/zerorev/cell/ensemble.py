"""Many possible arms on a plan: how far the tip strays, and what the plan gains, as ranges.

What is reported are medians with the 5th and 95th percentile over the sets of parameters; no single set is a
prediction. The deviation is the thesis' (§5.3): the greatest distance across the axis from the mean path, half a stroke
of path on either side of the turn. By the encoders, as a controller's trace has it, and at the tool, which none sees.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import NamedTuple

import numpy as np

from zerorev.cell.motions import MOTIONS, MotionName, compared
from zerorev.cell.parameters import ParameterSet
from zerorev.cell.plant import Run, run
from zerorev.cell.reference import Followed, Manner
from zerorev.errors import InputError
from zerorev.model._arrays import Array
from zerorev.model.plan import HolePlan, Plan
from zerorev.workers import HERE, Machines, Workers

__all__ = ["POINTS", "SIDES", "Band", "HoleStudy", "band", "conditioned", "deviations", "study"]

SIDES = ("encoder", "tool")
POINTS = 801  # of the mean path, evenly by path distance
KEPT_POINTS = 201  # of a profile that is kept
BLOCK = 25  # sets that a worker is given at a time
QUANTILES = (0.05, 0.5, 0.95)
THRUST_ENDS = 2e-3  # [m] before the turn: the drill is through


class Band(NamedTuple):
    """Median, 5th and 95th percentile over the sets."""

    median: float
    low: float
    high: float


@dataclass(frozen=True)
class HoleStudy:
    """What the sets did at one hole.

    Attributes:
        id: of the hole.
        motions: that could be run, M of them.
        deviation: greatest in the window [m], shape (M, 2, sets): encoder and tool.
        vertical: of it the part along Z of the base [m], likewise.
        offset: distance of the mean path from the commanded one [m], likewise.
        swing: greatest less least torque of the drives in the window [N m], shape (M, 6, sets).
        profile: distance from the mean path [m], shape (M, 2, 3, 201): 5th percentile, median, 95th along the path.
        path: path distance of the profile over the stroke, -1 to 1, shape (201,).
        speed: of the tip that is reached [m/s], shape (M,).
    """

    id: str
    motions: tuple[MotionName, ...]
    deviation: Array
    vertical: Array
    offset: Array
    swing: Array
    profile: Array
    path: Array
    speed: Array

    def of(self, motion: MotionName) -> int:
        """Row of a motion."""
        return self.motions.index(motion)

    def gain(self, motion: MotionName = "plan") -> Array:
        """Less deviation than the baseline, as a share of it, shape (2, sets): encoder and tool."""
        base, other = self.deviation[self.of("baseline")], self.deviation[self.of(motion)]
        return np.asarray(1.0 - other / base)


def band(values: Array) -> Band:
    """Median, 5th and 95th percentile of a value per set."""
    low, median, high = np.quantile(values, QUANTILES)
    return Band(float(median), float(low), float(high))


def study(
    plan: Plan,
    sets: Sequence[ParameterSet],
    *,
    manner: Manner | None = None,
    thrust: float = 0.0,
    motions: tuple[MotionName, ...] = MOTIONS,
    machines: Machines = HERE,
    known: Mapping[str, HoleStudy] | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> Iterator[HoleStudy | tuple[str, str]]:
    """What each set does at each hole of a plan, hole by hole; the same for any number of workers.

    Args:
        plan: of a robot with dynamics.
        sets: of parameters.
        manner: of the controller.
        thrust: of the drill while it cuts [N].
        motions: to compare; baseline and plan are always among them.
        machines: where.
        known: holes that were studied before, which are not studied again.
        progress: called with (blocks done, blocks in all).

    Yields:
        the study of a hole, or its id and why there is none.

    Raises:
        InputError: the robot has no dynamics.
    """
    manner, known = manner or Manner(), known or {}
    names = tuple(name for name in MOTIONS if name in {"baseline", "plan", *motions})
    if plan.robot.dynamics is None:
        raise InputError(
            f"the masses of the robot {plan.robot.name} are not known, so that nothing can be simulated",
            where="robot",
            accepted="a robot file with dynamics: links, payload_kg",
        )
    blocks = [tuple(sets[k : k + BLOCK]) for k in range(0, len(sets), BLOCK)]
    wanted = [hole for hole in plan.holes if hole.hole.id not in known and _why_not(hole) is None]
    tasks = [(hole, block) for hole in wanted for block in blocks]
    done = 0
    if progress:
        progress(0, len(tasks))
    with Workers(partial(_block, plan, names, manner, thrust), machines) as workers:
        answers = workers.map(tasks, len(tasks))
        for hole in plan.holes:
            if hole.hole.id in known:
                yield known[hole.hole.id]
                continue
            if (why := _why_not(hole)) is not None:
                yield hole.hole.id, why
                continue
            parts = []
            for _ in blocks:
                parts.append(next(answers))
                done += 1
                if progress:
                    progress(done, len(tasks))
            if "baseline" not in parts[0].motions or "plan" not in parts[0].motions:
                yield hole.hole.id, "the same hole with constant spin cannot be run"
            else:
                yield _joined(hole.hole.id, parts)


def _why_not(hole: HolePlan) -> str | None:
    if hole.motion is None:
        return "it has no motion"
    return None if hole.verified is not None and hole.verified.passed else "its motion did not pass the check"


class _Part(NamedTuple):
    """What some sets did: as `HoleStudy`, but whole profiles, shape (M, 2, sets, 201)."""

    motions: tuple[MotionName, ...]
    deviation: Array
    vertical: Array
    offset: Array
    swing: Array
    profile: Array
    speed: Array


def _block(
    plan: Plan,
    names: tuple[MotionName, ...],
    manner: Manner,
    thrust: float,
    task: tuple[HolePlan, tuple[ParameterSet, ...]],
) -> _Part:
    """Some sets at one hole; references are shared by the sets that ask for the same manner."""
    hole, sets = task
    references: dict[Manner, tuple[Mapping[MotionName, Followed], Mapping[MotionName, Array]]] = {}
    rows = []
    for each in sets:
        asked = each.manner(manner)
        if asked not in references:
            found = compared(plan, hole, asked, names)
            references[asked] = found.followed, found.shift
        followed, shift = references[asked]
        rows.append([
            _measured(run(followed[name], each, shift=shift.get(name), thrust=_thrust(followed[name], thrust)))
            for name in names
            if name in followed
        ])  # fmt: skip
    followed = next(iter(references.values()))[0]
    motions = tuple(name for name in names if name in followed)
    deviation, vertical, offset, swing, profile = (
        np.array([[getattr(one, figure) for one in row] for row in rows]) for figure in _Measured._fields
    )
    return _Part(
        motions,
        np.moveaxis(deviation, 0, -1),
        np.moveaxis(vertical, 0, -1),
        np.moveaxis(offset, 0, -1),
        np.moveaxis(swing, 0, -1),
        np.moveaxis(profile, 0, 2),
        np.array([followed[name].speed for name in motions]),
    )


def _thrust(reference: Followed, thrust: float) -> Array | None:
    """The force on the drill at the nodes [N]: while it plunges into the stroke, until it is through."""
    if thrust == 0:
        return None
    depth = reference.drilling.hole.depth
    cutting = (np.arange(reference.standoff.size) < reference.turn) & (reference.standoff < depth)
    return np.where(cutting & (reference.standoff > THRUST_ENDS), thrust, 0.0)


class _Measured(NamedTuple):
    """Of one run: (2,) each, encoder and tool, the swing (6,), the profile (2, 201)."""

    deviation: Array
    vertical: Array
    offset: Array
    swing: Array
    profile: Array


def _measured(done: Run) -> _Measured:
    window = 0.5 * float(done.reference.drilling.hole.depth - done.reference.standoff.min())
    path, figures = deviations(done)
    inside = np.abs(path) <= window
    greatest, vertical, offset, kept = [], [], [], []
    for lateral in figures:
        mean = lateral.mean(axis=0)
        apart = lateral - mean
        distance = np.linalg.norm(apart, axis=1)
        greatest.append(distance[inside].max())
        vertical.append(np.abs(apart[inside, 2]).max())
        offset.append(np.linalg.norm(mean))
        kept.append(distance[:: (POINTS - 1) // (KEPT_POINTS - 1)])
    nodes = np.abs(done.reference.path) <= window
    swing = np.ptp(done.drive[nodes], axis=0)
    return _Measured(np.array(greatest), np.array(vertical), np.array(offset), swing, np.array(kept))


def deviations(done: Run) -> tuple[Array, tuple[Array, Array]]:
    """Deviation across the axis along a run, resampled evenly by path distance.

    Args:
        done: a run.

    Returns:
        path distance [m], 0 at the turn, shape (801,); the deviation by the encoders and of the tool [m], base frame,
        each (801, 3).
    """
    own = done.reference.path
    grid = np.linspace(own[0], own[-1], POINTS)
    d = done.reference.drilling.hole.direction
    found = []
    for deviation in (done.encoder, done.tool):
        lateral = deviation - np.outer(deviation @ d, d)
        found.append(np.stack([np.interp(grid, own, lateral[:, k]) for k in range(3)], axis=1))
    return grid, (found[0], found[1])


def _joined(hole_id: str, parts: list[_Part]) -> HoleStudy:
    deviation, vertical, offset, swing = (
        np.concatenate([getattr(part, name) for part in parts], axis=-1)
        for name in ("deviation", "vertical", "offset", "swing")
    )
    profiles = np.concatenate([part.profile for part in parts], axis=2)
    profile = np.moveaxis(np.quantile(profiles, QUANTILES, axis=2), 0, 2)
    return HoleStudy(
        hole_id, parts[0].motions, deviation, vertical, offset, swing, profile, np.linspace(-1.0, 1.0, KEPT_POINTS),
        parts[0].speed,
    )  # fmt: skip


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
    ids = {hole.hole.id for hole in plan.holes}
    for name in measured:
        if name not in ids:
            raise InputError(f"no hole '{name}' in the plan", where="baseline_mm", accepted=", ".join(sorted(ids)))
    kept = replace(plan, holes=tuple(hole for hole in plan.holes if hole.hole.id in measured))
    fits = np.ones(len(sets), dtype=bool)
    for found in study(kept, sets, manner=manner, motions=("baseline",), machines=machines):
        if isinstance(found, HoleStudy):
            ratio = found.deviation[found.of("baseline"), 0] / measured[found.id]
            fits &= (ratio < factor) & (ratio > 1 / factor)
    if not fits.any():
        raise InputError(
            f"none of {len(sets)} sets has a baseline within a factor of {factor:g} of what was measured",
            where="baseline_mm",
            accepted="more sets, wider ranges, or what was measured in another manner",
        )
    return [each for each, fit in zip(sets, fits, strict=True) if fit]
