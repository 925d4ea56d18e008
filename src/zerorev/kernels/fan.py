"""Fans: the legs out of every spin of a grid, followed once, and all pairs of them (theory §3).

A fan answers which pair of legs, with any reversals, has the fewest reversals.

Lengths in m, angles in rad, rates outwards in rad/m; controller angles. No kernel raises.
`constraints` is a `layout.Constraints`, `fan` a `zerorev.search.survey.Fan` throughout.
"""

from __future__ import annotations

import numpy as np

from zerorev.kernels._jit import kernel
from zerorev.kernels.arm import controller_angles, twist_field
from zerorev.kernels.field import ROOM
from zerorev.kernels.leg_search import GEOMETRIC_SLOPES, SLOPES_BETWEEN
from zerorev.kernels.legs import (
    END_ANGLE,
    GREATEST_MARGIN,
    GREATEST_RATE,
    LEAST_RATE,
    NIL,
    PLUNGE_ROTATION,
    TARGET_RATE,
    TURNS,
    joint_travel,
    trace_leg,
)
from zerorev.kernels.order import order_of
from zerorev.kernels.pairs import turns_fit

EVEN_SLOPES = 48
MAX_FAN = 7 + 2 * GEOMETRIC_SLOPES + 6 * SLOPES_BETWEEN + EVEN_SLOPES


@kernel
def fan_slopes(kappa, psi_t, constraints, out, critical):  # type: ignore[no-untyped-def]
    """Slopes of the legs that are followed out of one point of the target line, for any joints to be kept.

    Args:
        kappa: critical rates at the target [rad/m], shape (6,).
        psi_t: spin at the target [rad].
        constraints: `Constraints`, for the steepest slope and the bound on the spin.
        out: out, shape (MAX_FAN,): rising slopes.
        critical: out, shape (MAX_FAN,): whether a slope is a critical rate.

    Returns:
        how many slopes were written.
    """
    low, high = -constraints.steepest, constraints.steepest
    if constraints.psi_bound > 0.0:
        low = max(low, (-constraints.psi_bound - psi_t) / constraints.depth)
        high = min(high, (constraints.psi_bound - psi_t) / constraints.depth)
    anchors = np.empty(6)
    pieces = 0
    for i in range(6):
        if low < kappa[i] < high:
            anchors[pieces] = kappa[i]
            pieces += 1
    count = 0
    if pieces == 0:
        anchors[0] = min(max(0.0, low), high)
        pieces = 1
    anchors = anchors[order_of(anchors[:pieces])]
    marked = np.zeros(MAX_FAN)
    for p in range(pieces):
        out[count], marked[count] = anchors[p], 1.0
        count += 1
        if p < pieces - 1:
            for j in range(SLOPES_BETWEEN):
                out[count] = anchors[p] + (anchors[p + 1] - anchors[p]) * (j + 0.5) / SLOPES_BETWEEN
                count += 1
    for j in range(GEOMETRIC_SLOPES):
        share = 1e-4 ** (1.0 - j / (GEOMETRIC_SLOPES - 1.0))
        out[count] = anchors[0] - (anchors[0] - low) * share
        out[count + 1] = anchors[pieces - 1] + (high - anchors[pieces - 1]) * share
        count += 2
    for j in range(EVEN_SLOPES):
        out[count] = low + (high - low) * (j + 0.5) / EVEN_SLOPES
        count += 1
    if low < 0.0 < high:  # the spin held
        out[count] = 0.0
        count += 1
    order = order_of(out[:count])
    out[:count] = out[:count][order]
    for j in range(count):
        critical[j] = marked[order[j]] > 0.0
    return count


@kernel
def follow(arm, plane, psi, constraints, nodes, branches, fan):  # type: ignore[no-untyped-def]
    """Follow a fan of legs out of every spin of a grid, once for both wrist flips of a posture and for any `keep`.

    Args:
        arm: `ArmGeometry`.
        plane: `TwistPlane`.
        psi: spins at the target [rad], shape (K,).
        constraints: `Constraints`.
        nodes: points on a leg.
        branches: whether to examine a branch, shape (8,).
        fan: out, `Fan`.
    """
    cs = np.empty((6, 2))
    theta_s, theta_psi, principal, kappa = np.empty(6), np.empty(6), np.empty(6), np.empty(6)
    work = np.empty(ROOM)
    fan.counts[:] = 0
    fan.fits[:] = False
    for posture in range(4):
        if not (branches[2 * posture] or branches[2 * posture + 1]):
            continue
        for n in range(psi.shape[0]):
            if not twist_field(arm, plane, 0.0, psi[n], posture, cs, theta_s, theta_psi) or np.isnan(theta_psi[0]):
                continue
            slopes = fan.slopes[posture, n]
            for i in range(6):
                kappa[i] = -theta_s[i] / theta_psi[i]
            count = fan_slopes(kappa, psi[n], constraints, slopes, fan.critical[posture, n])
            fan.counts[posture, n] = count
            for j in range(count):
                leg = fan.legs[posture, n, j]
                if not trace_leg(arm, plane, 2 * posture, psi[n], slopes[j], constraints.depth, nodes, work, leg):
                    continue
                for flip in range(2):
                    if branches[2 * posture + flip]:
                        controller_angles(arm, cs, flip == 1, principal)
                        fan.fits[posture, n, j, flip] = turns_fit(leg, leg, flip == 1, principal, constraints)


@kernel
def judge_pair(a, b, slope_a, slope_b, weights, constraints, mode):  # type: ignore[no-untyped-def]
    """What two legs out of the same point are worth together, limits aside: each figure the less the better.

    Args:
        a: a leg from `trace_leg`, shape (ROWS, 6); b the other.
        b: see a.
        slope_a: twist rates [rad/m]; slope_b the other.
        slope_b: see slope_a.
        weights: what a reversal of each joint costs, shape (6,).
        constraints: `Constraints`.
        mode: TRAVEL, GREATEST_MARGIN or PLUNGE_ROTATION.

    Returns:
        cost: weighted count of reversals.
        lack: by how much the slowest joint that does not reverse is below the threshold [rad/m].
        value: what is to be least.
    """
    cost, margin, travel = 0.0, np.inf, 0.0
    for i in range(6):
        turns = a[TURNS, i] + b[TURNS, i]
        at_a, at_b = a[TARGET_RATE, i], b[TARGET_RATE, i]
        if abs(at_a) > NIL and abs(at_b) > NIL and at_a * at_b > 0.0:
            turns += 1.0
        cost += weights[i] * turns
        travel += joint_travel(a, i) + joint_travel(b, i)
        moves = False
        slowest = np.inf
        for k in range(2):
            leg = a if k == 0 else b
            if leg[LEAST_RATE, i] < -NIL or leg[GREATEST_RATE, i] > NIL:
                moves = True
                if constraints.mean_rule:
                    slowest = min(slowest, abs(leg[END_ANGLE, i]) / constraints.depth)
                else:
                    slowest = min(slowest, max(leg[LEAST_RATE, i], -leg[GREATEST_RATE, i]))
        if turns == 0.0 and moves:
            margin = min(margin, slowest)
    lack = max(0.0, constraints.min_rate - margin)
    if mode == GREATEST_MARGIN:
        return cost, lack, -margin
    if mode == PLUNGE_ROTATION:
        return cost, lack, min(abs(slope_a), abs(slope_b)) * constraints.depth
    return cost, lack, travel


@kernel
def is_better(cost, lack, value, than):  # type: ignore[no-untyped-def]
    """Whether fewer reversals, else less lack of motion, else a lower value; `than` holds those three."""
    if abs(cost - than[0]) > 1e-9:
        return cost < than[0]
    if abs(lack - than[1]) > 1e-12:
        return lack < than[1]
    return value < than[2]


@kernel
def survey(arm, plane, psi, fan, weights, constraints, mode, branches, out):  # type: ignore[no-untyped-def]
    """The best pair of legs of the fan at every spin, with any reversals (theory §3).

    Args:
        arm: `ArmGeometry`.
        plane: `TwistPlane`.
        psi: spins at the target [rad], shape (K,).
        fan: `Fan`, from `follow` with slopes between the critical rates.
        weights: see `judge_pair`.
        constraints: `Constraints`.
        mode: see `judge_pair`.
        branches: whether to examine a branch, shape (8,).
        out: out, shape (8, K, 5): cost, lack and value of the best pair, inf where none can be run, and its slopes.
    """
    cs = np.empty((6, 2))
    theta_s, theta_psi, principal = np.empty(6), np.empty(6), np.empty((2, 6))
    inside = np.empty(MAX_FAN)
    out[:] = np.inf
    for posture in range(4):
        for n in range(psi.shape[0]):
            count = fan.counts[posture, n]
            if count == 0:
                continue
            twist_field(arm, plane, 0.0, psi[n], posture, cs, theta_s, theta_psi)
            controller_angles(arm, cs, False, principal[0])
            controller_angles(arm, cs, True, principal[1])
            legs, fits = fan.legs[posture, n], fan.fits[posture, n]
            for j in range(count):
                inside[j] = np.inf  # at a critical rate the count is a matter of rounding
                if not fan.critical[posture, n, j] and (fits[j, 0] or fits[j, 1]):
                    inside[j] = 0.0
                    for i in range(6):
                        inside[j] += weights[i] * legs[j, TURNS, i]
            for x in range(count):
                for y in range(x + 1):
                    least = inside[x] + inside[y]
                    if least == np.inf or least > max(out[2 * posture, n, 0], out[2 * posture + 1, n, 0]) + 1e-9:
                        continue
                    a, b = fan.slopes[posture, n, x], fan.slopes[posture, n, y]
                    cost, lack, value = judge_pair(legs[x], legs[y], a, b, weights, constraints, mode)
                    for flip in range(2):
                        best = out[2 * posture + flip, n]
                        if (
                            branches[2 * posture + flip] and fits[x, flip] and fits[y, flip]
                            and is_better(cost, lack, value, best)
                            and turns_fit(legs[x], legs[y], flip == 1, principal[flip], constraints)
                        ):  # fmt: skip
                            best[0], best[1], best[2], best[3], best[4] = cost, lack, value, a, b
