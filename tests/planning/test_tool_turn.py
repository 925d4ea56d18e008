"""How far the end effector turns: against the arm's own forward kinematics, followed in small steps."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

import zerorev as zr
from oracles.arm import tcp
from zerorev.model._arrays import transform
from zerorev.model.job import Job
from zerorev.model.plan import Transition
from zerorev.model.profile import Profile
from zerorev.model.tool import Tool
from zerorev.planning.hole import plan
from zerorev.planning.job import plan_job
from zerorev.planning.restated import check_plan
from zerorev.planning.tool_turn import with_tool_turn

SETTINGS = zr.Settings(proof_boxes=0)
STRAIGHT = Tool("straight", transform(np.diag([1.0, -1.0, -1.0]), np.array([0, 0, -0.1])))


def said(findings):
    return [finding for finding in findings if finding.kind == "tool_turn"]


def turned_along(robot, tool, move, samples=3_000):
    """The turn about the tool's own Z along a move, summed over small steps, shape (samples,)."""
    one, other = move.joints[0], move.joints[-1]
    poses = [tcp(robot, tool, one + share * (other - one))[:3, :3] for share in np.linspace(0, 1, samples + 1)]
    steps = [(before.T @ after)[1, 0] - (before.T @ after)[0, 1] for before, after in pairwise(poses)]
    return np.cumsum(steps) / 2


@pytest.fixture(scope="module")
def positions():
    job = zr.read_job("examples/jobs/thesis_positions.yaml")
    home = tuple(np.deg2rad([0, -90, 90, 0, 30, 0]))
    return plan_job(replace(job, settings=replace(job.settings, proof_boxes=0, home_joints=home)))


def test_over_a_job(positions):
    """The spins of the holes and the turns between them, counted on; the last joint by its angles."""
    holes = {hole.hole.id: hole.motion for hole in positions.holes}
    at, seen, last = 0.0, [0.0], []
    for move in positions.transitions:
        along = at + turned_along(positions.robot, positions.tool, move)
        seen += along.tolist()
        at = along[-1]
        last += move.joints[:, 5].tolist()
        if move.to is not None:
            motion = holes[move.to]
            profile = motion.profile
            lead_in = profile.psi[0] + profile.twist_rate[0] * positions.settings.lead_in
            seen += (at + np.append(lead_in, profile.psi) - lead_in).tolist()
            at = seen[-1]
            last += motion.joints[:, 5].tolist()
    (finding,) = said(positions.findings)
    tool, joint = np.rad2deg(np.ptp(seen)), np.rad2deg(np.ptp(last))
    assert f"turns by {tool:.0f} deg about its own axis, seen from the base, and A6 by {joint:.0f} deg" in (
        finding.message
    )
    assert (finding.level, finding.hole) == (("warning" if max(tool, joint) > 360 else "info"), None)
    assert not check_plan(positions).wrong


def test_turns_are_counted_on(positions):
    """Of a tool along the last axis a turn of the last joint is its own, whole turns and all."""
    holes = positions.holes[:1]
    start, there = np.zeros(6), np.deg2rad([0, -90, 90, 0, 30, 300])
    start[:] = there
    start[5] = np.deg2rad(-200)
    first = holes[0].hole.id
    moves = (Transition(None, first, np.array([start, there]), 1.0, False, np.deg2rad(500)),)
    turned = with_tool_turn(
        replace(positions, tool=STRAIGHT, holes=holes, order=(first,), transitions=moves, findings=())
    )
    spins = holes[0].motion.profile.psi
    (finding,) = said(turned.findings)
    assert finding.level == "warning"
    stated = float(finding.message.split("turns by ")[1].split()[0])
    assert abs(stated - 500) <= np.rad2deg(np.ptp(spins)) + 20
    assert "psi_bound_deg" in finding.message
    assert f"hole {first}" in finding.message


@pytest.mark.parametrize(
    ("spins", "level"),
    [((-20, 0, 20), None), ((-50, 0, 50), "info"), ((-170, 0, 170), "info"), ((0, 0, 361), "warning")],
)
def test_over_a_hole(spins, level, robot):
    """A drill along the last axis: the spin moves that alone."""
    hole = replace(
        zr.read_job("examples/jobs/thesis_positions.yaml").holes[0],
        profile=Profile(np.array([0.02, 0.0, 0.02]), np.deg2rad(spins)), depth=0.02,
    )  # fmt: skip
    answer = plan(robot, STRAIGHT, hole, replace(SETTINGS, lead_in=0.0))
    assert answer.motion is not None
    found = said(answer.findings)
    assert [finding.level for finding in found] == ([level] if level else [])
    if level:
        assert f"turns by {spins[2] - spins[0]} deg" in found[0].message


def test_a_plan_without_a_motion_says_nothing(robot, tool):
    hole = zr.read_job("examples/jobs/thesis_positions.yaml").holes[0]
    away = replace(hole, target=hole.target + np.array([3.0, 0, 0]))
    assert not said(plan_job(Job(robot, tool, (away,), SETTINGS)).all_findings)


def test_check_holds_what_is_said_of_it_to_what_is_so(positions):
    """A plan that says nothing of it may be of an older version."""
    assert not check_plan(replace(positions, findings=())).wrong
    other = [replace(each, message=each.message.replace("turns by ", "turns by 1")) for each in positions.findings]
    assert any(
        "turns by 1" in finding.message for finding in check_plan(replace(positions, findings=tuple(other))).wrong
    )
