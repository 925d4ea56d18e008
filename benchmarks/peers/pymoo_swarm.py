"""pymoo's particle swarm (adaptive), on the same objective and with as many evaluations as the thesis' swarm."""

from __future__ import annotations

import numpy as np

from benchmarks.cases import Answer
from benchmarks.peers.objective import Objective
from benchmarks.peers.swarm import BOUND
from zerorev.thesis.methods import BUDGET
from zerorev.thesis.population_methods import pymoo_pso
from zerorev.thesis.trial import Trial

__all__ = ["pymoo_swarm"]


def pymoo_swarm(objective: Objective, seed: int, budget: int = BUDGET) -> Answer:
    """The best motion that one run finds.

    Args:
        objective: eq. 4.7 of a hole.
        seed: of all that is random.
        budget: evaluations.
    """
    trial = Trial(objective, budget, np.full(3, -BOUND), np.full(3, BOUND)).run(pymoo_pso, seed)
    return objective.answer(trial.best)
