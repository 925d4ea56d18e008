"""What a page knows of the real arm: a simulation is of one motion, and what has changed since is said."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from oracles.published import POSITIONS
from zerorev.cell.possible import Arms
from zerorev.model.job import Job
from zerorev.model.profile import Profile
from zerorev.model.ranges import Cell
from zerorev.web.job_edits import with_hole, with_settings
from zerorev.web.real_arm import Asked, RealArm, Simulated, outdated
from zerorev.web.session import undone
from zerorev.web.state import State, Steered, opened_job, selected, steered

MOTION = Steered(POSITIONS[0].profile, POSITIONS[0].branch)


@pytest.fixture
def state(robot, tool, positions):
    """Position 1 with its published motion, simulated."""
    state = steered(opened_job(Job(robot, tool, tuple(each.hole for each in positions))), MOTION)
    found = Simulated(
        state.hole, MOTION, state.job.settings, state.arm.cell, Asked(1, 0, None, 0.0), Arms((), 1), study=None
    )
    return replace(state, arm=replace(state.arm, simulated={state.selected: found}))


def why(state: State, motion: Steered | None = MOTION) -> str | None:
    return outdated(state.arm.simulated["position 1"], state, motion)


def test_it_is_of_the_same_motion_however_that_is_kept(state):
    assert why(state) is None
    profile = MOTION.profile
    assert why(state, Steered(Profile(profile.standoff.copy(), profile.psi.copy()), MOTION.branch)) is None
    there_and_back = selected(selected(state, "position 2"), "position 1")
    assert why(there_and_back) is None


def test_what_has_changed_since_is_said(state):
    profile = MOTION.profile
    turned = Profile(profile.standoff, profile.psi + np.array([0.0, 1e-6, 0.0]))
    for motion in (None, Steered(turned, MOTION.branch), Steered(profile, 5)):
        assert why(state, motion) == "the motion has changed since"
    assert why(with_hole(state, replace(state.hole, depth=0.04), "position 1")) == "the hole has changed since"
    settings = replace(state.job.settings, feed_plunge=0.01)
    assert why(with_settings(state, settings)) == "the settings have changed since"
    other = replace(state, arm=replace(state.arm, cell=Cell(), file="cell.yaml"))
    assert why(other) == "another cell file was opened since"


def test_a_step_back_keeps_what_is_known_of_the_same_arm(state):
    before = replace(state, arm=RealArm())
    assert undone(state, before).arm is state.arm
    another = opened_job(replace(state.job, robot=replace(state.job.robot, name="another")))
    assert undone(state, another).arm is another.arm
