"""Splits, blends and breakpoints of a program's points."""

import numpy as np
import pytest

from zerorev.model.job import Settings
from zerorev.model.profile import Profile
from zerorev.program.waypoints import GREATEST_TURN, waypoints, with_blends


def psi_deg(points):
    return [pytest.approx(np.rad2deg(point.psi)) for point in points]


def standoff_mm(points):
    return [pytest.approx(point.standoff * 1e3) for point in points]


def test_the_lead_in_continues_with_the_slope_of_the_plunge():
    points, corner = waypoints(Profile.straight(0.05, *np.deg2rad([20, -5, -30])), 5e-3)
    assert standoff_mm(points) == [55, 50, 0, 50]
    assert psi_deg(points) == [22.5, 20, -5, -30]
    assert [point.leg for point in points] == ["lead-in", "lead-in", "plunge", "retract"]
    assert corner == 2


def test_without_lead_in_the_start_comes_first():
    points, corner = waypoints(Profile.straight(0.05, 0.1, 0.0, -0.1), 0.0)
    assert standoff_mm(points) == [50, 0, 50]
    assert corner == 1


@pytest.mark.parametrize(
    ("turn_deg", "pieces"), [(119.9, 1), (120.0, 1), (120.1, 2), (240.0, 2), (300.0, 3), (-300.0, 3)]
)
def test_a_leg_is_split_so_that_no_move_turns_more_than_120_deg(turn_deg, pieces):
    points, corner = waypoints(Profile.straight(0.03, *np.deg2rad([turn_deg, 0, 10])), 0.0)
    assert corner == pieces
    psi = np.array([point.psi for point in points])
    assert (np.abs(np.diff(psi)) <= GREATEST_TURN + 1e-12).all()
    np.testing.assert_allclose(np.rad2deg(psi[: pieces + 1]), np.linspace(turn_deg, 0, pieces + 1), atol=1e-9)
    np.testing.assert_allclose([p.standoff for p in points[: pieces + 1]], np.linspace(0.03, 0, pieces + 1), atol=1e-12)


def test_a_steep_lead_in_is_split_too():
    points, corner = waypoints(Profile.straight(0.01, *np.deg2rad([100, 0, -10])), 15e-3)
    assert psi_deg(points) == [250, 175, 100, 0, -10]
    assert standoff_mm(points) == [25, 17.5, 10, 0, 10]
    assert corner == 3


def test_every_breakpoint_is_named():
    profile = Profile(np.array([40, 25, 10, 0, 20, 40]) * 1e-3, np.deg2rad([30, 20, 5, 0, -10, -40]))
    points, corner = waypoints(profile, 0.0)
    assert standoff_mm(points) == [40, 25, 10, 0, 20, 40]
    assert psi_deg(points) == [30, 20, 5, 0, -10, -40]
    assert corner == 3
    assert [point.comment for point in points[1:]] == ["breakpoint"] * 2 + ["target", "breakpoint", "end of the stroke"]


def test_a_deeper_corner_says_so():
    points, corner = waypoints(Profile.straight(0.05, 0.1, 0.0, -0.1, corner=-5e-4), 0.0)
    assert points[corner].comment == "corner, 0.5 mm below the target"


def blends_mm(profile, lead_in, blend):
    points, corner = waypoints(profile, lead_in)
    return [pytest.approx(point.blend * 1e3) for point in with_blends(points, corner, Settings(blend=blend))]


def test_every_inner_point_is_blended_and_the_ends_are_not():
    assert blends_mm(Profile.straight(0.05, 0.3, 0.0, -0.3), 5e-3, 1e-3) == [0, 1, 1, 0]


def test_a_blend_is_clipped_to_half_the_shorter_neighbour():
    assert blends_mm(Profile.straight(0.012, 0.3, 0.0, -0.3), 5e-3, 10e-3) == [0, 2.5, 6, 0]
    profile = Profile(np.array([40, 4, 0, 40]) * 1e-3, np.array([0.3, 0.1, 0.0, -0.3]))
    assert blends_mm(profile, 0.0, 10e-3) == [0, 2, 2, 0]


def test_an_exact_stop_at_the_corner_is_not_a_stop_elsewhere():
    passing = Settings(blend=0.0).passing_blend * 1e3
    assert blends_mm(Profile.straight(0.05, 0.3, 0.0, -0.3), 5e-3, 0.0) == [0, passing, 0, 0]


def test_without_a_feed_of_its_own_the_way_in_is_not_cut_at_the_target():
    """Also where the corner lies below it."""
    profile = Profile.straight(50e-3, 0.3, 0.0, -0.4, corner=-1e-3)
    points, corner = waypoints(profile, 0.0)
    assert (len(points), corner) == (3, 1)
    points, corner = waypoints(profile, 0.0, last=3e-3)
    assert [round(point.standoff * 1e3, 9) for point in points] == [50, 3, -1, 50]
    assert corner == 2
