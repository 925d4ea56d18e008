"""The range that a joint's curve is drawn in."""

from __future__ import annotations

import numpy as np
import pytest

from zerorev.report.scene.joint_range import LEAST_SPAN, joint_range


def test_all_angles_are_in_view_and_limits_where_they_are_near():
    found = joint_range(np.array([10.0, np.nan, 30.0]), -170, 170)
    assert (found.lower, found.upper) == (None, None)
    assert found.low < 10 < 30 < found.high
    near = joint_range(np.array([150.0, 165.0]), -170, 170)
    assert (near.lower, near.upper) == (None, 170)
    assert near.high > 170
    beyond = joint_range(np.array([-175.0, -160.0]), -170, 170)
    assert beyond.lower == -170
    assert beyond.low < -175


def test_a_joint_that_hardly_moves_looks_so():
    found = joint_range(np.array([1.0, 1.0001]), -170, 170)
    assert found.high - found.low == pytest.approx(LEAST_SPAN * 1.2)


def test_without_any_angle_the_limits_are_shown():
    found = joint_range(np.array([np.nan]), -120, 156)
    assert (found.lower, found.upper) == (-120, 156)
