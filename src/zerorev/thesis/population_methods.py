"""Populations of motions from other libraries: pymoo's PSO, GA and DE, and cma's covariance matrix adaptation."""

from __future__ import annotations

from typing import Any

import numpy as np

from zerorev.model._arrays import Array
from zerorev.thesis.trial import Trial

__all__ = ["cma_es", "pymoo_de", "pymoo_ga", "pymoo_pso"]


def pymoo_pso(trial: Trial, seed: int, *, population: int = 100) -> None:
    """The particle swarm of pymoo, which adapts its weights as it goes.

    Args:
        trial: what is to be least.
        seed: of all that is random.
        population: particles.
    """
    from pymoo.algorithms.soo.nonconvex.pso import PSO

    _minimise(trial, PSO(pop_size=population), seed)


def pymoo_ga(trial: Trial, seed: int, *, population: int = 100) -> None:
    """The genetic algorithm of pymoo: tournaments, simulated binary crossover, polynomial mutation.

    Args:
        trial: what is to be least.
        seed: of all that is random.
        population: motions of a generation.
    """
    from pymoo.algorithms.soo.nonconvex.ga import GA

    _minimise(trial, GA(pop_size=population), seed)


def pymoo_de(trial: Trial, seed: int, *, population: int = 100) -> None:
    """The differential evolution of pymoo, with its defaults.

    Args:
        trial: what is to be least.
        seed: of all that is random.
        population: motions of a generation.
    """
    from pymoo.algorithms.soo.nonconvex.de import DE

    _minimise(trial, DE(pop_size=population), seed)


def _minimise(trial: Trial, algorithm: Any, seed: int) -> None:
    from pymoo.core.problem import Problem
    from pymoo.core.termination import NoTermination
    from pymoo.optimize import minimize

    class Motions(Problem):  # type: ignore[misc]
        """Three spins in the trial's box, a generation at a time."""

        def _evaluate(self, x: Array, out: dict[str, Array], *_: Any, **__: Any) -> None:
            out["F"] = trial(x)[:, None]

    problem = Motions(n_var=3, n_obj=1, xl=trial.low, xu=trial.high)
    minimize(problem, algorithm, NoTermination(), seed=seed, copy_algorithm=False)


def cma_es(trial: Trial, seed: int, *, step: float = 0.25, growth: float = 2.0) -> None:
    """Hansen's covariance matrix adaptation, begun again with a larger population wherever it has converged (IPOP).

    Args:
        trial: what is to be least.
        seed: of all that is random.
        step: first standard deviation, as a share of the box.
        growth: of the population from one beginning to the next.
    """
    import cma

    rng = np.random.default_rng(seed)
    population = 4 + int(3 * np.log(3))  # cma's own for three dimensions
    width = trial.high - trial.low
    while True:
        options = {
            "bounds": [trial.low.tolist(), trial.high.tolist()],
            "CMA_stds": width.tolist(),
            "popsize": population,
            "randn": lambda *shape: rng.standard_normal(shape),
            "seed": np.nan,  # else it seeds the one generator that all of NumPy shares
            "verbose": -9,
        }
        search = cma.CMAEvolutionStrategy(rng.uniform(trial.low, trial.high), step, options)
        while not search.stop():
            motions = search.ask()
            search.tell(motions, trial(np.array(motions)).tolist())
        population = int(growth * population)
