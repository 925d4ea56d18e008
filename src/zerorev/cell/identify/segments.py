"""Where in a recording one joint alone moves at an even speed, and what the drives gave there."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from zerorev.errors import InputError
from zerorev.kernels import dynamics
from zerorev.model._arrays import Array
from zerorev.model.dynamics import Load
from zerorev.model.recording import Recording
from zerorev.motion.bodies import bodies_of
from zerorev.motion.drilling import Drilling
from zerorev.motion.loads import GRAVITY

__all__ = ["Segment", "segments"]

SLOWEST_SAMPLING = 30e-3  # [s]
DROPPED = 0.15  # [s] round a reversal
OVER = 40e-3  # [s] that a speed is taken over
MOVES, RESTS = 0.01, 3e-3  # [rad/s]
EVEN = 0.05  # of the speed
FEWEST = 6  # samples
NEAR = float(np.deg2rad(12.0))  # of the posture about which the sweeps were written


@dataclass(frozen=True)
class Segment:
    """One joint at an even speed, the others at rest: means over its samples.

    Attributes:
        joint: 0..5.
        speed: [rad/s], with its sign.
        torque: of the drive of that joint [N m], on the joint's side.
        bare: torque that holds the bare arm [N m].
        mass: torque per kilogram at the flange [N m/kg].
        moment: torque per kilogram, at the tip less at the flange [N m/kg].
        spread: standard deviation of the torque within the segment [N m].
        unsteady: standard deviation of the measured speed, as a share of the speed; large where the joint sticks.
        count: samples.
    """

    joint: int
    speed: float
    torque: float
    bare: float
    mass: float
    moment: float
    spread: float
    unsteady: float
    count: int


def segments(
    recording: Recording, drilling: Drilling, posture: Array | None = None, torque_ratio: Sequence[float] = (1.0,) * 6
) -> list[Segment]:
    """The segments of one recording.

    Args:
        recording: of sweeps.
        drilling: robot and tool; the robot has dynamics.
        posture: about which the sweeps were written [rad], shape (6,); None: any.
        torque_ratio: by which logged torques are multiplied to be those of the joints.

    Raises:
        InputError: no torque, no joints, sampled too slowly, another posture or robot, nothing that moves.
    """
    where = recording.source
    if recording.torque is None:
        raise InputError("no torque is recorded", where=where, accepted="A1_torque_nm to A6_torque_nm (Istmoment)")
    if recording.joints is None:
        raise InputError("no joint angles are recorded", where=where, accepted="A1_deg to A6_deg (Istposition)")
    if recording.interval > SLOWEST_SAMPLING:
        raise InputError(
            f"one sample every {recording.interval * 1e3:.0f} ms: too few between two reversals",
            where=where,
            accepted=f"{SLOWEST_SAMPLING * 1e3:.0f} ms or less, better 12",
        )  # fmt: skip
    _check_posture(recording, drilling, posture)
    led = recording.joints if recording.joints_commanded is None else recording.joints_commanded
    step = recording.interval
    half = max(round(OVER / 2 / step), 1)
    speed = _speeds(recording.time, led, half)
    measured = _speeds(recording.time, recording.joints, half)
    moves, rests = np.abs(speed) > MOVES, np.abs(speed) < RESTS
    alone = (moves.sum(axis=1) == 1) & (rests.sum(axis=1) == 5)
    first = np.argmax(moves, axis=1)
    state = np.where(alone, (first + 1) * np.sign(speed[np.arange(len(speed)), first]), 0).astype(int)
    found = []
    drop = round(DROPPED / step)
    begin = 0
    for end in (*(np.flatnonzero(np.diff(state)) + 1), state.size):
        rows = slice(begin + drop, end - drop)
        if state[begin] != 0 and end - begin - 2 * drop >= FEWEST:
            found.append((abs(int(state[begin])) - 1, rows))
        begin = int(end)
    held = _held(recording.joints, drilling)
    results = []
    for joint, rows in found:
        own = speed[rows, joint]
        kept = np.flatnonzero(np.abs(own - np.median(own)) <= EVEN * abs(np.median(own))) + rows.start
        if kept.size < FEWEST:
            continue
        torque = recording.torque[kept, joint] * torque_ratio[joint]
        bare, mass, moment = held[:, kept, joint]
        results.append(
            Segment(
                joint, float(speed[kept, joint].mean()), float(torque.mean()), float(bare.mean()), float(mass.mean()),
                float(moment.mean()), float((torque - bare).std()),
                float(measured[kept, joint].std() / abs(speed[kept, joint].mean())), int(kept.size),
            )
        )  # fmt: skip
    if not results:
        raise InputError(
            "no joint moves alone at an even speed", where=where,
            accepted="the recording of a program that --write-sweeps wrote",
        )  # fmt: skip
    return results


def _speeds(time: Array, joints: Array, half: int) -> Array:
    at = np.arange(len(time))
    before, after = np.maximum(at - half, 0), np.minimum(at + half, len(time) - 1)
    return np.asarray((joints[after] - joints[before]) / (time[after] - time[before])[:, None])


def _check_posture(recording: Recording, drilling: Drilling, posture: Array | None) -> None:
    joints, limits, names = recording.joints, drilling.robot.limits, drilling.robot.joint_names
    assert joints is not None
    outside = np.maximum(limits.lower - joints.min(axis=0), joints.max(axis=0) - limits.upper)
    if (outside > 0).any():
        n = int(np.argmax(outside))
        raise InputError(
            f"{names[n]} is {np.degrees(outside[n]):.1f} deg beyond its limit", where=recording.source,
            accepted=f"joint angles of the robot {drilling.robot.name}, with --gear-ratio where the motors' are logged",
        )  # fmt: skip
    if posture is not None:
        off = np.abs(np.median(joints, axis=0) - posture)
        if (off > NEAR).any():
            n = int(np.argmax(off))
            raise InputError(
                f"{names[n]} is {np.degrees(off[n]):.1f} deg from where the sweeps of hole {drilling.hole.id} are",
                where=recording.source,
                accepted="recordings of the sweeps of this plan and hole (--hole), on this robot",
            )


def _held(joints: Array, drilling: Drilling) -> Array:
    """Torques that hold the bare arm, a kilogram at the flange, the same at the tip less at the flange: (3, N, 6)."""
    robot, tool = drilling.robot, drilling.tool
    q, still = np.ascontiguousarray(joints), np.zeros_like(joints)
    out = np.empty((3, *joints.shape))
    for n, share in enumerate((None, 0.0, 1.0)):
        load = None if share is None else Load(1.0, share * tool.T_flange_tcp[:3, 3], np.zeros((3, 3)))
        bodies = bodies_of(robot, replace(tool, load=load))
        if bodies is None:
            raise InputError(
                f"the masses of the robot {robot.name} are not known", where="robot",
                accepted="a robot file with dynamics: links, payload_kg",
            )  # fmt: skip
        dynamics.inverse_dynamics(robot.arm, bodies, q, still, still, GRAVITY, out[n])
    out[2] -= out[1]
    out[1] -= out[0]
    return out
