"""Two legs of straight segments, improved together by sequential linear programming (theory §4).

The unknowns are the depth and the spins at all breakpoints of both legs, the target among them; the stand-offs of the
breakpoints change in proportion to the depth. The rates of the joints at points along the segments are very nearly
linear functions of the unknowns within a small region, and so are the joints at the outer ends; a linear programme goes
as far as it can within that region. A step counts only if it improves the goal, with what the rates lack added at a
price; the region grows and shrinks by how well the step was predicted.

Where every joint keeps its direction each comes nearest to its limits at the two outer ends, so those alone are held.

Lengths in m, angles in rad, rates outwards in rad/m. No kernel raises.
"""

from __future__ import annotations

import numpy as np

from zerorev.kernels._jit import kernel, lean
from zerorev.kernels.arm import controller_angles, flip_sign, solve_at, twist_field
from zerorev.kernels.segments import elbow, linearise
from zerorev.kernels.simplex import WIDTH, solve

# what is improved; all but the first keep the depth
DEPTH, TRAVEL, MARGIN, PLUNGE_ROTATION = range(4)

TRUSTED_TURN = 0.2  # [rad] by which a spin moves in one step, at most
TRUSTED_STRETCH = 0.1  # by which the depth changes, relative
FIRST_TRUST, LEAST_TRUST = 0.5, 1e-4  # shares of the two
LEAST_BEND = 1e-4  # of the elbow, as `elbow` measures it: about 0.01 mm from the end of the reach
CLEAN = 1e-8  # [rad/m] that may lack at the end; else the price of it is raised
RAISE, RAISES = 30.0, 2
ROOMY = 1e-6  # what a slack of a rate is worth, against a shortfall: what does not matter else is laid in the middle
HALVINGS = 6  # of a step that cannot be run
FOLLOWED = 8  # steps of a leg, at least, in which joints are followed to its end
WRONG_WAY = 0.5 * np.pi  # [rad] by which a joint that should go the other way goes in one of them, at most
ROUNDING = 1e-7  # [rad/m] of a limit that is just kept
TOLERANCE = 1e-6  # [rad] more than a linear programme is off by


@kernel
def better(arm, plane, branch, sense, rules, goal, shares, steps, enough, weighed, standoff, psi):  # type: ignore[no-untyped-def]
    """Better two legs by small steps, for as long as it pays.

    Args:
        arm: `ArmGeometry`.
        plane: `TwistPlane`.
        branch: 0..7.
        sense: wanted signs of the outward rates of the first leg on the unflipped wrist, shape (6,); the second leg
            has the opposite ones.
        rules: `Constraints`.
        goal: DEPTH, as deep as can be; TRAVEL, the least; MARGIN, the greatest; PLUNGE_ROTATION, the least of the two.
        shares: where on each segment the joints are examined, 0 to 1, shape (Q,).
        steps: at most.
        enough: less gain than this, relative, is none.
        weighed: whether rates are weighed as in `linearise`, not for MARGIN: the way past a singularity is then open,
            but what lacks near one seems less.
        standoff: in and out, shape (2, K + 1): breakpoints of the legs, outwards [m].
        psi: in and out, shape (2, K + 1): their spins [rad]; the first two are the same.

    Returns:
        by how much a rate, weighed or not, or the room to a limit over the depth, lacks what is
        asked, at most [rad/m]; below 0 where nothing lacks; inf where the legs to begin with cannot be run.
    """
    segments, samples = standoff.shape[1] - 1, shares.shape[0]
    size = 4 + 2 * segments
    rows = 14 * segments * samples + 12 + 4 * segments
    rates = np.empty((2, segments, samples, 6, 5))
    at, by, spare = np.empty((2, rows, WIDTH), dtype=np.int64), np.empty((2, rows, WIDTH)), np.empty((2, rows))
    cost, step = np.zeros((2, size)), np.empty(size)
    bent = np.empty(rows)
    near = np.empty((rows, WIDTH), dtype=np.int64), np.empty((rows, WIDTH)), np.empty(rows)
    unit = standoff[0, segments]  # over which room to a limit is spread, so that it can be set against rates
    share = standoff / unit
    there = standoff.copy(), psi.copy()
    task = rules, goal, shares, share, unit, weighed

    scale, price = 1.0, 30.0
    if goal == DEPTH:
        scale, price = standoff[0, segments], 1000.0 * standoff[0, segments]
    elif goal == MARGIN:
        scale, price = rules.min_rate, 1.0
    here, trust, raised = 0, FIRST_TRUST, 0
    lack = _look(arm, plane, branch, sense, task, standoff, psi, rates, at[0], by[0], spare[0], cost[0])
    if lack == np.inf:
        return lack
    for _ in range(steps):
        predicted = _step(
            rules, goal, trust, lack, price, standoff[0, segments], psi, at[here], by[here], spare[here], cost[here],
            near, step,
        )  # fmt: skip
        if not predicted >= enough * scale or trust < LEAST_TRUST:
            if goal == MARGIN or lack <= CLEAN or raised == RAISES:
                break
            # to lack something has paid so far
            price, trust, raised = RAISE * price, FIRST_TRUST, raised + 1
            continue
        for corrected in range(2):
            for _ in range(HALVINGS):
                _move(share, standoff, psi, step, there)
                lack_there = _look(
                    arm, plane, branch, sense, task, there[0], there[1], rates,
                    at[1 - here], by[1 - here], spare[1 - here], cost[1 - here],
                )  # fmt: skip
                if lack_there < np.inf:
                    break
                # over the end of the reach, which is curved
                step *= 0.5
                predicted *= 0.5
            gain = _worth(goal, price, lack) - _worth(goal, price, lack_there)
            for i in range(size - 2):
                gain -= cost[here, i] * step[i]
            if corrected == 1 or gain > 0.6 * predicted or lack_there == np.inf:
                break
            # the rows are curved: once more, with what they really have at the end of the step
            for r in range(rows):
                bent[r] = spare[1 - here, r]
                for j in range(3):
                    bent[r] -= by[here, r, j] * step[at[here, r, j]]
            again = _step(
                rules, goal, trust, lack, price, standoff[0, segments], psi, at[here], by[here], bent, cost[here],
                near, step,
            )  # fmt: skip
            if not again > 0.0:
                break
        if gain > 0.6 * predicted:
            trust = min(1.0, 2.0 * trust)
        elif not gain > 0.1 * predicted:
            trust *= 0.4
        if gain > 0.1 * predicted:
            here, lack = 1 - here, lack_there
            standoff[:], psi[:] = there[0], there[1]
    return lack


@lean
def _worth(goal, price, lack):  # type: ignore[no-untyped-def]
    """What is lacking, at its price; margin is the one goal for which to lack less than nothing is worth more."""
    return price * (lack if goal == MARGIN else max(lack, 0.0))


@lean
def _move(share, standoff, psi, step, there):  # type: ignore[no-untyped-def]
    """Legs with their unknowns changed."""
    segments = standoff.shape[1] - 1
    depth = standoff[0, segments] + step[0]
    for k in range(2):
        for n in range(segments + 1):
            there[0][k, n] = share[k, n] * depth
            there[1][k, n] = psi[k, n] + step[_spin(k, n, segments)]


@lean
def _spin(k, n, segments):  # type: ignore[no-untyped-def]
    """Which unknown is the spin of the n-th breakpoint of a leg."""
    return 1 if n == 0 else 1 + k * segments + n


@kernel
def _look(arm, plane, branch, sense, task, standoff, psi, rates, at, by, spare, cost):  # type: ignore[no-untyped-def]
    """All that a linear programme needs to know of legs: its rows and costs.

    First come rates and elbow at all points, then the room of the joints at the outer ends, then the twist rates.

    Returns:
        see `better`.
    """
    rules, goal, shares, share, unit, weighed = task
    segments, samples = standoff.shape[1] - 1, shares.shape[0]
    size = 4 + 2 * segments
    cs, theta_s, theta_psi, side = np.empty((6, 2)), np.empty(6), np.empty(6), np.empty(6)
    at[:], by[:], cost[:] = 0, 0.0, 0.0
    at[:, 3], at[:, 4] = size - 2, size - 1
    lack, r, per = -np.inf, 0, unit if weighed else 0.0
    for k in range(2):
        side[:] = sense if k == 0 else -sense
        linearise(arm, plane, branch // 2, side, standoff[k], psi[k], shares, rules.min_rate, per, rates[k])
        for n in range(segments):
            length = standoff[k, n + 1] - standoff[k, n]
            for q in range(samples):
                for i in range(6):
                    found = rates[k, n, q, i]
                    if np.isnan(found[0]):
                        return np.inf
                    spare[r] = found[0]
                    lack = max(lack, -spare[r])
                    at[r, 1], at[r, 2] = _spin(k, n, segments), _spin(k, n + 1, segments)
                    by[r, 0] = share[k, n] * found[1] + share[k, n + 1] * found[3]
                    by[r, 1], by[r, 2], by[r, 3], by[r, 4] = found[2], found[4], 1.0, -1.0
                    r += 1
                # nothing is known beyond the reach, and its end is curved, so the elbow stays a hair away from it
                part = shares[q]
                s, turned = standoff[k, n] + part * length, psi[k, n] + part * (psi[k, n + 1] - psi[k, n])
                bend, by_s, by_psi = elbow(arm, plane, branch // 2, s, turned)
                spare[r] = bend - LEAST_BEND
                if goal == MARGIN:  # which does not contain the elbow
                    spare[r] = max(spare[r], 0.0)
                else:
                    lack = max(lack, -spare[r])
                    by[r, 3], by[r, 4] = 1.0, -1.0
                at[r, 1], at[r, 2] = _spin(k, n, segments), _spin(k, n + 1, segments)
                by[r, 0] = by_s * (share[k, n] + part * (share[k, n + 1] - share[k, n]))
                by[r, 1], by[r, 2] = (1.0 - part) * by_psi, part * by_psi
                r += 1
    moved, first = np.empty((2, 6)), np.empty(6)
    for k in range(2):
        side[:] = sense if k == 0 else -sense
        end = _spin(k, segments, segments)
        if not _follow(arm, plane, branch, side, standoff[k], psi[k], first, moved[k]):
            return np.inf
        if not twist_field(arm, plane, standoff[k, segments], psi[k, segments], branch // 2, cs, theta_s, theta_psi):
            return np.inf
        for i in range(6):
            spare[r + 6 * k + i] = side[i] * (flip_sign(arm, branch) if i == 4 else 1.0)
            at[r + 6 * k + i, 1] = end
            by[r + 6 * k + i, 0], by[r + 6 * k + i, 1] = -side[i] * theta_s[i] / unit, -side[i] * theta_psi[i] / unit
            by[r + 6 * k + i, 3] = 0.0 if goal == MARGIN else 1.0
            if goal == TRAVEL:
                cost[end] += side[i] * theta_psi[i]
    cramped = _room(first, moved, unit, rules, spare[r : r + 12])
    if goal != MARGIN or cramped > ROUNDING:  # a limit that is kept says nothing of the margin
        lack = max(lack, cramped)
    _twists(rules, share, standoff, psi, at[r + 12 :], by[r + 12 :], spare[r + 12 :])
    if goal == DEPTH:
        cost[0] = -1.0
    elif goal == PLUNGE_ROTATION:
        k = 0 if abs(psi[0, segments] - psi[0, 0]) <= abs(psi[1, segments] - psi[1, 0]) else 1
        way = 1.0 if psi[k, segments] > psi[k, 0] else -1.0
        cost[_spin(k, segments, segments)], cost[1] = way, -way
    return lack


@kernel
def _follow(arm, plane, branch, side, standoff, psi, first, moved):  # type: ignore[no-untyped-def]
    """How far each joint goes on a leg, if it keeps the direction it should have.

    Args:
        arm: `ArmGeometry`.
        plane: `TwistPlane`.
        branch: 0..7.
        side: signs of the outward rates on the unflipped wrist, shape (6,).
        standoff: of the breakpoints [m], shape (K + 1,).
        psi: spins there [rad], shape (K + 1,).
        first: out, shape (6,): angles at the target within (-pi, pi] [rad].
        moved: out, shape (6,): to the outer end [rad].

    Returns:
        whether all breakpoints can be reached.
    """
    cs, before, here = np.empty((6, 2)), np.empty(6), np.empty(6)
    segments = standoff.shape[0] - 1
    parts = max(1, FOLLOWED // segments)
    moved[:] = 0.0
    for n in range(parts * segments + 1):
        k = min(n // parts, segments - 1)
        part = n / parts - k
        s, turned = standoff[k] + part * (standoff[k + 1] - standoff[k]), psi[k] + part * (psi[k + 1] - psi[k])
        if not solve_at(arm, plane, s, turned, branch // 2, cs)[0]:
            return False
        controller_angles(arm, cs, branch % 2 == 1, here)
        if n == 0:
            first[:] = here
        else:
            for i in range(6):
                way = side[i] * (flip_sign(arm, branch) if i == 4 else 1.0)
                moved[i] += way * onwards(way * (here[i] - before[i]))
        before[:] = here
    return True


@lean
def onwards(step):  # type: ignore[no-untyped-def]
    """By how much a joint goes on in the direction that it should have, given that up to full turns [rad]."""
    return step - 2.0 * np.pi * np.floor((step + WRONG_WAY) / (2.0 * np.pi))


@lean
def _room(first, moved, unit, rules, spare):  # type: ignore[no-untyped-def]
    """Room of the joints at the outer ends of two legs, each with the turns that leave it most.

    Args:
        first: angles at the target within (-pi, pi], shape (6,).
        moved: from there to the outer ends, shape (2, 6).
        unit: length over which the room is spread [m].
        rules: `Constraints`.
        spare: in and out, shape (12,): wanted signs of the outward rates; room to the limit ahead, by the unit [rad/m].

    Returns:
        what any lacks, at most [rad/m].
    """
    lack, full = -np.inf, 2.0 * np.pi
    for i in range(6):
        middle = 0.5 * (rules.lower[i] + rules.upper[i])
        centre = first[i] + 0.5 * (moved[0, i] + moved[1, i])
        turns = full * np.rint((middle - centre) / full) if np.isfinite(middle) else 0.0
        for k in range(2):
            end, r = first[i] + moved[k, i] + turns, 6 * k + i
            # a joint that goes down comes nearest to its lower limit
            spare[r] = (rules.upper[i] - end if spare[r] > 0.0 else end - rules.lower[i]) / unit
            lack = max(lack, -spare[r])
    return lack


@lean
def _twists(rules, share, standoff, psi, at, by, spare):  # type: ignore[no-untyped-def]
    """Rows for the greatest twist rate of each segment, to either side."""
    segments, r = standoff.shape[1] - 1, 0
    for k in range(2):
        for n in range(segments):
            for way in (-1.0, 1.0):
                length, part = standoff[k, n + 1] - standoff[k, n], share[k, n + 1] - share[k, n]
                spare[r] = rules.longest * part - TOLERANCE - way * (psi[k, n + 1] - psi[k, n])
                if rules.steepest < np.inf:
                    spare[r] += rules.steepest * length - rules.longest * part
                    by[r, 0] = rules.steepest * part
                at[r, 1], at[r, 2] = _spin(k, n + 1, segments), _spin(k, n, segments)
                by[r, 1], by[r, 2] = -way, way
                r += 1


@kernel
def _step(rules, goal, trust, lack, price, depth, psi, at, by, spare, cost, near, step):  # type: ignore[no-untyped-def]
    """The best change of the unknowns within the trusted region.

    Args:
        rules: `Constraints`.
        goal: see `better`.
        trust: share of the region.
        lack: what the legs lack now.
        price: of that.
        depth: [m].
        psi: spins now, shape (2, K + 1).
        at: see `simplex.solve`.
        by: see `simplex.solve`.
        spare: see `simplex.solve`.
        cost: see `simplex.solve`.
        near: room for the rows that may matter.
        step: out, shape (N,): the last two are the shortfall of the rates afterwards, and their slack.

    Returns:
        the predicted gain; 0 where there is no step.
    """
    size, rows, segments = cost.shape[0], spare.shape[0], psi.shape[1] - 1
    reach = np.full(size, trust * TRUSTED_TURN)
    reach[0] = trust * TRUSTED_STRETCH * depth if goal == DEPTH else 0.0
    reach[size - 2 :] = 1.0
    low, high = -np.ones(size), np.ones(size)
    if rules.psi_bound > 0.0:
        for k in range(2):
            for n in range(segments + 1):
                i = _spin(k, n, segments)
                low[i] = max(low[i], min(0.0, (-rules.psi_bound - psi[k, n]) / reach[i]))
                high[i] = min(high[i], max(0.0, (rules.psi_bound - psi[k, n]) / reach[i]))
    least = np.inf
    for r in range(rows):
        least = min(least, spare[r])
    near_at, near_by, near_spare = near
    count, most = 0, 1.0
    for r in range(rows):
        span = 0.0
        for j in range(3):
            span += abs(by[r, j]) * reach[at[r, j]]
        most = max(most, span)
        if by[r, 3] == 0.0:
            matters = spare[r] < span
        elif goal == MARGIN:
            matters = spare[r] < least + 2.0 * span
        else:
            matters = spare[r] < 2.0 * span + max(lack, 0.0) + (least if least > 0.0 else 0.0)
        if not matters:
            continue
        greatest = 0.0
        for j in range(WIDTH):
            near_at[count, j] = at[r, j]
            near_by[count, j] = by[r, j] * reach[at[r, j]]
            greatest = max(greatest, abs(near_by[count, j]))
        for j in range(WIDTH):
            near_by[count, j] /= greatest
        near_spare[count] = spare[r] / greatest
        count += 1
    high[size - 2] = 2.0 * (abs(lack) + most)
    low[size - 2] = -high[size - 2] if goal == MARGIN else 0.0
    low[size - 1], high[size - 1] = 0.0, 0.0 if goal == MARGIN else high[size - 2]
    scaled = cost * reach
    scaled[size - 2], scaled[size - 1] = price, -ROOMY * price
    if not solve(scaled, low, high, near_at, near_by, near_spare, count, step):
        return 0.0
    gain = _worth(goal, price, lack) - price * step[size - 2]
    for i in range(size - 2):
        step[i] = min(max(step[i], low[i]), high[i]) * reach[i]
        gain -= cost[i] * step[i]
    return gain
