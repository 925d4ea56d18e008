"""What is probably wrong with a job is said, and of an ordinary job nothing is."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from oracles.holes import THESIS_DRILL, random_hole
from oracles.places import ROOT
from zerorev.files.io import read_job, read_robot, robot_names
from zerorev.model._arrays import rotation_rpy, transform
from zerorev.model.hole import Hole
from zerorev.model.job import Job
from zerorev.model.profile import Profile
from zerorev.model.settings import Settings
from zerorev.model.tool import Tool
from zerorev.planning.likely_mistakes import GUESSES, likely_mistakes
from zerorev.planning.same_holes import CLOSE, same_holes

JOBS = [*sorted((ROOT / "examples/jobs").rglob("*.yaml")), ROOT / "docs/tutorial/bracket.yaml",
        ROOT / "src/zerorev/web/demo.yaml"]  # fmt: skip
PLACES = np.array([[0.5, 0.3, 0.8], [0.5, 0.33, 0.8], [0.5, 0.36, 0.8], [0.52, 0.3, 0.7]])


def job(*, robot=None, tool=THESIS_DRILL, targets=PLACES, direction=(1, 0, 0), depth=0.02, T=None, **settings):
    holes = tuple(Hole(f"h{n}", target, np.array(direction, float), depth, (0.3, 0.5, 0.7))
                  for n, target in enumerate(targets))  # fmt: skip
    return Job(robot or read_robot("kuka_kr6_r700_2"), tool, holes, Settings(**settings), np.eye(4) if T is None else T)


def said(wanted):
    found = likely_mistakes(wanted)
    assert all(finding.level == "warning" and finding.kind in GUESSES for finding in found)
    return {finding.kind for finding in found}, " | ".join(finding.message for finding in found)


# --- nothing is said of what is right ---------------------------------------------------------------------------------


@pytest.mark.parametrize("path", JOBS, ids=lambda path: path.stem)
def test_no_shipped_job_warns(path):
    assert likely_mistakes(read_job(path)) == ()


@pytest.mark.parametrize("name", robot_names())
def test_no_shipped_robot_warns(name):
    robot = read_robot(name)
    assert said(job(robot=robot, targets=PLACES * robot.reach / 0.7))[0] == set()


def test_no_random_job_warns_but_of_what_is_so():
    """Random tools point anywhere, and random postures reach into the robot: that is found again by other means."""
    warned = 0
    for seed in range(300):
        drilled = random_hole(seed)
        kinds, message = said(Job(drilled.robot, drilled.tool, (drilled.hole,), drilled.settings))
        T, (x, y, z) = drilled.tool.T_flange_tcp, drilled.hole.target
        back = np.degrees(np.arccos(-T[:3, 2] @ T[:3, 3] / np.linalg.norm(T[:3, 3]))) > 95
        steps = T[:3, 3] - np.outer(np.linspace(0, 3 * np.linalg.norm(T[:3, 3]), 4000), T[:3, 2])
        hits = np.linalg.norm(steps[:, :2], axis=1).min() < 0.045 * drilled.robot.reach
        inside = np.sqrt(x * x + y * y) < 0.13 * drilled.robot.reach and z < drilled.robot.arm.c1
        assert kinds <= ({"tool_direction"} if back and hits else set()) | ({"base_column"} if inside else set()), (
            message
        )
        warned += bool(kinds)
    assert warned < 30
    assert all(said(Job(each.robot, THESIS_DRILL, (each.hole,), each.settings))[0] <= {"base_column"}
               for each in map(random_hole, range(60)))  # fmt: skip


# --- units ------------------------------------------------------------------------------------------------------------


def with_robot(lengths=1.0, angles=1.0, speeds=1.0):
    robot = read_robot("kuka_kr120_r2700_2")
    arm, limits = robot.arm, robot.limits
    arm = arm._replace(**{name: getattr(arm, name) * lengths for name in ("a1", "a2", "b", "c1", "c2", "c3", "c4")},
                       offset=tuple(each * angles for each in arm.offset))  # fmt: skip
    limits = replace(limits, lower=limits.lower * angles, upper=limits.upper * angles, speed=limits.speed * speeds)
    return replace(robot, arm=arm, limits=limits)


@pytest.mark.parametrize(
    ("wanted", "words"),
    [
        (job(robot=with_robot(lengths=1e-3)), "are they in metres? geometry_mm"),
        (job(robot=with_robot(lengths=1 / 25.4)), "are they in inches? geometry_mm"),
        (job(robot=with_robot(angles=np.pi / 180)), "joint limits"),
        (job(robot=with_robot(angles=np.pi / 180)), "an offset of the robot kuka_kr120_r2700_2 is -1.5708"),
        (job(robot=with_robot(speeds=np.pi / 180)), "joint speeds"),
        (job(tool=Tool.from_mm_deg((0.1, 0, 0.065), (0, -90, 0))), "is it in metres? tcp_mm"),
        (job(tool=Tool.from_mm_deg((3.94, 0, 2.56), (0, -90, 0))), "is it in inches? tcp_mm"),
        (job(tool=Tool.from_mm_deg((100, 0, 65), (0, -np.pi / 2, 0))), "an angle of tool.rpy_deg is -1.5708"),
        (job(T=transform(rotation_rpy(0, 0, np.deg2rad(np.pi)), np.zeros(3))), "in degrees it is 180"),
        (job(targets=PLACES * 1e-3), "within 1.01 mm of the base's origin"),
        (job(targets=PLACES / 25.4), "of the base's origin"),
        (job(targets=PLACES[0] + PLACES * 1e-3), "within 0.118 mm of each other"),
        (job(depth=2e-5), "no hole is deeper than 0.02 mm"),
        (job(depth=0.02 / 25.4), "no hole is deeper than 0.787 mm"),
        (job(feed_plunge=5e-6, feed_retract=0.02), "a plunge at 0.005 mm/s takes up to 66.7 min"),
        (job(feed_plunge=0.3), "is feed_mm_s.plunge in mm/min"),
        (job(feed_plunge=0.12, spindle_rpm=6000), "is 1.2 mm per turn of the drill"),
        (job(feed_retract=2e-5), "is feed_mm_s.retract in m/s"),
        (job(psi_bound=np.deg2rad(np.pi)), "psi_bound_deg is 3.1416: is it in radians? in degrees it is 180"),
    ],
)
def test_units(wanted, words):
    kinds, message = said(wanted)
    assert "units" in kinds
    assert words in message


# --- tool, directions, places -----------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("tcp", "rpy", "cure"),
    [
        ((100, 0, 65), (0, 90, 0), "rpy_deg [0, -90, 0]?"),
        ((0, 80, 120), (-90, 0, 0), "rpy_deg [90, 0, 0]?"),
        ((0, 0, 150), (0, 0, 0), "check rpy_deg and tcp_mm"),
        ((-100, 0, 65), (0, -90, 0), "rpy_deg [0, 90, 0]?"),
    ],
)
def test_a_drill_that_points_back(tcp, rpy, cure):
    kinds, message = said(job(tool=Tool.from_mm_deg(tcp, rpy)))
    assert kinds == {"tool_direction"}
    assert cure in message


@pytest.mark.parametrize(
    ("tcp", "rpy"), [((100, 0, 65), (0, -90, 0)), ((0, 0, 200), (180, 0, 0)), ((0, -80, 120), (-90, 0, 0)),
                     ((150, 0, 200), (180, 0, 0)), ((100, 0, 165), (0, -135, 0)), ((0, 0, 0), (0, 0, 0))]
)  # fmt: skip
def test_drills_that_point_ahead_or_aside(tcp, rpy):
    assert said(job(tool=Tool.from_mm_deg(tcp, rpy)))[0] == set()


def test_angles_of_a_tool_in_the_order_of_kuka():
    """A = 0, B = 30, C = 180 of a drill that points ahead and aside, typed as roll, pitch, yaw."""
    assert said(job(tool=Tool.from_mm_deg((0, 0, 150), (180, 30, 0))))[0] == set()
    kinds, message = said(job(tool=Tool.from_mm_deg((0, 0, 150), (0, 30, 180))))
    assert kinds == {"tool_direction", "frame_angles"}
    assert "are they A, B, C, which are yaw, pitch, roll? rpy_deg: [180, 30, 0], or abc_deg" in message


def test_drills_that_all_point_towards_the_robot():
    assert said(job(direction=(-1, 0, 0)))[0] == {"normals"}
    assert said(job(direction=(0, 0, 1), targets=PLACES - [0, 0, 0.9]))[0] == {"normals"}
    assert said(job(direction=(-1, 0, 0), targets=PLACES[:1]))[0] == set()
    assert said(job(direction=(0, 0, -1)))[0] == set()


def test_targets_in_the_column():
    kinds, message = said(job(targets=[*PLACES, [0.03, 0.02, 0.2]]))
    assert kinds == {"base_column"}
    assert message.endswith("h4; is part_frame missing?")
    moved = transform(np.eye(3), np.array([0.1, 0, 0]))
    assert said(job(targets=[*PLACES, [0.03, 0.02, 0.2]], T=moved))[1].endswith("check part_frame")


# --- holes that are drilled twice -------------------------------------------------------------------------------------


def twin_pairs(holes):
    """By sampling both strokes: on one line, and half of the shorter within the longer."""
    found = []
    for i, one in enumerate(holes):
        for j in range(i + 1, len(holes)):
            other = holes[j]
            short, long = (one, other) if one.depth <= other.depth else (other, one)
            points = short.target - np.outer((np.arange(2000) + 0.5) / 2000 * short.depth, short.direction)
            along = (long.target - points) @ long.direction
            across = np.linalg.norm(points + along[:, None] * long.direction - long.target, axis=1)
            parallel = abs(one.direction @ other.direction) > np.cos(np.deg2rad(2))
            if parallel and across.max() < CLOSE and ((along > 0) & (along < long.depth)).mean() > 0.5:
                found.append((i, j))
    return found


def test_holes_drilled_twice_are_those_that_sampling_finds():
    rng = np.random.default_rng(5)
    for _ in range(30):
        holes = []
        for n in range(24):
            direction = np.eye(3)[rng.integers(3)] * rng.choice([-1, 1])
            target = rng.integers(0, 3, 3) * 0.01 + rng.uniform(-4e-4, 4e-4, 3)
            holes.append(Hole(f"h{n}", target, direction, float(rng.choice([0.01, 0.03])), (0.3, 0.5, 0.7)))
        from zerorev.planning.same_holes import _pairs

        assert [(i, j) for i, j, _ in _pairs(holes)] == twin_pairs(holes)


def test_what_is_said_of_them():
    one, far = job(targets=PLACES[:1]).holes[0], job().holes[3]
    beside = replace(one, id="b", target=one.target + np.array([0, 4e-4, 0]))
    opposite = replace(one, id="c", target=one.target - [0.02, 0, 0], direction=-one.direction)
    assert list(same_holes([one, far, beside])) == ["h0 and b are drilled 0.4 mm apart: is one of them a duplicate?"]
    assert "h0 and c are drilled on one axis from opposite sides" in next(same_holes([one, opposite]))
    assert "h0 and f are drilled at the same place: " in next(same_holes([one, replace(one, id="f", depth=0.01)]))
    assert list(same_holes([one, replace(one, id="d", branch=3)])) == []
    given = Profile(np.array([0.02, 0, 0.02]), np.zeros(3))
    assert list(same_holes([one, replace(one, id="d", profile=given)])) == []
    through = replace(
        one, id="e", target=one.target + np.array([0.02, 0, 0]), direction=-one.direction
    )  # from the other side
    assert list(same_holes([one, through])) == []


def test_many_at_one_place_end_soon():
    (one,) = job(targets=PLACES[:1]).holes
    holes = [replace(one, id=f"h{n}") for n in range(3000)]
    lines = list(same_holes(holes))
    assert len(lines) == 6
    assert "that overlap so: " in lines[-1]
    assert " or more; " in lines[-1]
