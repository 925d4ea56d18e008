"""Pairs of legs out of the target line: of one spin, of a coarse sample at many, and of the bottom of a valley."""

from __future__ import annotations

import numpy as np
import pytest

from oracles import legs as twin
from oracles.starts import ALL_JOINTS, ROBOTS, SLOW, TOOL, Start, asked, starts
from zerorev.kernels import field, leg_search, legs, pairs, weigh
from zerorev.model.hole import Hole

NODES = 24
EVERY_BRANCH = np.ones(8, dtype=bool)


def wide(start, **how):
    """What is asked where no limit is in the way: any motion of up to 1.7 rad fits with one of a few turns."""
    return asked(start.robot, start.hole, **how)._replace(lower=np.full(6, -4.0), upper=np.full(6, 4.0))


def best_pair(start, wanted, *, keep=ALL_JOINTS, mode=legs.TRAVEL, branches=None, bound=np.inf):
    """Columns of `pairs`; of the start's own branch alone unless others are named."""
    out, work = np.empty(pairs.COLUMNS), np.empty(field.ROOM)
    branches = np.arange(8) == start.branch if branches is None else branches
    at = start.robot.arm, start.plane, start.branch // 2, start.psi_t
    pairs.best_pair(*at, keep, wanted, wanted.unlimited(), branches, mode, NODES, bound, work, out)
    return out


def reaches(start, pair):
    """Least and greatest angle of each joint on both legs, relative to the target, shape (2, 6), by dense samples."""
    slopes = pair[[pairs.SLOPE_ABOVE, pairs.SLOPE_BELOW]]
    found = [twin.trace(start.robot, TOOL, start.hole, start.branch, start.psi_t, slope) for slope in slopes]
    if any(leg is None for leg in found):
        return None
    angles = np.concatenate([leg.angles for leg in found])
    return np.array([angles.min(axis=0), angles.max(axis=0)])


def promising(count, seed, robots=ROBOTS, deepest=0.03):
    """Random starts out of which a pair without reversals can be run, limits aside, and that pair."""
    found = []
    for start in starts(4 * count, seed=seed, robots=robots, deepest=deepest):
        if len(found) < count * len(robots):
            pair = best_pair(start, wide(start))
            if np.isfinite(pair[pairs.VALUE]):
                found.append((start, pair))
    return found


class TestTurns:
    def test_are_all_the_choices_there_are(self):
        rng = np.random.default_rng(6)
        for robot in ROBOTS:
            hole = Hole("any", np.array([0.5, 0.0, 0.8]), np.array([1.0, 0.0, 0.0]), 0.05)
            wanted = asked(robot, hole)
            for _ in range(3 if SLOW else 30):
                principal = rng.uniform(-np.pi, np.pi, 6)
                expected = twin.choices_of_turns(principal, wanted)
                assert pairs.turn_choices(principal, wanted) == len(expected)
                found = np.empty((len(expected), 6))
                for choice in range(len(expected)):
                    pairs.take_turns(principal, wanted, choice, found[choice])
                np.testing.assert_allclose(sorted(found.tolist()), sorted(expected), atol=1e-12)


class TestBestPair:
    def test_is_the_best_leg_of_either_side(self, robot, positions):
        for psi in np.deg2rad([-2.0, 0.0, 3.0]):
            start = Start(robot, positions[0].hole, 4, psi, 0.0)
            wanted = wide(start)
            sides = [start.best_leg(side, wanted.unlimited(), nodes=NODES) for side in (1.0, -1.0)]
            out = best_pair(start, wanted)
            # not to the last bit: the critical rates that the slopes start from come from two kernels
            assert out[pairs.VALUE] == pytest.approx(sides[0][0] + sides[1][0], rel=1e-8)
            assert out[pairs.SLOPE_ABOVE] == pytest.approx(sides[0][1], rel=1e-7)
            assert out[pairs.SLOPE_BELOW] == pytest.approx(sides[1][1], rel=1e-7)
            assert (out[pairs.BRANCH], out[pairs.SPIN]) == (4, psi)

    def test_brackets_the_critical_rates_of_the_joints_to_keep(self):
        keep = np.array([True, True, False, True, False, True])
        found = 0
        for start in starts(2 if SLOW else 8, seed=8, deepest=0.03):
            out = best_pair(start, asked(start.robot, start.hole), keep=keep)
            if np.isfinite(out[pairs.VALUE]):
                kappa = start.at_target()[1][keep]
                assert out[pairs.SLOPE_ABOVE] > kappa.max() > kappa.min() > out[pairs.SLOPE_BELOW]
                found += 1
        assert found >= (0 if SLOW else 5)

    def test_keeps_the_limits_that_the_best_pair_would_pass(self):
        """A limit is planted between where the greatest margin and where the least travel take a joint."""
        narrowed = 0
        for start, other in promising(1 if SLOW else 8, seed=16, robots=ROBOTS[:: 4 if SLOW else 1]):
            free = best_pair(start, wide(start), mode=legs.GREATEST_MARGIN)
            one, another = reaches(start, free), reaches(start, other)
            if one is None or another is None:
                continue
            i = (one[1] - another[1])[:3].argmax()  # joints that the wrist flips share
            if one[1, i] < another[1, i] + 1e-3:
                continue
            lower, upper = wide(start).lower.copy(), wide(start).upper.copy()
            joints, both = start.at_target()[0], np.arange(8) // 2 == start.branch // 2
            lower[i] = joints[i] - 2.0
            upper[i] = joints[i] + (one[1, i] + another[1, i]) / 2
            wanted = wide(start)._replace(lower=lower, upper=upper)
            out = best_pair(start, wanted, mode=legs.GREATEST_MARGIN, branches=both)
            assert free[pairs.VALUE] <= out[pairs.VALUE] < np.inf
            assert (out[[pairs.SLOPE_ABOVE, pairs.SLOPE_BELOW]] != free[[pairs.SLOPE_ABOVE, pairs.SLOPE_BELOW]]).any()
            assert both[int(out[pairs.BRANCH])]
            held = Start(start.robot, start.hole, int(out[pairs.BRANCH]), start.psi_t, 0.0)
            low, high = held.at_target()[0] + reaches(held, out)
            turns = np.ceil((lower - low - 1e-5) / (2 * np.pi))
            assert (high + 2 * np.pi * turns <= upper + 1e-5).all()
            narrowed += 1
        assert narrowed >= (0 if SLOW else 5)

    @pytest.mark.parametrize("mode", [legs.TRAVEL, legs.GREATEST_MARGIN, legs.PLUNGE_ROTATION])
    def test_a_bound_above_the_answer_does_not_change_it(self, mode):
        below = 0
        for start, _ in promising(1 if SLOW else 4, seed=17, robots=ROBOTS[:: 4 if SLOW else 1]):
            wanted, both = asked(start.robot, start.hole), np.arange(8) // 2 == start.branch // 2
            answer = best_pair(start, wanted, mode=mode, branches=both)
            if not np.isfinite(answer[pairs.VALUE]):
                continue
            above = answer[pairs.VALUE] + 1e-6
            np.testing.assert_array_equal(best_pair(start, wanted, mode=mode, branches=both, bound=above), answer)
            # and one below it leaves no answer that is better than the bound
            under = answer[pairs.VALUE] - 1e-3
            assert best_pair(start, wanted, mode=mode, branches=both, bound=under)[pairs.VALUE] >= under
            below += 1
        assert below >= (0 if SLOW else 8)

    def test_out_of_reach_there_is_none(self, robot):
        far = Hole("far", np.array([3.0, 0.0, 0.8]), np.array([1.0, 0.0, 0.0]), 0.02)
        out = best_pair(Start(robot, far, 0, 0.0, 0.0), asked(robot, far))
        assert out[pairs.VALUE] == np.inf
        assert out[pairs.MARGIN] == -np.inf


def sample_line(robot, plane, psi, wanted, *, keep=ALL_JOINTS, mode=legs.TRAVEL, branches=EVERY_BRANCH, enough=-np.inf):
    """Value, margin and guess at every spin, shapes (4, K)."""
    out = np.empty((4, psi.size, pairs.SAMPLED))
    lines = np.repeat(branches[:, None], psi.size, axis=1)
    pairs.sample_line(robot.arm, plane, psi, lines, keep, wanted, mode, enough, out)
    return np.moveaxis(out[..., :3], -1, 0)


class TestSampleLine:
    def test_guesses_the_value_and_the_margin(self):
        """The value to within 5 %; a pair that lies between the slopes that are examined may be missed."""
        guessed = missed = 0
        for start, _ in promising(1 if SLOW else 6, seed=18, robots=ROBOTS[:: 2 if SLOW else 1]):
            wanted, posture = wide(start), start.branch // 2
            psi = start.psi_t + np.linspace(-0.1, 0.1, 3 if SLOW else 9)
            value, margin, _ = sample_line(start.robot, start.plane, psi, wanted)
            for n, spin in enumerate(psi):
                at = Start(start.robot, start.hole, start.branch, spin, 0.0)
                least = best_pair(at, wanted)[pairs.VALUE]
                greatest = least_of_greatest(at, wanted)
                assert margin[posture, n] >= greatest - 1e-9
                assert (value[posture, n] < np.inf) == (margin[posture, n] >= wanted.min_rate)
                if np.isfinite(least):
                    guessed += np.isfinite(value[posture, n])
                    missed += not np.isfinite(value[posture, n])
                    assert SLOW or not np.isfinite(value[posture, n]) or 0.95 < value[posture, n] / least < 1.05
        assert guessed >= (0 if SLOW else 80)
        assert missed <= 0.05 * guessed

    def test_the_gentlest_pair_turns_one_leg_little(self):
        compared = 0
        for start, _ in promising(1 if SLOW else 4, seed=19, robots=ROBOTS[:: 4 if SLOW else 1]):
            wanted, psi = wide(start), np.array([start.psi_t])
            value = sample_line(start.robot, start.plane, psi, wanted, mode=legs.PLUNGE_ROTATION)[0][
                start.branch // 2, 0
            ]
            least = best_pair(start, wanted, mode=legs.PLUNGE_ROTATION)[pairs.VALUE]
            if np.isfinite(value):
                assert abs(value - least) <= 0.05 * abs(least) + 0.02 * wanted.steepest
                compared += 1
        assert compared >= (0 if SLOW else 8)

    def test_legs_that_no_turns_bring_within_the_limits_are_left_out_and_no_others(self):
        pruned = kept = 0
        for start in starts(1 if SLOW else 40, seed=20, robots=ROBOTS[:: 4 if SLOW else 1], deepest=0.03):
            psi, posture = np.array([start.psi_t]), start.branch // 2
            wanted, both = asked(start.robot, start.hole), np.arange(8) // 2 == posture
            _, margin, _ = sample_line(start.robot, start.plane, psi, wanted, branches=both)
            greatest = least_of_greatest(start, wanted, within=True)
            assert margin[posture, 0] >= greatest - 1e-9
            _, without, _ = sample_line(start.robot, start.plane, psi, wide(start), branches=both)
            pruned += greatest <= margin[posture, 0] < without[posture, 0] - 1e-6
            kept += greatest > -np.inf
        assert pruned >= (0 if SLOW else 20)
        assert kept >= (0 if SLOW else 20)

    def test_only_the_lines_asked_for_are_examined(self, robot, positions):
        plane = Start(robot, positions[0].hole, 4, 0.0, 0.0).plane
        psi = np.linspace(-0.2, 0.2, 3)
        wanted = asked(robot, positions[0].hole)
        whole = np.array(sample_line(robot, plane, psi, wanted))
        alone = np.array(sample_line(robot, plane, psi, wanted, branches=np.arange(8) == 4))
        assert np.isfinite(alone[:, 2]).all()
        assert (alone[0, [0, 1, 3]] == np.inf).all()
        assert (alone[1, [0, 1, 3]] == -np.inf).all()
        assert (alone[1] <= whole[1]).all()

    def test_with_too_little_margin_on_one_side_the_other_is_left_out(self, robot, positions):
        plane = Start(robot, positions[0].hole, 4, 0.0, 0.0).plane
        psi = np.linspace(-3, 3, 12 if SLOW else 60)
        wanted = asked(robot, positions[0].hole)
        whole = np.array(sample_line(robot, plane, psi, wanted))
        enough = np.median(whole[1][np.isfinite(whole[1])])
        left = np.array(sample_line(robot, plane, psi, wanted, enough=enough))
        more = whole[1] > enough
        assert 0 < more.sum() < np.isfinite(whole[1]).sum()
        np.testing.assert_array_equal(left[:, more], whole[:, more])
        assert (left[1, ~more] <= enough).all()
        assert (left[1] >= whole[1]).all()


def least_of_greatest(start, wanted, within=False):
    """The margin of the better candidate of each side, of the worse side; of those within the limits, if asked."""
    _, kappa, sense = start.at_target()
    sides, slopes, leg = [], np.empty(leg_search.MAX_SLOPES), np.empty((legs.ROWS, 6))
    other = Start(start.robot, start.hole, start.branch ^ 1, start.psi_t, 0.0)
    flips = [(False, start.at_target()[0]), (True, other.at_target()[0])]
    for side in (1.0, -1.0):
        count = leg_search.slope_candidates(kappa, ALL_JOINTS, side, start.psi_t, wanted, slopes)
        at, work = (start.robot.arm, start.plane, start.branch, start.psi_t), np.empty(field.ROOM)
        greatest = -np.inf
        for slope in slopes[:count]:
            if not legs.trace_leg(*at, slope, start.hole.depth, 94, work, leg):
                continue
            if not within or any(pairs.turns_fit(leg, leg, flipped, joints, wanted) for flipped, joints in flips):
                held = side * sense, ALL_JOINTS, flips[0][1]
                greatest = max(greatest, weigh.weigh_leg(*at, slope, held, wanted, 94, work)[0])
        sides.append(greatest)
    return min(sides)


def descend(start, low, high, wanted, *, mode=legs.TRAVEL, steps=40, bound=np.inf):
    best, branches = np.empty(pairs.COLUMNS), np.arange(8) == start.branch
    at = start.robot.arm, start.plane, start.branch // 2, low, high
    args = ALL_JOINTS, wanted, wanted.unlimited(), branches, mode, NODES, steps, bound
    pairs.descend(*at, *args, best)
    return best


def scan(start, spins, wanted, mode=legs.TRAVEL):
    """Values and margins of `best_pair` at many spins."""
    found = [best_pair(Start(start.robot, start.hole, start.branch, spin, 0.0), wanted, mode=mode) for spin in spins]
    return np.array(found)[:, [pairs.VALUE, pairs.MARGIN]].T


@pytest.mark.skipif(SLOW, reason="thousands of pairs")
class TestDescend:
    def test_finds_the_least_of_a_dense_scan(self):
        """Where the scan shows one valley."""
        compared = 0
        for start, _ in promising(6, seed=21):
            wanted, low, high = wide(start), start.psi_t - 0.03, start.psi_t + 0.03
            values, _ = scan(start, np.linspace(low, high, 121), wanted)
            if not (np.isfinite(values).all() and (np.diff(np.sign(np.diff(values))) != 0).sum() <= 1):
                continue
            found = descend(start, low, high, wanted)
            assert found[pairs.VALUE] <= values.min() * (1 + 1e-6) + 1e-6
            at = Start(start.robot, start.hole, start.branch, found[pairs.SPIN], 0.0)
            np.testing.assert_array_equal(best_pair(at, wanted), found)
            compared += 1
        assert compared >= 8

    @pytest.mark.parametrize("width", [0.05, 0.005])
    def test_finds_a_thin_window(self, width):
        """A threshold just below the greatest margin leaves a window of about `width` [deg] around its place."""
        rng, found, tried = np.random.default_rng(22), 0, 0
        for start, _ in promising(12, seed=23):
            spins = start.psi_t + np.linspace(-0.03, 0.03, 61)
            _, margins = scan(start, spins, wide(start), legs.GREATEST_MARGIN)
            top = margins.argmax()
            turns = (np.diff(np.sign(np.diff(margins))) != 0).sum()
            if not (5 < top < 55 and turns == 1 and margins.max() > 0.05):
                continue
            half = np.deg2rad(width) / 2
            fine = spins[top] + np.linspace(-1e-3, 1e-3, 201)
            _, close = scan(start, fine, wide(start), legs.GREATEST_MARGIN)
            peak = fine[close.argmax()]
            _, edges = scan(start, [peak - half, peak + half], wide(start), legs.GREATEST_MARGIN)
            if close.max() - edges.max() < 1e-4:
                continue  # a blunt peak, whose width says little about how hard it is to hit
            planted = wide(start, min_rate=edges.max())
            for _ in range(4):
                low, high = peak - rng.uniform(0.2, 1) * 0.02, peak + rng.uniform(0.2, 1) * 0.02
                best = descend(start, low, high, planted)
                found += np.isfinite(best[pairs.VALUE]) and abs(best[pairs.SPIN] - peak) < 1.1 * np.deg2rad(width)
                tried += 1
        assert tried >= 8
        assert found == tried

    def test_a_bound_is_not_an_answer(self):
        """What is not better than what is known already may be wrong, but it is not better, either."""
        compared = 0
        for start, _ in promising(2, seed=24):
            wanted, low, high = asked(start.robot, start.hole), start.psi_t - 0.03, start.psi_t + 0.03
            answer = descend(start, low, high, wanted)
            if np.isfinite(answer[pairs.VALUE]):
                under = answer[pairs.VALUE] - 1e-3
                assert descend(start, low, high, wanted, bound=under)[pairs.VALUE] >= under
                compared += 1
        assert compared >= 3

    def test_out_of_reach_finds_none(self, robot):
        far = Hole("far", np.array([3.0, 0.0, 0.8]), np.array([1.0, 0.0, 0.0]), 0.02)
        best = descend(Start(robot, far, 0, 0.0, 0.0), -0.1, 0.1, asked(robot, far))
        assert best[pairs.VALUE] == np.inf
        assert best[pairs.MARGIN] == -np.inf
