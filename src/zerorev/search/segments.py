"""Legs of a few straight segments, bettered together by sequential linear programming (theory §4).

The unknowns are the depth and the spins at all breakpoints of both legs, the target among them. The rates of the joints
at points along the segments are very nearly linear functions of them within a small region, and so are the joints at
the outer ends; a linear programme goes as far as it can within that region. Each step counts only if it betters the
goal, with what the rates lack added at a price; the region grows and shrinks by how well the step was foretold.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, NamedTuple

import numpy as np

from zerorev.kernels import segments as kernels
from zerorev.kernels.arm import controller_angles, flip_sign, twist_field
from zerorev.kernels.free import BACK
from zerorev.kinematics import TwistPlane
from zerorev.model._arrays import Array
from zerorev.model.profile import Profile
from zerorev.model.robot import ArmGeometry

__all__ = ["Goal", "Legs", "Rules", "bettered", "legs_through", "motion_of"]

Goal = Literal["depth", "travel", "margin", "plunge_rotation"]

LOOKS = 9  # points of a segment at which the joints are looked at
SHARES = 0.5 - 0.5 * np.cos(np.linspace(0, np.pi, LOOKS))
STEPS = 120
TRUSTED_TURN = 0.2  # [rad] by which a spin moves in one step, at most
TRUSTED_STRETCH = 0.1  # by which the depth changes, relative
LEAST_TRUST = 1e-4  # share of the two
GUARD = float(np.deg2rad(0.2))  # [rad/m] 0.0002 deg/mm aimed at beyond the threshold, for what lies between the points
TOLERANCE = 1e-6  # [rad] more than a linear programme is off by
OPTIONS = {"presolve": False}
ENOUGH = 2e-5  # relative: less is no gain


class Rules(NamedTuple):
    """What two legs are held to; SI units.

    Attributes:
        arm: of the robot.
        plane: of the hole.
        branch: 0..7.
        sense: signs of the outward rates of the first leg on the unflipped wrist, shape (6,).
        at_target: joints at the target with their turns, as far as known [rad], shape (6,).
        lower: limits of the joints [rad], shape (6,).
        upper: likewise.
        min_rate: of any joint [rad/m].
        steepest: twist rate [rad/m].
        psi_bound: spins within +- this [rad]; 0: periodic.
    """

    arm: ArmGeometry
    plane: TwistPlane
    branch: int
    sense: Array
    at_target: Array
    lower: Array
    upper: Array
    min_rate: float
    steepest: float
    psi_bound: float


@dataclass(frozen=True)
class Legs:
    """Two legs of K segments each out of one point of the target line, on either side of the critical rates.

    Attributes:
        standoff: breakpoints from the target outwards [m], shape (2, K + 1); the last two are the same.
        psi: their spins [rad], shape (2, K + 1); the first two are the same.
    """

    standoff: Array
    psi: Array

    @property
    def depth(self) -> float:
        """Length of both [m]."""
        return float(self.standoff[0, -1])


def legs_through(tubes: list[Array], narrowed: list[Array], segments: int) -> Legs:
    """Two legs through the middles of narrowed tubes.

    Args:
        tubes: rows of each, shape (rows, WIDTH).
        narrowed: what `kernels.segments.narrow` leaves of them, shape (rows, 2).
        segments: of each leg.
    """
    standoff, psi = np.empty((2, 2, segments + 1))
    for k, (tube, viable) in enumerate(zip(tubes, narrowed, strict=True)):
        knots = np.empty(segments + 1, dtype=np.int64)
        kernels.place_knots(tube, len(tube), viable, knots)
        standoff[k], psi[k] = tube[knots, 0], viable[knots].mean(axis=1)
    psi[:, 0] = psi[:, 0].mean()
    return Legs(standoff, psi)


def motion_of(legs: Legs, *, periodic: bool) -> Profile:
    """The motion of two legs; of the two twins the one that turns the tool less while it cuts (theory §2).

    Args:
        legs: the two.
        periodic: whether full turns of the tool do not matter: the spin at the target is then within (-pi, pi].
    """
    plunge, retract = np.argsort(np.abs(legs.psi[:, -1] - legs.psi[:, 0]), kind="stable")
    standoff = np.concatenate([legs.standoff[plunge, ::-1], legs.standoff[retract, 1:]])
    psi = np.concatenate([legs.psi[plunge, ::-1], legs.psi[retract, 1:]])
    if periodic:
        psi = psi - 2 * np.pi * np.ceil((legs.psi[0, 0] - np.pi) / (2 * np.pi))
    return Profile(standoff, psi)


def bettered(rules: Rules, legs: Legs, goal: Goal) -> Legs | None:
    """The best legs to be had from these by small steps.

    Args:
        rules: what they are held to.
        legs: to begin with; they need not keep the rules.
        goal: `depth`: as deep as can be; the others keep the depth: least `travel`, greatest `margin`, or the least
            `plunge_rotation` of the two.

    Returns:
        None where none are found that keep the rules.
    """
    problem = _Problem(rules, goal, legs)
    look, trust = problem.look(legs), 0.5
    for _ in range(STEPS):
        step, foretold = problem.step(legs, look, trust)
        if foretold < ENOUGH * problem.scale:
            break
        trial = problem.moved(legs, step)
        there = problem.look(trial)
        gain = problem.worth(look.lack) - problem.worth(there.lack) - float(look.cost @ step)
        if gain > 0.6 * foretold:
            trust = min(1.0, 2 * trust)
        elif not gain > 0.1 * foretold:
            trust *= 0.4
        if gain > 0.1 * foretold:
            legs, look = trial, there
        elif trust < LEAST_TRUST:
            break
    return legs if look.lack <= GUARD else None


class _Look(NamedTuple):
    """Legs looked at: what their joints do, and how that changes with the unknowns.

    Attributes:
        rates: in the wanted direction [rad/m], shape (N,).
        rates_by: their derivatives, shape (N, unknowns).
        room: of the joints at the outer ends to their limits [rad], shape (12,).
        room_by: their derivatives, shape (12, unknowns).
        cost: derivatives of what is to be least, shape (unknowns,).
        lack: greatest of what any rate or room lacks; below 0 where nothing does.
    """

    rates: Array
    rates_by: Array
    room: Array
    room_by: Array
    cost: Array
    lack: float


class _Problem:
    """The linear programmes of one hole.

    Unknowns are the depth, the spin at the target, then the other spins of each leg. The stand-offs of the breakpoints
    change in proportion to the depth.
    """

    def __init__(self, rules: Rules, goal: Goal, legs: Legs) -> None:
        self.rules, self.goal = rules, goal
        self.segments = legs.standoff.shape[1] - 1
        self.size = 2 + 2 * self.segments
        self.share = legs.standoff / legs.depth
        # which unknown is the spin of a breakpoint
        self.at = np.column_stack([np.ones(2, dtype=int), np.arange(2, self.size).reshape(2, -1)])
        self.scale = {"depth": legs.depth, "margin": rules.min_rate + GUARD}.get(goal, 1.0)
        # one unit of rate or room that is lacking, against the goal: more than any exchange of the two is worth
        self.price = {"depth": 10 * legs.depth, "margin": 1.0}.get(goal, 30.0)

    def worth(self, lack: float) -> float:
        """What is lacking, at its price; margin is the one goal for which to lack less than nothing is worth more."""
        return self.price * (lack if self.goal == "margin" else max(lack, 0.0))

    def moved(self, legs: Legs, step: Array) -> Legs:
        """Legs with their unknowns changed."""
        return Legs(self.share * (legs.depth + step[0]), legs.psi + step[self.at])

    def look(self, legs: Legs) -> _Look:
        """All that a linear programme needs to know of legs."""
        rules, posture = self.rules, self.rules.branch // 2
        shape = (2, self.segments, LOOKS, 6)
        rates, by = np.empty((*shape, 5)), np.zeros((*shape, self.size))
        room, room_by, cost = np.empty((2, 6)), np.zeros((2, 6, self.size)), np.zeros(self.size)
        cs, theta_s, theta_psi, angles = np.empty((6, 2)), np.empty(6), np.empty(6), np.empty(6)
        for k in range(2):
            side = (1 - 2 * k) * rules.sense
            kernels.linearise(rules.arm, rules.plane, posture, side, legs.standoff[k], legs.psi[k], SHARES, rates[k])
            for n in range(self.segments):
                by[k, n][..., 0] = rates[k, n][..., 1::2] @ self.share[k, n : n + 2]
                by[k, n][..., self.at[k, n : n + 2]] = rates[k, n][..., 2::2]
            end = self.at[k, -1]
            if not twist_field(rules.arm, rules.plane, legs.depth, legs.psi[k, -1], posture, cs, theta_s, theta_psi):
                rates[k] = np.nan
            controller_angles(rules.arm, cs, rules.branch % 2 == 1, angles)
            direction = side.copy()
            direction[4] *= flip_sign(rules.arm, rules.branch)
            moved = direction * (angles - rules.at_target)
            moved -= 2 * np.pi * np.floor((moved + BACK) / (2 * np.pi))
            room[k] = np.where(direction > 0, rules.upper - rules.at_target, rules.at_target - rules.lower) - moved
            room_by[k, :, 0], room_by[k, :, end] = -side * theta_s, -side * theta_psi
            if self.goal == "travel":
                cost[end] = side @ theta_psi
        if self.goal == "depth":
            cost[0] = -1.0
        elif self.goal == "plunge_rotation":
            turns = legs.psi[:, -1] - legs.psi[:, 0]
            k = int(np.argmin(np.abs(turns)))
            cost[self.at[k, -1]], cost[1] = np.sign(turns[k]), -np.sign(turns[k])
        flat = np.nan_to_num(rates[..., 0].ravel(), nan=-np.inf)
        lack = max(float(rules.min_rate + GUARD - flat.min()), float(-room.min()))
        return _Look(flat, by.reshape(flat.size, -1), room.ravel(), room_by.reshape(12, -1), cost, lack)

    def step(self, legs: Legs, look: _Look, trust: float) -> tuple[Array, float]:
        """The best change of the unknowns within the trusted region, and what it is foretold to gain."""
        from scipy.optimize import linprog  # half a second of imports that straight legs do without

        rules, size = self.rules, self.size
        reach = np.full(size, trust * TRUSTED_TURN)
        reach[0] = trust * TRUSTED_STRETCH * legs.depth if self.goal == "depth" else 0.0
        low, high = -reach, reach.copy()
        if rules.psi_bound > 0:
            at, psi = self.at.ravel(), legs.psi.ravel()
            low[at], high[at] = np.maximum(low[at], -rules.psi_bound - psi), np.minimum(high[at], rules.psi_bound - psi)
        spare = look.rates - rules.min_rate - GUARD
        near = spare < np.abs(look.rates_by) @ reach + max(look.lack, 0.0)
        if self.goal == "margin":
            near = spare < spare.min() + 2 * np.abs(look.rates_by) @ reach
        # the greatest twist rate, to either side
        ds, turn = rules.steepest * np.diff(legs.standoff).ravel() - TOLERANCE, np.diff(legs.psi).ravel()
        by_depth, by_spin = rules.steepest * np.diff(self.share).ravel(), np.zeros((turn.size, size))
        places = np.arange(turn.size)
        by_spin[places, self.at[:, 1:].ravel()], by_spin[places, self.at[:, :-1].ravel()] = 1.0, -1.0
        by_spin = np.concatenate([by_spin, -by_spin])
        by_spin[:, 0] = -np.tile(by_depth, 2)
        most = np.concatenate([ds - turn, ds + turn])
        lacking = np.full((12, 1), 0.0 if self.goal == "margin" else -1.0)
        A = np.block([
            [-look.rates_by[near], np.full((int(near.sum()), 1), -1.0)],
            [-look.room_by, lacking],
            [by_spin, np.zeros((most.size, 1))],
        ])  # fmt: skip
        b = np.concatenate([spare[near], look.room, most])
        v_low = -np.inf if self.goal == "margin" else 0.0
        bounds = np.column_stack([np.append(low, v_low), np.append(high, np.inf)])
        answer = linprog(np.append(look.cost, self.price), A, b, bounds=bounds, method="highs-ds", options=OPTIONS)
        if answer.x is None:
            return np.zeros(size), 0.0
        return np.clip(answer.x[:-1], low, high), self.worth(look.lack) - float(answer.fun)
