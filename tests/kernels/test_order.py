"""The order of a few numbers, against NumPy's; and that no kernel asks NumPy for it."""

from __future__ import annotations

import inspect
from importlib import import_module
from pkgutil import iter_modules

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from zerorev import kernels
from zerorev.kernels.order import order_of

FEW = st.sampled_from([0.0, -0.0, 1.0, 2.5, -3.0, np.inf, -np.inf, np.nan])


@given(arrays(float, st.integers(0, 12), elements=FEW | st.floats()))
def test_is_the_stable_order_of_numpy(values):
    np.testing.assert_array_equal(order_of(values), np.argsort(values, kind="stable"))


@pytest.mark.parametrize("count", [1, 37, 480])
def test_of_many(count):
    values = np.random.default_rng(count).normal(size=count)
    np.testing.assert_array_equal(order_of(values), np.argsort(values))


@pytest.mark.parametrize("name", [module.name for module in iter_modules(kernels.__path__)])
def test_no_kernel_sorts_with_numpy(name):
    source = inspect.getsource(import_module(f"zerorev.kernels.{name}"))
    code = [line for line in source.splitlines() if "`" not in line]
    assert not [line for line in code if "np.sort(" in line or "argsort(" in line or ".sort(" in line]
