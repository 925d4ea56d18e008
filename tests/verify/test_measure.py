"""Counting on made-up joints, where the answer is known."""

import numpy as np

from zerorev.model.profile import Profile
from zerorev.verify.measure import mean_rates, path_steps, rates, reversals, travel
from zerorev.verify.path import Path, Track, around, blend, legs, with_blend


def made_up(columns):
    joints = np.array(columns, dtype=float).T
    standoff = np.abs(np.linspace(-0.05, 0.05, joints.shape[0]))
    return Track(Path(standoff, np.zeros_like(standoff), (), int(standoff.argmin())), joints)


def test_a_pause_is_no_reversal_and_a_turn_after_a_pause_is_one():
    track = made_up(
        [
            [0, 1, 2, 3, 4],
            [0, 1, 1, 1, 2],
            [0, 1, 1, 1, 0],
            [0, 1, 0, 1, 0],
            [5, 5, 5, 5, 5],
            [0, -1, -2, -1, -3],
        ]
    )
    assert reversals(track) == ((), (), (3,), (1, 2, 3), (), (2, 3))


def test_steps_of_rounding_size_have_no_direction():
    wobble = np.array([0, 1, 0, 1, 0])
    per_step = np.deg2rad(1e-9) * 25  # 1e-9 deg/mm over steps of 25 mm
    assert reversals(made_up([wobble * 0.9 * per_step] * 6)) == ((),) * 6
    assert reversals(made_up([wobble * 1.1 * per_step] * 6)) == ((1, 2, 3),) * 6
    close = made_up([wobble * 0.9e-12] * 6)
    close = Track(close.path._replace(standoff=close.path.standoff * 1e-4), close.joints)
    assert reversals(close) == ((),) * 6
    assert reversals(Track(close.path, close.joints * 1.2)) == ((1, 2, 3),) * 6


def test_nan_is_not_counted():
    assert reversals(made_up([[0, np.nan, 2, 1, 0]] * 6)) == ((),) * 6


def test_travel_and_rates():
    track = made_up([[0, 1, 2, 1, 3]] * 6)
    assert travel(track) == 6 * 5
    np.testing.assert_allclose(path_steps(track), 0.025)
    np.testing.assert_allclose(rates(track)[:, 0], np.array([1, 1, 1, 2]) / 0.025)
    np.testing.assert_allclose(mean_rates(track), 2 / 0.05)


def test_legs_are_even_and_hold_every_breakpoint_exactly():
    profile = Profile([0.05, 0.031, 0.0300001, 0.0, 0.013, 0.05], [0.1, 0.2, -0.7, 0.3, 0.4, 1.1])
    path = legs(profile, 1_000)
    knots = list(path.knots)
    assert path.standoff[knots].tolist() == profile.standoff.tolist()
    assert path.psi[knots].tolist() == profile.psi.tolist()
    assert path.standoff[path.corner] == 0
    steps = np.abs(np.diff(path.standoff))
    assert steps.max() < 1.05 * 0.1 / 1_000
    assert knots[2] - knots[1] == 16  # the narrow kink is looked at closely all the same
    between = profile.at(np.concatenate([[0.0], np.cumsum(steps)]))
    np.testing.assert_allclose(path.psi, between[1], atol=1e-9)


def test_the_blend_is_a_parabola_between_the_legs():
    profile = Profile.straight(0.05, 0.4, 0.0, -0.2)
    path = blend(profile, profile.corner, 0.01, 1001)
    np.testing.assert_allclose([path.standoff[0], path.standoff[-1]], 0.01)
    np.testing.assert_allclose([path.psi[0], path.psi[-1]], [0.08, -0.04])
    np.testing.assert_allclose(path.standoff.min(), 0.005)  # radius / 2 short of the corner (theory §5)
    np.testing.assert_allclose(path.psi[500], (0.08 + 0 - 0.04) / 4)
    entry = np.diff(path.psi)[0] / np.diff(path.standoff)[0]
    np.testing.assert_allclose(entry, 0.4 / 0.05, rtol=2e-3)


def test_the_blend_is_clipped_to_half_the_shorter_neighbour():
    profile = Profile([0.05, 0.004, 0.0, 0.05], [0.0, 0.4, 0.2, 0.0])
    path = blend(profile, profile.corner, 0.01, 101)
    np.testing.assert_allclose(path.standoff[[0, -1]], 0.002)
    deeper = blend(Profile.straight(0.05, 0.0, 0.1, 0.0, corner=-0.001), 1, 0.002, 101)
    np.testing.assert_allclose([deeper.standoff[0], deeper.standoff.min()], [0.001, 0.0], atol=1e-15)


def test_a_blended_track_leaves_the_legs_and_comes_back_to_them():
    profile = Profile.straight(0.05, 0.4, 0.0, -0.2)
    path, curve = legs(profile, 1000), blend(profile, profile.corner, 0.01, 101)
    track, cut = (Track(p, np.tile(p.psi[:, None], 6)) for p in (path, curve))
    whole, first, last = with_blend(track, cut, *around(path, profile.corner, curve))
    assert (np.diff(whole.path.standoff[: whole.path.corner + 1]) < 0).all()
    assert (np.diff(whole.path.standoff[whole.path.corner :]) > 0).all()
    assert np.abs(np.diff(whole.path.psi)).max() < 2e-3
    assert last - first == 100
    np.testing.assert_array_equal(whole.part(first, last).joints, cut.joints)
