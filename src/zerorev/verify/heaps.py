"""Solids as heaps of triangles and lines for the check, in groups with spheres about them (`verify.solids`)."""

from __future__ import annotations

from functools import lru_cache
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from zerorev.model._arrays import Array
from zerorev.model.body import Box, Capsule, Shape

__all__ = ["EDGES", "Heap", "corners_of", "heap_of"]

Whole = npt.NDArray[np.int64]

TOGETHER = 32  # pieces in a group, groups in a group of groups
EDGES = np.array([[x, y, z] for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-0.5, 0.5)])
SIDES = ((0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3))  # corners round a box


class Heap(NamedTuple):
    """The pieces of all solids, with spheres about groups of them; each in the frame of its solid.

    Attributes:
        corners: of the pieces [m], shape (P, 3, 3); a line has its second corner twice.
        sides: 3, or 2 of a line, shape (P,).
        starts: first piece of each group, and behind the last, shape (G + 1,).
        axes: a line that each group lies about [m], shape (G, 6).
        wide: how far from it at most [m], shape (G,).
        spheres: about each group: centre and radius [m], shape (G, 4).
        members: first group of each group of groups, shape (S + 1,).
        balls: about each of these, shape (S, 4).
        groups: first group of each solid, shape (N + 1,).
        supers: first group of groups of each solid, shape (N + 1,).
        thick: of each solid [m], shape (N,).
    """

    corners: Array
    sides: Whole
    starts: Whole
    axes: Array
    wide: Array
    spheres: Array
    members: Whole
    balls: Array
    groups: Whole
    supers: Whole
    thick: Array


def corners_of(shape: Shape) -> Array:
    """The pieces of a shape [m], shape (P, 3, 3)."""
    if isinstance(shape, Capsule):
        return shape.ends[None, [0, 1, 1]]
    if isinstance(shape, Box):
        box = EDGES * shape.size
        return np.array([box[list(each)] for a, b, c, d in SIDES for each in ((a, b, c), (a, c, d))])
    return np.asarray(shape.vertices[shape.faces])


def heap_of(shapes: list[Shape]) -> Heap:
    """The pieces of all of them."""
    parts = [_grouped(shape) for shape in shapes]
    counts = [len(part.corners) for part in parts]
    groups = [len(part.wide) for part in parts]
    before, groups_before = np.cumsum([0, *counts]), np.cumsum([0, *groups])
    return Heap(
        corners=np.concatenate([part.corners for part in parts]),
        sides=np.concatenate([part.sides for part in parts]),
        starts=np.concatenate([*(part.starts[:-1] + n for part, n in zip(parts, before[:-1], strict=True)),
                               before[-1:]]),
        axes=np.concatenate([part.axes for part in parts]),
        wide=np.concatenate([part.wide for part in parts]),
        spheres=np.concatenate([part.spheres for part in parts]),
        members=np.concatenate([*(part.members[:-1] + n for part, n in zip(parts, groups_before[:-1], strict=True)),
                                groups_before[-1:]]),
        balls=np.concatenate([part.balls for part in parts]),
        groups=groups_before,
        supers=np.cumsum([0, *(len(part.balls) for part in parts)]),
        thick=np.concatenate([part.thick for part in parts]),
    )  # fmt: skip


@lru_cache(maxsize=16)
def _grouped(shape: Shape) -> Heap:
    """The pieces of one shape; those that lie together are grouped along a curve through space (Morton order)."""
    corners = corners_of(shape)
    middles = corners.mean(axis=1)
    low, high = middles.min(axis=0), middles.max(axis=0)
    cells = ((middles - low) / np.maximum((high - low).max(), 1e-12) * 1023).astype(np.int64)
    corners = corners[np.argsort(_spread(cells), kind="stable")]
    starts = np.append(np.arange(0, len(corners), TOGETHER), len(corners))
    spheres = _balls(corners, starts)
    members = np.append(np.arange(0, len(spheres), TOGETHER), len(spheres))
    balls = _balls(corners, np.append(starts[members[:-1]], len(corners)))
    line = isinstance(shape, Capsule)
    return Heap(
        corners=corners,
        sides=np.full(len(corners), 2 if line else 3),
        starts=starts,
        axes=corners[:, :2].reshape(1, 6) if line else np.concatenate([spheres[:, :3], spheres[:, :3]], axis=1),
        wide=np.zeros(1) if line else spheres[:, 3].copy(),
        spheres=spheres,
        members=members,
        balls=balls,
        groups=np.array([0, len(spheres)]),
        supers=np.array([0, len(balls)]),
        thick=np.array([shape.radius if isinstance(shape, Capsule) else 0.0]),
    )


def _spread(cells: Whole) -> Whole:
    """Morton numbers: the bits of three coordinates by turns."""
    found = np.zeros(len(cells), dtype=np.int64)
    for bit in range(10):
        for axis in range(3):
            found |= ((cells[:, axis] >> bit) & 1) << (3 * bit + axis)
    return found


def _balls(corners: Array, starts: Whole) -> Array:
    """Spheres about runs of pieces, shape (G, 4)."""
    low = np.minimum.reduceat(corners.min(axis=1), starts[:-1])
    high = np.maximum.reduceat(corners.max(axis=1), starts[:-1])
    centre = (low + high) / 2
    which = np.repeat(np.arange(len(centre)), np.diff(starts))
    away = np.linalg.norm(corners - centre[which][:, None], axis=2).max(axis=1)
    return np.concatenate([centre, np.maximum.reduceat(away, starts[:-1])[:, None]], axis=1)
