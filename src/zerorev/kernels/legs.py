"""Legs out of a target, followed and judged (theory §2, §3).

A leg is a straight line in the twist plane, from the target outwards: psi(s) = psi_t + u s. Joint i keeps its direction
through the target if and only if its outward rates on the two legs have opposite signs, so at a given psi_t one leg has
to lie above the critical rates of all joints that must not reverse, the other below them, and each can be looked for on
its own: along the one line of slopes u on its side (`kernels.leg_search`).

Lengths in m, angles in rad, rates outwards in rad/m; controller angles. No kernel raises.
`constraints` is a `layout.Constraints` throughout.
"""

from __future__ import annotations

import numpy as np

from zerorev.kernels._jit import kernel, lean
from zerorev.kernels.arm import controller_angles, flip_sign, twist_field
from zerorev.kernels.field import BLOCK, PSI, STANDOFF, THETA_PSI, THETA_S, fields

# rows of a traced leg, one column per joint
LEAST_RATE, GREATEST_RATE, LEAST_ANGLE, GREATEST_ANGLE, END_ANGLE, MOVED, TURNS, TARGET_RATE = range(8)
ROWS = 8
# what makes one leg better than another
TRAVEL, GREATEST_MARGIN, PLUNGE_ROTATION = range(3)

NIL = np.deg2rad(1e-6)  # [rad/m] 1e-9 deg/mm: below it a joint does not move


@kernel
def trace_leg(arm, plane, branch, psi_t, slope, depth, nodes, work, leg):  # type: ignore[no-untyped-def]
    """Follow a leg from the target outwards.

    Args:
        arm: `ArmGeometry`.
        plane: `TwistPlane`.
        branch: 0..7.
        psi_t: spin at the target [rad].
        slope: twist rate u [rad/m].
        depth: length of the leg [m].
        nodes: how many points are examined, both ends among them.
        work: room for `fields`.
        leg: out, shape (ROWS, 6): least and greatest outward rate; least and greatest angle, and the one at the outer
            end, relative to the target; angle moved; how often the joint turns round; outward rate at the target.

    Returns:
        whether all of the leg can be reached.
    """
    earlier, before, direction = np.zeros(6), np.zeros(6), np.zeros(6)
    five = flip_sign(arm, branch)
    step = depth / (nodes - 1)
    for start in range(0, nodes, BLOCK):
        count = min(BLOCK, nodes - start)
        place(psi_t, slope, step, start, count, work)
        fields(arm, plane, branch // 2, count, work)
        for k in range(count):
            n = start + k
            for i in range(6):
                rate = work[(THETA_S + i) * BLOCK + k] + slope * work[(THETA_PSI + i) * BLOCK + k]
                if i == 4:
                    rate *= five
                if np.isnan(rate):
                    return False
                _extend(leg, i, n, n == nodes - 1, step, rate, earlier[i], before[i])
                earlier[i], before[i] = before[i], rate
                if abs(rate) > NIL:
                    if rate * direction[i] < 0.0:
                        leg[TURNS, i] += 1.0
                    direction[i] = 1.0 if rate > 0.0 else -1.0
    # the outer end is known exactly up to whole turns, and the sum over the nodes knows those
    cs = np.empty((6, 2))
    theta_s, theta_psi, first, last = np.empty(6), np.empty(6), np.empty(6), np.empty(6)
    twist_field(arm, plane, 0.0, psi_t, branch // 2, cs, theta_s, theta_psi)
    controller_angles(arm, cs, branch % 2 == 1, first)
    if not twist_field(arm, plane, depth, psi_t + slope * depth, branch // 2, cs, theta_s, theta_psi):
        return False
    controller_angles(arm, cs, branch % 2 == 1, last)
    for i in range(6):
        exact = last[i] - first[i]
        exact += 2.0 * np.pi * np.rint((leg[END_ANGLE, i] - exact) / (2.0 * np.pi))
        leg[END_ANGLE, i] = exact
        leg[LEAST_ANGLE, i] = min(leg[LEAST_ANGLE, i], exact)
        leg[GREATEST_ANGLE, i] = max(leg[GREATEST_ANGLE, i], exact)
    return True


@lean
def place(psi_t, slope, step, start, count, work):  # type: ignore[no-untyped-def]
    """Points of a leg, from the one numbered `start` on, into the workspace."""
    for k in range(count):
        s = (start + k) * step
        work[STANDOFF * BLOCK + k] = s
        work[PSI * BLOCK + k] = psi_t + slope * s


@lean
def _extend(leg, i, n, is_last, step, rate, earlier, before):  # type: ignore[no-untyped-def]
    """Take the n-th point of a joint into a traced leg; the two points before it are known."""
    if n == 0:
        leg[LEAST_RATE, i] = leg[GREATEST_RATE, i] = rate
        leg[LEAST_ANGLE:, i] = 0.0
        leg[TARGET_RATE, i] = rate
        return
    leg[LEAST_RATE, i] = min(leg[LEAST_RATE, i], rate)
    leg[GREATEST_RATE, i] = max(leg[GREATEST_RATE, i], rate)
    tilt, bend = rate - earlier, rate - 2.0 * before + earlier
    reach = abs(bend)
    if (n == 2 and tilt * bend > 0.0) or (is_last and tilt * bend < 0.0):
        reach *= 2.0  # an end of the leg has no nodes on its other side
    if n > 1 and abs(tilt) < reach:
        # an extreme lies between the nodes: take it from the parabola through three of them
        extreme = before - tilt * tilt / (8.0 * bend)
        leg[LEAST_RATE, i] = min(leg[LEAST_RATE, i], extreme)
        leg[GREATEST_RATE, i] = max(leg[GREATEST_RATE, i], extreme)
        if extreme * before < 0.0 and rate * before > 0.0 and earlier * before > 0.0:
            leg[TURNS, i] += 2.0
    moved = 0.5 * step * (before + rate)
    leg[MOVED, i] += abs(moved)
    leg[END_ANGLE, i] += moved
    leg[LEAST_ANGLE, i] = min(leg[LEAST_ANGLE, i], leg[END_ANGLE, i])
    leg[GREATEST_ANGLE, i] = max(leg[GREATEST_ANGLE, i], leg[END_ANGLE, i])


@lean
def joint_travel(leg, i):  # type: ignore[no-untyped-def]
    """Angle moved by a joint on a traced leg [rad]: exact where it does not turn round, from its extremes if once."""
    if leg[TURNS, i] == 0.0:
        return abs(leg[END_ANGLE, i])
    if leg[TURNS, i] == 1.0:
        return 2.0 * (leg[GREATEST_ANGLE, i] - leg[LEAST_ANGLE, i]) - abs(leg[END_ANGLE, i])
    return leg[MOVED, i]


@lean
def judge_leg(leg, sense, keep, at_target, depth, constraints):  # type: ignore[no-untyped-def]
    """Margin, slack to the limits, and travel of a traced leg.

    Args:
        leg: from `trace_leg`, shape (ROWS, 6).
        sense: wanted sign of each joint's outward rate, shape (6,).
        keep: whether a joint must keep its direction, shape (6,); the others may turn at the target, but not within a
            leg unless `asked.turn_inside`.
        at_target: joint angles at the target with their turns, shape (6,).
        depth: length of the leg [m].
        constraints: `Constraints`.

    Returns:
        margin: least rate in the wanted sense over the joints to keep [rad/m], by the rule asked for.
        slack: least distance to a limit [rad].
        travel: sum of the joints' angles moved [rad].
    """
    margin, slack, travel = np.inf, np.inf, 0.0
    for i in range(6):
        least, greatest = leg[LEAST_RATE, i], leg[GREATEST_RATE, i]
        end = leg[END_ANGLE, i]
        travel += joint_travel(leg, i)
        slack = min(slack, at_target[i] + leg[LEAST_ANGLE, i] - constraints.lower[i])
        slack = min(slack, constraints.upper[i] - at_target[i] - leg[GREATEST_ANGLE, i])
        if least >= -NIL and greatest <= NIL:
            continue  # a joint that does not move does not reverse
        if keep[i]:
            pointwise = least if sense[i] > 0.0 else -greatest
            if constraints.mean_rule:
                # the mean has to reach the threshold, and no point may turn round
                margin = min(margin, sense[i] * end / depth, pointwise + constraints.min_rate)
            else:
                margin = min(margin, pointwise)
        elif not constraints.turn_inside:
            margin = min(margin, max(least, -greatest) + constraints.min_rate)
    return margin, slack, travel
