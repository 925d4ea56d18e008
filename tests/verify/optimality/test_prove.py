"""The check of logged proofs: what it says of a box holds, true proofs are confirmed, and no lie is."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import zerorev as zr
from oracles import boxes, holes
from oracles.proof_trees import THESIS, around, by_hand, logged, without_node
from zerorev.errors import InputError
from zerorev.model.proof_tree import NO_VALUE, Claim
from zerorev.motion import kinematics
from zerorev.motion.drilling import Drilling, joint_rates
from zerorev.search.bounds.proof import prove
from zerorev.search.problem import Problem

pytest.importorskip("flint")

from flint import arb

from zerorev.verify.certificate.piece import ball_arithmetic
from zerorev.verify.optimality.arm import arm_of, directions, rates_at, root_of
from zerorev.verify.optimality.box import Box, Examiner, denominators
from zerorev.verify.optimality.legs import MID_SHARES, BoxLegs
from zerorev.verify.optimality.prove import check_tree

RATE = float(np.deg2rad(10.0))  # 0.01 deg/mm


def position(k):
    target, depth = THESIS[k]
    return zr.Hole("1", target=target, direction=[1, 0, 0], depth=depth)


@pytest.fixture(scope="module")
def second(kuka, drill):
    """The best motion at the second position, and its proof."""
    return logged(kuka, drill, position(1), RATE)


class TestTheArm:
    def test_has_the_rates_and_angles_of_the_kinematics(self):
        compared = 0
        rng = np.random.default_rng(0)
        for seed in range(12):
            robot, tool, hole, _ = holes.random_hole(seed).all
            arm, sign = arm_of(robot.arm, tool, hole), np.array(robot.arm.sign)
            for _ in range(4):
                psi, s = rng.uniform(-3, 3), rng.uniform(0, hole.depth)
                outwards, spinning = joint_rates(Drilling(robot, tool, hole), s, psi)
                T = kinematics.tcp_pose(hole, s, psi) @ np.linalg.inv(tool.T_flange_tcp)
                joints = kinematics.inverse(robot, T)
                for posture in range(4):
                    branch = 2 * posture + (0 if sign[4] > 0 else 1)
                    if np.isnan(outwards[branch]).any():
                        continue
                    with ball_arithmetic():
                        turn = arb(psi).cos(), arb(psi).sin()
                        at = rates_at(arm, posture, arb(s), turn, root_of, [])
                        angles = np.array([float(arb.atan2(*pair[::-1])) for pair in directions(arm, turn, at)])
                    h, s2 = float(at.height), float(at.sine_2)
                    den = np.array([1, h, h, h * s2, h * np.sqrt(s2), h * s2])
                    for own, theirs in ((at.outwards, outwards), (at.spinning, spinning)):
                        found = np.array([float(rate) for rate in own]) / den * sign
                        np.testing.assert_allclose(found, theirs[branch], rtol=1e-9, atol=1e-9)
                    angles[2] -= angles[1]
                    model = joints[branch] * sign - np.array(robot.arm.offset)
                    off = np.abs((angles - model + np.pi) % (2 * np.pi) - np.pi)
                    assert off.max() < 1e-9
                    compared += 1
        assert compared > 60


def within_limits(robot, angles, flip):
    """Whether some turns keep model angles within the limits on a wrist flip."""
    sign, offset = np.array(robot.arm.sign), np.array(robot.arm.offset)
    ends = np.sort(np.stack([robot.limits.lower, robot.limits.upper]) * sign - offset, axis=0)
    angles = angles.copy()
    if flip:
        angles[:, 4] *= -1
        angles[:, [3, 5]] += np.pi
    turns = np.ceil((ends[0] - angles.min(axis=0)) / (2 * np.pi)) * 2 * np.pi
    return bool((angles.max(axis=0) + turns <= ends[1]).all())


def check_a_box(rng, drilled):
    """Legs drawn from a box against what is said of it; how many legs could be run."""
    robot, tool, hole, _ = drilled.all
    width = 10.0 ** rng.uniform(-4, -0.5)
    psi, twist, wide = rng.uniform(-np.pi, np.pi), rng.normal() * 1.5, width * rng.uniform(0.3, 3)
    slopes = (twist - wide / 2) / hole.depth, (twist + wide / 2) / hole.depth
    box = Box(psi - width / 2, psi + width / 2, *slopes)
    min_rate, posture = float(rng.choice([0.0, RATE])), int(rng.integers(4))
    claim = Claim(hole.depth, min_rate, 0.0, None, np.ones(6), 60.0, NO_VALUE)
    with ball_arithmetic():
        legs = BoxLegs(Examiner(robot, tool, hole, claim, posture), box, MID_SHARES)
        while legs.sample_closer():
            pass
    run = 0
    for _ in range(4):
        psi_t = rng.choice([box.low, box.high, rng.uniform(box.low, box.high)])
        slope = rng.choice([*slopes, rng.uniform(*slopes)])
        leg = boxes.leg(drilled, posture, psi_t, slope)
        if leg is None:
            continue
        run += 1
        in_limits = [within_limits(robot, leg["angles"], flip) for flip in range(2)]
        if legs.dead is not None:
            assert not any(in_limits)
            continue
        for i in range(6):
            side = legs.forth if leg["first"][i] >= 0 else legs.back
            assert leg["turns"][i] >= side[i] or leg["first"][i] == 0
            if leg["turns"][i] == 0 and np.abs(leg["rates"][:, i]).min() >= max(min_rate, 1e-9) * (1 + 1e-6):
                assert legs.may[i][0 if leg["first"][i] > 0 else 1]
        away = arb(psi_t - 0.5 * (box.low + box.high))
        aside = arb(slope - np.mean(slopes))
        least = legs.least - abs(legs.by_psi * away) - abs(legs.by_slope * aside)
        assert leg["travel"] >= float(least.lower()) - 1e-6
        assert leg["travel"] >= float(legs.twist) - 1e-9
        for flip in range(2):
            if in_limits[flip]:
                assert all(lo <= hi for lo, hi in legs.turns[flip])
        for i, share in ((int(rng.integers(6)), float(rng.uniform())) for _ in range(3)):
            with ball_arithmetic():
                held = check_a_condition(legs, i, share, float(rng.choice([-1, 1])), psi_t, slope)
            assert held is not False
    return run


def check_a_condition(legs, i, share, way, psi_t, slope):
    """Whether the enclosure of a condition holds that of a leg; None where there is none."""
    condition, of, extent = legs.condition(i, share, way), legs.of, legs.extent
    if condition is None:
        return None
    standoff = of.depth * arb(share)
    psi = arb(psi_t) + standoff * arb(slope)
    at = rates_at(of.arm, of.posture, standoff, (psi.cos(), psi.sin()), root_of, [])
    least = of.threshold if of.threshold > 0 else -of.nil
    truth = way * (at.outwards[i] + arb(slope) * at.spinning[i]) - least * denominators(at)[i]
    unit = denominators(of.sample(extent, share).centre)[i].mid()
    middle, by_psi, by_slope = condition
    said = middle + by_psi * (arb(psi_t) - extent.psi) + by_slope * (arb(slope) - extent.slope)
    return said.overlaps(truth / unit)


class TestABox:
    def test_says_nothing_that_one_of_its_legs_contradicts(self):
        rng = np.random.default_rng(3)
        assert sum(check_a_box(rng, holes.random_hole(seed, narrowed=seed % 4 == 0)) for seed in range(60)) > 60

    @pytest.mark.soak
    def test_nor_do_many(self):
        rng = np.random.default_rng(4)
        assert (
            sum(check_a_box(rng, holes.random_hole(seed % 100, narrowed=seed % 4 == 0)) for seed in range(3000)) > 3000
        )


class TestATrueProof:
    def test_is_confirmed(self, kuka, drill, second):
        check = check_tree(kuka, drill, position(1), second[1], sample=25)
        assert check.verdict == "confirmed"
        assert check.boxes == 25
        assert check.of > 1000
        assert check.pairs > 0
        assert not check.failures

    def test_is_nearly_sharp(self, second):
        """The tree claims what the plan states, not something that is easier to prove."""
        best, tree = second
        assert best.score.travel * (1 - 4e-4) < tree.claim.value <= best.score.travel

    @pytest.mark.long
    @pytest.mark.parametrize("rate", [0.0, RATE])
    @pytest.mark.parametrize("k", range(3))
    def test_a_random_hundred_at_the_thesis_positions(self, kuka, drill, k, rate):
        _, tree = logged(kuka, drill, position(k), rate)
        check = check_tree(kuka, drill, position(k), tree, sample=100, seed=k)
        assert (check.verdict, check.boxes, check.undecided) == ("confirmed", 100, 0)
        assert np.isinf(check.most_reversals)

    @pytest.mark.soak
    @pytest.mark.parametrize("rate", [0.0, RATE])
    @pytest.mark.parametrize("k", range(3))
    def test_every_box_at_the_thesis_positions(self, kuka, drill, k, rate):
        _, tree = logged(kuka, drill, position(k), rate)
        check = check_tree(kuka, drill, position(k), tree)
        assert (check.verdict, check.boxes, check.undecided) == ("confirmed", check.of, 0)


class TestALie:
    """Trees of one node, so that the box that lies is sure to be checked; that they hold few legs is said besides."""

    def reported(self, kuka, drill, tree):
        check = check_tree(kuka, drill, position(1), tree)
        assert check.verdict == "refuted"
        return " ".join(check.failures)

    def test_two_legs_that_reach_the_value_are_not_called_one(self, kuka, drill, second):
        """The honest small tree: nothing is wrong with its boxes."""
        best, _ = second
        *node, slopes = around(best, best.score.travel * 0.99)
        reported = self.reported(kuka, drill, by_hand(*node, slopes, [False, False]))
        assert "less than the value" not in reported
        assert "could not be decided" not in reported
        assert "no node holds all spins" in reported

    def test_a_value_above_the_best(self, kuka, drill, second):
        best, _ = second
        *node, slopes = around(best, best.score.travel * 1.01)
        assert "have less than the value" in self.reported(kuka, drill, by_hand(*node, slopes, [False, False]))

    @pytest.mark.parametrize("leg", [0, 1])
    def test_a_dead_box_that_holds_the_best(self, kuka, drill, second, leg):
        best, _ = second
        *node, slopes = around(best, best.score.travel * 0.99)
        dead = [k == leg for k in range(2)]
        assert "is said to be impossible, and was not found to be" in self.reported(
            kuka, drill, by_hand(*node, slopes, dead)
        )

    def test_that_there_is_no_motion(self, kuka, drill, second):
        best, _ = second
        *node, slopes = around(best, NO_VALUE)
        assert "have less than the value" in self.reported(kuka, drill, by_hand(*node, slopes, [False, False]))


class TestAnUnsoundSearch:
    """Its log is whole, but what it rests on is not so: a sample of its boxes shows that."""

    def test_that_believes_in_narrower_limits(self, kuka, drill):
        limits = kuka.limits
        middle, half = (limits.lower + limits.upper) / 2, (limits.upper - limits.lower) / 2
        narrow = replace(kuka, limits=replace(limits, lower=middle - 0.6 * half, upper=middle + 0.6 * half))
        trees = []
        prove(Problem(Drilling(narrow, drill, position(1)), zr.Settings(min_rate=0.0)), None, 100_000, log=trees)
        tree = trees[0]
        assert check_tree(narrow, drill, position(1), tree, sample=20).verdict == "confirmed"
        check = check_tree(kuka, drill, position(1), tree, sample=80)
        assert check.verdict == "refuted"
        assert any("was not found to be" in failure for failure in check.failures)


class TestATreeThatLeavesSomethingOut:
    def structure(self, kuka, drill, tree):
        """What is found of the numbers alone."""
        check = check_tree(kuka, drill, position(1), tree, sample=0)
        assert check.boxes == 0
        return check

    def test_the_true_one_does_not(self, kuka, drill, second):
        assert self.structure(kuka, drill, second[1]).verdict == "confirmed"

    def test_a_half(self, kuka, drill, second):
        tree = second[1]
        parents = set(tree.parents.tolist())
        leaf = max(n for n in range(len(tree.spins)) if n not in parents and tree.parents[n] >= 0)
        check = self.structure(kuka, drill, without_node(tree, leaf))
        assert check.verdict == "refuted"
        assert f"the parts of node {tree.parents[leaf]} leave spins out" in check.failures

    def test_a_root(self, kuka, drill, second):
        tree = second[1]
        parents = set(tree.parents.tolist())
        root = next(n for n in range(len(tree.spins)) if n not in parents and tree.parents[n] < 0)
        check = self.structure(kuka, drill, without_node(tree, root))
        assert check.failures == (f"no node holds all spins on posture {tree.postures[root]}",)

    def test_a_closed_interval(self, kuka, drill, second):
        tree = second[1]
        row = next(k for k in range(len(tree.closed)) if (tree.parents == tree.closed_of[k]).any())
        keep = np.arange(len(tree.closed)) != row
        wrong = replace(tree, closed_of=tree.closed_of[keep], closed=tree.closed[keep], dead=tree.dead[keep])
        check = self.structure(kuka, drill, wrong)
        assert any("leaves slopes out" in failure for failure in check.failures)

    def test_the_last_digit_of_a_spin(self, kuka, drill, second):
        tree = second[1]
        spins = tree.spins.copy()
        child = int(np.flatnonzero(tree.parents >= 0)[0])
        spins[child, 0] = np.nextafter(spins[child, 0], np.inf)
        check = self.structure(kuka, drill, replace(tree, spins=spins))
        assert any("leave spins out" in failure for failure in check.failures)

    def test_the_steepest_slopes(self, kuka, drill, second):
        tree = second[1]
        lists, roots = tree.lists.copy(), tree.parents < 0
        lists[roots] += np.array([1, -2])
        check = self.structure(kuka, drill, replace(tree, lists=lists))
        assert "the slopes of the roots end before those that the joints' ranges allow" in check.failures

    def test_is_not_taken_where_its_arrays_do_not_fit(self, kuka, drill, second):
        tree = second[1]
        for wrong in (
            replace(tree, parents=tree.parents[:-1]),
            replace(tree, lists=tree.lists + np.array([len(tree.slopes), 0])),
            replace(tree, parents=np.arange(len(tree.parents))),
            replace(tree, spins=tree.spins[:, ::-1]),
            replace(tree, slopes=tree.slopes * np.nan),
        ):
            with pytest.raises(InputError, match="do not fit"):
                check_tree(kuka, drill, position(1), wrong)
