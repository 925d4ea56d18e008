"""What the critical rates predict before any search: the least twist and the deepest stroke of a hole (theory §2).

Everything here follows from the target line alone: at each spin the two rate fields and their derivatives up to second
order are known, no leg is followed. How good the figures are is measured in docs/explanation/prediction.md.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import numpy.typing as npt
from numpy.polynomial.polynomial import polyval

from zerorev.kernels.layout import LONGEST_TWIST
from zerorev.model._arrays import Array
from zerorev.model.job import Settings
from zerorev.model.robot import NIL_RATE, JointLimits
from zerorev.motion.critical import CriticalRates, bracket, critical
from zerorev.motion.drilling import Drilling, joint_rates
from zerorev.search.line import golden
from zerorev.search.straight import LEAST_RATE, target_spins

__all__ = [
    "Prediction",
    "earlier_root",
    "first_order_root",
    "narrowest",
    "predict",
    "second_order_root",
]

SPINS, FINE_SPINS = 120, 1440  # at the target, in one turn: for legs, for brackets
CLOSING_STEPS = 20
SLOPES = 24  # on each side, in geometric steps away from the bracket
LEAST_STEP_AWAY = 2e-4  # of the steepest slope: the first of them
STEEPEST = float(np.deg2rad(20e3))  # [rad/m] 20 deg/mm
BISECTIONS = 30
STEP_ALONG, STEP_ROUND = 1e-3, 1e-2  # [m], [rad] of the finite differences
FULL_TURN = 2 * np.pi

Root = Callable[[Array, Array, Array], Array]


@dataclass(frozen=True)
class Prediction:
    """What is predicted of a hole; straight legs.

    Attributes:
        cheapest: the narrowest bracket of the target line, or None where the target is out of reach or the tool has
            no lever. No motion without a reversal out of that place turns the tool less than its width times the depth.
        least_twist: predicted least |psi_start - psi_end| [rad] of a motion without a reversal to the hole's depth; inf
            where none is predicted.
        deepest: predicted deepest stroke [m]; 0 where none, however short, has zero reversals.
        deepest_at: its spin and branch, or None.
    """

    cheapest: CriticalRates | None
    least_twist: float
    deepest: float
    deepest_at: CriticalRates | None


def predict(drilling: Drilling, settings: Settings | None = None, *, root: Root | None = None) -> Prediction:
    """Predict the least twist of a hole at its depth, and its deepest stroke, without a search.

    How good the figures are is measured in docs/explanation/prediction.md.

    Args:
        drilling: robot, tool and hole: what to drill; its `branch`, if any, is the only one examined.
        settings: whose `min_rate` every joint keeps at every point, and whose `psi_bound` holds the spin.
        root: up to where an expansion of a joint's motion is trusted; by default `earlier_root` for the deepest stroke
            and `second_order_root` for the twist.
    """
    settings = settings or Settings()
    deep, gentle = root or earlier_root, root or second_order_root
    line = _target_line(drilling, settings)
    if line.psi.size == 0:
        return Prediction(None, np.inf, 0.0, None)

    depths = np.minimum(line.farthest(1, deep), line.farthest(-1, deep))
    best = int(np.argmax(depths))
    at = critical(drilling, int(line.branch[best]), float(line.psi[best]), settings.min_rate)
    twists = (
        line.gentlest(1, drilling.hole.depth, gentle) - line.gentlest(-1, drilling.hole.depth, gentle)
    ) * drilling.hole.depth
    return Prediction(
        cheapest=narrowest(drilling, settings),
        least_twist=float(np.nanmin(twists, initial=np.inf)),
        deepest=float(depths[best]),
        deepest_at=at if depths[best] > 0 else None,
    )


def narrowest(drilling: Drilling, settings: Settings) -> CriticalRates:
    """The narrowest bracket of the target line; its width is not finite where the target is out of reach.

    Args:
        drilling: robot, tool and hole: where to drill; its `branch`, if any, is the only one examined.
        settings: whose `min_rate` every joint keeps at the target, and whose `psi_bound` holds the spin.
    """
    spins = target_spins(settings.psi_bound, FINE_SPINS)
    below, above = bracket(*joint_rates(drilling, 0.0, spins), settings.min_rate)
    with np.errstate(invalid="ignore"):  # out of reach, where both are infinite
        width = np.where(_within(drilling, _angles(drilling, spins)), above - below, np.inf)
    n, branch = np.unravel_index(np.nanargmin(width), width.shape)
    low, high = spins[max(int(n) - 1, 0)], spins[min(int(n) + 1, len(spins) - 1)]

    def at(psi: float) -> CriticalRates:
        return critical(drilling, int(branch), psi, settings.min_rate)

    here, closer = at(float(spins[n])), at(golden(lambda psi: at(psi).width, low, high, CLOSING_STEPS))
    return closer if closer.width < here.width else here


# --- how far an expansion a + b s + c s^2 / 2, above 0 at s = 0, stays above 0 ----------------------------------------


def first_order_root(a: Array, b: Array, c: Array) -> Array:
    """By first order; inf where it never comes down."""
    with np.errstate(divide="ignore", over="ignore", invalid="ignore"):
        return np.where(a > 0, np.where(b < 0, -a / b, np.inf), 0.0)


def second_order_root(a: Array, b: Array, c: Array) -> Array:
    """By second order; inf where it never comes down."""
    with np.errstate(divide="ignore", over="ignore", invalid="ignore"):
        root = 2 * a / (np.sqrt(b * b - 2 * a * c) - b)
        return np.where(a > 0, np.where(root > 0, root, np.inf), 0.0)


def earlier_root(a: Array, b: Array, c: Array) -> Array:
    """The earlier of the two: that a joint recovers is not believed of an expansion, that it slows down is."""
    return np.minimum(first_order_root(a, b, c), second_order_root(a, b, c))


# --- the target line --------------------------------------------------------------------------------------------------


class _TargetLine(NamedTuple):
    """The N places (spin, branch) of the target line that are in reach and within the limits.

    Attributes:
        psi: [rad], shape (N,).
        branch: 0..7, shape (N,).
        angles: of the joints [rad], turned to where they are farthest from the limits, shape (N, 6).
        motion: how the joints move along a leg of slope u, by order: the coefficients in u of the first, second and
            third derivative of theta(s, psi + u s) by s, shapes (2, N, 6), (3, N, 6), (4, N, 6).
        below: lower end of the bracket [rad/m], shape (N,).
        above: its upper end [rad/m], shape (N,).
        limits: of the joints.
        min_rate: the threshold [rad/m].
        psi_bound: of the spin [rad], inf where it is periodic.
    """

    psi: Array
    branch: npt.NDArray[np.int64]
    angles: Array
    motion: tuple[Array, Array, Array]
    below: Array
    above: Array
    limits: JointLimits
    min_rate: float
    psi_bound: float

    def reach(self, slopes: Array, side: int, root: Root) -> Array:
        """How far legs are predicted to run [m], shape (N, J), of slopes (N, J) above (1) or below (-1) the bracket."""
        rate, bend, curl = (
            np.asarray(polyval(slopes[..., None], order[:, :, None, :], tensor=False), dtype=np.float64)
            for order in self.motion
        )
        angles, sense = self.angles[:, None, :], np.copysign(1.0, side * self.motion[0][1])[:, None, :]
        # a joint that stands still altogether does not reverse
        moves = np.abs(rate) > NIL_RATE
        stops = np.where(moves, root(sense * rate - self.min_rate, sense * bend, sense * curl), np.inf)
        limit = np.minimum(root(self.limits.upper - angles, -rate, -bend), root(angles - self.limits.lower, rate, bend))
        room = np.minimum(LONGEST_TWIST, self.psi_bound - self.psi[:, None] * np.sign(slopes))
        joints: Array = np.minimum(stops, limit).min(axis=-1)
        return np.minimum(joints, room / np.maximum(np.abs(slopes), 1e-9))

    def slopes(self, side: int) -> Array:
        """Slopes away from the bracket, in geometric steps, shape (N, SLOPES)."""
        edge = (self.above if side > 0 else self.below)[:, None]
        steps = np.geomspace(LEAST_STEP_AWAY, 1.0, SLOPES, dtype=np.float64)
        return np.asarray(edge + side * np.maximum(STEEPEST - side * edge, 0.0) * steps)

    def farthest(self, side: int, root: Root) -> Array:
        """How far the best slope is predicted to run [m], shape (N,)."""
        return np.asarray(self.reach(self.slopes(side), side, root).max(axis=1))

    def gentlest(self, side: int, depth: float, root: Root) -> Array:
        """The slope nearest to the bracket that is predicted to run so deep [rad/m], shape (N,); NaN where none is."""
        slopes = self.slopes(side)
        runs = self.reach(slopes, side, root) >= depth
        first = runs.argmax(axis=1)
        edge = self.above if side > 0 else self.below
        rows = np.arange(len(first))
        good = np.where(runs.any(axis=1), slopes[rows, first], np.nan)
        bad = np.where(first > 0, slopes[rows, first - 1], edge)
        for _ in range(BISECTIONS):
            middle = (good + bad) / 2
            does = self.reach(middle[:, None], side, root)[:, 0] >= depth
            good, bad = np.where(does, middle, good), np.where(does, bad, middle)
        return good


def _target_line(drilling: Drilling, settings: Settings) -> _TargetLine:
    limits, min_rate = drilling.limits, max(settings.min_rate, LEAST_RATE)
    spins = target_spins(settings.psi_bound, SPINS)
    angles = _angles(drilling, spins)
    # five points: the place itself, a step out and in, a step round and back
    steps = np.array([[0, 0], [1, 0], [-1, 0], [0, 1], [0, -1]]) * [STEP_ALONG, STEP_ROUND]
    theta_s, theta_psi = joint_rates(drilling, steps[:, :1], spins + steps[:, 1:])
    with np.errstate(invalid="ignore"):
        below, above = bracket(theta_s[0], theta_psi[0], min_rate)
        use = _within(drilling, angles) & np.isfinite(above - below) & np.isfinite(theta_s).all(axis=(0, 3))
    theta_s, theta_psi = theta_s[:, use], theta_psi[:, use]
    along, round_ = (slice(0, 3), STEP_ALONG), ([0, 3, 4], STEP_ROUND)
    (s_s, s_ss), (s_psi, s_psipsi) = (_derivatives(theta_s[points], step) for points, step in (along, round_))
    (_, psi_ss), (psi_psi, psi_psipsi) = (_derivatives(theta_psi[points], step) for points, step in (along, round_))
    motion = (
        np.array([theta_s[0], theta_psi[0]]),
        np.array([s_s, 2 * s_psi, psi_psi]),
        np.array([s_ss, 3 * psi_ss, 3 * s_psipsi, psi_psipsi]),
    )
    n, branch = (index.astype(np.int64) for index in np.nonzero(use))
    bound = np.inf if settings.psi_bound is None else settings.psi_bound
    return _TargetLine(spins[n], branch, angles[use], motion, below[use], above[use], limits, min_rate, bound)


def _angles(drilling: Drilling, spins: Array) -> Array:
    """Joints at the target [rad], turned to where they are farthest from the limits, shape (N, 8, 6)."""
    angles = drilling.angles(0.0, spins)
    middle = (drilling.limits.lower + drilling.limits.upper) / 2
    return angles + FULL_TURN * np.round((middle - angles) / FULL_TURN)


def _within(drilling: Drilling, angles: Array) -> npt.NDArray[np.bool_]:
    """Which places are in reach, within the limits and on a branch that is asked for, shape (N, 8)."""
    limits, branch = drilling.limits, drilling.hole.branch
    inside = ((angles > limits.lower) & (angles < limits.upper)).all(axis=-1)
    return np.asarray(inside & (True if branch is None else np.arange(8) == branch))


def _derivatives(points: Array, step: float) -> tuple[Array, Array]:
    """First and second derivative from values at a place, a step on and a step back, shape (3, ...)."""
    here, on, back = points
    return (on - back) / (2 * step), (on - 2 * here + back) / step**2
