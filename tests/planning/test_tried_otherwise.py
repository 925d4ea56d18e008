"""Where most holes fail, what would have helped is tried and said; and how far a hole is out of reach."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from oracles.holes import ROBOTS, THESIS_DRILL
from oracles.places import ROOT
from zerorev.files.io import job_from_dict, read_job
from zerorev.model.finding import Finding
from zerorev.model.hole import Hole
from zerorev.model.plan import HolePlan
from zerorev.model.settings import Settings
from zerorev.motion.drilling import Drilling
from zerorev.planning import tried_otherwise
from zerorev.planning.hole import plan
from zerorev.planning.job import plan_job
from zerorev.planning.out_of_reach import shift_into_reach
from zerorev.planning.restated import check_plan
from zerorev.search.exact import can_run

PRACTICE = ROOT / "tests/data/practice"


def quickly(job):
    return replace(job, settings=replace(job.settings, proof_boxes=0))


def kinds(plan):
    """Of what is said of the whole job, but of how far the tool turns."""
    return [finding.kind for finding in plan.findings if finding.kind != "tool_turn"]


def test_directions_turned_round():
    found = plan_job(quickly(read_job(PRACTICE / "c08_normals/reversed.yaml")))
    assert "normals" in kinds(found)
    (message,) = [each.message for each in found.findings if "turned round" in each.message]
    assert "3 of 3 holes fail or reverse" in message
    assert "with the directions turned round 3 of 3 are drilled without a reversal" in message
    assert kinds(plan_job(quickly(read_job(PRACTICE / "c08_normals/okdir.yaml")))) == []


def test_no_more_than_a_few_are_tried(monkeypatch):
    tried = []

    def counted(robot, tool, hole, settings):
        tried.append(hole)
        return plan(robot, tool, hole, settings)

    monkeypatch.setattr(tried_otherwise, "plan", counted)
    monkeypatch.setattr(tried_otherwise, "MOST_TRIED", 2)
    job = quickly(read_job(PRACTICE / "c08_normals/reversed.yaml"))
    found = tried_otherwise.TriedOtherwise(job)
    for hole in job.holes:
        found.add(HolePlan(hole, "infeasible", 0.1))
    (finding,) = found.findings()
    assert [hole.id for hole in tried] == ["a", "c"]
    assert "2 of 2 that were tried are drilled" in finding.message


def test_angles_in_the_order_of_kuka():
    holes = [{"id": f"h{n}", "target_mm": [300, 20 * n, 0], "direction": [-1, 0, 0], "depth_mm": 12} for n in range(3)]
    data = {"robot": "kuka_kr6_r700_2", "tool": "thesis_drill", "proof_boxes": 0, "holes": holes}
    frame = {"xyz_mm": [850, 200, 700], "rpy_deg": [0, 0, 180]}
    right = plan_job(job_from_dict(data | {"part_frame": frame}))
    assert all(hole.score.reversals == 0 for hole in right.holes)
    assert kinds(right) == []
    swapped = plan_job(job_from_dict(data | {"part_frame": frame | {"rpy_deg": [180, 0, 0]}}))
    assert all(hole.motion is None for hole in swapped.holes)
    (finding,) = [each for each in swapped.findings if each.kind == "frame_angles"]
    assert "3 of 3 holes cannot be drilled; with the angles of part_frame in the other order 3 of 3" in finding.message
    assert finding.message.endswith("rpy_deg: [0, 0, 180]")


def test_no_more_is_said_of_holes_that_are_good_and_a_check_minds_no_guess():
    found = plan_job(quickly(read_job(ROOT / "examples/jobs/thesis_positions.yaml")))
    assert kinds(found) == []
    guess = Finding("warning", "units", "metres?")
    assert check_plan(replace(found, findings=(*found.findings, guess))).wrong == ()


@pytest.mark.parametrize("seed", range(4))
def test_a_hole_that_is_moved_as_it_is_said_is_within_reach(seed):
    """And not much less is enough: 0.8 of the way is not."""
    rng, checked = np.random.default_rng(seed), 0
    while checked < 4:
        robot = ROBOTS[int(rng.integers(len(ROBOTS)))]
        free = replace(robot.limits, lower=np.full(6, -4 * np.pi), upper=np.full(6, 4 * np.pi))
        robot = replace(robot, limits=free)
        direction, away = rng.normal(size=3), rng.normal(size=3)
        target = away / np.linalg.norm(away) * rng.uniform(0.0, 2.5) * robot.reach + [0, 0, robot.arm.c1]
        hole = Hole("a", target, direction, 0.02, psi_zero=np.cross(direction, rng.normal(size=3)))
        if can_run(Drilling(robot, THESIS_DRILL, hole), Settings()):
            continue
        way = shift_into_reach(Drilling(robot, THESIS_DRILL, hole))
        assert can_run(Drilling(robot, THESIS_DRILL, replace(hole, target=target + way)), Settings())
        assert not can_run(Drilling(robot, THESIS_DRILL, replace(hole, target=target + 0.8 * way)), Settings())
        checked += 1


def test_the_message_says_how_far_and_which_way(robot, tool):
    hole = Hole("a", np.array([1.2, 0, 0.6]), np.array([1.0, 0, 0]), 0.02)
    answer = plan(robot, tool, hole, Settings(proof_boxes=0))
    (finding,) = [each for each in answer.findings if each.kind == "unreachable"]
    by = float(finding.message.split()[4])
    x, y, z = map(float, finding.message.split("moved by (")[1].split(")")[0].split(","))
    assert finding.message.startswith("out of reach by ")
    assert by == pytest.approx(np.linalg.norm([x, y, z]), abs=1.5)
    assert x < 0
    near = replace(hole, target=hole.target + np.array([x, y, z]) / 1e3)
    assert not any(each.kind == "unreachable" for each in plan(robot, tool, near, Settings(proof_boxes=0)).findings)
