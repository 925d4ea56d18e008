"""Workspace maps made of given numbers, in the form that `zerorev map` writes."""

from __future__ import annotations

import numpy as np
import xarray

from zerorev.files.conversion import robot_data, settings_data, tool_data
from zerorev.model.job import Settings


def made_map(robot, tool, axes, directions, value, *, variable="deepest_mm", branch=None, psi_deg=None, **attributes):
    """A dataset over x, y, z and direction.

    Args:
        robot: of the map.
        tool: of the map.
        axes: x, y and z [mm].
        directions: vectors, shape (D, 3).
        value: of the quantity, called with x, y, z and a direction.
        variable: name of the quantity.
        branch: of every cell with an answer, or None.
        psi_deg: three spins of every cell with an answer, or None.
        attributes: others than usual.
    """
    dims = ("x", "y", "z", "direction")
    shape = (*map(len, axes), len(directions))
    found = np.array([value(axes[0][i], axes[1][j], axes[2][k], directions[n]) for i, j, k, n in np.ndindex(*shape)])
    found = found.reshape(shape).astype(float)
    there = ~np.isnan(found)
    variables = {
        variable: (dims, found),
        "branch": (dims, np.where(there, -1 if branch is None else branch, -1).astype(np.int8)),
        "status": (dims, np.where(there, 0, 3).astype(np.int8)),
    }
    for n, place in enumerate(("start", "target", "end")):
        psi = np.nan if psi_deg is None else psi_deg[n]
        variables[f"psi_{place}_deg"] = (dims, np.where(there, psi, np.nan))
    coordinates = {f"{name}_mm": (name, np.asarray(axis, dtype=float)) for name, axis in zip("xyz", axes, strict=True)}
    for n, name in enumerate("xyz"):
        coordinates[f"direction_{name}"] = ("direction", np.asarray(directions, dtype=float)[:, n])
    settings = settings_data(Settings(min_rate=0.0))
    names = ("min_rate_deg_per_mm", "psi_bound_deg", "legs", "max_twist_deg_per_mm")
    usual = {
        "format": "zerorev.map/1", "version": "0.1.0", "quantity": "deepest", "legs": "straight",
        "robot": robot_data(robot), "tool": tool_data(tool), "psi_reference": "base_y",
        "settings": {name: settings[name] for name in names},
    }  # fmt: skip
    return xarray.Dataset(variables, coordinates, usual | attributes)
