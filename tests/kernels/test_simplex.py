"""Small linear programmes against scipy's HiGHS."""

import numpy as np
import pytest
from numba import config
from scipy.optimize import linprog

from zerorev.kernels import simplex

MANY = 10 if config.DISABLE_JIT else 400


def random_programme(rng, size, rows, *, lacking):
    """Cost, bounds, and rows that know a few unknowns each; `lacking`: the middle of the box breaks many of them."""
    at = np.array([rng.permutation(size)[: simplex.WIDTH] for _ in range(rows)], dtype=np.int64)
    at = at.reshape(rows, -1)
    missing = simplex.WIDTH - at.shape[1]
    at = np.pad(at, ((0, 0), (0, missing)))
    by = rng.normal(size=at.shape)
    by[:, simplex.WIDTH - missing :] = 0.0
    by /= np.abs(by).max(axis=1, keepdims=True)
    spare = rng.exponential(size=rows) - (0.1 if lacking else 0.0)
    cost = rng.normal(size=size) * (rng.random(size) < 0.5)  # many unknowns cost nothing, as twists do
    return cost, -rng.random(size), rng.random(size), at, by, spare


def by_highs(cost, low, high, at, by, spare):
    A = np.zeros((len(spare), len(cost)))
    for row, unknowns, coefficients in zip(A, at, by, strict=True):
        np.add.at(row, unknowns, coefficients)
    return linprog(cost, -A, spare, bounds=np.column_stack([low, high]), method="highs-ds"), A


@pytest.mark.parametrize("lacking", [False, True])
def test_as_cheap_as_highs_has_it_and_within_all_rows(lacking):
    rng, solved, without = np.random.default_rng(1), 0, 0
    for _ in range(MANY):
        size, rows = int(rng.integers(2, 36)), int(rng.integers(1, 300))
        programme = random_programme(rng, size, rows, lacking=lacking)
        cost, low, high, _, _, spare = programme
        expected, A = by_highs(*programme)
        x = np.empty(size)
        assert simplex.solve(*programme, rows, x) == (expected.status == 0)
        without += expected.status != 0
        if expected.status == 0:
            assert cost @ x == pytest.approx(expected.fun, abs=1e-7)
            assert (spare + A @ x >= -1e-7).all()
            assert (x >= low - 1e-7).all()
            assert (x <= high + 1e-7).all()
            solved += 1
    assert solved >= MANY / 3
    assert lacking == (without > 0)


def test_rows_beyond_the_count_are_not_examined():
    rng = np.random.default_rng(2)
    cost, low, high, at, by, spare = random_programme(rng, 6, 20, lacking=False)
    few, all_rows = np.empty(6), np.empty(6)
    assert simplex.solve(cost, low, high, at, by, spare, 5, few)
    assert simplex.solve(cost, low, high, at[:5], by[:5], spare[:5], 5, all_rows)
    np.testing.assert_array_equal(few, all_rows)


def test_many_equal_rows_do_not_trap():
    """A corner at which far more rows meet than there are unknowns."""
    size, rows = 4, 200
    at, by = np.tile(np.array([0, 1, 2, 3, 0]), (rows, 1)), np.ones((rows, simplex.WIDTH))
    by[:, 4], spare = 0.0, np.zeros(rows)
    by[1::2, 0] = 0.5
    x = np.empty(size)
    cost, box = np.ones(size), np.ones(size)
    assert simplex.solve(cost, -box, box, at, by, spare, rows, x)
    assert cost @ x == pytest.approx(by_highs(cost, -box, box, at, by, spare)[0].fun, abs=1e-9)
