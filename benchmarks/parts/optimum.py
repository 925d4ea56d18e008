"""The exact optimum of one hole against swarms and evolutions, at the three positions of the thesis."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass
from functools import partial

import numpy as np

from benchmarks.cases import Answer, Case, exact, positions
from benchmarks.parts import Options
from benchmarks.peers.evolution import attack, evolution
from benchmarks.peers.objective import NumbaObjective, NumpyObjective, Objective, graded
from benchmarks.peers.pymoo_swarm import pymoo_swarm
from benchmarks.peers.swarm import swarm
from benchmarks.scorer import SAMPLES, Rescored, Verdict, compare, located_reversals, rescore, words
from benchmarks.table import Goal, Section
from benchmarks.timing import Timed, duration, in_turns

__all__ = ["run"]

OURS = "zerorev, exact"
NEAR = np.deg2rad(2.0)


@dataclass(frozen=True)
class Outcome:
    """What one method made of one hole, with all of its seeds.

    Attributes:
        timed: its answers.
        counted: reversals as the method itself counts them; None for the exact search.
        scores: as rescored.
        located: reversals between the samples, too.
        verdicts: against the exact answer.
        examined: motions, a seed.
    """

    timed: Timed[Answer]
    counted: list[int] | None
    scores: list[Rescored]
    located: list[float]
    verdicts: list[Verdict]
    examined: int

    @property
    def travel_deg(self) -> list[float]:
        """Of the answers that have zero reversals, located ones included."""
        return [float(np.rad2deg(s.travel)) for s, n in zip(self.scores, self.located, strict=True) if n == 0]


def run(options: Options) -> Section:
    """Run every method with every seed at every position, and rescore what comes out."""
    outcomes = {case.hole.id: _outcomes(case, options) for case in positions()}
    failures = [failure for hole, methods in outcomes.items() for failure in _failures(hole, methods)]
    exact_times = [methods[OURS].timed.median for methods in outcomes.values()]
    ratios = [methods["Numba swarm"].timed.median / methods[OURS].timed.median for methods in outcomes.values()]
    return Section(
        name="optimum",
        title="One hole, the exact straight-leg optimum",
        columns=(
            "hole, method",
            "zero: as it counts",
            "as rescored",
            "as located",
            "best travel [deg]",
            "median travel [deg]",
            "motions examined",
            "median time",
            "ratio to exact",
        ),
        rows=[
            (f"{hole}: {name}", *_row(outcome, methods[OURS].timed.median))
            for hole, methods in outcomes.items()
            for name, outcome in methods.items()
        ],
        notes=[
            f"{options.seeds} seeds. The objective of the peers is eq. 4.7 of the thesis at N = 200 steps on eight"
            " branches, psi within ±180°, the motion threshold off. The swarms have the thesis' settings (100"
            " particles, 50 iterations), the others as many motions to look at, or stop of their own accord.",
            "*Zero*: share of the seeds with zero reversals, as the method itself counts them, as rescored at N ="
            f" {SAMPLES:,}, and as `zerorev.evaluate` locates them between the samples; travel is of the"
            " last. The gap between the counts is reversals within the first step next to the target: samples overlook"
            " them, and least travel leads to them.",
            "*Crowded*: as many samples, but crowded at the ends of the legs, so that little is overlooked. *From"
            f" ours*: the same within ±{np.rad2deg(NEAR):g}° of the exact answer, which is in its first population; it"
            " is there to find something better.",
        ],
        goals=[
            Goal(
                "one hole, exact straight-leg optimum, never worse than any peer's best seed",
                "Numba swarm 560 ms; NumPy swarm 2.3 s; thesis 280 s",
                "10 ms",
                " / ".join(duration(time) for time in exact_times)
                + " at positions 1 / 2 / 3; Numba swarm × "
                + " / ".join(f"{ratio:.0f}" for ratio in ratios)
                + ("; does not hold, see below" if failures else "; never beaten"),
            )
        ],
        failures=failures,
        figures={
            f"{hole}, {name}": {**asdict(outcome), "timed": outcome.timed.seconds}
            for hole, methods in outcomes.items()
            for name, outcome in methods.items()
        },
    )


def _outcomes(case: Case, options: Options) -> dict[str, Outcome]:
    timed, objectives = _answers(case, options)
    ours = rescore(case, timed[OURS].values[0])
    found = {}
    for name, each in timed.items():
        objective, scores = objectives.get(name), [rescore(case, answer) for answer in each.values]
        found[name] = Outcome(
            each,
            None if objective is None else [objective.reversals(answer) for answer in each.values],
            scores,
            [located_reversals(case, answer) for answer in each.values],
            [compare(case, answer, score, ours) for answer, score in zip(each.values, scores, strict=True)],
            0 if objective is None else objective.evaluations // (options.seeds + 1),
        )
    return found


def _failures(hole: str, methods: dict[str, Outcome]) -> Iterator[str]:
    ours = methods[OURS].scores[0]
    if ours.wrong or ours.reversals:
        yield f"{hole}: the exact answer itself has {words(ours)}"
    for name, outcome in methods.items():
        for seed, (score, verdict) in enumerate(zip(outcome.scores, outcome.verdicts, strict=True)):
            if verdict == "better":
                yield f"{hole}: {name}, seed {seed}, has {words(score)}, zerorev {words(ours)}"


def _answers(case: Case, options: Options) -> tuple[dict[str, Timed[Answer]], dict[str, Objective]]:
    """Every method's answers, one a seed, and the objectives of the peers."""
    crowded = {
        name: NumbaObjective(case, graded()) for name in ("SciPy evolution, crowded", "SciPy evolution, from ours")
    }
    objectives: dict[str, Objective] = {
        "Numba swarm": NumbaObjective(case),
        "NumPy swarm": NumpyObjective(case),
        "SciPy evolution": NumbaObjective(case),
        "pymoo swarm": NumbaObjective(case),
        **crowded,
    }
    ours = _exact(case)
    methods: dict[str, Callable[[Objective, int], Answer]] = {
        "Numba swarm": swarm,
        "NumPy swarm": swarm,
        "SciPy evolution": evolution,
        "pymoo swarm": pymoo_swarm,
        "SciPy evolution, crowded": evolution,
        "SciPy evolution, from ours": lambda objective, seed: attack(objective, ours, seed, NEAR),
    }
    work: dict[str, Callable[[int], Answer]] = {OURS: lambda _: _exact(case)}
    work |= {name: partial(method, objectives[name]) for name, method in methods.items()}
    return in_turns(work, options.seeds), objectives


def _exact(case: Case) -> Answer:
    found = exact(case)
    if found is None:
        raise RuntimeError(f"the search finds no motion at {case.hole.id}")
    return found


def _row(outcome: Outcome, ours: float) -> list[str]:
    seeds, travel, median = len(outcome.scores), outcome.travel_deg, outcome.timed.median
    rescored = sum(not score.wrong and score.reversals == 0 for score in outcome.scores)
    return [
        "" if outcome.counted is None else f"{outcome.counted.count(0) / seeds:.0%}",
        f"{rescored / seeds:.0%}",
        f"{len(travel) / seeds:.0%}",
        f"{min(travel):.3f}" if travel else "none",
        f"{np.median(travel):.3f}" if travel else "none",
        f"{outcome.examined:,}" if outcome.examined else "",
        duration(median),
        f"{median / ours:.1f}",
    ]
