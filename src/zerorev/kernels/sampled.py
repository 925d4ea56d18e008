"""Motions judged on samples as the thesis does it (sec. 4.2, 4.3): reversals, travel, jumps, limits of all branches.

No angle is needed to tell which way a joint steps, nor that it jumps: cosines and sines say so. Between two points
where it turns round a joint's travel is the difference of two angles, and its extents are among those points, so
inverse trigonometry is for those alone. Both wrist flips of a posture make the same steps, but for the sign of joint
5's: they differ in limits alone.

Lengths in m, angles in rad.
"""

from __future__ import annotations

import numpy as np

from zerorev.kernels._jit import kernel
from zerorev.kernels.arm import flip_sign, solve_at

STILL = 1e-12  # [rad] a step that is none
JUMP = 0.5  # [rad] a step that no drilling motion makes: B_jump
COS_JUMP = float(np.cos(JUMP))
FULL = 2.0 * np.pi
LIMIT_SLACK = 1e-12  # of a turn

# Where the turn begins in which the thesis takes the angles of the first point. That of joint 6 it does not say but
# show: Appendix B begins at A6 = 217 and 237 deg, and only so psi = [-1, 0, 1] runs and [1, 0, -1] does not (sec. 4.7).
FIRST_FROM = (-np.pi, -np.pi, -np.pi, -np.pi, -np.pi, 0.0)

# rows of what is known of a path, per joint
START, LOW, HIGH, DIRECTION, TURNED, CORNER, LAST, WINDING, MOVED, SLOW = range(10)
ROWS = 10


@kernel
def judge(arm, plane, depth, fractions, least, lower, upper, first_point, weights, spins, costs, reversals):  # type: ignore[no-untyped-def]
    """Thesis eq. 4.7 of many motions on all eight branches.

    Args:
        arm: `ArmGeometry`.
        plane: `TwistPlane`.
        depth: stroke [m].
        fractions: samples of a leg, from 0 at the target to 1 at its outer end, shape (L + 1,).
        least: of a joint that does not reverse: sine of its least step between two samples, outermost first, then its
            least step on a whole leg [rad], shape (L + 1,); 0 where it may rest.
        lower: least controller angles [rad], shape (6,).
        upper: greatest controller angles [rad], shape (6,).
        first_point: whether each joint has the turn in which its first angle lies within a turn from FIRST_FROM on;
            else any turn that fits its extents.
        weights: cost of one reversal, and of one radian of travel.
        spins: psi_s, psi_t and psi_e [rad], shape (M, 3).
        costs: out, shape (M, 8): eq. 4.7; 1 where a pose is out of reach.
        reversals: out, shape (M, 8): -1 where the motion cannot be run.
    """
    cs, before, path = np.empty((6, 2)), np.empty((6, 2)), np.empty((ROWS, 6))
    for m in range(spins.shape[0]):
        for posture in range(4):
            count, travel, jump = follow(arm, plane, depth, fractions, least, spins[m], posture, cs, before, path)
            cost, slow = weights[0] * count + weights[1] * travel, False
            for i in range(6):
                slow |= path[TURNED, i] == 0.0 and path[SLOW, i] > 0.0
            for flip in range(2):
                branch = 2 * posture + flip
                if count < 0:
                    costs[m, branch], reversals[m, branch] = 1.0, -1
                    continue
                beyond = not within(arm, path, branch, lower, upper, first_point)
                costs[m, branch] = cost + jump + slow + beyond
                reversals[m, branch] = -1 if jump or slow or beyond else count


@kernel
def follow(arm, plane, depth, fractions, least, spins, posture, cs, before, path):  # type: ignore[no-untyped-def]
    """The joints of one posture along one motion, as model angles with sin(q5) >= 0.

    Args:
        arm: `ArmGeometry`.
        plane: `TwistPlane`.
        depth: stroke [m].
        fractions: see `judge`.
        least: see `judge`.
        spins: psi_s, psi_t and psi_e [rad], shape (3,).
        posture: 0..3.
        cs: room, shape (6, 2).
        before: room, shape (6, 2).
        path: out, shape (ROWS, 6): angle at START, LOW and HIGH [rad], reversals in TURNED, whether SLOW somewhere.

    Returns:
        number of reversals, or -1 where a pose is out of reach; travel [rad]; whether a joint jumps.
    """
    legs = fractions.size - 1
    jump = False
    path[:] = 0.0
    for n in range(2 * legs + 1):
        x = fractions[abs(n - legs)]
        outer = spins[0] if n < legs else spins[2]
        if not solve_at(arm, plane, x * depth, spins[1] + x * (outer - spins[1]), posture, cs)[0]:
            return -1, 0.0, False
        for i in range(6):
            c, s = cs[i, 0], cs[i, 1] + 0.0  # no negative zero: the angle lies in (-pi, pi]
            if n == 0:
                path[START, i] = path[LAST, i] = path[LOW, i] = path[HIGH, i] = np.arctan2(s, c)
            else:
                c0, s0 = before[i, 0], before[i, 1]
                step, ahead = s * c0 - c * s0, c * c0 + s * s0  # its sine and cosine
                jump |= ahead < COS_JUMP
                if abs(step) < least[min(n - 1, 2 * legs - n)] and ahead > 0.0:
                    path[SLOW, i] = 1.0
                if abs(step) > STILL:
                    if step * path[DIRECTION, i] < 0.0:
                        path[TURNED, i] += 1.0
                        _arrive(path, i, c0, s0)
                    path[DIRECTION, i] = step
                if step > 0.0 and s0 >= 0.0 and s < 0.0:
                    path[WINDING, i] += 1.0
                elif step < 0.0 and s0 < 0.0 and s >= 0.0:
                    path[WINDING, i] -= 1.0
            before[i, 0], before[i, 1] = c, s
            if n == legs:
                path[CORNER, i] = np.arctan2(s, c) + FULL * path[WINDING, i]
    count, travel = 0, 0.0
    for i in range(6):
        _arrive(path, i, before[i, 0], before[i, 1])
        count += int(path[TURNED, i])
        travel += path[MOVED, i]
        legs_moved = abs(path[CORNER, i] - path[START, i]), abs(path[LAST, i] - path[CORNER, i])
        if min(legs_moved) < least[legs]:
            path[SLOW, i] = 1.0
    return count, travel, jump


@kernel
def _arrive(path, i, c, s):  # type: ignore[no-untyped-def]
    """Joint i, having gone one way since the last such point, is now at the angle of this cosine and sine."""
    angle = np.arctan2(s, c) + FULL * path[WINDING, i]
    path[MOVED, i] += abs(angle - path[LAST, i])
    path[LAST, i] = angle
    path[LOW, i], path[HIGH, i] = min(path[LOW, i], angle), max(path[HIGH, i], angle)


@kernel
def within(arm, path, branch, lower, upper, first_point):  # type: ignore[no-untyped-def]
    """Whether the turns bring every joint within its limits all along a path.

    Args:
        arm: `ArmGeometry`.
        path: of `follow`.
        branch: 0..7; its wrist flip says which of both is meant.
        lower: see `judge`.
        upper: see `judge`.
        first_point: see `judge`.
    """
    flipped = flip_sign(arm, branch) < 0.0
    for i in range(6):
        start, low, high = path[START, i], path[LOW, i], path[HIGH, i]
        sign, offset = arm.sign[i], arm.offset[i]
        if flipped and i == 4:
            start, low, high = -start, -high, -low
        elif flipped and i > 2:
            offset += np.pi
        start = (start + offset) * sign
        low, high = (low + offset) * sign, (high + offset) * sign
        if sign < 0.0:
            low, high = high, low
        if first_point:
            turn = -np.floor((start - FIRST_FROM[i]) / FULL)
            fits = (low - lower[i]) / FULL + turn >= -LIMIT_SLACK and (high - upper[i]) / FULL + turn <= LIMIT_SLACK
        else:
            fits = np.ceil((lower[i] - low) / FULL - LIMIT_SLACK) <= np.floor((upper[i] - high) / FULL + LIMIT_SLACK)
        if not fits:
            return False
    return True
