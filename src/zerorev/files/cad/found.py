"""What a CAD file says of holes, before anybody has chosen among them: plain data, in millimetres."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from zerorev.model._arrays import Array

__all__ = [
    "BLIND", "CIRCLE", "COUNTERBORED", "COUNTERSUNK", "POINT", "THROUGH", "TIP", "FoundHole", "FoundHoles", "Solid",
    "Wall",
]  # fmt: skip

THROUGH, BLIND, COUNTERSUNK, COUNTERBORED = "through", "blind", "countersunk", "counterbored"
CIRCLE, POINT = "circle", "point"  # of a drawing, which does not say how a hole is
TIP = "drill point"  # begins a note of a depth to the tip of one


@dataclass(frozen=True)
class FoundHole:
    """A hole of a CAD file, in the frame of that file.

    Attributes:
        id: by its place in the file.
        kinds: how it ends, and what its mouth is; or what stands for it in a drawing.
        entry: where the drill enters [mm], on the axis, level with what it meets first, shape (3,).
        direction: of the drill, into the material, unit, shape (3,).
        diameter: of the drill [mm], or None.
        depth: from the entry to the bottom [mm], the tip of a drill point included; or None.
        other_entry: where the drill enters from the other side [mm], shape (3,), if the file does not say which of the
            two it is; else None.
        of: name of the solid, or the layer.
        mouth: in words: a countersink by its diameter and full angle, a counterbore by its diameter and depth.
        notes: what was assumed, in words.
        faces: numbers of the faces in which it opens: at the entry, and at the other end.
    """

    id: str
    kinds: tuple[str, ...]
    entry: Array
    direction: Array
    diameter: float | None
    depth: float | None
    other_entry: Array | None = None
    of: str = ""
    mouth: str = ""
    notes: tuple[str, ...] = ()
    faces: tuple[frozenset[int], frozenset[int]] = (frozenset(), frozenset())


@dataclass(frozen=True)
class FoundHoles:
    """The holes of a CAD file.

    Attributes:
        holes: in the order of the file.
        unit: of length, as the file states it.
        scale: millimetres in the unit with which its numbers were read.
        notes: what was left out, in words.
        picked: numbers of the faces that lie at the places which were asked for.
    """

    holes: tuple[FoundHole, ...]
    unit: str
    scale: float
    notes: tuple[str, ...] = ()
    picked: frozenset[int] = frozenset()


@dataclass(frozen=True)
class Wall:
    """A face of a solid that is a cylinder or a cone with the material outside.

    Attributes:
        face: its number.
        point: of the axis [mm], shape (3,); of a cone its apex.
        axis: unit, shape (3,).
        radius: of a cylinder [mm]; None: a cone.
        slope: of a cone, between its axis and its side [rad].
        edges: numbers of its edges.
        exact: whether the file says that it is one; else it was recognised in a free-form surface.
    """

    face: int
    point: Array
    axis: Array
    radius: float | None
    slope: float
    edges: tuple[int, ...]
    exact: bool


@dataclass(frozen=True)
class Solid:
    """What matters of a solid to find its holes.

    Attributes:
        name: as the file calls it, or its number.
        walls: that could be those of holes.
        points: of each edge of a wall [mm], by its number, shape (N, 3).
        beside: numbers of the faces of an edge, by its number.
        rims: numbers of the edges at which a face meets others, by its number.
        outer: those of its edges that go round its outside, of faces beside a wall.
        inside: whether a point [mm], shape (3,), lies in the material.
    """

    name: str
    walls: tuple[Wall, ...]
    points: Mapping[int, Array]
    beside: Mapping[int, frozenset[int]]
    rims: Mapping[int, frozenset[int]]
    outer: Mapping[int, frozenset[int]]
    inside: Callable[[Array], bool]
