"""pymoo's particle swarm (adaptive), on the same objective and with as many evaluations as the thesis' swarm."""

from __future__ import annotations

from typing import Any

import numpy as np
from pymoo.algorithms.soo.nonconvex.pso import PSO
from pymoo.core.problem import Problem
from pymoo.optimize import minimize

from benchmarks.cases import Answer
from benchmarks.peers.evolution import BUDGET
from benchmarks.peers.objective import Objective
from benchmarks.peers.swarm import BOUND, PARTICLES
from zerorev.model._arrays import Array

__all__ = ["pymoo_swarm"]


class _Motions(Problem):  # type: ignore[misc]
    """Three spins within +-180 deg."""

    def __init__(self, objective: Objective) -> None:
        super().__init__(n_var=3, n_obj=1, xl=-BOUND, xu=BOUND)
        self.objective = objective

    def _evaluate(self, x: Array, out: dict[str, Array], *_: Any, **__: Any) -> None:
        out["F"] = self.objective(x)[:, None]


def pymoo_swarm(objective: Objective, seed: int, budget: int = BUDGET) -> Answer:
    """The best motion that one run finds.

    Args:
        objective: eq. 4.7 of a hole.
        seed: of all that is random.
        budget: evaluations.
    """
    found = minimize(_Motions(objective), PSO(pop_size=PARTICLES), ("n_eval", budget), seed=seed)
    return objective.answer(np.asarray(found.X))
