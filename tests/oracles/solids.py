"""Capsules against boxes the slow way: sample by sample, by thirds along each line."""

from __future__ import annotations

import numba
import numpy as np

from zerorev.model._arrays import transform
from zerorev.model.body import Box, Capsule, Obstacle
from zerorev.motion.links import link_frames

__all__ = ["box_at", "least_at"]


@numba.njit
def _least_on_lines(one, other, half, thirds, out):
    """Least distance of each line from the box about the origin, shape (N,): along a line it is convex."""
    for n in range(len(one)):
        low, high = 0.0, 1.0
        for step in range(thirds + 1):
            a, b = low + (high - low) / 3, high - (high - low) / 3
            da = db = 0.0
            for c in range(3):
                da += max(abs(one[n, c] + a * (other[n, c] - one[n, c])) - half[c], 0.0) ** 2
                db += max(abs(one[n, c] + b * (other[n, c] - one[n, c])) - half[c], 0.0) ** 2
            if step == thirds:
                out[n] = min(da, db) ** 0.5
            elif da > db:
                low = a
            else:
                high = b


def least_at(robot, bodies, joints, obstacle, thirds=36):
    """Least distance of capsules from a box at joints (N, 6), shape (N,)."""
    frames = np.concatenate([np.broadcast_to(np.eye(4), (len(joints), 1, 4, 4)), link_frames(robot, joints)], axis=1)
    least, found = np.full(len(joints), np.inf), np.empty(len(joints))
    R, place = obstacle.T_base[:3, :3], obstacle.T_base[:3, 3]
    for body in bodies:
        assert isinstance(body.shape, Capsule)
        T = frames[:, body.link] @ body.T_link
        one, other = ((T[:, :3, :3] @ end + T[:, :3, 3] - place) @ R for end in body.shape.ends)
        _least_on_lines(one, other, obstacle.shape.size / 2, thirds, found)
        least = np.minimum(least, found - body.shape.radius)
    return least


def box_at(place, size, name="box"):
    """A box along the axes of the base frame, as a fixture."""
    return Obstacle(name, "fixture", Box(np.asarray(size, dtype=float)), transform(np.eye(3), np.asarray(place)))
