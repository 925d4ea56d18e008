"""Masses that no body has are refused; the guess of the drives is the one that the sources give."""

import numpy as np
import pytest

from zerorev.errors import InputError
from zerorev.model.dynamics import Dynamics, Link, Load, nominal_drives


def link(**other):
    return Link(
        **{"mass": 1.0, "com": np.zeros(3), "inertia": np.diag([1.0, 1.0, 1.0]), "T_base_link": np.eye(4)} | other
    )


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ({"mass": -1.0}, "mass that is not above 0"),
        ({"mass": np.nan}, "mass that is not above 0"),
        ({"com": [0.0, np.inf, 0.0]}, "NaN or infinite"),
        ({"inertia": np.diag([1.0, 1.0, -1.0])}, "the inertia of no body"),
        ({"inertia": np.diag([1.0, 1.0, 2.1])}, "the inertia of no body"),
        ({"inertia": np.zeros((3, 3))}, "the inertia of no body"),
        ({"T_base_link": 2 * np.eye(4)}, "not a rotation"),
    ],
)
def test_no_link(wrong, message):
    with pytest.raises(InputError, match=message):
        link(**wrong)


def test_a_load_may_be_a_point():
    assert Load(0.3, np.zeros(3), np.zeros((3, 3))).mass == 0.3
    with pytest.raises(InputError, match="the inertia of no body"):
        Load(0.3, np.zeros(3), np.diag([1.0, 0.1, 0.1]))


def test_dynamics_need_a_payload():
    links = (link(),) * 6
    with pytest.raises(InputError, match="payload is not above 0"):
        Dynamics(links, 0.0)
    with pytest.raises(InputError, match="torque is not above 0"):
        Dynamics(links, 6.0, np.zeros(6))


def test_drives_for_six_kilograms():
    """As worked out once by hand from the two sources, rounded there."""
    drives = nominal_drives(6.0)
    np.testing.assert_allclose(drives.coulomb, [18.57, 32.25, 17.59, 8.002, 11.18, 4.843], rtol=3e-4)
    np.testing.assert_allclose(drives.viscous, [8.479, 15.07, 3.47, 3.646, 1.6, 1.778], rtol=3e-4)
    np.testing.assert_allclose(drives.inertia, [2.69, 6.677, 0.7476, 0.275, 0.2359, 0.08161], rtol=3e-4)


@pytest.mark.parametrize(("payload", "coulomb"), [(2.0, 6.9822), (15.0, 42.0)])
def test_the_measured_arms_themselves(payload, coulomb):
    assert nominal_drives(payload).coulomb[0] == pytest.approx(coulomb)
