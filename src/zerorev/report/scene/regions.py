"""Regions of the twist plane: outlines of where something holds, drawn finer than the grid that they are found on."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import numpy.typing as npt
from contourpy import FillType, contour_generator

from zerorev.model._arrays import Array

__all__ = ["Region", "regions"]

HALVINGS = 7  # an edge is found to 1/256 of the grid

Bytes = npt.NDArray[np.uint8]
ZoneAt = Callable[[Array, Array], Bytes]


@dataclass(frozen=True)
class Region:
    """Where a map is of one zone or a graver one.

    Attributes:
        zone: its number; a graver one has a greater.
        rings: closed outlines, holes in it among them (even-odd), each (n, 2): stand-off [m] and spin [rad].
        edges: the same without what runs along the border of the map, each (n, 2).
    """

    zone: int
    rings: tuple[Array, ...]
    edges: tuple[Array, ...]


def regions(standoff: Array, psi: Array, zone: Bytes, levels: Sequence[int], zone_at: ZoneAt) -> tuple[Region, ...]:
    """The regions of the zones, drawn to where the zone changes between two points of the grid.

    Args:
        standoff: of the grid [m], shape (S,).
        psi: of the grid [rad], shape (P,).
        zone: on the grid, shape (S, P).
        levels: the zones whose regions are wanted.
        zone_at: the zone at points of stand-off [m] and spin [rad], shape (n,) each.
    """
    drawn = []
    for level in levels:
        contours = contour_generator(z=(zone >= level).astype(float), fill_type=FillType.OuterOffset)
        filled = zip(*contours.filled(0.5, np.inf), strict=True)
        rings = [points[a:b] for points, offsets in filled for a, b in pairwise(offsets)]
        drawn.append((level, rings, contours.lines(0.5)))
    curves = [curve for _, rings, edges in drawn for curve in (*rings, *edges)]
    of_each = [level for level, rings, edges in drawn for _ in (*rings, *edges)]
    found = iter(_on_the_edge(standoff, psi, curves, of_each, zone_at))
    return tuple(
        Region(level, tuple(next(found) for _ in rings), tuple(next(found) for _ in edges))
        for level, rings, edges in drawn
    )


def _on_the_edge(standoff: Array, psi: Array, curves: list[Array], levels: list[int], zone_at: ZoneAt) -> list[Array]:
    """Curves through midpoints between two points of the grid, drawn to where the zone changes between those two.

    Args:
        standoff: of the grid [m], shape (S,).
        psi: of the grid [rad], shape (P,).
        curves: in numbers of the grid, each (n, 2): spin first.
        levels: of each curve: on one side of it the zone is as grave or graver, on the other milder.
        zone_at: the zone at points.

    Returns:
        the curves, each (n, 2): stand-off [m] and spin [rad].
    """
    if not curves:
        return []
    sizes = [len(curve) for curve in curves]
    each = np.column_stack([np.repeat(levels, sizes), np.concatenate(curves)[:, ::-1]])
    points, where = np.unique(each, axis=0, return_inverse=True)
    level, at = points[:, 0], points[:, 1:]
    low, high = np.floor(at), np.ceil(at)  # the same but for the coordinate of which the point is a midpoint

    def place(t: Array) -> tuple[Array, Array]:
        s, p = (low + t[:, None] * (high - low)).T
        return standoff[0] + s * (standoff[1] - standoff[0]), psi[0] + p * (psi[1] - psi[0])

    def grave(t: Array) -> npt.NDArray[np.bool_]:
        return np.asarray(zone_at(*place(t)) >= level)

    begins = grave(np.zeros(len(at)))
    t, step = np.full(len(at), 0.5), 0.25
    for _ in range(HALVINGS):
        t += np.where(grave(t) == begins, step, -step)
        step /= 2
    return np.split(np.stack(place(t), axis=-1)[where.ravel()], np.cumsum(sizes)[:-1])
