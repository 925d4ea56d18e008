"""Millimetres and degrees to SI, and back; used by the conversions between files and nouns alone."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import numpy.typing as npt

from zerorev.model._arrays import Array
from zerorev.model.units import DEG, DEG_PER_MM, MM


def m(value_mm: npt.ArrayLike) -> Array:
    """Metres of millimetres."""
    return MM.inside(np.asarray(value_mm, dtype=np.float64))


def rad(value_deg: npt.ArrayLike) -> Array:
    """Radians of degrees."""
    return DEG.inside(np.asarray(value_deg, dtype=np.float64))


def rad_per_m(value_deg_per_mm: npt.ArrayLike) -> Array:
    """Radians per metre of degrees per millimetre."""
    return DEG_PER_MM.inside(np.asarray(value_deg_per_mm, dtype=np.float64))


def mm(value: npt.ArrayLike) -> Array:
    """Millimetres of metres."""
    return np.asarray(MM.outside(np.asarray(value)))


def deg(value: npt.ArrayLike) -> Array:
    """Degrees of radians."""
    return np.asarray(DEG.outside(np.asarray(value)))


def deg_per_mm(value: npt.ArrayLike) -> Array:
    """Degrees per millimetre of radians per metre."""
    return np.asarray(DEG_PER_MM.outside(np.asarray(value)))


def plain(value: Any) -> Any:
    """Plain data for a file: numbers of 13 significant digits, 0.0 where they are but noise, None for NaN.

    So few digits survive the way to SI and back unchanged, and a file that is read and written again stays the same.
    """
    if isinstance(value, dict):
        return {key: plain(entry) for key, entry in value.items()}
    if isinstance(value, (list, tuple)):
        return [plain(entry) for entry in value]
    if isinstance(value, (np.ndarray, np.generic)):
        return plain(value.tolist())
    if isinstance(value, float):
        if not math.isfinite(value):
            return None
        return float(f"{value:.13g}") if abs(value) > 1e-12 else 0.0
    return value
