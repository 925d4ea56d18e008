"""Random holes in random directions: is the exact optimum ever beaten, and is the answer the same in the mirror?

Every other hole has 0.9 to 0.995 of its deepest stroke, where what is feasible shrinks to slivers; the rest have a
random depth, beyond the deepest stroke, too.
"""

from __future__ import annotations

import time
from dataclasses import dataclass, field, replace

import numpy as np

import zerorev as zr
from benchmarks.arm_numpy import wrapped
from benchmarks.cases import NO_THRESHOLD, Answer, Case, drilled, exact, mirrored, random_place
from benchmarks.parts import Options
from benchmarks.peers.evolution import attack, evolution
from benchmarks.peers.objective import NumbaObjective, graded
from benchmarks.peers.swarm import swarm
from benchmarks.scorer import Verdict, compare, rescore, words
from benchmarks.table import Section
from zerorev.search.methods import BUDGET

__all__ = ["run"]

FIRST_SEED = 1_000
NEAR_DEEPEST, ANY_DEPTH = (0.9, 0.995), (0.002, 0.06)  # of the deepest stroke; [m]
WORTH_DRILLING = 2e-3  # [m] a place whose deepest stroke is less is passed over for the holes near their deepest
PEER_SEEDS = (0, 1)
NEAR = np.deg2rad(2.0)
SAME_DEPTH, SAME_TRAVEL = 1e-5, np.deg2rad(0.01)  # [m], [rad]
SAME_SPIN = SAME_TRAVEL


@dataclass
class Tally:
    """What has been seen so far."""

    holes: int = 0
    zero: int = 0
    positive: int = 0
    seconds: float = 0.0  # of the exact search
    peer_seconds: float = 0.0
    verdicts: dict[str, int] = field(default_factory=dict)
    beaten: list[str] = field(default_factory=list)
    depth_apart: float = 0.0
    travel_apart: float = 0.0
    same_spins: int = 0
    unlike: list[str] = field(default_factory=list)


def run(options: Options) -> Section:
    """Hole after hole."""
    near, anywhere, seed = Tally(), Tally(), FIRST_SEED
    while near.holes + anywhere.holes < options.holes:
        place, rng = random_place(seed), np.random.default_rng(seed)
        seed += 1
        tally = near if near.holes <= anywhere.holes else anywhere
        deepest, deepest_there = _deepest(place), _deepest(mirrored(place))
        if tally is near and deepest < WORTH_DRILLING:
            continue
        depth = deepest * rng.uniform(*NEAR_DEEPEST) if tally is near else rng.uniform(*ANY_DEPTH)
        tally.holes += 1
        tally.depth_apart = max(tally.depth_apart, abs(deepest - deepest_there))
        if abs(deepest - deepest_there) > SAME_DEPTH:
            tally.unlike.append(f"{place.hole.id}: {deepest * 1e3:.3f} mm deep, mirrored {deepest_there * 1e3:.3f} mm")
        _look_at(drilled(place, depth), tally)
        if (near.holes + anywhere.holes) % 20 == 0:
            print(f"  {near.holes + anywhere.holes} of {options.holes} holes", flush=True)
    rows = [_row("0.9 to 0.995 of the deepest stroke", near), _row("2 to 60 mm", anywhere)]
    return Section(
        name="holes",
        title="Random holes in random directions",
        columns=(
            "depth",
            "holes",
            "zero reversals",
            "one or more",
            "exact search, peers [s]",
            "peers' answers: worse / equal / between samples / better",
            "mirror: depth apart [mm]",
            "mirror: travel apart [deg]",
            "mirror: spins within 0.01°",
        ),
        rows=rows,
        notes=[
            f"The peers, {len(PEER_SEEDS)} seeds each: the Numba swarm with the thesis' settings; SciPy's evolution on"
            f" samples that crowd at the ends of the legs, from anywhere and from within ±{np.rad2deg(NEAR):g}° of"
            " the exact answer. And, once, the exact search on each branch alone. *Between samples*: looks better by"
            " the scorer's 40,001 samples, but has reversals between them. The exact search runs twice a hole,"
            " once in the mirror."
        ],
        failures=[*near.beaten, *anywhere.beaten, *near.unlike, *anywhere.unlike],
        figures={"near_deepest": vars(near), "any_depth": vars(anywhere)},
    )


def _look_at(case: Case, tally: Tally) -> None:
    """One hole: the exact answer, the same in the mirror, and what the peers find."""
    began = time.process_time()
    ours, there = exact(case), exact(mirrored(case))
    tally.seconds += time.process_time() - began
    our_score = None if ours is None else rescore(case, ours)
    if ours is not None and our_score is not None:
        tally.zero += our_score.reversals == 0
        tally.positive += our_score.reversals > 0
        if our_score.wrong:
            tally.beaten.append(f"{case.hole.id}: the exact answer itself meets a {our_score.wrong}")
    _compare_mirrored(case, ours, there, tally)
    for seed in PEER_SEEDS:
        began = time.process_time()
        answers = _peers(case, ours, seed)
        tally.peer_seconds += time.process_time() - began
        if seed == PEER_SEEDS[0]:
            answers |= _branch_by_branch(case)
        for name, answer in answers.items():
            score = rescore(case, answer)
            verdict: Verdict = compare(case, answer, score, our_score)
            tally.verdicts[verdict] = tally.verdicts.get(verdict, 0) + 1
            if verdict == "better":
                where = f"{case.hole.id}, {case.hole.depth * 1e3:.3f} mm"
                tally.beaten.append(f"{where}: {name}, seed {seed}, has {words(score)}, zerorev {words(our_score)}")


def _peers(case: Case, ours: Answer | None, seed: int) -> dict[str, Answer]:
    crowded = NumbaObjective(case, graded())
    answers = {"swarm": swarm(NumbaObjective(case), seed), "evolution": evolution(crowded, seed)}
    if ours is not None:
        answers["evolution from ours"] = attack(crowded, ours, seed, NEAR, BUDGET // 2)
    return answers


def _branch_by_branch(case: Case) -> dict[str, Answer]:
    """The exact search against itself: on all branches at once it must find what it finds on each alone."""
    alone = {branch: exact(replace(case, hole=replace(case.hole, branch=branch))) for branch in range(8)}
    return {f"zerorev on branch {branch} alone": found for branch, found in alone.items() if found is not None}


def _compare_mirrored(case: Case, ours: Answer | None, there: Answer | None, tally: Tally) -> None:
    """The answer for the mirrored hole must be as good; that it is this very motion, mirrored, is counted."""
    if ours is None or there is None:
        if ours is not there:
            tally.unlike.append(f"{case.hole.id}: a motion on one side of the mirror alone")
        return
    score, score_there = rescore(case, ours), rescore(mirrored(case), there)
    apart = abs(score.travel - score_there.travel)
    if score.reversals != score_there.reversals or not apart <= SAME_TRAVEL:
        tally.unlike.append(
            f"{case.hole.id}, {case.hole.depth * 1e3:.3f} mm: {score.reversals} reversals,"
            f" {np.rad2deg(score.travel):.3f} deg, mirrored {score_there.reversals},"
            f" {np.rad2deg(score_there.travel):.3f} deg"
        )
    else:
        tally.travel_apart = max(tally.travel_apart, apart)
        tally.same_spins += _spins_apart(ours, there) <= SAME_SPIN


def _spins_apart(ours: Answer, there: Answer) -> float:
    """Greatest difference of the spins [rad] from those in the mirror, where either leg may be the plunge."""
    sums = (ours.profile.psi + psi for psi in (there.profile.psi, there.profile.psi[::-1]))
    return min(float(np.abs(wrapped(each)).max()) for each in sums)


def _deepest(place: Case) -> float:
    return zr.deepest_stroke(place.robot, place.tool, place.hole, NO_THRESHOLD).depth


def _row(depth: str, tally: Tally) -> tuple[str, ...]:
    counts = " / ".join(f"{tally.verdicts.get(v, 0)}" for v in ("worse", "equal", "between samples", "better"))
    apart = f"{tally.depth_apart * 1e3:.1g}", f"{np.rad2deg(tally.travel_apart):.1g}", f"{tally.same_spins}"
    seconds = f"{tally.seconds:.0f}, {tally.peer_seconds:.0f}"
    return depth, f"{tally.holes}", f"{tally.zero}", f"{tally.positive}", seconds, counts, *apart
