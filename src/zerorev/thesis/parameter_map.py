"""The thesis' objective over all three spins of a hole, each cell on its best branch (thesis sec. 4.7, Fig. 26).

The map is built from pairs of legs (theory §3): 100 x 100 legs a posture instead of 100^3 motions on eight branches.
"""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import asdict
from importlib.metadata import version
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from zerorev.errors import InputError
from zerorev.kernels.cube import cube
from zerorev.model._arrays import Array
from zerorev.model.hole import Hole
from zerorev.model.robot import Robot
from zerorev.model.tool import Tool
from zerorev.motion.drilling import Drilling
from zerorev.thesis.sampled import SAMPLES, SampledObjective, Weighing
from zerorev.thesis.threads import share_out

if TYPE_CHECKING:
    from xarray import Dataset

__all__ = ["AXES", "FORMAT", "check_memory", "parameter_map", "spin_axis"]

Int8 = npt.NDArray[np.int8]
FORMAT = "zerorev.parameter_map/1"
AXES = ("psi_target_deg", "psi_start_deg", "psi_end_deg")
CELL_BYTES = 8 + 1 + 1 + 8  # score, reversals, branch, travel
ROOM = 1.2  # times the cells alone: what writing and looking at them takes besides
TARGETS_AT_ONCE = 8  # between two words of progress


def parameter_map(
    robot: Robot,
    tool: Tool,
    hole: Hole,
    weighing: Weighing = Weighing(),  # noqa: B008, frozen
    *,
    size: int = 100,
    samples: int = SAMPLES,
    psi_range: tuple[float, float] = (-np.pi, np.pi),
    psi_target: npt.ArrayLike | None = None,
    threads: int | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> Dataset:
    """Eq. 4.7 of every motion on a grid of spins, on its best branch; what `SampledObjective` gives, cell by cell.

    Args:
        robot: the arm.
        tool: the drill.
        hole: what is drilled; its branch, where it has one, is the only one examined.
        weighing: weights, motion threshold, and how the turns are chosen.
        size: K, spins on each of the three axes.
        samples: steps on the whole path, an even number.
        psi_range: first and last spin of each axis [rad].
        psi_target: spins at the target [rad], shape (M,), instead of K in that range: a slice or a few.
        threads: how many to use; None: one per core. The map is the same.
        progress: called with the number of spins at the target done and in all.

    Returns:
        a dataset over psi_target_deg (M), psi_start_deg (K) and psi_end_deg (K) with `score` (eq. 4.7, 1 or more where
        no branch can run the motion), `reversals` and `branch` (-1 there) and `travel_deg` (NaN there).

    Raises:
        InputError: a size below 2, a map that does not fit into memory, a range that is none.
    """
    outer = spin_axis(size, psi_range)
    target = outer if psi_target is None else np.atleast_1d(np.asarray(psi_target, dtype=float))
    if target.ndim != 1 or target.size == 0 or not np.isfinite(target).all():
        raise InputError("no list of finite spins", where="psi_target", accepted="one spin or more [rad]")
    check_memory(target.size, size)
    score, reversals, branch, travel = _evaluate(robot, tool, hole, weighing, samples, outer, target, threads, progress)
    import xarray

    axes = zip(AXES, (target, outer, outer), ("target", "start", "end"), strict=True)
    return xarray.Dataset(
        {
            "score": (AXES, score, {"units": "1", "long_name": "objective (thesis eq. 4.7), best branch"}),
            "reversals": (AXES, reversals, {"units": "1", "long_name": "reversals; -1: cannot be run"}),
            "branch": (AXES, branch, {"units": "1", "long_name": "best branch; -1: cannot be run"}),
            "travel_deg": (AXES, travel, {"units": "deg", "long_name": "travel of all joints"}),
        },
        {
            name: (name, np.rad2deg(psi), {"units": "deg", "long_name": f"spin at the {word}"})
            for name, psi, word in axes
        },
        {
            "format": FORMAT,
            "version": version("zerorev"),
            "robot": robot.name,
            "tool": tool.name,
            "hole": hole.id,
            "target_mm": (hole.target * 1e3).tolist(),
            "direction": hole.direction.tolist(),
            "psi_zero": hole.psi_zero.tolist(),
            "depth_mm": hole.depth * 1e3,
            "samples": samples,
            "turns": weighing.turns,
            "settings": json.dumps(asdict(weighing)),
        },
    )


def check_memory(targets: int, size: int) -> None:
    """Make sure, before it is begun, that a map fits into memory.

    Args:
        targets: spins at the target.
        size: spins at the start, and at the end.

    Raises:
        InputError: it does not; says how much is needed and how much there is.
    """
    needed, there = ROOM * CELL_BYTES * targets * size**2, _memory_available()
    if needed > there:
        most = int((there / ROOM / CELL_BYTES) ** (1 / 3))
        raise InputError(
            f"a map of {targets} x {size} x {size} spins needs {_bytes(needed)} of memory, {_bytes(there)} are there",
            where="size",
            accepted=f"about {most} or less",
        )


def spin_axis(size: int, psi_range: tuple[float, float] = (-np.pi, np.pi)) -> Array:
    """Evenly spaced spins [rad], both ends of the range among them, shape (size,).

    Raises:
        InputError: a size below 2, a range that is none.
    """
    if isinstance(size, bool) or not isinstance(size, int | np.integer) or size < 2:
        raise InputError(f"{size!r} spins an axis", where="size", accepted="a whole number, 2 or more")
    first, last = psi_range
    if not (np.isfinite([first, last]).all() and first < last):
        raise InputError(
            f"{first!r} to {last!r}", where="psi_range", accepted="two finite spins [rad], the lesser first"
        )
    return np.linspace(first, last, size)


def _evaluate(
    robot: Robot, tool: Tool, hole: Hole, weighing: Weighing, samples: int, outer: Array, target: Array,
    threads: int | None, progress: Callable[[int, int], None] | None,
) -> tuple[Array, Int8, Int8, Array]:  # fmt: skip
    """Score, reversals, branch and travel [deg], each (M, K, K)."""
    drilling = Drilling(robot, tool, hole)
    objective = SampledObjective(drilling, weighing, samples=samples, threads=threads)
    plane, limits = drilling.plane, robot.limits
    weights = weighing.reversals / 6, weighing.travel / (12 * np.pi)
    shape = (target.size, outer.size, outer.size)
    score, travel = np.empty(shape), np.empty(shape)
    reversals, branch = np.empty(shape, dtype=np.int8), np.empty(shape, dtype=np.int8)
    only = -1 if hole.branch is None else hole.branch

    def look(part: slice, at: Array, *out: Array | Int8) -> None:
        cube(
            robot.arm, plane, hole.depth, objective.fractions, objective.least, limits.lower, limits.upper,
            weighing.turns == "first_point", weights, only, outer, at[part], *(each[part] for each in out),
        )  # fmt: skip

    for first in range(0, target.size, TARGETS_AT_ONCE):
        if progress:
            progress(first, target.size)
        some = [each[first : first + TARGETS_AT_ONCE] for each in (target, score, reversals, branch, travel)]
        share_out(lambda part, some=some: look(part, *some), some[0].size, threads)  # type: ignore[misc]
    if progress:
        progress(target.size, target.size)
    np.rad2deg(travel, out=travel)
    return score, reversals, branch, travel


def _memory_available() -> float:
    """Bytes that are available without swapping, infinite where the system does not say."""
    try:
        lines = Path("/proc/meminfo").read_text(encoding="ascii").splitlines()
        return 1024.0 * next(int(line.split()[1]) for line in lines if line.startswith("MemAvailable"))
    except (OSError, StopIteration):
        return float("inf")


def _bytes(count: float) -> str:
    return f"{count / 2**30:.1f} GiB" if count >= 2**30 else f"{count / 2**20:.0f} MiB"
