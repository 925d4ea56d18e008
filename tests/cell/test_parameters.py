"""Ranges, and sets drawn from them."""

from __future__ import annotations

import numpy as np
import pytest

from zerorev.cell.parameters import RANGES, drawn, nominal
from zerorev.errors import InputError
from zerorev.files.io import read_robot
from zerorev.kernels.plant import GAP, HYSTERESIS
from zerorev.model.dynamics import nominal_drives
from zerorev.model.ranges import HELD


def test_a_seed_gives_the_same_sets_and_another_other_ones():
    assert [one.values for one in drawn(20, 3)] == [one.values for one in drawn(20, 3)]
    assert drawn(20, 3)[0].values != drawn(20, 4)[0].values


def test_few_sets_cover_each_range():
    """A Latin hypercube: one set in each twentieth of every range."""
    sets = drawn(20, 1)
    for name, range_ in RANGES.items():
        if name in HELD:
            assert all(name not in one.values for one in sets)
            continue
        values = np.array([one[name] for one in sets])
        assert (values >= range_.low).all()
        assert (values <= range_.high).all()
        ends = range_.at(np.linspace(0, 1, 21))
        assert (np.histogram(values, ends)[0] == 1).all()


def test_what_is_held_and_what_is_varied_besides():
    one = drawn(3, 0, vary=("corner", "tcp_error"), held=("tool_mass",))[0].values
    assert "corner" in one
    assert "tcp_error" in one
    assert "tool_mass" not in one


def test_nominal_values_are_the_nominal_arm():
    dynamics = read_robot("kuka_kr6_r700_2").dynamics
    arm, drives = nominal().arm(dynamics), nominal_drives(6.0)
    np.testing.assert_array_equal(arm.coulomb, drives.coulomb)
    np.testing.assert_allclose(arm.gap, drives.lost_motion, rtol=1e-12)
    assert arm.kind == GAP
    assert {one.arm(dynamics).kind for one in drawn(8, 0)} == {GAP, HYSTERESIS}
    for name, range_ in RANGES.items():
        assert range_.low <= range_.nominal <= range_.high, name


@pytest.mark.parametrize(("count", "held", "message"), [(0, (), "no sets"), (3, ("mass",), "unknown parameter 'mass'")])
def test_what_cannot_be_drawn(count, held, message):
    with pytest.raises(InputError, match=message):
        drawn(count, 0, held=held)
