"""Plans made of given motions: no search is needed to draw one."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from oracles.published import POSITIONS
from zerorev.files.io import job_from_dict
from zerorev.model.hole import Hole
from zerorev.model.job import Settings
from zerorev.model.plan import Baseline, HolePlan, Plan
from zerorev.model.profile import Profile
from zerorev.motion.evaluation import evaluate
from zerorev.motion.kinematics import wrist_offset
from zerorev.planning.job import plan_job


def answer(robot, tool, hole, profile, branch):
    found = evaluate(robot, tool, hole, profile, branch)
    assert found.score is not None, found.findings
    held = Profile(profile.standoff, np.full_like(profile.psi, profile.psi[0]))
    score = evaluate(robot, tool, hole, held, branch).score
    baseline = Baseline(score.reversals_per_joint, score.travel) if score else None
    return HolePlan(hole, "evaluated", wrist_offset(robot, tool), found.motion, found.score, baseline)


@pytest.fixture(scope="session")
def make_plan(robot, tool):
    """Profile over the hole of position 1 -> plan of that one hole."""

    def make(standoff_mm=(50, 0, 50), psi_deg=(14.1646, -5.9388, -30.4599), *, name="P1", robot=robot, tool=tool):
        hole = replace(POSITIONS[0].hole, id=name)
        profile = Profile(np.array(standoff_mm) * 1e-3, np.deg2rad(psi_deg))
        return Plan(robot, tool, Settings(), (answer(robot, tool, hole, profile, 4),))

    return make


@pytest.fixture(scope="session")
def published(robot, tool):
    """The three published plans, and a hole that is out of reach."""
    holes = [answer(robot, tool, p.hole, p.profile, p.branch) for p in POSITIONS]
    lost = HolePlan(
        Hole("far", np.array([9.0, 0, 0]), np.array([1.0, 0, 0]), 0.05), "infeasible", holes[0].wrist_offset
    )
    return Plan(robot, tool, Settings(), (*holes, lost))


@pytest.fixture(scope="session")
def two_tools():
    """A job of two tools, planned: the first drills hole `a` in two strokes and `b` in one, the second both in one."""
    drill, reamer = ({"tcp_mm": [x, 0, z], "rpy_deg": [0, -90, 0]} for x, z in ((100, 65), (120, 80)))
    job = {
        "name": "two",
        "robot": "kuka_kr6_r700_2",
        "proof_boxes": 0,
        "tools": [
            {"tool": drill, "tool_number": 2, "cycle": {"kind": "peck", "depth_mm": 10}},
            {"tool": reamer, "tool_number": 3, "depth_mm": 22},
        ],
        "holes": [
            {"id": "a", "target_mm": [500, 300, 800], "direction": [1, 0, 0], "depth_mm": 20},
            {"id": "b", "target_mm": [500, 340, 800], "direction": [1, 0, 0], "depth_mm": 8},
        ],
    }
    return plan_job(job_from_dict(job))
