"""What the controller may be like: the sets whose baseline strays along the path as the recorded one does.

Gains of a controller show together, in how far the tip strays where joints reverse and how fast it comes back. No point
is fitted: of many sets those are kept whose deviation by the encoders is nearest to what was recorded, over the window
about the turn (§5.3 of the thesis), and their ranges are reported.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from zerorev.cell.ensemble import BLOCK
from zerorev.cell.followed import Followed
from zerorev.cell.motions import compared
from zerorev.cell.parameters import ParameterSet
from zerorev.cell.plant import run
from zerorev.cell.recordings.metrics import Metrics, metrics
from zerorev.cell.recordings.run import across, drilling_run
from zerorev.cell.recordings.tip import planned_hole
from zerorev.cell.reference import Manner
from zerorev.cell.run_figures import deviations
from zerorev.errors import InputError
from zerorev.model._arrays import Array
from zerorev.model.plan import HolePlan, Plan
from zerorev.model.ranges import RANGES, Range
from zerorev.model.recording import Recording
from zerorev.model.strokes import by_stroke
from zerorev.workers import HERE, Machines, Workers

__all__ = ["CONTROLLER", "Baseline", "Nearest", "baseline_of", "blocks_of", "controller_ranges", "nearest"]

CONTROLLER = ("bandwidth", "position_gain", "reset")
SHARE = 0.05  # of the sets are kept
FEWEST = 8
QUANTILES = (0.05, 0.5, 0.95)
FAR = 1.0  # of the recorded deviation, as a root of mean squares: sets that are all farther off explain nothing


@dataclass(frozen=True)
class Baseline:
    """What was recorded of the baseline of a hole.

    Attributes:
        hole: its id.
        measured: of the recording.
    """

    hole: str
    measured: Metrics


@dataclass(frozen=True)
class Nearest:
    """The sets that are kept.

    Attributes:
        sets: the nearest first.
        distance: of each from what was recorded, as a share of it, shape (K,).
        tried: how many there were.
    """

    sets: tuple[ParameterSet, ...]
    distance: Array
    tried: int


def baseline_of(recording: Recording, plan: Plan, corner: float | None = None) -> Baseline:
    """Of which hole of a plan a recording is, and what is measured of it.

    Args:
        recording: of one hole at constant spin.
        plan: whose hole it is.
        corner: radius of the blend with which it was run [m]; None: the plan's.

    Raises:
        InputError: of none, or sampled too slowly for its feed.
    """
    why = ""
    for hole in by_stroke(plan).holes:
        if hole.motion is None:
            continue
        try:
            planned = planned_hole(plan, hole.hole.id)
            done = drilling_run(recording, planned if corner is None else replace(planned, blend=corner))
        except InputError as error:
            why = error.what
            continue
        found = metrics(done)
        for finding in found.findings:
            if finding.kind == "sampling":
                raise InputError(
                    finding.message, where=recording.source, accepted="a baseline sampled faster, or run more slowly"
                )
        return Baseline(hole.hole.id, found)
    raise InputError(
        "the baseline of no hole of the plan" + (f": {why}" if len(plan.holes) == 1 else ""),
        where=recording.source, accepted="recordings of joints, of this plan's robot and tool, one hole each",
    )  # fmt: skip


def blocks_of(sets: int, baselines: int) -> int:
    """How many blocks of sets are simulated, for `progress`."""
    return baselines * -(-sets // BLOCK)


def nearest(
    plan: Plan,
    sets: Sequence[ParameterSet],
    baselines: Sequence[Baseline],
    manner: Manner,
    *,
    machines: Machines = HERE,
    progress: Callable[[int, int], None] | None = None,
) -> Nearest:
    """The sets of which the baseline strays most nearly as it was recorded.

    Args:
        plan: whose holes were run.
        sets: to choose among.
        baselines: as recorded, one or more.
        manner: in which they were run.
        machines: where.
        progress: called with (blocks done, blocks in all).

    Raises:
        InputError: no set is anywhere near.
    """
    blocks = [tuple(sets[k : k + BLOCK]) for k in range(0, len(sets), BLOCK)]
    tasks = [(each, block) for each in baselines for block in blocks]
    squares = np.zeros((len(baselines), len(sets)))
    with Workers(partial(_distances, plan, manner), machines) as workers:
        for n, found in enumerate(workers.map(tasks, len(tasks))):
            row, block = divmod(n, len(blocks))
            squares[row, block * BLOCK : block * BLOCK + len(found)] = found
            if progress:
                progress(n + 1, len(tasks))
    distance = np.sqrt(squares.mean(axis=0))
    if distance.min() > FAR:
        raise InputError(
            f"the nearest of {len(sets)} sets is {100 * distance.min():.0f} % off the recorded baseline",
            where=", ".join(each.hole for each in baselines),
            accepted="the feed and the corner that were run (--feed-mm-s, --corner-mm), or more sets (--sets)",
        )
    order = np.argsort(distance, kind="stable")[: max(round(SHARE * len(sets)), min(FEWEST, len(sets)))]
    return Nearest(tuple(sets[n] for n in order), distance[order], len(sets))


def _distances(plan: Plan, manner: Manner, task: tuple[Baseline, tuple[ParameterSet, ...]]) -> Array:
    """Mean square distance from a recorded baseline, as a share of its own mean square, shape (sets,)."""
    baseline, sets = task
    hole = next(each for each in plan.holes if each.hole.id == baseline.hole)
    references: dict[Manner, Followed] = {}
    measured = baseline.measured
    inside = np.abs(measured.path) <= measured.window
    path, wanted = measured.path[inside], (measured.lateral - measured.mean)[inside]
    found = []
    for each in sets:
        asked = each.manner(manner)
        if asked not in references:
            references[asked] = _reference(plan, hole, asked)
        own, (encoder, _) = deviations(run(references[asked], each))
        lateral = across(encoder - encoder.mean(axis=0), hole.hole.direction)
        there = np.stack([np.interp(path, own, lateral[:, n]) for n in range(2)], axis=1)
        found.append(np.mean((there - wanted) ** 2) / np.mean(wanted**2))
    return np.array(found)


def _reference(plan: Plan, hole: HolePlan, manner: Manner) -> Followed:
    found = compared(plan, hole, manner, ("baseline",)).followed
    if "baseline" not in found:
        raise InputError("the same hole with constant spin cannot be run", where=f"hole {hole.hole.id}")
    return found["baseline"]


def controller_ranges(found: Nearest, ranges: Mapping[str, Range], source: str) -> dict[str, Range]:
    """Median and 5 to 95 % of the kept sets for what the controller is like.

    Args:
        found: the kept sets.
        ranges: of all parameters, from which the sets were drawn.
        source: where the recordings come from.
    """
    result = {}
    for name in CONTROLLER:
        low, middle, high = np.quantile([each[name] for each in found.sets], QUANTILES)
        result[name] = replace(
            ranges.get(name, RANGES[name]), nominal=float(middle), low=float(low), high=float(high), source=source,
            basis="conditioned",
        )  # fmt: skip
    return result
