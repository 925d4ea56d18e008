"""Alignment, path distance and metrics against a plain twin, and against runs whose errors are known."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from oracles.published import POSITIONS
from oracles.recordings import kick, no_error, plain_metrics, plain_reversals, run_of
from zerorev.cell.recordings.alignment import aligned
from zerorev.cell.recordings.metrics import metrics, reversals
from zerorev.cell.recordings.repeatability import repeatability
from zerorev.cell.recordings.run import across, drilling_run
from zerorev.cell.recordings.tip import PlannedHole, planned_hole, tip_of
from zerorev.errors import InputError
from zerorev.model.hole import Hole
from zerorev.model.plan import HolePlan, Motion, Plan
from zerorev.model.recording import Recording
from zerorev.model.settings import Settings
from zerorev.model.tool import Tool
from zerorev.motion.drilling import Drilling


def planned(robot, tool, position, hole=None):
    motion = Motion(position.profile, position.branch, np.zeros((3, 6)))
    return PlannedHole(Drilling(robot, tool, hole or position.hole), motion, 5e-3, 1e-3)


@pytest.mark.parametrize("held", [False, True])
@pytest.mark.parametrize("feed", [0.02, 0.15])
@pytest.mark.parametrize("index", range(3))
def test_metrics_are_those_of_the_plain_twin(robot, tool, index, feed, held):
    position = POSITIONS[index]
    run = run_of(robot, tool, position, error=kick, held=held, feed=feed, tips=True)
    recording = replace(run.recording, joints=None, joints_commanded=None)
    found = metrics(drilling_run(recording, planned(robot, tool, position)))
    twin = plain_metrics(run, position.depth_mm / 2, feed * 1e3)
    assert found.window == pytest.approx(position.depth_mm / 2e3)
    assert found.path_length * 1e3 == pytest.approx(twin.path_mm, abs=1e-6)
    assert found.deviation_max * 1e3 == pytest.approx(twin.max_mm, abs=2e-6)
    assert found.deviation_rms * 1e3 == pytest.approx(twin.rms_mm, abs=2e-6)
    assert found.deviation_parts * 1e3 == pytest.approx(twin.parts_mm, abs=2e-6)
    assert found.offset * 1e3 == pytest.approx(twin.offset_mm, abs=2e-6)


def smooth(path):
    return 0.05e-3 + 0.11e-3 * np.exp(-((path / 6e-3) ** 2)), 0.04e-3 * np.tanh(path / 5e-3)


@pytest.mark.parametrize("given_plan", [True, False])
@pytest.mark.parametrize("held", [False, True])
def test_a_known_error_is_found_within_a_micrometre(robot, tool, position, held, given_plan):
    run = run_of(robot, tool, position, error=smooth, held=held, tips=not given_plan)
    found = metrics(drilling_run(run.recording, planned(robot, tool, position) if given_plan else None))
    depth, window = position.depth_mm / 1e3, position.depth_mm / 2e3
    path = np.linspace(-depth, depth, 20_001)
    apart = np.stack(smooth(path), axis=1)
    mean = apart.mean(axis=0)
    inside = np.linalg.norm(apart - mean, axis=1)[np.abs(path) <= window]
    assert found.deviation_max == pytest.approx(inside.max(), abs=1e-6)
    assert found.deviation_rms == pytest.approx(np.sqrt(np.mean(inside**2)), abs=1e-6)
    assert found.offset == pytest.approx(np.linalg.norm(mean), abs=1e-6)
    assert found.path_length == pytest.approx(2 * depth, abs=20e-6)  # the turn lies between two samples
    expected = position.baseline if held else (0,) * 6
    assert found.reversals_per_joint == expected


def test_the_alignment_is_the_first_commanded_torque_or_change(robot, tool, position):
    for before in (12, 75, 200):
        run = run_of(robot, tool, position, before=before)
        torque = aligned(run.recording)
        assert (torque.by, torque.sample) == ("commanded_torque", before)
        assert torque.time == run.recording.time[before]
        moved = aligned(replace(run.recording, torque_commanded=None, commanded_from=None))
        assert moved.by == "commanded_position"
        assert abs(moved.sample - before) <= 1
    measured = replace(run.recording, torque_commanded=None, commanded_from=None, joints_commanded=None)
    assert aligned(measured).by == "measured_position"


def test_a_torque_of_zero_can_be_the_first_commanded_one(robot, tool):
    run = run_of(robot, tool, POSITIONS[1], before=50)
    known = replace(run.recording, commanded_from=float(run.recording.time[40]))
    assert aligned(known).sample == 40


def test_where_nothing_is_commanded_the_measured_tip_is_taken(robot, tool, position):
    run = run_of(robot, tool, position, error=smooth, noise=2e-6, tips=True)
    bare = Recording(run.recording.time, joints=run.recording.joints, source="bare")
    exact = metrics(drilling_run(run.recording, planned(robot, tool, position)))
    found = metrics(drilling_run(bare, planned(robot, tool, position)))
    assert found.path_length == pytest.approx(2e-3 * position.depth_mm, rel=0.02)  # noise adds no distance
    assert found.deviation_max == pytest.approx(exact.deviation_max, abs=15e-6)
    assert found.deviation_rms == pytest.approx(exact.deviation_rms, abs=3e-6)
    assert found.reversals_per_joint == (0,) * 6
    alone = metrics(drilling_run(Recording(bare.time, tcp=run.recording.tcp, source="tip")))
    assert alone.offset is None
    assert alone.reversals_per_joint is None
    assert 0.3 < alone.deviation_max / exact.deviation_max < 1.2  # the line fits what it is held against


def test_moves_before_and_after_are_left_out(robot, tool):
    position = POSITIONS[0]
    run = run_of(robot, tool, position, error=smooth)
    # the arm comes from elsewhere, rests, drills, and goes away again
    away = np.linspace(0, 1, 200)[:, None] * np.radians([20, -10, 5, 30, 0, 10])
    joints = [run.recording.joints[0] + away[::-1], run.recording.joints, run.recording.joints[-1] + away]
    commanded = [run.recording.joints_commanded[0] + away[::-1], run.recording.joints_commanded]
    commanded.append(run.recording.joints_commanded[-1] + away)
    count = sum(map(len, joints))
    whole = Recording(0.004 * np.arange(count), np.concatenate(joints), np.concatenate(commanded))
    hole = planned(robot, tool, position)
    plain, found = (metrics(drilling_run(each, hole)) for each in (run.recording, whole))
    assert found.deviation_max == pytest.approx(plain.deviation_max, abs=1e-6)
    assert found.path_length == pytest.approx(plain.path_length, abs=2.5e-3)  # what of the moves is within 2 mm
    with pytest.raises(InputError, match="only joint angles are recorded"):
        drilling_run(whole)


def test_the_window_is_an_option(robot, tool):
    run = drilling_run(run_of(robot, tool, POSITIONS[0], error=kick).recording, planned(robot, tool, POSITIONS[0]))
    narrow, wide = metrics(run, 2e-3), metrics(run, 1.0)
    assert narrow.window == 2e-3
    assert wide.deviation_max == pytest.approx(np.linalg.norm(wide.lateral - wide.mean, axis=1).max())
    assert narrow.deviation_rms > wide.deviation_rms  # the kick is at the turn
    for window in (0.0, -1.0, math.nan, math.inf):
        with pytest.raises(InputError, match="window"):
            metrics(run, window)


class TestAnotherPlan:
    def test_another_hole(self, robot, tool):
        recording = run_of(robot, tool, POSITIONS[0]).recording
        with pytest.raises(InputError, match=r"run of position 1, hole position 3: .* not the plan's: the tip stays"):
            drilling_run(recording, planned(robot, tool, POSITIONS[2]))

    def test_a_hole_on_the_same_axis(self, robot, tool):
        recording = run_of(robot, tool, POSITIONS[0]).recording
        for further, says in ((0.02, "20.0 mm before the target"), (-0.03, "30.0 mm beyond the target")):
            hole = POSITIONS[0].hole
            other = Hole("other", hole.target + further * hole.direction, hole.direction, hole.depth)
            with pytest.raises(InputError, match=says):
                drilling_run(recording, planned(robot, tool, POSITIONS[0], other))

    def test_another_tool(self, robot, tool):
        recording = run_of(robot, tool, POSITIONS[0]).recording
        longer = tool.T_flange_tcp.copy()
        longer[2, 3] += 0.03
        turned = tool.T_flange_tcp.copy()
        turned[:3, :3] = turned[:3, :3] @ np.array(
            [[1, 0, 0], [0, np.cos(0.1), -np.sin(0.1)], [0, np.sin(0.1), np.cos(0.1)]]
        )
        for T, says in ((longer, "the tip stays"), (turned, "the drill points 5.7 deg")):
            with pytest.raises(InputError, match=says):
                drilling_run(recording, planned(robot, Tool("other", T), POSITIONS[0]))

    def test_another_robot(self, robot, tool):
        from robots import TRIED
        from zerorev.files.io import read_robot

        recording = run_of(robot, tool, POSITIONS[0]).recording
        others = [name for name in TRIED if name != "kuka_kr6_r700_2"]
        assert others
        for name in others:
            with pytest.raises(InputError, match="not the plan's"):
                drilling_run(recording, planned(read_robot(name), tool, POSITIONS[0]))

    def test_the_hole_is_named(self, robot, tool):
        holes = tuple(
            HolePlan(each.hole, "evaluated", 0.155, Motion(each.profile, each.branch, np.zeros((3, 6))))
            for each in POSITIONS
        )
        plan = Plan(robot, tool, Settings(), holes)
        assert planned_hole(plan, "position 2").drilling.hole.id == "position 2"
        assert planned_hole(replace(plan, holes=holes[:1]), None).lead_in == plan.settings.lead_in
        with pytest.raises(InputError, match="has 3 holes with a motion"):
            planned_hole(plan, None)
        with pytest.raises(InputError, match="no hole 'x'"):
            planned_hole(plan, "x")


def test_the_controllers_tip_is_compared(robot, tool):
    run = run_of(robot, tool, POSITIONS[0], tips=True)
    hole = planned(robot, tool, POSITIONS[0])
    (same,) = tip_of(run.recording, hole).findings
    assert (same.level, same.kind) == ("info", "tip_difference")
    assert "0.000 mm at most" in same.message
    # a tool frame that is 0.6 mm off turns with the tool
    off = tool.T_flange_tcp.copy()
    off[:3, 3] += off[:3, :3] @ np.array([0.6e-3, 0, 0])
    other = PlannedHole(Drilling(robot, Tool("off", off), POSITIONS[0].hole), hole.motion, 5e-3, 1e-3)
    (apart,) = tip_of(run.recording, other).findings
    assert apart.level == "warning"
    assert "0.600 mm at most" in apart.message
    assert float(apart.message.split("moves ")[1].split()[0]) > 0.1


def test_sampling_too_slow_for_the_feed_is_said(robot, tool):
    for interval, feed, slow in ((0.012, 0.2, True), (0.004, 0.02, False)):
        run = run_of(robot, tool, POSITIONS[1], interval=interval, feed=feed, before=20)
        found = metrics(drilling_run(run.recording, planned(robot, tool, POSITIONS[1]))).findings
        assert [finding.kind for finding in found] == ["sampling"] * slow


def test_what_does_not_move_is_refused(robot, tool):
    still = Recording(np.arange(50.0), tcp=np.zeros((50, 3)))
    with pytest.raises(InputError, match=r"the tip moves by 0\.000 mm"):
        drilling_run(still)
    with pytest.raises(InputError, match="never changes"):
        drilling_run(Recording(np.arange(50.0), tcp=np.zeros((50, 3)), tcp_commanded=np.zeros((50, 3))))
    circle = np.stack([np.cos(np.arange(50.0)), np.sin(np.arange(50.0)), np.zeros(50)], axis=1)
    with pytest.raises(InputError, match="leaves the line"):
        drilling_run(Recording(np.arange(50.0), tcp=circle))


@pytest.mark.parametrize(
    ("direction", "left", "up"),
    [([1, 0, 0], [0, 1, 0], [0, 0, 1]), ([0, 1, 0], [-1, 0, 0], [0, 0, 1]), ([0, 0, -1], [1, 0, 0], [0, -1, 0])],
)
def test_horizontal_and_vertical(direction, left, up):
    parts = across(np.array([left, up, direction], dtype=float), np.array(direction, dtype=float))
    assert parts == pytest.approx(np.array([[1, 0], [0, 1], [0, 0]]), abs=1e-15)


@given(st.lists(st.integers(-6, 6), min_size=1, max_size=40), st.integers(1, 4))
def test_reversals_are_those_of_the_plain_twin(steps, swing):
    angles = np.cumsum(np.array(steps, dtype=float))
    assert reversals(angles, float(swing)) == plain_reversals(angles.tolist(), float(swing))


class TestRepeatability:
    def runs(self, robot, tool, count, **options):
        hole = planned(robot, tool, POSITIONS[1])
        return [
            drilling_run(run_of(robot, tool, POSITIONS[1], seed=n, **options).recording, hole) for n in range(count)
        ]

    def test_equal_runs_do_not_differ(self, robot, tool):
        hole = planned(robot, tool, POSITIONS[1])
        pair = [drilling_run(run_of(robot, tool, POSITIONS[1], before=n).recording, hole) for n in (40, 90)]
        found = repeatability(pair)
        assert found.tip_max < 1e-9
        assert np.abs(found.torque_max).max() < 1e-6
        assert found.radius is None

    def test_known_differences(self, robot, tool):
        hole = planned(robot, tool, POSITIONS[1])
        runs = [
            drilling_run(
                run_of(robot, tool, POSITIONS[1], error=lambda path, n=n: (n * 1e-5 + 0 * path, 0 * path)).recording,
                hole,
            )
            for n in (-2, -1, 0, 1, 2)
        ]
        for n, run in enumerate(runs):
            louder = replace(run.recording, torque=run.recording.torque + 0.25 * n)
            runs[n] = replace(run, recording=louder)
        found = repeatability(runs)
        assert found.tip_max == pytest.approx(4e-5, abs=1e-8)
        assert found.torque_max == pytest.approx(np.full(6, 1.0), abs=1e-6)
        apart = [0.25 * abs(a - b) for a in range(5) for b in range(a)]
        assert found.torque_rms == pytest.approx(np.full(6, np.sqrt(np.mean(np.square(apart)))), abs=1e-6)
        away = np.abs([-2e-5, -1e-5, 0, 1e-5, 2e-5])
        assert found.radius == pytest.approx(away.mean() + 3 * away.std(ddof=1), abs=1e-8)

    def test_too_few(self, robot, tool):
        with pytest.raises(InputError, match="two or more"):
            repeatability(self.runs(robot, tool, 1, error=no_error))
