"""Every search method under its name, with one signature: they all look for the least of the thesis' objective.

`exact` is the project's own search, which needs no evaluations of it; the others look at as many motions as the budget
allows. To add one, write its algorithm (see `zerorev.thesis.trial`) and a line in `METHODS`.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from importlib.util import find_spec

import numpy as np

from zerorev.errors import InputError
from zerorev.model._arrays import Array
from zerorev.model.job import Settings
from zerorev.motion.drilling import Drilling
from zerorev.search.exact import search
from zerorev.thesis import population_methods as populations
from zerorev.thesis import scipy_methods as scipys
from zerorev.thesis.sampled import SAMPLES, THESIS, SampledObjective, Weighing, crowded_fractions, even_fractions
from zerorev.thesis.swarm import TABLE_3, TABLE_4, SwarmSettings, run_swarm
from zerorev.thesis.trial import Algorithm, Trial

__all__ = ["BUDGET", "METHODS", "Method", "Outcome", "SampledProblem", "methods_named"]

BUDGET = 100 * 51  # evaluations: the thesis' 100 particles, where they begin and after each of 50 iterations


@dataclass(frozen=True)
class SampledProblem:
    """A hole, and what is to be least there: eq. 4.7 of the motion's samples, on the best of the branches.

    Attributes:
        drilling: robot, tool and hole.
        bound: spins are within +- this [rad]; the thesis' unless given.
        weighing: of eq. 4.7; with its motion threshold the exact search keeps it, too.
        samples: steps of a motion at which it is examined.
        crowded: whether the samples crowd at the ends of the legs; the thesis' are evenly spread.
    """

    drilling: Drilling
    bound: float = np.pi
    weighing: Weighing = THESIS
    samples: int = SAMPLES
    crowded: bool = False

    def objective(self) -> SampledObjective:
        """The objective, its counters at zero."""
        fractions = (crowded_fractions if self.crowded else even_fractions)(self.samples)
        return SampledObjective(self.drilling, self.weighing, fractions=fractions)


@dataclass(frozen=True)
class Outcome:
    """What one run of a method found, as the objective itself sees it.

    Attributes:
        spins: (psi_start, psi_target, psi_end) [rad], shape (3,).
        branch: 0..7.
        score: eq. 4.7, 1 or more where the motion cannot be run.
        reversals: counted on the samples; -1 where the motion cannot be run.
        evaluations: motions that the method examined; 0 for the exact search, which looks at legs.
        first_zero: how many until the first one without reversals; None where there was none.
    """

    spins: Array
    branch: int
    score: float
    reversals: int
    evaluations: int
    first_zero: int | None


Run = Callable[[SampledProblem, int, int], Outcome | None]


@dataclass(frozen=True)
class Method:
    """One way to look for the best motion.

    Attributes:
        run: (problem, seed, budget of evaluations) -> outcome; None where the exact search finds no motion.
        what: the method in a few words.
        random: whether its outcome depends on the seed.
        needs: the module it needs beside the project's own, or nothing.
    """

    run: Run
    what: str
    random: bool = True
    needs: str = ""


def _exact(problem: SampledProblem, seed: int, budget: int) -> Outcome | None:
    del seed, budget
    weighing = problem.weighing
    settings = Settings(weighing.min_rate, weighing.min_rate_rule, problem.bound)
    found = search(problem.drilling, settings)
    return None if found is None else replace(_outcome(problem, found.profile.psi), branch=found.branch)


def _swarm(swarm: SwarmSettings, problem: SampledProblem, seed: int, budget: int) -> Outcome:
    objective, bound = problem.objective(), problem.bound
    iterations = min(swarm.iterations, budget // swarm.particles - 1)
    found = run_swarm(objective, replace(swarm, iterations=iterations, seed=seed, bounds=(-bound, bound)))
    return Outcome(found.spins, found.branch, found.score, found.reversals, found.evaluations, objective.first_zero)


def _sampled(algorithm: Algorithm, problem: SampledProblem, seed: int, budget: int) -> Outcome:
    objective, box = problem.objective(), np.full(3, problem.bound)
    trial = Trial(objective, budget, -box, box).run(algorithm, seed)
    return _outcome(problem, trial.best, budget - trial.left, objective.first_zero)


def _outcome(problem: SampledProblem, spins: Array, evaluations: int = 0, first_zero: int | None = None) -> Outcome:
    judged = problem.objective().judged(spins[None])
    score, branch, reversals = (each[0].item() for each in judged)
    return Outcome(spins, branch, score, reversals, evaluations, first_zero)


METHODS: dict[str, Method] = {
    "exact": Method(_exact, "this project's exact search", random=False),
    "swarm": Method(partial(_swarm, TABLE_4), "the thesis' particle swarm (its table 4)"),
    **{
        f"swarm_trial_{n}": Method(partial(_swarm, trial), f"the thesis' particle swarm, trial {n} of its table 3")
        for n, trial in TABLE_3.items()
    },
    "differential_evolution": Method(
        partial(_sampled, scipys.differential_evolution), "SciPy's differential evolution"
    ),
    "direct": Method(partial(_sampled, scipys.direct), "SciPy's DIRECT", random=False),
    "dual_annealing": Method(partial(_sampled, scipys.dual_annealing), "SciPy's dual annealing"),
    "pymoo_pso": Method(partial(_sampled, populations.pymoo_pso), "pymoo's particle swarm", needs="pymoo"),
    "pymoo_ga": Method(partial(_sampled, populations.pymoo_ga), "pymoo's genetic algorithm", needs="pymoo"),
    "pymoo_de": Method(partial(_sampled, populations.pymoo_de), "pymoo's differential evolution", needs="pymoo"),
    "cma": Method(partial(_sampled, populations.cma_es), "cma's CMA-ES with restarts", needs="cma"),
}
"""The methods by their names."""


def methods_named(names: Sequence[str]) -> dict[str, Method]:
    """The methods of these names, in this order.

    Raises:
        InputError: no name, one that is unknown or there twice, or one whose package is not installed.
    """
    known = ", ".join(METHODS)
    if not names:
        raise InputError("no method", where="methods", accepted=known)
    found: dict[str, Method] = {}
    for name in names:
        if name not in METHODS:
            raise InputError(f"there is no method '{name}'", where="methods", accepted=known)
        if name in found:
            raise InputError(f"'{name}' is there twice", where="methods", accepted="each method once")
        method = METHODS[name]
        if method.needs and find_spec(method.needs) is None:
            raise InputError(
                f"{name} needs {method.needs}, which is not installed",
                where="methods",
                accepted="pip install 'zerorev[methods]'",
            )
        found[name] = method
    return found
