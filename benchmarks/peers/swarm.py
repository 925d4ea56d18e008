"""zerorev's own build of the thesis' particle swarm (sec. 4.1 to 4.5), with the thesis' settings."""

from __future__ import annotations

from dataclasses import replace

from benchmarks.cases import Answer
from benchmarks.peers.objective import Objective
from zerorev.thesis.swarm import TABLE_4, run_swarm

__all__ = ["BOUND", "ITERATIONS", "PARTICLES", "swarm"]

PARTICLES, ITERATIONS, BOUND = TABLE_4.particles, TABLE_4.iterations, TABLE_4.bounds[1]


def swarm(objective: Objective, seed: int, particles: int = PARTICLES, iterations: int = ITERATIONS) -> Answer:
    """The best motion that one run of the swarm finds.

    Args:
        objective: eq. 4.7 of a hole.
        seed: of all that is random.
        particles: in the swarm.
        iterations: at most.
    """
    settings = replace(TABLE_4, particles=particles, iterations=iterations, seed=seed)
    return objective.answer(run_swarm(objective, settings).spins)
