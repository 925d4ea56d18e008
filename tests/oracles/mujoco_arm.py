"""The KR 6 with drives and elastic gears as MuJoCo has it, from KUKA's own description; nothing of ours but parameters.

Rotors are six bodies that turn freely; a gear is a fixed tendon between rotor and joint, of which the dead band of its
spring is the gap. Friction and control are applied as forces, step by step.
"""

from __future__ import annotations

import json
from pathlib import Path

import mujoco
import numpy as np

__all__ = ["followed_by_mujoco"]

DESCRIPTION = Path(__file__).parents[1] / "data/dynamics/kuka_kr6_r700_2.json"
NEXT_TO_NOTHING = 1e-9  # [kg m^2] a body must have some inertia


def followed_by_mujoco(reference, arm, load, rest, dt):
    """Rotor and link less reference at the nodes [rad], each (N, 6), as `kernels.plant.follow` has them.

    Args:
        reference: of the kernel: `step`, `q`, `qd`, `qdd`, `torque`.
        arm: of the kernel, with a gap.
        load: mass [kg] and place of a point mass in the flange frame [m].
        rest: time at the first node [s].
        dt: time step [s].
    """
    model = mujoco.MjModel.from_xml_string(_xml(arm, load, dt))
    data = mujoco.MjData(model)
    data.qpos[:6] = reference.q[0]
    data.qpos[6:] = reference.q[0] - _give(reference, arm)
    mujoco.mj_forward(model, data)
    least = reference.inertia
    damping = 2 * arm.damping * np.sqrt(arm.stiffness * np.minimum(arm.drive, least))
    integral, zm, zl = np.zeros((3, 6))
    Kv, Kp, Ti = arm.bandwidth * arm.drive, arm.position * arm.bandwidth, arm.reset / arm.bandwidth
    inner, N, asked = round(reference.step / dt), len(reference.q), reference.q[0].copy()
    rotor, link = np.empty((2, N, 6))
    for step in range(-round(rest / dt), (N - 1) * inner):
        n, m = divmod(step, inner)
        if step >= 0 and m == 0:
            rotor[n], link[n] = data.qpos[:6] - asked, data.qpos[6:] - asked
        share, at = ((m + 1) / inner, n) if step >= 0 else (0.0, 0)

        def between(values, share=share, at=at):
            return values[at] + share * (values[at + 1] - values[at])

        speed, gain = (np.zeros(6), np.zeros(6)) if step < 0 else (between(reference.qd), between(reference.qdd))
        # speeds as they would be at the end of the step if nothing but the reference changed
        th, thd, qd = data.qpos[:6], data.qvel[:6] + dt * gain, data.qvel[6:] + dt * gain
        e = Kp * (asked - th) + speed - thd
        u = Kv * (e + integral) + arm.forward * (between(reference.torque) + arm.drive * gain)
        u += arm.friction_forward * (arm.coulomb * np.tanh(speed / 1e-3) + arm.viscous * speed)
        integral += np.where(np.abs(u) < arm.limit, dt * e / Ti, 0.0)
        u = np.clip(u, -arm.limit, arm.limit)
        zm, zl = _bristle(zm, thd, arm, dt), _bristle(zl, qd, arm, dt)
        d, rate = th - data.qpos[6:], thd - qd
        spring = np.where(np.abs(d) > arm.gap / 2, arm.stiffness * (d - np.sign(d) * arm.gap / 2), 0.0)
        gear = np.where(spring > 0, np.maximum(spring + damping * rate, 0), np.minimum(spring + damping * rate, 0))
        damped = np.where(spring == 0, 0.0, gear - spring)
        data.qfrc_applied[:6] = u - (1 - arm.behind) * (arm.coulomb * zm + arm.viscous * thd) - damped
        data.qfrc_applied[6:] = damped - arm.behind * (arm.coulomb * zl + arm.viscous * qd)
        mujoco.mj_step(model, data)
        asked = asked + dt * speed  # as MuJoCo advances places, so that what is compared is not half a step apart
    rotor[-1], link[-1] = data.qpos[:6] - asked, data.qpos[6:] - asked
    return rotor, link


def _give(reference, arm):
    load = reference.torque[0]
    return load / arm.stiffness + np.sign(load) * arm.gap / 2


def _bristle(z, speed, arm, dt):
    peak = 1 + (arm.breakaway - 1) * np.exp(-((speed / arm.stribeck) ** 2))
    return (z + dt * speed / arm.presliding) / (1 + dt * np.abs(speed) / (arm.presliding * peak))


def _xml(arm, load, dt):
    stated = json.loads(DESCRIPTION.read_text(encoding="utf-8"))
    opened, closed = "", ""
    for k, (joint, link) in enumerate(zip(stated["joints"], stated["links"], strict=True)):
        quat = _quat(joint["origin_rpy_rad"])
        inertial = (
            f'<inertial pos="{_text(link["com_m"])}" quat="{_text(_quat(link["inertia_frame_rpy_rad"]))}"'
            f' mass="{link["mass_kg"]}" diaginertia="{_text(link["principal_inertia_kgm2"])}"/>'
        )
        opened += f'<body pos="{_text(joint["origin_xyz_m"])}" quat="{_text(quat)}"><joint name="q{k}" axis="0 0 1"/>'
        opened += inertial
        closed += "</body>"
    flange = stated["tool0"]
    opened += (
        f'<body pos="{_text(flange["origin_xyz_m"])}" quat="{_text(_quat(flange["origin_rpy_rad"]))}"><inertial'
        f' pos="{_text(load[1])}" mass="{load[0]}" diaginertia="{_text([NEXT_TO_NOTHING] * 3)}"/></body>'
    )
    rotors = "".join(
        f'<body><joint name="r{k}" axis="0 0 1"/><inertial pos="0 0 0" mass="1" diaginertia="{_text([J] * 3)}"/></body>'
        for k, J in enumerate(arm.drive)
    )
    gears = "".join(
        f'<fixed stiffness="{float(k)!r}" springlength="{float(-b / 2)!r} {float(b / 2)!r}">'
        f'<joint joint="r{n}" coef="1"/><joint joint="q{n}" coef="-1"/></fixed>'
        for n, (k, b) in enumerate(zip(arm.stiffness, arm.gap, strict=True))
    )
    return (
        f'<mujoco><compiler angle="radian" boundinertia="0"/><option timestep="{dt!r}" gravity="0 0 -9.81"'
        f' integrator="Euler"/><worldbody>{rotors}{opened}{closed}</worldbody><tendon>{gears}</tendon></mujoco>'
    )


def _quat(rpy):
    r, p, y = (angle / 2 for angle in rpy)
    cr, sr, cp, sp, cy, sy = np.cos(r), np.sin(r), np.cos(p), np.sin(p), np.cos(y), np.sin(y)
    w, x = cr * cp * cy + sr * sp * sy, sr * cp * cy - cr * sp * sy
    return [w, x, cr * sp * cy + sr * cp * sy, cr * cp * sy - sr * sp * cy]


def _text(values):
    return " ".join(repr(float(value)) for value in values)
