"""Search methods against each other: the same holes, the same objective, the same number of evaluations.

A method that looks at samples of a motion may settle where a joint turns round between two of them, and least travel
leads it there. So what a method finds is evaluated once more, exactly (`motion.evaluation`), and that counts.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from zerorev.errors import InputError
from zerorev.model.hole import Hole
from zerorev.model.job import Job
from zerorev.model.profile import Profile
from zerorev.motion.criteria import thesis_objective
from zerorev.motion.drilling import Drilling
from zerorev.motion.evaluation import evaluated
from zerorev.thesis.methods import BUDGET, Method, Outcome, SampledProblem, methods_named
from zerorev.thesis.sampled import SAMPLES, even_fractions

__all__ = ["Comparison", "Rescored", "Summary", "compare", "comparison", "runs", "wilson"]

LEAST_BUDGET = 400  # two generations of the largest swarm
WORST = 1.0  # score where there is no motion (thesis sec. 4.3)
CONFIDENT = 1.959963984540054  # standard deviations either way that hold 95 % of a normal distribution


@dataclass(frozen=True)
class Rescored:
    """One run of one method at one hole, its motion evaluated exactly.

    Attributes:
        hole: id.
        method: name.
        seed: None for a method without chance.
        outcome: as the method sees it; None where it found no motion at all.
        score: eq. 4.7 of the exact evaluation, 1 or more where the motion cannot be run.
        reversals: located ones; None where the motion cannot be run.
        travel: sum over the joints of the angle moved [rad]; None where the motion cannot be run.
        seconds: that the run took [s].
    """

    hole: str
    method: str
    seed: int | None
    outcome: Outcome | None
    score: float
    reversals: int | None
    travel: float | None
    seconds: float


@dataclass(frozen=True)
class Summary:
    """All runs of one method at one hole.

    Attributes:
        hole: id.
        method: name.
        runs: of it, in the order of the seeds.
        random: whether they depend on the seed.
    """

    hole: str
    method: str
    runs: tuple[Rescored, ...]
    random: bool

    @property
    def zero(self) -> int:
        """Runs that ended with zero reversals."""
        return sum(run.reversals == 0 for run in self.runs)

    @property
    def zero_sampled(self) -> int:
        """Runs that ended with zero reversals as the objective counts them, on its samples."""
        return sum(run.outcome is not None and run.outcome.reversals == 0 for run in self.runs)

    @property
    def interval(self) -> tuple[float, float] | None:
        """Of the share of runs with zero reversals, 95 % (Wilson); None for a method without chance."""
        return wilson(self.zero, len(self.runs)) if self.random else None

    @property
    def scores(self) -> list[float]:
        """Exact scores of all runs."""
        return [run.score for run in self.runs]

    @property
    def travels(self) -> list[float]:
        """Travel [rad] of the runs with zero reversals."""
        return [run.travel for run in self.runs if run.reversals == 0 and run.travel is not None]

    @property
    def first_zeros(self) -> list[int]:
        """Evaluations until the first motion without reversals on its samples, of the runs that came across one."""
        firsts = (run.outcome.first_zero for run in self.runs if run.outcome is not None)
        return [first for first in firsts if first is not None]

    @property
    def seconds(self) -> list[float]:
        """What each run took [s]."""
        return [run.seconds for run in self.runs]


@dataclass(frozen=True)
class Comparison:
    """What was asked, and the runs so far.

    Attributes:
        job: robot, tool, holes.
        holes: those of the job that are compared at.
        methods: by name.
        seeds: of the methods that depend on chance; the others run once.
        budget: evaluations of the objective that each run may make.
        samples: steps of a motion that the objective looks at.
        crowded: whether the samples crowd at the ends of the legs; the thesis' are evenly spread.
        runs: hole by hole, method by method, seed by seed.
    """

    job: Job
    holes: tuple[Hole, ...]
    methods: dict[str, Method]
    seeds: tuple[int, ...]
    budget: int
    samples: int = SAMPLES
    crowded: bool = False
    runs: tuple[Rescored, ...] = ()

    @property
    def expected(self) -> int:
        """How many runs it has when it is complete."""
        return len(self.holes) * sum(len(self.seeds_of(method)) for method in self.methods)

    def seeds_of(self, method: str) -> tuple[int | None, ...]:
        """The seeds that a method runs with."""
        return self.seeds if self.methods[method].random else (None,)

    def problem(self, hole: Hole) -> SampledProblem:
        """What the methods are given."""
        return SampledProblem(Drilling.of(self.job, hole), self.bound, samples=self.samples, crowded=self.crowded)

    @property
    def bound(self) -> float:
        """Spins are within +- this [rad]: the job's bound, or the thesis'."""
        return self.job.settings.psi_bound or math.pi

    def summaries(self) -> list[Summary]:
        """Every method at every hole that has been run there."""
        pairs = ((hole.id, name) for hole in self.holes for name in self.methods)
        found = [
            Summary(
                *pair, tuple(run for run in self.runs if (run.hole, run.method) == pair), self.methods[pair[1]].random
            )
            for pair in pairs
        ]
        return [summary for summary in found if summary.runs]


def comparison(
    job: Job,
    methods: Sequence[str],
    seeds: Sequence[int] = range(20),
    *,
    budget: int = BUDGET,
    samples: int = SAMPLES,
    crowded: bool = False,
    hole: str | None = None,
) -> Comparison:
    """A comparison that has yet to be run.

    Args:
        job: robot, tool, holes; of its settings only the bound on the spin counts.
        methods: names, as `zerorev.thesis.methods` knows them.
        seeds: a run each.
        budget: evaluations a run.
        samples: steps of a motion that the objective looks at, an even number.
        crowded: whether the samples crowd at the ends of the legs, where joints turn round between even ones unnoticed.
        hole: the id of the only hole to look at; None for all.

    Raises:
        InputError: an unknown method or hole, no seed or one that is not an integer of 0 or more, too small a budget.
    """
    if not seeds:
        raise InputError("no seed", where="seeds", accepted="1 or more")
    for seed in seeds:
        if not isinstance(seed, (int, np.integer)) or isinstance(seed, bool) or seed < 0:
            raise InputError(f"{seed!r} is not a seed", where="seeds", accepted="integers of 0 or more")
    if budget < LEAST_BUDGET:
        raise InputError(f"{budget} evaluations", where="budget", accepted=f"{LEAST_BUDGET} or more")
    even_fractions(samples)  # says what is wrong with it, if anything
    chosen = tuple(each for each in job.holes if hole in (None, each.id))
    if not chosen:
        ids = ", ".join(each.id for each in job.holes[:8]) + (", ..." if len(job.holes) > 8 else "")
        raise InputError(f"there is no hole '{hole}'", where="hole", accepted=ids)
    return Comparison(job, chosen, methods_named(methods), tuple(int(seed) for seed in seeds), budget, samples, crowded)


def compare(
    job: Job,
    methods: Sequence[str],
    seeds: Sequence[int] = range(20),
    *,
    budget: int = BUDGET,
    samples: int = SAMPLES,
    crowded: bool = False,
    hole: str | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> Comparison:
    """Run every method with every seed at every hole of a job, and evaluate exactly what comes out.

    Args:
        job: as `comparison` has it, and so are the others.
        methods: names.
        seeds: a run each.
        budget: evaluations a run.
        samples: steps of a motion that the objective looks at, an even number.
        crowded: whether the samples crowd at the ends of the legs, where joints turn round between even ones unnoticed.
        hole: the only hole to look at.
        progress: called with (runs done, runs in all) after each.

    Raises:
        InputError: as `comparison`.
    """
    asked = comparison(job, methods, seeds, budget=budget, samples=samples, crowded=crowded, hole=hole)
    found: list[Rescored] = []
    for run in runs(asked):
        found.append(run)
        if progress:
            progress(len(found), asked.expected)
    return replace(asked, runs=tuple(found))


def runs(asked: Comparison) -> Iterator[Rescored]:
    """The runs of a comparison, each as soon as it is there.

    Each method first runs once, briefly and untimed: what it imports and what is compiled is not its own time.
    """
    for hole in asked.holes:
        problem = asked.problem(hole)
        for name, method in asked.methods.items():
            if hole is asked.holes[0]:
                method.run(problem, 0, LEAST_BUDGET)
            for seed in asked.seeds_of(name):
                began = time.perf_counter()
                outcome = method.run(problem, seed or 0, asked.budget)
                yield _rescored(problem, name, seed, outcome, time.perf_counter() - began)


def _rescored(
    problem: SampledProblem, method: str, seed: int | None, outcome: Outcome | None, seconds: float
) -> Rescored:
    hole = problem.drilling.hole
    if outcome is None:
        return Rescored(hole.id, method, seed, None, WORST, None, None, seconds)
    profile = Profile.straight(hole.depth, *outcome.spins.tolist())
    evaluation = evaluated(replace(problem.drilling, hole=hole), profile, outcome.branch)
    score, worth = evaluation.score, thesis_objective(evaluation)
    if score is None:
        return Rescored(hole.id, method, seed, outcome, max(WORST, worth), None, None, seconds)
    return Rescored(hole.id, method, seed, outcome, worth, score.reversals, score.travel, seconds)


def wilson(successes: int, trials: int) -> tuple[float, float]:
    """Wilson's 95 % interval of the probability behind so many successes in so many trials.

    Args:
        successes: 0 to `trials`.
        trials: 1 or more.
    """
    z2, share = CONFIDENT**2, successes / trials
    centre = (share + z2 / (2 * trials)) / (1 + z2 / trials)
    half = math.sqrt(share * (1 - share) * z2 / trials + (z2 / (2 * trials)) ** 2) / (1 + z2 / trials)
    return max(0.0, centre - half), min(1.0, centre + half)
