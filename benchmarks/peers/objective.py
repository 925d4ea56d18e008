"""The thesis' objective (eq. 4.7) of many motions at once: one peer in Numba, one in plain NumPy.

    f = 6/7 * reversals / 6 + 1/7 * travel / (6 * 360 deg) + jump + limit + fault

counted on the steps between N samples, on each of the eight branches; the best branch counts. Turns are chosen after
the extents of the whole path are known. A path with a pose out of reach costs 1, whatever else it does.
"""

from __future__ import annotations

import numba
import numpy as np

from benchmarks.arm_numpy import inverse, wrapped
from benchmarks.cases import Answer, Case
from zerorev.kernels.arm import controller_angles, solve_posture
from zerorev.kinematics import tcp_pose, twist_plane
from zerorev.model._arrays import Array
from zerorev.model.profile import Profile

__all__ = ["STEPS", "NumbaObjective", "NumpyObjective", "Objective", "graded"]

STEPS = 200  # on the whole path (thesis sec. 4.2)
STILL = 1e-12  # [rad] a step that is none
JUMP = 0.5  # [rad] a step that no drilling motion makes
HALF_TURNS = np.array([0.0, 0.0, 0.0, np.pi, 0.0, np.pi])  # from one wrist flip to the other, but for A5


def graded(nearest: float = 1e-6) -> Array:
    """Samples of a leg that crowd at both of its ends, as fractions of it: where joints come to rest without notice.

    Evenly spread samples overlook a reversal in the first step next to the target, and a swarm settles there.
    """
    half = np.concatenate([[0.0], np.geomspace(nearest, 0.5, STEPS // 4)])
    return np.unique(np.concatenate([half, 1 - half]))


class Objective:
    """Eq. 4.7 of one hole. `evaluations` counts the motions looked at."""

    def __init__(self, case: Case, fractions: Array | None = None) -> None:
        self.case, self.evaluations = case, 0
        self.fractions = np.linspace(0.0, 1.0, STEPS // 2 + 1) if fractions is None else fractions

    def __call__(self, spins: Array) -> Array:
        """Cost of motions given by (psi_start, psi_target, psi_end) [rad], shape (P, 3); returns (P,)."""
        self.evaluations += len(spins)
        return np.asarray(self.costs(spins).min(axis=1))

    def answer(self, spins: Array) -> Answer:
        """One motion, shape (3,), on its best branch."""
        profile = Profile.straight(self.case.hole.depth, *spins.tolist())
        return Answer(profile, int(self.costs(spins[None])[0].argmin()))

    def reversals(self, answer: Answer) -> int:
        """Reversals of an answer, as the objective itself counts them; more than it has where it cannot be run."""
        return int(7 * self.costs(answer.profile.psi[None])[0, answer.branch])

    def costs(self, spins: Array) -> Array:
        """Cost on each branch, shape (P, 8)."""
        cost, low, high = self.postures(np.ascontiguousarray(spins, dtype=float))
        limits = self.case.robot.limits
        # the other wrist flip makes the same steps, but for the sign of A5's: it differs in limits alone
        flipped_low, flipped_high = low + HALF_TURNS, high + HALF_TURNS
        flipped_low[..., 4], flipped_high[..., 4] = -high[..., 4], -low[..., 4]
        low, high = np.stack([low, flipped_low], axis=2), np.stack([high, flipped_high], axis=2)
        first, last = np.ceil((limits.lower - low) / (2 * np.pi)), np.floor((limits.upper - high) / (2 * np.pi))
        return np.asarray((cost[..., None] + (first > last).any(axis=-1)).reshape(-1, 8))

    def postures(self, spins: Array) -> tuple[Array, Array, Array]:
        """Cost but for limits, shape (P, 4), and the joints' extents with A5 >= 0, each (P, 4, 6), NaN at a fault."""
        raise NotImplementedError


class NumpyObjective(Objective):
    """Vectorised over motions, samples and branches, inverse kinematics included."""

    def postures(self, spins: Array) -> tuple[Array, Array, Array]:
        """Cost but for limits, and extents."""
        x = self.fractions
        start, target, end = (spins[:, i, None] for i in range(3))
        psi = np.concatenate([target + x[::-1] * (start - target), (target + x * (end - target))[:, 1:]], axis=1)
        standoff = self.case.hole.depth * np.concatenate([x[::-1], x[1:]])
        T = tcp_pose(self.case.hole, standoff, psi) @ np.linalg.inv(self.case.tool.T_flange_tcp)
        joints = inverse(self.case.robot.arm, T, (0, 2, 4, 6))  # (P, N, 4, 6)
        steps = wrapped(np.diff(joints, axis=1))
        path = np.concatenate([joints[:, :1], joints[:, :1] + np.cumsum(steps, axis=1)], axis=1)
        size = np.abs(steps)
        jump = (size > JUMP).any(axis=(1, 3))
        cost = _reversals(steps) / 7 + size.sum(axis=(1, 3)) / (84 * np.pi) + jump
        return np.where(np.isnan(cost), 1.0, cost), path.min(axis=1), path.max(axis=1)


def _reversals(steps: Array) -> Array:
    """Changes of sign along axis 1, zeros passed over, summed over the last; shape (P, N, K, 6) -> (P, K)."""
    signs = np.where(np.abs(steps) > STILL, np.sign(steps), 0.0)
    if (signs == 0).any():  # a joint that stands still keeps the direction it had
        place = np.arange(signs.shape[1])[None, :, None, None]
        last = np.maximum.accumulate(np.where(signs != 0, place, 0), axis=1)
        signs = np.take_along_axis(signs, last, axis=1)
    return np.asarray((signs[:, 1:] * signs[:, :-1] < 0).sum(axis=(1, 3)))


class NumbaObjective(Objective):
    """Compiled, one motion after the other, on the project's own kinematics."""

    def __init__(self, case: Case, fractions: Array | None = None) -> None:
        super().__init__(case, fractions)
        self.plane = twist_plane(case.robot, case.tool, case.hole)

    def postures(self, spins: Array) -> tuple[Array, Array, Array]:
        """Cost but for limits, and extents."""
        cost, extents = np.empty((len(spins), 4)), np.empty((2, len(spins), 4, 6))
        _postures(self.case.robot.arm, self.plane, self.case.hole.depth, self.fractions, spins, cost, *extents)
        return cost, extents[0], extents[1]


@numba.njit(nogil=True, error_model="numpy")
def _postures(arm, plane, depth, fractions, spins, out, lowest, highest):  # type: ignore[no-untyped-def]
    last = fractions.size - 1
    cs, joints, before, angle, direction = np.empty((6, 2)), np.empty(6), np.empty(6), np.empty(6), np.empty(6)
    for p in range(spins.shape[0]):
        for posture in range(4):
            low, high = lowest[p, posture], highest[p, posture]
            direction[:] = 0.0
            reversals, travel, jump = 0, 0.0, 0.0
            for n in range(2 * last + 1):
                x = fractions[abs(n - last)]
                outer = spins[p, 0] if n < last else spins[p, 2]
                psi = spins[p, 1] + x * (outer - spins[p, 1])
                if not _pose(arm, plane, x * depth, psi, posture, cs):
                    reversals = -1
                    break
                controller_angles(arm, cs, False, joints)
                for i in range(6):
                    if n == 0:
                        angle[i] = low[i] = high[i] = joints[i]
                    else:
                        step = joints[i] - before[i]
                        if step > np.pi:
                            step -= 2.0 * np.pi
                        elif step < -np.pi:
                            step += 2.0 * np.pi
                        travel += abs(step)
                        if abs(step) > JUMP:
                            jump = 1.0
                        if abs(step) > STILL:
                            if step * direction[i] < 0.0:
                                reversals += 1
                            direction[i] = step
                        angle[i] += step
                        low[i], high[i] = min(low[i], angle[i]), max(high[i], angle[i])
                    before[i] = joints[i]
            if reversals < 0:
                out[p, posture], low[:], high[:] = 1.0, np.nan, np.nan
            else:
                out[p, posture] = reversals / 7.0 + travel / (84.0 * np.pi) + jump


@numba.njit(nogil=True, error_model="numpy")
def _pose(arm, plane, standoff, psi, posture, cs):  # type: ignore[no-untyped-def]
    """Cosines and sines of the joints at one point of the twist plane; whether it is in reach."""
    c, s = np.cos(psi), np.sin(psi)
    x0, y0, zx, x1, y1, zy, x2, y2, zz = plane.R_base_tcp0
    a0, a1, a2 = c * x0 + s * y0, c * x1 + s * y1, c * x2 + s * y2
    b0, b1, b2 = c * y0 - s * x0, c * y1 - s * x1, c * y2 - s * x2
    f00, f01, f02, f10, f11, f12, f20, f21, f22 = plane.R_tcp_flange
    R = (
        a0 * f00 + b0 * f10 + zx * f20, a0 * f01 + b0 * f11 + zx * f21, a0 * f02 + b0 * f12 + zx * f22,
        a1 * f00 + b1 * f10 + zy * f20, a1 * f01 + b1 * f11 + zy * f21, a1 * f02 + b1 * f12 + zy * f22,
        a2 * f00 + b2 * f10 + zz * f20, a2 * f01 + b2 * f11 + zz * f21, a2 * f02 + b2 * f12 + zz * f22,
    )  # fmt: skip
    w0, w1, w2 = plane.wrist
    t0, t1, t2 = plane.target
    along = standoff + w2
    wx, wy, wz = (
        t0 + along * zx + a0 * w0 + b0 * w1, t1 + along * zy + a1 * w0 + b1 * w1, t2 + along * zz + a2 * w0 + b2 * w1,
    )  # fmt: skip
    return solve_posture(arm, R, wx, wy, wz, posture, cs)
