"""Kernels run as plain Python, too (NUMBA_DISABLE_JIT=1), and mean the same there."""

from __future__ import annotations

import numpy as np
import pytest


@pytest.fixture(autouse=True, scope="module")
def no_pose_is_nan():
    """Dividing by zero gives infinity, and a root of what is negative NaN, without a word: as in compiled kernels."""
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        yield
