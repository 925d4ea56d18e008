"""The best pair of legs out of one point of the target line, and the turns of the joints there (theory §2, §3).

Lengths in m, angles in rad, rates outwards in rad/m; controller angles. No kernel raises.
"""

from __future__ import annotations

import numpy as np

from zerorev.kernels._jit import kernel
from zerorev.kernels.arm import controller_angles, flip_sign, twist_field
from zerorev.kernels.legs import (
    GREATEST_ANGLE,
    GREATEST_MARGIN,
    LEAST_ANGLE,
    PLUNGE_ROTATION,
    ROWS,
    TRAVEL,
    best_leg,
    trace_leg,
)

# columns of what is returned
VALUE, SLOPE_ABOVE, SLOPE_BELOW, MARGIN = range(4)


@kernel
def turn_choices(principal, asked):  # type: ignore[no-untyped-def]
    """In how many ways the turns of six joints can be chosen so that the target lies within the limits."""
    choices = 1
    for i in range(6):
        first = np.ceil((asked.lower[i] - principal[i]) / (2.0 * np.pi))
        last = np.floor((asked.upper[i] - principal[i]) / (2.0 * np.pi))
        choices *= max(0, int(last - first) + 1)
    return choices


@kernel
def take_turns(principal, asked, choice, at_target):  # type: ignore[no-untyped-def]
    """Joint angles at the target for one of the `turn_choices`, written to `at_target`, shape (6,)."""
    for i in range(6):
        first = np.ceil((asked.lower[i] - principal[i]) / (2.0 * np.pi))
        options = int(np.floor((asked.upper[i] - principal[i]) / (2.0 * np.pi)) - first) + 1
        at_target[i] = principal[i] + 2.0 * np.pi * (first + choice % options)
        choice //= options


@kernel
def best_pair(arm, plane, branch, psi_t, keep, asked, unlimited, mode, nodes, out):  # type: ignore[no-untyped-def]
    """The best two legs out of one point of the target line, one on each side of the critical rates.

    Args:
        arm: `ArmGeometry`.
        plane: `TwistPlane`.
        branch: 0..7.
        psi_t: spin at the target [rad].
        keep: whether a joint must keep its direction, shape (6,).
        asked: `Asked`.
        unlimited: the same without joint limits.
        mode: TRAVEL, GREATEST_MARGIN or PLUNGE_ROTATION.
        nodes: points on a leg.
        out: out, shape (4,): value to be least (inf where no pair will do), slope above, slope below, and the greatest
            margin that both legs can have (-inf where one cannot be run at all).
    """
    cs = np.empty((6, 2))
    theta_s, theta_psi = np.empty(6), np.empty(6)
    kappa, sense, principal, at_target = np.empty(6), np.empty(6), np.empty(6), np.empty(6)
    out[:] = np.inf, np.nan, np.nan, -np.inf
    if not twist_field(arm, plane, 0.0, psi_t, branch // 2, cs, theta_s, theta_psi):
        return
    controller_angles(arm, cs, branch % 2 == 1, principal)
    five = flip_sign(arm, branch)
    for i in range(6):
        if np.isnan(theta_psi[i]):
            return
        kappa[i] = -theta_s[i] / theta_psi[i]
        sense[i] = 1.0 if theta_psi[i] > 0.0 else -1.0
    sense[4] *= five

    # The limits seldom bind: look without them first, and keep that answer if some choice of turns brings it within.
    _pair_within(arm, plane, branch, psi_t, principal, sense, kappa, keep, unlimited, mode, nodes, out)
    if out[MARGIN] == -np.inf or not turn_choices(principal, asked):
        out[:] = np.inf, np.nan, np.nan, -np.inf
        return
    if out[VALUE] < np.inf:
        legs = np.empty((2, ROWS, 6))
        trace_leg(arm, plane, branch, psi_t, out[SLOPE_ABOVE], asked.depth, nodes, legs[0])
        trace_leg(arm, plane, branch, psi_t, out[SLOPE_BELOW], asked.depth, nodes, legs[1])
        fits = True
        for i in range(6):
            least = principal[i] + min(legs[0, LEAST_ANGLE, i], legs[1, LEAST_ANGLE, i])
            greatest = principal[i] + max(legs[0, GREATEST_ANGLE, i], legs[1, GREATEST_ANGLE, i])
            first = np.ceil((asked.lower[i] - least) / (2.0 * np.pi))
            fits = fits and greatest + 2.0 * np.pi * first <= asked.upper[i]
        if fits:
            return
    out[:] = np.inf, np.nan, np.nan, -np.inf
    for choice in range(turn_choices(principal, asked)):
        take_turns(principal, asked, choice, at_target)
        _pair_within(arm, plane, branch, psi_t, at_target, sense, kappa, keep, asked, mode, nodes, out)


@kernel
def _pair_within(arm, plane, branch, psi_t, at_target, sense, kappa, keep, asked, mode, nodes, out):  # type: ignore[no-untyped-def]
    """`best_pair` for one choice of turns; `out` is bettered where this choice betters it."""
    legs, gentle = np.empty((2, 3)), np.empty((2, 3))
    leg_mode = GREATEST_MARGIN if mode == GREATEST_MARGIN else TRAVEL
    for k in range(2):
        side = 1.0 - 2.0 * k
        held = (side * sense, keep, at_target)
        best_leg(arm, plane, branch, psi_t, side, kappa, held, asked, leg_mode, nodes, legs[k])
        if legs[k, 2] == -np.inf:
            return
        if mode == PLUNGE_ROTATION and legs[k, 0] < np.inf:
            best_leg(arm, plane, branch, psi_t, side, kappa, held, asked, mode, nodes, gentle[k])
    out[MARGIN] = max(out[MARGIN], min(legs[0, 2], legs[1, 2]))
    if not (legs[0, 0] < np.inf and legs[1, 0] < np.inf):
        return
    above, below = legs[0, 1], legs[1, 1]
    if mode == TRAVEL:
        value = legs[0, 0] + legs[1, 0]
    elif mode == GREATEST_MARGIN:
        value = max(legs[0, 0], legs[1, 0])
    else:
        # one leg, the plunge, turns least; the other travels least
        value = min(gentle[0, 0], gentle[1, 0])
        if gentle[0, 0] <= gentle[1, 0]:
            above = gentle[0, 1]
        else:
            below = gentle[1, 1]
    if value < out[VALUE]:
        out[VALUE], out[SLOPE_ABOVE], out[SLOPE_BELOW] = value, above, below
