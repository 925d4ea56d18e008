"""Branch and bound over boxes of legs: what it says of a box holds for each of its legs, what it proves is so."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import zerorev as zr
from oracles import boxes, holes
from oracles.places import CASES
from zerorev.files.io import read_job
from zerorev.kernels import bound_boxes as kernels
from zerorev.kernels import bound_legs, bound_nodes, bound_tree
from zerorev.kernels.bound_multipliers import LEG, MOST_TERMS, TERM
from zerorev.kernels.intervals import DERIVATIVE, LANES
from zerorev.kernels.layout import BoundRules
from zerorev.motion.drilling import Drilling, joint_rates
from zerorev.search.bounds.proof import prove
from zerorev.search.bounds.straight_depth import bound_depth
from zerorev.search.bounds.tree import Search, _room, model_limits
from zerorev.search.exact import search
from zerorev.search.problem import Problem

BUDGET = 100_000
THESIS = (([0.5, 0.3, 0.8], 0.05), ([0.2, 0.4, 0.6], 0.02), ([0.2, 0.2, 1.0], 0.03))


def rules_of(drilled, *, min_rate, most_cost=80.0, samples=8):
    _, _, hole, settings = drilled.all
    lower, upper = model_limits(drilled.both[0])
    weights = np.array(settings.reversal_weights)
    bound = settings.psi_bound or 0.0
    return BoundRules(
        hole.depth, min_rate, bound, lower, upper, np.ones(2, bool), weights, most_cost, weights.min(), samples
    )


def sampled_at(samples):
    return np.array([kernels.share(samples, 0, sample) for sample in range(samples)])


def no_terms(samples):
    return np.zeros((MOST_TERMS, TERM)), 1.0, sampled_at(samples)


def examined(drilled, posture, psi, slopes, *, min_rate, groups=1, samples=8):
    """What is known of one box, and its row; None where no leg of it may exist."""
    robot, tool, hole, _ = drilled.all
    rules = rules_of(drilled, min_rate=min_rate, samples=samples)
    tree = Search(robot.arm, Drilling(robot, tool, hole).plane, rules, [posture], 1.0, 0.0)
    legs, known, _, _, room, _ = _room()
    legs[0, kernels.LOW], legs[0, kernels.HIGH] = slopes
    model = tree.models[posture]
    left, _ = bound_legs.examine(
        model, rules, no_terms(samples), np.array(psi), legs, known, 1, groups, np.zeros(0), room
    )
    return (legs[0], known[0]) if left else None


def random_box(rng, drilled):
    """Around a spin and a slope, of any size."""
    width = 10.0 ** rng.uniform(-5, -0.3)
    psi, twist = rng.uniform(-np.pi, np.pi), rng.normal() * 1.5
    wide = width * rng.uniform(0.3, 3)
    depth = drilled.hole.depth
    return (psi - width / 2, psi + width / 2), ((twist - wide / 2) / depth, (twist + wide / 2) / depth)


def check_a_box(rng, drilled):
    """Legs drawn from a box against what is said of it; how many legs could be run."""
    posture = int(rng.integers(4))
    psi, slopes = random_box(rng, drilled)
    min_rate, samples = float(rng.choice([0.0, np.deg2rad(10.0)])), int(rng.choice([4, 8]))
    groups = int(rng.choice([1, 2, 4]))
    said = examined(drilled, posture, psi, slopes, min_rate=min_rate, groups=groups, samples=samples)
    legs = []
    for _ in range(6):
        psi_t, slope = rng.choice([*psi, rng.uniform(*psi)]), rng.choice([*slopes, rng.uniform(*slopes)])
        found = boxes.leg(drilled, posture, psi_t, slope)
        if found is not None:
            legs.append((psi_t, slope, found))
    middle, centre = np.mean(psi), np.mean(slopes)
    for psi_t, slope, leg in legs:
        in_limits = within_limits(drilled, leg)
        if said is None:
            assert not in_limits.any()
            continue
        row, known = said
        for i in range(6):
            side = kernels.FORTH if leg["first"][i] >= 0 else kernels.BACK
            assert leg["turns"][i] >= known[side, i] or leg["first"][i] == 0
            if leg["turns"][i] == 0:
                slowest = np.abs(leg["rates"][:, i]).min()
                if slowest >= max(min_rate, 1e-9) * (1 + 1e-6):
                    assert known[kernels.MAY_FORTH if leg["first"][i] > 0 else kernels.MAY_BACK, i]
        low, high = row[kernels.BY_PSI_LOW], row[kernels.BY_PSI_HIGH]
        away = psi_t - middle
        along = min(low * away, high * away)
        share = abs(slope - centre) / max(slopes[1] - centre, 1e-300)
        assert leg["travel"] >= row[kernels.LEAST] + along - row[kernels.BY_SLOPE] * share - 1e-6
        assert leg["travel"] >= row[kernels.TWIST] - 1e-9
        for flip in range(2):
            if in_limits[flip]:
                assert (known[kernels.FITS + flip] != 0).all()
    return len(legs)


def check_weights(rng, drilled):
    """The travel less weighted conditions, of legs drawn from a box, against its bound; how many legs could be run."""
    robot, tool, hole, _ = drilled.all
    psi, slopes = random_box(rng, drilled)
    posture, samples = int(rng.integers(4)), int(rng.choice([4, 8]))
    rules = rules_of(drilled, min_rate=float(rng.choice([0.0, np.deg2rad(10.0)])), samples=samples)
    terms, of_travel = np.zeros((MOST_TERMS, TERM)), float(rng.integers(2))
    for term in terms[: rng.integers(1, MOST_TERMS + 1)]:
        term[:] = rng.integers(2), rng.integers(6), rng.integers(samples), rng.choice([-1, 1]), rng.exponential() * 0.1
    plane = Drilling(robot, tool, hole).plane
    model = Search(robot.arm, plane, rules, [posture], 1.0, 0.0).models[posture]

    def row_of(psi, slopes):
        rows, known, _, _, room, _ = _room()
        rows[0, kernels.LOW], rows[0, kernels.HIGH] = slopes
        aim = terms, of_travel, sampled_at(samples)
        left, _ = bound_legs.examine(model, rules, aim, np.array(psi), rows, known, 1, 1, np.zeros(0), room)
        return rows[0].copy() if left else None

    row = row_of(psi, slopes)
    at = slice(LANES, LANES + samples)
    smooth = model.unknown[DERIVATIVE, :samples] == 0.0
    units = np.where(smooth, model.rows[model.denominator_middle, at], model.rows[model.denominator[1], at])
    count = 0
    for _ in range(6):
        psi_t, slope = rng.uniform(*psi), rng.uniform(*slopes)
        truth = boxes.leg(drilled, posture, psi_t, slope)
        if truth is None or row is None or row_of((psi_t, psi_t), (slope, slope)) is None:
            continue
        dens = model.rows[model.denominator[1], at].copy()
        away, aside = psi_t - np.mean(psi), abs(slope - np.mean(slopes)) / (0.5 * (slopes[1] - slopes[0]))
        for leg in range(2):
            least, low, high, by_slope = row[kernels.WEIGHED + 4 * leg : kernels.WEIGHED + 4 * leg + 4]
            if least < -1e20:
                continue
            value = of_travel * truth["travel"]
            for _, joint, sample, way, multiplier in terms[terms[:, LEG] == leg]:
                i, j = int(joint), int(sample)
                s = kernels.share(samples, 0, j) * hole.depth
                theta_s, theta_psi = joint_rates(Drilling(robot, tool, hole), s, psi_t + slope * s)
                branch = 2 * posture + (0 if robot.arm.sign[4] > 0 else 1)
                rate = (theta_s + slope * theta_psi)[branch, i] * robot.arm.sign[i]
                spare = way * rate - (rules.min_rate or -boxes.NIL)
                value -= multiplier * spare * dens[i, j] / units[i, j] if multiplier else 0.0
            bound = least + min(low * away, high * away) - by_slope * aside
            assert value >= bound - 1e-6 * (1 + abs(bound))
            count += 1
    return count


def within_limits(drilled, leg):
    """Whether some turns keep a leg within the limits, on either wrist flip."""
    lower, upper = model_limits(drilled.both[0])
    out = []
    for flip in range(2):
        angles = leg["angles"].copy()
        if flip:
            angles[:, 4] *= -1
            angles[:, [3, 5]] += np.pi
        turns = np.ceil((lower - angles.min(axis=0)) / (2 * np.pi)) * 2 * np.pi
        out.append(bool((angles.max(axis=0) + turns <= upper).all()))
    return np.array(out)


class TestABox:
    def test_holds_the_rates_and_angles_of_its_legs(self):
        """At points: what the tapes enclose is what the kinematics have."""
        rng = np.random.default_rng(0)
        for seed in range(10):
            drilled = holes.random_hole(seed)
            robot, tool, hole, _ = drilled.all
            sign = np.array(robot.arm.sign)
            psi, twist = rng.uniform(-np.pi, np.pi), rng.normal()
            slope = twist / hole.depth
            rules = rules_of(drilled, min_rate=1.0)
            for posture in range(4):
                tree = Search(robot.arm, Drilling(robot, tool, hole).plane, rules, [posture], 1.0, 0.0)
                legs, known, _, _, room, _ = _room()
                legs[0, kernels.LOW] = legs[0, kernels.HIGH] = slope
                model = tree.models[posture]
                left, _ = bound_legs.examine(
                    model, rules, no_terms(8), np.array([psi, psi]), legs, known, 1, 1, np.zeros(0), room
                )
                truth = boxes.leg(drilled, posture, psi, slope)
                if truth is None or not left:
                    continue
                for j, share in enumerate(sampled_at(8)):
                    s = share * hole.depth
                    theta_s, theta_psi = joint_rates(Drilling(robot, tool, hole), s, psi + slope * s)
                    branch = 2 * posture + (0 if robot.arm.sign[4] > 0 else 1)
                    rate = (theta_s + slope * theta_psi)[branch] * sign
                    for i in range(6):
                        den = model.rows[model.denominator[1, i], [j, LANES + j]]
                        low, high = model.rows[model.rate[1, i], [j, LANES + j]]
                        room_for = 1e-9 * (1 + abs(rate[i])) * den[1]
                        assert low - room_for <= rate[i] * den[0] <= high + room_for
                        plus = model.rows[model.plus[1, i], [j, LANES + j]]
                        assert plus[0] - room_for <= (rate[i] - 1.0) * den[0] <= plus[1] + room_for

    def test_says_nothing_that_one_of_its_legs_contradicts(self):
        rng, legs = np.random.default_rng(1), 0
        for seed in range(60):
            legs += check_a_box(rng, holes.random_hole(seed, narrowed=bool(seed % 4 == 0)))
        assert legs > 60

    def test_weighs_conditions_as_its_legs_keep_them(self):
        rng, legs = np.random.default_rng(5), 0
        for seed in range(80):
            legs += check_weights(rng, holes.random_hole(seed))
        assert legs > 60

    @pytest.mark.long
    def test_nor_do_many(self):
        rng, legs = np.random.default_rng(2), 0
        for seed in range(800):
            legs += check_a_box(rng, holes.random_hole(seed % 100, narrowed=bool(seed % 4 == 0)))
        assert legs > 800


def problem_of(name, **changes):
    job = read_job(CASES / f"{name}.yaml")
    return Problem(Drilling(job.robot, job.tool, job.holes[0]), replace(job.settings, **changes))


class TestTheThesisPositions:
    @pytest.mark.parametrize(("target", "depth"), THESIS)
    @pytest.mark.parametrize("rate", [0.0, 10.0])
    def test_are_proven(self, robot, tool, target, depth, rate):
        """To 0.05 deg, and within the budget of a plan."""
        hole = zr.Hole("1", target=target, direction=[1, 0, 0], depth=depth)
        problem = Problem(Drilling(robot, tool, hole), zr.Settings(min_rate=float(np.deg2rad(rate))))
        best = search(Drilling(robot, tool, hole), problem.settings)
        proof = prove(problem, best, BUDGET)
        assert proof.optimality.proven
        assert proof.optimality.reversals_at_least == 0
        assert np.rad2deg(proof.best.score.travel - proof.optimality.travel_at_least) <= 0.05
        assert proof.best.score.travel <= best.score.travel

    def test_are_found_from_nothing(self, robot, tool):
        hole = zr.Hole("1", target=THESIS[0][0], direction=[1, 0, 0], depth=0.05)
        problem = Problem(Drilling(robot, tool, hole), zr.Settings(min_rate=0.0))
        proof = prove(problem, None, BUDGET)
        assert proof.best.reversals == 0
        assert np.rad2deg(proof.best.score.travel) == pytest.approx(102.031, abs=0.05)


# reversals and travel [deg] of a better motion that was found by another search
GIVEN = {
    "zero_missed_20060": (0, 230.93), "zero_missed_20023": (0, 412.1), "zero_missed_30000": (0, 215.39),
    "zero_missed_30029": (0, 15.43), "fewest_5239": (7, 46.43),
}  # fmt: skip


class TestHolesThatWereMissed:
    @pytest.mark.parametrize("name", GIVEN)
    def test_are_found_by_the_proof_alone(self, name):
        """Without the valleys, and without the deepest motion cut short."""
        problem = problem_of(name)
        proof = prove(problem, None, BUDGET)
        assert proof.optimality.proven
        assert proof.best.keeps_threshold
        assert (proof.best.reversals, np.rad2deg(proof.best.score.travel)) <= GIVEN[name]
        assert proof.optimality.reversals_at_least == GIVEN[name][0]

    def test_a_deeper_stroke_is_found_where_there_is_one(self):
        problem = problem_of("deepest_oracle_4042")
        bound = bound_depth(problem, 90.977e-3, BUDGET)
        assert bound.deeper is not None
        assert bound.deeper.depth > 90.977e-3
        assert bound.deeper.reversals == 0


class TestSoundness:
    @pytest.mark.long
    def test_no_bound_is_above_what_another_search_has_found(self):
        """Driven up without a motion to begin with, so that an unsound bound is seen; the valleys are independent."""
        checked = 0
        for seed in range(60):
            drilled = holes.random_hole(seed, narrowed=seed % 4 == 0)
            drilled = drilled.deep(min(drilled.hole.depth, 0.06))
            problem = Problem(*drilled.both)
            best = search(*drilled.both)
            if best is None or not best.keeps_threshold:
                continue
            rules = rules_of(drilled, min_rate=problem.settings.min_rate * (1 - 2e-6), most_cost=30.0)
            tree = Search(problem.drilling.robot.arm, problem.plane, rules, [0, 1, 2, 3], 4 * np.pi, 0.0)
            while tree.advance(6000) == bound_tree.CANDIDATE:
                pass
            value = bound_nodes.BIG * problem.order.reversals(best) + best.score.travel
            assert tree.bound <= value * (1 + 1e-9)
            checked += 1
        assert checked > 30

    def test_an_impossible_hole_is_proven_to_be_one(self, robot, tool):
        hole = zr.Hole("far", target=[2.0, 0.0, 0.5], direction=[1, 0, 0], depth=0.02)
        proof = prove(Problem(Drilling(robot, tool, hole), zr.Settings()), None, BUDGET)
        assert proof.best is None
        assert proof.optimality.proven

    def test_a_bound_on_the_spin_and_a_branch_are_kept(self, robot, tool):
        hole = zr.Hole("1", target=THESIS[0][0], direction=[1, 0, 0], depth=0.05, branch=4)
        settings = zr.Settings(psi_bound=float(np.deg2rad(20)))
        proof = prove(Problem(Drilling(robot, tool, hole), settings), None, BUDGET)
        if proof.best is not None:
            assert proof.best.branch == 4
            assert np.abs(proof.best.profile.psi).max() <= settings.psi_bound + 1e-9


class TestTheDeepestStroke:
    @pytest.mark.parametrize(("target", "depth"), THESIS)
    def test_is_bounded(self, robot, tool, target, depth):
        hole = zr.Hole("1", target=target, direction=[1, 0, 0], depth=depth)
        problem = Problem(Drilling(robot, tool, hole), zr.Settings())
        deepest = zr.deepest_stroke(robot, tool, hole).depth
        bound = bound_depth(problem, deepest, BUDGET)
        assert bound.deeper is None
        assert deepest <= bound.at_most <= deepest * 1.001 * (1 + 1e-9)
