"""How often a proof decides, and how soon: `python -m benchmarks.proof_study`.

Random and hostile holes are proven with budgets of boxes, their deepest strokes bounded, and the bound is driven up on
others without any motion to begin with, to be held against what the search by valleys has found. Prints the figures of
docs/benchmarks.md; takes some minutes.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from benchmarks.problems import hostile_problem, random_problem
from zerorev.search.bounds.proof import prove
from zerorev.search.deepest import deepest_of
from zerorev.search.exact import search
from zerorev.search.optimum import deepest_as_drilled

FIRST_SEED, FIRST_HOSTILE, FIRST_ALONE = 8_000, 20_000, 30_000
BUDGETS = (100_000, 1_000_000)  # boxes: the default, and some 10 s
DEPTH_BOXES = 100_000
ALONE_BOXES = 50_000
ROUNDING = 1e-9  # relative: the travel of a motion is a sum of angles


class Proven(NamedTuple):
    """The proof of one hole; times in seconds of one core."""

    hole: str
    first: bool  # whether there was a first answer
    seconds: tuple[float, ...]
    boxes: int
    fewest: tuple[bool, ...]
    gap: tuple[float | None, ...]  # None: no motion, or none that keeps the threshold
    proven: tuple[bool, ...]
    better: bool  # than the first answer, by 0.1 % or a reversal


class Bounded(NamedTuple):
    """The deepest stroke of one hole, and how much deeper one could be; times in seconds of one core."""

    hole: str
    seconds: float
    above: float | None  # relative; None: not decided, or there is no stroke
    none: bool  # whether it is proven that there is no stroke
    found: bool  # whether the proof has found a deeper one, by 0.1 %


def proven(make: Callable[[int], Any], seed: int) -> Proven:
    """Prove one hole within each budget, the smaller ones first; what is proven already is not proven again."""
    problem = make(seed)
    first = search(problem.drilling, problem.settings)
    seconds, rows, boxes, best = [], [], 0, first
    for budget in BUDGETS:
        if not rows or not rows[-1].proven:
            began = time.process_time()
            proof = prove(problem, first, budget)
            seconds.append(time.process_time() - began)
            boxes, best = proof.boxes, proof.best
            rows.append(proof.optimality)
        else:
            seconds.append(seconds[-1])
            rows.append(rows[-1])
    order = problem.order
    better = best is not None and (
        first is None
        or order.reversals(best) < order.reversals(first)
        or (best.keeps_threshold, -best.score.travel) > (first.keeps_threshold, -first.score.travel * (1 - 1e-3))
    )
    fewest = tuple(best is None or one.reversals_at_least >= order.reversals(best) for one in rows)
    return Proven(
        problem.drilling.hole.id, first is not None, tuple(seconds), boxes, fewest, tuple(one.gap for one in rows),
        tuple(one.proven for one in rows), better,
    )  # fmt: skip


def bounded(seed: int) -> Bounded:
    """Bound the deepest stroke of one random hole, as a plan does it: a deeper one that is found is bounded in turn."""
    problem = random_problem(seed)
    drilling, settings = problem.drilling, problem.settings
    known = deepest_of(drilling, settings).depth
    began = time.process_time()
    found = deepest_as_drilled(drilling, replace(settings, proof_boxes=DEPTH_BOXES))
    seconds = time.process_time() - began
    above = found.at_most / found.depth - 1 if found.at_most is not None and found.depth > 0 else None
    none = found.at_most is not None and found.depth == 0
    return Bounded(drilling.hole.id, seconds, above, none, found.depth > known * (1 + 1e-3))


def alone(seed: int) -> tuple[bool, float | None]:
    """Whether a bound that was driven up without a motion passes what another search has; the share it reaches."""
    problem = random_problem(seed)
    known = search(problem.drilling, problem.settings)
    optimality = prove(problem, None, ALONE_BOXES).optimality
    if known is None:
        return True, None
    cost = problem.order.reversals(known)
    if optimality.reversals_at_least > cost + ROUNDING:
        return False, None
    if optimality.travel_at_least is None or optimality.reversals_at_least < cost or not known.keeps_threshold:
        return True, None
    share = optimality.travel_at_least / known.score.travel
    return share <= 1 + ROUNDING, share


def _shares(rows: Sequence[Proven], budget: int) -> str:
    gaps = [row.gap[budget] for row in rows]
    within = [sum(row.proven[budget] or (g is not None and g <= most) for row, g in zip(rows, gaps, strict=True))
              for most in (1e-3, 5e-3)]  # fmt: skip
    seconds = [row.seconds[budget] for row in rows]
    return (
        f"{BUDGETS[budget]:,} boxes: fewest reversals proven on {sum(row.fewest[budget] for row in rows)},"
        f" travel to 0.1 % on {within[0]}, to 0.5 % on {within[1]} of {len(rows)};"
        f" median {np.median(seconds):.3f} s, 90 % {np.quantile(seconds, 0.9):.2f} s, greatest {max(seconds):.1f} s"
    )


def main() -> None:
    """Print the figures."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--random", type=int, default=200)
    parser.add_argument("--hostile", type=int, default=100)
    parser.add_argument("--depths", type=int, default=200)
    parser.add_argument("--alone", type=int, default=500)
    parser.add_argument("--workers", type=int, default=2)
    asked = parser.parse_args()
    with ProcessPoolExecutor(asked.workers) as pool:
        for name, make, first, count in (
            ("random", random_problem, FIRST_SEED, asked.random),
            ("hostile", hostile_problem, FIRST_HOSTILE, asked.hostile),
        ):
            seeds = range(first, first + count)
            rows = list(pool.map(proven, [make] * count, seeds))
            if not rows:
                continue
            for budget in range(len(BUDGETS)):
                print(f"{name}, {_shares(rows, budget)}", flush=True)
            print(f"{name}: a better motion on {[row.hole for row in rows if row.better]}")
            print(f"{name}: open {[(row.hole, row.gap[-1]) for row in rows if not row.proven[-1]]}", flush=True)
        depths = list(pool.map(bounded, range(FIRST_SEED, FIRST_SEED + asked.depths)))
        if depths:
            counts = [sum(d.none or (d.above is not None and d.above <= most * 1.01) for d in depths)
                      for most in (1e-3, 1e-2, 1e-1)]  # fmt: skip
            seconds = [d.seconds for d in depths]
            print(
                f"deepest stroke, {DEPTH_BOXES:,} boxes: within 0.1 / 1 / 10 % on {' / '.join(map(str, counts))} of"
                f" {len(depths)}; deeper ones found on {sum(d.found for d in depths)};"
                f" median {np.median(seconds):.2f} s, greatest {max(seconds):.1f} s"
            )
            undecided = [d.hole for d in depths if d.above is None and not d.none]
            print(f"deepest stroke, undecided: {undecided}", flush=True)
        found = list(pool.map(alone, range(FIRST_ALONE, FIRST_ALONE + asked.alone), chunksize=4))
        if found:
            shares = [share for _, share in found if share is not None]
            print(
                f"without a motion to begin with, {ALONE_BOXES:,} boxes: {sum(not sound for sound, _ in found)} of"
                f" {len(found)} bounds above what is known; to 0.1 % on {sum(s > 0.999 for s in shares)},"
                f" 1 % on {sum(s > 0.99 for s in shares)}; greatest share {max(shares, default=0.0):.7f}"
            )


if __name__ == "__main__":
    main()
