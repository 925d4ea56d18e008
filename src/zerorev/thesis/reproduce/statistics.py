"""How far a rate or a mean from a few seeds can be trusted, and which differences between groups are real."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations

import numpy as np
from scipy import stats

from zerorev.model._arrays import Array

__all__ = ["Interval", "mean_interval", "pairwise", "rate_interval"]

LEVEL = 0.95
RESAMPLES = 2000

Interval = tuple[float, float]


def rate_interval(successes: int, trials: int) -> Interval:
    """Wilson's interval of a rate [1], at 95 %."""
    found = stats.binomtest(successes, trials).proportion_ci(LEVEL, method="wilson")
    return float(found.low), float(found.high)


def mean_interval(values: Array, seed: int = 0) -> Interval:
    """Bootstrapped interval of a mean, at 95 %, of values of shape (n,).

    Args:
        values: independent, one per run.
        seed: of the resampling.
    """
    picks = np.random.default_rng(seed).integers(len(values), size=(RESAMPLES, len(values)))
    low, high = np.quantile(values[picks].mean(axis=1), [(1 - LEVEL) / 2, (1 + LEVEL) / 2])
    return float(low), float(high)


def pairwise(groups: Sequence[Array]) -> dict[tuple[int, int], float]:
    """Probability that two groups differ so much by chance, for every pair (i, j) with i < j.

    Two-sided: Fisher's exact test where all values are 0 or 1, else Mann and Whitney's; corrected for the number of
    pairs after Holm.

    Args:
        groups: values of shape (n,), one array a group.
    """
    pairs = list(combinations(range(len(groups)), 2))
    binary = all(np.isin(group, (0.0, 1.0)).all() for group in groups)
    raw = np.array([_fisher(groups[i], groups[j]) if binary else _rank_sum(groups[i], groups[j]) for i, j in pairs])
    order = np.argsort(raw, kind="stable")
    corrected = np.empty_like(raw)
    # Holm: the smallest of m is multiplied by m, the next by m - 1, and none falls below the one before
    corrected[order] = np.minimum(1.0, np.maximum.accumulate(raw[order] * np.arange(len(raw), 0, -1)))
    return dict(zip(pairs, corrected.tolist(), strict=True))


def _fisher(one: Array, other: Array) -> float:
    table = [[int(group.sum()), int(len(group) - group.sum())] for group in (one, other)]
    return float(stats.fisher_exact(table).pvalue)


def _rank_sum(one: Array, other: Array) -> float:
    if np.ptp(np.concatenate([one, other])) == 0:
        return 1.0  # all alike: nothing to tell apart
    return float(stats.mannwhitneyu(one, other, alternative="two-sided").pvalue)
