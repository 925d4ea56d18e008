"""Free legs: how deep two legs out of one point of the target line get, and where they end (theory §4).

At one spin at the target the two legs are independent: one lies above the critical rates there, the other below them.
Each has its tube (`kernels.tube`), made with no heed of the joint limits: on a leg that keeps its directions no joint
that has passed a limit comes back within, so that limits are a matter of where the leg ends.

Lengths in m, angles in rad, slopes outwards in rad/m; controller angles. No kernel raises.
"""

from __future__ import annotations

import numpy as np

from zerorev.kernels._jit import kernel
from zerorev.kernels.arm import controller_angles, flip_sign, twist_field
from zerorev.kernels.field import BLOCK, PSI, STANDOFF, THETA_PSI, fields
from zerorev.kernels.legs import TRAVEL
from zerorev.kernels.order import order_of
from zerorev.kernels.pairs import take_turns, turn_choices
from zerorev.kernels.tube import KEPT, LEAST_NODES, MAX_ROWS, WIDTH, admissible, march, workspace

BACK = 0.5  # [rad] more than steps that are too long can move a joint the wrong way
ENDS = 17  # spins examined on an interval of the last row


@kernel
def signs_at(arm, plane, posture, psi_t, constraints, room, sense):  # type: ignore[no-untyped-def]
    """The signs of theta_psi at the target: which way each joint moves outwards on the leg above the critical rates.

    Args:
        arm: `ArmGeometry`.
        plane: `TwistPlane`.
        posture: 0..3.
        psi_t: spin at the target [rad].
        constraints: `Constraints`.
        room: as `living` takes it.
        sense: out, shape (6,).

    Returns:
        whether legs can set out on both sides.
    """
    work, lo, hi, spare = room
    work[STANDOFF * BLOCK], work[PSI * BLOCK] = 0.0, psi_t
    fields(arm, plane, posture, 1, work)
    for i in range(6):
        sense[i] = 1.0 if work[(THETA_PSI + i) * BLOCK] > 0.0 else -1.0
    admissible(work, 1, sense, constraints, lo, hi, spare)
    sets_out = lo[0] <= hi[0]
    admissible(work, 1, -sense, constraints, lo, hi, spare)
    return sets_out and lo[0] <= hi[0]


@kernel
def begin(tube, psi_t):  # type: ignore[no-untyped-def]
    """The first row of a tube: one spin at the target."""
    tube[0, 0], tube[0, 1] = 0.0, 1
    tube[0, 2] = tube[0, 3] = psi_t


@kernel
def free_depth(arm, plane, posture, psi_t, sense, constraints, grain, longest, room, tubes, rows):  # type: ignore[no-untyped-def]
    """How deep the two legs out of one point of the target line get, limits left aside.

    Args:
        arm: `ArmGeometry`.
        plane: `TwistPlane`.
        posture: 0..3.
        psi_t: spin at the target [rad].
        sense: out, shape (6,): see `signs_at`.
        constraints: `Constraints`.
        grain: `Grain`.
        longest: where to stop [m].
        room: as `living` takes it.
        tubes: out, shape (2, MAX_ROWS, WIDTH): of the leg above and of the one below the critical rates.
        rows: out, shape (2,): of each tube.

    Returns:
        the depth [m]; 0 where there are no two legs.
    """
    if not signs_at(arm, plane, posture, psi_t, constraints, room, sense):
        return 0.0
    rows[:] = 1
    depth = 0.0
    begin(tubes[0], psi_t)
    begin(tubes[1], psi_t)
    # a stretch at a time, so that no leg is followed much farther than the other gets
    stretch = min(longest, 4.0 * grain.step)
    while True:
        depth = stretch
        for k in range(2):
            side = (1.0 - 2.0 * k) * sense
            rows[k] = march(
                arm, plane, posture, side, constraints, grain, depth, room, tubes[k], rows[k]
            )  # fmt: skip
            depth = min(depth, tubes[k, rows[k] - 1, 0])
        if depth < stretch or stretch >= longest:
            return depth
        stretch = min(longest, 2.0 * stretch)


@kernel
def slack_within(arm, plane, s, psi, branch, side, at_target, constraints):  # type: ignore[no-untyped-def]
    """How much farther the joints may move before one of them meets its limit, and how far they have come.

    On a leg that keeps its directions each joint only ever moves away from where it is at the target, so that the
    limit on that side alone counts, and where it is tells how far it has come.

    Args:
        arm: `ArmGeometry`.
        plane: `TwistPlane`.
        s: stand-off [m].
        psi: spin [rad].
        branch: 0..7.
        side: signs of the outward rates on the unflipped wrist, shape (6,).
        at_target: joint angles at the target with their turns [rad], shape (6,).
        constraints: `Constraints`.

    Returns:
        the least room of a joint [rad], below 0 beyond its limit; and what all joints have moved together [rad].
    """
    cs, theta_s, theta_psi, angle = np.empty((6, 2)), np.empty(6), np.empty(6), np.empty(6)
    if not twist_field(arm, plane, s, psi, branch // 2, cs, theta_s, theta_psi):
        return -np.inf, np.inf
    controller_angles(arm, cs, branch % 2 == 1, angle)
    slack, travel = np.inf, 0.0
    for i in range(6):
        direction = side[i] * flip_sign(arm, branch) if i == 4 else side[i]
        room = constraints.upper[i] - at_target[i] if direction > 0.0 else at_target[i] - constraints.lower[i]
        moved = direction * (angle[i] - at_target[i])
        # the whole turns that it may be off by; a joint that all but stands still may seem to have moved back
        moved -= 2.0 * np.pi * np.floor((moved + BACK) / (2.0 * np.pi))
        slack = min(slack, room - moved)
        travel += moved
    return slack, travel


@kernel
def _some_within(arm, plane, row, after, share, branch, side, at_target, constraints):  # type: ignore[no-untyped-def]
    """Whether some spin of a tube, a share of the way from one row to the next, is within the limits."""
    s = row[0] + share * (after[0] - row[0])
    for k in range(int(row[1])):
        a, b = row[2 + 2 * k], row[3 + 2 * k]
        if share > 0.0:
            a, b = a + share * (after[2 + 2 * k] - a), b + share * (after[3 + 2 * k] - b)
        for n in range(LEAST_NODES):
            psi = a + (b - a) * n / (LEAST_NODES - 1)
            if slack_within(arm, plane, s, psi, branch, side, at_target, constraints)[0] >= 0.0:
                return True
    return False


@kernel
def depth_within(arm, plane, branch, side, at_target, constraints, finest, tube, rows):  # type: ignore[no-untyped-def]
    """How far legs get within the joint limits, given the tube of those that heed none.

    No leg that has passed a limit comes back within, so that what counts is where a leg ends, and the last row that
    has a spin within is found by bisection.

    Args:
        arm: `ArmGeometry`.
        plane: `TwistPlane`.
        branch: 0..7.
        side: signs of the outward rates on the unflipped wrist, shape (6,).
        at_target: joint angles at the target with their turns [rad], shape (6,).
        constraints: `Constraints`.
        finest: to which the stand-off is closed in on [m].
        tube: shape (MAX_ROWS, WIDTH).
        rows: how many it has.

    Returns:
        the stand-off [m].
    """
    inside, outside = 0, rows - 1
    if _some_within(arm, plane, tube[outside], tube[outside], 0.0, branch, side, at_target, constraints):
        return tube[outside, 0]
    while outside - inside > 1:
        middle = (inside + outside) // 2
        if _some_within(arm, plane, tube[middle], tube[middle], 0.0, branch, side, at_target, constraints):
            inside = middle
        else:
            outside = middle
    row, after = tube[inside], tube[outside]
    low, high = 0.0, 1.0
    if row[1] == after[1]:
        while (high - low) * (after[0] - row[0]) > finest:
            middle = 0.5 * (low + high)
            if _some_within(arm, plane, row, after, middle, branch, side, at_target, constraints):
                low = middle
            else:
                high = middle
    return row[0] + low * (after[0] - row[0])


@kernel
def limited_depth(arm, plane, branch, psi_t, sense, constraints, finest, tubes, rows, at_target):  # type: ignore[no-untyped-def]
    """How deep the two legs get within the joint limits of one branch, for the choice of turns that gets deepest.

    Args:
        arm: `ArmGeometry`.
        plane: `TwistPlane`.
        branch: 0..7.
        psi_t: spin at the target [rad].
        sense: as `free_depth` leaves it.
        constraints: `Constraints`.
        finest: to which the depth is closed in on [m].
        tubes: as `free_depth` leaves them, shape (2, MAX_ROWS, WIDTH).
        rows: of each tube, shape (2,).
        at_target: out, shape (6,): joint angles at the target with those turns [rad].

    Returns:
        the depth [m]; 0 where no turns bring the target within the limits.
    """
    cs, theta_s, theta_psi = np.empty((6, 2)), np.empty(6), np.empty(6)
    principal, trial = np.empty(6), np.empty(6)
    twist_field(arm, plane, 0.0, psi_t, branch // 2, cs, theta_s, theta_psi)
    controller_angles(arm, cs, branch % 2 == 1, principal)
    deepest = 0.0
    for choice in range(turn_choices(principal, constraints)):
        take_turns(principal, constraints, choice, trial)
        depth = np.inf
        for k in range(2):
            side = (1.0 - 2.0 * k) * sense
            depth = min(depth, depth_within(arm, plane, branch, side, trial, constraints, finest, tubes[k], rows[k]))
        if depth > deepest:
            deepest = depth
            at_target[:] = trial
    return deepest


@kernel
def depth_at(arm, plane, branch, psi_t, constraints, grain, longest, room, tubes, rows, sense, at_target):  # type: ignore[no-untyped-def]
    """`free_depth` within the limits of one branch (`limited_depth`)."""
    depth = free_depth(arm, plane, branch // 2, psi_t, sense, constraints, grain, longest, room, tubes, rows)
    if depth > 0.0:
        depth = limited_depth(arm, plane, branch, psi_t, sense, constraints, grain.finest, tubes, rows, at_target)
    return depth


@kernel
def ends_within(arm, plane, branch, side, at_target, constraints, row, psi, travel):  # type: ignore[no-untyped-def]
    """The spins of a row of a tube at which a leg may end, and what the joints move on the way there.

    Args:
        arm: `ArmGeometry`.
        plane: `TwistPlane`.
        branch: 0..7.
        side: signs of the outward rates on the unflipped wrist, shape (6,).
        at_target: joint angles at the target with their turns [rad], shape (6,).
        constraints: `Constraints`.
        row: of a tube, shape (WIDTH,).
        psi: out, shape (KEPT, ENDS) [rad].
        travel: out, shape (KEPT, ENDS) [rad]; inf beyond the limits, and where there is no interval.
    """
    travel[:] = np.inf
    for k in range(int(row[1])):
        for n in range(ENDS):
            psi[k, n] = row[2 + 2 * k] + (row[3 + 2 * k] - row[2 + 2 * k]) * n / (ENDS - 1)
            slack, moved = slack_within(arm, plane, row[0], psi[k, n], branch, side, at_target, constraints)
            if slack >= 0.0:
                travel[k, n] = moved


@kernel
def value_at(arm, plane, branch, psi_t, constraints, grain, depth, mode, room, tubes, rows, sense, at_target):  # type: ignore[no-untyped-def]
    """What the best two legs of a given depth are worth; inf where there are none.

    Args:
        arm: `ArmGeometry`.
        plane: `TwistPlane`.
        branch: 0..7.
        psi_t: spin at the target [rad].
        constraints: `Constraints`.
        grain: `Grain`.
        depth: [m].
        mode: TRAVEL: what the joints move in all; PLUNGE_ROTATION: what the tool turns on the leg on which it turns
            less.
        room: as `living` takes it.
        tubes: out, shape (2, MAX_ROWS, WIDTH).
        rows: out, shape (2,).
        sense: out, shape (6,): see `signs_at`.
        at_target: out, shape (6,): the joints at the target with the best choice of turns [rad].
    """
    value = np.inf
    if free_depth(arm, plane, branch // 2, psi_t, sense, constraints, grain, depth, room, tubes, rows) < depth:
        return value
    cs, theta_s, theta_psi = np.empty((6, 2)), np.empty(6), np.empty(6)
    principal, trial, psi, travel = np.empty(6), np.empty(6), np.empty((KEPT, ENDS)), np.empty((KEPT, ENDS))
    twist_field(arm, plane, 0.0, psi_t, branch // 2, cs, theta_s, theta_psi)
    controller_angles(arm, cs, branch % 2 == 1, principal)
    for choice in range(turn_choices(principal, constraints)):
        take_turns(principal, constraints, choice, trial)
        total, turn = 0.0, np.inf
        for k in range(2):
            side = (1.0 - 2.0 * k) * sense
            ends_within(arm, plane, branch, side, trial, constraints, tubes[k, rows[k] - 1], psi, travel)
            total += travel.min()
            for n in range(KEPT * ENDS):
                if travel.flat[n] < np.inf:
                    turn = min(turn, abs(psi.flat[n] - psi_t))
        worth = total if mode == TRAVEL or total == np.inf else turn
        if worth < value:
            value = worth
            at_target[:] = trial
    return value


@kernel
def scan(arm, plane, psi, branches, constraints, grain, longest, worth, out):  # type: ignore[no-untyped-def]
    """Depths along the target line in all branches.

    Args:
        arm: `ArmGeometry`.
        plane: `TwistPlane`.
        psi: spins at the target [rad], shape (K,).
        branches: which of the eight to examine, shape (8,).
        constraints: `Constraints`.
        grain: `Grain`.
        longest: where to stop [m].
        worth: share of the greatest depth below which the limits are not looked into.
        out: out, shape (8, K): depth [m]; 0 where it is not worth examining.
    """
    count = psi.shape[0]
    room, tubes, rows = workspace(), np.empty((2, MAX_ROWS, WIDTH)), np.empty(2, np.int64)
    depths, sense, at_target = np.zeros(4 * count), np.empty(6), np.empty(6)
    for posture in range(4):
        if branches[2 * posture] or branches[2 * posture + 1]:
            for n in range(count):
                depths[posture * count + n] = free_depth(
                    arm, plane, posture, psi[n], sense, constraints, grain, longest, room, tubes, rows
                )  # fmt: skip
    out[:] = 0.0
    deepest = 0.0
    # deepest first: what limits leave of a leg is never deeper than the leg
    for place in order_of(depths)[::-1]:
        posture, n = place // count, place % count
        if depths[place] <= worth * deepest:
            break
        for branch in range(2 * posture, 2 * posture + 2):
            if branches[branch]:
                out[branch, n] = depth_at(
                    arm, plane, branch, psi[n], constraints, grain, longest, room, tubes, rows, sense, at_target
                )  # fmt: skip
                deepest = max(deepest, out[branch, n])
