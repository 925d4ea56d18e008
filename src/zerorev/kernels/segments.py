"""From a tube to legs of few straight segments (theory §4).

A tube is narrowed, from its outer end inwards, to the spins from which a wanted end can still be reached: what is left
holds every leg from the target to that end, and little else. Breakpoints are placed where it bends; how the joints'
rates along the segments depend on them is what is needed to better them.

Lengths in m, angles in rad, slopes outwards in rad/m. No kernel raises.
"""

from __future__ import annotations

import numpy as np

from zerorev.kernels._jit import kernel
from zerorev.kernels.field import BLOCK, PSI, STANDOFF, fields, rates
from zerorev.kernels.tube import HIGH, KEPT, LEFT, LOW, RIGHT, admissible, drift

ROUNDING = 1e-5  # [rad] by which the way in may miss the way out
NUDGE = 1e-5  # [m], [rad] for derivatives


@kernel
def narrow(arm, plane, posture, side, held, tube, rows, room, viable):  # type: ignore[no-untyped-def]
    """The spins of a tube from which a wanted end can be reached.

    Args:
        arm: `ArmGeometry`.
        plane: `TwistPlane`.
        posture: 0..3.
        side: signs of the outward rates on the unflipped wrist, shape (6,).
        held: `Held`.
        tube: shape (MAX_ROWS, WIDTH).
        rows: how many it has.
        room: what `kernels.tube.workspace` returns.
        viable: in and out, shape (rows, 2): the last row holds the spins wanted at the end; the others are written.

    Returns:
        whether the target can be traced back to.
    """
    work, lo, hi, spare = room
    parts, spins = np.empty((KEPT, 4)), np.empty((KEPT, 2))
    for n in range(rows - 2, -1, -1):
        s = tube[n + 1, 0]
        for end in range(2):
            work[STANDOFF * BLOCK + end], work[PSI * BLOCK + end] = s, viable[n + 1, end]
        fields(arm, plane, posture, 2, work)
        admissible(work, 2, side, held, lo, hi, spare)
        for end in range(2):
            if not lo[end] <= hi[end]:  # by a hair, at the edge of where life is
                lo[end] = hi[end] = min(max(0.5 * (lo[end] + hi[end]), -held.steepest), held.steepest)
        # inwards it is the steepest way that leads to the least spin
        parts[0, LEFT], parts[0, RIGHT], parts[0, LOW], parts[0, HIGH] = (
            viable[n + 1, 0],
            viable[n + 1, 1],
            hi[0],
            lo[1],
        )
        drift(arm, plane, posture, s, tube[n, 0] - s, parts, 1, side, held, room, spins)
        widest = -1.0
        for k in range(int(tube[n, 1])):
            a = max(spins[0, 0] - ROUNDING, tube[n, 2 + 2 * k])
            b = min(spins[0, 1] + ROUNDING, tube[n, 3 + 2 * k])
            if b - a > widest and b >= a:
                widest = b - a
                viable[n, 0], viable[n, 1] = a, b
        if widest < 0.0:
            return False
    return True


@kernel
def place_knots(tube, rows, viable, knots):  # type: ignore[no-untyped-def]
    """Rows at which segments meet: where the middle of a narrowed tube bends, and evenly besides.

    Args:
        tube: whose first column holds the stand-offs.
        rows: how many it has.
        viable: as left by `narrow`.
        knots: out, shape (K + 1,): rows, the first and the last among them.
    """
    weight = np.zeros(rows)
    before = 0.0
    for n in range(1, rows):
        ds = tube[n, 0] - tube[n - 1, 0]
        slope = 0.5 * (viable[n].sum() - viable[n - 1].sum()) / ds
        weight[n] = abs(slope - before) if n > 1 else 0.0
        before = slope
    bend = max(weight.sum(), 1e-12)
    for n in range(1, rows):
        weight[n] = weight[n - 1] + weight[n] / bend + (tube[n, 0] - tube[n - 1, 0]) / tube[rows - 1, 0]
    segments = knots.shape[0] - 1
    knots[0], n = 0, 0
    for k in range(1, segments + 1):
        # at least a row each, and one left for each of those to come
        n += 1
        while n < rows - 1 - (segments - k) and weight[n] < weight[rows - 1] * k / segments:
            n += 1
        knots[k] = n
    knots[segments] = rows - 1


@kernel
def linearise(arm, plane, posture, side, standoff, psi, shares, out):  # type: ignore[no-untyped-def]
    """The joints' rates on a leg of straight segments, and how they change with its breakpoints.

    Args:
        arm: `ArmGeometry`.
        plane: `TwistPlane`.
        posture: 0..3.
        side: signs of the outward rates on the unflipped wrist, shape (6,).
        standoff: of the breakpoints [m], shape (K + 1,).
        psi: spins there [rad], shape (K + 1,).
        shares: where on each segment it is looked at, 0 to 1, shape (Q,).
        out: out, shape (K, Q, 6, 5): rate in the wanted direction [rad/m]; its derivatives by the stand-off and by the
            spin of the inner breakpoint, then of the outer one.
    """
    segments, looks = standoff.shape[0] - 1, shares.shape[0]
    where, turned = np.empty(5 * looks), np.empty(5 * looks)
    theta_s, theta_psi = np.empty((6, 5 * looks)), np.empty((6, 5 * looks))
    for k in range(segments):
        length = standoff[k + 1] - standoff[k]
        slope = (psi[k + 1] - psi[k]) / length
        for q in range(looks):
            s, p = standoff[k] + shares[q] * length, psi[k] + shares[q] * (psi[k + 1] - psi[k])
            for n in range(5):
                where[5 * q + n], turned[5 * q + n] = s, p
            where[5 * q + 1] += NUDGE
            where[5 * q + 2] -= NUDGE
            turned[5 * q + 3] += NUDGE
            turned[5 * q + 4] -= NUDGE
        rates(arm, plane, posture, where, turned, theta_s, theta_psi)
        for q in range(looks):
            for i in range(6):
                rate = side[i] * (theta_s[i, 5 * q : 5 * q + 5] + slope * theta_psi[i, 5 * q : 5 * q + 5])
                by_s, by_psi = (rate[1] - rate[2]) / (2.0 * NUDGE), (rate[3] - rate[4]) / (2.0 * NUDGE)
                by_slope = side[i] * theta_psi[i, 5 * q] / length
                share = shares[q]
                out[k, q, i, 0] = rate[0]
                out[k, q, i, 1] = (1.0 - share) * by_s + by_slope * slope
                out[k, q, i, 2] = (1.0 - share) * by_psi - by_slope
                out[k, q, i, 3] = share * by_s - by_slope * slope
                out[k, q, i, 4] = share * by_psi + by_slope
