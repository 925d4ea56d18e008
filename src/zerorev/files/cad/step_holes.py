"""The holes of a solid: walls on one axis that touch each other and close around it.

The narrowest cylinder is what the drill makes. Wider cylinders are counterbores, cones that open outwards countersinks,
a cone that ends in its apex the drill point. An end is closed where the faces beside it end at the hole.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from zerorev.files.cad.found import BLIND, COUNTERBORED, COUNTERSUNK, THROUGH, TIP, FoundHole, Solid, Wall

__all__ = ["holes_of"]

ONE_AXIS = 0.02  # [mm] between the feet of axes that are one
PARALLEL = 1e-4  # [1] between the entries of d d^T of their directions
TOUCHING = 0.05  # [mm] between walls of one hole, along the axis
WIDER = 1.02  # times as wide as the hole: what is less is not a feature of its own
ONE_RADIUS = 1e-3  # [mm]
CLOSED = 0.5  # [rad] of the circle that may be missing, as where a keyway is cut
HALF = np.pi + 0.2  # [rad] of the circle that is missing at the end of a slot, and somewhat more
BEYOND = 0.05  # [mm] past an end where the material is asked for
LOW, HIGH = 0, 1


@dataclass(frozen=True)
class _Part:
    """A wall along the axis of its hole.

    Attributes:
        wall: which.
        low: where it begins, along the axis [mm].
        high: where it ends.
        wide: its largest radius [mm].
    """

    wall: Wall
    low: float
    high: float
    wide: float


def holes_of(solid: Solid) -> tuple[list[FoundHole], Counter[str]]:
    """The holes of a solid, in the order of its faces and without ids, and why others were left out, how often.

    Args:
        solid: as a reader has it.
    """
    found, left = list[tuple[int, FoundHole]](), Counter[str]()
    for walls in _on_one_axis(solid):
        line = min(walls, key=_narrowest)
        parts = sorted((_part(solid, wall, line) for wall in walls), key=lambda part: part.low)
        for touching in _touching(parts):
            try:
                hole = _hole(solid, touching, line)
            except _NoHoleError as error:
                if why := str(error):
                    left[why] += 1
            else:
                found.append((min(part.wall.face for part in touching), hole))
    return [hole for _, hole in sorted(found, key=lambda each: each[0])], left


class _NoHoleError(Exception):
    """Why walls on one axis are not a hole; without words where nobody would take them for one, as a fillet."""


def _narrowest(wall: Wall) -> tuple[float, bool]:
    """Cylinders before cones, the narrowest first, those that the file states before those that were recognised."""
    return np.inf if wall.radius is None else wall.radius, not wall.exact


def _on_one_axis(solid: Solid) -> Iterator[list[Wall]]:
    walls = [wall for wall in solid.walls if any(edge in solid.points for edge in wall.edges)]
    if not walls:
        return
    points, axes = np.array([wall.point for wall in walls]), np.array([wall.axis for wall in walls])
    feet = points + ((points.mean(axis=0) - points) * axes).sum(axis=1, keepdims=True) * axes
    squares = (axes[:, :, None] * axes[:, None, :]).reshape(-1, 9)  # the same for both senses of an axis
    pairs = cKDTree(np.hstack([feet / ONE_AXIS, squares / PARALLEL])).query_pairs(1.0, output_type="ndarray")
    graph = coo_array((np.ones(len(pairs)), pairs.T), shape=(len(walls), len(walls)))
    _, label = connected_components(graph, directed=False)
    order = np.argsort(label, kind="stable")
    for numbers in np.split(order, np.flatnonzero(np.diff(label[order])) + 1):
        yield [walls[n] for n in numbers]


def _part(solid: Solid, wall: Wall, line: Wall) -> _Part:
    """A wall, measured along an axis."""
    points = np.concatenate([solid.points[edge] for edge in wall.edges if edge in solid.points]) - line.point
    along = points @ line.axis
    off = np.linalg.norm(points - along[:, None] * line.axis, axis=1)
    return _Part(wall, float(along.min()), float(along.max()), float(off.max()))


def _touching(parts: Sequence[_Part]) -> Iterator[list[_Part]]:
    """Parts in stretches without a gap between them."""
    start, end = 0, parts[0].high
    for n, part in enumerate(parts):
        if part.low > end + TOUCHING:
            yield list(parts[start:n])
            start = n
        end = max(end, part.high)
    yield list(parts[start:])


def _hole(solid: Solid, parts: list[_Part], line: Wall) -> FoundHole:
    """The hole of walls that touch each other.

    Args:
        solid: of the walls.
        parts: the walls, measured along the axis of `line`.
        line: the wall by whose axis they are measured.

    Raises:
        _NoHoleError: they are none.
    """
    core = min(parts, key=lambda part: _narrowest(part.wall)).wall
    if core.radius is None:
        raise _NoHoleError("a cone without a cylinder")
    drilled = [part for part in parts if part.wall.radius is not None and part.wall.radius < core.radius + ONE_RADIUS]
    gap = _gap(solid, drilled, core)
    if gap > CLOSED:
        raise _NoHoleError("a slot, or a hole that runs out of the side" if gap < HALF else "")
    ends = [min(part.low for part in parts), max(part.high for part in parts)]
    closed, beside = zip(*(_end(solid, parts, line, side, ends[side]) for side in (LOW, HIGH)), strict=True)
    if all(closed):
        raise _NoHoleError("closed at both ends")
    for side in (LOW, HIGH):
        if closed[side] and not any(_is_tip(part) for part in parts):
            ends[side] = _bottom(solid, line, side, ends[side], core.radius)
    mouths = [_mouth(parts, drilled, core.radius, side) for side in (LOW, HIGH)]
    entry = HIGH if closed[LOW] or (mouths[HIGH].kinds and not mouths[LOW].kinds and not closed[HIGH]) else LOW
    through, marked = not any(closed), [bool(mouth.kinds) for mouth in mouths]
    notes = []
    if through and all(marked):
        notes.append("wider at both ends")
    tip = max((part.high - part.low for part in parts if _is_tip(part)), default=0.0)
    if tip:
        notes.append(f"{TIP} of {tip:.3g} mm in the depth")
    sense = 1.0 if core.axis @ line.axis > 0 else -1.0
    foot, last = (
        core.point + ((line.point + ends[side] * line.axis - core.point) @ core.axis) * core.axis
        for side in (entry, 1 - entry)
    )
    return FoundHole(
        id="",
        kinds=(THROUGH if through else BLIND, *mouths[entry].kinds),
        entry=foot,
        direction=core.axis * (sense if entry == LOW else -sense) + 0.0,
        diameter=2 * core.radius,
        depth=ends[HIGH] - ends[LOW],
        other_entry=last if through and marked[LOW] == marked[HIGH] else None,
        of=solid.name,
        mouth=mouths[entry].words,
        notes=tuple(notes),
        faces=(beside[entry], beside[1 - entry]),
    )


def _gap(solid: Solid, drilled: Sequence[_Part], core: Wall) -> float:
    """How far walls are from going all the way round: the largest angle [rad] without a point of their edges."""
    edges = {edge for part in drilled for edge in part.wall.edges if edge in solid.points}
    points = np.concatenate([solid.points[edge] for edge in edges]) - core.point
    across = np.cross(core.axis, np.eye(3)[np.argmin(np.abs(core.axis))])
    angles = np.sort(np.arctan2(points @ np.cross(core.axis, across), points @ across))
    return float(np.diff(angles, append=angles[0] + 2 * np.pi).max())


def _is_tip(part: _Part) -> bool:
    """Whether a cone ends in its apex."""
    return part.wall.radius is None and part.high - part.low > 0.9 * part.wide / np.tan(part.wall.slope)


@dataclass(frozen=True)
class _Mouth:
    kinds: tuple[str, ...] = ()
    words: str = ""


def _mouth(parts: Sequence[_Part], drilled: Sequence[_Part], radius: float, side: int) -> _Mouth:
    """What is wider than the hole on one side of it: a countersink, a counterbore, or both."""
    middle = np.mean([(part.low + part.high) / 2 for part in drilled])
    wider = [
        part for part in parts
        if part.wide > WIDER * radius and ((part.low + part.high) / 2 > middle) == (side == HIGH) and not _is_tip(part)
    ]  # fmt: skip
    bores = [part for part in wider if part.wall.radius is not None]
    widest = max((part.wide for part in bores), default=0.0)
    # a cone that is no wider than a counterbore is the floor of it
    sinks = [part for part in wider if part.wall.radius is None and part.wide > WIDER * widest]
    kinds, words = [], []
    if sinks:
        sink = max(sinks, key=lambda part: part.wide)
        kinds.append(COUNTERSUNK)
        words.append(f"countersink {2 * sink.wide:.4g} mm, {2 * np.degrees(sink.wall.slope):.4g} deg")
    if bores:
        low, high = min(part.low for part in bores), max(part.high for part in bores)
        kinds.append(COUNTERBORED)
        words.append(f"counterbore {2 * widest:.4g} mm, {high - low:.4g} mm deep")
    return _Mouth(tuple(kinds), ", ".join(words))


def _bottom(solid: Solid, line: Wall, side: int, end: float, radius: float) -> float:
    """Where a closed end lies on the axis: beyond the wall, if it is rounded."""
    sign = 1.0 if side == HIGH else -1.0

    def is_inside(further: float) -> bool:
        return solid.inside(line.point + (end + sign * further) * line.axis)

    if is_inside(BEYOND) or not is_inside(2 * radius):
        return end
    low, high = 0.0, 2 * radius
    while high - low > ONE_RADIUS:
        middle = (low + high) / 2
        low, high = (low, middle) if is_inside(middle) else (middle, high)
    return end + sign * high


def _end(solid: Solid, parts: Sequence[_Part], line: Wall, side: int, end: float) -> tuple[bool, frozenset[int]]:
    """Whether an end of a hole is closed, and the faces beside it there."""
    last = min(parts, key=lambda part: part.low) if side == LOW else max(parts, key=lambda part: part.high)
    if _is_tip(last):
        return True, frozenset()
    own = {part.wall.face for part in parts}
    level = (last.low + last.high) / 2
    rim = {
        edge
        for part in parts
        for edge in part.wall.edges
        if edge in solid.points
        and not solid.beside[edge] <= own
        and (((solid.points[edge] - line.point) @ line.axis).mean() > level) == (side == HIGH)
    }
    faces = frozenset(face for edge in rim for face in solid.beside[edge] - own)
    if any(solid.rims[face] <= rim for face in faces):
        return True, faces
    if faces and all(not solid.rims[face] & rim & solid.outer[face] for face in faces):
        return False, faces
    beyond = line.point + (end + (BEYOND if side == HIGH else -BEYOND)) * line.axis
    return solid.inside(beyond), faces
