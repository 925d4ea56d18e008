"""What the panel says of a simulation: figures of the study, whether they still hold, what they rest on."""

from __future__ import annotations

import re
from dataclasses import replace

import pytest

pytest.importorskip("nicegui")

from oracles.made_study import made_study
from oracles.published import POSITIONS
from zerorev.cell.ensemble import band
from zerorev.cell.parameters import nominal
from zerorev.cell.possible import Arms
from zerorev.model.job import Job
from zerorev.model.ranges import RANGES, Cell
from zerorev.web.real_arm import Asked, Simulated
from zerorev.web.state import Steered, opened_job, steered
from zerorev.web.views.arm_words import figures, notes, stands

MOTION = Steered(POSITIONS[0].profile, POSITIONS[0].branch)


@pytest.fixture
def state(robot, tool):
    return steered(opened_job(Job(robot, tool, (POSITIONS[0].hole,))), MOTION)


@pytest.fixture
def found(state):
    """Made up, of 4 of 6 arms, with 100 N of thrust."""
    study = made_study("position 1")
    arms = Arms((nominal(),) * 6, 8, 2)
    return Simulated(state.hole, MOTION, state.job.settings, state.arm.cell, Asked(8, 5, 0.2, 100.0), arms, study)


def text(html):
    return re.sub(r"\s+", " ", re.sub(r"<[^>]+>", " ", html)).replace("−", "-").strip()


def test_the_table_has_the_figures_of_the_study(found, state):
    of, old = stands(found, state)
    assert (of, old) == ("4 of 6 arms so far, seed 5, 200 mm/s, thrust 100 N.", False)
    said = text(figures(found, of, old))
    for k, side in enumerate(("by the encoders", "at the tool")):
        cells = []
        for motion in range(2):
            median, low, high = band(found.study.deviation[motion, k])
            cells.append(f"{median * 1e3:.3f} {low * 1e3:.3f} to {high * 1e3:.3f}")
        median, low, high = band(found.study.gain()[k])
        cells.append(f"{median * 100:.0f} % {low * 100:.0f} to {high * 100:.0f}")
        assert f"{side} [mm] {' '.join(cells)}" in said
    assert said.endswith("speed reached [mm/s] 200.0 100.0")


def test_what_it_rests_on_is_said(found, state):
    said = text(notes(found, state))
    assert "ranges are guesses" in said
    assert "6 of 8 sets have baselines near those that were measured." in said
    assert "The two motions are not equally fast" in said
    assert "With 100 N of thrust on a free tip" in said
    assert "the gain may be lost" in said
    assert "must let the tool turn" in said
    assert "the tool turns by 45 deg against the part" in said
    quiet = replace(found, asked=replace(found.asked, thrust=0.0), arms=Arms(found.arms.sets, 6))
    assert "on a free tip" not in notes(quiet, state)
    assert "near those that were measured" not in notes(quiet, state)
    fitted = replace(found, cell=Cell({"bandwidth": replace(RANGES["bandwidth"], basis="conditioned")}))
    assert "Narrowed by a recording: bandwidth." in notes(fitted, state)


def test_what_is_out_of_date_says_so_and_why(found, state):
    of, old = stands(found, replace(state, steered=Steered(MOTION.profile, 5)))
    assert old
    assert of.startswith("Out of date: the motion has changed since. Simulate again.")
    assert 'class="zr-warn"' in figures(found, of, old)


def test_before_anything_is_simulated_it_says_what_would_be(state):
    of, old = stands(None, state)
    assert not old
    assert of.startswith("Not simulated yet.")
    assert "<table" not in figures(None, of, old)
    assert "on a free tip" not in notes(None, state)
    heavy = replace(state, job=replace(state.job, settings=replace(state.job.settings, thrust=50.0)))
    assert "With 50 N of thrust" in notes(None, heavy)
