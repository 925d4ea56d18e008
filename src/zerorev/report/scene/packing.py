"""Numbers as the player in the browser takes them."""

from __future__ import annotations

import base64
from typing import Any

import numpy as np
import numpy.typing as npt

from zerorev.files.units import mm
from zerorev.model._arrays import Array

__all__ = ["in_mm", "packed", "pose_in_mm"]


def packed(values: npt.ArrayLike, kind: str = "<f4") -> str:
    """Numbers as base64 of little-endian binary, row by row."""
    return base64.b64encode(np.ascontiguousarray(values, dtype=kind).tobytes()).decode("ascii")


def in_mm(value: npt.ArrayLike) -> Any:
    """Lengths [m] as lists [mm]."""
    return np.round(mm(value), 6).tolist()


def pose_in_mm(T: Array) -> list[list[float]]:
    """The upper three rows of a pose, shape (4, 4), the last column in mm."""
    rows: list[list[float]] = np.hstack([T[:3, :3], mm(T[:3, 3:])]).tolist()
    return rows
