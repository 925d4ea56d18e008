"""The bodies of the arm and what stands around it, as the player of the cell takes them: plain data in mm."""

from __future__ import annotations

from functools import lru_cache
from typing import Any

import numpy as np
import numpy.typing as npt

from zerorev.collision.arms import setting_of
from zerorev.files.units import mm
from zerorev.model._arrays import Array
from zerorev.model.body import Box, Capsule, Mesh, Shape
from zerorev.model.robot import Robot
from zerorev.model.settings import Settings
from zerorev.model.tool import Tool
from zerorev.report.scene.packing import in_mm, packed, pose_in_mm

__all__ = ["MOST_DRAWN", "solids_data"]

MOST_DRAWN = 20_000  # triangles of a mesh that are drawn; of a finer one points that are close together become one
FINEST, COARSER = 400, 0.8  # parts of its longest side to begin with; how many of them are tried next


def solids_data(robot: Robot, tool: Tool, settings: Settings) -> dict[str, Any] | None:
    """The bodies of the arm with its tool, and what stands around; None where neither is stated.

    A body moves with its link: 0 is the base, 6 the flange (`motion.links`).

    Args:
        robot: the arm.
        tool: on its flange.
        settings: with what stands around.
    """
    setting = setting_of(robot, tool, settings)
    if setting is None:
        return None
    floor = [one for one in setting.obstacles if one.kind == "floor"]
    return {
        "bodies": [
            {"id": body.id, "link": body.link, "pose": pose_in_mm(body.T_link)} | _shape(body.shape)
            for body in setting.bodies
        ],
        "obstacles": [
            {"id": one.id, "kind": one.kind, "pose": pose_in_mm(one.T_base)} | _shape(one.shape)
            for one in setting.obstacles
            if one.kind != "floor"
        ],
        "floor_mm": max((_top(one.shape, one.T_base) for one in floor), default=None),
    }


def _top(shape: Shape, T: Array) -> float:
    """The height of a box that lies flat [mm]."""
    assert isinstance(shape, Box)
    return float(mm(T[2, 3] + shape.size[2] / 2))


def _shape(shape: Shape) -> dict[str, Any]:
    if isinstance(shape, Capsule):
        return {"shape": "capsule", "ends": in_mm(shape.ends), "radius": in_mm(shape.radius)}
    if isinstance(shape, Box):
        return {"shape": "box", "size": in_mm(shape.size)}
    vertices, faces = _drawn(shape)
    return {"shape": "mesh", "vertices_mm": packed(mm(vertices)), "faces": packed(faces, "<u4")}


@lru_cache(maxsize=16)
def _drawn(mesh: Mesh) -> tuple[Array, npt.NDArray[np.int64]]:
    """Vertices [m], shape (V, 3), and triangles, shape (F, 3), few enough to be drawn."""
    vertices, faces, parts = mesh.vertices, mesh.faces.astype(np.int64), float(FINEST)
    low = vertices.min(axis=0)
    while len(faces) > MOST_DRAWN:
        step = max(float(np.ptp(mesh.vertices, axis=0).max()) / parts, 1e-9)
        cell = np.floor((mesh.vertices - low) / step).astype(np.int64)
        _, of, count = np.unique(cell @ np.array([1, 2**20, 2**40]), return_inverse=True, return_counts=True)
        sums = [np.bincount(of, mesh.vertices[:, k], minlength=count.size) for k in range(3)]
        vertices, faces = np.column_stack(sums) / count[:, None], of[mesh.faces]
        a, b, c = faces.T
        faces = faces[(a != b) & (b != c) & (c != a)]
        parts *= COARSER
    return vertices, faces
