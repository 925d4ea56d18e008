"""The map around the holes of a job: a grid in their plane, in the frame of the part."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from zerorev.errors import InputError
from zerorev.files.moved_job import frame_text
from zerorev.files.units import m, mm, rad
from zerorev.maps.cells import SPINS
from zerorev.maps.frames import in_frame
from zerorev.model._arrays import Array, rotation_rpy, transform
from zerorev.model.hole import Hole
from zerorev.model.job import Job
from zerorev.model.map_task import MapTask, Question
from zerorev.motion.drilling import Drilling
from zerorev.search.straight import target_spins

__all__ = ["Around", "task_around"]

FLAT = 5e-4  # [m] that the holes may be apart along an axis of the part across which their plane stands
LEAST_MARGIN = 0.05  # [m]
CELLS = 24  # along the longer side, about, where no size of a cell is given
NICE = (1.0, 2.0, 5.0, 10.0)  # sizes of a cell [mm], times powers of ten
MOST_CELLS = 100_000


class Around(NamedTuple):
    """A map around a job.

    Attributes:
        task: the map.
        margin: how far it goes beyond the holes [m].
        cell: from target to target [m].
        off: how far a hole lies off its plane at most [m].
        lean: how far a hole leans from its direction at most [rad].
        left_out: ids of holes that are out of reach, around which no map is drawn.
        own_frame: whether the plane is none of the part frame's, so that the map has a frame of its own.
    """

    task: MapTask
    margin: float
    cell: float
    off: float
    lean: float
    own_frame: bool
    left_out: tuple[str, ...] = ()


def task_around(job: Job, margin: float | None = None, cell: float | None = None) -> Around:
    """The map of the deepest strokes around the holes of a job, in the direction in which they are drilled.

    The targets lie in the plane of the holes. It stands across an axis of the part frame where they have one place
    along it; else it is the plane nearest to them, and the map gets a frame of its own, whose Z is its normal.

    Args:
        job: its robot, tool and settings are those of the map.
        margin: how far it goes beyond the holes [m]; None: half of their greater extent, 50 mm at least.
        cell: from target to target [m]; None: so that the longer side has some 24.

    Raises:
        InputError: a margin or a cell that cannot be, too many cells, or a task that `MapTask` refuses.
    """
    for name, value, least in (("--margin-mm", margin, 0.0), ("--cell-mm", cell, 1e-5)):
        if value is not None and not least <= value < np.inf:
            raise InputError(f"{value * 1e3:g} mm", where=name, accepted=f"{least * 1e3:g} mm or more")
    holes = [hole for hole in job.holes if _reached(job, hole)] or list(job.holes)
    T, across, own = _frame(job, holes)
    targets = in_frame(T, np.array([hole.target for hole in holes]))
    drills = np.array([hole.direction for hole in holes]) @ T[:3, :3]
    drill = _middle(drills)
    low, high = targets.min(axis=0), targets.max(axis=0)
    extent = float(np.delete(high - low, across).max())
    margin = max(LEAST_MARGIN, extent / 2) if margin is None else margin
    cell = _nice((extent + 2 * margin) / CELLS) if cell is None else cell
    middle = float(np.mean(targets[:, across]))
    axes = [
        np.array([mm(middle)]) if axis == across else _axis(low[axis] - margin, high[axis] + margin, cell)
        for axis in range(3)
    ]
    cells = int(np.prod([len(axis) for axis in axes]))
    if cells > MOST_CELLS:
        raise InputError(f"{cells:,} cells", where="--cell-mm", accepted=f"{MOST_CELLS:,} cells or less: a wider one")
    x, y, z = (np.asarray(axis.round(6) + 0.0) for axis in axes)
    task = MapTask(_question(job), (x, y, z), drill[None], T_base_part=T)
    off = float(np.abs(targets[:, across] - middle).max())
    lean = float(np.arctan2(np.linalg.norm(np.cross(drills, drill), axis=1), drills @ drill).max())
    kept = {hole.id for hole in holes}
    return Around(task, margin, cell, off, lean, own, tuple(hole.id for hole in job.holes if hole.id not in kept))


def _question(job: Job) -> Question:
    reference = job.psi_reference
    if reference not in ("base_y", "nearest_base"):
        reference = tuple(job.holes[0].psi_zero.tolist())
    return Question(job.robot, job.tool, "deepest", job.settings, reference)


def _reached(job: Job, hole: Hole) -> bool:
    """Whether the target is reached at all, regardless of the joint limits."""
    spins = target_spins(None, SPINS)
    return not np.isnan(Drilling.of(job, hole).angles(0.0, spins)).all()


def _frame(job: Job, holes: Sequence[Hole]) -> tuple[Array, int, bool]:
    """The frame of the map, the axis that its plane stands across, and whether it is none of the part's."""
    part = job.T_base_part
    targets = in_frame(part, np.array([hole.target for hole in holes]))
    drill = _middle(np.array([hole.direction for hole in holes]) @ part[:3, :3])
    flat = np.flatnonzero(np.ptp(targets, axis=0) <= FLAT)
    if flat.size:
        return _as_written(part), int(flat[np.abs(drill[flat]).argmax()]), False
    centre = targets.mean(axis=0)
    _, spreads, ways = np.linalg.svd(targets - centre)
    normal = ways[2]
    if spreads[1] <= FLAT:  # a row of holes: of the planes through it the one that is drilled most squarely
        normal = drill - drill @ ways[0] * ways[0]
        normal = normal / np.linalg.norm(normal) if np.linalg.norm(normal) > 1e-6 else ways[2]
    normal = normal if normal @ drill <= 0 else -normal  # Z points out of the part
    x = np.eye(3)[int(np.abs(normal[:2]).argmin())]
    x = x - x @ normal * normal
    x /= np.linalg.norm(x)
    return _as_written(part @ transform(np.column_stack([x, np.cross(normal, x), normal]), centre)), 2, True


def _as_written(T: Array) -> Array:
    """A frame as its digits in the file have it."""
    text = frame_text(T)
    written = transform(rotation_rpy(*rad(np.array(text["rpy_deg"]))), m(np.array(text["xyz_mm"])))
    return np.eye(4) if np.allclose(written, np.eye(4), rtol=0, atol=1e-12) else written


def _middle(drills: Array) -> Array:
    """The mean of directions, shape (3,); of directions that cancel each other the first."""
    mean = np.asarray(drills.mean(axis=0))
    length = float(np.linalg.norm(mean))
    return np.asarray(mean / length if length > 1e-3 else drills[0])


def _axis(low: float, high: float, cell: float) -> Array:
    """Targets [mm] on whole multiples of a cell, from the last below `low` to the first above `high`."""
    first, last = np.floor(low / cell + 1e-9), np.ceil(high / cell - 1e-9)
    return np.asarray(np.arange(first, last + 1) * mm(cell))


def _nice(cell: float) -> float:
    """The next size of a cell [m] that people choose: 1, 2 or 5 of a power of ten."""
    size = max(1e-4, cell) * 1e3
    power = 10.0 ** np.floor(np.log10(size))
    return float(next(nice for nice in NICE if nice * power >= size * (1 - 1e-9)) * power / 1e3)
