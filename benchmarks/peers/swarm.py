"""The thesis' particle swarm (sec. 4.1 to 4.5, trial 3): 100 particles, 50 iterations, psi within +-180 deg.

Where the thesis is silent: a particle that leaves the bounds is put back onto them, and its velocity is then what it
really moved (eq. 4.2); first velocities are uniform, up to a tenth of the range either way.
"""

from __future__ import annotations

import numpy as np

from benchmarks.cases import Answer
from benchmarks.peers.objective import Objective
from zerorev.model._arrays import Array

__all__ = ["ITERATIONS", "PARTICLES", "swarm"]

PARTICLES, ITERATIONS = 100, 50
TO_OWN_BEST, TO_BEST_OF_ALL = 0.2, 0.1
BOUND = np.pi
FIRST_VELOCITY = 0.1 * 2 * BOUND
AT_REST, STILL = 0.95, 0.01  # eq. 4.3: so many particles moved by less than so much of where they are


def swarm(objective: Objective, seed: int, particles: int = PARTICLES, iterations: int = ITERATIONS) -> Answer:
    """The best motion that one run of the swarm finds.

    Args:
        objective: eq. 4.7 of a hole.
        seed: of all that is random.
        particles: in the swarm.
        iterations: at most.
    """
    rng = np.random.default_rng(seed)
    x = _beginning(rng, particles)
    v = rng.uniform(-FIRST_VELOCITY, FIRST_VELOCITY, x.shape)
    own, own_cost = x.copy(), objective(x)
    for _ in range(iterations):
        before = x
        x = np.clip(before + v, -BOUND, BOUND)
        v = x - before
        cost = objective(x)
        better = cost < own_cost
        own[better], own_cost[better] = x[better], cost[better]
        best = own[own_cost.argmin()]
        if (np.abs(v) < STILL * np.abs(x)).all(axis=1).mean() > AT_REST:
            break
        inertia = rng.uniform(0.5, 1.0)
        r, s = rng.uniform(size=(2, particles, 1))
        v = r * (own - x) * TO_OWN_BEST + s * (best - x) * TO_BEST_OF_ALL + v * inertia  # eq. 4.6
    return objective.answer(own[own_cost.argmin()])


def _beginning(rng: np.random.Generator, particles: int) -> Array:
    """Start and target anywhere, the end further round in the same sense (eq. 4.8); shape (particles, 3)."""
    start, target = rng.uniform(-BOUND, BOUND, (2, particles))
    end = target + rng.uniform(size=particles) * (np.where(target > start, BOUND, -BOUND) - target)
    return np.stack([start, target, end], axis=1)
