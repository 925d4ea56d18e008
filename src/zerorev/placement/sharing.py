"""Which robot should drill which hole of a part that several robots reach (thesis sec. 4.6)."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy.optimize import linear_sum_assignment

from zerorev.errors import InputError
from zerorev.model._arrays import Array
from zerorev.model.hole import Hole
from zerorev.model.job import Job, Settings
from zerorev.model.robot import Robot
from zerorev.model.tool import Tool
from zerorev.motion.drilling import Drilling
from zerorev.search.cycles import deepest_in_cycle
from zerorev.workers import HERE, Machines, Workers

__all__ = ["Shares", "assigned", "share"]

SAME = 1e-6  # [m], and of unit vectors: what is closer is the same hole

Progress = Callable[[int, int], None]


@dataclass(frozen=True)
class Shares:
    """Which robot takes which hole.

    Attributes:
        margins: how much deeper than needed each robot could drill each hole without a reversal [m], shape (R, H);
            NaN where its job has no such hole.
        ids: of the holes, in the order of the jobs, those of the first one first.
        taken_by: index of the robot that takes each hole, shape (H,); -1 where none drills it to its depth.
    """

    margins: Array
    ids: tuple[str, ...]
    taken_by: npt.NDArray[np.int64]

    @property
    def least(self) -> float:
        """The least margin of a hole that is taken [m]; NaN where none is."""
        taken = np.flatnonzero(self.taken_by >= 0)
        return float(self.margins[self.taken_by[taken], taken].min()) if taken.size else np.nan


def share(
    jobs: Sequence[Job], *, balance: bool = False, machines: Machines = HERE, progress: Progress | None = None
) -> Shares:
    """Share the holes of a part among robots: each to the robot that has the greatest margin on it.

    Args:
        jobs: one per robot. A hole of the same id is the same hole of the part: it lies at the same place of the part
            frame, and each job says where the part stands as seen from its robot.
        balance: no robot takes more than an even share of the holes, or no more above it than it must; among such
            shares the least margin counts first, then the sum of the margins.
        machines: to run it on; the answer is the same.
        progress: called with the number of strokes known and in all.

    Raises:
        InputError: fewer than two jobs, a hole that is not the same in two jobs, a hole with a given motion.
    """
    if len(jobs) < 2:
        raise InputError(f"{len(jobs)} job", where="jobs", accepted="two jobs or more, one per robot")
    ids = tuple(dict.fromkeys(hole.id for job in jobs for hole in job.holes))
    _check_same(jobs)
    asked = [(r, hole) for r, job in enumerate(jobs) for hole in job.holes]
    margins = np.full((len(jobs), len(ids)), np.nan)
    with Workers(_Depth([(job.robot, job.tool, job.settings) for job in jobs]), machines) as processes:
        for done, ((r, hole), depth) in enumerate(zip(asked, processes.map(asked, len(asked)), strict=True)):
            if progress:
                progress(done, len(asked))
            margins[r, ids.index(hole.id)] = depth - hole.depth
    if progress:
        progress(len(asked), len(asked))
    return Shares(margins, ids, assigned(margins, balance=balance))


def assigned(margins: Array, *, balance: bool = False) -> npt.NDArray[np.int64]:
    """The robot that takes each hole, shape (H,); -1: none.

    Args:
        margins: of each robot and hole [m], shape (R, H); below 0 or NaN: it cannot drill it.
        balance: as `share` has it.
    """
    able = np.where(margins >= 0, margins, -np.inf)
    if not balance:
        return np.where(np.isfinite(able).any(axis=0), able.argmax(axis=0), -1)
    drillable = np.flatnonzero(np.isfinite(able).any(axis=0))
    taken = np.full(margins.shape[1], -1)
    if drillable.size:
        taken[drillable] = _balanced(able[:, drillable])
    return taken


def _balanced(able: Array) -> npt.NDArray[np.int64]:
    """As even as the holes allow; first the least margin, then the sum counts."""
    robots, holes = able.shape
    loads = range(-(-holes // robots), holes + 1)
    most = next(load for load in loads if _filled(np.isfinite(able), load) is not None)
    bars = np.unique(able[np.isfinite(able)])
    low, high = 0, len(bars) - 1  # the highest bar that every hole can clear
    while low < high:
        middle = (low + high + 1) // 2
        low, high = (middle, high) if _filled(able >= bars[middle], most) is not None else (low, middle - 1)
    found = _filled(able >= bars[low], most, able)
    assert found is not None
    return found


def _filled(allowed: npt.NDArray[np.bool_], most: int, worth: Array | None = None) -> npt.NDArray[np.int64] | None:
    """A robot for each hole among those allowed, shape (R, H), none with more than `most`; None: there is no way."""
    holes = allowed.shape[1]
    gain = np.where(allowed, 0.0 if worth is None else worth, 0.0)
    cost = np.where(allowed, -gain, 1e6 + holes * float(gain.max(initial=0.0)))  # not allowed: dearer than all else
    rows, columns = linear_sum_assignment(np.repeat(cost, most, axis=0).T)
    found = np.asarray(columns // most, dtype=np.int64)
    return found if allowed[found, rows].all() else None


class _Depth:
    """The task of a worker."""

    def __init__(self, robots: Sequence[tuple[Robot, Tool, Settings]]) -> None:
        self.robots = robots

    def __call__(self, asked: tuple[int, Hole]) -> float:
        robot, tool, settings = self.robots[asked[0]]
        drilling = Drilling(robot, tool, asked[1], settings.limit_margin)
        return deepest_in_cycle(drilling, settings.without_proof).depth


def _check_same(jobs: Sequence[Job]) -> None:
    first: dict[str, Array] = {}
    for job in jobs:
        T = np.linalg.inv(job.T_base_part)
        for hole in job.holes:
            if hole.profile is not None:
                raise InputError("has a given motion", where=f"{job.name}, hole {hole.id}",
                                 accepted="holes without psi_deg")  # fmt: skip
            there = np.array([*(T[:3, :3] @ hole.target + T[:3, 3]), *(T[:3, :3] @ hole.direction), hole.depth])
            known = first.setdefault(hole.id, there)
            if np.abs(known - there).max() > SAME:
                raise InputError(
                    "is not the same hole as in another job",
                    where=f"{job.name}, hole {hole.id}",
                    accepted="the same target_mm, direction and depth_mm in the part frame, or another id",
                )
