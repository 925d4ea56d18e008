"""Counting on made-up joints, where the answer is known."""

import numpy as np
import pytest

from oracles import counting
from zerorev.model.profile import Profile
from zerorev.verify.measure import mean_rates, reversals, reversals_through, slowest_at, travel
from zerorev.verify.path import Path, Track, around, blend, joined, legs


def made_up(columns):
    joints = np.array(columns, dtype=float).T
    standoff = np.abs(np.linspace(-0.05, 0.05, joints.shape[0]))
    return Track(Path(standoff, np.zeros_like(standoff), (), int(standoff.argmin())), joints)


def test_a_pause_is_not_a_reversal_and_a_turn_after_a_pause_is_one():
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
    np.testing.assert_allclose(track.path_steps, 0.025)
    np.testing.assert_allclose(track.moves.slowest, 1 / 0.025)
    np.testing.assert_allclose([track.moves.least, track.moves.most], [[-1] * 6, [2] * 6])
    assert [slowest_at(made_up([[0, 2, 4, 3, 1]] * 6), joint) for joint in range(6)] == [2] * 6
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
    assert knots[2] - knots[1] == 16  # the narrow kink is examined closely all the same
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
    before, behind = around(track, profile.corner, curve)
    piece = joined(track, cut, before, behind)
    corner = piece.path.corner
    assert (np.diff(piece.path.standoff[: corner + 1]) < 0).all()
    assert (np.diff(piece.path.standoff[corner:]) > 0).all()
    assert np.abs(np.diff(piece.path.psi)).max() < 2e-3
    np.testing.assert_array_equal(piece.joints[1:-1], cut.joints)
    np.testing.assert_array_equal(piece.joints[[0, -1]], track.joints[[before, behind]])


@pytest.mark.parametrize(("k", "leg"), [(1, "plunge"), (3, "retract")])
def test_a_blend_within_a_leg_lies_on_that_leg(k, leg):
    profile = Profile([0.05, 0.03, 0.0, 0.02, 0.05], [0.0, 0.1, -0.1, 0.2, 0.1])
    path, curve = legs(profile, 1000), blend(profile, k, 0.01, 11)
    track, cut = (Track(p, np.tile(p.psi[:, None], 6)) for p in (path, curve))
    piece = joined(track, cut, *around(track, k, curve))
    assert all(piece.path.place(i).startswith(f"on the {leg}") for i in range(13))


class TestThroughABlend:
    """Counted on the blend's own samples, against the slow twin that counts the whole blended motion."""

    def motion(self, rng, count, pause):
        """Joints on a random walk that pauses, is NaN now and then, and keeps its way for a while."""
        ways = np.sign(rng.normal(size=(count, 6))) * rng.choice(
            [0.0, 0.5e-12, 1e-4], (count, 6), p=[pause, 0.1, 0.9 - pause]
        )
        steps = np.where(rng.uniform(size=(count, 6)) < 0.8, np.abs(ways), ways) * np.sign(rng.normal(size=6))
        joints = np.cumsum(steps, axis=0)
        joints[rng.uniform(size=joints.shape) < rng.choice([0.0, 0.01])] = np.nan
        return joints

    @pytest.mark.parametrize("seed", range(40))
    def test_counts_and_places_are_those_of_the_whole_motion(self, seed):
        rng = np.random.default_rng(seed)
        profile = Profile([0.05, 0.03, 0.0, 0.02, 0.05], rng.uniform(-1, 1, 5))
        path, k, pause = legs(profile, 600), int(rng.integers(1, 4)), rng.choice([0.05, 0.85])
        curve = blend(profile, k, rng.choice([1e-3, 8e-3]), int(rng.integers(2, 60)))
        track = Track(path, self.motion(rng, path.psi.size, pause))
        before, behind = around(track, k, curve)
        smooth = rng.uniform() < 0.3  # the blend pauses altogether
        joints = track.joints[before] + (0.0 if smooth else self.motion(rng, curve.psi.size, pause))
        piece = joined(track, Track(curve, np.broadcast_to(joints, (curve.psi.size, 6))), before, behind)
        turned = reversals(track)
        assert turned == counting.reversals_of(track)
        assert sum(map(len, turned)) > 0
        expected = counting.reversals_through(track, piece, before, behind)
        assert reversals_through(track, turned, piece, before, behind) == expected

    def test_steady_joints_are_passed_over(self):
        """All joints run one way, but for a blend that turns two of them round."""
        profile = Profile.straight(0.05, 0.4, 0.0, -0.2)
        path, curve = legs(profile, 1000), blend(profile, 1, 0.01, 101)
        track = Track(path, np.linspace(0, 1, path.psi.size)[:, None] * np.array([1, -1, 1, -1, 1, -1.0]))
        before, behind = around(track, 1, curve)
        ends = track.joints[[before, behind]]
        bent = ends[0] + np.linspace(0, 1, 103)[1:-1, None] * (ends[1] - ends[0])
        bent[:, 2:4] += 0.5 * np.sin(np.linspace(0, np.pi, 101))[:, None]
        piece = joined(track, Track(curve, bent), before, behind)
        found = reversals_through(track, reversals(track), piece, before, behind)
        assert [len(places) for places in found] == [0, 0, 2, 2, 0, 0]
        assert found == counting.reversals_through(track, piece, before, behind)
