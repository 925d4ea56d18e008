"""A plunge with breaks of the chips and a straight retract, as four numbers (theory §2).

The four are the spin at the corner, the slope of the plunge, that of the retract, and the stand-off where the motion
begins. How the tool draws back at each break follows from them: with the slope nearest to the retract's that turns no
joint round. Rates along the motion, and the joints at its two outer ends, are very nearly linear functions of the four
within a small region; a linear programme goes as far as it can within that, as `kernels.slp` does for legs without
breaks.

Lengths in m, angles in rad, rates outwards in rad/m, of the unflipped wrist. No kernel raises.
"""

from __future__ import annotations

import numpy as np

from zerorev.kernels._jit import kernel, lean
from zerorev.kernels.arm import controller_angles, flip_sign, twist_field
from zerorev.kernels.layout import LONGEST_TWIST
from zerorev.kernels.simplex import WIDTH, solve
from zerorev.kernels.slp import onwards

PSI, PLUNGE, RETRACT, DEPTH = range(4)
DEEPEST, LEAST_TRAVEL = range(2)
ROUNDS = 4  # where a way back begins depends on its slope
ROOMS = 17  # rows that are not rates
NUDGE = 1e-7  # [rad], and a share of the depth: by which derivatives are found
STEPS = 40
TRUSTED_TURN, TRUSTED_STRETCH = 0.1, 0.05  # [rad] of each spin, and a share of the depth, by which a step goes at most
FIRST_TRUST, LEAST_TRUST = 0.5, 1e-4  # shares of the two
PRICE = 10.0  # of 1 rad/m that lacks, against the whole depth, or a turn of travel
SETTLED = 1e-9  # [rad/m] by which the slope still changes


@kernel
def path(arm, plane, posture, breaking, count, numbers, standoff, psi):  # type: ignore[no-untyped-def]
    """Breakpoints of the plunge, from the corner outwards.

    Args:
        arm: `ArmGeometry`.
        plane: `TwistPlane`.
        posture: 0..3.
        breaking: `Breaking`.
        count: of the breaks.
        numbers: the four, shape (4,).
        standoff: out [m], shape (2 count + 2,).
        psi: out, spins there [rad], shape (2 count + 2,).
    """
    room = np.empty((6, 2)), np.empty((2, 6)), np.empty((2, 6))
    s, spin, plunge, n = breaking.corner, numbers[PSI], numbers[PLUNGE], 0
    standoff[0], psi[0] = s, spin
    peck, back, nearest = breaking.peck, breaking.back, breaking.nearest
    if breaking.evenly:
        length = numbers[DEPTH] - breaking.corner
        peck, back, nearest = length / (count + 1), back * length / (peck * count), breaking.corner
    for k in range(count, 0, -1):
        # a motion that is too short for its breaks has them next to the target
        at = max(numbers[DEPTH] - k * peck, nearest)
        spin += plunge * (at + back - s)
        s = at + back
        slope = _way_back(arm, plane, posture, breaking, back, s, spin, plunge, numbers[RETRACT], room)
        standoff[n + 1], psi[n + 1] = s, spin
        spin -= slope * back
        s, n = at, n + 2
        standoff[n], psi[n] = s, spin
    standoff[n + 1], psi[n + 1] = numbers[DEPTH], spin + plunge * (numbers[DEPTH] - s)


@lean
def _way_back(arm, plane, posture, breaking, back, s, psi, plunge, retract, room):  # type: ignore[no-untyped-def]
    """The slope nearest to the retract's with which the tool draws back so that no joint turns round [rad/m].

    The retract's own where there is none.

    Args:
        arm: `ArmGeometry`.
        plane: `TwistPlane`.
        posture: 0..3.
        breaking: `Breaking`.
        back: length of the way [m].
        s: stand-off at which the way back ends, and the plunge continues [m].
        psi: spin there [rad].
        plunge: slope of the plunge [rad/m].
        retract: slope of the retract [rad/m].
        room: to work in: (6, 2), (2, 6) and (2, 6).
    """
    cs, theta_s, theta_psi = room
    if not twist_field(arm, plane, s, psi, posture, cs, theta_s[0], theta_psi[0]):
        return retract
    slope = retract
    for _ in range(ROUNDS):
        s_there, psi_there = s - back, psi - slope * back
        if not twist_field(arm, plane, s_there, psi_there, posture, cs, theta_s[1], theta_psi[1]):
            return retract
        low, high = -breaking.steepest, breaking.steepest
        for n in range(2):
            for i in range(6):
                way = -1.0 if theta_s[0, i] + plunge * theta_psi[0, i] > 0.0 else 1.0
                # way * (theta_s + u theta_psi) >= least
                at = (breaking.least_back * way - theta_s[n, i]) / theta_psi[n, i]
                if way * theta_psi[n, i] > 0.0:
                    low = max(low, at)
                else:
                    high = min(high, at)
        if not low <= high:
            return retract
        chosen = min(max(retract, low), high)
        if abs(chosen - slope) <= SETTLED:
            break
        slope = chosen
    return slope


@lean
def rows_of(count, samples):  # type: ignore[no-untyped-def]
    """How many rows a motion has."""
    return 6 * ((count + 2) * samples[0] + 2 * count + samples[1]) + ROOMS


@kernel
def better(arm, plane, branch, breaking, count, samples, goal, deepest, enough, numbers):  # type: ignore[no-untyped-def]
    """Better a motion by small steps, for as long as it pays.

    Args:
        arm: `ArmGeometry`.
        plane: `TwistPlane`.
        branch: 0..7.
        breaking: `Breaking`.
        count: of the breaks.
        samples: see `_rows`.
        goal: DEEPEST, or LEAST_TRAVEL at the depth that is given.
        deepest: it gets no deeper [m].
        enough: less gain than this, relative, is none.
        numbers: in and out, the four, shape (4,).

    Returns:
        by how much a rate, or the room to a limit over the depth, lacks what is asked, at most [rad/m]; 0 or less where
        nothing lacks; inf where the motion to begin with cannot be run.
    """
    size = rows_of(count, samples)
    rows, there, bent = np.empty(size), np.empty(size), np.empty(size)
    by, cost, step, again, moved = np.empty((size, 4)), np.zeros(5), np.empty(5), np.empty(5), np.empty(4)
    near = np.empty((size, WIDTH), dtype=np.int64), np.empty((size, WIDTH)), np.empty(size)
    unit = numbers[DEPTH] - breaking.corner
    scale = np.array([1.0, 1.0 / unit, 1.0 / unit, unit])  # spins count by what they are at the outer end
    worth = unit if goal == DEEPEST else 2.0 * np.pi
    price, trust = PRICE * worth, FIRST_TRUST
    travel = _look(arm, plane, branch, breaking, count, samples, scale, numbers, rows, there, by, cost, goal)
    if np.isnan(travel):
        return np.inf
    for _ in range(STEPS):
        room = (deepest - numbers[DEPTH]) / unit
        predicted = _step(rows, rows, by, cost, price, trust, goal, room, near, step)
        if not predicted >= enough * worth or trust < LEAST_TRUST:
            break
        gain, best = -np.inf, step
        for corrected in range(2):
            tried = again if corrected == 1 else step
            moved[:] = numbers + scale * tried[:4]
            after = _rows(arm, plane, branch, breaking, count, samples, unit, moved, there)
            if np.isnan(after):
                break
            gained = price * (max(-rows.min(), 0.0) - max(-there.min(), 0.0))
            gained += travel - after if goal == LEAST_TRAVEL else moved[DEPTH] - numbers[DEPTH]
            if gained > gain:
                gain, best = gained, tried
            if corrected == 1 or gain > 0.6 * predicted:
                break
            # the rows are curved: once more, with what they really have at the end of the step
            for r in range(size):
                bent[r] = there[r]
                for k in range(4):
                    bent[r] -= by[r, k] * step[k]
            if not _step(rows, bent, by, cost, price, trust, goal, room, near, again) > 0.0:
                break
        if gain > 0.1 * predicted:
            numbers += scale * best[:4]
            travel = _look(arm, plane, branch, breaking, count, samples, scale, numbers, rows, there, by, cost, goal)
        trust = min(1.0, 2.0 * trust) if gain > 0.6 * predicted else trust if gain > 0.1 * predicted else 0.3 * trust
    return -rows.min()


@kernel
def room_of_joints(arm, plane, branch, breaking, count, samples, numbers):  # type: ignore[no-untyped-def]
    """The least room of a joint to its limits [rad]; see `_rows`."""
    rows, unit = np.empty(rows_of(count, samples)), numbers[DEPTH] - breaking.corner
    travel = _rows(arm, plane, branch, breaking, count, samples, unit, numbers, rows)
    return -np.inf if np.isnan(travel) else rows[rows.shape[0] - ROOMS : rows.shape[0] - ROOMS + 12].min() * unit


@kernel
def _look(arm, plane, branch, breaking, count, samples, scale, numbers, rows, nudged, by, cost, goal):  # type: ignore[no-untyped-def]
    """Rows, how they change with the four numbers, shape (R, 4), and how what is to be least does, shape (4,)."""
    travel = _rows(arm, plane, branch, breaking, count, samples, scale[DEPTH], numbers, rows)
    there = np.empty(4)
    for k in range(4):
        there[:] = numbers
        there[k] += NUDGE * scale[k]
        after = _rows(arm, plane, branch, breaking, count, samples, scale[DEPTH], there, nudged)
        if np.isnan(after) or np.isnan(travel):
            return np.nan
        cost[k] = (after - travel) / NUDGE
        for r in range(rows.shape[0]):
            by[r, k] = (nudged[r] - rows[r]) / NUDGE if rows[r] < np.inf else 0.0
    if goal == DEEPEST:
        cost[:3], cost[DEPTH] = 0.0, -scale[DEPTH]
    return travel


@kernel
def _step(rows, bent, by, cost, price, trust, goal, room, near, step):  # type: ignore[no-untyped-def]
    """The best change of the four within the trusted region, and the gain that is predicted; 0 where there is none.

    Args:
        rows: what the motion has beyond what is asked, shape (R,).
        bent: the same as the linear programme takes it, shape (R,).
        by: how it changes, shape (R, 4).
        cost: how what is to be least changes, shape (5,); the last one is set.
        price: of what lacks.
        trust: share of the region.
        goal: see `better`.
        room: by how much the depth may grow, as a share.
        near: room for the rows that may matter.
        step: out, shape (5,): the last is what still lacks.
    """
    reach = np.full(5, trust * TRUSTED_TURN)
    reach[DEPTH], reach[4] = trust * TRUSTED_STRETCH if goal == DEEPEST else 0.0, 1.0
    low, high = -np.ones(5), np.ones(5)
    if goal == DEEPEST:
        high[DEPTH] = min(1.0, max(room / reach[DEPTH], -1.0))
    lack, most, count = max(-rows.min(), 0.0), 0.0, 0
    at, coefficients, spare = near
    for r in range(rows.shape[0]):
        span, greatest = 0.0, 1.0
        for k in range(4):
            span += abs(by[r, k]) * reach[k]
            greatest = max(greatest, abs(by[r, k]) * reach[k])
        most = max(most, span)
        if not bent[r] < 2.0 * span + lack:
            continue
        for k in range(4):
            at[count, k], coefficients[count, k] = k, by[r, k] * reach[k] / greatest
        at[count, 4], coefficients[count, 4] = 4, 1.0 / greatest
        spare[count] = bent[r] / greatest
        count += 1
    low[4], high[4] = 0.0, 2.0 * (lack + most)
    scaled = cost * reach
    scaled[4] = price
    if not solve(scaled, low, high, at, coefficients, spare, count, step):
        return 0.0
    gain = price * (lack - step[4])
    for k in range(4):
        step[k] = min(max(step[k], low[k]), high[k]) * reach[k]
        gain -= cost[k] * step[k]
    return gain


@kernel
def _rows(arm, plane, branch, breaking, count, samples, unit, numbers, rows):  # type: ignore[no-untyped-def]
    """What each rate and each room of a motion has beyond what is asked.

    Args:
        arm: `ArmGeometry`.
        plane: `TwistPlane`.
        branch: 0..7.
        breaking: `Breaking`.
        count: of the breaks.
        samples: points at which rates are examined: of the pieces of the plunge, of the retract, 2 or more.
        unit: length over which room to a limit is spread, so that it can be set against rates [m].
        numbers: the four, shape (4,).
        rows: out [rad/m], shape (`rows_of`,): first the rates, then the rooms of the joints (12), of the twist of both
            legs, and of the spin at the corner and at both ends; infinite where something is not asked.

    Returns:
        travel of all joints [rad]; NaN where a point is out of reach.
    """
    standoff, psi = np.empty((2, 2 * count + 2))
    path(arm, plane, branch // 2, breaking, count, numbers, standoff, psi)
    cs, theta_s, theta_psi = np.empty((6, 2)), np.empty(6), np.empty(6)
    before, here, side = np.empty(6), np.empty(6), np.empty(6)
    if not twist_field(arm, plane, standoff[0], psi[0], branch // 2, cs, theta_s, theta_psi):
        return np.nan
    ends = np.empty((3, 6))
    for i in range(6):  # the leg of the greater slope goes where the spin goes (theory §2)
        side[i] = 1.0 if (theta_psi[i] > 0.0) == (numbers[PLUNGE] > numbers[RETRACT]) else -1.0
    rows[:] = np.inf
    r, pieces = 0, 2 * count + (2 if breaking.lead > 0.0 else 1)
    for leg in range(2):
        for n in range(pieces if leg == 0 else 1):
            inwards, led = leg == 0 and n % 2 == 0, leg == 0 and n > 2 * count
            m = min(n, 2 * count)
            s0, p0, s1 = standoff[m], psi[m], standoff[m + 1]
            slope, points = numbers[PLUNGE], samples[0]
            if led:  # the lead-in, of which nothing is asked but that no joint turns round
                s0, p0, s1 = s1, psi[m + 1], s1 + breaking.lead
            elif leg == 1:
                s1, slope, points = numbers[DEPTH], numbers[RETRACT], samples[1]
            elif not inwards:
                slope, points = (psi[n + 1] - p0) / (s1 - s0), 2
            for q in range(points):
                part = q / (points - 1)
                s = s0 + part * (s1 - s0)
                known = q == 0 and not (n == 0 and leg == 1)  # where the piece before it ends
                psi_here = p0 + slope * (s - s0)
                if not (known or twist_field(arm, plane, s, psi_here, branch // 2, cs, theta_s, theta_psi)):
                    return np.nan
                for i in range(6):
                    way = side[i] if inwards or led else -side[i]
                    rows[r] = way * (theta_s[i] + slope * theta_psi[i]) - breaking.least
                    r += 1
                if led or (q == 0 and n > 0):
                    continue
                controller_angles(arm, cs, branch % 2 == 1, here)
                if q == 0 and n == 0:
                    ends[0] = here
                    ends[1 + leg] = here
                else:
                    for i in range(6):
                        way = side[i] * (flip_sign(arm, branch) if i == 4 else 1.0) * (1.0 - 2.0 * leg)
                        ends[1 + leg, i] += way * onwards(way * (here[i] - before[i]))
                before[:] = here
    rooms = rows[rows.shape[0] - ROOMS :]
    travel, full = 0.0, 2.0 * np.pi
    for i in range(6):  # where no joint reverses each is nearest to its limits at the two outer ends
        least, most = min(ends[1, i], ends[2, i]), max(ends[1, i], ends[2, i])
        turns = full * np.rint(0.5 * (breaking.lower[i] + breaking.upper[i] - least - most) / full)
        rooms[2 * i] = (least + turns - breaking.lower[i]) / unit
        rooms[2 * i + 1] = (breaking.upper[i] - most - turns) / unit
        travel += most - least
    length = numbers[DEPTH] - breaking.corner
    rooms[12] = (LONGEST_TWIST - abs(numbers[PLUNGE]) * length) / unit
    rooms[13] = (LONGEST_TWIST - abs(numbers[RETRACT]) * length) / unit
    if breaking.psi_bound > 0.0:
        rooms[14] = (breaking.psi_bound - abs(psi[0])) / unit
        rooms[15] = (breaking.psi_bound - abs(psi[2 * count + 1])) / unit
        rooms[16] = (breaking.psi_bound - abs(psi[0] + numbers[RETRACT] * length)) / unit
    return travel
