"""Frames as KUKA's controllers have them: X, Y, Z [mm] and A, B, C [deg], which are yaw, pitch and roll."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any

import numpy as np

from zerorev.model._arrays import rotation_rpy

__all__ = ["KEYS", "in_own_keys", "with_direction"]

DRILL_AXES = {"x": 0, "z": 2}
AXES, ANGLES = ("x", "y", "z"), ("a", "b", "c")
KEYS = {
    **{axis: f"a number [mm]: {axis.upper()} of the frame, in place of xyz_mm (tcp_mm of a tool)" for axis in AXES},
    **{
        angle: f"a number [deg]: KUKA's {angle.upper()}, which is {name}; in place of rpy_deg"
        for angle, name in zip(ANGLES, ("yaw", "pitch", "roll"), strict=True)
    },
    "abc_deg": "three numbers [deg]: KUKA's A, B, C, which are yaw, pitch, roll; in place of rpy_deg",
}
"""What the keys mean, which a job may have in place of its own."""

_PASTED = re.compile(r"([XYZABCxyzabc])\s+([-+]?[0-9.]+(?:[eE][-+]?[0-9]+)?)")


def in_own_keys(data: Any, place: str) -> Any:
    """A mapping with the keys of a job in place of KUKA's; as it is where it has both, for the form to refuse.

    Args:
        data: as it was read; `{X 100.0, Y 0.0}`, as it stands in a controller's file, is a mapping of such texts to
            nothing.
        place: the job's key of the origin, `xyz_mm` or `tcp_mm`.
    """
    if not isinstance(data, Mapping):
        return data
    found: dict[str, Any] = {}
    rest: dict[str, Any] = {}
    for key, value in data.items():
        pasted = _PASTED.fullmatch(str(key)) if value is None else None
        name = str(pasted[1] if pasted else key).lower()
        if name in (*AXES, *ANGLES, "abc_deg") and name not in found:
            found[name] = _number(pasted[2]) if pasted else value
        else:
            rest[key] = value
    angles = "abc_deg" in found or any(name in found for name in ANGLES)
    mixed = "abc_deg" in found and any(name in found for name in ANGLES)
    if not found or mixed or (angles and "rpy_deg" in rest) or (place in rest and any(name in found for name in AXES)):
        return data
    if any(name in found for name in (*AXES, *ANGLES)):
        rest.setdefault(place, [found.get(name, 0.0) for name in AXES])
    if "abc_deg" in found:
        given = found["abc_deg"]
        rest["rpy_deg"] = given[::-1] if isinstance(given, list) else given
    else:
        rest["rpy_deg"] = [found.get(name, 0.0) for name in ANGLES[::-1]]
    return rest


def with_direction(data: Any) -> Any:
    """A hole with the direction that KUKA's angles and the axis of their frame say; what is wrong with them is left.

    Args:
        data: as it was read; with `abc_deg` in place of `direction`, and `drill_axis` beside it.
    """
    if not isinstance(data, Mapping) or ("abc_deg" not in data and "drill_axis" not in data):
        return data
    found = dict(data)
    if "direction" in data or "abc_deg" not in data:
        return found | {"drill_axis": "beside direction" if "direction" in data else "without abc_deg"}
    found.setdefault("drill_axis", "not given")
    given, axis = data["abc_deg"], DRILL_AXES.get(str(found["drill_axis"]))
    if axis is None or not isinstance(given, list) or [type(each) in (int, float) for each in given] != [True] * 3:
        return found | {"direction": [0.0, 0.0, 1.0]}  # the form refuses the others
    del found["abc_deg"], found["drill_axis"]
    yaw, pitch, roll = np.deg2rad(np.array(given, dtype=float))
    return found | {"direction": rotation_rpy(roll, pitch, yaw)[:, axis].tolist()}


def _number(text: str) -> Any:
    try:
        return float(text)
    except ValueError:
        return text
