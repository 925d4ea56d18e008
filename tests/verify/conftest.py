"""Robots and the tool straight from their files, the published plans, and plans with honest claims to spoil."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import yaml

import zerorev.files
from zerorev.model.hole import Hole
from zerorev.model.job import Settings
from zerorev.model.plan import Event, HolePlan, Motion, Score
from zerorev.model.profile import Profile
from zerorev.model.robot import ArmGeometry, JointLimits, Robot
from zerorev.model.tool import Tool
from zerorev.verify.arm import branch_of, posture_of, skeleton
from zerorev.verify.certificate.certify import certify_hole
from zerorev.verify.measure import mean_rates, reversals, travel
from zerorev.verify.path import Track, follow, legs
from zerorev.verify.sound import limit_distances

FILES = Path(zerorev.files.__file__).parent
ROBOTS = ("kuka_kr6_r700_2", "kuka_kr120_r2700_2", "abb_irb4600_60_205", "yaskawa_gp8", "staubli_tx2_90l")

# thesis Appendix B with theory §6 and §7: target [mm], stroke [mm], spins [deg], joints at start, target, end [deg]
PUBLISHED = {
    1: (
        (500, 300, 800),
        50,
        (14.1646, -5.9388, -30.4599),
        (
            (143.1752, -107.9003, -79.0638, 11.3008, 88.3939, 217.3562),
            (141.688, -120.7634, -61.915, -4.6854, 96.3471, 217.943),
            (132.754, -121.5371, -57.5418, -21.63, 110.9973, 223.361),
        ),
    ),
    2: (
        (200, 400, 600),
        20,
        (180.0, 180 - 1.8999, 180 - 1.8999 - 35.6083),
        (
            (-78.6901, -86.9817, 87.6934, 0, 89.2884, 101.3099),
            (-75.7884, -87.0847, 87.8145, -0.46682, 87.4284, 104.225),
            (-75.3314, -102.9224, 107.3981, -11.6946, 49.5235, 109.3832),
        ),
    ),
    3: (
        (200, 200, 1000),
        30,
        (20.2431, -4.5475, -9.6903),
        (
            (115.5591, -64.3099, -87.1047, 12.4793, 43.6965, 236.7431),
            (115.223, -75.2295, -81.4464, -2.0503, 70.8028, 245.521),
            (107.2031, -75.6544, -80.8389, -2.9439, 75.7758, 253.7521),
        ),
    ),
}


def load_robot(name):
    data = yaml.safe_load((FILES / "robots" / f"{name}.yaml").read_text())
    lengths, joints = data["geometry_mm"], data["joints"]
    arm = ArmGeometry(
        *(lengths[key] * 1e-3 for key in ("a1", "a2", "b", "c1", "c2", "c3", "c4")),
        sign=tuple(joints["sign"]),
        offset=tuple(np.deg2rad(joints["offset_deg"])),
    )
    limits = JointLimits(*(np.deg2rad(joints[key]) for key in ("lower_deg", "upper_deg", "speed_deg_s")))
    return Robot(name, arm, limits, tuple(joints["names"]))


@pytest.fixture(scope="session")
def kuka():
    return load_robot("kuka_kr6_r700_2")


@pytest.fixture(scope="session", params=ROBOTS)
def robot(request):
    return load_robot(request.param)


@pytest.fixture(scope="session")
def drill():
    data = yaml.safe_load((FILES / "tools" / "thesis_drill.yaml").read_text())
    return Tool.from_mm_deg(data["tcp_mm"], data["rpy_deg"], name=data["name"])


@pytest.fixture(scope="session")
def settings():
    return Settings()


def wrist_offset(robot, tool):
    """Distance of the wrist centre from the drill axis, by projecting it out of the line."""
    axis, tip = tool.T_flange_tcp[:3, 2], tool.T_flange_tcp[:3, 3]
    arm = np.array([0, 0, -robot.arm.c4]) - tip
    return float(np.linalg.norm(arm - (arm @ axis) * axis))


def honest(robot, tool, hole, profile, start, status="evaluated", samples=20_000):
    """A plan whose claims are measured: joints followed from near `start`."""
    path = legs(profile, samples)
    track = Track(path, follow(robot, tool, hole, path, posture_of(robot.arm, start), start))
    turned = reversals(track)

    def event(joint, index):
        leg = "target" if index == path.corner else "plunge" if index < path.corner else "retract"
        return Event(joint + 1, leg, float(path.standoff[index]))

    score = Score(
        reversals_per_joint=tuple(map(len, turned)),
        events=tuple(event(joint, i) for joint in range(6) for i in turned[joint]),
        travel=travel(track),
        min_rate=track.moves.slowest,
        mean_rate=mean_rates(track),
        limit_distance=limit_distances(robot, track.joints).min(axis=0),
    )
    joints = track.joints[list(path.knots)]
    motion = Motion(profile, branch_of(robot.arm, joints[0]), joints)
    return HolePlan(hole, status, wrist_offset(robot, tool), motion, score)


@pytest.fixture(scope="session")
def published(kuka, drill):
    """A function: position -> the thesis' plan of it, or the same hole with other spins [deg]."""

    def make(position, psi_deg=None):
        target, stroke, spins, joints = PUBLISHED[position]
        hole = Hole(f"position {position}", np.array(target) * 1e-3, [1, 0, 0], stroke * 1e-3, [0, 1, 0])
        profile = Profile.straight(stroke * 1e-3, *np.deg2rad(spins if psi_deg is None else psi_deg))
        return honest(kuka, drill, hole, profile, np.deg2rad(joints[0]), "planned")

    return make


@pytest.fixture(scope="session")
def appendix_b():
    return PUBLISHED


@pytest.fixture(scope="session")
def build():
    return honest


@pytest.fixture(scope="session")
def random_hole():
    """A function: robot, tool, seed -> hole, gentle profile and start joints, well away from singular postures."""

    def make(robot, tool, seed, *, joints_deg=None, depth=None):
        rng = np.random.default_rng(seed)
        middle, half = (robot.limits.upper + robot.limits.lower) / 2, (robot.limits.upper - robot.limits.lower) / 2
        while True:
            start = middle + 0.6 * half * rng.uniform(-1, 1, 6)
            if joints_deg is not None:
                start = np.deg2rad(np.array(joints_deg, dtype=float))
            body = skeleton(robot.arm, start[None])
            R = body.R_base_flange[:, :, 0] @ tool.T_flange_tcp[:3, :3]
            tip = body.flange[:, 0] + body.R_base_flange[:, :, 0] @ tool.T_flange_tcp[:3, 3]
            along = -R[:, 2]
            stroke = depth or rng.uniform(0.002, 0.03)
            hole = Hole("random", tip + stroke * along, along, stroke, R[:, 1])
            profile = Profile.straight(stroke, 0.0, *rng.uniform(-0.3, 0.3, 2))
            plan = honest(robot, tool, hole, profile, start, samples=500)
            smooth = np.isfinite(plan.motion.joints).all() and plan.score.limit_distance.min() > 0
            if joints_deg is not None or (smooth and np.abs(np.diff(plan.motion.joints, axis=0)).max() < 1):
                return hole, profile, start

    return make


@pytest.fixture
def modest(published):
    """Plans with claims that are a little modest: those of the fixture are measured by steps, not at points."""

    def make(position, psi_deg=None):
        plan = published(position, psi_deg)
        score = plan.score
        modestly = replace(score, min_rate=score.min_rate * 0.5, mean_rate=score.mean_rate * (1 - 1e-6))
        return replace(plan, score=modestly)

    return make


@pytest.fixture
def prove(kuka, drill, settings):
    def run(plan, *, robot=kuka, **changes):
        answer = certify_hole(robot, drill, replace(settings, **changes), plan)
        assert (answer.verdict == "certified") == (not answer.reasons)
        return answer

    return run
