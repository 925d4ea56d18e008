"""The cells of a workspace map: the question, put to one target and direction after another."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from zerorev.model._arrays import Array
from zerorev.model.hole import Hole
from zerorev.model.map_task import Question
from zerorev.model.quantity import Found, quantity
from zerorev.motion.drilling import Drilling
from zerorev.motion.joint_path import turns_within
from zerorev.search.broken_legs import Numbers
from zerorev.search.free_deepest import SEGMENTS
from zerorev.search.straight import target_spins

__all__ = ["KNOTS", "SPINS", "STATUS", "Block", "answer", "columns_of"]

SPINS = 240  # at the target in one turn, by which reach is judged
KNOTS = 2 * SEGMENTS + 1  # breakpoints of a motion on free legs, at most

STATUS = ("answered", "none", "joint_limits", "out_of_reach", "robot_base")
"""What became of a cell, by its number: answered; no such motion or stroke, though the target is reached; reached
outside the joint limits or the bound on the spin alone; out of reach; inside the robot's base."""
ANSWERED, NONE, LIMITS, OUT_OF_REACH, IN_BASE = range(5)

Values = dict[str, npt.NDArray[np.generic]]


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
    kind = quantity(question.quantity)
    whole = {
        "status": "what became of the cell; -1: not yet examined",
        "branch": "inverse-kinematics branch; -1: none",
    }
    count = kind.unit == "1"
    columns = {kind.variable: ("i1" if count else "f8", kind.unit, kind.title + ("; -1: none" if count else ""))}
    columns |= {name: ("i1", "1", title) for name, title in whole.items()}
    columns |= {f"psi_{place}_deg": ("f8", "deg", f"spin at the {place}") for place in ("start", "target", "end")}
    if question.settings.legs == "free":
        columns |= {"standoff_mm": ("f8", "mm", "stand-off at the breakpoints of the motion"),
                    "psi_deg": ("f8", "deg", "spin at the breakpoints of the motion")}  # fmt: skip
    if question.settings.cycle.kind == "chip_break":
        columns["plunge_deg_per_mm"] = ("f8", "deg/mm", "slope of the plunge, from which its breaks follow")
    return columns


def answer(question: Question, block: Block) -> Values:
    """The variables of a block of cells, each with the cells along its first axis.

    Args:
        question: what is asked.
        block: of which cells.
    """
    values: Values = {}
    wanted = quantity(question.quantity)
    for name, (kind, _, _) in columns_of(question).items():
        shape = (len(block.cells), KNOTS) if name in ("standoff_mm", "psi_deg") else len(block.cells)
        values[name] = np.full(shape, -1 if kind == "i1" else np.nan, dtype=kind)
    for n, cell in enumerate(block.cells):
        if block.in_base[n]:
            values["status"][n] = IN_BASE
            continue
        hole = question.hole(block.target[n], block.direction[n])
        found = wanted.solve(question, hole, question.seed + int(cell))
        if found is None:
            values["status"][n] = _why_none(question, hole)
        else:
            _write(values, n, wanted.variable, found)
    return values


def _write(values: Values, n: int, variable: str, found: Found) -> None:
    values[variable][n] = found.value
    values["status"][n], values["branch"][n] = ANSWERED, found.branch
    values["psi_target_deg"][n] = np.rad2deg(found.psi_target)
    if found.profile is not None:
        values["psi_start_deg"][n], values["psi_end_deg"][n] = np.rad2deg(found.profile.psi[[0, -1]])
        if "plunge_deg_per_mm" in values:
            values["plunge_deg_per_mm"][n] = np.rad2deg(Numbers.of(found.profile).plunge) / 1e3
        if "psi_deg" in values:
            knots = len(found.profile.psi)
            values["standoff_mm"][n, :knots] = found.profile.standoff * 1e3
            values["psi_deg"][n, :knots] = np.rad2deg(found.profile.psi)


def _why_none(question: Question, hole: Hole) -> int:
    """Whether the target is reached at all, and within the joint limits."""
    drilling = Drilling.of(question, hole)

    def angles(psi_bound: float | None) -> Array:
        return drilling.angles(0.0, target_spins(psi_bound, SPINS))

    if np.isnan(angles(None)).all():
        return OUT_OF_REACH
    there = angles(question.settings.psi_bound)
    _, fits = turns_within(there, there, drilling.limits)
    return NONE if (fits.all(axis=-1) & ~np.isnan(there).any(axis=-1)).any() else LIMITS
