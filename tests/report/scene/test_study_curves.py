"""Curves of a study: in their units, and where they change their sign."""

from __future__ import annotations

import numpy as np
import pytest

from zerorev.cell.ensemble import HoleStudy
from zerorev.report.scene.study_curves import Banded, stray_curve, torque_curve


@pytest.fixture
def hole():
    """Made up, of 2 motions and 4 sets."""
    numbers = np.random.default_rng(0)
    sizes = dict.fromkeys(("deviation", "vertical", "offset", "ovality"), (2, 2, 4))
    sizes |= {"swing": (2, 6, 4), "position": (2, 4), "tilt": (2, 4)}
    sizes |= {"profile": (2, 2, 3, 5), "torque": (2, 6, 3, 5), "speed": (2,)}
    figures = {name: numbers.normal(size=size) for name, size in sizes.items()}
    return HoleStudy("h", ("baseline", "plan"), **figures, path=np.linspace(-1, 1, 5))


def test_they_are_those_of_the_study(hole):
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
