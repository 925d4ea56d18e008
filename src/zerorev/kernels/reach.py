"""How far a leg runs before a joint stops: the deepest stroke with no reversal (theory §4).

At one spin at the target the two legs are independent: the deepest stroke there is the lesser of how far the best slope
above the critical rates runs, and the best slope below them. Lengths in m, angles in rad, rates outwards in rad/m;
controller angles. No kernel raises.
"""

from __future__ import annotations

import numpy as np

from zerorev.kernels._jit import kernel
from zerorev.kernels.arm import controller_angles, flip_sign, twist_field
from zerorev.kernels.legs import GOLDEN, NIL
from zerorev.kernels.pairs import take_turns, turn_choices

SLOPES = 24  # tried on each side, in geometric steps away from the critical rates
LEAST_STEP_AWAY = 2e-4  # of the steepest slope: the first of them
GOLDEN_STEPS = 24
BISECTIONS = 40
# columns of what a search returns
DEPTH, SLOPE_ABOVE, SLOPE_BELOW = range(3)


@kernel
def leg_reach(arm, plane, branch, psi_t, slope, sense, at_target, sought, step):  # type: ignore[no-untyped-def]
    """How far a leg runs outwards before a joint stops, a limit is met or the pose is out of reach.

    Args:
        arm: `ArmGeometry`.
        plane: `TwistPlane`.
        branch: 0..7.
        psi_t: spin at the target [rad].
        slope: twist rate u [rad/m].
        sense: wanted sign of each joint's outward rate, shape (6,).
        at_target: joint angles at the target with their turns, shape (6,).
        sought: `Sought`.
        step: distance of the points looked at [m]; the end is bisected between two of them.

    Returns:
        the length [m], 0 where the leg does not even set out, at most `sought.longest`.
    """
    cs = np.empty((6, 2))
    theta_s, theta_psi = np.empty(6), np.empty(6)
    rate, before, earlier = np.zeros(6), np.zeros(6), np.zeros(6)
    angle, trial = at_target.copy(), np.empty(6)
    five = flip_sign(arm, branch)
    # as far as the bound on the spin lets it run
    longest = sought.longest
    if slope != 0.0:
        longest = min(longest, sought.longest_twist / abs(slope))
    if sought.psi_bound > 0.0 and slope != 0.0:
        room = (sought.psi_bound - psi_t) if slope > 0.0 else (sought.psi_bound + psi_t)
        longest = min(longest, max(0.0, room / abs(slope)))
    good, bad = 0.0, -1.0  # the farthest place known to do, and the nearest known not to
    within = True  # whether a limit may lie between the two: not where a joint nearly stopped before a point that does
    n = 0
    while good < longest:
        s = min(n * step, longest)
        if not _runs(arm, plane, branch, five, psi_t, slope, s, sense, sought, cs, theta_s, theta_psi, rate):
            if n == 0:
                return 0.0
            bad = s
            break
        # a joint that nearly stops between two points: the parabola through three of them tells where
        if n > 1 and s == n * step:
            for i in range(6):
                a, b, c = sense[i] * earlier[i], sense[i] * before[i], sense[i] * rate[i]
                bend = c - 2.0 * b + a
                if b < a and b < c and b - (c - a) ** 2 / (8.0 * bend) < sought.min_rate:
                    low = good + step * 0.5 * (a - c) / bend
                    if bad < 0.0 or low < bad:
                        bad = low
            if bad >= 0.0:
                if bad <= good:
                    good, within = good - step, False
                break
        if n > 0:
            for i in range(6):
                trial[i] = angle[i] + 0.5 * (s - good) * (before[i] + rate[i])
                if not (sought.lower[i] <= trial[i] <= sought.upper[i]):
                    bad = s
            if bad >= 0.0:
                break
            angle[:] = trial
        earlier[:] = before
        before[:] = rate
        good = s
        n += 1
    if bad < 0.0:
        return good
    base = good
    for _ in range(BISECTIONS):
        if bad - good < 1e-9:
            break
        middle = 0.5 * (good + bad)
        runs = _runs(arm, plane, branch, five, psi_t, slope, middle, sense, sought, cs, theta_s, theta_psi, rate)
        if runs and within:
            for i in range(6):
                there = angle[i] + 0.5 * (middle - base) * (before[i] + rate[i])
                runs = runs and sought.lower[i] <= there <= sought.upper[i]
        if runs:
            good = middle
        else:
            bad = middle
    return good


@kernel
def _runs(arm, plane, branch, five, psi_t, slope, s, sense, sought, cs, theta_s, theta_psi, rate):  # type: ignore[no-untyped-def]
    """Whether the pose is in reach and every joint moves the wanted way there; its rates are written to `rate`."""
    if not twist_field(arm, plane, s, psi_t + slope * s, branch // 2, cs, theta_s, theta_psi):
        return False
    for i in range(6):
        rate[i] = theta_s[i] + slope * theta_psi[i]
        if i == 4:
            rate[i] *= five
        # a joint that does not move at all does not reverse either; NaN fails both
        if not (sense[i] * rate[i] > sought.min_rate or abs(rate[i]) <= NIL):
            return False
    return True


@kernel
def deepest_pair(arm, plane, branch, psi_t, sought, step, refine, out):  # type: ignore[no-untyped-def]
    """The deepest stroke out of one point of the target line, and the slopes of its two legs.

    Args:
        arm: `ArmGeometry`.
        plane: `TwistPlane`.
        branch: 0..7.
        psi_t: spin at the target [rad].
        sought: `Sought`.
        step: distance of the points looked at [m].
        refine: whether the best slope is closed in on, or taken from those tried.
        out: out, shape (3,): depth [m], slope above, slope below [rad/m].
    """
    cs = np.empty((6, 2))
    theta_s, theta_psi = np.empty(6), np.empty(6)
    sense, principal, at_target = np.empty(6), np.empty(6), np.empty(6)
    out[:] = 0.0
    if not twist_field(arm, plane, 0.0, psi_t, branch // 2, cs, theta_s, theta_psi) or np.isnan(theta_psi[0]):
        return
    controller_angles(arm, cs, branch % 2 == 1, principal)
    five = flip_sign(arm, branch)
    highest, lowest = -np.inf, np.inf
    for i in range(6):
        if abs(theta_psi[i]) <= 1e-12:
            if abs(theta_s[i]) > NIL:
                return  # the spin does not move this joint, so nothing keeps it from reversing
            sense[i] = 1.0
            continue
        sense[i] = 1.0 if theta_psi[i] > 0.0 else -1.0
        highest = max(highest, -theta_s[i] / theta_psi[i])
        lowest = min(lowest, -theta_s[i] / theta_psi[i])
    sense[4] *= five
    for choice in range(turn_choices(principal, sought)):
        take_turns(principal, sought, choice, at_target)
        above, far = _farthest(arm, plane, branch, psi_t, highest, 1.0, sense, at_target, sought, step, refine)
        if far <= out[DEPTH]:
            continue
        below, other = _farthest(arm, plane, branch, psi_t, lowest, -1.0, -sense, at_target, sought, step, refine)
        if min(far, other) > out[DEPTH]:
            out[DEPTH], out[SLOPE_ABOVE], out[SLOPE_BELOW] = min(far, other), above, below


@kernel
def _farthest(arm, plane, branch, psi_t, edge, side, sense, at_target, sought, step, refine):  # type: ignore[no-untyped-def]
    """The slope on one side of the critical rates whose leg runs farthest, and how far."""
    slopes = np.empty(SLOPES)
    span = max(sought.steepest - side * edge, 0.0)
    best, far = 0, -1.0
    for j in range(SLOPES):
        slopes[j] = edge + side * span * LEAST_STEP_AWAY ** (1.0 - j / (SLOPES - 1.0))
        reach = leg_reach(arm, plane, branch, psi_t, slopes[j], sense, at_target, sought, step)
        if reach > far:
            best, far = j, reach
    slope = slopes[best]
    if not refine or far <= 0.0:
        return slope, far
    a = edge if best == 0 else slopes[best - 1]
    b = slopes[min(best + 1, SLOPES - 1)]
    x, y = b - GOLDEN * (b - a), a + GOLDEN * (b - a)
    at_x = leg_reach(arm, plane, branch, psi_t, x, sense, at_target, sought, step)
    at_y = leg_reach(arm, plane, branch, psi_t, y, sense, at_target, sought, step)
    for _ in range(GOLDEN_STEPS):
        if at_x >= at_y:
            if at_x > far:
                slope, far = x, at_x
            b, y, at_y = y, x, at_x
            x = b - GOLDEN * (b - a)
            at_x = leg_reach(arm, plane, branch, psi_t, x, sense, at_target, sought, step)
        else:
            if at_y > far:
                slope, far = y, at_y
            a, x, at_x = x, y, at_y
            y = a + GOLDEN * (b - a)
            at_y = leg_reach(arm, plane, branch, psi_t, y, sense, at_target, sought, step)
    return slope, far


@kernel
def scan_depth(arm, plane, psi, sought, step, branches, out):  # type: ignore[no-untyped-def]
    """Deepest stroke along the target line from the slopes tried, without closing in.

    Args:
        arm: `ArmGeometry`.
        plane: `TwistPlane`.
        psi: spins at the target [rad], shape (K,).
        sought: `Sought`.
        step: distance of the points looked at [m].
        branches: whether to look at a branch, shape (8,).
        out: out, shape (8, K): depth [m].
    """
    pair = np.empty(3)
    for branch in range(8):
        for n in range(psi.shape[0]):
            out[branch, n] = 0.0
            if branches[branch]:
                deepest_pair(arm, plane, branch, psi[n], sought, step, False, pair)
                out[branch, n] = pair[DEPTH]
