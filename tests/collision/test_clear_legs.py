"""Legs and moves among boxes: what is proven against many samples of it, found by other formulas."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from oracles.solids import box_at, least_at
from zerorev.collision.arms import setting_of
from zerorev.collision.near import EXACT, first_hit, lines, moves, nearest_of
from zerorev.files.io import read_job
from zerorev.kernels.clearance import FREE, HIT, UNDECIDED, keeps
from zerorev.model.surroundings import Surroundings
from zerorev.motion.drilling import Drilling
from zerorev.motion.evaluation import evaluated
from zerorev.motion.kinematics import forward

MARGIN = 5e-3
SAMPLES = 2_000
JOB = "examples/jobs/thesis_published.yaml"


def legs_of(hole, drilling, settings):
    """The two legs of the published motion: paths, and the joints along each."""
    for branch in range(8):
        found = evaluated(drilling, hole.profile, branch, settings)
        if found.score is not None and found.score.reversals == 0:
            break
    profile, joints = hole.profile, found.motion.joints
    for k in range(2):
        (path,) = lines(drilling, branch, zip(profile.standoff[k : k + 2], profile.psi[k : k + 2], strict=True))
        share = np.linspace(0, 1, SAMPLES + 1)[:, None]
        at = path.ends[0, :2] + share * (path.ends[1, :2] - path.ends[0, :2])
        along = np.unwrap(drilling.angles(at[:, 0], at[:, 1])[:, branch], axis=0)
        yield path, along + 2 * np.pi * np.round((joints[k] - along[0]) / (2 * np.pi))


def compared(seeds):
    """Legs that were judged; how many of them otherwise than the samples; how many were free."""
    job = read_job(JOB)
    rng = np.random.default_rng(seeds)
    count = wrong = free = 0
    for hole in job.holes:
        drilling = Drilling(job.robot, job.tool, hole)
        legs = list(legs_of(hole, drilling, job.settings))
        for _ in range(seeds):
            box = box_at(hole.target + rng.normal(size=3) * 0.35, 2 * rng.uniform(0.02, 0.15, 3))
            settings = replace(job.settings, surroundings=Surroundings((box,)), clearance=MARGIN)
            setting = setting_of(job.robot, job.tool, settings)
            moving = [body for body in setting.bodies if body.link > 0]
            for path, joints in legs:
                verdict = keeps(
                    job.robot.arm, path.plane, path.branch, path.ends, setting.arms, setting.against, 10_000,
                    setting.lever_w, setting.desk(), np.empty(3),
                )  # fmt: skip
                least = least_at(job.robot, moving, joints, box).min()
                count, free = count + 1, free + (verdict == FREE)
                wrong += verdict not in (FREE, HIT) or (
                    (verdict == FREE) != (least >= MARGIN) and abs(least - MARGIN) > 1e-6
                )
    return count, wrong, free


def test_legs_are_judged_as_by_many_samples():
    count, wrong, free = compared(20)
    assert (count, wrong) == (120, 0)
    assert 60 < free < 120


@pytest.mark.long
def test_3600_legs_are_judged_as_by_many_samples(record_property):
    count, wrong, free = compared(600)
    record_property(
        "measured", f"legs against boxes: {count}, {free} free, {wrong} judged otherwise than 2,000 samples"
    )
    assert (count, wrong) == (3_600, 0)


@pytest.fixture(scope="module")
def swing(robot, tool):
    """A wide move, and the tip in the middle of two of 20 samples of it."""
    joints = np.deg2rad([[-60.0, -90.0, 90.0, 0.0, 20.0, 0.0], [60.0, -80.0, 80.0, 10.0, 30.0, 40.0]])
    return joints


def test_a_thin_wall_between_samples_is_found(robot, tool, swing):
    settings = read_job(JOB).settings
    share = np.linspace(0, 1, 21)[:, None]
    sampled = swing[0] + share * (swing[1] - swing[0])
    missed = 0
    for k in range(3, 17):
        between = (sampled[k] + sampled[k + 1]) / 2
        setting = setting_of(robot, tool, replace(settings, surroundings=Surroundings((box_at([9, 9, 9], [1, 1, 1]),))))
        drill = next(body for body in setting.bodies if body.id == "drill")
        T = forward(robot, between) @ drill.T_link
        tip = T[:3, :3] @ drill.shape.ends[0] + T[:3, 3]
        wall = box_at(tip, [1e-3, 1e-3, 1e-3])
        setting = setting_of(robot, tool, replace(settings, surroundings=Surroundings((wall,))))
        only = np.array([setting.names(n) == ("drill", "box") for n in range(len(setting.against))])
        missed += least_at(robot, [drill], sampled, wall).min() > 0
        hit = first_hit(setting, robot, moves(swing), only)
        assert hit is not None
        assert hit.between == ("drill", "box")
        found = nearest_of(setting, robot, moves(swing), only)
        assert found.distance <= 0
    assert missed > 7  # the samples do not see it


def test_the_nearest_is_as_near_as_the_nearest_of_many_samples(robot, tool, swing):
    settings = read_job(JOB).settings
    rng = np.random.default_rng(3)
    share = np.linspace(0, 1, 4_001)[:, None]
    joints = swing[0] + share * (swing[1] - swing[0])
    for _ in range(12):
        box = box_at(rng.uniform([-0.2, -0.9, 0.0], [0.9, 0.9, 1.2]), rng.uniform(0.02, 0.2, 3))
        setting = setting_of(robot, tool, replace(settings, surroundings=Surroundings((box,))))
        found = nearest_of(setting, robot, moves(swing), setting.against)
        least = least_at(robot, [body for body in setting.bodies if body.link > 0], joints, box).min()
        if least > 0:
            assert found.proven
            assert found.distance == pytest.approx(least, abs=2 * EXACT)
        else:
            assert found.distance <= 0


def test_lines_are_cut_where_a_joint_turns_round(robot, tool):
    hole = next(hole for hole in read_job(JOB).holes if hole.id.endswith("1"))
    drilling = Drilling(robot, tool, hole)
    paths = list(lines(drilling, 4, [(0.05, 0.0), (0.0, 0.0)]))  # at constant spin joints reverse
    ends = np.array([path.ends[:, 0] for path in paths])
    assert ends[0, 0] == 0.05
    assert ends[-1, 1] == 0.0
    assert all(one[1] == other[0] for one, other in pairwise(ends))
    for path in paths:
        at = path.ends[0, :2] + np.linspace(0, 1, 400)[:, None] * (path.ends[1, :2] - path.ends[0, :2])
        steps = np.diff(np.unwrap(drilling.angles(at[:, 0], at[:, 1])[:, 4], axis=0), axis=0)
        assert ((steps > -1e-9).all(axis=0) | (steps < 1e-9).all(axis=0)).all()


def test_a_leg_along_an_obstacle_is_given_up_after_so_many_pieces(robot, tool):
    """The distance is the same all along, and all but what is asked for: no few pieces prove that it is kept."""
    job = read_job(JOB)
    drilling = Drilling(robot, tool, job.holes[0])
    wall = box_at(job.holes[0].target + np.array([-0.1, 0.3, 0.0]), [0.6, 0.1, 0.6])
    (path,) = list(lines(drilling, 4, [(0.002, 0.0), (0.0, 0.0)]))[:1]
    setting = setting_of(robot, tool, replace(job.settings, surroundings=Surroundings((wall,)), clearance=0.0))
    only = np.array([setting.names(k) == ("tool", "box") for k in range(len(setting.against))])
    found = nearest_of(setting, robot, [path], only)
    assert found.distance > 0
    close = replace(job.settings, surroundings=Surroundings((wall,)), clearance=found.distance - 3e-6)
    setting = setting_of(robot, tool, close)
    verdicts = [
        keeps(
            robot.arm, path.plane, 4, path.ends, setting.arms, only, most, setting.lever_w, setting.desk(), np.empty(3)
        )
        for most in (20, 100_000)
    ]
    assert verdicts == [UNDECIDED, FREE]
