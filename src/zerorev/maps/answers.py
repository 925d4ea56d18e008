"""What a workspace map says, cell by cell: its best cells, its mirror in Y, and how far it is from another map.

A map on a grid and one at given points are read into the same form, a row per target and a column per direction.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from zerorev.errors import InputError
from zerorev.maps.frames import frame_of
from zerorev.model._arrays import Array
from zerorev.model.quantity import Quantity, quantities

if TYPE_CHECKING:
    from xarray import Dataset

__all__ = [
    "Cells",
    "Difference",
    "Field",
    "best_cells",
    "cells_of",
    "difference",
    "mirror_in_y",
]

SAME_MM = 1e-3  # targets that are nearer to each other are one
SAME_DIRECTION = 1e-6
SPINS = ("psi_start_deg", "psi_target_deg", "psi_end_deg")


@dataclass(frozen=True)
class Field:
    """Numbers of T targets by D directions.

    Attributes:
        quantity: what `value` is.
        target: [mm], shape (T, 3).
        direction: unit vectors, shape (D, 3).
        value: in the unit of the quantity, NaN where there is none, shape (T, D).
        T_base_part: the frame of targets and directions, shape (4, 4), translation [m].
    """

    quantity: Quantity
    target: Array
    direction: Array
    value: Array
    T_base_part: Array = field(default_factory=lambda: np.eye(4), kw_only=True)

    @property
    def best(self) -> Array:
        """The best value over all directions, NaN where no direction has an answer, shape (T,)."""
        chosen = np.fmax if self.quantity.more_is_better else np.fmin
        return np.asarray(chosen.reduce(self.value, axis=1))


@dataclass(frozen=True)
class Cells(Field):
    """A map, and the motion in each of its cells.

    Attributes:
        branch: 0..7, or -1 where there is no motion, shape (T, D).
        psi_deg: spins at start, target and end [deg], or NaN, shape (T, D, 3).
    """

    branch: npt.NDArray[np.int8]
    psi_deg: Array


def cells_of(found: Dataset) -> Cells:
    """The cells of a map.

    Args:
        found: a workspace map, over x, y, z and direction, or over point and direction.

    Raises:
        InputError: the dataset holds none of the quantities that a map may.
    """
    quantity = next((each for each in quantities().values() if each.variable in found), None)
    if quantity is None:
        accepted = ", ".join(dict.fromkeys(each.variable for each in quantities().values()))
        raise InputError("holds no quantity of a map", accepted=accepted)
    title = str(found[quantity.variable].attrs.get("long_name", quantity.title)).partition(";")[0]
    quantity = replace(quantity, title=title)
    places = ("point",) if "point" in found.dims else ("x", "y", "z")
    axes = [np.asarray(found[name].values, dtype=float) for name in ("x_mm", "y_mm", "z_mm")]
    if len(places) == 3:
        axes = [axis.ravel() for axis in np.meshgrid(*axes, indexing="ij")]
    direction = np.stack([found[f"direction_{axis}"].values for axis in "xyz"], axis=-1).astype(float)
    shape = (axes[0].size, len(direction))

    def flat(name: str) -> Array:
        return np.asarray(found[name].transpose(*places, "direction").values).reshape(shape)

    value = flat(quantity.variable).astype(float)
    if quantity.variable == "deepest_mm":
        value = np.where(value > 0, value, np.nan)
    elif quantity.variable == "reversals":
        value = np.where(value >= 0, value, np.nan)
    branch = flat("branch").astype(np.int8) if "branch" in found else np.full(shape, -1, dtype=np.int8)
    psi = [flat(name).astype(float) if name in found else np.full(shape, np.nan) for name in SPINS]
    spins, T = np.stack(psi, axis=-1), frame_of(found)
    return Cells(quantity, np.stack(axes, axis=-1), direction, value, branch, spins, T_base_part=T)


def best_cells(cells: Cells, count: int) -> list[tuple[int, int]]:
    """Rows and columns of the best cells, best first; the first of several that are alike."""
    cost = (-cells.value if cells.quantity.more_is_better else cells.value).ravel()
    order = np.argsort(cost, kind="stable")[:count]  # NaN comes last
    return [divmod(int(n), cells.value.shape[1]) for n in order if not np.isnan(cost[n])]


@dataclass(frozen=True)
class Difference:
    """Two maps on the cells that both have.

    Attributes:
        quantity: of both.
        target: common targets [mm], shape (T, 3).
        direction: common directions, shape (D, 3).
        first: values of the one, NaN where it has no answer, shape (T, D).
        second: of the other.
    """

    quantity: Quantity
    target: Array
    direction: Array
    first: Array
    second: Array

    @property
    def change(self) -> Array:
        """Second less first, NaN where it is unknown, shape (T, D).

        Where no stroke is possible, the deepest is 0; cells without an answer in either map are left out.
        """
        lost = np.isnan(self.first) & np.isnan(self.second)
        filled = (np.where(np.isnan(each), self.quantity.nothing, each) for each in (self.second, self.first))
        second, first = filled
        return np.where(lost, np.nan, second - first)

    @property
    def fields(self) -> tuple[Field, Field, Field]:
        """First, second, and the change."""
        changed = replace(self.quantity, title=f"change of {self.quantity.title}")
        named = (self.quantity, self.first), (self.quantity, self.second), (changed, self.change)
        first, second, change = (Field(quantity, self.target, self.direction, value) for quantity, value in named)
        return first, second, change


def difference(first: Field, second: Field) -> Difference:
    """Set two maps side by side on their common cells.

    Raises:
        InputError: they hold different quantities, or have no cell in common.
    """
    if first.quantity.variable != second.quantity.variable:
        raise InputError(
            f"one holds {first.quantity.variable}, the other {second.quantity.variable}",
            accepted="two maps of one quantity",
        )
    if not np.allclose(first.T_base_part, second.T_base_part, rtol=0, atol=SAME_MM / 1e3):
        raise InputError("the maps lie in different frames", accepted="two maps around jobs with one part_frame")
    a, b = _common(first.target, second.target, SAME_MM)
    c, d = _common(first.direction, second.direction, SAME_DIRECTION)
    if not a.size or not c.size:
        what = "targets" if not a.size else "directions"
        raise InputError(f"the maps have no {what} in common", accepted="maps that share cells")
    return Difference(
        first.quantity, first.target[a], first.direction[c], first.value[np.ix_(a, c)], second.value[np.ix_(b, d)]
    )


def mirror_in_y(cells: Field) -> Difference | None:
    """The map beside its own mirror image in Y, on the cells that have one; None where none has, or in a part frame.

    Only a cell of Y > 0, or of Y = 0 and a direction that leans to Y > 0, is set beside its mirror, so that no pair is
    counted twice; a cell that is its own mirror is left out.
    """
    if not np.array_equal(cells.T_base_part, np.eye(4)):
        return None
    turned = np.array([1.0, -1.0, 1.0])
    a, b = _common(cells.target, cells.target * turned, SAME_MM)
    c, d = _common(cells.direction, cells.direction * turned, SAME_DIRECTION)
    if not a.size or not c.size:
        return None
    y, lean = cells.target[a, 1], cells.direction[c, 1]
    chosen = (y[:, None] > SAME_MM) | ((np.abs(y[:, None]) <= SAME_MM) & (lean > SAME_DIRECTION))
    if not chosen.any():
        return None
    first, second = cells.value[np.ix_(a, c)], cells.value[np.ix_(b, d)]
    return Difference(
        cells.quantity, cells.target[a], cells.direction[c], np.where(chosen, first, np.nan),
        np.where(chosen, second, np.nan),
    )  # fmt: skip


def _common(first: Array, second: Array, same: float) -> tuple[npt.NDArray[np.intp], npt.NDArray[np.intp]]:
    """Rows of two lists of places, shape (N, 3) and (M, 3), that are the same place, in the order of the first."""
    whole = [np.ascontiguousarray(np.round(each / same).astype(np.int64)) for each in (first, second)]
    one, other = (each.view([("", np.int64)] * 3).ravel() for each in whole)
    _, a, b = np.intersect1d(one, other, return_indices=True)
    order = np.argsort(a)
    return a[order], b[order]
