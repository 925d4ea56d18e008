"""What a job says is what was planned: by a reader that shares nothing, by forward kinematics, and certified."""

import re
from itertools import pairwise

import numpy as np
import pytest

from oracles import arm, inform_reader
from zerorev.model.plan import Plan
from zerorev.program.as_exported import as_exported
from zerorev.program.export import export
from zerorev.program.inform.dialect import INFORM
from zerorev.program.inform.text import from_pulses, pulses
from zerorev.program.neutral import build_program
from zerorev.verify.certificate.program import certify_program

WHAT = [1, 2, 3, "free legs", "panel", "chip break"]
ROBOTS = ["ma2010", "stand_in"]


def certificates(plan: Plan, files):
    program = INFORM.read(files)
    return [hole.certificate for hole in certify_program(plan, program, as_exported(plan, program, INFORM)).holes]


@pytest.mark.parametrize("what", WHAT, ids=str)
@pytest.mark.parametrize("robot", ROBOTS)
def test_all_are_certified(robot, what, plan_for):
    plan = plan_for(robot, what)
    found = certificates(plan, export(plan).files)
    assert [(each.verdict, each.reasons) for each in found] == len(plan.holes) * [("certified", ())]
    assert all((each.min_rate > 0).all() for each in found)


@pytest.mark.parametrize("what", WHAT, ids=str)
@pytest.mark.parametrize("robot", ROBOTS)
def test_positions_lie_on_the_drill_axis(robot, what, plan_for):
    """Each position by another forward kinematics, from the pulses as printed."""
    plan = plan_for(robot, what)
    job = inform_reader.read(export(plan).text)
    assert job.tool == 3
    assert len(job.holes()) == len(plan.holes)
    worst = np.zeros(2)
    for moves, planned, neutral in zip(job.holes(), plan.in_order, build_program(plan).holes, strict=True):
        hole = planned.hole
        joints = np.deg2rad(np.array([move.pulses for move in moves]) / plan.robot.pulses_per_deg)
        poses = np.array([arm.tcp(plan.robot, plan.tool, each) for each in joints])
        back = poses[:, :3, 3] - hole.target
        along = back @ -hole.direction
        off = np.linalg.norm(back + np.outer(along, hole.direction), axis=1)
        tilt = np.linalg.norm(np.cross(poses[:, :3, 2], hole.direction), axis=1)
        worst = np.maximum(worst, (off.max(), tilt.max()))
        ends = [neutral.start.standoff, *(move.standoff for move in neutral.moves)]
        assert np.abs(along - ends).max() < 15e-6
        # the spin, right-handed about Z of the tcp frame
        spins = [neutral.start.psi, *(move.psi for move in neutral.moves)]
        y = np.array([np.cos(s) * hole.psi_zero + np.sin(s) * np.cross(-hole.direction, hole.psi_zero) for s in spins])
        assert np.abs(y - poses[:, :3, 1]).max() < 1e-4
    # half a pulse in each of six axes: an axis of 455 to 1,908 pulses per degree, over a lever of up to 2 m
    assert worst[0] < 15e-6
    assert np.rad2deg(worst[1]) < 0.002


@pytest.mark.parametrize("what", WHAT[:-1], ids=str)
def test_joint_moves_keep_the_feed(what, plan_for):
    """VJ= is a share of the joint that needs longest, and so gives the time of the move."""
    plan = plan_for("ma2010", what)
    for moves in inform_reader.read(export(plan).text).holes():
        corner = [(a, b) for a, b in pairwise(moves) if b.kind == "MOVJ"]
        assert len(corner) == 2
        for (before, move), feed in zip(corner, (5.0, 20.0), strict=True):
            turned = np.abs((move.pulses - before.pulses) / np.array(plan.robot.pulses_per_deg))
            seconds = (turned / np.rad2deg(plan.robot.limits.speed)).max() / (move.speed / 100)
            assert plan.holes[0].corner.reach * 1e3 / seconds == pytest.approx(feed, rel=0.1)


def test_moves_and_levels(plan_for):
    plan = plan_for("ma2010", 1, approach=10e-3, retract=15e-3)
    (moves,) = inform_reader.read(export(plan).text).holes()
    assert [(move.kind, move.level) for move in moves] == [
        ("MOVJ", 0), ("MOVL", 0), ("MOVL", 1), ("MOVL", 1), ("MOVJ", 1), ("MOVJ", 1), ("MOVL", 0), ("MOVL", 0),
    ]  # fmt: skip
    assert [move.speed for move in moves if move.kind == "MOVL"] == [20.0, 5.0, 5.0, 20.0, 20.0]
    assert {each.verdict for each in certificates(plan, export(plan).files)} == {"certified"}


def test_a_stop_at_the_corner(plan_for):
    plan = plan_for("ma2010", 1, corner="stop", blend=1e-3)
    exported = export(plan)
    (moves,) = inform_reader.read(exported.text).holes()
    assert [(move.kind, move.level) for move in moves] == [("MOVJ", 0), ("MOVL", 1), ("MOVL", 0), ("MOVL", 0)]
    assert {each.verdict for each in certificates(plan, exported.files)} == {"certified"}


def test_the_same_plan_gives_the_same_bytes(plan_for):
    texts = {export(plan_for("ma2010", 1), version="1").text for _ in range(2)}
    (text,) = texts
    assert re.search(r"^///DATE 2000/01/01 00:00$", text, re.MULTILINE)


def test_limits_are_kept_in_whole_pulses(yaskawas):
    """An axis that ends on its limit would lie beyond it if it were rounded to the nearest pulse."""
    robot, _ = yaskawas["stand_in"]
    for limits in (robot.limits.lower, robot.limits.upper):
        found = from_pulses(robot, pulses(robot, limits))
        assert (found >= robot.limits.lower).all()
        assert (found <= robot.limits.upper).all()
        assert (np.abs(np.rad2deg(found - limits)) <= (1 + 1e-6) / np.abs(robot.pulses_per_deg)).all()
