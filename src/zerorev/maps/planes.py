"""The planes of a workspace map: one after the other along an axis, each as it is seen along the drill."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from zerorev.errors import InputError
from zerorev.maps.answers import Field
from zerorev.model._arrays import Array
from zerorev.model.quantity import Quantity

__all__ = ["AXES", "Across", "Plane", "is_grid", "planes_of", "view_flips"]

Across = Literal["x", "y", "z"]
AXES: tuple[Across, ...] = ("x", "y", "z")


@dataclass(frozen=True)
class Plane:
    """One plane of a map.

    Attributes:
        quantity: what `value` is.
        across: the axis that the plane stands across.
        at: its place on that axis [mm].
        right: the axis along its width, z along the height where it can be.
        up: the axis along its height.
        width: places along `right` [mm], ascending, shape (U,).
        height: places along `up` [mm], ascending, shape (V,).
        value: in the unit of the quantity, NaN where there is no answer, shape (V, U).
        towards: 1 or -1: the drill goes up or down the axis that the plane stands across.
    """

    quantity: Quantity
    across: Across
    at: float
    right: Across
    up: Across
    width: Array
    height: Array
    value: Array
    towards: int

    @property
    def flipped(self) -> bool:
        """Whether `right` runs to the left, as it does for who looks along the drill."""
        return view_flips(self.right, self.up) == (self.towards > 0)

    @property
    def name(self) -> str:
        """The plane's equation."""
        return f"{self.across.upper()} = {self.at:g} mm"

    def surface(self, scale: float) -> Array:
        """Places [mm], shape (V, U, 3): the plane, offset along its axis and the drill by the value times a scale."""
        places = np.empty((*self.value.shape, 3))
        places[..., AXES.index(self.right)] = self.width
        places[..., AXES.index(self.up)] = self.height[:, None]
        offset = np.nan_to_num(self.value) * scale * self.towards
        places[..., AXES.index(self.across)] = self.at + offset
        return places


def view_flips(right: Across, up: Across) -> bool:
    """Whether `right` runs to the left for who looks up the third axis, because right x up points away from them."""
    return (AXES.index(up) - AXES.index(right)) % 3 == 1


def planes_of(found: Field, direction: int = 0, across: Across | None = None) -> list[Plane]:
    """The planes of a map along one axis, for one direction.

    Args:
        found: of which the targets are a grid, in any order.
        direction: which of its directions.
        across: the axis that the planes stand across; None: the only one across which there is a single plane, or else
            the one that the direction is nearest to.

    Raises:
        InputError: the targets do not form a grid; a direction that the map lacks.
    """
    if not 0 <= direction < len(found.direction):
        raise InputError(f"direction {direction}", accepted=f"0 to {len(found.direction) - 1}")
    grid = [np.unique(places, return_inverse=True) for places in found.target.T]
    axes, places = [values for values, _ in grid], tuple(place.ravel() for _, place in grid)
    shape = tuple(axis.size for axis in axes)
    if np.unique(np.ravel_multi_index(places, shape)).size != len(found.target) or np.prod(shape) != len(found.target):
        raise InputError("its targets do not form a grid, so it has no planes", accepted="a map on a grid")
    value = np.empty(shape)
    value[places] = found.value[:, direction]
    drill = found.direction[direction]
    if across is None:
        flat = [n for n in range(3) if shape[n] == 1]
        across = AXES[flat[0] if len(flat) == 1 else int(np.abs(drill).argmax())]
    up: Across = "z" if across != "z" else "x"
    right = next(axis for axis in AXES if axis not in (across, up))
    order = [AXES.index(axis) for axis in (across, up, right)]
    at, height, width = (axes[n] for n in order)
    towards = -1 if drill[order[0]] < 0 else 1
    return [
        Plane(found.quantity, across, float(place), right, up, width, height, part, towards)
        for place, part in zip(at, value.transpose(order), strict=True)
    ]


def is_grid(found: Field) -> bool:
    """Whether a map has planes: its targets are a grid."""
    try:
        return bool(planes_of(found))
    except InputError:
        return False
