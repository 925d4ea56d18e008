"""The twist map of a hole: which spins are possible along the drill axis, and where spin does not move a joint.

The map covers one whole turn of spin, of which every other turn is a copy, and the stroke once, of which the retract is
the mirror image. It is of one branch, or the envelope of all: at each point the branch that serves best there.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from contourpy import contour_generator

from zerorev.files.units import deg_per_mm
from zerorev.model._arrays import Array
from zerorev.motion.criteria import from_singular
from zerorev.motion.critical import kappa_of, spread_of
from zerorev.motion.drilling import Drilling, joint_rates
from zerorev.report.scene.field import over_limits, stuck_joints
from zerorev.report.scene.load_lines import LoadLine, load_lines
from zerorev.report.scene.regions import Region, regions

__all__ = ["LIMITED", "NEAR_SINGULAR", "OPEN", "UNREACHED", "SignLine", "TwistMap", "twist_map"]

OPEN, NEAR_SINGULAR, LIMITED, UNREACHED = range(4)  # from best to worst
SINGULAR_BELOW = float(np.sin(np.deg2rad(5.0)))  # of `from_singular`: within 5 deg of a singularity
SHAPE = (61, 181)  # stand-offs and spins
ON_LINE = 1e-9  # |theta_psi| on a line where spin does not move the joint

Bools = npt.NDArray[np.bool_]
Bytes = npt.NDArray[np.uint8]


@dataclass(frozen=True)
class SignLine:
    """A line on which spin does not move a joint: its theta_psi changes sign there.

    Attributes:
        joint: 1 to 6.
        branch: 0..7; its wrist flip has the same line.
        points: stand-off [m] and spin [rad], shape (n, 2).
    """

    joint: int
    branch: int
    points: Array


@dataclass(frozen=True)
class TwistMap:
    """One branch over the stroke and a whole turn of spin, or the best of all branches.

    Attributes:
        branch: 0..7, or None for the envelope of all.
        standoff: [m], shape (S,).
        psi: [rad], shape (P,), from -pi to pi.
        best: the branch that is shown at each point, shape (S, P).
        zone: `OPEN`, `NEAR_SINGULAR`, `LIMITED` or `UNREACHED`, shape (S, P).
        limited: bit i is set where no turn brings joint i + 1 within its limits, shape (S, P).
        singular: bits 0, 1 and 2 are set where shoulder, elbow and wrist are near singular, shape (S, P).
        spread: twist spread [deg/mm], shape (S, P); inf where a joint's critical rate is, NaN out of reach.
        regions: from mild to grave; each holds the graver ones.
        lines: in the envelope those of each branch where it is the one that is shown.
        stuck: joints (1..6) that spin moves nowhere.
        load_lines: where loads change their sign; none in the envelope, nor for a robot whose masses are not known.
    """

    branch: int | None
    standoff: Array
    psi: Array
    best: npt.NDArray[np.int64]
    zone: Bytes
    limited: Bytes
    singular: Bytes
    spread: Array
    regions: tuple[Region, ...]
    lines: tuple[SignLine, ...]
    stuck: tuple[int, ...]
    load_lines: tuple[LoadLine, ...]


def twist_map(
    drilling: Drilling,
    branch: int | None,
    corner: float = 0.0,
    shape: tuple[int, int] = SHAPE,
    *,
    thrust: float = 0.0,
) -> TwistMap:
    """The twist map of a hole; some fifty milliseconds.

    Args:
        drilling: robot, tool and hole: whose stroke it spans.
        branch: 0..7, or None for the envelope of all.
        corner: stand-off of the motion's corner [m], below 0 where it is placed deeper.
        shape: how many stand-offs and spins.
        thrust: of the drill while it plunges [N].
    """
    here = _Place(drilling, np.arange(8) if branch is None else np.array([branch]))
    standoff, finely = np.linspace(corner, drilling.hole.depth, shape[0]), np.linspace(-np.pi, np.pi, 2 * shape[1] - 1)
    psi = finely[::2]
    zone, limited, singular = here.zones(*np.meshgrid(standoff, psi, indexing="ij"))
    theta_s, theta_psi = here.rates(*np.meshgrid(standoff, finely, indexing="ij"))
    spread = deg_per_mm(spread_of(kappa_of(theta_s[:, ::2], theta_psi[:, ::2])))
    spread = np.where(zone < UNREACHED, spread, np.nan)
    # the mildest zone, and in it the least spread
    with np.errstate(invalid="ignore"):
        rank = zone + np.where(np.isfinite(spread), spread / (1 + spread), 1 - 1e-9)
    best = rank.argmin(axis=-1)[..., None]
    zone, limited, singular = (np.take_along_axis(each, best, -1)[..., 0] for each in (zone, limited, singular))
    shown = here.branches[best[..., 0]]
    lines = _sign_lines(here, standoff, finely, theta_psi)
    if branch is None:
        lines = _of_the_best(lines, standoff, psi, shown, zone)
    return TwistMap(
        branch, standoff, psi, shown, zone, limited, singular, np.take_along_axis(spread, best, -1)[..., 0],
        regions(standoff, psi, zone, (NEAR_SINGULAR, LIMITED, UNREACHED), here.zone), tuple(lines),
        tuple(i + 1 for i in stuck_joints(theta_psi)),
        () if branch is None else load_lines(drilling, branch, standoff, psi, thrust),
    )  # fmt: skip


@dataclass(frozen=True)
class _Place:
    """What is asked of the points of a hole's twist plane: some branches, shape (B,)."""

    drilling: Drilling
    branches: npt.NDArray[np.int64]

    def rates(self, s: Array, p: Array) -> tuple[Array, Array]:
        """theta_s and theta_psi, each (..., B, 6), at points (...,)."""
        theta_s, theta_psi = joint_rates(self.drilling, s, p)
        return theta_s[..., self.branches, :], theta_psi[..., self.branches, :]

    def zone(self, s: Array, p: Array) -> Bytes:
        """The mildest zone of the branches at points (...,)."""
        return np.asarray(self.zones(s, p)[0].min(axis=-1))

    def zones(self, s: Array, p: Array) -> tuple[Bytes, Bytes, Bytes]:
        """Zone, joints over their limits and near singularities (bits), each (..., B), at points (...,)."""
        robot = self.drilling.robot
        joints = self.drilling.angles(s, p)[..., self.branches, :]
        limited = np.packbits(over_limits(self.drilling, joints), axis=-1, bitorder="little")[..., 0]
        with np.errstate(invalid="ignore"):
            near = from_singular(robot, joints) < SINGULAR_BELOW
        singular = np.packbits(near, axis=-1, bitorder="little")[..., 0]
        zone = np.where(limited > 0, LIMITED, np.where(singular > 0, NEAR_SINGULAR, OPEN))
        return np.where(np.isnan(joints[..., 0]), UNREACHED, zone).astype(np.uint8), limited, singular


def _sign_lines(here: _Place, standoff: Array, psi: Array, theta_psi: Array) -> list[SignLine]:
    """Where theta_psi, shape (S, P, B, 6), is zero; of two wrist flips the lines are the same, so of one of them."""
    drawn: list[tuple[int, int, Array]] = []
    for k in range(0, here.branches.size, 2):
        for i in range(6):
            values = theta_psi[..., k, i]
            if np.nanmin(values, initial=np.inf) < 0 < np.nanmax(values, initial=-np.inf):
                lines = contour_generator(psi, standoff, np.ma.masked_invalid(values)).lines(0.0)
                drawn += [(k, i, np.asarray(points)[:, ::-1]) for points in lines]
    if not drawn:
        return []
    sizes = [len(points) for _, _, points in drawn]
    of_each = np.repeat([(k, i) for k, i, _ in drawn], sizes, axis=0)
    points, good = _zeros(here, of_each, np.concatenate([points for _, _, points in drawn]), psi[1] - psi[0])
    cuts = np.cumsum(sizes)[:-1]
    return [
        SignLine(i + 1, int(here.branches[k]), part)
        for (k, i, _), line, fine in zip(drawn, np.split(points, cuts), np.split(good, cuts), strict=True)
        for part in _runs(line, fine)
    ]


def _zeros(here: _Place, of_each: npt.NDArray[np.int64], points: Array, step: float) -> tuple[Array, Bools]:
    """Points (n, 2) moved along the spin by secants to where theta_psi of one branch and joint each, (n, 2), is zero.

    Returns:
        the points, and whether there is a zero within the grid's step [rad]: at a pole, or at an edge, there is none.
    """
    s, p = points.T
    rows = np.arange(s.size)

    def value(psi: Array) -> Array:
        return np.asarray(here.rates(s, psi)[1][rows, of_each[:, 0], of_each[:, 1]])

    with np.errstate(invalid="ignore", divide="ignore"):
        a, b = p - 0.05 * step, p
        f, g = value(a), value(b)
        for _ in range(8):
            done = (np.abs(g) <= ON_LINE) | (f == g)
            a, b = np.where(done, a, b), np.where(done, b, b - g * (b - a) / (g - f))
            f, g = np.where(done, f, g), value(b)
        return np.stack([s, b], axis=-1), (np.abs(g) <= ON_LINE) & (np.abs(b - p) <= 2 * step)


def _of_the_best(
    lines: list[SignLine], standoff: Array, psi: Array, shown: npt.NDArray[np.int64], zone: Bytes
) -> list[SignLine]:
    """The parts of the lines, in an envelope, where their branch or its wrist flip is the one that is shown.

    Args:
        lines: of all branches.
        standoff: of the grid [m], shape (S,).
        psi: of the grid [rad], shape (P,).
        shown: the branch that is shown at each point of the grid, shape (S, P).
        zone: at each point of the grid, shape (S, P).
    """
    found = []
    for line in lines:
        s = np.rint((line.points[:, 0] - standoff[0]) / (standoff[1] - standoff[0])).astype(int)
        p = np.rint((line.points[:, 1] - psi[0]) / (psi[1] - psi[0])).astype(int).clip(0, psi.size - 1)
        seen = (shown[s, p] // 2 == line.branch // 2) & (zone[s, p] < UNREACHED)
        found += [SignLine(line.joint, line.branch, part) for part in _runs(line.points, seen)]
    return found


def _runs(points: Array, good: Bools) -> list[Array]:
    """The stretches of a line, shape (n, 2), all of whose points are good; those of one point are left out."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], good, [False]]).astype(np.int8)))
    return [points[a:b] for a, b in edges.reshape(-1, 2) if b - a > 1]
