from __future__ import annotations

import base64
import json
import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest

from zerorev.model.hole import Hole
from zerorev.model.job import Settings
from zerorev.model.profile import Profile
from zerorev.motion.drilling import Drilling
from zerorev.motion.evaluation import evaluate
from zerorev.motion.kinematics import forward, tcp_pose
from zerorev.report.scene.cell_data import arm_data, holes_data, motion_data, slice_data, track_data


def unpacked(text, columns=1, kind="<f4"):
    values = np.frombuffer(base64.b64decode(text), dtype=kind)
    return values if columns == 1 else values.reshape(-1, columns)


@pytest.fixture
def track(robot, tool, position):
    return track_data(Drilling(robot, tool, position.hole), position.profile, position.branch, Settings())


def test_the_joints_bring_the_tip_along_the_path(robot, tool, position, track):
    joints = np.deg2rad(unpacked(track["joints_deg"], 6).astype(float))
    standoff, psi = unpacked(track["standoff_mm"]) * 1e-3, np.deg2rad(unpacked(track["psi_deg"]))
    found = forward(robot, joints) @ tool.T_flange_tcp
    assert found == pytest.approx(tcp_pose(position.hole, standoff, psi), abs=1e-5)
    assert len(joints) > 100
    assert (np.diff(unpacked(track["x_mm"])) > 0).all()


def test_distance_is_counted_from_the_target(position, track):
    x, standoff = unpacked(track["x_mm"]), unpacked(track["standoff_mm"])
    assert np.abs(x) == pytest.approx(standoff, abs=1e-4)
    assert x[[0, -1]] == pytest.approx([-position.hole.depth * 1e3, position.hole.depth * 1e3], rel=1e-6)


def test_time_is_by_the_feeds(robot, tool, position):
    settings = Settings(feed_plunge=5e-3, feed_retract=20e-3)
    track = track_data(Drilling(robot, tool, position.hole), position.profile, position.branch, settings)
    seconds, x = unpacked(track["seconds"]), unpacked(track["x_mm"])
    depth = position.hole.depth
    assert seconds[-1] == pytest.approx(depth / 5e-3 + depth / 20e-3, rel=1e-6)
    assert np.interp(0.0, x, seconds) == pytest.approx(depth / 5e-3, rel=1e-6)


def test_reversals_are_samples_and_are_where_evaluate_finds_them(robot, tool, positions):
    position = positions[0]
    profile = replace(position.profile, psi=np.deg2rad([14.0, -5.0, 40.0]))
    score = evaluate(robot, tool, position.hole, profile, position.branch).score
    track = track_data(Drilling(robot, tool, position.hole), profile, position.branch, Settings())
    assert score.reversals > 0
    assert track["reversals"] == score.reversals
    assert [mark["joint"] for mark in track["marks"]] == [event.joint for event in score.events]
    x = unpacked(track["x_mm"])
    for mark, event in zip(track["marks"], score.events, strict=True):
        assert abs(mark["x_mm"]) == pytest.approx(event.standoff * 1e3, abs=1e-6)
        assert np.abs(x - mark["x_mm"]).min() < 1e-3
        assert mark["name"] == robot.joint_names[event.joint - 1]


def test_a_joint_turns_round_at_its_mark(robot, tool, positions):
    """Seen in the very angles that are played."""
    position = positions[0]
    held = motion_data(Drilling(robot, tool, position.hole), position.profile, position.branch, Settings())["held"]
    joints, x = unpacked(held["joints_deg"], 6), unpacked(held["x_mm"])
    assert held["marks"]
    for mark in held["marks"]:
        at = int(np.abs(x - mark["x_mm"]).argmin())
        before, after = joints[at - 3, mark["joint"] - 1], joints[at + 3, mark["joint"] - 1]
        here = joints[at, mark["joint"] - 1]
        assert (before - here) * (after - here) > 0, mark


def test_the_baseline_keeps_the_spin_of_the_start(robot, tool, position):
    data = motion_data(Drilling(robot, tool, position.hole), position.profile, position.branch, Settings())
    assert data["hole"] == position.hole.id
    assert unpacked(data["held"]["psi_deg"]) == pytest.approx(np.rad2deg(position.profile.psi[0]), abs=1e-4)


def test_the_ribbon_starts_at_the_tip_and_turns_with_the_spin(position, track):
    ribbon, psi = unpacked(track["ribbon_mm"], 6).astype(float), np.deg2rad(unpacked(track["psi_deg"]))
    standoff = unpacked(track["standoff_mm"])
    tip, beside = ribbon[:, :3], ribbon[:, 3:] - ribbon[:, :3]
    along = position.hole.target * 1e3 - standoff[:, None] * position.hole.direction
    assert tip == pytest.approx(along, abs=1e-3)
    assert beside @ position.hole.direction == pytest.approx(0, abs=1e-3)
    way = beside / np.linalg.norm(beside, axis=1)[:, None]
    turned = np.arctan2(np.cross(way[0], way) @ -position.hole.direction, way @ way[0])
    assert np.unwrap(turned) == pytest.approx(psi - psi[0], abs=1e-4)


def test_a_motion_that_cannot_be_run_is_drawn_as_far_as_it_goes(robot, tool, positions):
    hole = replace(positions[0].hole, depth=1.2)
    profile = Profile(np.array([1.2, 0, 1.2]), np.zeros(3))
    track = track_data(Drilling(robot, tool, hole), profile, positions[0].branch, Settings())
    assert not track["runs"]
    assert track["why"]
    assert track["faults_mm"]
    assert np.isfinite(unpacked(track["joints_deg"])).all()
    assert track["reversals"] is None


def test_nothing_is_drawn_of_a_motion_out_of_reach(robot, tool):
    hole = Hole("far", np.array([9.0, 0, 0]), np.array([1.0, 0, 0]), 0.05)
    assert track_data(Drilling(robot, tool, hole), Profile.straight(0.05, 0, 0, 0), 0, Settings()) is None


def test_all_of_it_is_plain_json(robot, tool, published):
    answers = {answer.hole.id: answer for answer in published.holes}
    holes = [answer.hole for answer in published.holes]
    data = arm_data(robot, tool) | holes_data(holes, np.eye(4), answers)
    assert json.loads(json.dumps(data, allow_nan=False))["ids"] == [hole.id for hole in holes]
    assert data["reversals"] == [0, 0, 0, -2]
    assert holes_data(holes, np.eye(4), {})["reversals"] == [-1] * 4


def test_the_arm_is_available_without_the_library_that_draws_figures():
    code = (
        "import sys; from zerorev.report.scene.cell_data import arm_data; from zerorev.web.opening import demo;"
        "job = demo().job; arm_data(job.robot, job.tool); sys.exit('matplotlib' in sys.modules)"
    )
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


def test_plates_hold_the_holes_that_begin_on_them():
    turn = np.array([[0.6, 0, 0.8], [0, 1, 0], [-0.8, 0, 0.6]])
    grid = np.stack(np.meshgrid([0.0, 0.1, 0.3], [0.0, 0.2], [0.0]), axis=-1).reshape(-1, 3)
    holes = [Hole(str(n), turn @ place, turn[:, 2], 0.02 + 0.00 * n) for n, place in enumerate(grid)]
    holes.append(Hole("other", np.array([1.0, 1.0, 1.0]), np.array([0.0, 0, -1]), 0.03))
    T = np.eye(4)
    T[:3, :3] = turn
    plates = holes_data(holes, T, {})["plates"]
    assert len(plates) == 2
    for hole in holes:
        inside = 0
        for plate in plates:
            pose, half = np.array(plate["pose"]), np.array(plate["size_mm"]) / 2
            for place in (hole.target, hole.target - hole.depth * hole.direction):
                inside += bool((np.abs((place * 1e3 - pose[:, 3]) @ pose[:, :3]) <= half + 1e-6).all())
        assert inside == 2, hole.id


def test_a_rounded_part_has_no_plates():
    angles = np.linspace(0, 1, 60)
    holes = [
        Hole(str(a), np.array([np.cos(a), np.sin(a), 0]), np.array([np.cos(a), np.sin(a), 0]), 0.01) for a in angles
    ]
    assert holes_data(holes, np.eye(4), {})["plates"] == []


def test_cells_of_a_map():
    data = slice_data(np.array([[0.1, 0, 0], [0.2, 0, 0]]), np.eye(3)[:2] * 0.05, ("#ff0080", "#000001"), ("a", "b"))
    assert unpacked(data["position_mm"], 3) == pytest.approx(np.array([[100.0, 0, 0], [200, 0, 0]]))
    assert unpacked(data["rgb"], 3, "u1").tolist() == [[255, 0, 128], [0, 0, 1]]
    assert data["edges_mm"] == [[50, 0, 0], [0, 50, 0]]
