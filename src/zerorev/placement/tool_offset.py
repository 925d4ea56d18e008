"""How deep the holes of a job go as the drill axis is moved away from the wrist, and the least offset that drills them.

The offset e of the drill axis from the wrist centre is the lever of the spin (theory §1): it belongs to the tool, and
whoever designs the tool can choose it.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from zerorev.errors import InputError
from zerorev.model._arrays import Array, finite
from zerorev.model.hole import Hole
from zerorev.model.job import Job, Settings
from zerorev.model.robot import Robot
from zerorev.model.tool import Tool
from zerorev.motion.drilling import Drilling
from zerorev.search.cycles import deepest_in_cycle

__all__ = ["LeastOffset", "OffsetCurve", "least_offset", "offset_curve", "offset_of", "with_offset"]

TOLERANCE = 1e-4  # [m] to which the least offset is closed in on
PARALLEL = 1e-6  # sine below which the drill axis counts as parallel to the flange's Z

Progress = Callable[[int, int], None]


@dataclass(frozen=True)
class OffsetCurve:
    """The deepest strokes of some holes over offset and angle of the tool.

    Attributes:
        offsets: e [m], rising, shape (E,).
        angles: [rad], shape (A,); see `with_offset`.
        deepest: deepest stroke without a reversal [m], shape (E, A, H); 0 where there is none.
        needed: depth of each hole [m], shape (H,).
    """

    offsets: Array
    angles: Array
    deepest: Array
    needed: Array

    @property
    def margin(self) -> Array:
        """How much deeper than needed the worst hole could go [m], shape (E, A); below 0 where it is too shallow."""
        return np.asarray((self.deepest - self.needed).min(axis=2))


@dataclass(frozen=True)
class LeastOffset:
    """The least offset at which every hole of a job is drilled without a reversal.

    Attributes:
        offset: e [m]. It does drill every hole.
        angle: [rad]; see `with_offset`.
        tool: the tool moved there.
        deepest: deepest stroke of each hole with it [m], shape (H,).
        fails_at: the greatest offset below it, of those tried at this angle, at which a hole is too shallow [m]; None
            where the least offset of the curve drills them all.
    """

    offset: float
    angle: float
    tool: Tool
    deepest: Array
    fails_at: float | None


def offset_of(robot: Robot, tool: Tool) -> tuple[float, float]:
    """Offset e [m] of a tool's drill axis from the wrist centre, and its angle [rad]; see `with_offset`."""
    across = _offset_vector(robot, tool)
    x, y = _directions(tool)
    return float(np.linalg.norm(across)), float(np.arctan2(across @ y, across @ x))


def with_offset(robot: Robot, tool: Tool, offset: float, angle: float | None = None) -> Tool:
    """The tool with its drill axis moved parallel to itself; how far along the axis the tip lies is kept.

    Args:
        robot: whose wrist centre counts.
        tool: to be moved; which way it points is kept.
        offset: e, distance of the drill axis from the wrist centre [m].
        angle: where to, seen from the wrist centre [rad], right-handed about Z_tcp: 0 is along the flange's Z as seen
            along the drill axis or, where the two are parallel, along the flange's X. None: the tool's own angle.

    Raises:
        InputError: an offset below 0 or not finite, or an angle that is not.
    """
    if not (np.isfinite(offset) and offset >= 0):
        raise InputError(f"an offset of {offset * 1e3:g} mm", where="offset", accepted="0 or more, finite")
    angle = offset_of(robot, tool)[1] if angle is None else angle
    if not np.isfinite(angle):
        raise InputError(f"an angle of {angle:g}", where="angle", accepted="a finite number")
    x, y = _directions(tool)
    T = tool.T_flange_tcp.copy()
    T[:3, 3] += offset * (np.cos(angle) * x + np.sin(angle) * y) - _offset_vector(robot, tool)
    return Tool(f"{tool.name} e={offset * 1e3:.6g}mm {np.rad2deg(angle) + 0.0:.6g}deg", T, tool.sources)


def offset_curve(
    robot: Robot,
    tool: Tool,
    holes: Sequence[Hole],
    settings: Settings,
    offsets: npt.ArrayLike,
    angles: npt.ArrayLike | None = None,
    progress: Progress | None = None,
) -> OffsetCurve:
    """The deepest stroke of each hole with the tool at each offset and angle.

    Args:
        robot: the arm.
        tool: the drill, moved as `with_offset` has it.
        holes: what to drill; given motions are not examined.
        settings: how deep is deep: legs, threshold, bound on the spin.
        offsets: e [m], shape (E,), rising, 0 or more.
        angles: [rad], shape (A,); None for the tool's own.
        progress: called with the number of strokes known and in all.

    Raises:
        InputError: no offset or angle, or offsets that do not rise from 0 or more.
    """
    e = _list_of(offsets, "offsets")
    a = _list_of(offset_of(robot, tool)[1] if angles is None else angles, "angles")
    if e[0] < 0 or (np.diff(e) <= 0).any():
        raise InputError("not rising from 0 or more", where="offsets", accepted="0 or more, each above the one before")
    deepest = np.empty((e.size, a.size, len(holes)))
    for done, (i, j, k) in enumerate(np.ndindex(deepest.shape)):
        if progress:
            progress(done, deepest.size)
        moved = with_offset(robot, tool, float(e[i]), float(a[j]))
        deepest[i, j, k] = deepest_in_cycle(
            Drilling(robot, moved, holes[k], settings.limit_margin), settings.without_proof
        ).depth
    if progress:
        progress(deepest.size, deepest.size)
    return OffsetCurve(e, a, deepest, np.array([hole.depth for hole in holes]))


def least_offset(job: Job, curve: OffsetCurve) -> LeastOffset | None:
    """The least offset at which every hole of a job is drilled without a reversal to its depth.

    Of each angle of the curve the first offset that drills them all is taken, and closed in on to 0.1 mm by bisection
    down to the offset before it. A deeper stroke for a greater offset is the rule, not a law: an interval of offsets
    that drill them all and that lies between two neighbours of the curve which do not is missed, and so is one between
    its angles.

    Args:
        job: robot, tool, holes, settings.
        curve: its deepest strokes, from `offset_curve`.

    Returns:
        the least offset and its angle, or None where no point of the curve drills all holes.
    """
    drills = curve.margin >= 0
    best: LeastOffset | None = None
    first = np.where(drills.any(axis=0), drills.argmax(axis=0), len(curve.offsets))
    for j in np.argsort(first, kind="stable"):
        if first[j] == len(curve.offsets) or (best and first[j] > 0 and curve.offsets[first[j] - 1] >= best.offset):
            break  # what is left begins no lower
        found = _closed_in(job, curve, int(first[j]), int(j))
        if best is None or found.offset < best.offset:
            best = found
    return best


def _closed_in(job: Job, curve: OffsetCurve, i: int, j: int) -> LeastOffset:
    """The least offset of one angle, between the first of the curve that drills all holes and the one before."""
    angle = float(curve.angles[j])
    good, deepest = float(curve.offsets[i]), curve.deepest[i, j]
    bad = float(curve.offsets[i - 1]) if i > 0 else None
    while bad is not None and good - bad > TOLERANCE:
        middle = (good + bad) / 2
        found = offset_curve(job.robot, job.tool, job.holes, job.settings, [middle], [angle])
        if found.margin[0, 0] >= 0:
            good, deepest = middle, found.deepest[0, 0]
        else:
            bad = middle
    return LeastOffset(good, angle, with_offset(job.robot, job.tool, good, angle), deepest, bad)


def _offset_vector(robot: Robot, tool: Tool) -> Array:
    """From the wrist centre to the nearest point of the drill axis [m], flange frame, shape (3,)."""
    axis, to_tip = tool.T_flange_tcp[:3, 2], tool.T_flange_tcp[:3, 3] + [0.0, 0.0, robot.arm.c4]
    return np.asarray(to_tip - (to_tip @ axis) * axis)


def _directions(tool: Tool) -> tuple[Array, Array]:
    """Directions of the angles 0 and 90 deg in the flange frame, unit, each of shape (3,)."""
    axis = tool.T_flange_tcp[:3, 2]
    for direction in np.eye(3)[[2, 0]]:
        x = direction - (direction @ axis) * axis
        if np.linalg.norm(x) > PARALLEL:
            break
    x = x / np.linalg.norm(x)
    return x, np.cross(axis, x)


def _list_of(values: npt.ArrayLike, name: str) -> Array:
    array = np.atleast_1d(np.asarray(values, dtype=float))
    if array.ndim != 1 or array.size == 0:
        raise InputError(f"of shape {array.shape}", where=name, accepted="a list of one number or more")
    return finite(array, array.shape, name)
