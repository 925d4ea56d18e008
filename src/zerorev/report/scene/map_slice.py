"""A plane of a workspace map as coloured cells, shown in the robot's cell and clicked; and how one is asked for."""

from __future__ import annotations

import tempfile
from collections.abc import Generator
from contextlib import closing
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Literal

import numpy as np
import numpy.typing as npt
from scipy.spatial import cKDTree

from zerorev.errors import InputError
from zerorev.files.units import m, mm
from zerorev.maps.answers import cells_of
from zerorev.maps.cells import STATUS
from zerorev.maps.planes import AXES, Across
from zerorev.maps.replan import hole_of
from zerorev.maps.run import answerers, answering
from zerorev.maps.workspace import MapStore, read_workspace_map
from zerorev.model._arrays import Array
from zerorev.model.hole import Hole
from zerorev.model.map_task import MapTask, Question
from zerorev.model.quantity import Quantity
from zerorev.report.words.map_run import WORDS
from zerorev.workers import Machines

if TYPE_CHECKING:
    from xarray import Dataset

__all__ = ["MOST_SHOWN", "WHY_COLOURS", "Cut", "Key", "MapSlice", "computed", "plane_task", "slice_of"]

MOST_SHOWN = 10_000  # cells of a plane, as computed for a page or shown in it
NOMINAL_SIZE_MM = 50.0  # of a cell that has no neighbour
KEYS = 5  # values that the legend names

# of a cell without an answer: the farther from one the darker, and no value has a grey
WHY_COLOURS = {
    "none": "#b8b8b8", "joint_limits": "#8f8f8f", "out_of_reach": "#5c5c5c", "robot_base": "#303030",
    "not_yet": "#e4e4e4",
}  # fmt: skip
WHY_WORDS = {**WORDS, "not_yet": "not yet examined"}
NOT_YET = -1  # the status of a cell that the map has not come to

Cut = Literal["x", "y", "z", "drill"]  # the axis that a plane stands across


@dataclass(frozen=True)
class Key:
    """One line of a legend.

    Attributes:
        colour: as #rrggbb.
        words: what it means, with the unit.
    """

    colour: str
    words: str


@dataclass(frozen=True, eq=False)
class MapSlice:
    """Cells of a map for one direction: one of its planes, or all of its points.

    Attributes:
        found: the map itself.
        direction: which of its directions, from 0.
        across: the axis that the plane stands across; None: the map is one of points, and all of them are shown.
        at: which of the map's planes, from 0.
        quantity: what `value` is.
        drill: unit vector into the material, shape (3,).
        position: targets [m], base frame, shape (N, 3).
        value: in the unit of the quantity, NaN where there is no answer, shape (N,).
        status: what became of each cell, by its number in `zerorev.maps.cells.STATUS`; -1: not examined, shape (N,).
        row: the number of each target in the map, shape (N,).
        edges: the two edges of a cell [m], shape (2, 3).
    """

    found: Dataset
    direction: int
    across: Across | None
    at: int
    quantity: Quantity
    drill: Array
    position: Array
    value: Array
    status: npt.NDArray[np.int8]
    row: npt.NDArray[np.int64]
    edges: Array

    def index(self, cell: int) -> dict[str, int]:
        """A cell's place in the dataset, as `hole_of` and `isel` take it.

        Raises:
            InputError: no such cell.
        """
        if not 0 <= cell < len(self.row):
            raise InputError(f"no cell {cell}", where="cell", accepted=f"0 to {len(self.row) - 1}")
        names = [name for name in ("point", *AXES) if name in self.found.sizes]
        places = np.unravel_index(self.row[cell], [self.found.sizes[name] for name in names])
        return {name: int(place) for name, place in zip(names, places, strict=True)} | {"direction": self.direction}

    def words(self, cell: int) -> str:
        """What a cell holds: its value with the unit, or why it has none."""
        if np.isfinite(self.value[cell]):
            return self.quantity.shown(float(self.value[cell]))
        return WHY_WORDS[_why(int(self.status[cell]))]

    def hole(self, cell: int, depth: float) -> Hole:
        """The hole of a cell, with the motion that the map found; named by its target.

        Args:
            cell: which.
            depth: stroke [m] of a hole for whose target the map has no motion, though it is reached.

        Raises:
            InputError: no such cell; or its target is not reached, and why.
        """
        hole = hole_of(self.found, **self.index(cell))
        if hole.profile is None:
            if np.isnan(self.value[cell]) and _why(int(self.status[cell])) != "none":
                raise InputError(self.words(cell), where="cell", accepted="a cell that is reached")
            hole = replace(hole, depth=depth, branch=None)
        target = " ".join(f"{value + 0.0:g}" for value in np.round(mm(hole.target), 3))
        lean = f" d{self.direction}" if self.found.sizes["direction"] > 1 else ""
        return replace(hole, id=f"cell {target}{lean}")

    @cached_property
    def best(self) -> int | None:
        """The best cell, or None where none has an answer."""
        if not np.isfinite(self.value).any():
            return None
        return int(np.nanargmax(self.value) if self.quantity.more_is_better else np.nanargmin(self.value))

    @cached_property
    def colours(self) -> tuple[str, ...]:
        """Of each cell, as #rrggbb: the colours of the figures."""
        known = np.isfinite(self.value)
        shown = iter(self._colours(self.value[known]))
        each = zip(known, self.status.tolist(), strict=True)
        return tuple(next(shown) if there else WHY_COLOURS[_why(status)] for there, status in each)

    @cached_property
    def legend(self) -> tuple[Key, ...]:
        """Values and what they look like, the least first; then why cells have none, of those there are."""
        known = self.value[np.isfinite(self.value)]
        keys: list[Key] = []
        if self.quantity.variable == "reversals":
            counts = np.unique(np.minimum(known, 6.0))
            words = [f"{count:.0f}{'+' if count == 6 else ''} reversal{'' if count == 1 else 's'}" for count in counts]
            keys += map(Key, self._colours(counts), words)
        elif known.size:
            low = 0.0 if self.quantity.more_is_better else float(known.min())
            values = np.linspace(low, float(known.max()), KEYS)
            keys += map(Key, self._colours(values), map(self.quantity.shown, values.tolist()))
        lacking = np.bincount(self.status[np.isnan(self.value)] + 1, minlength=len(STATUS) + 1)
        for number, count in enumerate(lacking.tolist(), NOT_YET):
            if count:
                why = _why(number)
                keys.append(Key(WHY_COLOURS[why], f"{WHY_WORDS[why]}: {count:,}"))
        return tuple(keys)

    def _colours(self, values: Array) -> list[str]:
        from matplotlib.colors import to_hex

        from zerorev.report.figures.workspace_map import colours_of

        cmap, norm = colours_of(self.quantity, self.value)
        clipped = np.minimum(values, 6.0) if self.quantity.variable == "reversals" else values
        return [to_hex(cmap(float(norm(value)))) for value in clipped]


def slice_of(found: Dataset, direction: int = 0, across: Across | None = None, at: int | None = None) -> MapSlice:
    """A plane of a map on a grid, or all points of a map of points.

    Args:
        found: a workspace map, also one that is not finished.
        direction: which of its directions, from 0.
        across: the axis that the plane stands across; None: the only one across which there is a single plane, or else
            the one that the direction is nearest to. Not examined for points.
        at: which of those planes, from 0; None: the one with the best cell.

    Raises:
        InputError: no such direction or plane, a dataset that is not a workspace map, or more cells than can be shown.
    """
    cells = cells_of(found)
    if not 0 <= direction < len(cells.direction):
        raise InputError(f"direction {direction}", where="direction", accepted=f"0 to {len(cells.direction) - 1}")
    drill, value = cells.direction[direction], cells.value[:, direction]
    rows = np.arange(len(value))
    if "point" in found.sizes:
        across, at = None, 0
    else:
        across = across or _facing(found, drill)
        place = np.unravel_index(rows, [found.sizes[axis] for axis in AXES])[AXES.index(across)]
        at = _best_plane(value, place, cells.quantity.more_is_better) if at is None else at
        rows = rows[place == at]
    if not 0 < rows.size <= MOST_SHOWN:
        accepted = f"1 to {MOST_SHOWN:,} cells" if rows.size else f"0 to {found.sizes[across] - 1}" if across else ""
        raise InputError(f"{rows.size:,} cells" if rows.size else f"plane {at}", where="plane", accepted=accepted)
    order = [name for name in ("point", *AXES, "direction") if name in found.sizes]
    status = found["status"].transpose(*order).values.reshape(cells.value.shape)[rows, direction]
    target, T = cells.target[rows], cells.T_base_part
    edges = m(_edges(target, across, drill)) @ T[:3, :3].T
    return MapSlice(
        found, direction, across, at, cells.quantity, drill @ T[:3, :3].T, m(target) @ T[:3, :3].T + T[:3, 3],
        value[rows], status.astype(np.int8), rows, np.asarray(edges),
    )  # fmt: skip


def plane_task(
    question: Question, centre: Array, drill: Array, cut: Cut, size: tuple[float, float], spacing: float
) -> MapTask:
    """The map of a plane through a target, as wide and high as asked for or a little less, the target in its middle.

    Args:
        question: what is asked in each cell.
        centre: target [m], shape (3,).
        drill: unit vector into the material, shape (3,).
        cut: the axis that the plane stands across: of the base frame, or the drill's.
        size: width and height [m]; the height is along z where the plane does not lie flat.
        spacing: from cell to cell [m].

    Raises:
        InputError: a number that cannot be, more cells than can be shown, or a task that `MapTask` refuses.
    """
    for name, number in (("width", size[0]), ("height", size[1]), ("spacing", spacing)):
        if not (np.isfinite(number) and number >= (0 if name != "spacing" else 1e-4)):
            accepted = "a length of 0 mm or more" if name != "spacing" else "a length of 0.1 mm or more"
            raise InputError(f"{mm(number):g} mm", where=name, accepted=accepted)
    halves = [int(min(length / 2 / spacing + 1e-9, MOST_SHOWN)) for length in size]
    count = (2 * halves[0] + 1) * (2 * halves[1] + 1)
    if count > MOST_SHOWN:
        raise InputError(f"{count:,} cells or more", where="spacing", accepted=f"{MOST_SHOWN:,} or less: a wider one")
    across, up = (mm(np.arange(-half, half + 1) * spacing) for half in halves)
    if cut != "drill":
        right_axis, up_axis = _in_plane(cut)
        axes = [mm(np.asarray(centre))[n : n + 1] for n in range(3)]
        axes[right_axis], axes[up_axis] = axes[right_axis] + across, axes[up_axis] + up
        x, y, z = (np.round(axis, 6) for axis in axes)
        return MapTask(question, (x, y, z), drill[None, :])
    right, upwards = _frame(drill)
    points = mm(centre) + (across[:, None, None] * right + up[:, None] * upwards).reshape(-1, 3)
    ids = tuple(f"{n:g} {k:g}" for n in across for k in up)
    x, y, z = np.round(points, 6).T
    return MapTask(question, (x, y, z), drill[None, :], ids)


def computed(task: MapTask, machines: Machines) -> Generator[Dataset, None, None]:
    """Run a map in a folder that is gone afterwards.

    Args:
        task: the map.
        machines: to compute it on.

    Yields:
        the map as it is after each of its chunks, of which `zerorev.maps.chunks.Chunks` tells the number.

    Raises:
        ZerorevError: as `zerorev.maps.run.run_map` has it.
    """
    with tempfile.TemporaryDirectory(prefix="zerorev-map-") as folder:
        path = Path(folder) / "map.zarr"
        with (
            answerers(task, machines) as workers,
            MapStore(path, task) as store,
            closing(answering(store, store.missing(), workers)) as written,
        ):
            for _ in written:
                yield read_workspace_map(path)


def _why(status: int) -> str:
    return "not_yet" if status == NOT_YET else STATUS[status]


def _facing(found: Dataset, drill: Array) -> Across:
    """The axis across which there is a single plane, or that the drill is nearest to."""
    flat = [axis for axis in AXES if found.sizes[axis] == 1]
    return flat[0] if len(flat) == 1 else AXES[int(np.abs(drill).argmax())]


def _best_plane(value: Array, place: npt.NDArray[np.intp], more_is_better: bool) -> int:
    """The plane with the best cell, the middle one where none has an answer."""
    if not np.isfinite(value).any():
        return int(place.max() + 1) // 2
    return int(place[np.nanargmax(value) if more_is_better else np.nanargmin(value)])


def _in_plane(across: Across) -> tuple[int, int]:
    """Numbers of the axes to the right and up, z up where it can be."""
    up = 2 if across != "z" else 0
    return next(n for n in range(3) if AXES[n] != across and n != up), up


def _frame(drill: Array) -> Array:
    """Unit vectors across a drill, the second as far upwards as can be, shape (2, 3)."""
    upwards = np.array([0.0, 0.0, 1.0]) if abs(drill[2]) < 0.9 else np.array([1.0, 0.0, 0.0])
    upwards = upwards - upwards @ drill * drill
    upwards /= np.linalg.norm(upwards)
    return np.stack([np.cross(upwards, drill), upwards])


def _edges(target_mm: Array, across: Across | None, drill: Array) -> Array:
    """The edges of a cell [mm], shape (2, 3): as long as the nearest neighbour is away."""
    if across is None:
        away = cKDTree(target_mm).query(target_mm, k=2)[0][:, 1]  # inf for a single point
        return _frame(drill) * (float(away.min()) if np.isfinite(away).any() else NOMINAL_SIZE_MM)
    edges = np.zeros((2, 3))
    for edge, axis in zip(edges, _in_plane(across), strict=True):
        steps = np.diff(np.unique(target_mm[:, axis]))
        edge[axis] = steps.min() if steps.size else NOMINAL_SIZE_MM
    return edges
