"""SciPy's global optimisers: differential evolution, DIRECT, dual annealing."""

from __future__ import annotations

import numpy as np

from zerorev.model._arrays import Array
from zerorev.thesis.trial import Trial

__all__ = ["differential_evolution", "direct", "dual_annealing"]

NO_LIMIT = 10**6  # iterations; the budget ends them


def differential_evolution(
    trial: Trial, seed: int, *, population: int = 45, tolerance: float = 0.0, first: Array | None = None
) -> None:
    """Storn and Price's differential evolution (best1bin), a generation at a time.

    Args:
        trial: what is to be least.
        seed: of all that is random.
        population: motions of a generation, a multiple of 3.
        tolerance: ends where the scores of a generation spread by less than this share of their mean.
        first: a motion that is in the first generation [rad], shape (3,).
    """
    from scipy.optimize import differential_evolution as search

    search(
        lambda x: trial(x.T),
        np.stack([trial.low, trial.high], axis=1),
        popsize=population // 3,
        maxiter=NO_LIMIT,
        rng=seed,
        tol=tolerance,
        polish=False,
        vectorized=True,
        updating="deferred",
        x0=first,
    )


def direct(trial: Trial, seed: int, *, locally_biased: bool = False) -> None:
    """Jones' DIRECT, which divides the box into ever smaller ones; nothing in it is random.

    Args:
        trial: what is to be least.
        seed: has no effect.
        locally_biased: Gablonsky's variant, for objectives of few valleys.
    """
    from scipy.optimize import Bounds
    from scipy.optimize import direct as search

    del seed
    bounds = Bounds(trial.low, trial.high)
    # its own limit of evaluations is checked late, but memory goes with it; it never stops for small boxes
    limits = {"maxfun": 2 * trial.left, "maxiter": NO_LIMIT, "vol_tol": 0.0, "len_tol": 0.0}
    search(trial.one, bounds, locally_biased=locally_biased, **limits)


def dual_annealing(trial: Trial, seed: int, *, local_search: bool = True) -> None:
    """Generalised simulated annealing, with local searches (L-BFGS-B) from where it gets to; one motion at a time.

    Args:
        trial: what is to be least.
        seed: of all that is random.
        local_search: without it this is plain generalised simulated annealing.
    """
    from scipy.optimize import dual_annealing as search

    bounds = np.stack([trial.low, trial.high], axis=1)
    search(trial.one, bounds, maxiter=NO_LIMIT, maxfun=NO_LIMIT, rng=seed, no_local_search=not local_search)
