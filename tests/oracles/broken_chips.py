"""Motions that break chips, built from the definition (theory §2), and a grid of them."""

from itertools import pairwise

import numpy as np

from zerorev.model.profile import Profile
from zerorev.motion.drilling import joint_rates
from zerorev.motion.evaluation import evaluated

ROUNDS = 6
LEAST_BACK = np.deg2rad(1.0)  # [rad/m] beyond the threshold on a way back
SHORT = 2.5e-3  # [m]: of a shorter piece the two ends are examined


def fields(drilling, branch, standoff, psi):
    """theta_s and theta_psi of one branch, each (N, 6)."""
    theta_s, theta_psi = joint_rates(drilling, np.full(psi.shape, standoff), psi)
    return theta_s[:, branch], theta_psi[:, branch]


def way_back(drilling, settings, branch, at, spin, plunge, retract, back):
    """The slope nearest to the retract's with which no joint turns round where a way back of slopes ends [rad/m], (N,).

    NaN where there is none.
    """
    slope, least = retract, settings.min_rate + LEAST_BACK
    theta_s, theta_psi = fields(drilling, branch, at + back, spin)
    way = -np.sign(theta_s + plunge[:, None] * theta_psi)
    for _ in range(ROUNDS):
        low, high = np.full(spin.shape, -settings.max_twist), np.full(spin.shape, settings.max_twist)
        for s, there in ((at + back, spin), (at, spin - slope * back)):
            theta_s, theta_psi = fields(drilling, branch, s, there)
            bound = (least * way - theta_s) / theta_psi
            low = np.maximum(low, np.where(way * theta_psi > 0, bound, -np.inf).max(axis=1))
            high = np.minimum(high, np.where(way * theta_psi > 0, np.inf, bound).min(axis=1))
        slope = np.where(low <= high, np.clip(retract, low, high), np.nan)
    return slope


def margin(drilling, branch, side, way, piece):
    """How far the slowest joint is from turning round in a piece (s0, s1, spins at s0, slopes) [rad/m], (N,)."""
    s0, s1, psi, slope = piece
    worst = np.full(psi.shape, np.inf)
    for s in np.linspace(s0, s1, 9 if s1 - s0 > SHORT else 2):
        theta_s, theta_psi = fields(drilling, branch, s, psi + slope * (s - s0))
        worst = np.minimum(worst, (way * side * (theta_s + slope[:, None] * theta_psi)).min(axis=1))
    return np.nan_to_num(worst, nan=-np.inf)


def kept(drilling, settings, branch, depth, cycle, psi, plunge, retract):
    """Those of many motions of a depth that break chips and turn no joint round: stand-offs (n,), and spins (n, K)."""
    theta_s, theta_psi = fields(drilling, branch, 0.0, psi)
    side = np.sign(theta_s + plunge[:, None] * theta_psi)
    good = margin(drilling, branch, side, -1, (0.0, depth, psi, retract)) >= settings.min_rate
    side, plunge, retract, spins = side[good], plunge[good], retract[good], [psi[good]]
    end = spins[0] + retract * depth
    standoff = [0.0]
    outer = [*(at for k in cycle.breaks(depth)[::-1] for at in (k + cycle.back, k)), depth]
    for n, (s0, s1) in enumerate(pairwise([0.0, *outer])):
        slope = (
            plunge if n % 2 == 0 else way_back(drilling, settings, branch, s1, spins[-1], plunge, retract, cycle.back)
        )
        good = margin(drilling, branch, side, 1 - 2 * (n % 2), (s0, s1, spins[-1], slope)) >= settings.min_rate
        spins = [each[good] for each in (*spins, spins[-1] + slope * (s1 - s0))]
        side, plunge, retract, end = side[good], plunge[good], retract[good], end[good]
        standoff.append(s1)
        if end.size == 0:
            break
    return np.array([*standoff[::-1], depth]), np.array([*spins[::-1], end])


def any_on_a_grid(drilling, settings, depth, cycle, spins=72, slopes=14, steepest=40.0):
    """A motion of a depth of a grid of spins and slopes that breaks chips without a reversal, and its branch; or None.

    Args:
        drilling: robot, tool and hole.
        settings: with the motion threshold.
        depth: [m].
        cycle: how often and how far the tool draws back.
        spins: of the grid in a turn.
        slopes: of the grid, to either side of the critical rates.
        steepest: beyond these [rad/m].
    """
    grid = np.linspace(-np.pi, np.pi, spins, endpoint=False)
    beyond = np.geomspace(0.05, steepest, slopes)
    for branch in range(0, 8, 2):
        theta_s, theta_psi = fields(drilling, branch, 0.0, grid)
        kappa = -theta_s / theta_psi
        low, high = kappa.min(axis=1)[:, None, None], kappa.max(axis=1)[:, None, None]
        psi, above, below = (
            each.ravel() for each in np.broadcast_arrays(grid[:, None, None], high + beyond[:, None], low - beyond)
        )
        able = np.maximum(np.abs(above), np.abs(below)) * depth < 2 * np.pi  # False of a NaN, too
        for plunge, retract in ((above[able], below[able]), (below[able], above[able])):
            standoff, found = kept(drilling, settings, branch, depth, cycle, psi[able], plunge, retract)
            for k in range(found.shape[1]):
                for flip in (branch, branch + 1):
                    profile = Profile(standoff, found[:, k])
                    score = evaluated(drilling.deep(depth), profile, flip, settings).score
                    if score is not None and score.reversals == 0 and score.min_rate.min() >= settings.min_rate:
                        return profile, flip
    return None
