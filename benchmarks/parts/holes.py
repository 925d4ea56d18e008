"""Random holes in random directions: is the exact optimum ever beaten, and is the answer the same in the mirror?

Every other hole has 0.9 to 0.995 of its deepest stroke, where what is feasible shrinks to slivers; the rest have a
random depth, beyond the deepest stroke, too.
"""

from __future__ import annotations

import time
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass, field, replace
from functools import partial
from importlib.metadata import version
from typing import Any

import numpy as np

import zerorev as zr
from benchmarks.arm_numpy import wrapped
from benchmarks.cases import NO_THRESHOLD, Answer, Case, drilled, exact, mirrored, random_place
from benchmarks.finished import Finished
from benchmarks.parts import Options
from benchmarks.peers.evolution import attack, evolution
from benchmarks.peers.objective import NumbaObjective, graded
from benchmarks.peers.swarm import ITERATIONS, PARTICLES, swarm
from benchmarks.scorer import SAMPLES, Rescored, compare, rescore, words
from benchmarks.table import Section
from zerorev.thesis.methods import BUDGET
from zerorev.workers import Machines, Workers

__all__ = ["run"]

FIRST_SEED = 1_000
NEAR_DEEPEST, ANY_DEPTH = (0.9, 0.995), (0.002, 0.06)  # of the deepest stroke; [m]
WORTH_DRILLING = 2e-3  # [m] a place whose deepest stroke is less is passed over for the holes near their deepest
NEAR = float(np.deg2rad(2.0))
SAME_DEPTH, SAME_TRAVEL = 1e-5, float(np.deg2rad(0.01))  # [m], [rad]
SAME_SPIN = SAME_TRAVEL
SAME_HOLE, SAME_ANSWER = 1e-9, 1e-6  # [m], [rad] by which a hole that was finished before is known again


@dataclass(frozen=True)
class Hole:
    """One hole to be examined.

    Attributes:
        seed: of its place.
        near: whether its depth is near its deepest stroke.
        depth: [m].
        deepest: its deepest stroke, and that in the mirror [m].
    """

    seed: int
    near: bool
    depth: float
    deepest: tuple[float, float]

    @property
    def case(self) -> Case:
        """The hole, with robot and tool."""
        return drilled(random_place(self.seed), self.depth)


@dataclass
class Seen:
    """What was seen of one hole; numbers and words alone, as a line of JSON holds them.

    Attributes:
        seed: of its place.
        depth: [m].
        peer_seeds: with how many seeds each peer ran.
        ours: branch and spins [rad] of the exact answer, or None.
        reversals: of the exact answer.
        seconds: of the exact search, here and in the mirror.
        peer_seconds: of the peers.
        verdicts: on the peers' answers.
        travel_apart: of the exact answer from that in the mirror [rad].
        same_spins: whether it is the same motion, mirrored.
        beaten: where a peer is better.
        unlike: where the mirror is.
    """

    seed: int
    depth: float
    peer_seeds: int
    ours: list[float] | None
    reversals: float | None = None
    seconds: float = 0.0
    peer_seconds: float = 0.0
    verdicts: dict[str, int] = field(default_factory=dict)
    travel_apart: float = 0.0
    same_spins: bool = False
    beaten: list[str] = field(default_factory=list)
    unlike: list[str] = field(default_factory=list)


def run(options: Options) -> Section:
    """Hole after hole, or several at a time; those that an earlier run finished are taken from its file."""
    made_with = _made_with(options.peer_seeds)
    finished = Finished(options.folder / "holes.jsonl", made_with, key=lambda entry: entry["seed"])
    if finished.known:
        print(f"  resuming after {len(finished.known)} finished holes", flush=True)
    holes, seen = [], list[Seen]()

    def asked() -> Iterator[tuple[Hole, dict[str, Any] | None]]:
        for hole in _holes(options.holes):
            holes.append(hole)
            yield hole, finished.known.get(hole.seed)

    with Workers(partial(_look_at, options.peer_seeds), Machines(options.workers)) as processes:
        for each in processes.map(asked()):
            if asdict(each) != finished.known.get(each.seed):
                finished.add(asdict(each))
            seen.append(each)
            if len(seen) % 20 == 0:
                print(f"  {len(seen)} of {options.holes} holes", flush=True)
    finished.remove()
    examined = list(zip(holes, seen, strict=True))
    near, anywhere = ([each for each in examined if each[0].near is wanted] for wanted in (True, False))
    beaten = [text for one in seen for text in one.beaten]
    unlike = [text for hole, one in examined for text in (*_depths_unlike(hole), *one.unlike)]
    return Section(
        name="holes",
        title="Random holes in random directions",
        columns=(
            "depth",
            "holes",
            "seeds of each peer",
            "zero reversals",
            "one or more",
            "exact search, peers [s]",
            "peers' answers: worse / equal / between samples / better",
            "mirror: depth apart [mm]",
            "mirror: travel apart [deg]",
            "mirror: spins within 0.01°",
        ),
        rows=[_row("0.9 to 0.995 of the deepest stroke", near), _row("2 to 60 mm", anywhere)],
        notes=[
            f"The peers, {options.peer_seeds} seeds each at each hole: the Numba swarm with the thesis' settings;"
            " SciPy's evolution on samples that crowd at the ends of the legs, from anywhere and from within"
            f" ±{np.rad2deg(NEAR):g}° of the exact answer. And, once, the exact search on each branch alone. *Between"
            f" samples*: looks better by the scorer's {SAMPLES:,} samples, but has reversals between them. The exact"
            " search runs twice a hole, once in the mirror."
        ],
        failures=beaten + unlike,
        figures={"holes": [asdict(hole) | asdict(one) for hole, one in examined]},
    )


def _made_with(peer_seeds: int) -> dict[str, Any]:
    """What a finished hole depends on, but for the exact search, whose answer is examined again."""
    peers = {"particles": PARTICLES, "iterations": ITERATIONS, "budget": BUDGET, "near": NEAR, "samples": SAMPLES}
    return {"peer_seeds": peer_seeds, **peers, **{name: version(name) for name in ("zerorev", "numpy", "scipy")}}


def _holes(count: int) -> Iterator[Hole]:
    """So many holes, near their deepest strokes and of any depth by turns."""
    seed, found = FIRST_SEED, Counter[bool]()
    while found.total() < count:
        place, rng = random_place(seed), np.random.default_rng(seed)
        near = found[True] <= found[False]
        deepest, there = _deepest(place), _deepest(mirrored(place))
        if not near or deepest >= WORTH_DRILLING:
            depth = deepest * rng.uniform(*NEAR_DEEPEST) if near else rng.uniform(*ANY_DEPTH)
            found[near] += 1
            yield Hole(seed, near, depth, (deepest, there))
        seed += 1


def _look_at(peer_seeds: int, asked: tuple[Hole, dict[str, Any] | None]) -> Seen:
    """One hole: the exact answer, the same in the mirror, and what the peers find.

    Args:
        peer_seeds: of each peer.
        asked: the hole, and what an earlier run saw of it; that is kept where the exact answer is still the same.
    """
    hole, before = asked
    case = hole.case
    began = time.process_time()
    ours = exact(case)
    if before is not None and _is_the_same(hole, ours, Seen(**before)):
        return Seen(**before)
    there = exact(mirrored(case))
    seen = Seen(hole.seed, hole.depth, peer_seeds, None if ours is None else _numbers(ours))
    seen.seconds = time.process_time() - began
    our_score = None if ours is None else rescore(case, ours)
    if our_score is not None:
        seen.reversals = float(our_score.reversals)
        if our_score.wrong:
            seen.beaten.append(f"{case.hole.id}: the exact answer itself meets a {our_score.wrong}")
    _compare_mirrored(case, ours, there, seen)
    for name, answer in _branch_by_branch(case).items():
        _judge(case, name, answer, our_score, seen)
    for seed in range(peer_seeds):
        began = time.process_time()
        answers = _peers(case, ours, seed)
        seen.peer_seconds += time.process_time() - began
        for name, answer in answers.items():
            _judge(case, f"{name}, seed {seed},", answer, our_score, seen)
    return seen


def _is_the_same(hole: Hole, ours: Answer | None, before: Seen) -> bool:
    """Whether an earlier run examined this very hole and found this very answer."""
    if ours is None or before.ours is None:
        return ours is before.ours
    same_answer = np.allclose(_numbers(ours), before.ours, rtol=0, atol=SAME_ANSWER)
    return bool(same_answer) and abs(hole.depth - before.depth) <= SAME_HOLE


def _numbers(answer: Answer) -> list[float]:
    return [float(answer.branch), *answer.profile.psi.tolist()]


def _judge(case: Case, who: str, answer: Answer, our_score: Rescored | None, seen: Seen) -> None:
    """Rescore a peer's answer and compare it with the exact one."""
    score = rescore(case, answer)
    verdict = compare(case, answer, score, our_score)
    seen.verdicts[verdict] = seen.verdicts.get(verdict, 0) + 1
    if verdict == "better":
        where = f"{case.hole.id}, {case.hole.depth * 1e3:.3f} mm"
        seen.beaten.append(f"{where}: {who} has {words(score)}, zerorev {words(our_score)}")


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


def _compare_mirrored(case: Case, ours: Answer | None, there: Answer | None, seen: Seen) -> None:
    """The answer for the mirrored hole must be as good; that it is this very motion, mirrored, is counted."""
    if ours is None or there is None:
        if ours is not there:
            seen.unlike.append(f"{case.hole.id}: a motion on one side of the mirror alone")
        return
    score, score_there = rescore(case, ours), rescore(mirrored(case), there)
    apart = abs(score.travel - score_there.travel)
    if score.reversals != score_there.reversals or not apart <= SAME_TRAVEL:
        seen.unlike.append(
            f"{case.hole.id}, {case.hole.depth * 1e3:.3f} mm: {score.reversals} reversals,"
            f" {np.rad2deg(score.travel):.3f} deg, mirrored {score_there.reversals},"
            f" {np.rad2deg(score_there.travel):.3f} deg"
        )
    else:
        seen.travel_apart, seen.same_spins = float(apart), _spins_apart(ours, there) <= SAME_SPIN


def _spins_apart(ours: Answer, there: Answer) -> float:
    """Greatest difference of the spins [rad] from those in the mirror, where either leg may be the plunge."""
    sums = (ours.profile.psi + psi for psi in (there.profile.psi, there.profile.psi[::-1]))
    return min(float(np.abs(wrapped(each)).max()) for each in sums)


def _deepest(place: Case) -> float:
    return zr.deepest_stroke(place.robot, place.tool, place.hole, NO_THRESHOLD).depth


def _depths_unlike(hole: Hole) -> Iterator[str]:
    deepest, there = hole.deepest
    if abs(deepest - there) > SAME_DEPTH:
        yield f"random {hole.seed}: {deepest * 1e3:.3f} mm deep, mirrored {there * 1e3:.3f} mm"


def _row(depth: str, examined: Sequence[tuple[Hole, Seen]]) -> tuple[str, ...]:
    holes, seen = [hole for hole, _ in examined], [one for _, one in examined]
    verdicts = sum((Counter(one.verdicts) for one in seen), Counter())
    seeds = sorted({one.peer_seeds for one in seen})
    found = [one.reversals for one in seen if one.reversals is not None]
    depth_apart = max((abs(hole.deepest[0] - hole.deepest[1]) for hole in holes), default=0.0)
    return (
        depth,
        f"{len(seen)}",
        " to ".join(f"{count}" for count in sorted({seeds[0], seeds[-1]})) if seeds else "",
        f"{found.count(0)}",
        f"{len(found) - found.count(0)}",
        f"{sum(one.seconds for one in seen):.0f}, {sum(one.peer_seconds for one in seen):.0f}",
        " / ".join(f"{verdicts[v]}" for v in ("worse", "equal", "between samples", "better")),
        f"{depth_apart * 1e3:.1g}",
        f"{np.rad2deg(max((one.travel_apart for one in seen), default=0.0)):.1g}",
        f"{sum(one.same_spins for one in seen)}",
    )
