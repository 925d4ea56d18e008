"""What is drilled in the benchmarks: the positions of the thesis, and random holes in random directions."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import NamedTuple

import numpy as np

import zerorev as zr
from zerorev.motion import kinematics
from zerorev.motion.drilling import Drilling
from zerorev.search.exact import search
from zerorev.verify.certificate.certify import certify_hole

__all__ = [
    "NO_THRESHOLD",
    "Answer",
    "Case",
    "certified",
    "certified_holes",
    "drilled",
    "exact",
    "mirrored",
    "positions",
    "random_place",
]

NO_THRESHOLD = zr.Settings(min_rate=0.0)
JOB = Path(__file__).parents[1] / "examples" / "jobs" / "thesis_least_travel.yaml"


@dataclass(frozen=True)
class Case:
    """One hole, with the robot and the tool that drill it."""

    robot: zr.Robot
    tool: zr.Tool
    hole: zr.Hole


class Answer(NamedTuple):
    """A motion, and the branch on which it runs."""

    profile: zr.Profile
    branch: int


def positions() -> list[Case]:
    """Positions 1 to 3 of the thesis; the motion threshold is off."""
    job = zr.read_job(JOB)
    return [Case(job.robot, job.tool, hole) for hole in job.holes]


def random_place(seed: int) -> Case:
    """A hole in a direction spread evenly over the sphere, which some joints within the limits reach; 10 mm deep."""
    first, rng = positions()[0], np.random.default_rng(seed)
    robot, tool = first.robot, first.tool
    while True:
        direction, target = rng.normal(size=3), rng.uniform([-0.7, -0.7, 0.0], [0.7, 0.7, 1.1])
        hole = zr.Hole(f"random {seed}", target, direction / np.linalg.norm(direction), 0.01)
        T = kinematics.tcp_pose(hole, 0.0, rng.uniform(-np.pi, np.pi)) @ np.linalg.inv(tool.T_flange_tcp)
        joints = kinematics.inverse(robot, T)
        if ((joints > robot.limits.lower) & (joints < robot.limits.upper)).all(axis=1).any():
            return Case(robot, tool, hole)


def drilled(case: Case, depth: float) -> Case:
    """The same hole with another stroke [m]."""
    return replace(case, hole=replace(case.hole, depth=depth))


def mirrored(case: Case) -> Case:
    """The hole on the other side of the xz plane: same branch, psi of the other sign.

    It is the same problem where the tool and the limits of axes 1, 4 and 6 are the same both ways.
    """
    flip = np.array([1.0, -1.0, 1.0])
    hole = case.hole
    other = replace(hole, target=hole.target * flip, direction=hole.direction * flip, psi_zero=-hole.psi_zero * flip)
    return replace(case, hole=other)


def exact(case: Case) -> Answer | None:
    """The exact straight-leg optimum, no motion threshold, spin periodic."""
    found = search(Drilling(case.robot, case.tool, case.hole), NO_THRESHOLD)
    return None if found is None else Answer(found.profile, found.branch)


def certified(seed: int, settings: zr.Settings) -> zr.Plan | None:
    """A plan of one random hole, certified; None where a joint reverses, or nothing is certified."""
    case = random_place(seed)
    job = zr.Job(name=f"seed {seed}", robot=case.robot, tool=case.tool, holes=(case.hole,), settings=settings)
    plan = zr.plan_job(job)
    hole = plan.holes[0]
    if hole.score is None or hole.score.reversals:
        return None
    certificate = certify_hole(plan.robot, plan.tool, plan.settings, hole)
    return (
        replace(plan, holes=(replace(hole, certificate=certificate),)) if certificate.verdict == "certified" else None
    )


def certified_holes(seed: int, count: int, settings: zr.Settings) -> Iterator[zr.Plan]:
    """Plans of so many random holes, the first ones from a seed on that are certified."""
    found = 0
    while found < count:
        plan = certified(seed, settings)
        if plan is not None:
            found += 1
            yield plan
        seed += 1
