"""The largest tolerance of the part's placement within which a hole is certified: how long it takes to find."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np

import zerorev as zr
from benchmarks.cases import certified_holes
from benchmarks.parts import Options
from benchmarks.table import Goal, Section
from benchmarks.timing import duration, in_turns
from zerorev.verify.certificate.certify import certify_hole
from zerorev.verify.certificate.within import Tolerance, largest_within

__all__ = ["run"]

JOB = Path(__file__).parents[2] / "examples" / "jobs" / "thesis_positions.yaml"
FIRST_SEED, HOLES = 5_000, 50


def run(options: Options) -> Section:
    """The positions of the thesis and random holes, each certified before."""
    plan = zr.plan_job(zr.read_job(JOB))
    plan = replace(
        plan,
        holes=tuple(
            replace(hole, certificate=certify_hole(plan.robot, plan.tool, plan.settings, hole)) for hole in plan.holes
        ),
    )
    known = in_turns({hole.hole.id: partial(_largest, plan, hole) for hole in plan.holes}, options.rounds)
    count = min(HOLES, options.holes)
    holes = {
        plan.holes[0].hole.id: partial(_largest, plan, plan.holes[0])
        for plan in certified_holes(FIRST_SEED, count, zr.Settings())
    }
    found = in_turns(holes, 1)
    times = [each.median for each in found.values()]
    positions = [each.median for each in known.values()]
    return Section(
        name="tolerance",
        title="Certified for every placement of the part within a tolerance: the largest, per hole",
        columns=("hole", "certified within", "median time", "greatest time"),
        rows=[
            *(
                (name, _words(each.values[0]), duration(each.median), duration(max(each.seconds)))
                for name, each in known.items()
            ),
            (
                f"{count} random holes",
                _median(found[name].values[0] for name in found),
                duration(float(np.median(times))),
                duration(max(times)),
            ),
        ],
        notes=[
            f"Default settings, 10 mm per deg, {options.rounds} rounds (random holes: one). The certificate without a"
            " tolerance, which comes first, is not in the times. The time includes the search for a placement under"
            " which the motion is proven to fail."
        ],
        goals=[
            Goal(
                "the largest tolerance of the part's placement within which a hole is certified",
                "nobody",
                "0.5 s",
                " / ".join(map(duration, positions))
                + f" at positions 1 / 2 / 3; {duration(float(np.median(times)))} at the median of {count} random holes,"
                f" {duration(max(times))} at the slowest",
            )
        ],
        failures=[f"{name}: no tolerance" for name, each in known.items() if each.values[0].within is None],
        figures={name: each.seconds for name, each in (known | found).items()},
    )


def _largest(plan: zr.Plan, hole: zr.HolePlan, _: int) -> Tolerance:
    return largest_within(plan.robot, plan.tool, plan.settings, plan.T_base_part, hole)


def _words(tolerance: Tolerance) -> str:
    within = tolerance.within
    return "none" if within is None else f"{within.position * 1e3:.4g} mm, {np.rad2deg(within.rotation):.4g} deg"


def _median(tolerances: Iterable[Tolerance]) -> str:
    sizes = [0.0 if each.within is None else each.within.position for each in tolerances]
    return f"{np.median(sizes) * 1e3:.3g} mm at the median"
