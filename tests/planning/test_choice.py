"""Which members the holes of a job take; the order and the shortest path are tested with `planning.sequence`."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from zerorev.model.job import Job
from zerorev.planning.choice import Member, chosen


@pytest.fixture
def two(robot, tool, positions):
    """A job of two holes."""
    hole = positions[0].hole
    return Job(robot, tool, (hole, replace(hole, id="another")))


def member(branch, travel):
    joints = np.zeros((3, 6))
    return Member(None, branch, joints, joints[0], joints[0], travel=travel, time=0.0)


def test_the_budget_counts_from_the_planned_motions(two):
    """Not from those of least travel: where another objective decides, the planned motion is not among them."""
    planned, shorter = member(0, 2.0), member(4, 1.0)
    order, taken = chosen(two, [(planned, shorter), (planned,)])
    assert order == [0, 1]
    assert taken == {0: planned, 1: planned}  # one posture within the budget of 1.1 * 4, not of 1.1 * 3


def test_another_posture_is_taken_for_no_more_than_the_share(two):
    planned, dear = member(0, 2.0), member(4, 2.5)
    for freedom, branch in ((0.2, 4), (0.1, 0)):  # the other hole has posture 4 alone
        job = replace(two, settings=replace(two.settings, posture_freedom=freedom))
        _, taken = chosen(job, [(planned, dear), (member(4, 2.0),)])
        assert taken[0].branch == branch


def test_a_hole_without_a_motion_is_left_out(two):
    planned = member(0, 2.0)
    assert chosen(two, [(), (planned,)]) == ([1], {1: planned})
    assert chosen(two, [(), ()]) == ([], {})
