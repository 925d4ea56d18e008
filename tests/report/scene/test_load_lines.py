"""Curves of zero load, against the loads of a dense grid of points, each computed by the check's statics."""

from __future__ import annotations

import itertools
from dataclasses import replace

import numpy as np
import pytest

from oracles.published import POSITIONS
from zerorev.files.io import read_robot
from zerorev.model.dynamics import nominal_drives
from zerorev.model.hole import Hole
from zerorev.motion.drilling import Drilling
from zerorev.motion.kinematics import forward, jacobian
from zerorev.motion.loads import LEVELS, lost_motion_of
from zerorev.report.scene.load_lines import LEGS, load_lines, senses
from zerorev.report.scene.twist_map import twist_map

GRAVITY = 9.81
HALF = 1e-5  # [rad]
ROW = 7
STEP = np.deg2rad(2)  # of the coarse grid


def weights(drilling: Drilling, joints):
    """Torques of the weights alone [N m], shape (N, 6): how the potential grows with each joint, by its differences.

    A naive twin: links are placed by products of matrices.
    """
    robot, tool = drilling.robot, drilling.tool
    arm, links = robot.arm, robot.dynamics.links
    places = [(0, 0, 0), (arm.a1, 0, arm.c1), (0, arm.b, arm.c2), (arm.a2, 0, 0), (0, 0, arm.c3), (0, 0, 0)]

    def frames(controller):
        T, found = np.broadcast_to(np.eye(4), (len(controller), 4, 4)), []
        for i in range(6):
            angle = controller[:, i] * arm.sign[i] - arm.offset[i]
            step = np.broadcast_to(np.eye(4), T.shape).copy()
            step[:, :3, 3] = places[i]
            x, y = (0, 1) if "zyyzyz"[i] == "z" else (2, 0)
            step[:, x, x] = step[:, y, y] = np.cos(angle)
            step[:, y, x], step[:, x, y] = np.sin(angle), -np.sin(angle)
            T = T @ step
            found.append(T)
        return found

    still = [T[0] for T in frames(np.zeros((1, 6)))]
    bodies = [(link.mass, link.T_base_link @ np.append(link.com, 1.0), i) for i, link in enumerate(links)]
    bodies.append((tool.load.mass, forward(robot, np.zeros(6)) @ np.append(tool.load.com, 1.0), 5))

    def potential(controller):
        there = frames(controller)
        return sum(GRAVITY * mass * (there[i] @ np.linalg.inv(still[i]) @ centre)[:, 2] for mass, centre, i in bodies)

    steps = np.eye(6) * HALF
    return np.stack([(potential(joints + step) - potential(joints - step)) / (2 * HALF) for step in steps], axis=-1)


@pytest.fixture(scope="module")
def abb(tool):
    hole = Hole("abb", np.array([0.55, 0.1, 0.6]), np.array([1.0, 0, 0]), 0.04)
    return Drilling(read_robot("abb_irb1200_5_90"), tool, hole)


def cases(robot, tool, abb):
    for n, branch in ((0, 4), (1, 1), (2, 5)):
        yield Drilling(robot, tool, POSITIONS[n].hole), branch
    yield abb, 0


@pytest.mark.parametrize("thrust", [0.0, 100.0])
def test_a_curve_lies_where_the_load_is_zero_and_nowhere_is_one_missing(robot, tool, abb, thrust):
    """Along one stand-off the load of a joint is zero where a curve of it passes, and only there."""
    crossed = 0
    for drilling, branch in cases(robot, tool, abb):
        friction = nominal_drives(drilling.robot.dynamics.payload).coulomb
        standoff, psi = np.linspace(0, drilling.hole.depth, 21), np.linspace(-np.pi, np.pi, 181)
        lines = load_lines(drilling, branch, standoff, psi, thrust)
        dense = np.linspace(-np.pi, np.pi, 721)
        joints = drilling.angles(np.full(dense.size, standoff[ROW]), dense)[:, branch]
        held = weights(drilling, joints)
        pushed = (
            held + thrust * np.swapaxes(jacobian(drilling.robot, tool, joints)[:, :3], 1, 2) @ drilling.hole.direction
        )
        for leg, naive in zip(LEGS, (pushed, held), strict=True):
            for i, level, sense in itertools.product(range(6), LEVELS, (-1, 1)):
                load = naive[:, i] + sense * level * friction[i]
                ours = through(lines, i + 1, sense, level, leg, standoff[ROW])
                # next to the edge of reach the coarse grid has no cell
                zeros = dense[np.flatnonzero(load[:-1] * load[1:] < 0)]
                clear = [p for p in zeros if np.isfinite(load[np.abs(dense - p) < 2 * STEP]).all()]
                assert all(np.abs(ours - p).min(initial=9) < STEP for p in clear), (i, level, sense)
                there = np.array([np.interp(p, dense, load) for p in ours])
                slope = np.gradient(load, dense)
                steep = np.array([np.nanmax(np.abs(slope[np.abs(dense - p) < 2 * STEP])) for p in ours])
                assert (np.isnan(there) | (np.abs(there) < steep * STEP / 2)).all(), (i, level, sense)
                crossed += len(clear)
    assert crossed > 15


def through(lines, joint, sense, level, leg, standoff):
    """Spins at which curves pass a stand-off."""
    found = []
    for line in lines:
        if (line.joint, line.sense, line.level) == (joint, sense, level) and leg in line.legs:
            s, p = line.points.T
            for n in np.flatnonzero((s[:-1] - standoff) * (s[1:] - standoff) <= 0):
                share = 0.0 if s[n] == s[n + 1] else (standoff - s[n]) / (s[n + 1] - s[n])
                found.append(p[n] + share * (p[n + 1] - p[n]))
    return np.array(found)


def test_a_leg_crosses_a_curve_where_the_plan_has_an_event(robot, tool):
    """Of published motions: as many crossings of the curves for the way the joints turn as there are events."""
    counted = 0
    for n, (joint, leg, level) in ((0, (4, "plunge", 0.1)), (2, (2, "plunge", 0.1)), (2, (4, "plunge", 0.1))):
        position = POSITIONS[n]
        drilling = Drilling(robot, tool, position.hole)
        events = lost_motion_of(drilling, position.profile, position.branch).events
        (event,) = (each for each in events if (each.joint, each.leg, each.friction) == (joint, leg, level))
        turning = senses(drilling, position.profile, position.branch)
        assert len(turning[leg][joint - 1]) == 1  # a motion without a reversal
        standoff, psi = np.linspace(0, position.hole.depth, 61), np.linspace(-np.pi, np.pi, 361)
        lines = load_lines(drilling, position.branch, standoff, psi)
        wanted = [
            line for line in lines if (line.joint, line.level, line.sense) == (joint, level, turning[leg][joint - 1][0])
        ]
        spin = float(position.profile.at(np.array([position.hole.depth - event.standoff]))[1][0])
        spin = (spin + np.pi) % (2 * np.pi) - np.pi
        apart = min(
            np.hypot((line.points[:, 0] - event.standoff) / position.hole.depth, line.points[:, 1] - spin).min()
            for line in wanted
        )
        assert apart < 0.03
        counted += 1
    assert counted == 3


def test_senses_are_the_signs_of_the_joints_steps(robot, tool):
    for position in POSITIONS:
        drilling = Drilling(robot, tool, position.hole)
        found = senses(drilling, position.profile, position.branch)
        along = np.linspace(0, 2 * position.hole.depth, 401)
        joints = np.unwrap(drilling.angles(*position.profile.at(along))[:, position.branch], axis=0)
        steps = np.sign(np.diff(joints, axis=0))
        for leg, part in zip(LEGS, (steps[:200], steps[200:]), strict=True):
            assert found[leg] == tuple(tuple(sorted(set(part[:, i].astype(int)) - {0})) for i in range(6))


def test_the_first_axis_stands_upright_and_holds_nothing(robot, tool):
    drilling = Drilling(robot, tool, POSITIONS[0].hole)
    patch = np.linspace(0, 0.05, 11), np.linspace(-np.pi, np.pi, 61)
    assert not [line for line in load_lines(drilling, 4, *patch) if line.joint == 1]
    pushed = load_lines(drilling, 4, *patch, 200.0)
    assert {line.legs for line in pushed} == {("plunge",), ("retract",)}
    free = [line for line in pushed if line.legs == ("retract",)]
    for one, other in zip(free, load_lines(drilling, 4, *patch), strict=True):
        np.testing.assert_array_equal(one.points, other.points)


def test_without_masses_and_in_the_envelope_there_are_none(robot, tool):
    hole = POSITIONS[0].hole
    bare = Drilling(replace(robot, dynamics=None), tool, hole)
    assert twist_map(bare, 4, shape=(11, 31)).load_lines == ()
    assert twist_map(Drilling(robot, tool, hole), None, shape=(11, 31)).load_lines == ()
    assert twist_map(Drilling(robot, tool, hole), 4, shape=(11, 31)).load_lines
