"""The deepest stroke without a reversal: as deep as theory §7 has it, or deeper; proven; and no deeper than that."""

from dataclasses import replace

import numpy as np
import pytest

from zerorev.model.hole import Hole
from zerorev.model.job import Settings
from zerorev.model.plan import HolePlan
from zerorev.model.tool import Tool
from zerorev.motion.drilling import Drilling
from zerorev.motion.evaluation import evaluate
from zerorev.motion.kinematics import wrist_offset
from zerorev.placement.tool_offset import with_offset
from zerorev.search.deepest import deepest_stroke
from zerorev.search.exact import search
from zerorev.verify import verify_hole

X = np.array([1.0, 0.0, 0.0])
OFF = Settings(min_rate=0.0)
# theory §7: target [mm]; least depth [mm] that a slow search found with the spin periodic, and within +-180 deg
FIGURES = [
    ((500, 300, 800), 104.6, 104.6),
    ((200, 400, 600), 26.1, 22.7),
    ((200, 200, 1000), 36.4, 36.4),
    ((500, 300, 900), 134.8, 134.8),
]


def hole_at(target_mm, depth=0.01):
    return Hole("h", np.array(target_mm) * 1e-3, X, depth)


@pytest.mark.parametrize(("offset_mm", "least_mm"), [(80.0, 56.9), (155.0, 90.8)])
def test_a_hole_that_the_coarse_sample_thinks_deeper_than_it_is_still_has_a_depth(robot, tool, offset_mm, least_mm):
    """With the threshold, and less offset, all that the coarse sample sees at one depth turns out to lack margin."""
    moved = with_offset(robot, tool, offset_mm * 1e-3)
    assert deepest_stroke(robot, moved, hole_at((500, 300, 800)), Settings()).depth * 1e3 >= least_mm


def plan_of(robot, tool, hole, deepest):
    """The plan that reaches the depth, as the independent check wants it."""
    deep = replace(hole, depth=deepest.depth)
    seen = evaluate(robot, tool, deep, deepest.profile, deepest.branch)
    assert seen.score is not None, seen.findings
    return HolePlan(deep, "planned", wrist_offset(robot, tool), seen.motion, seen.score)


@pytest.mark.parametrize("bounded", [False, True], ids=["periodic", "within 180"])
@pytest.mark.parametrize("figures", FIGURES, ids=lambda figures: str(figures[0]))
def test_as_deep_as_theory_7_has_it_and_proven(robot, tool, figures, bounded):
    target, periodic_mm, bounded_mm = figures
    settings = replace(OFF, psi_bound=np.pi if bounded else None)
    deepest = deepest_stroke(robot, tool, hole_at(target), settings)
    assert deepest.depth * 1e3 >= (bounded_mm if bounded else periodic_mm)
    plan = plan_of(robot, tool, hole_at(target), deepest)
    assert plan.score.reversals == 0
    checked = verify_hole(robot, tool, replace(settings, blend=0.0), plan)
    assert checked.passed, checked.failures


@pytest.mark.parametrize("figures", FIGURES[:3], ids=lambda figures: str(figures[0]))
def test_the_exact_search_finds_zero_just_above_and_none_just_below(robot, tool, figures):
    hole = hole_at(figures[0])
    depth = deepest_stroke(robot, tool, hole, OFF).depth
    assert search(Drilling(robot, tool, replace(hole, depth=0.995 * depth)), OFF).reversals == 0
    assert search(Drilling(robot, tool, replace(hole, depth=1.01 * depth)), OFF).reversals > 0


def test_every_joint_keeps_the_threshold(robot, tool):
    settings = Settings()
    deepest = deepest_stroke(robot, tool, hole_at(FIGURES[0][0]), settings)
    score = plan_of(robot, tool, hole_at(FIGURES[0][0]), deepest).score
    assert (score.min_rate >= settings.min_rate * (1 - 1e-3)).all()
    assert deepest.depth < deepest_stroke(robot, tool, hole_at(FIGURES[0][0]), OFF).depth


def test_the_depth_shrinks_with_the_lever(robot, tool):
    """Theory §1: the tip moved along the flange's axis, the wrist centre e from the drill axis."""
    expected = {155: 104, 100: 77, 60: 51, 30: 27.5, 10: 9, 3: 2, 0: 0}
    for offset_mm, depth_mm in expected.items():
        T = tool.T_flange_tcp.copy()
        T[2, 3] = offset_mm * 1e-3 - robot.arm.c4
        shorter = Tool("shorter", T)
        assert wrist_offset(robot, shorter) == pytest.approx(offset_mm * 1e-3)
        found = deepest_stroke(robot, shorter, hole_at(FIGURES[0][0]), OFF)
        assert found.depth * 1e3 == pytest.approx(depth_mm, abs=1.0)
        assert (found.profile is None) == (offset_mm == 0)


def test_the_mirror_image_is_as_deep(robot, tool):
    x, y, z = FIGURES[1][0]
    one, other = (deepest_stroke(robot, tool, hole_at(target), OFF) for target in ((x, y, z), (x, -y, z)))
    assert other.depth == pytest.approx(one.depth, abs=1e-5)


def test_a_hole_out_of_reach_has_no_depth(robot, tool):
    nothing = deepest_stroke(robot, tool, hole_at((3000, 0, 500)))
    assert (nothing.depth, nothing.profile, nothing.branch) == (0.0, None, None)


def test_the_own_depth_of_the_hole_is_not_examined(robot, tool):
    depths = {deepest_stroke(robot, tool, hole_at(FIGURES[1][0], depth), OFF).depth for depth in (0.001, 0.5)}
    assert len(depths) == 1


def test_only_the_branch_asked_for_is_searched(robot, tool):
    hole = replace(hole_at(FIGURES[0][0]), branch=4)
    assert deepest_stroke(robot, tool, hole, OFF).branch == 4
