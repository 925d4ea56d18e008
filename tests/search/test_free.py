"""Free legs: as deep as theory §7 has it, or deeper; verified, certified; never less deep than straight legs."""

from __future__ import annotations

from dataclasses import replace

import numba
import numpy as np
import pytest

from zerorev.files.io import read_robot
from zerorev.model.hole import Hole
from zerorev.model.job import Settings
from zerorev.model.plan import HolePlan
from zerorev.model.tool import Tool
from zerorev.motion import kinematics
from zerorev.motion.drilling import Drilling
from zerorev.motion.evaluation import evaluate
from zerorev.motion.kinematics import wrist_offset
from zerorev.search.deepest import deepest_stroke
from zerorev.search.free import search_free
from zerorev.search.free_deepest import SEGMENTS, deepest_free
from zerorev.search.optimum import best_motion
from zerorev.verify import verify_hole
from zerorev.verify.certificate.certify import certify_hole

pytestmark = pytest.mark.skipif(bool(numba.config.DISABLE_JIT), reason="thousands of tubes")

X = np.array([1.0, 0.0, 0.0])
ROBOTS = ("kuka_kr6_r700_2", "abb_irb4600_60_205", "kuka_kr120_r2700_2", "staubli_tx2_90l", "yaskawa_gp8")
OFF = Settings(min_rate=0.0, max_twist=float(np.deg2rad(12e3)))
FIVE = replace(OFF, max_twist=float(np.deg2rad(5e3)))
# target [mm], deepest stroke [mm] asked for at a greatest twist of 12 deg/mm
FIGURES = [((500, 300, 800), 125.0), ((200, 400, 600), 40.0), ((200, 200, 1000), 50.0), ((500, 300, 900), 177.0)]


def hole_at(target_mm, depth=0.01, **more):
    return Hole("h", np.array(target_mm) * 1e-3, X, depth, **more)


def proven(robot, tool, hole, profile, branch, settings):
    """The score, if the motion passes the independent check and the certificate."""
    deep = replace(hole, depth=float(profile.standoff[0]))
    seen = evaluate(robot, tool, deep, profile, branch, settings)
    assert seen.score is not None, seen.findings
    assert seen.score.reversals == 0
    plan = HolePlan(deep, "planned", wrist_offset(robot, tool), seen.motion, seen.score)
    checked = verify_hole(robot, tool, settings, plan)
    assert checked.passed, checked.failures
    certificate = certify_hole(robot, tool, settings, plan)
    assert certificate.verdict == "certified", certificate.reasons
    assert np.abs(profile.twist_rate).max() <= settings.max_twist * (1 + 1e-9)
    assert max(profile.corner, profile.psi.size - 1 - profile.corner) <= SEGMENTS
    return seen.score


def found(robot, tool, hole, settings):
    """Profile and branch of what the search finds."""
    motion = search_free(Drilling(robot, tool, hole), settings)
    return motion.profile, motion.branch


@pytest.mark.parametrize("figures", FIGURES, ids=lambda figures: str(figures[0]))
def test_as_deep_as_asked_for_and_proven(robot, tool, figures):
    target, asked_mm = figures
    depth, profile, branch = deepest_free(Drilling(robot, tool, hole_at(target)), OFF)
    assert depth * 1e3 >= asked_mm
    assert profile.standoff[0] == profile.standoff[-1] == pytest.approx(depth)
    proven(robot, tool, hole_at(target), profile, branch, OFF)


@pytest.mark.parametrize("figures", FIGURES, ids=lambda figures: str(figures[0]))
def test_never_less_deep_than_straight_legs_that_twist_no_more(robot, tool, figures):
    straight = deepest_stroke(robot, tool, hole_at(figures[0]), FIVE)
    assert np.abs(straight.profile.twist_rate).max() <= FIVE.max_twist
    assert deepest_free(Drilling(robot, tool, hole_at(figures[0])), FIVE)[0] > straight.depth


def test_random_holes_are_never_less_deep_than_straight_and_proven(robot, tool):
    rng = np.random.default_rng(3)
    compared = 0
    while compared < 6:
        direction = np.array([1.0, *rng.uniform(-0.6, 0.6, 2)])
        target = np.array([rng.uniform(0.3, 0.6), rng.uniform(-0.3, 0.3), rng.uniform(0.5, 1.0)])
        hole = Hole("random", target, direction, 0.01)
        straight = deepest_stroke(robot, tool, hole, FIVE)
        if straight.profile is None or np.abs(straight.profile.twist_rate).max() > FIVE.max_twist:
            continue
        depth, profile, branch = deepest_free(Drilling(robot, tool, hole), FIVE)
        assert depth >= straight.depth * (1 - 1e-3)
        proven(robot, tool, hole, profile, branch, FIVE)
        compared += 1


def random_place(seed):
    """A hole that some joints within the limits reach, on one of the shipped robots, with a tool at random."""
    rng = np.random.default_rng(seed)
    robot = read_robot(ROBOTS[seed % len(ROBOTS)])
    size = robot.reach / 0.7
    T = np.eye(4)
    T[:3, :3] = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    T[:3, 2] *= np.linalg.det(T[:3, :3])
    T[:3, 3] = rng.uniform(-0.2, 0.2, 3) * size
    tool = Tool("random", T)
    while True:
        direction, target = rng.normal(size=3), rng.uniform([-0.8, -0.8, -0.2], [0.8, 0.8, 1.0]) * size
        hole = Hole("random", target, direction, 0.01)
        pose = kinematics.tcp_pose(hole, 0.0, rng.uniform(-np.pi, np.pi)) @ np.linalg.inv(T)
        joints = kinematics.inverse(robot, pose)
        if ((joints > robot.limits.lower) & (joints < robot.limits.upper)).all(axis=1).any():
            return robot, tool, hole


def falls_with_the_cap(seeds, caps_deg_per_mm):
    """By how much the stroke falls at most from one cap to a greater one, relative, of random holes."""
    falls = {}
    for seed in seeds:
        case = random_place(seed)
        caps = [replace(OFF, max_twist=float(np.deg2rad(cap * 1e3))) for cap in caps_deg_per_mm]
        depths = [deepest_free(Drilling(*case), settings)[0] for settings in caps]
        best = np.maximum.accumulate(depths)
        fallen = [1 - depth / most for depth, most in zip(depths, best, strict=True) if most > 0]
        falls[seed] = max(fallen, default=0.0)
    return falls


@pytest.mark.long
def test_a_greater_cap_is_at_least_as_deep():
    """Five caps on the kind of holes on which the stroke fell by up to a half."""
    falls = falls_with_the_cap(range(24), (1, 2, 5, 8, 12))
    assert sum(fall > 2e-3 for fall in falls.values()) <= 3, falls
    assert max(falls.values()) < 0.015, falls


@pytest.mark.soak
def test_of_347_holes_none_is_markedly_less_deep_at_12_than_at_5_deg_per_mm():
    falls = falls_with_the_cap(range(347), (5, 12))
    assert sum(fall > 0.02 for fall in falls.values()) <= 3, falls
    assert max(falls.values()) < 0.05, falls


def test_the_mirror_image_is_as_deep(robot, tool):
    x, y, z = FIGURES[2][0]
    one, other = (deepest_free(Drilling(robot, tool, hole_at(target)), FIVE)[0] for target in ((x, y, z), (x, -y, z)))
    assert other == pytest.approx(one, abs=1e-5)


def test_the_threshold_is_kept_at_every_point(robot, tool):
    settings = replace(FIVE, min_rate=float(np.deg2rad(10.0)))
    target = FIGURES[0][0]
    depth, profile, branch = deepest_free(Drilling(robot, tool, hole_at(target)), settings)
    score = proven(robot, tool, hole_at(target), profile, branch, settings)
    assert (score.min_rate >= settings.min_rate * (1 - 1e-6)).all()
    assert depth < deepest_free(Drilling(robot, tool, hole_at(target)), FIVE)[0]


def test_the_spin_stays_within_its_bound(robot, tool):
    settings = replace(FIVE, psi_bound=float(np.deg2rad(40.0)))
    target = FIGURES[0][0]
    depth, profile, branch = deepest_free(Drilling(robot, tool, hole_at(target)), settings)
    assert np.abs(profile.psi).max() <= settings.psi_bound + 1e-9
    proven(robot, tool, hole_at(target), profile, branch, settings)
    assert 0 < depth < deepest_free(Drilling(robot, tool, hole_at(target)), FIVE)[0]


def test_a_limit_planted_within_the_motion_costs_depth_and_one_just_outside_costs_none(robot, tool):
    hole = hole_at(FIGURES[2][0])
    depth, profile, branch = deepest_free(Drilling(robot, tool, hole), FIVE)
    hole = replace(hole, branch=branch)
    joints = evaluate(robot, tool, replace(hole, depth=depth), profile, branch).motion.joints
    for inset_deg, costs in ((-1.0, False), (10.0, True)):
        upper, lower = robot.limits.upper.copy(), robot.limits.lower.copy()
        upper[0], lower[0] = joints[:, 0].max() - np.deg2rad(inset_deg), joints[:, 0].min() - 0.01
        tight = replace(robot, limits=replace(robot.limits, upper=upper, lower=lower))
        found, planted, where = deepest_free(Drilling(tight, tool, hole), FIVE)
        proven(tight, tool, hole, planted, where, FIVE)
        assert (found < 0.995 * depth) == costs


def test_out_of_reach_there_is_nothing(robot, tool):
    assert deepest_free(Drilling(robot, tool, hole_at((3000, 0, 500))), FIVE) == (0.0, None, None)
    assert search_free(Drilling(robot, tool, hole_at((3000, 0, 500))), FIVE) is None


@pytest.mark.parametrize("objective", ["travel", "margin", "plunge_rotation"])
def test_search_finds_what_straight_legs_cannot(robot, tool, objective):
    """At a depth that is beyond straight legs, by each objective; and each is best at its own."""
    settings = replace(FIVE, objective=objective)
    hole = hole_at(FIGURES[2][0], 0.042)
    assert deepest_stroke(robot, tool, hole, FIVE).depth < hole.depth
    profile, branch = found(robot, tool, hole, settings)
    assert profile.standoff[0] == pytest.approx(hole.depth)
    proven(robot, tool, hole, profile, branch, settings)


def test_each_objective_is_best_at_its_own(robot, tool):
    hole = hole_at(FIGURES[0][0], 0.05)
    scores, turns = {}, {}
    for objective in ("travel", "margin", "plunge_rotation"):
        profile, branch = found(robot, tool, hole, replace(FIVE, objective=objective))
        scores[objective] = proven(robot, tool, hole, profile, branch, FIVE)
        turns[objective] = abs(profile.psi[profile.corner] - profile.psi[0])
    assert min(scores, key=lambda name: scores[name].travel) == "travel"
    assert max(scores, key=lambda name: scores[name].min_rate.min()) == "margin"
    assert min(turns, key=turns.get) == "plunge_rotation"
    # theory §7: least travel of straight legs
    assert np.rad2deg(scores["travel"].travel) < 101.8


def test_search_finds_zero_just_above_the_deepest_and_none_well_below(robot, tool):
    hole = hole_at(FIGURES[1][0])
    depth = deepest_free(Drilling(robot, tool, hole), FIVE)[0]
    profile, branch = found(robot, tool, replace(hole, depth=0.9 * depth), FIVE)
    proven(robot, tool, hole, profile, branch, FIVE)
    # nearer to it there is at least the deepest motion cut short
    nearly = best_motion(Drilling(robot, tool, replace(hole, depth=0.99 * depth)), replace(FIVE, legs="free"))
    proven(robot, tool, hole, nearly.profile, nearly.branch, FIVE)
    assert search_free(Drilling(robot, tool, replace(hole, depth=1.15 * depth)), FIVE) is None


def test_where_the_threshold_cannot_be_kept_the_greatest_margin_is_found(robot, tool):
    settings = replace(FIVE, min_rate=float(np.deg2rad(60.0)))
    hole = hole_at(FIGURES[1][0], 0.03)
    profile, branch = found(robot, tool, hole, settings)
    score = proven(robot, tool, hole, profile, branch, FIVE)
    assert 0 < score.min_rate.min() < settings.min_rate


def test_only_the_branch_asked_for_is_searched(robot, tool):
    _, _, branch = deepest_free(Drilling(robot, tool, hole_at(FIGURES[0][0], branch=3)), FIVE)
    assert branch == 3


def test_a_short_stroke_is_not_a_special_case(robot, tool):
    profile, branch = found(robot, tool, hole_at(FIGURES[0][0], 5e-4), FIVE)
    assert profile.standoff[0] == pytest.approx(5e-4)
    proven(robot, tool, hole_at(FIGURES[0][0]), profile, branch, replace(FIVE, blend=1e-4))
