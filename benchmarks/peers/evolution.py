"""SciPy's differential evolution, on the same objective and with no more evaluations than the swarm."""

from __future__ import annotations

import numpy as np
from scipy.optimize import differential_evolution

from benchmarks.cases import Answer
from benchmarks.peers.objective import Objective
from benchmarks.peers.swarm import BOUND, ITERATIONS, PARTICLES
from zerorev.model._arrays import Array

__all__ = ["attack", "evolution"]

BUDGET = PARTICLES * (ITERATIONS + 1)
POPULATION = 45


def evolution(objective: Objective, seed: int, budget: int = BUDGET) -> Answer:
    """The best motion that one run finds, psi within +-180 deg.

    Args:
        objective: eq. 4.7 of a hole.
        seed: of all that is random.
        budget: evaluations, at most.
    """
    return _evolve(objective, [(-BOUND, BOUND)] * 3, seed, budget, tolerance=0.01)


def attack(objective: Objective, answer: Answer, seed: int, within: float, budget: int = BUDGET) -> Answer:
    """The best motion around a given one, which is in the first population: is there a better one close by?

    Args:
        objective: eq. 4.7 of a hole.
        answer: the motion to be beaten.
        seed: of all that is random.
        within: so far around each of its spins [rad].
        budget: evaluations, at most.
    """
    spins = answer.profile.psi
    return _evolve(objective, [(psi - within, psi + within) for psi in spins], seed, budget, tolerance=0.0, first=spins)


def _evolve(
    objective: Objective,
    bounds: list[tuple[float, float]],
    seed: int,
    budget: int,
    *,
    tolerance: float,
    first: Array | None = None,
) -> Answer:
    found = differential_evolution(
        lambda x: objective(x.T),
        bounds,
        popsize=POPULATION // 3,
        maxiter=budget // POPULATION - 1,
        rng=seed,
        tol=tolerance,
        polish=False,
        vectorized=True,
        updating="deferred",
        x0=first,
    )
    return objective.answer(np.asarray(found.x))
