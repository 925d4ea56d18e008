"""Plans that are right pass, and the published figures come out (theory §7)."""

import ast
import sys
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import zerorev.verify
from zerorev.model.hole import Hole
from zerorev.model.plan import HolePlan, Plan
from zerorev.model.profile import Profile
from zerorev.verify import verify_hole, verify_plan
from zerorev.verify.arm import posture_of
from zerorev.verify.path import Track, follow, legs

TRAVEL = {1: 107.1, 2: 98.5, 3: 90.5}
BASELINE = {1: ((1, 1, 1, 1, 1, 1), 52.5), 2: ((1, 1, 1, 0, 1, 1), 14.1), 3: ((1, 1, 1, 1, 1, 1), 57.5)}


@pytest.mark.parametrize("position", [1, 2, 3])
def test_published_plans_pass_without_reversals(kuka, drill, settings, published, appendix_b, position):
    plan = published(position)
    plan = replace(plan, score=replace(plan.score, travel=round_trip(plan)))
    verdict = verify_hole(kuka, drill, settings, plan)
    assert verdict.failures == ()
    assert verdict.passed
    assert verdict.reversals_per_joint == (0,) * 6
    assert round(np.rad2deg(plan.score.travel), 1) == TRAVEL[position]
    assert verdict.samples >= 40_000
    assert verdict.blend_samples == 4_000
    assert verdict.max_position_error < 1e-14
    assert verdict.max_rotation_error < 1e-14
    assert verdict.max_joint_step < 1e-4
    np.testing.assert_allclose(np.rad2deg(plan.motion.joints), appendix_b[position][3], atol=1e-4)


def round_trip(plan):
    """With zero reversals the travel depends on the two outer ends alone (theory §2)."""
    return float(np.abs(plan.motion.joints[-1] - plan.motion.joints[0]).sum())


@pytest.mark.parametrize("position", [1, 2, 3])
def test_constant_spin_reverses_every_moving_joint(kuka, drill, settings, published, appendix_b, position):
    plan = published(position, (appendix_b[position][2][0],) * 3)
    verdict = verify_hole(kuka, drill, settings, plan)
    counts, travel = BASELINE[position]
    assert verdict.passed, verdict.failures
    assert verdict.reversals_per_joint == counts
    assert round(np.rad2deg(plan.score.travel), 1) == travel


def test_position_2_with_constant_spin_backs_up_joint_5_and_rests_joint_4(kuka, drill, published):
    plan = published(2, (180, 180, 180))
    path = legs(plan.motion.profile, 40_000)
    start = plan.motion.joints[0]
    joints = follow(kuka, drill, plan.hole, path, posture_of(kuka.arm, start), start)
    plunge = np.rad2deg(joints[: path.corner + 1])
    assert round(abs(plunge[-1, 4] - plunge[0, 4]), 3) == 0.041
    assert np.ptp(plunge[:, 3]) < 1e-10


@pytest.mark.parametrize("position", [1, 2, 3])
def test_the_mirror_law(kuka, drill, settings, published, appendix_b, position):
    """Thesis eq. 4.12: the motion backwards has the same reversals and travel."""
    forth = published(position)
    back = replace(
        forth,
        motion=replace(forth.motion, profile=forth.motion.profile.reversed(), joints=forth.motion.joints[::-1]),
    )
    assert verify_hole(kuka, drill, settings, back).passed


@pytest.mark.parametrize("seed", range(4))
def test_every_robot_is_checked_wherever_it_stands(robot, drill, settings, build, random_hole, seed):
    """Random poses, directions and spins, lateral offset and negative signs among them."""
    hole, profile, start = random_hole(robot, drill, seed)
    plan = build(robot, drill, hole, profile, start)
    verdict = verify_hole(robot, drill, replace(settings, blend=0.0), plan)
    assert verdict.failures == ()
    assert verdict.blend_samples == 0


def test_an_edge_where_a_joint_just_stops_still_passes(kuka, drill, settings, published):
    """Least travel drives a joint to a standstill at the end of a leg; that is not a reversal, also after blending."""
    inside, outside = 20.1, 0.0
    for _ in range(40):
        middle = (inside + outside) / 2
        still = published(1, (-5.9388 + middle, -5.9388, -30.4599)).score.reversals == 0
        inside, outside = (middle, outside) if still else (inside, middle)
    plan = published(1, (-5.9388 + inside, -5.9388, -30.4599))
    assert plan.score.min_rate.min() < 1e-3
    for blend in (0.0, 1e-3, 10e-3):
        verdict = verify_hole(kuka, drill, replace(settings, blend=blend), plan)
        assert verdict.failures == ()


def test_more_breakpoints_and_a_deeper_corner(kuka, drill, settings, build, published):
    base = published(1)
    spins = np.deg2rad([14.1646, 4.1, -5.9388, -18.2, -30.4599])
    profile = Profile([0.05, 0.025, -0.0005, 0.0248, 0.05], spins)
    plan = build(kuka, drill, base.hole, profile, base.motion.joints[0])
    deeper = replace(settings, deepen_corner=True)
    assert verify_hole(kuka, drill, deeper, plan).failures == ()
    assert any("behind the target" in f for f in verify_hole(kuka, drill, settings, plan).failures)


def test_verify_plan_fills_in_every_hole_that_has_a_motion(kuka, drill, settings, published):
    good = published(1)
    bad = replace(good, score=replace(good.score, travel=1.0))
    none = HolePlan(good.hole, "infeasible", good.wrist_offset)
    plan = verify_plan(Plan(kuka, drill, settings, (good, bad, none)))
    assert plan.holes[0].verified.passed
    assert not plan.holes[1].verified.passed
    assert plan.holes[2].verified is None
    assert good.verified is None


def test_it_is_quick(kuka, drill, settings, published):
    plan = published(1)
    times = []
    for _ in range(5):
        begin = time.perf_counter()
        verify_hole(kuka, drill, settings, plan)
        times.append(time.perf_counter() - begin)
    assert min(times) < 0.05  # 4 ms on an idle core


def test_it_sees_the_model_alone():
    allowed = ("zerorev.model", "zerorev.errors", "zerorev.verify", "numpy", "flint")
    compiler = dict.fromkeys(("compiled.py", "solids.py"), "zerorev.kernels._jit")
    for file in Path(zerorev.verify.__file__).parent.rglob("*.py"):
        for node in ast.walk(ast.parse(file.read_text())):
            names = [a.name for a in node.names] if isinstance(node, ast.Import) else []
            names += [node.module] if isinstance(node, ast.ImportFrom) else []
            for name in names:
                standard = name.split(".")[0] in sys.stdlib_module_names
                own = standard or name.startswith(allowed) or name == compiler.get(file.name)
                assert own, f"{file.name} imports {name}"


def test_tracks_agree_with_their_samples(kuka, drill, published):
    plan = published(3)
    path = legs(plan.motion.profile, 100)
    start = plan.motion.joints[0]
    track = Track(path, follow(kuka, drill, plan.hole, path, posture_of(kuka.arm, start), start))
    np.testing.assert_allclose(track.joints[list(path.knots)], plan.motion.joints, atol=1e-12)
    assert isinstance(plan.hole, Hole)
