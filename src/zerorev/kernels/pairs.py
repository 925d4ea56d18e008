"""The best pair of legs out of one point of the target line, and along that line (theory §2, §3).

Both wrist flips of a posture share their legs, so it is a posture that is searched; the flips differ in what their
limits allow.

Lengths in m, angles in rad, rates outwards in rad/m; controller angles. No kernel raises.
`constraints` is a `layout.Constraints` throughout.
"""

from __future__ import annotations

import numpy as np

from zerorev.kernels._jit import kernel, lean
from zerorev.kernels.arm import controller_angles, flip_sign, other_flip, twist_field
from zerorev.kernels.field import ROOM
from zerorev.kernels.leg_search import GOLDEN, MAX_SLOPES, best_leg, most_gained, slope_candidates
from zerorev.kernels.legs import GREATEST_ANGLE, GREATEST_MARGIN, LEAST_ANGLE, PLUNGE_ROTATION, ROWS, TRAVEL, trace_leg
from zerorev.kernels.weigh import SIEVE_ERROR, sift

# columns of what is returned
VALUE, SLOPE_ABOVE, SLOPE_BELOW, MARGIN, BRANCH, SPIN = range(6)
COLUMNS = 6
SAMPLED = 5  # of what `sample_line` returns
MARGIN_SAMPLED, SLOPES_SAMPLED = 1, 3

HOPELESS = 1e6  # what a pair that will not do is worth, at least: the more it lacks, the more


@lean
def turn_choices(principal, constraints):  # type: ignore[no-untyped-def]
    """In how many ways the turns of six joints can be chosen so that the target lies within the limits."""
    choices = 1
    for i in range(6):
        first = np.ceil((constraints.lower[i] - principal[i]) / (2.0 * np.pi))
        last = np.floor((constraints.upper[i] - principal[i]) / (2.0 * np.pi))
        choices *= max(0, int(last - first) + 1)
    return choices


@lean
def take_turns(principal, constraints, choice, at_target):  # type: ignore[no-untyped-def]
    """Joint angles at the target for one of the `turn_choices`, written to `at_target`, shape (6,)."""
    for i in range(6):
        first = np.ceil((constraints.lower[i] - principal[i]) / (2.0 * np.pi))
        options = int(np.floor((constraints.upper[i] - principal[i]) / (2.0 * np.pi)) - first) + 1
        at_target[i] = principal[i] + 2.0 * np.pi * (first + choice % options)
        choice //= options


@kernel
def best_pair(arm, plane, posture, psi_t, keep, constraints, unlimited, branches, mode, nodes, bound, work, out):  # type: ignore[no-untyped-def]
    """The best two legs out of one point of the target line, one on each side of the critical rates.

    Args:
        arm: `ArmGeometry`.
        plane: `TwistPlane`.
        posture: 0..3.
        psi_t: spin at the target [rad].
        keep: whether a joint must keep its direction, shape (6,).
        constraints: `Constraints`.
        unlimited: the same without joint limits.
        branches: whether to examine a branch, shape (8,).
        mode: TRAVEL, GREATEST_MARGIN or PLUNGE_ROTATION.
        nodes: points on a leg.
        bound: a value that is reached elsewhere: where limits aside none is better, they are not examined.
        work: room for `fields`.
        out: out, shape (COLUMNS,): value to be least (inf where no pair is admissible), slope above, slope below, the
            greatest margin that both legs can have (-inf where one cannot be run at all), branch, psi_t.
    """
    kappa, sense, at_target, principal = np.empty(6), np.empty(6), np.empty(6), np.empty((2, 6))
    choices, cs = np.zeros(2, dtype=np.int64), np.empty((6, 2))
    out[:] = np.inf, np.nan, np.nan, -np.inf, -1.0, psi_t
    if not set_out(arm, plane, posture, psi_t, constraints, branches, cs, kappa, sense, principal, choices):
        return

    # The limits seldom bind: search without them first, and keep that answer if some choice of turns brings it within.
    demands = (sense, kappa, keep, at_target)
    _pair_within(arm, plane, 2 * posture, psi_t, demands, unlimited, mode, nodes, work, out)
    if out[MARGIN] == -np.inf:
        return
    if out[VALUE] >= bound:
        # what lacks margin without limits lacks it within them, and what is no better is no better within them
        out[BRANCH] = 2.0 * posture if choices[0] else 2.0 * posture + 1.0
        return
    legs = np.empty((2, ROWS, 6))
    trace_leg(arm, plane, 2 * posture, psi_t, out[SLOPE_ABOVE], constraints.depth, nodes, work, legs[0])
    trace_leg(arm, plane, 2 * posture, psi_t, out[SLOPE_BELOW], constraints.depth, nodes, work, legs[1])
    for flip in range(2):
        if choices[flip] and turns_fit(legs[0], legs[1], flip == 1, principal[flip], constraints):
            out[BRANCH] = 2.0 * posture + flip
            return
    out[:] = np.inf, np.nan, np.nan, -np.inf, -1.0, psi_t
    for flip in range(2):
        if flip == 1:
            sense[4] = -sense[4]
        for choice in range(choices[flip]):
            take_turns(principal[flip], constraints, choice, at_target)
            if _pair_within(arm, plane, 2 * posture + flip, psi_t, demands, constraints, mode, nodes, work, out):
                out[BRANCH] = 2.0 * posture + flip


@lean
def turns_fit(a, b, flipped, principal, constraints):  # type: ignore[no-untyped-def]
    """Whether some turns bring both of two legs within the limits.

    Args:
        a: a leg from `trace_leg`, shape (ROWS, 6); b the other.
        b: see a.
        flipped: whether the legs were followed on the other wrist flip, whose joint 5 moves the other way.
        principal: angles at the target within (-pi, pi], shape (6,).
        constraints: `Constraints`.
    """
    for i in range(6):
        low, high = min(a[LEAST_ANGLE, i], b[LEAST_ANGLE, i]), max(a[GREATEST_ANGLE, i], b[GREATEST_ANGLE, i])
        if flipped and i == 4:
            low, high = -high, -low
        first = np.ceil((constraints.lower[i] - principal[i] - low) / (2.0 * np.pi))
        if not principal[i] + high + 2.0 * np.pi * first <= constraints.upper[i]:
            return False
    return True


@kernel
def _pair_within(arm, plane, branch, psi_t, demands, constraints, mode, nodes, work, out):  # type: ignore[no-untyped-def]
    """`best_pair` for one choice of turns; whether it improved `out`."""
    sense, kappa, keep, at_target = demands
    legs, gentle = np.empty((2, 3)), np.empty((2, 3))
    leg_mode = GREATEST_MARGIN if mode == GREATEST_MARGIN else TRAVEL
    for k in range(2):
        side = 1.0 - 2.0 * k
        to = (side * sense, keep, at_target)
        best_leg(arm, plane, branch, psi_t, side, kappa, to, constraints, leg_mode, nodes, work, legs[k])
        if legs[k, 2] == -np.inf:
            return False
        if mode == PLUNGE_ROTATION and legs[k, 0] < np.inf:
            best_leg(arm, plane, branch, psi_t, side, kappa, to, constraints, mode, nodes, work, gentle[k])
    margin = min(legs[0, 2], legs[1, 2])
    if not (legs[0, 0] < np.inf and legs[1, 0] < np.inf):
        better = out[VALUE] == np.inf and margin > out[MARGIN]
        out[MARGIN] = max(out[MARGIN], margin)
        return better
    out[MARGIN] = max(out[MARGIN], margin)
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
    if not value < out[VALUE]:
        return False
    out[VALUE], out[SLOPE_ABOVE], out[SLOPE_BELOW] = value, above, below
    return True


@kernel
def sample_line(arm, plane, psi, lines, keep, constraints, mode, enough, out):  # type: ignore[no-untyped-def]
    """A coarse sample of the target line: what a few points of a few legs out of each spin of a grid say.

    Args:
        arm: `ArmGeometry`.
        plane: `TwistPlane`.
        psi: spins at the target [rad], shape (K,).
        lines: whether to examine a branch there, shape (8, K).
        keep: whether a joint must keep its direction, shape (6,).
        constraints: `Constraints`.
        mode: PLUNGE_ROTATION, or TRAVEL.
        enough: a margin; where no leg on one side has more, nothing rests on the other side, and it is left out.
        out: out, shape (4, K, SAMPLED): about the least value of pairs that may do (inf: none), what the margin of a
            pair is at most (-inf: none can be run), about the value of the pair that has it, and its slopes.
    """
    work = np.empty(ROOM)
    kappa, sense, principal = np.empty(6), np.empty(6), np.empty((2, 6))
    choices, cs = np.zeros(2, dtype=np.int64), np.empty((6, 2))
    slopes, ceiling, travel = np.empty(MAX_SLOPES), np.empty(MAX_SLOPES), np.empty(MAX_SLOPES)
    ends = np.empty((MAX_SLOPES, 6))
    for posture in range(4):
        for n in range(psi.shape[0]):
            spin = out[posture, n]
            spin[:] = np.inf, -np.inf, np.inf, np.nan, np.nan
            wanted = lines[:, n]
            if not (wanted[2 * posture] or wanted[2 * posture + 1]):
                continue
            if not set_out(arm, plane, posture, psi[n], constraints, wanted, cs, kappa, sense, principal, choices):
                continue
            spin[:3] = 0.0, np.inf, 0.0
            for k in range(2):
                if k == 1 and not spin[1] > enough:
                    break
                side = 1.0 - 2.0 * k
                count = slope_candidates(kappa, keep, side, psi[n], constraints, slopes)
                sift(
                    arm, plane, 2 * posture, psi[n], slopes, count, side * sense, keep, constraints, work, ceiling,
                    travel, ends,
                )  # fmt: skip
                for j in range(count):
                    if mode == PLUNGE_ROTATION:
                        travel[j] = abs(slopes[j])
                    if not _may_fit(ends, j, principal, choices, constraints):
                        ceiling[j], travel[j] = -np.inf, np.inf
                least, greatest, there = np.inf, -np.inf, np.inf
                for j in range(count):
                    if ceiling[j] > greatest:
                        greatest, there, spin[3 + k] = ceiling[j], travel[j], slopes[j]
                    if ceiling[j] < constraints.min_rate:
                        continue
                    least = min(least, travel[j])
                    # the end of an interval, between two candidates, may have less
                    for outside, inside in ((j - 1, j + 1), (j + 1, j - 1)):
                        if (
                            0 <= outside < count
                            and 0 <= inside < count
                            and -np.inf < ceiling[outside] < constraints.min_rate
                        ):
                            share = (ceiling[j] - constraints.min_rate) / (ceiling[j] - ceiling[outside])
                            least = min(least, travel[j] + share * (travel[outside] - travel[j]))
                spin[1] = min(spin[1], greatest)
                if mode == PLUNGE_ROTATION and k == 1:
                    # only one of the two legs has to turn little
                    spin[0] = max(spin[0], least) if max(spin[0], least) == np.inf else min(spin[0], least)
                    spin[2] = min(spin[2], there)
                else:
                    spin[0] += least
                    spin[2] += there


@lean
def _may_fit(ends, leg, principal, choices, constraints):  # type: ignore[no-untyped-def]
    """Whether a leg whose outer end is roughly known may lie within the limits on either wrist flip."""
    for flip in range(2):
        fits = choices[flip] > 0
        for i in range(6):
            if not fits:
                break
            there = (1.0 - SIEVE_ERROR) * (-ends[leg, i] if flip == 1 and i == 4 else ends[leg, i])
            low, high = principal[flip, i] + min(0.0, there), principal[flip, i] + max(0.0, there)
            if not (low >= constraints.lower[i] and high <= constraints.upper[i]):  # else it fits as it is
                first = np.ceil((constraints.lower[i] - low) / (2.0 * np.pi))
                fits = high + 2.0 * np.pi * first <= constraints.upper[i]
        if fits:
            return True
    return False


@lean
def set_out(arm, plane, posture, psi_t, constraints, branches, cs, kappa, sense, principal, choices):  # type: ignore[no-untyped-def]
    """Whether legs can set out from a spin at the target at all.

    Args:
        arm: `ArmGeometry`.
        plane: `TwistPlane`.
        posture: 0..3.
        psi_t: spin at the target [rad].
        constraints: `Constraints`.
        branches: whether to examine a branch, shape (8,).
        cs: out, shape (6, 2): cosines and sines of the model angles.
        kappa: out, shape (6,): critical rates [rad/m].
        sense: out, shape (6,): signs of theta_psi on the unflipped branch.
        principal: out, shape (2, 6): angles within (-pi, pi], of both flips.
        choices: out, shape (2,): `turn_choices` of both flips.
    """
    theta_s, theta_psi = kappa, sense
    if not twist_field(arm, plane, 0.0, psi_t, posture, cs, theta_s, theta_psi) or np.isnan(theta_psi[0]):
        return False
    for i in range(6):
        kappa[i] = -theta_s[i] / theta_psi[i]
        sense[i] = 1.0 if theta_psi[i] > 0.0 else -1.0
    sense[4] *= flip_sign(arm, 2 * posture)
    controller_angles(arm, cs, False, principal[0])
    other_flip(arm, principal[0], principal[1])
    for flip in range(2):
        choices[flip] = turn_choices(principal[flip], constraints) if branches[2 * posture + flip] else 0
    return choices[0] + choices[1] > 0


@kernel
def descend(arm, plane, posture, low, high, keep, constraints, unlimited, branches, mode, nodes, steps, bound, best):  # type: ignore[no-untyped-def]
    """The bottom of a valley of the target line: golden section, first towards admissible pairs, then among them.

    Args:
        arm: `ArmGeometry`.
        plane: `TwistPlane`.
        posture: 0..3.
        low: one end of the valley [rad].
        high: the other.
        keep: whether a joint must keep its direction, shape (6,).
        constraints: `Constraints`.
        unlimited: the same without joint limits.
        branches: whether to examine a branch, shape (8,).
        mode: see `best_pair`.
        nodes: points on a leg.
        steps: of the golden section, at most.
        bound: see `best_pair`.
        best: out, shape (COLUMNS,): the best pair seen, see `best_pair`.
    """
    work, pair = np.empty(ROOM), np.empty(COLUMNS)
    best[:] = np.inf, np.nan, np.nan, -np.inf, -1.0, 0.5 * (low + high)
    x, y = high - GOLDEN * (high - low), low + GOLDEN * (high - low)
    args = (keep, constraints, unlimited, branches, mode, nodes, bound)
    at_x = _worth(arm, plane, posture, x, args, work, pair, best)
    at_y = _worth(arm, plane, posture, y, args, work, pair, best)
    at_low, at_high = np.nan, np.nan
    for _ in range(steps):
        if min(at_x, at_y) - most_gained(low, x, y, high, at_low, at_x, at_y, at_high) >= HOPELESS:
            return  # too little can be gained: it will not get there
        if at_x <= at_y:
            high, at_high = y, at_y
            y, at_y = x, at_x
            x = high - GOLDEN * (high - low)
            at_x = _worth(arm, plane, posture, x, args, work, pair, best)
        else:
            low, at_low = x, at_x
            x, at_x = y, at_y
            y = low + GOLDEN * (high - low)
            at_y = _worth(arm, plane, posture, y, args, work, pair, best)


@kernel
def _worth(arm, plane, posture, psi_t, args, work, pair, best):  # type: ignore[no-untyped-def]
    """The value of the best pair at a spin, or HOPELESS and what it lacks; `best` is improved where it is better."""
    keep, constraints, unlimited, branches, mode, nodes, bound = args
    best_pair(arm, plane, posture, psi_t, keep, constraints, unlimited, branches, mode, nodes, bound, work, pair)
    if pair[VALUE] < best[VALUE] or (best[VALUE] == np.inf and pair[MARGIN] > best[MARGIN]):
        best[:] = pair
    if pair[VALUE] < np.inf:
        return pair[VALUE]
    return HOPELESS + min(constraints.min_rate - pair[MARGIN], HOPELESS) if pair[MARGIN] > -np.inf else np.inf
