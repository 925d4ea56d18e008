"""Compass searches from a pair of legs, with any reversals: its figures move by ever less (theory §3).

Lengths in m, angles in rad, rates outwards in rad/m; controller angles. No kernel raises.
`constraints` is a `layout.Constraints` throughout.
"""

from __future__ import annotations

import numpy as np

from zerorev.kernels._jit import kernel
from zerorev.kernels.arm import controller_angles, twist_field
from zerorev.kernels.fan import is_better, judge_pair
from zerorev.kernels.field import ROOM
from zerorev.kernels.legs import ROWS, trace_leg
from zerorev.kernels.pairs import turns_fit

COMPASS_STEPS = 40
SETTLE_STEPS = 200
SETTLED, SLOPES_SETTLED = 1e-8, 1e-9  # [rad] of psi_t, and of the outer end of a leg: steps at which it has settled
SLOPES_LOOSE = 4.0  # by so many steps of psi_t a leg may have to follow it, to begin with


@kernel
def judge_point(arm, plane, branch, point, weights, constraints, mode, nodes, legs):  # type: ignore[no-untyped-def]
    """`judge_pair` of (psi_t, slope, slope), inf where it cannot be run; `legs` is room for two legs."""
    psi_t, a, b = point
    if constraints.psi_bound > 0.0 and (
        max(abs(psi_t), abs(psi_t + a * constraints.depth), abs(psi_t + b * constraints.depth)) > constraints.psi_bound
    ):
        return np.inf, np.inf, np.inf
    if max(abs(a), abs(b)) > constraints.steepest:
        return np.inf, np.inf, np.inf
    cs, work = np.empty((6, 2)), np.empty(ROOM)
    theta_s, theta_psi, principal = np.empty(6), np.empty(6), np.empty(6)
    if not twist_field(arm, plane, 0.0, psi_t, branch // 2, cs, theta_s, theta_psi):
        return np.inf, np.inf, np.inf
    controller_angles(arm, cs, branch % 2 == 1, principal)
    if not (
        trace_leg(arm, plane, branch, psi_t, a, constraints.depth, nodes, work, legs[0])
        and trace_leg(arm, plane, branch, psi_t, b, constraints.depth, nodes, work, legs[1])
        and turns_fit(legs[0], legs[1], False, principal, constraints)
    ):
        return np.inf, np.inf, np.inf
    return judge_pair(legs[0], legs[1], a, b, weights, constraints, mode)


@kernel
def refine(arm, plane, branch, point, step, weights, constraints, mode, nodes, best):  # type: ignore[no-untyped-def]
    """Compass search from a pair of legs: any of its three figures may move, alone or together, by ever less.

    Args:
        arm: `ArmGeometry`.
        plane: `TwistPlane`.
        branch: 0..7.
        point: in and out, shape (3,): psi_t [rad] and the two slopes [rad/m].
        step: of psi_t, to begin with [rad].
        weights: see `judge_pair`.
        constraints: `Constraints`.
        mode: see `judge_pair`.
        nodes: points on a leg.
        best: out, shape (3,): cost, lack and value.
    """
    moves = np.empty((27, 3))
    for move in range(27):
        moves[move, 0], moves[move, 1], moves[move, 2] = move % 3 - 1, move // 3 % 3 - 1, move // 9 - 1
    _search(arm, plane, branch, point, moves, step, 0.0, COMPASS_STEPS, (weights, constraints, mode, nodes), best)


@kernel
def settle(arm, plane, branch, point, step, weights, constraints, mode, nodes, best):  # type: ignore[no-untyped-def]
    """Descend to the bottom from a pair of legs: psi_t moves by ever less, and the slopes find their best at each.

    Where a joint begins to turn round there are edges, and a valley may run down along one. It is tilted against the
    moves of `refine`, which is soon stopped. At one psi_t it does not, as there the legs hardly depend on each other;
    and which way it goes from one psi_t to the next is decided by the last move that was of use.

    Args:
        arm: `ArmGeometry`.
        plane: `TwistPlane`.
        branch: 0..7.
        point: see `refine`.
        step: see `refine`.
        weights: see `judge_pair`.
        constraints: `Constraints`.
        mode: see `judge_pair`.
        nodes: points on a leg.
        best: see `refine`.
    """
    judged = (weights, constraints, mode, nodes)
    slopes = np.zeros((4, 3))
    slopes[0, 1], slopes[1, 1], slopes[2, 2], slopes[3, 2] = -1.0, 1.0, -1.0, 1.0
    _search(arm, plane, branch, point, slopes, step, SLOPES_SETTLED, SETTLE_STEPS, judged, best)
    tried, worth, drift = np.empty(3), np.empty(3), np.zeros(2)
    for _ in range(SETTLE_STEPS):
        if step < SETTLED:
            break
        stuck = True
        for move in (-step, step):
            tried[0] = point[0] + move
            tried[1:] = point[1:] + drift * move
            _search(
                arm, plane, branch, tried, slopes, SLOPES_LOOSE * step, SLOPES_SETTLED, SETTLE_STEPS, judged, worth
            )  # fmt: skip
            if is_better(worth[0], worth[1], worth[2], best):
                drift[:] = (tried[1:] - point[1:]) / move
                best[:], point[:] = worth, tried
                stuck = False
                break
        if stuck:
            step *= 0.5


@kernel
def _search(arm, plane, branch, point, moves, step, least, steps, judged, best):  # type: ignore[no-untyped-def]
    """Take whichever moves better a pair of legs; halve them once none does; until they are less than the least.

    Args:
        arm: `ArmGeometry`.
        plane: `TwistPlane`.
        branch: 0..7.
        point: see `refine`.
        moves: in steps of psi_t, and of the outer ends of the legs, shape (M, 3).
        step: to begin with [rad].
        least: step [rad].
        steps: times that all moves are tried, at most.
        judged: by (weights, asked, mode, nodes), see `refine`.
        best: see `refine`.
    """
    weights, constraints, mode, nodes = judged
    legs, tried = np.empty((2, ROWS, 6)), np.empty(3)
    best[0], best[1], best[2] = judge_point(arm, plane, branch, point, weights, constraints, mode, nodes, legs)
    for _ in range(steps):
        if step < least:
            break
        stuck = True
        for move in moves:
            tried[0] = point[0] + move[0] * step
            tried[1:] = point[1:] + move[1:] * step / constraints.depth
            cost, lack, value = judge_point(arm, plane, branch, tried, weights, constraints, mode, nodes, legs)
            if is_better(cost, lack, value, best):
                best[0], best[1], best[2] = cost, lack, value
                point[:] = tried
                stuck = False
        if stuck:
            step *= 0.5
