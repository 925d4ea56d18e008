"""The thesis' own two ways to a deepest stroke: a swarm asked at one stroke after another (sec. 4.6, eq. 4.9, 4.10)."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from zerorev.model.job import Settings
from zerorev.model.profile import Profile
from zerorev.motion.drilling import Drilling
from zerorev.thesis.sampled import SampledObjective, Weighing
from zerorev.thesis.swarm import TABLE_4, run_swarm

__all__ = ["RANGE_MM", "RESOLUTION_MM", "STEP_MM", "Stroke", "Way", "bisect", "step_down", "thesis_stroke"]

Way = Literal["bisection", "stepping"]

RANGE_MM = (0.0, 200.0)  # sec. 4.6: "bounded between 0-200mm"
RESOLUTION_MM = 1.0
STEP_MM = 5.0  # of Table 5: "decremented the plunge depth by 5mm"


@dataclass(frozen=True)
class Stroke:
    """The deepest stroke at which the swarm found zero reversals, as it samples them.

    Attributes:
        depth: [m]; 0 where it found none at any stroke.
        profile: the motion it found there, or None.
        branch: 0..7, or None.
    """

    depth: float
    profile: Profile | None = None
    branch: int | None = None


def thesis_stroke(drilling: Drilling, settings: Settings, way: Way, seed: int) -> Stroke:
    """The deepest stroke of a hole as the thesis looks for it: a lower bound, as a swarm may miss what is there.

    Args:
        drilling: target, direction and reference of the spin; its depth is not examined.
        settings: whose `min_rate` the objective asks for, and whose `psi_bound` holds the swarm, +-180 deg where none.
        way: halving 0 to 200 mm (eq. 4.9), or stepping down from 200 mm by 5 mm.
        seed: of every swarm.
    """
    bound = settings.psi_bound or math.pi
    scheme = replace(TABLE_4, stop_at_zero=True, seed=seed, bounds=(-bound, bound))
    weighing = Weighing(min_rate=settings.min_rate)
    deepest = Stroke(0.0)

    def succeeds(depth_mm: float) -> bool:
        nonlocal deepest
        depth = depth_mm / 1e3
        found = run_swarm(SampledObjective(drilling.deep(depth), weighing, threads=1), scheme)
        if found.reversals != 0:
            return False
        if depth > deepest.depth:
            deepest = Stroke(depth, Profile.straight(depth, *np.asarray(found.spins).tolist()), found.branch)
        return True

    if way == "bisection":
        bisect(succeeds, *RANGE_MM, RESOLUTION_MM)
    else:
        step_down(succeeds, RANGE_MM[1], STEP_MM)
    return deepest


def bisect(succeeds: Callable[[float], bool], low: float, high: float, resolution: float) -> tuple[float, int]:
    """Eq. 4.9 and 4.10: the deepest stroke at which zero was found, and how many strokes were tried.

    Args:
        succeeds: whether zero reversals are found at a stroke.
        low: bound of the search, likewise the answer where nothing succeeds.
        high: bound of the search.
        resolution: of the answer, all in one unit.
    """
    steps = math.ceil(math.log2((high - low) / resolution))
    for _ in range(steps):
        middle = low + (high - low) / 2
        low, high = (middle, high) if succeeds(middle) else (low, middle)
    return low, steps


def step_down(succeeds: Callable[[float], bool], high: float, step: float) -> tuple[float, int]:
    """From the deepest stroke downwards, until zero reversals are found: the stroke, and how many were tried."""
    depth, tried = high, 0
    while depth > 0:
        tried += 1
        if succeeds(depth):
            return depth, tried
        depth -= step
    return 0.0, tried
