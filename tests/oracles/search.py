"""The slow twin of the search: every plan on a grid of (psi_s, psi_t, psi_e), as pairs of legs (theory §3).

It knows no critical rates, no intervals and no valleys: legs are sampled, their reversals counted, and all pairs out of
one spin at the target are examined. What it finds is there; what it does not find may still be.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from zerorev.model.hole import Hole
from zerorev.model.profile import Profile
from zerorev.motion import kinematics
from zerorev.motion.drilling import Drilling, joint_rates
from zerorev.motion.evaluation import evaluate

FULL_TURN = 2 * np.pi
NIL = np.deg2rad(1e-6)  # [rad/m]


@dataclass(frozen=True)
class GridPlan:
    """One plan of the grid, as `evaluate` sees it."""

    cost: float
    travel: float
    branch: int
    profile: Profile

    @property
    def key(self):
        return round(self.cost, 9), self.travel


@dataclass(frozen=True)
class Legs:
    """All legs out of all spins at the target: first axis psi_t, second the twist of the leg, third the branch.

    Attributes:
        psi_t: shape (K,).
        twist: psi at the outer end less psi_t, shape (L,).
        runs: whether a branch reaches all along, shape (K, L, 8).
        inside: reversals within the leg, shape (K, L, 8, 6).
        signature: sign of the outward rate at the target, shape (K, L, 8, 6).
        least: rate nearest to rest, shape (K, L, 8, 6).
        low: least angle, target's within (-pi, pi], shape (K, L, 8, 6); high likewise.
        travel: sum of the angles moved, shape (K, L, 8).
    """

    psi_t: np.ndarray
    twist: np.ndarray
    runs: np.ndarray
    inside: np.ndarray
    signature: np.ndarray
    least: np.ndarray
    low: np.ndarray
    high: np.ndarray
    travel: np.ndarray


def trace_legs(robot, tool, hole, psi_t, twist, *, nodes=33):
    """`Legs` of a grid."""
    standoff = np.linspace(0.0, hole.depth, nodes)
    share = standoff / hole.depth
    shape = (psi_t.size, twist.size, 8)
    runs, travel = np.zeros(shape, bool), np.zeros(shape)
    inside, signature = np.zeros((*shape, 6), int), np.zeros((*shape, 6), int)
    least, low, high = np.zeros((3, *shape, 6))
    T_tcp_flange = np.linalg.inv(tool.T_flange_tcp)
    for k, target in enumerate(psi_t):
        psi = target + twist[:, None] * share
        slope = (twist / hole.depth)[:, None, None, None]
        theta_s, theta_psi = joint_rates(Drilling(robot, tool, hole), np.broadcast_to(standoff, psi.shape), psi)
        rates = np.moveaxis(theta_s + slope * theta_psi, 1, -1)  # (L, 8, 6, nodes)
        joints = kinematics.inverse(robot, kinematics.tcp_pose(hole, standoff, psi) @ T_tcp_flange)
        runs[k] = np.isfinite(rates).all(axis=(2, 3)) & np.isfinite(joints).all(axis=(1, 3))
        joints = np.unwrap(joints, axis=1)
        steps = np.abs(np.diff(joints, axis=1))
        runs[k] &= np.nan_to_num(steps, nan=9.0).max(axis=(1, 3)) < 0.5
        sign = np.where(np.abs(rates) > NIL, np.sign(rates), 0)
        inside[k] = (sign[..., 1:] * sign[..., :-1] < 0).sum(axis=-1)
        signature[k] = np.nan_to_num(sign[..., 0])
        least[k] = np.abs(rates).min(axis=-1)
        low[k], high[k] = joints.min(axis=1), joints.max(axis=1)
        travel[k] = steps.sum(axis=(1, 3))
    return Legs(psi_t, twist, runs, inside, signature, least, low, high, travel)


def turns_fit(low, high, limits):
    """Whether whole turns bring extents (..., 6) within the limits."""
    first = np.ceil((limits.lower - low) / FULL_TURN)
    return (high + first * FULL_TURN <= limits.upper).all(axis=-1)


def pairs(robot, legs, k, branch, weights):
    """Weighted reversals and travel of all pairs (plunge, retract) at one spin, shape (L, L); inf if not to run."""
    signature, inside = legs.signature[k, :, branch], legs.inside[k, :, branch]
    at_target = (signature[:, None] * signature[None] > 0).astype(int)
    reversals = at_target + inside[:, None] + inside[None]
    cost = reversals @ np.asarray(weights, float)
    travel = legs.travel[k, :, None, branch] + legs.travel[k, None, :, branch]
    low = np.minimum(legs.low[k, :, None, branch], legs.low[k, None, :, branch])
    high = np.maximum(legs.high[k, :, None, branch], legs.high[k, None, :, branch])
    runs = legs.runs[k, :, branch]
    possible = runs[:, None] & runs[None] & turns_fit(low, high, robot.limits)
    return np.where(possible, cost, np.inf), np.where(possible, travel, np.inf)


def best_on_grid(robot, tool, hole, *, spins=40, weights=(1.0,) * 6, bound=None, offset=0.0, examined=60):
    """The best plan of a grid of spins [rad] by (weighted reversals, travel), or None where none can be run.

    The sampled counts may miss a pair of reversals between two nodes, so plans are taken up in the order of what they
    seem to be, and the best of what they are is returned.

    Args:
        robot: the arm.
        tool: the drill.
        hole: what is drilled; on its branch alone, if it names one.
        spins: at the target, in one turn.
        weights: of the joints' reversals.
        bound: the spins lie within +- this, or anywhere.
        offset: moves the grid, in steps of it.
        examined: how many plans are evaluated at most.
    """
    if bound is None:
        step = FULL_TURN / spins
        psi_t = (np.arange(spins) + offset) * step - np.pi
        twist = np.arange(-spins + 1, spins) * step
    else:
        psi_t = np.linspace(-bound, bound, spins)
        twist = np.arange(-spins + 1, spins) * (psi_t[1] - psi_t[0])
    legs = trace_legs(robot, tool, hole, psi_t, twist)
    branches = range(8) if hole.branch is None else (hole.branch,)
    found = []
    for k in range(psi_t.size):
        for branch in branches:
            if not legs.runs[k, :, branch].any():
                continue
            cost, travel = pairs(robot, legs, k, branch, weights)
            if bound is not None:
                out = np.abs(psi_t[k] + twist) > bound + 1e-9
                cost[out], cost[:, out] = np.inf, np.inf
            # the best few pairs of each column of the grid
            order = np.lexsort((travel.ravel(), cost.round(9).ravel()))[:4]
            found += [(cost.flat[n], travel.flat[n], k, branch, *np.unravel_index(n, cost.shape)) for n in order]
    best = None
    candidates = sorted(candidate for candidate in found if np.isfinite(candidate[0]))
    for cost, travel, k, branch, p, r in candidates[:examined]:
        if best is not None and (round(cost, 9), travel) >= best.key:
            break
        profile = Profile.straight(hole.depth, psi_t[k] + twist[p], psi_t[k], psi_t[k] + twist[r])
        score = evaluate(robot, tool, hole, profile, branch).score
        if score is None:
            continue
        plan = GridPlan(float(np.dot(weights, score.reversals_per_joint)), score.travel, branch, profile)
        if best is None or plan.key < best.key:
            best = plan
    return best


def random_hole(robot, seed):
    """A hole somewhere around a robot, oblique or along +X, of a depth that often asks for a reversal."""
    rng = np.random.default_rng(seed)
    reach = robot.arm.c2 + np.hypot(robot.arm.c3, robot.arm.a2)
    while True:
        up = robot.arm.c1 + rng.uniform(-0.6, 0.7) * reach
        target = np.array([rng.uniform(0.1, 0.9) * reach, rng.uniform(-0.7, 0.7) * reach, up])
        direction = rng.normal(size=3)
        direction /= np.linalg.norm(direction)
        if rng.random() < 0.5:
            direction = np.array([1.0, 0.0, 0.0]) + 0.5 * direction
        if abs(direction[1]) < 0.95 * np.linalg.norm(direction):
            depth = rng.choice([10, 20, 30, 50, 80, 120, 180]) / 1e3 * reach / 0.7
            return Hole(f"hole {seed}", target, direction, depth)


def best_without_reversal(robot, tool, hole, value, *, spins=40, min_rate=NIL):
    """The least `value` over the grid's plans without reversal that keep the motion threshold at every node, or inf.

    Args:
        robot: the arm.
        tool: the drill.
        hole: what is drilled.
        value: of (twist of one leg, twist of the other, least rate), arrays of shape (L, L).
        spins: at the target, in one turn.
        min_rate: motion threshold [rad/m].
    """
    step = FULL_TURN / spins
    twist = np.arange(-spins + 1, spins) * step
    legs = trace_legs(robot, tool, hole, np.arange(spins) * step - np.pi, twist)
    slowest = legs.least.min(axis=-1)
    best = np.inf
    for k in range(spins):
        for branch in range(8):
            cost, _ = pairs(robot, legs, k, branch, np.ones(6))
            least = np.minimum(slowest[k, :, None, branch], slowest[k, None, :, branch])
            values = value(twist[:, None], twist[None], least)
            best = min(best, np.where((cost == 0) & (least >= min_rate), values, np.inf).min())
    return best


def least_rate(robot, tool, hole, branch, profile, nodes=400):
    """Slowest motion of any joint of a motion of two straight legs [rad/m]; below 0 where one reverses."""
    standoff = np.linspace(0.0, hole.depth, nodes)
    slopes = profile.twist_rate
    rates = []
    for slope, sense in zip(slopes, (-1.0, 1.0), strict=True):
        theta_s, theta_psi = joint_rates(Drilling(robot, tool, hole), standoff, profile.psi[1] + slope * standoff)
        rates.append(sense * (theta_s + slope * theta_psi)[:, branch])
    rates = np.concatenate(rates)
    return float((rates * np.sign(rates.sum(axis=0))).min())
