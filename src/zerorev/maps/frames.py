"""The frame in which a workspace map has its targets and directions: the base frame, or that of a part."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from zerorev.errors import InputError
from zerorev.files.units import m, rad
from zerorev.model._arrays import Array, finite, rotation_rpy, transform

if TYPE_CHECKING:
    from xarray import Dataset

__all__ = ["frame_of", "in_frame"]


def frame_of(found: Dataset) -> Array:
    """The part frame of a map, shape (4, 4), translation [m]; of most maps the base frame.

    Args:
        found: a workspace map.

    Raises:
        InputError: its attributes name no frame that can be used.
    """
    given = found.attrs.get("part_frame")
    if given is None:
        return np.eye(4)
    try:
        origin, angles = (finite(given[key], (3,), key) for key in ("xyz_mm", "rpy_deg"))
    except (InputError, KeyError, TypeError, ValueError):
        accepted = "xyz_mm and rpy_deg, three numbers each"
        raise InputError("cannot be used", where="part_frame", accepted=accepted) from None
    return transform(rotation_rpy(*rad(angles)), m(origin))


def in_frame(T_base_part: Array, places: Array) -> Array:
    """Places of the base frame in a part frame.

    Args:
        T_base_part: shape (4, 4), translation [m].
        places: [m], shape (..., 3).
    """
    return np.asarray((places - T_base_part[:3, 3]) @ T_base_part[:3, :3])
