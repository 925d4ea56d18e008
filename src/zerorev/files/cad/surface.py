"""Directions of holes from the surface of a part, where a list has places alone: normals of the nearest triangle."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from zerorev.model._arrays import Array

__all__ = ["Normals", "normals_at"]

FAR = 20.0  # [mm] from the surface, beyond which no normal is looked for
EDGE = np.deg2rad(45.0)  # between triangles that meet in an edge of the part, not in a bend of its surface
AT_EDGE = 1.0  # [mm] from such an edge
BATCH = 500  # places at a time
Faces = npt.NDArray[np.integer]


@dataclass(frozen=True)
class Normals:
    """The surface at some places.

    Attributes:
        normals: out of the material, unit, shape (N, 3); NaN at places that are further off than `FAR`.
        off: how far each place is from the surface [mm], shape (N,); infinite beyond `FAR`.
        bend: the largest angle to a triangle beside the nearest one [rad], shape (N,): so much the normal may be off.
        at_edge: whether an edge of the part is nearer than `AT_EDGE`, shape (N,).
    """

    normals: Array
    off: Array
    bend: Array
    at_edge: npt.NDArray[np.bool_]


def normals_at(places: Array, vertices: Array, faces: Faces) -> Normals:
    """The normals of a surface at the points that are nearest to some places.

    Args:
        places: [mm], shape (N, 3).
        vertices: of triangles [mm], shape (V, 3).
        faces: as numbers of vertices, shape (M, 3), their normals out of the material.
    """
    corners = vertices[faces]
    across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    area = np.linalg.norm(across, axis=1)
    whole = area > 1e-12 * max(float(np.ptp(vertices, axis=0).max()), 1e-300) ** 2
    corners, faces, normals = corners[whole], faces[whole], across[whole] / area[whole, None]
    nearest, off = _nearest(places, corners)
    found, bend, at_edge = np.full_like(places, np.nan), np.zeros(len(places)), np.zeros(len(places), dtype=bool)
    beside = _beside(vertices, faces)
    for n, (triangle, distance) in enumerate(zip(nearest, off, strict=True)):
        if not np.isfinite(distance):
            continue
        found[n] = normals[triangle]
        others = np.array(beside.get(int(triangle), ()), dtype=int)
        angles = np.arccos(np.clip(normals[others] @ normals[triangle], -1.0, 1.0))
        sharp = angles > EDGE
        bend[n] = angles[~sharp].max(initial=0.0)
        near = _distance(np.broadcast_to(places[n], (int(sharp.sum()), 3)), corners[others[sharp]])
        at_edge[n] = bool((near < distance + AT_EDGE).any())
    return Normals(found, off, bend, at_edge)


def _nearest(places: Array, corners: Array) -> tuple[npt.NDArray[np.int64], Array]:
    """The nearest triangle of each place, and how far it is; infinitely far beyond `FAR`.

    The triangles are sorted into classes of about one size. A triangle nearer than a distance has its centre within
    that distance and its own radius, so that of each class only a few have to be measured.
    """
    from scipy.spatial import cKDTree  # which takes long to import, and few jobs need it

    centres = corners.mean(axis=1)
    radius = np.linalg.norm(corners - centres[:, None], axis=2).max(axis=1)
    sizes = np.floor(np.log2(radius)).astype(int)
    best, which = np.full(len(places), FAR), np.full(len(places), -1)
    for size in np.unique(sizes):
        members = np.flatnonzero(sizes == size)
        tree, most = cKDTree(centres[members]), float(radius[members].max())
        for start in range(0, len(places), BATCH):
            some = slice(start, start + BATCH)
            limit = np.minimum(best[some], tree.query(places[some])[0])
            groups = tree.query_ball_point(places[some], limit * (1 + 1e-9) + most)
            counts = np.array([len(group) for group in groups])
            if not counts.sum():
                continue
            rows = np.repeat(np.arange(len(groups)), counts) + start
            tried = members[np.concatenate([group for group in groups if group]).astype(int)]
            distance = _distance(places[rows], corners[tried])
            order = np.lexsort((tried, distance, rows))
            first = order[np.flatnonzero(np.diff(rows[order], prepend=-1))]
            nearer = distance[first] < best[rows[first]]
            best[rows[first][nearer]], which[rows[first][nearer]] = distance[first][nearer], tried[first][nearer]
    return which, np.where(which < 0, np.inf, best)


def _distance(places: Array, corners: Array) -> Array:
    """How far places are from triangles, one by one [mm], shape (N,): from the plane within, else from the sides."""
    a, b, c = corners[:, 0], corners[:, 1], corners[:, 2]
    sides = np.stack([_to_segment(places, *pair) for pair in ((a, b), (b, c), (c, a))])
    normal = np.cross(b - a, c - a)
    length = np.linalg.norm(normal, axis=1)
    within = np.ones(len(places), dtype=bool)
    for start, end in ((a, b), (b, c), (c, a)):
        within &= np.einsum("ij,ij->i", np.cross(end - start, places - start), normal) >= 0
    plane = np.abs(np.einsum("ij,ij->i", places - a, normal)) / np.where(length > 0, length, 1.0)
    return np.asarray(np.where(within & (length > 0), plane, sides.min(axis=0)))


def _to_segment(places: Array, start: Array, end: Array) -> Array:
    along = end - start
    share = np.einsum("ij,ij->i", places - start, along) / np.maximum(np.einsum("ij,ij->i", along, along), 1e-300)
    return np.asarray(np.linalg.norm(places - start - np.clip(share, 0.0, 1.0)[:, None] * along, axis=1))


def _beside(vertices: Array, faces: Faces) -> dict[int, list[int]]:
    """The triangles that share an edge with each; vertices at one place are one."""
    _, number = np.unique(vertices, axis=0, return_inverse=True)
    joined = number.reshape(-1)[faces]
    edges = np.sort(np.concatenate([joined[:, [0, 1]], joined[:, [1, 2]], joined[:, [2, 0]]]), axis=1)
    owner = np.tile(np.arange(len(faces)), 3)
    order = np.lexsort((edges[:, 1], edges[:, 0]))
    edges, owner = edges[order], owner[order]
    found: dict[int, list[int]] = {}
    for n in np.flatnonzero((edges[1:] == edges[:-1]).all(axis=1)):
        one, other = int(owner[n]), int(owner[n + 1])
        found.setdefault(one, []).append(other)
        found.setdefault(other, []).append(one)
    return found
