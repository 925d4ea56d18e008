"""How a hole is drilled: what fits together, and what is refused in one message."""

import numpy as np
import pytest

from zerorev.errors import InputError
from zerorev.files.io import job_from_text, read_robot, read_tool
from zerorev.model.cycle import Cycle
from zerorev.model.hole import Hole
from zerorev.model.job import Job, Settings

JOB = """
robot: kuka_kr6_r700_2
tool: thesis_drill
{}
holes:
  - {{id: a, target_mm: [500, 300, 800], direction: [1, 0, 0], depth_mm: 20{}}}
"""


@pytest.mark.parametrize(
    ("of_the_job", "of_the_hole", "what"),
    [
        ("cycle: {dwell_s: -0.1}", "", "dwell_s.*0 or more|dwell_s.*from 0"),
        ("cycle: {dwell_s: 11}", "", "dwell_s.*10"),
        ("cycle: {dwell_s: 0.125}", "", "a dwell of 0.125 s .*hundredths of a second"),
        ("cycle: {dwell_s: long}", "", "dwell_s"),
        ("cycle: {dwell_ms: 100}", "", "dwell_ms"),
        ("cycle: {dwell_s: 0.1}\ncorner: blend", "", "kind blend beside a dwell of 0.1 s: where the tool stands, noth"),
        ("cycle: {dwell_s: 0.1}\ncorner: joint\ncontroller: rapid", "", "kind joint beside a dwell of 0.1 s"),
        ("corner: blend", ", cycle: {dwell_s: 0.1}", "hole a, corner: a corner of kind blend beside a dwell of 0.1 s"),
        ("legs: free", ", cycle: {kind: chip_break, depth_mm: 5}", "hole a, cycle: free legs drill in one go"),
    ],
)
def test_what_does_not_fit_together(of_the_job, of_the_hole, what):
    with pytest.raises(InputError, match=what):
        job_from_text(JOB.format(of_the_job, of_the_hole), "job.yaml")


@pytest.mark.parametrize("corner", ["", "corner: stop", "blend_mm: 0"])
def test_a_dwell_makes_the_corner_a_stop(corner):
    job = job_from_text(JOB.format(f"cycle: {{dwell_s: 0.12}}\n{corner}", ""), "job.yaml")
    assert job.settings.turning.kind == "stop"
    assert job.settings.cycle == Cycle(dwell=0.12)


def test_the_cycle_of_a_hole_takes_the_place_of_the_jobs():
    """All of it: a hole that is drilled otherwise does not dwell either."""
    usual, own = Cycle(dwell=0.2), Cycle("chip_break", 5e-3)
    target, direction = np.array([0.5, 0.3, 0.8]), np.array([1.0, 0, 0])
    holes = (Hole("a", target, direction, 20e-3), Hole("b", target, direction, 20e-3, cycle=own))
    robot, tool = read_robot("kuka_kr6_r700_2"), read_tool("thesis_drill")
    job = Job(robot, tool, holes, Settings(cycle=usual, controller="krl"))
    assert [job.settings.of(hole).cycle for hole in holes] == [usual, own]
    assert [job.settings.of(hole).turning.kind for hole in holes] == ["stop", "blend"]


def test_a_cycle_in_words():
    assert Cycle().said == "in one go"
    assert Cycle(dwell=0.1).said == "a dwell of 0.1 s at the target"
    assert "each 5 mm by drawing back 0.3 mm, a dwell" in Cycle("chip_break", 5e-3, dwell=0.1).said
