"""Single joints that are pulled over friction by a spring, with MuJoCo's own LuGre friction (actuator `dcmotor`)."""

from __future__ import annotations

import mujoco
import numpy as np

__all__ = ["pulled_by_mujoco"]

NO_MOTOR = 'motorconst="1e-9 1e-9" resistance="1"'  # of the actuator the friction alone is wanted


def pulled_by_mujoco(q, qd, qdd, step, arm, inertia, dt):
    """Links at the nodes of a reference that their rotors are controlled to [rad], shape (N, 6), and their speeds.

    Args:
        q: reference [rad], shape (N, 6).
        qd: [rad/s].
        qdd: [rad/s^2].
        step: between nodes [s].
        arm: `kernels.plant.Arm`, without a gap, with all friction behind the gear and nothing fed forward.
        inertia: of the links [kg m^2], shape (6,).
        dt: time step [s].
    """
    model = mujoco.MjModel.from_xml_string(_xml(arm, inertia, dt))
    data = mujoco.MjData(model)
    Kv, Kp, Ti = arm.bandwidth * arm.drive, arm.position * arm.bandwidth, arm.reset / arm.bandwidth
    integral, inner = np.zeros(6), round(step / dt)
    links, speeds = np.empty((2, *q.shape))
    for n in range(len(q) - 1):
        links[n], speeds[n] = data.qpos[6:], data.qvel[6:]
        for m in range(inner):
            share = m / inner
            asked = q[n] + share * (q[n + 1] - q[n])
            speed = qd[n] + share * (qd[n + 1] - qd[n])
            e = Kp * (asked - data.qpos[:6]) + speed - data.qvel[:6]
            data.qfrc_applied[:6] = Kv * (e + integral)
            integral += dt * e / Ti
            mujoco.mj_step(model, data)
    links[-1], speeds[-1] = data.qpos[6:], data.qvel[6:]
    return links, speeds


def _xml(arm, inertia, dt):
    def body(name, value):
        return (
            f'<body><joint name="{name}" axis="0 0 1"/>'
            f'<inertial pos="0 0 0" mass="1" diaginertia="{value} {value} {value}"/></body>'
        )

    bodies = "".join(body(f"r{n}", float(J)) for n, J in enumerate(arm.drive))
    bodies += "".join(body(f"q{n}", float(M)) for n, M in enumerate(inertia))
    springs, motors = "", ""
    for n in range(6):
        k, M = float(arm.stiffness[n]), float(inertia[n])
        c = float(2 * arm.damping * np.sqrt(k * min(float(arm.drive[n]), M)))
        springs += f'<fixed stiffness="{k!r}" damping="{c!r}" springlength="0 0"><joint joint="r{n}" coef="1"/>'
        springs += f'<joint joint="q{n}" coef="-1"/></fixed>'
        dry = float(arm.coulomb[n])
        bristles = f"{dry / arm.presliding!r} 0 {dry!r} {dry * arm.breakaway!r} {arm.stribeck!r}"
        motors += (
            f'<dcmotor joint="q{n}" input="none" {NO_MOTOR} damping="{float(arm.viscous[n])!r}" lugre="{bristles}"/>'
        )
    return (
        f'<mujoco><compiler angle="radian" boundinertia="0"/><option timestep="{dt!r}" gravity="0 0 0"'
        f' integrator="Euler"/><worldbody>{bodies}</worldbody><tendon>{springs}</tendon>'
        f"<actuator>{motors}</actuator></mujoco>"
    )
