"""Recordings as an arm of known parameters would leave them: sweeps, and the baseline of a hole."""

from __future__ import annotations

import numpy as np

from zerorev.cell.followed import STEP, Followed
from zerorev.cell.parameters import ParameterSet, drawn
from zerorev.cell.plant import run
from zerorev.model.recording import Recording
from zerorev.program.sweeps import AMPLITUDE, Sweeps

NOISE = float(np.deg2rad(1e-4))
TORQUE_NOISE = 0.01  # of the greatest torque
ACCELERATION = 5.0  # [rad/s^2] of a joint
REST = 0.5
NOMINAL = {"position_gain": 0.12, "reset": 5.0, "forward": 1.0, "friction_forward": 0.0, "drive_inertia": 1.0}


def known_arm(seed: int, **values: float) -> ParameterSet:
    """A set of all parameters; of the controller only its bandwidth differs from the nominal one."""
    return ParameterSet(dict(drawn(1, seed)[0].values) | NOMINAL | values)


def moved(start: float, end: float, speed: float) -> np.ndarray:
    """Angles at nodes of a move with even ramps, without its first."""
    length, sign = abs(end - start), np.sign(end - start)
    speed = min(speed, np.sqrt(length * ACCELERATION))
    ramp = speed / ACCELERATION
    whole = length / speed + ramp
    t = np.minimum(np.arange(1, int(np.ceil(whole / STEP)) + 1) * STEP, whole)
    up, down = np.minimum(t, ramp), np.maximum(t - (whole - ramp), 0.0)
    even = np.clip(t - ramp, 0.0, whole - 2 * ramp)
    return start + sign * (ACCELERATION * up**2 / 2 + speed * even + speed * down - ACCELERATION * down**2 / 2)


def swept(sweeps: Sweeps) -> Followed:
    """The reference of all sweeps, one after the other."""
    posture, parts = sweeps.posture, []
    for sweep in sweeps.sweeps:
        middle = posture[sweep.joint]
        angles = [np.full(round(REST / STEP), middle)]
        for _ in range(sweep.cycles):
            for side in (1, -1):
                angles.append(moved(angles[-1][-1], middle + side * AMPLITUDE, sweep.speed))
        angles.append(moved(angles[-1][-1], middle, sweep.speed))
        own = np.concatenate(angles)
        part = np.repeat(posture[None], len(own), axis=0)
        part[:, sweep.joint] = own
        parts.append(part)
    q = np.concatenate(parts)
    qd = np.gradient(q, STEP, axis=0)
    nothing = np.zeros(len(q))
    return Followed(sweeps.drilling, nothing, nothing, q, qd, np.gradient(qd, STEP, axis=0), 1.0)


def recorded(
    reference: Followed, arm: ParameterSet, *, every: int = 12, seed: int | None = 0, source: str = "made up"
) -> Recording:
    """What a controller would log of a run, one sample every so many milliseconds; without a seed no noise."""
    done = run(reference, arm)
    joints, torque = (reference.q + done.rotor)[::every], done.drive[::every]
    if seed is not None:
        chance = np.random.default_rng(seed)
        limit = reference.drilling.robot.dynamics.effort_limit
        joints = joints + NOISE * chance.standard_normal(joints.shape)
        torque = torque + TORQUE_NOISE * limit * chance.standard_normal(torque.shape)
    time = np.arange(len(joints)) * every * STEP
    return Recording(time, joints, reference.q[::every].copy(), torque, source=source)
