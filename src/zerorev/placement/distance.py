"""How far apart two places of a part are: the greatest way that one of its points moves between them."""

from __future__ import annotations

import numpy as np

from zerorev.model._arrays import Array
from zerorev.model.job import Job

__all__ = ["Distance"]

ARM = 0.1  # [m] beside the part frame's vertical: points that a turn always moves
AT_ONCE = 4_000_000  # numbers


class Distance:
    """Of the places of one part: the greatest way [m] of the bottom of a hole, or of a point 100 mm from the vertical.

    The vertical is the one through the part frame's origin, about which the part is turned.
    """

    def __init__(self, job: Job) -> None:
        """Begin.

        Args:
            job: whose part is moved.
        """
        targets = np.array([hole.target for hole in job.holes])[:, :2] - job.T_base_part[:2, 3]
        corners = ARM * np.array([[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]])
        self._points = _outermost(np.vstack([targets, corners]))

    def __call__(self, places: Array, others: Array) -> Array:
        """The distances [m] of places, shape (P, 4), from others, shape (Q, 4); shape (P, Q)."""
        ours, theirs = self._moved(places), self._moved(others)
        found = np.empty((len(places), len(others)))
        rows = max(1, AT_ONCE // max(1, 2 * len(others) * len(self._points)))
        for first in range(0, len(places), rows):
            part = slice(first, first + rows)
            across = ((ours[part, None] - theirs[None]) ** 2).sum(axis=3).max(axis=2)
            found[part] = np.sqrt(across + (places[part, None, 2] - others[None, :, 2]) ** 2)
        return found

    def _moved(self, places: Array) -> Array:
        """Where the points come to lie in the plane, shape (P, N, 2), from the part frame's origin as it is."""
        c, s = np.cos(places[:, 3, None]), np.sin(places[:, 3, None])
        x, y = self._points.T
        turned = np.stack([c * x - s * y, s * x + c * y], axis=2)
        return np.asarray(turned + places[:, None, :2])


def _outermost(points: Array) -> Array:
    """The corners of the convex hull of points in a plane, shape (N, 2): one of them always moves the farthest."""
    ordered = points[np.lexsort(points.T[::-1])]
    halves = []
    for run in (ordered, ordered[::-1]):
        half: list[Array] = []
        for point in run:
            while len(half) > 1 and _left(half[-2], half[-1], point) <= 0:
                half.pop()
            half.append(point)
        halves.append(half[:-1])
    return np.array(halves[0] + halves[1])


def _left(one: Array, two: Array, three: Array) -> float:
    """Twice the area of a triangle, positive where its corners go round to the left."""
    return float((two[0] - one[0]) * (three[1] - one[1]) - (two[1] - one[1]) * (three[0] - one[0]))
