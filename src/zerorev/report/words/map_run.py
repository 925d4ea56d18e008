"""A finished workspace map in a few lines."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from zerorev.maps.cells import STATUS
from zerorev.maps.workspace import read_workspace_map
from zerorev.model.plan import named_holes

if TYPE_CHECKING:
    from xarray import Dataset

    from zerorev.maps.around import Around

__all__ = ["around_lines", "summary_lines"]

OFF, LEAN = 1e-4, 1e-3  # [m], [rad] less is not worth a word
WORDS = {
    "answered": "with an answer",
    "none": "reached, but none without a reversal",
    "joint_limits": "reached outside the joint limits or the bound on the spin alone",
    "out_of_reach": "out of reach",
    "robot_base": "inside the robot's base",
}


def summary_lines(path: str | Path) -> list[str]:
    """How many cells have an answer, and why the others have none.

    Args:
        path: of the map; it is read piece by piece, regardless of its size.
    """
    found = read_workspace_map(path, load=False)
    counts = np.zeros(len(STATUS), dtype=np.int64)
    for part in _slabs(found):
        status = part["status"].values
        counts += np.bincount(status[status >= 0].ravel(), minlength=len(STATUS))
    total = int(np.prod([found.sizes[name] for name in found["status"].dims]))
    shown = [f"{count:,} {WORDS[name]}" for name, count in zip(STATUS, counts.tolist(), strict=True) if count]
    unfinished = total - int(counts.sum())
    return [f"{total:,} cells: " + ", ".join(shown + ([f"{unfinished:,} not yet examined"] if unfinished else []))]


def around_lines(around: Around) -> list[str]:
    """Where a map around a job lies, and what it leaves out of account."""
    task = around.task
    sides = " x ".join(f"{len(axis)}" for axis in task.axes if len(axis) > 1) or "1"
    frame = "the part frame"
    if around.own_frame:
        frame = "a frame of its own, for no plane of the part frame holds the holes (attribute part_frame of the map)"
    lines = [
        f"{sides} targets, {around.cell * 1e3:g} mm apart, to {around.margin * 1e3:g} mm beyond the holes; in {frame}"
    ]
    if around.left_out:
        lines.append(f"{named_holes(around.left_out)} left out: out of reach")
    if around.off > OFF:
        lines.append(f"the holes lie up to {around.off * 1e3:.1f} mm off the plane of the map")
    if around.lean > LEAN:
        lines.append(
            f"the holes lean up to {np.rad2deg(around.lean):.1f} deg from the mean direction, which the map has"
        )
    return lines


def _slabs(found: Dataset) -> list[Dataset]:
    """The map in slabs along its first dimension."""
    first = str(found["status"].dims[0])
    step = max(1, -(-found.sizes[first] // 100))
    return [found.isel({first: slice(at, at + step)}) for at in range(0, found.sizes[first], step)]
