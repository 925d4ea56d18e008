"""Moves between holes as a plan has them, and with each thing that is said of them made wrong."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import zerorev as zr
from zerorev.planning.job import plan_job
from zerorev.verify.between import moves_claimed


@pytest.fixture(scope="module")
def planned():
    job = zr.read_job("examples/jobs/panel.yaml")
    home = tuple(np.deg2rad([0, -90, 90, 0, 0, 0]))
    settings = replace(
        job.settings.without_proof, home_joints=home, approach=0.01, retract=0.02, safe_height=0.05, part_thickness=0.02
    )
    return plan_job(replace(job, holes=job.holes[8:14], settings=settings))


def test_what_is_planned_is_so(planned):
    assert list(moves_claimed(planned)) == []


@pytest.mark.parametrize(
    ("change", "says"),
    [
        (lambda move: {"time": move.time * 0.99}, "takes "),
        (lambda move: {"changes_posture": not move.changes_posture}, "changes the posture"),
        (lambda move: {"clearance": move.clearance + 1e-4}, "of the part, the plan says"),
        (lambda move: {"joints": move.joints + 20.0 * np.eye(6)[5]}, "beyond a joint limit"),
        (lambda move: {"joints": move.joints + 1e-4 * np.eye(6)[1]}, "on the drill axis of"),
        (lambda move: {"to": "nowhere"}, "names a hole that is not there"),
    ],
)
def test_what_is_not_so_is_said(planned, change, says):
    for k in (1, 3):
        moves = list(planned.transitions)
        moves[k] = replace(moves[k], **change(moves[k]))
        found = list(moves_claimed(replace(planned, transitions=tuple(moves))))
        assert found
        assert any(says in wrong for wrong in found), found
        start = planned.transitions[k].start
        assert all(wrong.startswith(f"the move from {start} to ") for wrong in found)


def test_where_the_job_begins_and_ends(planned):
    other = replace(planned, settings=replace(planned.settings, home_joints=(0.0,) * 6))
    found = list(moves_claimed(other))
    assert [wrong.endswith("at the home position") for wrong in found] == [True, True]
