"""How deep free legs get, from any spin at the target, by reachable and viable sets (theory §4).

Along the target line the signs of theta_psi say which way each joint goes on the leg above the critical rates; on the
leg below it goes the other way. A *family* is an interval of spins at the target with the same signs, in one posture.
The reachable sets of whole families say how deep their legs get at most, so that viable sets are made for a few of them
only.

All depths here are estimates. Sets are cut at their rows and at spins a little apart, so that they may jump a stretch
that no leg can pass, where it is thinner than that; and limits of joints that can turn more than once round are left
out. What a leg attains is known of a motion that was evaluated (`search.free_deepest`), what none attains is proven
by other sets (`search.bounds.free_depth`).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from zerorev.kernels import viable as kernels
from zerorev.kernels.field import rates
from zerorev.kernels.layout import Constraints, TwistPlane
from zerorev.kernels.reach import KEPT, workspaces
from zerorev.model._arrays import Array
from zerorev.model.robot import ArmGeometry
from zerorev.search.straight import target_spins

__all__ = ["ROWS_SLACK", "Family", "Grain", "Pair", "Tubes", "Viable"]

GRID = 240  # spins at the target in one turn
MAX_ROWS = 512  # of a tube, which may get a little deeper
COARSE_ROWS = 60  # of the stretched arm
ROWS, MOST_ROWS = 48, 384  # of the depth in question: usually, and at most for the tubes to have room
CLOSE = 1e-3  # relative: to which a depth is closed in on
NEARLY = 0.97  # of the deepest: what gets nearly as deep is kept, too
ROWS_SLACK = 1e-5  # [rad] kept to the limits, against the straight lines by which rows are joined
COARSE_SLACK = 1.02  # by how much coarse tubes may end too early


class Grain(NamedTuple):
    """How closely a tube is examined.

    Attributes:
        step: between two rows, at most [m].
        turn: by which an end of an interval moves at once, at most [rad].
        between: two spins examined, at most [rad].
        finest: to which the end of a tube is located [m].
    """

    step: float
    turn: float
    between: float
    finest: float

    @classmethod
    def of(cls, depth: float, rows: int) -> Grain:
        """For tubes of about a depth [m]: the more rows, the closer the spins of each."""
        finer = min(1.0, ROWS / rows)
        return cls(depth / rows, float(np.deg2rad(4)) * finer, float(np.deg2rad(2)) * finer, 1e-3 * depth * finer)


@dataclass(frozen=True)
class Family:
    """Spins at the target from which each joint goes the same way on the leg above the critical rates.

    Attributes:
        posture: 0..3.
        sense: signs of theta_psi on the unflipped wrist, shape (6,).
        low: least spin [rad].
        high: greatest spin [rad].
    """

    posture: int
    sense: Array
    low: float
    high: float


class Pair(NamedTuple):
    """The two legs of a family on a branch, and how deep they get.

    Attributes:
        depth: [m].
        family: from where they set out.
        branch: 0..7.
        limited: whether the joint limits make a difference.
    """

    depth: float
    family: Family
    branch: int
    limited: bool


@dataclass
class Tubes:
    """Room for the tubes of two legs.

    Attributes:
        raw: stand-offs [m], shape (2, R); numbers of intervals, shape (2, R); the intervals [rad],
            shape (2, R, KEPT, 2).
        rows: of each, shape (2,).
    """

    raw: tuple[Array, npt.NDArray[np.int64], Array] = field(default_factory=lambda: _empty_tubes())
    rows: npt.NDArray[np.int64] = field(default_factory=lambda: np.zeros(2, dtype=np.int64))


def _empty_tubes() -> tuple[Array, npt.NDArray[np.int64], Array]:
    counts = np.zeros((2, MAX_ROWS), dtype=np.int64)
    return np.empty((2, MAX_ROWS)), counts, np.empty((2, MAX_ROWS, KEPT, 2))


class Viable:
    """One hole, and how deep its free legs get.

    Attributes:
        room: what the kernels work in.
        reached: the tubes that were followed last.
        viable: the viable sets that were made last.
        overlap: the spins at the target that they share [rad].
    """

    def __init__(
        self,
        arm: ArmGeometry,
        plane: TwistPlane,
        constraints: Constraints,
        branches: npt.NDArray[np.bool_],
        reach: float,
        rows: int = ROWS,
    ) -> None:
        self.arm, self.plane, self.constraints, self.branches, self.stretched = arm, plane, constraints, branches, reach
        self.rows, self.coarse = rows, Grain.of(reach, max(COARSE_ROWS, rows // 2))
        self.room = workspaces()
        self.reached, self.viable, self.overlap = Tubes(), Tubes(), np.empty(2)

    def pairs(self, enough: float = 0.0) -> list[Pair]:
        """The deepest legs of the families that get deepest, deepest first.

        Args:
            enough: [m]; what gets no deeper is left out.
        """
        bounds = [
            (self.bound(family, 2 * family.posture, False, self.coarse, enough), family) for family in self.families()
        ]
        found: list[Pair] = []
        for bound, family in sorted(bounds, key=lambda each: -each[0]):
            best = max((pair.depth for pair in found), default=enough)
            if bound * COARSE_SLACK <= best or bound == 0.0:
                break
            found += self._closer(family, bound, NEARLY * best)
        return sorted(found, key=lambda pair: -pair.depth)

    def _closer(self, family: Family, bound: float, enough: float) -> Iterator[Pair]:
        """The legs of a family on its branches, if they get deeper than `enough`."""
        grain = Grain.of(bound, self.rows)
        bound = self.bound(family, 2 * family.posture, False, grain, enough)
        for branch in (2 * family.posture, 2 * family.posture + 1):
            if not self.branches[branch] or bound <= enough:
                continue
            within = self.bound(family, branch, True, grain, enough)
            if within > enough:
                depth = self.depth(family, branch, True, grain, max(enough, within / self.rows), within)
                if depth > enough:
                    yield Pair(depth, family, branch, within < bound)

    def families(self) -> list[Family]:
        """All families of the target line."""
        psi = target_spins(self.constraints.psi_bound or None, GRID)
        if not self.constraints.psi_bound:
            psi = np.append(psi, psi[0] + 2 * np.pi)
        found = []
        for posture in range(4):
            if not self.branches[2 * posture : 2 * posture + 2].any():
                continue
            theta_s, theta_psi = np.empty((2, 6, psi.size))
            rates(self.arm, self.plane, posture, np.zeros(psi.size), psi, theta_s, theta_psi)
            known, up = ~np.isnan(theta_psi[0]), theta_psi > 0
            same = np.append(known[1:] & known[:-1] & (up[:, 1:] == up[:, :-1]).all(axis=0), False)
            first = 0
            for last in np.flatnonzero(~same).tolist():
                if known[first]:
                    low, high = float(psi[first]), float(psi[last])
                    if first > 0 and known[first - 1]:
                        low = _nil(psi, theta_psi, first, first - 1)
                    if last + 1 < psi.size and known[last + 1]:
                        high = _nil(psi, theta_psi, last, last + 1)
                    found.append(Family(posture, np.where(up[:, last], 1.0, -1.0), low, high))
                first = last + 1
        return found

    def bound(self, family: Family, branch: int, limited: bool, grain: Grain, enough: float = 0.0) -> float:
        """About how deep legs of a family get at most [m]; the tubes are left as made: `kernels.viable.pair_bound`."""
        return float(
            kernels.pair_bound(
                self.arm, self.plane, branch, family.sense, self.constraints, limited, grain, family.low, family.high,
                enough, 2 * self.stretched, self.room, self.reached.raw, self.reached.rows,
            )
        )  # fmt: skip

    def depth(self, family: Family, branch: int, limited: bool, grain: Grain, least: float, most: float) -> float:
        """About how deep legs of a family get [m], in the tubes that `bound` has left: `kernels.viable.pair_depth`."""
        return float(
            kernels.pair_depth(
                self.arm, self.plane, branch, family.sense, self.constraints, limited, grain, least, most, CLOSE,
                self.room, self.reached.raw, self.reached.rows, self.viable.raw, self.viable.rows, self.overlap,
            )
        )  # fmt: skip


def _nil(psi: Array, theta_psi: Array, here: int, there: int) -> float:
    """The spin nearest to a node at which a joint's theta_psi is nil on the way to the next node."""
    changes = (theta_psi[:, here] > 0) != (theta_psi[:, there] > 0)
    a, b = theta_psi[changes, here], theta_psi[changes, there]
    return float(psi[here] + (a / (a - b)).min() * (psi[there] - psi[here]))
