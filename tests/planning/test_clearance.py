"""Holes among obstacles: the motion keeps clear, the plan says by how much, and its check finds the same."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from oracles.solids import box_at, least_at
from zerorev.collision.arms import setting_of
from zerorev.files.io import plan_from_text, plan_to_json, read_job
from zerorev.files.text import json_text
from zerorev.model.surroundings import NOTHING_AROUND, Surroundings
from zerorev.motion.drilling import Drilling
from zerorev.motion.joint_path import joint_path
from zerorev.motion.links import link_frames
from zerorev.planning.hole import plan
from zerorev.planning.job import plan_job
from zerorev.planning.restated import check_plan
from zerorev.search.clear import clear_of, keeps_clear
from zerorev.search.members import members
from zerorev.search.optimum import best_motion
from zerorev.verify.check import verify_hole

MARGIN = 5e-3
FAST = {"proof_boxes": 0, "clearance": MARGIN}


@pytest.fixture(scope="module")
def job():
    job = read_job("examples/jobs/thesis_positions.yaml")
    return replace(job, settings=replace(job.settings, **FAST))


def in_the_way(job, hole, name="forearm"):
    """A box where a body of the best motion is at the target."""
    best = plan(job.robot, job.tool, hole, job.settings)
    setting = setting_of(
        job.robot, job.tool, replace(job.settings, surroundings=Surroundings((box_at([9, 9, 9], [1] * 3),)))
    )
    body = next(body for body in setting.bodies if body.id == name)
    T = link_frames(job.robot, best.motion.joints[1])[body.link - 1] @ body.T_link
    middle = T[:3, :3] @ body.shape.ends.mean(axis=0) + T[:3, 3]
    return best, box_at(middle + np.array([0.0, 0.0, 0.1]), [0.08, 0.08, 0.08])


def test_without_surroundings_nothing_is_said(job):
    best = plan(job.robot, job.tool, job.holes[0], job.settings)
    assert best.clearance is None


def test_a_motion_keeps_clear_of_what_the_best_one_meets(job):
    hole = job.holes[0]
    best, box = in_the_way(job, hole)
    settings = replace(job.settings, surroundings=Surroundings((box,)))
    answer = plan(job.robot, job.tool, hole, settings)
    assert answer.verified.passed
    assert answer.score.reversals == 0
    assert answer.score.travel > best.score.travel
    assert answer.clearance.certified
    assert answer.clearance.between[1] == "box"
    # samples found otherwise agree
    setting = setting_of(job.robot, job.tool, settings)
    drilling = Drilling(job.robot, job.tool, hole)
    moving = [body for body in setting.bodies if body.link > 0]
    along = joint_path(drilling, answer.motion.profile, answer.motion.branch).joints
    least = least_at(job.robot, moving, along, box).min()
    assert MARGIN - 1e-9 <= answer.clearance.least <= least + 1e-9
    # and the best one does meet it
    along = joint_path(drilling, best.motion.profile, best.motion.branch).joints
    assert least_at(job.robot, moving, along, box).min() < MARGIN
    met = replace(best, clearance=replace(answer.clearance, least=MARGIN))
    failures = verify_hole(job.robot, job.tool, settings, met).failures
    assert any("comes within" in failure for failure in failures)
    # nor may more be said than there is
    more = replace(answer, clearance=replace(answer.clearance, least=answer.clearance.least + 1e-3))
    assert not verify_hole(job.robot, job.tool, settings, more).passed


def test_where_nothing_keeps_clear_the_finding_says_what_is_met(job):
    hole = job.holes[0]
    wall = box_at(hole.target - 0.03 * hole.direction, [0.01, 0.5, 0.5], "wall")
    answer = plan(job.robot, job.tool, hole, replace(job.settings, surroundings=Surroundings((wall,))))
    assert answer.status == "infeasible"
    (finding,) = answer.findings
    assert finding.kind == "collision"
    assert "wall" in finding.message


def test_the_drill_may_be_in_the_part_and_nothing_else(job):
    hole = job.holes[0]
    sheet = box_at(hole.target - 0.01 * hole.direction, [0.02, 0.5, 0.5], "part")
    part = Surroundings((replace(sheet, kind="part"),))
    answer = plan(job.robot, job.tool, hole, replace(job.settings, surroundings=part))
    assert answer.status == "planned"
    assert answer.verified.passed
    as_fixture = plan(job.robot, job.tool, hole, replace(job.settings, surroundings=Surroundings((sheet,))))
    assert as_fixture.status == "infeasible"


def test_a_plan_file_keeps_what_stands_around_and_is_checked_again(job):
    hole = job.holes[2]
    _, box = in_the_way(job, hole)
    settings = replace(job.settings, surroundings=Surroundings((box,)))
    whole = plan_job(replace(job, holes=(hole,), settings=settings))
    text = json_text(plan_to_json(whole))
    again = plan_from_text(text, "plan")
    assert json_text(plan_to_json(again)) == text
    assert again.settings.surroundings.obstacles[0].id == "box"
    checked = check_plan(again)
    assert checked.wrong == ()
    nearer = replace(again, holes=(replace(again.holes[0], clearance=replace(again.holes[0].clearance, least=0.5)),))
    assert check_plan(nearer).wrong
    assert "surroundings" not in plan_to_json(replace(whole, settings=replace(settings, surroundings=NOTHING_AROUND)))


def test_a_sequence_is_offered_nothing_that_hits(job):
    hole = job.holes[0]
    best = best_motion(Drilling(job.robot, job.tool, hole), job.settings)
    _, box = in_the_way(job, hole)
    settings = replace(job.settings, surroundings=Surroundings((box,)))
    drilling = Drilling(job.robot, job.tool, hole)
    (clear, *_), hit = clear_of(drilling, settings, (best,))
    assert hit is not None
    everything = members(drilling, job.settings, clear)
    offered = members(drilling, settings, clear)
    assert all(keeps_clear(drilling, settings, one) for one in offered)
    assert 0 < len(offered) < len(everything)
