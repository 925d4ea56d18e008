"""Curves of a study: in their units, and where they change their sign."""

from __future__ import annotations

import numpy as np
import pytest

from oracles.made_study import made_study
from zerorev.report.scene.study_curves import Banded, stray_curve, torque_curve


def test_they_are_those_of_the_study():
    hole = made_study("h")
    stray, torque = stray_curve(hole, "plan", "tool"), torque_curve(hole, "baseline", 2)
    np.testing.assert_array_equal([stray.low, stray.median, stray.high], hole.profile[1, 1] * 1e3)
    np.testing.assert_array_equal([torque.low, torque.median, torque.high], hole.torque[0, 2])
    np.testing.assert_array_equal(torque.path, hole.path)


@pytest.mark.parametrize(
    ("median", "changes"),
    [
        ((1, 3, -1, -1, -2), (0.25 / 2 * 3 - 0.5 + 0.125 - 0.125,)),
        ((1, 0, 1, 0, -1), (0.5,)),
        ((0, 0, 1, 2, 0), ()),
        ((-1, 1, -1, 1, np.nan), (-0.75, -0.25, 0.25)),
        ((np.nan,) * 5, ()),
    ],
)
def test_where_the_sign_changes(median, changes):
    """Between two points by a straight line; a curve that only touches 0 has not changed."""
    path, values = np.linspace(-1, 1, 5), np.array(median, dtype=float)
    np.testing.assert_allclose(Banded(path, values, values, values).changes, changes)
