"""Of a motion, its twin and both on the other wrist flip, the plan is the one with the least predicted lost motion."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from zerorev.files.io import read_robot, read_tool
from zerorev.model.hole import Hole
from zerorev.model.settings import Settings
from zerorev.motion import kinematics
from zerorev.motion.drilling import Drilling
from zerorev.motion.loads import lost_motion
from zerorev.planning.hole import plan
from zerorev.program.lead_in import find_lead_in
from zerorev.search.optimum import optimum
from zerorev.search.rank import Order
from zerorev.search.twins import gentlest_first

SETTINGS = Settings(proof_boxes=0)


def some_holes(count):
    robot, tool = read_robot("kuka_kr6_r700_2"), read_tool("thesis_drill")
    rng = np.random.default_rng(5)
    while count:
        joints = rng.uniform(robot.limits.lower, robot.limits.upper)
        T = kinematics.forward(robot, joints) @ tool.T_flange_tcp
        if T[2, 3] > 0.1:
            count -= 1
            yield Drilling(robot, tool, Hole("h", T[:3, 3], -T[:3, 2], 0.02, psi_zero=T[:3, 1]))


def test_no_like_is_gentler_but_where_it_costs():
    chosen = 0
    for drilling in some_holes(6):
        best = optimum(drilling, SETTINGS).motion
        if best is None:
            continue
        first = gentlest_first(drilling, SETTINGS, best)[0]
        order = Order(drilling, SETTINGS)
        lost = lost_motion(drilling, first.profile, first.branch)
        assert order.rank(first)[:2] == order.rank(best)[:2]
        assert order.rank(first).cost == pytest.approx(order.rank(best).cost, rel=1e-8)
        chosen += first is not best
        run = find_lead_in(drilling, first.evaluation.motion, SETTINGS.lead_in).length
        assert run >= find_lead_in(drilling, best.evaluation.motion, SETTINGS.lead_in).length - 1e-9
        for profile in (best.profile, best.profile.reversed()):
            for branch in (best.branch, best.branch ^ 1):
                other = order.candidate(profile, branch)
                flipped = branch != first.branch
                if other is None or lost_motion(drilling, profile, branch) > lost - (10.1e-6 if flipped else 1e-7):
                    continue
                lead = find_lead_in(drilling, other.evaluation.motion, SETTINGS.lead_in).length
                assert lead < find_lead_in(drilling, best.evaluation.motion, SETTINGS.lead_in).length - 1e-9
    assert chosen > 0


def test_a_given_branch_is_kept_and_an_arm_without_masses_left_alone(robot, tool, positions):
    hole = replace(positions[2].hole, profile=None)
    for branch in range(8):
        drilling = Drilling(robot, tool, replace(hole, branch=branch))
        best = optimum(drilling, SETTINGS).motion
        if best is not None:
            assert {one.branch for one in gentlest_first(drilling, SETTINGS, best)} == {branch}
    bare = Drilling(replace(robot, dynamics=None), tool, hole)
    best = optimum(bare, SETTINGS).motion
    assert gentlest_first(bare, SETTINGS, best) == (best,)
    answer = plan(bare.robot, tool, hole, SETTINGS)
    assert answer.lost_motion is None
    assert np.isnan(answer.measures.lost_motion)


def test_the_thesis_positions(robot, tool, positions):
    for position in positions:
        answer = plan(robot, tool, replace(position.hole, profile=None), replace(SETTINGS, min_rate=0.0))
        assert answer.verified.passed
        assert answer.lost_motion.at_tip <= answer.lost_motion.twin_at_tip
