"""The cells of a workspace map: the question, put to one target and direction after another."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from zerorev.model._arrays import Array
from zerorev.model.hole import Hole
from zerorev.model.map_task import Question
from zerorev.model.profile import Profile
from zerorev.motion.joint_path import turns_within
from zerorev.motion.kinematics import inverse, tcp_pose
from zerorev.search.free_deepest import SEGMENTS
from zerorev.search.optimum import best_motion, deepest_as_drilled
from zerorev.search.prediction import narrowest
from zerorev.search.rank import Candidate
from zerorev.search.straight import target_spins
from zerorev.thesis.stroke import thesis_stroke

__all__ = ["KINDS", "KNOTS", "STATUS", "Block", "Kind", "answer", "columns_of"]

SPINS = 240  # at the target in one turn, by which reach is judged
KNOTS = 2 * SEGMENTS + 1  # breakpoints of a motion on free legs, at most

STATUS = ("answered", "none", "joint_limits", "out_of_reach", "robot_base")
"""What became of a cell, by its number: answered; no such motion or stroke, though the target is reached; reached
outside the joint limits or the bound on the spin alone; out of reach; inside the robot's base."""
ANSWERED, NONE, LIMITS, OUT_OF_REACH, IN_BASE = range(5)

Values = dict[str, npt.NDArray[np.generic]]


@dataclass(frozen=True)
class Kind:
    """A quantity as a map holds it.

    Attributes:
        variable: its name in the dataset.
        unit: of it.
        title: in words.
        cells: of a chunk, at most: some seconds of work.
        solve: finds it.
    """

    variable: str
    unit: str
    title: str
    cells: int
    solve: Callable[[Question, Hole, int], Found | None]


class Found(NamedTuple):
    """The answer of a cell.

    Attributes:
        value: in the unit of the quantity.
        branch: 0..7.
        profile: the motion; or None, where there is but a spin at the target.
        psi_target: spin there [rad].
    """

    value: float
    branch: int
    profile: Profile | None
    psi_target: float


class Block(NamedTuple):
    """Cells that are answered together; what is sent to a worker.

    Attributes:
        number: of the chunk.
        cells: numbers of the cells, of which the seeds of a swarm are made, shape (n,).
        target: [m], shape (n, 3).
        direction: unit vectors, shape (n, 3).
        in_base: which targets lie inside the robot's base, shape (n,).
    """

    number: int
    cells: npt.NDArray[np.int64]
    target: Array
    direction: Array
    in_base: npt.NDArray[np.bool_]


def columns_of(question: Question) -> dict[str, tuple[str, str, str]]:
    """The variables of a map: data type, unit and title of each by its name; -1 or NaN where there is nothing."""
    kind = KINDS[question.quantity]
    whole = {
        "status": "what became of the cell; -1: not yet looked at",
        "branch": "inverse-kinematics branch; -1: none",
    }
    columns = {kind.variable: ("i1" if kind.unit == "1" else "f8", kind.unit, kind.title)}
    columns |= {name: ("i1", "1", title) for name, title in whole.items()}
    columns |= {f"psi_{place}_deg": ("f8", "deg", f"spin at the {place}") for place in ("start", "target", "end")}
    if question.settings.legs == "free":
        columns |= {"standoff_mm": ("f8", "mm", "stand-off at the breakpoints of the motion"),
                    "psi_deg": ("f8", "deg", "spin at the breakpoints of the motion")}  # fmt: skip
    return columns


def answer(question: Question, block: Block) -> Values:
    """The variables of a block of cells, each with the cells along its first axis.

    Args:
        question: what is asked.
        block: of which cells.
    """
    values: Values = {}
    for name, (kind, _, _) in columns_of(question).items():
        shape = (len(block.cells), KNOTS) if name in ("standoff_mm", "psi_deg") else len(block.cells)
        values[name] = np.full(shape, -1 if kind == "i1" else np.nan, dtype=kind)
    for n, cell in enumerate(block.cells):
        if block.in_base[n]:
            values["status"][n] = IN_BASE
            continue
        hole = question.hole(block.target[n], block.direction[n])
        found = KINDS[question.quantity].solve(question, hole, question.seed + int(cell))
        if found is None:
            values["status"][n] = _why_none(question, hole)
        else:
            _write(values, n, KINDS[question.quantity].variable, found)
    return values


def _write(values: Values, n: int, variable: str, found: Found) -> None:
    values[variable][n] = found.value
    values["status"][n], values["branch"][n] = ANSWERED, found.branch
    values["psi_target_deg"][n] = np.rad2deg(found.psi_target)
    if found.profile is not None:
        values["psi_start_deg"][n], values["psi_end_deg"][n] = np.rad2deg(found.profile.psi[[0, -1]])
        if "psi_deg" in values:
            knots = len(found.profile.psi)
            values["standoff_mm"][n, :knots] = found.profile.standoff * 1e3
            values["psi_deg"][n, :knots] = np.rad2deg(found.profile.psi)


def _why_none(question: Question, hole: Hole) -> int:
    """Whether the target is reached at all, and within the joint limits."""
    robot, tool = question.robot, question.tool

    def angles(psi_bound: float | None) -> Array:
        spins = target_spins(psi_bound, SPINS)
        return inverse(robot, tcp_pose(hole, 0.0, spins) @ np.linalg.inv(tool.T_flange_tcp))

    if np.isnan(angles(None)).all():
        return OUT_OF_REACH
    there = angles(question.settings.psi_bound)
    _, fits = turns_within(there, there, robot.limits)
    return NONE if (fits.all(axis=-1) & ~np.isnan(there).any(axis=-1)).any() else LIMITS


# --- the quantities ---------------------------------------------------------------------------------------------------


def _deepest(question: Question, hole: Hole, _: int) -> Found | None:
    found = deepest_as_drilled(question.robot, question.tool, hole, question.settings.without_proof)
    return _stroke(found.depth, found.profile, found.branch)


def _thesis_bisection(question: Question, hole: Hole, seed: int) -> Found | None:
    found = thesis_stroke(question.robot, question.tool, hole, question.settings, "bisection", seed)
    return _stroke(found.depth, found.profile, found.branch)


def _thesis_stepping(question: Question, hole: Hole, seed: int) -> Found | None:
    found = thesis_stroke(question.robot, question.tool, hole, question.settings, "stepping", seed)
    return _stroke(found.depth, found.profile, found.branch)


def _stroke(depth: float, profile: Profile | None, branch: int | None) -> Found | None:
    if profile is None or branch is None:
        return None
    return Found(depth * 1e3, branch, profile, float(profile.psi[profile.corner]))


def _fewest_reversals(question: Question, hole: Hole, _: int) -> Found | None:
    best = _best_motion(question, hole)
    return None if best is None else _motion(float(best.reversals), best)


def _least_travel(question: Question, hole: Hole, _: int) -> Found | None:
    best = _best_motion(question, hole)
    if best is None or best.reversals > 0 or not best.keeps_threshold:
        return None
    return _motion(float(np.rad2deg(best.score.travel)), best)


def _greatest_margin(question: Question, hole: Hole, _: int) -> Found | None:
    margin = replace(question, settings=replace(question.settings, objective="margin"))
    best = _best_motion(margin, hole)
    if best is None or best.reversals > 0:
        return None
    return _motion(float(np.rad2deg(best.score.min_rate.min())) / 1e3, best)


def _twist_spread(question: Question, hole: Hole, _: int) -> Found | None:
    cheapest = narrowest(question.robot, question.tool, hole, question.settings)
    if not np.isfinite(cheapest.width):
        return None
    return Found(float(np.rad2deg(cheapest.spread)) / 1e3, cheapest.branch, None, cheapest.psi)


def _best_motion(question: Question, hole: Hole) -> Candidate | None:
    return best_motion(question.robot, question.tool, hole, question.settings.without_proof)


def _motion(value: float, best: Candidate) -> Found:
    return Found(value, best.branch, best.profile, best.psi_target)


KINDS: dict[str, Kind] = {
    "deepest": Kind("deepest_mm", "mm", "deepest stroke with zero reversals", 256, _deepest),
    "fewest_reversals": Kind("reversals", "1", "fewest reversals; -1: none", 256, _fewest_reversals),
    "least_travel": Kind("travel_deg", "deg", "least travel of all joints with zero reversals", 256, _least_travel),
    "greatest_margin": Kind(
        "margin_deg_per_mm", "deg/mm", "greatest margin (slowest joint) with zero reversals", 256, _greatest_margin
    ),
    "twist_spread": Kind("twist_spread_deg_per_mm", "deg/mm", "least twist spread at the target", 256, _twist_spread),
    "thesis_bisection": Kind("deepest_mm", "mm", "deepest stroke by a swarm and bisection", 4, _thesis_bisection),
    "thesis_stepping": Kind("deepest_mm", "mm", "deepest stroke by a swarm and steps of 5 mm", 4, _thesis_stepping),
}
