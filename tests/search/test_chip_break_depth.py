"""The deepest stroke that breaks chips: what is found has no reversal, and a grid finds hardly anything deeper."""

import json
from dataclasses import replace

import numpy as np
import pytest

from oracles.broken_chips import any_on_a_grid
from oracles.makers import POSITIONS
from zerorev.files.io import plan_from_text, plan_to_json, read_robot, read_tool
from zerorev.model.cycle import Cycle
from zerorev.model.hole import Hole
from zerorev.model.job import Job, Settings
from zerorev.motion.drilling import Drilling
from zerorev.motion.joint_path import joints_along
from zerorev.planning.hole import plan, plan_deepest
from zerorev.planning.job import plan_job
from zerorev.planning.restated import check_plan
from zerorev.search.cycles import deepest_in_cycle
from zerorev.search.optimum import deepest_as_drilled

FIVE = Cycle("chip_break", 5e-3, 0.3e-3)


def job(number, depth=None, **settings):
    target, usual = POSITIONS[number]
    hole = Hole("a", np.array(target) * 1e-3, np.array([1.0, 0, 0]), depth or usual * 1e-3)
    chosen = Settings(**({"proof_boxes": 0, "cycle": FIVE} | settings))
    return Job(read_robot("kuka_kr6_r700_2"), read_tool("thesis_drill"), (hole,), chosen, name="chips")


def deepest(number, **settings):
    own = job(number, **settings)
    return Drilling.of(own, own.holes[0]), own.settings, deepest_in_cycle(Drilling.of(own, own.holes[0]), own.settings)


@pytest.mark.parametrize(("number", "depth"), [(1, 77.9), (2, 24.15), (3, 31.6)])
def test_every_joint_runs_one_way_on_the_deepest_stroke(number, depth):
    """By inverse kinematics on close samples, with nothing of the search; a record of the depths."""
    drilling, settings, found = deepest(number)
    assert found.depth * 1e3 > depth
    inwards = [s for k, s in enumerate(found.profile.standoff) if k in found.profile.turns]
    np.testing.assert_allclose(inwards[:-1:2], FIVE.breaks(found.depth), atol=1e-12)
    standoff, psi = found.profile.at(np.linspace(0, found.profile.distance[-1], 60_001))
    joints = joints_along(drilling, found.branch, standoff, psi)
    steps = np.diff(joints, axis=0)
    assert ((steps > 0).all(axis=0) | (steps < 0).all(axis=0)).all()
    assert ((joints >= drilling.limits.lower) & (joints <= drilling.limits.upper)).all()
    rate = np.abs(steps).min(axis=0) / (found.profile.distance[-1] / 60_000)
    assert rate.min() > settings.min_rate * 0.9  # the sample next to a breakpoint spans it


def test_more_breaks_are_less_deep_and_none_are_the_plain_stroke():
    plain = deepest(1, cycle=Cycle())[2]
    strokes = [deepest(1, cycle=Cycle("chip_break", peck, 0.3e-3))[2].depth for peck in (20e-3, 5e-3, 2e-3)]
    assert plain.depth > strokes[0] > strokes[1] > strokes[2] > 0
    drilling, settings, far = deepest(2, cycle=Cycle("chip_break", 50e-3, 0.3e-3))
    straight = deepest_as_drilled(drilling, settings)
    assert len(far.profile.psi) == 3  # no break in so short a stroke
    assert far.depth == pytest.approx(straight.depth, rel=1e-3)


def test_the_bound_on_the_spin_the_branch_and_the_lead_in_are_kept():
    free = deepest(2)[2]
    bounded = deepest(2, psi_bound=np.pi)[2]
    assert np.abs(bounded.profile.psi).max() <= np.pi
    assert bounded.depth < free.depth
    own = job(2)
    drilling = Drilling.of(own, own.holes[0]).on_branch(free.branch)
    assert deepest_in_cycle(drilling, own.settings).depth == pytest.approx(free.depth, rel=1e-6)
    led = deepest(2, keep_lead_in=True)[2]
    assert 0 < led.depth < free.depth


def test_a_deeper_corner_is_part_of_the_stroke():
    _, settings, found = deepest(2, blend=2e-3, deepen_corner=True)
    assert found.profile.standoff.min() == settings.corner_standoff < 0


def test_the_depth_file_passes_its_check_and_a_deeper_claim_does_not():
    found = plan_job(job(2), strokes="deepest")
    (hole,) = found.holes
    assert hole.verified.passed
    assert hole.score.reversals == 0
    assert (hole.optimality, hole.deepest_at_most) == (None, None)
    assert any("not proven" in finding.message for finding in hole.findings if finding.kind == "deepest")
    again = plan_from_text(json.dumps(plan_to_json(found)), "depth.json")
    assert check_plan(again).wrong == ()
    claimed = replace(found, holes=(replace(hole, deepest=hole.deepest + 1e-3),))
    assert any("deepest_mm" in finding.message for finding in check_plan(claimed).wrong)


def test_a_plan_without_the_figure_is_still_sound():
    """Plans of before it was looked for have none."""
    found = plan_job(job(2))
    (hole,) = found.holes
    assert hole.deepest > hole.hole.depth
    before = replace(
        hole, deepest=None, findings=tuple(finding for finding in hole.findings if finding.kind != "deepest")
    )
    assert check_plan(replace(found, holes=(before,))).wrong == ()


def test_plan_and_depth_agree():
    """A little less deep than the deepest there is a motion; a given motion that is deeper raises it."""
    own = job(1)
    (hole,) = own.holes
    stroke = plan_deepest(own.robot, own.tool, hole, own.settings)
    shorter = plan(own.robot, own.tool, replace(hole, depth=stroke.deepest * 0.999), own.settings)
    assert shorter.score.reversals == 0
    assert shorter.deepest == pytest.approx(stroke.deepest, rel=1e-4)
    given = replace(stroke.hole, profile=stroke.motion.profile)
    assert plan(own.robot, own.tool, given, own.settings).deepest >= stroke.deepest


def test_where_none_is_found_it_says_so():
    own = job(2, min_rate=np.deg2rad(1e5))
    answer = plan_deepest(own.robot, own.tool, own.holes[0], own.settings)
    assert (answer.status, answer.deepest) == ("infeasible", 0.0)
    assert any("breaks chips was found" in finding.message for finding in answer.findings)


@pytest.mark.long
@pytest.mark.parametrize("number", POSITIONS)
@pytest.mark.parametrize("cycle", [FIVE, Cycle("chip_break", 10e-3, 1e-3)])
def test_a_grid_of_spins_and_slopes_has_nothing_much_deeper(number, cycle):
    """72 spins at the target, 14 slopes to either side of the critical rates, all branches, limits and all."""
    drilling, settings, found = deepest(number, cycle=cycle)
    assert any_on_a_grid(drilling, settings, 0.9 * found.depth, cycle) is not None
    for deeper in (1.02, 1.05, 1.1, 1.2):
        assert any_on_a_grid(drilling, settings, deeper * found.depth, cycle) is None
