"""The shipped panel with its shape and two clamps: drilled with clearance; where the job has no clamps they are hit."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from zerorev.collision.arms import setting_of
from zerorev.collision.motions import hit_of
from zerorev.files.io import read_job
from zerorev.model.surroundings import Surroundings
from zerorev.motion.drilling import Drilling
from zerorev.planning.job import plan_job
from zerorev.program.clear_moves import Around
from zerorev.verify.between import moves_claimed

pytest.importorskip("trimesh")


@pytest.fixture(scope="module")
def job():
    job = read_job("examples/jobs/panel_clamped/job.yaml")
    return replace(job, settings=replace(job.settings, proof_boxes=0))


def test_part_and_clamps_are_where_the_panel_is(job):
    part, *clamps = job.settings.surroundings.obstacles
    assert part.kind == "part"
    assert [clamp.id for clamp in clamps] == ["left clamp", "right clamp"]
    at = (np.array([hole.target for hole in job.holes]) - part.T_base[:3, 3]) @ part.T_base[:3, :3]
    assert np.abs(at[:, 2] + 0.012).max() < 1e-9  # the holes end at the back of the panel
    assert np.ptp(part.shape.vertices[:, 2]) == pytest.approx(0.012)


@pytest.mark.long
def test_the_panel_is_drilled_with_clearance(job, record_property):
    plan = plan_job(job)
    wanted = job.settings.clearance
    assert len(plan.order) == 20
    assert all(hole.verified.passed and hole.score.reversals == 0 for hole in plan.holes)
    assert all(hole.clearance.certified and hole.clearance.least >= wanted - 1e-9 for hole in plan.holes)
    assert all(move.around.certified and move.around.least > 0 for move in plan.transitions)
    assert not [finding for finding in plan.all_findings if finding.kind == "collision"]
    assert list(moves_claimed(plan)) == []
    # a move that is said to keep more than it does is refuted by the check's own distances
    first = plan.transitions[0]
    more = replace(first, around=replace(first.around, least=first.around.least + 1e-3))
    assert list(moves_claimed(replace(plan, transitions=(more, *plan.transitions[1:]))))
    least = min(hole.clearance.least for hole in plan.holes) * 1e3
    moves = min(move.around.least for move in plan.transitions) * 1e3
    record_property("measured", f"panel with clamps: least {least:.3f} mm in the holes, {moves:.3f} mm between them")


@pytest.mark.long
def test_without_the_clamps_in_the_job_they_are_hit(job, record_property):
    around = job.settings.surroundings
    unaware = replace(job, settings=replace(job.settings, surroundings=Surroundings(around.obstacles[:1])))
    plan = plan_job(unaware)
    setting = setting_of(job.robot, job.tool, job.settings)
    hits = []
    for answer in plan.holes:
        drilling = Drilling(job.robot, job.tool, answer.hole)
        hit = hit_of(setting, drilling, job.settings, answer.motion.profile, answer.motion.branch)
        hits += [] if hit is None else [hit.between[1]]
    met = Around.of(job.robot, job.tool, job.settings)
    through = [move for move in plan.transitions if met.hit(move.joints) is not None]
    assert set(hits) <= {"left clamp", "right clamp"}
    assert len(hits) + len(through) > 3
    record_property(
        "measured", f"panel without the clamps in the job: {len(hits)} holes and {len(through)} moves hit them"
    )
