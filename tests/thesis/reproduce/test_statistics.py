"""Intervals and tests against their formulas and against cases with a known answer."""

import numpy as np
import pytest

from zerorev.thesis.reproduce.statistics import mean_interval, pairwise, rate_interval


@pytest.mark.parametrize(("found", "of"), [(0, 20), (9, 20), (46, 100), (100, 100)])
def test_wilson(found, of):
    z, p = 1.959963984540054, found / of
    middle, half = p + z * z / (2 * of), z * np.sqrt(p * (1 - p) / of + z * z / (4 * of * of))
    low, high = rate_interval(found, of)
    assert low == pytest.approx(max(0.0, (middle - half) / (1 + z * z / of)), abs=1e-12)
    assert high == pytest.approx(min(1.0, (middle + half) / (1 + z * z / of)), abs=1e-12)


def test_the_interval_of_a_mean_is_that_of_the_normal_law_for_many_values():
    values = np.random.default_rng(5).normal(3.0, 2.0, 4000)
    low, high = mean_interval(values)
    error = 1.96 * values.std() / np.sqrt(values.size)
    assert low == pytest.approx(values.mean() - error, abs=0.1 * error)
    assert high == pytest.approx(values.mean() + error, abs=0.1 * error)
    assert (low, high) == mean_interval(values)


def test_fisher_after_holm():
    groups = [np.repeat([1.0, 0.0], counts) for counts in ((18, 2), (2, 18), (17, 3))]
    found = pairwise(groups)
    # 18:2 against 2:18 by the hypergeometric law: sums of products of binomials
    from math import comb

    def fisher(a, b, n=20):
        weights = [comb(n, k) * comb(n, a + b - k) for k in range(max(0, a + b - n), min(n, a + b) + 1)]
        at = comb(n, a) * comb(n, b)
        return sum(w for w in weights if w <= at * (1 + 1e-9)) / sum(weights)

    raw = {(0, 1): fisher(18, 2), (0, 2): fisher(18, 17), (1, 2): fisher(2, 17)}
    order = sorted(raw, key=raw.get)
    last = 0.0
    for place, pair in enumerate(order):
        last = max(last, min(1.0, raw[pair] * (3 - place)))
        assert found[pair] == pytest.approx(last, rel=1e-9)


def test_groups_that_differ_are_distinguished_from_groups_that_do_not():
    rng = np.random.default_rng(1)
    found = pairwise(
        [rng.normal(0, 1, 50), rng.normal(0, 1, 50), rng.normal(2, 1, 50), np.full(50, 7.0), np.full(50, 7.0)]
    )
    assert found[0, 1] > 0.05
    assert found[0, 2] < 1e-6
    assert found[3, 4] == 1.0
