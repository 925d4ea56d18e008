"""One result behind plan and deepest stroke: zero reversals at a depth if and only if it is at most the deepest."""

from __future__ import annotations

from dataclasses import replace

import numba
import numpy as np
import pytest

from oracles.holes import ROBOTS, random_hole
from oracles.places import CASES
from zerorev.files.io import read_job
from zerorev.model.job import Settings
from zerorev.model.profile import Profile
from zerorev.motion.drilling import Drilling
from zerorev.motion.evaluation import evaluate
from zerorev.planning import answered as planning
from zerorev.planning.hole import plan, plan_deepest
from zerorev.program.lead_in import find_lead_in
from zerorev.search import exact
from zerorev.search.cut_short import cut_short, descended, steadied
from zerorev.search.deepest import Deepest, deepest_stroke
from zerorev.search.optimum import deepest_as_drilled, optimum
from zerorev.search.rank import Order

pytestmark = pytest.mark.skipif(bool(numba.config.DISABLE_JIT), reason="whole searches")

OFF = Settings(min_rate=0.0)
LITTLE = 5_000  # boxes of a proof, where what is found is asked for


def case(name):
    """Robot, tool, hole, settings of a job with one hole, proven with little effort."""
    job = read_job(CASES / f"{name}.yaml")
    return job.robot, job.tool, job.holes[0], replace(job.settings, proof_boxes=LITTLE)


def any_hole(seed, boxes=Settings.proof_boxes):
    """A random hole, every fourth with narrow limits."""
    return random_hole(seed, narrowed=seed % 4 == 3).asking(proof_boxes=boxes)


def keeps(motion, settings):
    """Zero reversals, and the motion threshold at every point."""
    return (
        motion is not None and motion.reversals == 0 and motion.score.min_rate.min() >= settings.min_rate * (1 - 1e-6)
    )


def check_agreement(drilled):
    """At 0.99 of the deepest stroke such a motion is found, at 1.02 it is not, or the stroke is raised to it."""
    deepest = deepest_as_drilled(*drilled.both).depth
    if deepest == 0:
        return 0
    for share in (0.99, 1.02):
        asked = drilled.deep(share * deepest)
        found = optimum(*asked.both)
        assert keeps(found.motion, drilled.settings) == (asked.hole.depth <= found.deepest.depth), (
            share,
            drilled.hole.id,
        )
        if share < 1:
            assert keeps(found.motion, drilled.settings), drilled.hole.id
            assert found.deepest.depth == deepest
    return int(found.deepest.depth > deepest)


class TestCases:
    """Holes at which plan and deepest stroke contradicted each other."""

    @pytest.mark.parametrize("name", ["20060", "20023", "30000", "30018", "30029"])
    def test_zero_reversals_just_above_the_deepest_stroke_are_found(self, name):
        robot, tool, hole, settings = case(f"zero_missed_{name}")
        answer = plan(robot, tool, hole, settings)
        assert answer.status == "planned"
        assert answer.score.reversals == 0
        assert answer.deepest >= hole.depth
        assert answer.verified.passed

    @pytest.mark.parametrize("name", ["30054", "30044", "20008"])
    def test_the_deepest_stroke_is_at_least_that_of_a_plan_without_reversal(self, name):
        robot, tool, hole, settings = case(f"deepest_{name}")
        answer = plan(robot, tool, hole, settings)
        assert answer.score.reversals == 0
        assert answer.deepest >= hole.depth
        deepest = plan_deepest(robot, tool, hole, settings)
        assert deepest.deepest == answer.deepest
        # as the check of a depth file searches again
        again = replace(hole, depth=deepest.deepest, profile=deepest.motion.profile)
        assert deepest_as_drilled(Drilling(robot, tool, again), settings).depth == deepest.deepest
        assert deepest_as_drilled(Drilling(robot, tool, hole), settings).depth == answer.deepest


class TestAgreement:
    def test_on_some_random_holes(self):
        for seed in (0, 3, 1009):  # at the last the plan's motion is deeper than what the search alone finds
            check_agreement(any_hole(seed, LITTLE))

    @pytest.mark.long
    def test_on_more_random_holes(self):
        raised = [check_agreement(any_hole(seed, LITTLE)) for seed in range(100, 116)]
        assert sum(raised) <= 1

    @pytest.mark.soak
    def test_on_a_thousand_random_holes(self, record_property):
        raised = [check_agreement(any_hole(seed)) for seed in range(1000, 2000)]
        record_property("measured", f"agreement on 1,000 random holes: the stroke raised by the plan on {sum(raised)}")
        assert sum(raised) <= 20

    def test_a_given_motion_that_is_deeper_raises_the_stroke(self, robot, tool, positions, monkeypatch):
        """The search for the stroke made blind: the plan's own motion is then all that is known."""
        hole = positions[0].hole
        monkeypatch.setattr("zerorev.search.optimum.deepest_of", lambda *_: Deepest(0.0))
        found = optimum(Drilling(robot, tool, hole), OFF)
        whole = deepest_stroke(robot, tool, hole, OFF).depth
        assert hole.depth < found.deepest.depth <= whole * (1 + 1e-6)
        given = replace(hole, profile=found.motion.profile)
        assert deepest_as_drilled(Drilling(robot, tool, given), OFF).depth >= hole.depth
        deep = evaluate(
            robot, tool, replace(hole, depth=found.deepest.depth), found.deepest.profile, found.deepest.branch
        )
        assert deep.score.reversals == 0

    def test_where_the_search_sees_nothing_the_cut_motion_is_the_plan(self, robot, tool, positions, monkeypatch):
        hole, settings = positions[0].hole, Settings(proof_boxes=0)  # the proof would find what the search does
        sought = optimum(Drilling(robot, tool, hole), settings)
        deepest, order = sought.deepest, Order(Drilling(robot, tool, hole), settings)
        monkeypatch.setattr(exact, "without_reversal", lambda problem: None)
        found = optimum(Drilling(robot, tool, hole), settings).motion
        assert keeps(found, settings)
        cut = order.candidate(cut_short(deepest.profile, hole.depth), deepest.branch)
        assert order.rank(sought.motion) <= order.rank(found) < order.rank(cut)

    def test_from_a_deeper_corner_they_agree_as_well(self, robot, tool, positions):
        settings = Settings(blend=4e-3, deepen_corner=True)
        deepest = deepest_as_drilled(Drilling(robot, tool, positions[1].hole), settings).depth
        for share, zero in ((0.999, True), (1.02, False)):
            hole = replace(positions[1].hole, depth=share * deepest)
            found = optimum(Drilling(robot, tool, hole), settings)
            assert keeps(found.motion, settings) == zero == (hole.depth <= found.deepest.depth)
            assert found.motion.profile.standoff.min() == -2e-3

    def test_the_mean_rule_says_that_the_stroke_is_a_lower_bound(self, robot, tool, positions):
        answer = plan(robot, tool, positions[0].hole, Settings(min_rate_rule="mean"))
        (finding,) = [finding for finding in answer.findings if finding.kind == "deepest"]
        assert finding.level == "info"
        assert "lower bound" in finding.message


class TestFreeLegs:
    @pytest.mark.long
    @pytest.mark.parametrize("cap_deg_per_mm", [0.5, 1.0, 5.0])
    def test_every_motion_keeps_the_cap(self, robot, tool, positions, cap_deg_per_mm):
        """Straight legs among free ones, too; where they would go deeper without the cap a finding says so."""
        settings = replace(OFF, legs="free", max_twist=float(np.deg2rad(1e3 * cap_deg_per_mm)), proof_boxes=LITTLE)
        for position in positions:
            answer = plan(robot, tool, position.hole, settings)
            assert np.abs(answer.motion.profile.twist_rate).max() <= settings.max_twist * (1 + 1e-9)
            assert (answer.score.reversals == 0) == (position.hole.depth <= answer.deepest)
            straight = deepest_stroke(robot, tool, position.hole, OFF)
            steeper = np.abs(straight.profile.twist_rate).max() > settings.max_twist
            says = [finding.message for finding in answer.findings if finding.kind == "deepest"]
            assert bool(says) == (straight.depth > answer.deepest)
            assert answer.deepest >= straight.depth * (1 - 1e-9) or steeper


class TestCut:
    def test_keeps_the_spins_of_the_inner_part(self):
        whole = Profile(np.array([0.05, 0.02, 0.0, 0.01, 0.05]), np.array([0.5, 0.1, 0.0, -0.3, 0.4]))
        for depth in (0.05, 0.03, 0.02, 0.01, 0.004):
            inner = cut_short(whole, depth)
            assert inner.standoff[0] == inner.standoff[-1] == depth
            for distance in np.linspace(0, 2 * depth, 41):
                standoff, psi = inner.at(np.array([distance]))
                outer = distance + 0.05 - depth
                expected = whole.at(np.array([outer]))
                np.testing.assert_allclose([standoff, psi], expected, atol=1e-12)

    @pytest.mark.parametrize("objective", ["travel", "margin", "plunge_rotation"])
    def test_descending_ends_where_the_search_ends(self, robot, tool, position, objective):
        """From a deep motion cut to a third to the best of its valley, which at these holes is the best of all."""
        settings = Settings(objective=objective)
        deepest = deepest_stroke(robot, tool, position.hole, settings)
        hole = replace(position.hole, depth=deepest.depth / 3, branch=deepest.branch)
        order = Order(Drilling(robot, tool, hole), settings)
        cut = order.candidate(cut_short(deepest.profile, hole.depth), deepest.branch)
        found = descended(order, cut)
        assert keeps(found, settings)
        assert order.rank(found) < order.rank(cut)

    @pytest.mark.parametrize("flip", [0, 1])
    @pytest.mark.parametrize("seed", range(1, 1 + len(ROBOTS)))
    def test_small_steps_lead_on_with_every_robot_and_wrist_flip(self, seed, flip):
        """On one flip of arms whose joint 5 is counted the other way they once took it to run backwards."""
        drilled = random_hole(seed).asking(min_rate=0.0)
        far = np.full(6, 20.0)
        unlimited = replace(drilled.robot, limits=replace(drilled.robot.limits, lower=-far, upper=far))
        drilled = replace(drilled, robot=unlimited)
        deepest = deepest_stroke(*drilled.all)
        branch = 2 * (deepest.branch // 2) + flip
        order = Order(*drilled.deep(0.6 * deepest.depth).asking(objective="margin").both)
        slopes = deepest.profile.twist_rate
        straight = order.candidate(cut_short(deepest.profile, order.drilling.hole.depth), branch)
        found = steadied(order, branch, float(deepest.profile.psi[1]), slopes, 0.0)
        assert found.reversals == 0
        assert found.score.min_rate.min() > straight.score.min_rate.min()
        assert order.rank(descended(order, straight)) < order.rank(straight)


class TestCheck:
    """No motion is stated as planned that does not pass the plan's own check."""

    def test_beside_a_singularity_a_motion_that_jumps_gives_way_to_one_that_passes(self):
        """Zero reversals exist here only where joint 4 turns by 1,900 deg/mm, which few of the motions found follow."""
        answer = plan(*case("zero_missed_20004"))
        assert answer.status == "planned"
        assert answer.verified.passed
        rejected = [finding for finding in answer.findings if finding.kind == "rejected"]
        assert len(rejected) == (answer.score.reversals > 0)
        for finding in rejected:
            assert finding.level == "warning"
            assert "0 reversals was found, but does not pass the check: A4 jumps" in finding.message

    def test_nor_is_a_deepest_stroke_stated_that_does_not_pass(self):
        robot, tool, hole, settings = case("zero_missed_20004")
        answer = plan_deepest(robot, tool, hole, settings)
        assert (answer.status, answer.score.reversals) == ("planned", 0)
        assert answer.verified.passed
        assert answer.hole.depth == answer.deepest < deepest_as_drilled(Drilling(robot, tool, hole), settings).depth
        (rejected,) = [finding for finding in answer.findings if finding.kind == "rejected"]
        assert "a deeper motion without a reversal was found, but does not pass the check: A4" in rejected.message

    def test_the_next_best_that_passes_is_taken_and_none_if_none_does(self, robot, tool, positions, monkeypatch):
        sound, refused = planning.verify_hole, []

        def verify(how_many):
            def refuse(*args):
                refused.append(args[-1].motion)
                passed = sound(*args)
                return replace(passed, passed=False, failures=("planted",)) if len(refused) <= how_many else passed

            return refuse

        hole = replace(positions[0].hole, branch=4)  # one branch, so that there are few others
        monkeypatch.setattr(planning, "verify_hole", verify(2))
        second = plan(robot, tool, hole)
        assert (second.status, second.score.reversals, second.verified.passed) == ("planned", 0, True)
        assert [finding.kind for finding in second.findings if finding.level != "info"] == ["rejected"]
        assert len(refused) == 3
        refused.clear()
        monkeypatch.setattr(planning, "verify_hole", verify(10_000))
        none = plan(robot, tool, hole)
        assert (none.status, none.motion) == ("infeasible", None)
        assert [(finding.level, finding.kind) for finding in none.findings] == [("error", "verification")]
        assert "planted" in none.findings[0].message

    @staticmethod
    def check_plans(seeds, boxes=Settings.proof_boxes):
        """Every plan passes; how many there were of each kind."""
        counts = {"zero": 0, "reversing": 0, "rejected": 0, "infeasible": 0}
        for seed in seeds:
            rng = np.random.default_rng(seed)
            drilled = any_hole(seed, boxes).asking(blend=float(rng.choice([1e-3, 5e-3, 0.03])))
            deepest = deepest_stroke(*drilled.all).depth
            within = deepest * rng.choice([0.3, 0.9, 0.99, 1.02])
            answer = plan(*drilled.deep(within if within > 0 else 0.02 * drilled.robot.reach).all)
            if answer.status == "infeasible":
                counts["infeasible"] += 1
                continue
            assert answer.verified.passed, (seed, answer.verified.failures)
            counts["reversing" if answer.score.reversals else "zero"] += 1
            counts["rejected"] += any(finding.kind == "rejected" for finding in answer.findings)
        return counts

    @pytest.mark.long
    def test_random_plans_pass_their_own_check(self):
        counts = self.check_plans(range(5000, 5100), LITTLE)
        assert counts["zero"] >= 60
        assert counts["infeasible"] <= 10

    @pytest.mark.soak
    def test_two_thousand_random_plans_pass_their_own_check(self, record_property):
        counts = self.check_plans(range(10_000, 12_000))
        record_property("measured", f"2,000 random plans, each passed its check or is infeasible: {counts}")
        assert counts["zero"] >= 1200


class TestLeadIn:
    @pytest.mark.parametrize("seed", [1, *(pytest.param(seed, marks=pytest.mark.long) for seed in (2, 9))])
    def test_kept_whole_where_it_is_asked_for(self, seed):
        """By default it is shortened at these holes; and plan and deepest stroke agree here, too."""
        drilled = random_hole(seed).asking(proof_boxes=LITTLE)
        whole = deepest_as_drilled(*drilled.both)
        kept = drilled.asking(keep_lead_in=True)
        deepest = deepest_as_drilled(*kept.both)
        lead_in = drilled.settings.lead_in
        assert whole.depth - lead_in * (1 + 1e-9) <= deepest.depth <= whole.depth
        shortened = plan(*drilled.deep(0.6 * whole.depth).all)
        assert (
            find_lead_in(Drilling(drilled.robot, drilled.tool, shortened.hole), shortened.motion, lead_in).length
            < lead_in
        )
        for depth in (0.6 * whole.depth, deepest.depth, 1.02 * whole.depth):
            asked = kept.deep(depth)
            answer = plan(*asked.all)
            assert keeps_plan(answer, kept.settings) == (depth <= answer.deepest), depth
            led = find_lead_in(Drilling(drilled.robot, drilled.tool, answer.hole), answer.motion, lead_in)
            assert (led.length, led.findings) == (lead_in, ())
            assert answer.verified.passed

    def test_where_there_is_none_a_finding_says_so(self, robot, tool, positions):
        settings = Settings(keep_lead_in=True, lead_in=2.0, proof_boxes=LITTLE)
        answer = plan(robot, tool, positions[0].hole, settings)
        assert answer.status == "infeasible"
        assert [(finding.level, finding.kind) for finding in answer.findings] == [("error", "lead_in")]
        assert "whole lead-in of 2000 mm" in answer.findings[0].message


def keeps_plan(answer, settings):
    """Zero reversals, and the motion threshold at every point, of a plan."""
    rates = answer.score.min_rate
    return bool(answer.score.reversals == 0 and rates.min() >= settings.min_rate * (1 - 1e-6))
