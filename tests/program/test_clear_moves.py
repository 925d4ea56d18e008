"""Moves between holes and what stands between them: led over it, or refused; never written through it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from oracles.solids import box_at, least_at
from zerorev.errors import NotExportableError
from zerorev.files.io import job_from_dict
from zerorev.model.arm_bodies import bodies_of, withdrawn
from zerorev.model.surroundings import Surroundings
from zerorev.motion.kinematics import forward
from zerorev.planning.job import plan_job
from zerorev.planning.sequence import with_moves
from zerorev.program.export import export
from zerorev.verify.between import moves_claimed

HOLES = [
    {"id": name, "target_mm": [470, y, 700], "direction": [1, 0, 0], "depth_mm": 8}
    for name, y in (("a", -80), ("b", 80))
]


@pytest.fixture(scope="module")
def job():
    return job_from_dict({
        "robot": "kuka_kr6_r700_2", "tool": "thesis_drill", "holes": HOLES, "proof_boxes": 0, "retract_mm": 10,
        "approach_mm": 10, "part_thickness_mm": 5,
    })  # fmt: skip


@pytest.fixture(scope="module")
def plan(job):
    return plan_job(job)


def among(plan, *boxes, **keys):
    return with_moves(replace(plan, settings=replace(plan.settings, surroundings=Surroundings(boxes), **keys)))


def least(plan, box):
    """Of the moves, sample by sample."""
    (move,) = plan.transitions
    share = np.linspace(0, 1, 400)[:, None]
    joints = np.concatenate(
        [one + share * (other - one) for one, other in zip(move.joints, move.joints[1:], strict=False)]
    )
    moving = [body for body in bodies_of(plan.robot, withdrawn(plan.robot, plan.tool)) if body.link > 0]
    return least_at(plan.robot, moving, joints, box).min()


def test_a_post_between_two_holes_is_led_over_or_refused(job, plan):
    (move,) = plan.transitions
    tip = (forward(plan.robot, move.joints.mean(axis=0)) @ plan.tool.T_flange_tcp)[:3, 3]
    post = box_at(tip, [0.02, 0.02, 0.02], "post")
    free = among(plan, box_at([0.455, 0.0, 0.1], [0.02, 0.02, 0.02], "far"))
    assert free.transitions[0].around.certified
    straight = among(plan, post, safe_height=0.0)
    assert least(straight, post) <= 0
    (error,) = [finding for finding in straight.transitions[0].findings if finding.kind == "collision"]
    assert error.level == "error"
    assert "touches post" in error.message
    planned = plan_job(replace(job, settings=straight.settings))
    with pytest.raises(NotExportableError, match="touches post"):
        export(planned, "krl")
    over = among(plan, post)
    assert [finding for finding in over.transitions[0].findings if finding.level == "error"] == []
    assert len(over.transitions[0].joints) > 2
    near = over.transitions[0].around
    assert near.certified
    assert 0 < near.least <= least(over, post) + 1e-6
    assert list(moves_claimed(over)) == []


def test_a_move_nearer_than_asked_for_is_warned_of(plan):
    post = box_at([0.43, 0.0, 0.55], [0.02, 0.02, 0.02], "post")
    met = least(among(plan, post), post)
    assert met > 1e-3
    asked = among(plan, post, clearance=met + 1e-3)
    (warning,) = [finding for finding in asked.transitions[0].findings if "of post" in finding.message]
    assert (warning.level, warning.kind) == ("warning", "near_part")
    assert asked.transitions[0].around.least == pytest.approx(met, abs=2e-4)
