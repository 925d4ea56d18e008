"""Where most holes of a job fail: would they be drilled if a user had meant its directions or angles the other way?

A few of the holes are planned again in the other way, so that the cost is bounded regardless of the size of the job.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from zerorev.model._arrays import Array, rotation_rpy, rpy_of, transform
from zerorev.model.finding import Finding
from zerorev.model.hole import Hole
from zerorev.model.job import Job
from zerorev.model.plan import HolePlan
from zerorev.planning.hole import plan

__all__ = ["TriedOtherwise", "turned_round", "with_angles_swapped"]

MOST_TRIED = 8  # holes that are planned again, in each way
ENOUGH = 0.75  # of those that are tried


class TriedOtherwise:
    """Takes the answers of a job one by one, and says at the end what would have helped where most of them fail."""

    def __init__(self, job: Job) -> None:
        """Begin.

        Args:
            job: that is answered.
        """
        self._job = job
        self._count = 0
        self._failed: list[Hole] = []
        self._poor: list[Hole] = []

    def add(self, answer: HolePlan) -> None:
        """Take the next answer."""
        self._count += 1
        asked = self._job.holes[self._count - 1] if self._count <= len(self._job.holes) else answer.hole
        if asked.profile is not None:
            return
        if answer.score is None:
            self._failed.append(asked)
        if answer.score is None or answer.score.reversals:
            self._poor.append(asked)

    def findings(self) -> tuple[Finding, ...]:
        """What would have helped; nothing where most holes are drilled without a reversal."""
        found = []
        if _most(self._poor, self._count) and (self._count > 1 or self._failed) and self._towards_the_robot():
            tried, drilled = self._drilled(self._poor, lambda hole: turned_round(hole))
            if drilled >= ENOUGH * tried:
                message = (
                    f"{len(self._poor)} of {self._count} holes fail or reverse, and they are drilled towards the robot;"
                    f" with the directions turned round {_of(drilled, tried, len(self._poor))} drilled without a "
                    "reversal: do they point out of the material (normals: out)?"
                )
                found.append(Finding("warning", "normals", message))
        swapped = with_angles_swapped(self._job.T_base_part)
        if _most(self._failed, self._count) and swapped is not None:
            change = swapped @ np.linalg.inv(self._job.T_base_part)
            tried, drilled = self._drilled(self._failed, lambda hole: _moved(hole, change))
            if drilled >= ENOUGH * tried:
                angles = ", ".join(f"{angle:.6g}" for angle in np.rad2deg(rpy_of(swapped[:3, :3])).round(6) + 0.0)
                message = (
                    f"{len(self._failed)} of {self._count} holes cannot be drilled; with the angles of part_frame in "
                    f"the other order {_of(drilled, tried, len(self._failed))} drilled: are they A, B, C, which are "
                    f"yaw, pitch, roll? rpy_deg: [{angles}]"
                )
                found.append(Finding("warning", "frame_angles", message))
        return tuple(found)

    def _towards_the_robot(self) -> bool:
        """Whether the holes that are poor point, on the whole, towards the robot's shoulder."""
        shoulder = np.array([0.0, 0.0, self._job.robot.arm.c1])
        return sum(float(hole.direction @ (hole.target - shoulder)) for hole in self._poor) < 0

    def _drilled(self, holes: Sequence[Hole], change: Callable[[Hole], Hole]) -> tuple[int, int]:
        """How many holes were tried in another way, and how many of them are drilled without a reversal."""
        settings = replace(self._job.settings, legs="straight", weights=(), proof_boxes=0, keep_lead_in=False)
        chosen = [holes[n] for n in np.linspace(0, len(holes) - 1, min(len(holes), MOST_TRIED)).astype(int)]
        drilled = 0
        for hole in chosen:
            answer = plan(self._job.robot, self._job.tool, change(hole), settings)
            drilled += answer.score is not None and answer.score.reversals == 0
        return len(chosen), drilled


def _most(some: Sequence[Hole], count: int) -> bool:
    return 2 * len(some) > count


def _of(drilled: int, tried: int, all_of_them: int) -> str:
    """So many of so many are drilled; says where only some were tried."""
    return f"{drilled} of {tried} {'are' if tried == all_of_them else 'that were tried are'}"


def turned_round(hole: Hole) -> Hole:
    """The hole drilled from the other side: to the same bottom, in the other direction.

    Args:
        hole: any.
    """
    return replace(hole, direction=-hole.direction)


def _moved(hole: Hole, T: Array) -> Hole:
    R = T[:3, :3]
    return replace(hole, target=R @ hole.target + T[:3, 3], direction=R @ hole.direction, psi_zero=R @ hole.psi_zero)


def with_angles_swapped(T_base_part: Array) -> Array | None:
    """The frame whose roll, pitch and yaw are this one's yaw, pitch and roll; None where that is the same.

    Args:
        T_base_part: shape (4, 4).
    """
    roll, pitch, yaw = rpy_of(T_base_part[:3, :3])
    R = rotation_rpy(yaw, pitch, roll)
    return None if np.allclose(R, T_base_part[:3, :3], atol=1e-6) else transform(R, T_base_part[:3, 3])
