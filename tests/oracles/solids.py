"""Capsules against boxes the slow way: sample by sample, by golden section along each line."""

from __future__ import annotations

import numpy as np

from zerorev.model._arrays import transform
from zerorev.model.body import Box, Capsule, Obstacle
from zerorev.motion.links import link_frames

__all__ = ["box_at", "least_at", "point_box"]


def point_box(points, obstacle):
    """Distances of points (..., 3) from a box, 0 inside."""
    at = (points - obstacle.T_base[:3, 3]) @ obstacle.T_base[:3, :3]
    return np.linalg.norm(np.maximum(np.abs(at) - obstacle.shape.size / 2, 0.0), axis=-1)


def least_at(robot, bodies, joints, obstacle, thirds=36):
    """Least distance of capsules from a box at joints (N, 6), shape (N,): along each line it is convex."""
    frames = np.concatenate([np.broadcast_to(np.eye(4), (len(joints), 1, 4, 4)), link_frames(robot, joints)], axis=1)
    least = np.full(len(joints), np.inf)
    for body in bodies:
        assert isinstance(body.shape, Capsule)
        T = frames[:, body.link] @ body.T_link
        one, other = (T[:, :3, :3] @ end + T[:, :3, 3] for end in body.shape.ends)
        low, high = np.zeros(len(joints)), np.ones(len(joints))
        for _ in range(thirds):
            a, b = low + (high - low) / 3, high - (high - low) / 3
            da, db = (point_box(one + t[:, None] * (other - one), obstacle) for t in (a, b))
            low, high = np.where(da > db, a, low), np.where(da > db, high, b)
        middle = (low + high) / 2
        least = np.minimum(least, point_box(one + middle[:, None] * (other - one), obstacle) - body.shape.radius)
    return least


def box_at(place, size, name="box"):
    """A box along the axes of the base frame, as a fixture."""
    return Obstacle(name, "fixture", Box(np.asarray(size, dtype=float)), transform(np.eye(3), np.asarray(place)))
