"""The critical twist rates at the target against the spin there, and how the two legs bracket them (theory §2).

What a figure and the app draw, as arrays.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from zerorev.files.units import deg_per_mm
from zerorev.model._arrays import Array
from zerorev.model.profile import Profile
from zerorev.motion.drilling import Drilling
from zerorev.report.scene.field import critical, stuck_joints

__all__ = ["FAR_OFF", "Bracket", "bracket", "broken_at_poles"]

FAR_OFF = 1e6  # [deg/mm] beyond every picture
BROADEST = 6.0  # brackets: critical rates farther out are named at the edge of the picture


@dataclass(frozen=True)
class Bracket:
    """Critical rates over a full turn of the spin at the corner of a motion, on its branch.

    Attributes:
        psi: spins at the target [rad], shape (P,), the chosen one in their middle.
        kappa: critical rates there [deg/mm], shape (P, 6); infinite for a joint that spin does not move, NaN for one
            that nothing moves, and out of reach.
        theta_psi: d theta / d psi there [1], shape (P, 6).
        chosen: the motion's spin [rad].
        here: critical rates at the chosen spin [deg/mm], shape (6,).
        slopes: of the plunge and the retract leg at the corner [deg/mm], shape (2,), read outwards.
    """

    psi: Array
    kappa: Array
    theta_psi: Array
    chosen: float
    here: Array
    slopes: Array

    @property
    def stuck(self) -> tuple[int, ...]:
        """Joints (0..5) that spin moves nowhere."""
        return stuck_joints(self.theta_psi)

    @property
    def between(self) -> npt.NDArray[np.bool_]:
        """Whether each joint keeps its direction through the target at the chosen spin, shape (6,)."""
        return _between(self.here, self.slopes)

    @property
    def all_between(self) -> npt.NDArray[np.bool_]:
        """Spins at which these slopes bracket all six, shape (P,)."""
        return np.asarray(_between(self.kappa, self.slopes).all(axis=1) & ~self._lost)

    @property
    def _lost(self) -> npt.NDArray[np.bool_]:
        return np.asarray(np.isnan(self.kappa).all(axis=1))

    @property
    def reached(self) -> tuple[float, float]:
        """The stretch of spins [rad] around the chosen one that the branch reaches, with a little margin."""
        at, lost = int(np.argmin(np.abs(self.psi - self.chosen))), np.flatnonzero(self._lost)
        before, after = lost[lost < at], lost[lost > at]
        low = self.psi[before[-1]] if before.size else self.psi[0]
        high = self.psi[after[0]] if after.size else self.psi[-1]
        return float(low), float(high)

    @property
    def rates(self) -> tuple[float, float]:
        """Rates to show [deg/mm]: the bracket in the middle third or so, and the crossings that lie about it."""
        width = max(float(np.ptp(self.slopes)), 0.1)
        farthest = BROADEST * max(width, float(np.abs(self.slopes).max()))
        near = self.here[np.isfinite(self.here) & (np.abs(self.here - self.slopes.mean()) < farthest)]
        shown = np.concatenate([self.slopes, near])
        low, high = shown.min(), shown.max()
        pad = 0.55 * max(high - low, width)
        return float(low - pad), float(high + pad)

    def curve(self, joint: int) -> tuple[Array, Array]:
        """Spins [deg] and critical rates [deg/mm] of one joint (0..5), the curve broken at its poles."""
        return broken_at_poles(np.rad2deg(self.psi), self.kappa[:, joint], self.theta_psi[:, joint])


def bracket(drilling: Drilling, profile: Profile, branch: int, step: float, creep: float = 0.0) -> Bracket:
    """The critical rates around the corner of a motion.

    Args:
        drilling: robot, tool and hole.
        profile: the spin along the path.
        branch: 0..7.
        step: between the spins that are examined [rad].
        creep: how far the tool creeps in while it spins on at the corner [m]; 0: it does not.
    """
    n = profile.corner
    last = n - 1 - profile.just_before_corner(creep)  # segment of the plunge, before the spin
    chosen, corner = float(profile.psi[n]), float(profile.standoff[n])
    psi = chosen + np.arange(-np.pi, np.pi + step / 2, step)
    kappa, theta_psi = critical(drilling, branch, np.full_like(psi, corner), psi)
    here = critical(drilling, branch, np.array([corner]), np.array([chosen]))[0][0]
    return Bracket(psi, kappa, theta_psi, chosen, here, np.asarray(deg_per_mm(profile.twist_rate[[last, n]])))


def _between(kappa: Array, slopes: Array) -> npt.NDArray[np.bool_]:
    """Whether rates lie between the slopes; a joint that nothing moves need not."""
    with np.errstate(invalid="ignore"):
        return np.asarray(((kappa > slopes.min()) & (kappa < slopes.max())) | np.isnan(kappa))


def broken_at_poles(x: Array, kappa: Array, theta_psi: Array) -> tuple[Array, Array]:
    """The curve, broken where theta_psi changes sign: its ends run off along the asymptote, and no line joins them.

    Args:
        x: where, shape (P,).
        kappa: critical rates of one joint there, shape (P,).
        theta_psi: its d theta / d psi there, shape (P,).
    """
    turns = np.flatnonzero((theta_psi[:-1] > 0) != (theta_psi[1:] > 0))
    turns = turns[np.isfinite(kappa[turns]) & np.isfinite(kappa[turns + 1])]
    share = theta_psi[turns] / (theta_psi[turns] - theta_psi[turns + 1])
    pole = x[turns] + share * (x[turns + 1] - x[turns])
    far = [np.where(np.abs(kappa[n]) > 0, np.sign(kappa[n]) * FAR_OFF, np.nan) for n in (turns, turns + 1)]
    y = np.where(np.isinf(kappa), np.nan, kappa)
    at = np.repeat(turns + 1, 3)
    gap = np.full_like(pole, np.nan)
    return (
        np.insert(x, at, np.column_stack([pole, pole, pole]).ravel()),
        np.insert(y, at, np.column_stack([far[0], gap, far[1]]).ravel()),
    )
