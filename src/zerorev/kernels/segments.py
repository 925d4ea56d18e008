"""From a tube to legs of few straight segments (theory §4).

A tube is narrowed, from its outer end inwards, to the spins from which a wanted end can still be reached: what is left
holds every leg from the target to that end, and little else. Breakpoints are placed where it bends; how the joints'
rates along the segments depend on them is what is needed to better them.

Lengths in m, angles in rad, slopes outwards in rad/m. No kernel raises.
"""

from __future__ import annotations

import numpy as np

from zerorev.kernels._jit import kernel, lean
from zerorev.kernels.field import BLOCK, PSI, STANDOFF, fields, rates, spun
from zerorev.kernels.tube import HIGH, KEPT, LEFT, LOW, RIGHT, admissible, drift

ROUNDING = 1e-5  # [rad] by which the way in may miss the way out
NUDGE = 1e-5  # [m], [rad] for derivatives


@kernel
def narrow(arm, plane, posture, side, constraints, tube, rows, room, viable):  # type: ignore[no-untyped-def]
    """The spins of a tube from which a wanted end can be reached.

    Args:
        arm: `ArmGeometry`.
        plane: `TwistPlane`.
        posture: 0..3.
        side: signs of the outward rates on the unflipped wrist, shape (6,).
        constraints: `Constraints`.
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
        admissible(work, 2, side, constraints, lo, hi, spare)
        for end in range(2):
            if not lo[end] <= hi[end]:  # by a hair, at the edge of where life is
                lo[end] = hi[end] = min(max(0.5 * (lo[end] + hi[end]), -constraints.steepest), constraints.steepest)
        # inwards it is the steepest way that leads to the least spin
        parts[0, LEFT], parts[0, RIGHT], parts[0, LOW], parts[0, HIGH] = (
            viable[n + 1, 0],
            viable[n + 1, 1],
            hi[0],
            lo[1],
        )
        drift(arm, plane, posture, s, tube[n, 0] - s, parts, 1, side, constraints, room, spins)
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
def linearise(arm, plane, posture, side, standoff, psi, shares, min_rate, unit, out):  # type: ignore[no-untyped-def]
    """The slack of the joints' rates on a leg of straight segments, and how it changes with the breakpoints.

    Next to a singularity rates change without bound and over no distance at all. Where only their signs matter much,
    they are better weighed by one over 1 + the square of all fields, which leaves smooth functions there.

    Args:
        arm: `ArmGeometry`.
        plane: `TwistPlane`.
        posture: 0..3.
        side: signs of the outward rates on the unflipped wrist, shape (6,).
        standoff: of the breakpoints [m], shape (K + 1,).
        psi: spins there [rad], shape (K + 1,).
        shares: where on each segment it is examined, 0 to 1, shape (Q,).
        min_rate: what every joint has to keep [rad/m].
        unit: length by which stand-offs are set against spins [m/rad] where rates are weighed; 0: they are not.
        out: out, shape (K, Q, 6, 5): the slack of the rate in the wanted direction [rad/m]; its derivatives by the
            stand-off and by the spin of the inner breakpoint, then of the outer one.
    """
    segments, samples = standoff.shape[0] - 1, shares.shape[0]
    where, turned, spare = np.empty(5 * samples), np.empty(5 * samples), np.empty(5)
    theta_s, theta_psi, weight = np.empty((6, 5 * samples)), np.empty((6, 5 * samples)), np.ones(5 * samples)
    for k in range(segments):
        length = standoff[k + 1] - standoff[k]
        slope = (psi[k + 1] - psi[k]) / length
        for q in range(samples):
            s, p = standoff[k] + shares[q] * length, psi[k] + shares[q] * (psi[k + 1] - psi[k])
            for n in range(5):
                where[5 * q + n], turned[5 * q + n] = s, p
            where[5 * q + 1] += NUDGE
            where[5 * q + 2] -= NUDGE
            turned[5 * q + 3] += NUDGE
            turned[5 * q + 4] -= NUDGE
        rates(arm, plane, posture, where, turned, theta_s, theta_psi)
        if unit > 0.0:
            for n in range(5 * samples):
                square = 1.0
                for i in range(6):
                    square += theta_psi[i, n] ** 2 + (unit * theta_s[i, n]) ** 2
                weight[n] = 1.0 / square
        for q in range(samples):
            for i in range(6):
                for n in range(5):
                    at = 5 * q + n
                    spare[n] = weight[at] * (side[i] * (theta_s[i, at] + slope * theta_psi[i, at]) - min_rate)
                by_s, by_psi = (spare[1] - spare[2]) / (2.0 * NUDGE), (spare[3] - spare[4]) / (2.0 * NUDGE)
                by_slope = weight[5 * q] * side[i] * theta_psi[i, 5 * q] / length
                share = shares[q]
                out[k, q, i, 0] = spare[0]
                out[k, q, i, 1] = (1.0 - share) * by_s + by_slope * slope
                out[k, q, i, 2] = (1.0 - share) * by_psi - by_slope
                out[k, q, i, 3] = share * by_s - by_slope * slope
                out[k, q, i, 4] = share * by_psi + by_slope


@lean
def elbow(arm, plane, posture, standoff, psi):  # type: ignore[no-untyped-def]
    """How far the elbow is from stretched or folded, which is where reach ends.

    Args:
        arm: `ArmGeometry`.
        plane: `TwistPlane`.
        posture: 0..3.
        standoff: s [m].
        psi: spin [rad].

    Returns:
        the square of the sine of the angle between the two links, and its derivatives by stand-off [1/m] and spin.
    """
    zx, zy, zz = plane.R_base_tcp0[2], plane.R_base_tcp0[5], plane.R_base_tcp0[8]
    w0, w1, w2 = plane.wrist
    _, cosine, sine = spun(plane, w0, w1, 0.0)
    c, s = np.cos(psi), np.sin(psi)
    rx, ry, rz = c * cosine[0] + s * sine[0], c * cosine[1] + s * sine[1], c * cosine[2] + s * sine[2]
    along = standoff + w2
    wx, wy = plane.target[0] + along * zx + rx, plane.target[1] + along * zy + ry
    x1 = np.sqrt(wx * wx + wy * wy - arm.b * arm.b) * (-1.0 if posture >= 2 else 1.0)
    x, z = x1 - arm.a1, plane.target[2] + along * zz + rz - arm.c1
    k2 = arm.a2 * arm.a2 + arm.c3 * arm.c3
    per_links = 1.0 / (2.0 * arm.c2 * np.sqrt(k2))
    cos_phi = (x * x + z * z - arm.c2 * arm.c2 - k2) * per_links
    # the wrist centre moves along z as the tool backs out, and at z x r as it spins
    by_s = x * (wx * zx + wy * zy) / x1 + z * zz
    by_psi = x * (wx * (zy * rz - zz * ry) + wy * (zz * rx - zx * rz)) / x1 + z * (zx * ry - zy * rx)
    by_cos = -4.0 * cos_phi * per_links
    return 1.0 - cos_phi * cos_phi, by_cos * by_s, by_cos * by_psi
