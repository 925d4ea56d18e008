"""Many possible arms on a plan: how far the tip strays, and what the plan gains, as ranges.

What is reported are medians with the 5th and 95th percentile over the sets of parameters; no single set is a
prediction. The deviation is the thesis' (§5.3): the greatest distance across the axis from the mean path, half a stroke
of path on either side of the turn. By the encoders, as a controller's trace has it, and at the tool, which none sees.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import NamedTuple

import numpy as np

from zerorev.cell.followed import Followed, dynamics_of
from zerorev.cell.hole_estimate import THROUGH, calibrated_axis
from zerorev.cell.motions import MOTIONS, MotionName, compared
from zerorev.cell.parameters import ParameterSet
from zerorev.cell.plant import run
from zerorev.cell.reference import Manner
from zerorev.cell.run_figures import KEPT, RunFigures, run_figures
from zerorev.model._arrays import Array
from zerorev.model.plan import HolePlan, Plan
from zerorev.workers import HERE, Machines, Workers

__all__ = ["BLOCK", "ENDS", "SIDES", "Band", "HoleStudy", "band", "study"]

SIDES = ("encoder", "tool")
ENDS = ("entry", "exit")
BLOCK = 25  # sets that a worker is given at a time
QUANTILES = (0.05, 0.5, 0.95)
ALONG = ("profile", "torque")  # figures along the path, of which the quantiles are kept


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
        position: how far the drilled hole is off, across its axis [m], shape (M, sets).
        tilt: of the hole [rad], likewise.
        ovality: of the hole [m], shape (M, 2, sets): at its entry and exit.
        profile: distance from the mean path [m], shape (M, 2, 3, 201): 5th percentile, median, 95th along the path.
        torque: of the drives [N m], shape (M, 6, 3, 201): likewise.
        path: path distance of profile and torque over the stroke, -1 at its start, 0 at the turn, 1 at its end, (201,).
        speed: of the tip that is reached [m/s], shape (M,).
    """

    id: str
    motions: tuple[MotionName, ...]
    deviation: Array
    vertical: Array
    offset: Array
    swing: Array
    position: Array
    tilt: Array
    ovality: Array
    profile: Array
    torque: Array
    path: Array
    speed: Array

    @property
    def sets(self) -> int:
        """How many sets of parameters it is of."""
        return int(self.deviation.shape[-1])

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
    block: int = BLOCK,
    growing: bool = False,
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
        block: how many sets a worker is given at a time; the study is the same.
        growing: give out what is known of a hole after each block, too, of the sets until then.

    Yields:
        the study of a hole, or its id and why there is none.

    Raises:
        InputError: the robot has no dynamics.
    """
    manner, known = manner or Manner(), known or {}
    names = tuple(name for name in MOTIONS if name in {"baseline", "plan", *motions})
    dynamics_of(plan.robot)
    blocks = [tuple(sets[start : start + block]) for start in range(0, len(sets), block)]
    wanted = [hole for hole in plan.holes if hole.hole.id not in known and _why_not(hole) is None]
    tasks = [(hole, each) for hole in wanted for each in blocks]
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
            parts: list[_Part] = []
            for number, part in enumerate(itertools.islice(answers, len(blocks)), start=1):
                parts += [] if part is None else [part]
                done += 1
                if progress:
                    progress(done, len(tasks))
                if parts and (growing or number == len(blocks)):
                    yield _joined(hole.hole.id, parts)
            if not parts:
                yield hole.hole.id, "the same hole with constant spin cannot be run"


def _why_not(hole: HolePlan) -> str | None:
    if hole.motion is None:
        return "it has no motion"
    if hole.strokes:
        return f"it is drilled in {len(hole.strokes)} strokes, each of which is simulated for itself"
    return None if hole.verified is not None and hole.verified.passed else "its motion did not pass the check"


class _Part(NamedTuple):
    """What some sets did: the motions, `RunFigures` with motions and sets first, (M, sets, ...), and the speeds."""

    motions: tuple[MotionName, ...]
    figures: RunFigures
    speed: Array


def _block(
    plan: Plan,
    names: tuple[MotionName, ...],
    manner: Manner,
    thrust: float,
    task: tuple[HolePlan, tuple[ParameterSet, ...]],
) -> _Part | None:
    """Some sets at one hole, or None where it cannot be run; sets that ask for the same manner share references."""
    hole, sets = task
    references: dict[Manner, tuple[Mapping[MotionName, Followed], Mapping[MotionName, Array]]] = {}
    rows = []
    for each in sets:
        asked = each.manner(manner)
        if asked not in references:
            found = compared(plan, hole, asked, names)
            references[asked] = found.followed, found.shift
        followed, shift = references[asked]
        if not {"baseline", "plan"} <= followed.keys():
            return None
        axis = calibrated_axis(followed["baseline"], each)
        rows.append([
            run_figures(run(followed[name], each, shift=shift.get(name), thrust=_thrust(followed[name], thrust)), axis)
            for name in names
            if name in followed
        ])  # fmt: skip
    followed = next(iter(references.values()))[0]
    motions = tuple(name for name in names if name in followed)
    figures = RunFigures(*(
        np.array([[getattr(one, figure) for one in row] for row in rows]).swapaxes(0, 1)
        for figure in RunFigures._fields
    ))  # fmt: skip
    return _Part(motions, figures, np.array([followed[name].speed for name in motions]))


def _thrust(reference: Followed, thrust: float) -> Array | None:
    """The force on the drill at the nodes [N]: while it plunges into the stroke, until it is through."""
    if thrust == 0:
        return None
    depth = reference.drilling.hole.depth
    cutting = (np.arange(reference.standoff.size) < reference.turn) & (reference.standoff < depth)
    return np.where(cutting & (reference.standoff > THROUGH), thrust, 0.0)


def _joined(hole_id: str, parts: list[_Part]) -> HoleStudy:
    figures = RunFigures(
        *(np.concatenate(each, axis=1) for each in zip(*(part.figures for part in parts), strict=True))
    )
    along = {name: np.moveaxis(np.quantile(getattr(figures, name), QUANTILES, axis=1), 0, 2) for name in ALONG}
    others = {name: np.moveaxis(getattr(figures, name), 1, -1) for name in RunFigures._fields if name not in ALONG}
    return HoleStudy(hole_id, parts[0].motions, **others, **along, path=KEPT, speed=parts[0].speed)
