"""Holes among obstacles: the motion keeps clear, the plan says by how much, and its check finds the same."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from oracles.solids import box_at, least_at
from zerorev.collision.arms import setting_of
from zerorev.files.io import plan_from_text, plan_to_json, read_job
from zerorev.files.text import json_text
from zerorev.model.arm_bodies import bodies_of
from zerorev.model.surroundings import NOTHING_AROUND, Surroundings
from zerorev.motion.drilling import Drilling
from zerorev.motion.joint_path import joint_path
from zerorev.motion.kinematics import forward
from zerorev.motion.links import link_frames
from zerorev.planning.answered import answered
from zerorev.planning.hole import plan
from zerorev.planning.job import plan_job
from zerorev.planning.restated import check_plan
from zerorev.search.clear import clear_of, keeps_clear
from zerorev.search.members import members
from zerorev.search.optimum import best_motion
from zerorev.search.rank import Order
from zerorev.verify.around import clearance_claimed
from zerorev.verify.check import verify_hole
from zerorev.verify.way import corner_moves

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


@pytest.mark.parametrize("part", ["lead_in", "approach", "retract"])
def test_the_way_is_held_to_what_is_said_of_it(job, part):
    """A box stands where one part of the way ends: the plan cuts it short, and a plan that does not say so is wrong."""
    hole = job.holes[0]
    lengths = {"lead_in": 0.0, "approach": 0.0, "retract": 0.0, part: 0.02}
    asked = replace(job.settings, **lengths)
    free = plan(job.robot, job.tool, hole, asked)
    drilling, profile = Drilling(job.robot, job.tool, hole), free.motion.profile
    share = np.linspace(0, 1, 5)
    psi = profile.psi[-1 if part == "retract" else 0] + 0.02 * share * profile.twist_rate[0] * (part == "lead_in")
    way = drilling.angles(hole.depth + 0.02 * share, psi)[:, free.motion.branch]
    legs = joint_path(drilling, profile, free.motion.branch).joints[::20]
    moving = [body for body in bodies_of(job.robot, job.tool) if body.link > 0]
    rng = np.random.default_rng(0)
    while True:  # a box that is near at the end of the way, and not before
        box = box_at(forward(job.robot, way[-1])[:3, 3] + rng.uniform(-0.3, 0.3, 3), [0.05, 0.05, 0.05])
        far = least_at(job.robot, moving, np.concatenate([legs, way[:3]]), box).min()
        if far > MARGIN + 2e-3 and 1e-3 < least_at(job.robot, moving, way[-1:], box)[0] < MARGIN - 1e-3:
            break
    settings = replace(asked, surroundings=Surroundings((box,)))
    # not a twin of which more of the lead-in runs
    answer = answered(drilling, settings, "planned", Order(drilling, settings).candidate(profile, free.motion.branch))
    assert answer.verified.passed
    said = answer.clearance
    assert 0 < getattr(said, part) < 0.02
    whole = replace(answer, clearance=replace(said, **{part: 0.02}))
    failures = verify_hole(job.robot, job.tool, settings, whole).failures
    assert any("comes within" in failure for failure in failures)
    longer = replace(answer, clearance=replace(said, **{part: 0.021}))
    failures = verify_hole(job.robot, job.tool, settings, longer).failures
    assert any("is said to keep clear, asked for" in failure for failure in failures)


def test_a_corner_of_joint_moves_is_held_apart_too(job):
    hole = job.holes[0]
    far = Surroundings((box_at([2.0, 0.0, 0.5], [0.1, 0.1, 0.1]),))
    settings = replace(job.settings, surroundings=far, controller="rapid", corner="joint")
    answer = plan(job.robot, job.tool, hole, settings)
    assert answer.corner.kind == "joint"
    assert answer.verified.passed
    moves = corner_moves(job.robot, job.tool, hole, answer.motion, answer.corner)
    assert moves.shape == (3, 6)
    np.testing.assert_allclose(moves[1], answer.motion.joints[1], atol=1e-9)
    wall = replace(far, obstacles=(box_at(hole.target, [0.002, 0.002, 0.002]),))
    failures = list(
        clearance_claimed(
            job.robot, job.tool, replace(settings, surroundings=wall), replace(answer.clearance, certified=False), [],
            moves, planned=False,
        )
    )  # fmt: skip
    assert any("joint moves of its corner are not proven to touch nothing" in failure for failure in failures)


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
