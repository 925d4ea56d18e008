"""SciPy's differential evolution, on the same objective and with no more evaluations than the swarm."""

from __future__ import annotations

from functools import partial

import numpy as np

from benchmarks.cases import Answer
from benchmarks.peers.objective import Objective
from benchmarks.peers.swarm import BOUND
from zerorev.thesis.methods import BUDGET
from zerorev.thesis.scipy_methods import differential_evolution
from zerorev.thesis.trial import Trial

__all__ = ["attack", "evolution"]


def evolution(objective: Objective, seed: int, budget: int = BUDGET) -> Answer:
    """The best motion that one run finds, psi within +-180 deg.

    Args:
        objective: eq. 4.7 of a hole.
        seed: of all that is random.
        budget: evaluations, at most.
    """
    trial = Trial(objective, budget, np.full(3, -BOUND), np.full(3, BOUND))
    trial.run(partial(differential_evolution, tolerance=0.01), seed)
    return objective.answer(trial.best)


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
    trial = Trial(objective, budget, spins - within, spins + within)
    return objective.answer(trial.run(partial(differential_evolution, first=spins), seed).best)
