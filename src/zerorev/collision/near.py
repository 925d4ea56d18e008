"""How near a whole motion comes to what stands around the arm, and to the arm itself.

A motion is a row of paths: lines of the twist plane, and moves of all axes in proportion. What is proven of a path
holds where no joint turns round on it, so lines are cut where one does.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from itertools import pairwise
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from zerorev.collision.arms import Setting
from zerorev.kernels import clearance as kernels
from zerorev.kernels.arm import flip_sign
from zerorev.kernels.field import rates
from zerorev.kernels.layout import TwistPlane
from zerorev.model._arrays import Array
from zerorev.model.profile import Profile
from zerorev.model.robot import Robot
from zerorev.motion.drilling import Drilling

__all__ = [
    "EXACT",
    "Nearest",
    "Path",
    "blend_lines",
    "first_hit",
    "legs_lack",
    "lines",
    "moves",
    "nearest_of",
]

EXACT = 1e-5  # [m]
SAMPLES = 65  # of a line, to see where a joint turns round
BISECTIONS = 40
BLEND_PARTS = 8
MOST_PIECES = 100_000  # of a path, to prove that it keeps clear
MOST_OF_A_LEG = 1_000  # while legs are searched for: some 10 um are then kept to an obstacle along 10 mm
NO_PLANE = TwistPlane((0.0,) * 3, (0.0,) * 9, (0.0,) * 9, (0.0,) * 3)  # of moves of all axes
Mask = npt.NDArray[np.bool_]


class Path(NamedTuple):
    """A part of a motion on which no joint turns round.

    Attributes:
        plane: of the hole.
        branch: 0..7; -1: all axes move in proportion.
        ends: stand-off [m], spin [rad] and joints [rad] at both, shape (2, 8).
    """

    plane: TwistPlane
    branch: int
    ends: Array


class Nearest(NamedTuple):
    """Where a motion comes nearest to something.

    Attributes:
        distance: [m].
        between: the body, and what it comes near to.
        standoff: where [m]; None between holes.
        path: number of the path.
        share: of that path.
        proven: whether nothing comes nearer by more than `EXACT`.
    """

    distance: float
    between: tuple[str, str]
    standoff: float | None
    path: int
    share: float
    proven: bool


def lines(drilling: Drilling, branch: int, points: Iterable[tuple[float, float]]) -> Iterator[Path]:
    """Paths through points of the twist plane, stand-off [m] and spin [rad], cut where a joint turns round.

    Args:
        drilling: robot, tool and hole.
        branch: 0..7.
        points: in order.
    """
    for one, other in pairwise(points):
        begin, end = np.array(one), np.array(other)
        if (begin == end).all():
            continue
        shares = [0.0, *_turning_shares(drilling, branch, begin, end), 1.0]
        for a, b in pairwise(shares):
            ends = np.zeros((2, 8))
            ends[0, :2], ends[1, :2] = begin + a * (end - begin), begin + b * (end - begin)
            yield Path(drilling.plane, branch, ends)


def _turning_shares(drilling: Drilling, branch: int, begin: Array, end: Array) -> list[float]:
    """Where joints turn round on a line."""

    def along(share: Array) -> Array:
        """Rates of the joints, shape (6, n)."""
        at = begin[:, None] + share * (end - begin)[:, None]
        theta_s, theta_psi = np.empty((2, 6, share.size))
        rates(drilling.robot.arm, drilling.plane, branch // 2, np.ascontiguousarray(at[0]),
              np.ascontiguousarray(at[1]), theta_s, theta_psi)  # fmt: skip
        found = (end - begin)[0] * theta_s + (end - begin)[1] * theta_psi
        found[4] *= flip_sign(drilling.robot.arm, branch)
        return np.asarray(found)

    share = np.linspace(0.0, 1.0, SAMPLES)
    signs = np.sign(along(share))
    joint, k = np.nonzero(signs[:, 1:] * signs[:, :-1] < 0)
    if not joint.size:
        return []
    low, high = share[k], share[k + 1]
    for _ in range(BISECTIONS):
        middle = (low + high) / 2
        same = np.sign(along(middle)[joint, np.arange(joint.size)]) == signs[joint, k]
        low, high = np.where(same, middle, low), np.where(same, high, middle)
    return sorted(set(((low + high) / 2).tolist()))


def blend_lines(drilling: Drilling, branch: int, profile: Profile, radius: float) -> Iterator[Path]:
    """Paths along the blend of a motion's corner, a parabola that begins and ends so far from it.

    Args:
        drilling: robot, tool and hole.
        branch: 0..7.
        profile: of the motion.
        radius: [m]; 0: there is none.
    """
    c, distance = profile.corner, profile.distance
    radius = min(radius, (distance[c] - distance[c - 1]) / 2, (distance[c + 1] - distance[c]) / 2)
    if radius <= 0:
        return
    at = np.stack(profile.at(distance[c] + radius * np.array([-1.0, 0.0, 1.0])))
    t = np.linspace(0.0, 1.0, BLEND_PARTS + 1)
    s, psi = at @ np.array([(1 - t) ** 2, 2 * t * (1 - t), t**2])
    yield from lines(drilling, branch, zip(s.tolist(), psi.tolist(), strict=True))


def moves(joints: Array) -> Iterator[Path]:
    """Paths of all axes in proportion through some points.

    Args:
        joints: controller angles [rad], shape (n, 6).
    """
    for one, other in pairwise(joints):
        ends = np.zeros((2, 8))
        ends[0, 2:], ends[1, 2:] = one, other
        yield Path(NO_PLANE, -1, ends)


def legs_lack(
    setting: Setting, drilling: Drilling, branch: int, psi_t: Array, slope: Array, most: int = MOST_OF_A_LEG
) -> Array:
    """By how much straight legs on which no joint turns round lack the clearance [m], shape (n,); 0: they keep it.

    Args:
        setting: the bodies and what stands around.
        drilling: robot, tool and hole.
        branch: 0..7.
        psi_t: spins at the target [rad], shape (n,).
        slope: twist rates [rad/m], shape (n,).
        most: pieces of a leg that are examined before it is given up.
    """
    out = np.empty(psi_t.size)
    kernels.legs_keep(
        drilling.robot.arm, drilling.plane, branch, drilling.hole.depth, np.ascontiguousarray(psi_t),
        np.ascontiguousarray(slope), setting.arms, setting.drilled, most, setting.lever_w, setting.desk(), out,
    )  # fmt: skip
    return out


def first_hit(setting: Setting, robot: Robot, paths: Iterable[Path], pairs: Mask) -> Nearest | None:
    """Where a motion does not keep the clearance, or cannot be proven to; None where it is proven to keep it.

    Args:
        setting: the bodies and what stands around.
        robot: the arm.
        paths: of the motion.
        pairs: which are held apart, shape (K,).
    """
    where, desk = np.empty(3), setting.desk()
    for number, path in enumerate(paths):
        verdict = kernels.keeps(
            robot.arm,
            path.plane,
            path.branch,
            path.ends,
            setting.arms,
            pairs,
            MOST_PIECES,
            setting.lever_w,
            desk,
            where,
        )
        if verdict == kernels.FREE:
            continue
        share, pair, lack = float(where[0]), int(where[1]), float(where[2])
        if verdict == kernels.UNDECIDED:
            return Nearest(np.nan, ("", ""), None, number, np.nan, proven=False)
        least = float(setting.arms.least[pair])
        return Nearest(least - lack, setting.names(pair), _standoff(path, share), number, share, proven=True)
    return None


def nearest_of(setting: Setting, robot: Robot, paths: Iterable[Path], pairs: Mask) -> Nearest | None:
    """Where a motion comes nearest, to `EXACT`; None where no pair counts.

    Args:
        setting: the bodies and what stands around.
        robot: the arm.
        paths: of the motion.
        pairs: which count, shape (K,).
    """
    best, desk = np.full(3, np.inf), setting.desk()
    found: Nearest | None = None
    proven = True
    if not pairs.any():
        return None
    for number, path in enumerate(paths):
        verdict = kernels.nearest(
            robot.arm, path.plane, path.branch, path.ends, setting.arms, pairs, setting.lever_w, EXACT, desk, best
        )
        proven = proven and verdict == kernels.FREE
        if np.isnan(best[1]):
            continue
        share, pair = float(best[1]), int(best[2])
        found = Nearest(float(best[0]), setting.names(pair), _standoff(path, share), number, share, proven=True)
    return None if found is None else found._replace(proven=proven)


def _standoff(path: Path, share: float) -> float | None:
    return None if path.branch < 0 else float(path.ends[0, 0] + share * (path.ends[1, 0] - path.ends[0, 0]))
