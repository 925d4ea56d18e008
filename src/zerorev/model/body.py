"""Solids: those that move with the arm, and those that stand around it, which it must not touch."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal, TypeAlias

import numpy as np
import numpy.typing as npt

from zerorev.errors import InputError
from zerorev.model._arrays import Array, finite, is_rigid
from zerorev.model.fingerprint import Digested

__all__ = ["Body", "Box", "Capsule", "Mesh", "Obstacle", "Shape"]

MOST_TRIANGLES = 2_000_000  # of one mesh


@dataclass(frozen=True, eq=False)
class Capsule(Digested):
    """All points within a radius of a straight line.

    Attributes:
        ends: of the line [m], shape (2, 3).
        radius: [m], above 0.
    """

    ends: Array
    radius: float

    def __post_init__(self) -> None:
        """Check the numbers."""
        object.__setattr__(self, "ends", finite(self.ends, (2, 3), "capsule, ends"))
        if not 0 < self.radius < np.inf:
            raise InputError("is not above 0", where="radius_mm", accepted="a number above 0 [mm]")


@dataclass(frozen=True, eq=False)
class Box(Digested):
    """A box about its centre.

    Attributes:
        size: along x, y and z [m], shape (3,), above 0.
    """

    size: Array

    def __post_init__(self) -> None:
        """Check the numbers."""
        object.__setattr__(self, "size", finite(self.size, (3,), "box, size_mm"))
        if not (self.size > 0).all():
            raise InputError("is not above 0", where="size_mm", accepted="three numbers above 0 [mm]")


@dataclass(frozen=True, eq=False)
class Mesh(Digested):
    """Triangles; they need not be closed, nor be turned any way.

    Attributes:
        vertices: [m], shape (V, 3).
        faces: numbers of vertices, shape (F, 3).
    """

    vertices: Array
    faces: npt.NDArray[np.int32]

    def __post_init__(self) -> None:
        """Check the numbers."""
        faces = np.asarray(self.faces, dtype=np.int32).reshape(-1, 3)
        object.__setattr__(self, "vertices", finite(self.vertices, (len(self.vertices), 3), "mesh, vertices"))
        object.__setattr__(self, "faces", faces)
        if not 0 < len(faces) <= MOST_TRIANGLES:
            raise InputError(
                f"has {len(faces):,} triangles", where="mesh", accepted=f"1 to {MOST_TRIANGLES:,} triangles"
            )
        if faces.min() < 0 or faces.max() >= len(self.vertices):
            raise InputError("a triangle names a vertex that is not there", where="mesh")

    @property
    def extent(self) -> Array:
        """Its size along x, y and z [m], shape (3,)."""
        used = self.vertices[np.unique(self.faces)]
        return np.asarray(used.max(axis=0) - used.min(axis=0))


Shape: TypeAlias = Capsule | Box | Mesh


def _placed(noun: Body | Obstacle, name: str) -> None:
    T = finite(getattr(noun, name), (4, 4), f"{noun.id}, {name}")
    if not is_rigid(T):
        raise InputError("not a rotation and a translation", where=f"{noun.id}, {name}")
    object.__setattr__(noun, name, T)


@dataclass(frozen=True, eq=False)
class Body(Digested):
    """A solid that moves with a link of the arm.

    Attributes:
        id: how answers call it.
        link: 0, the base, to 6, the flange.
        shape: in its own frame.
        T_link: its frame in that of the link (`zerorev.motion.links`; of link 6 the flange), shape (4, 4) [m].
        touches_part: whether it touches the part where a hole is drilled, as the drill and a pressure foot do: on a
            hole's own moves it is not held against the part.
        guessed: whether no file states it.
    """

    id: str
    link: int
    shape: Shape
    T_link: Array = field(default_factory=lambda: np.eye(4))
    touches_part: bool = False
    guessed: bool = False

    def __post_init__(self) -> None:
        """Check the numbers."""
        _placed(self, "T_link")
        if not 0 <= self.link <= 6:
            raise InputError(f"link {self.link}", where=f"body {self.id}", accepted="a whole number from 0 to 6")


@dataclass(frozen=True, eq=False)
class Obstacle(Digested):
    """A solid that stands still.

    Attributes:
        id: how answers call it.
        kind: what it is.
        shape: a box or a mesh, in its own frame.
        T_base: its frame in the base frame, shape (4, 4) [m].
    """

    id: str
    kind: Literal["part", "fixture", "floor"]
    shape: Box | Mesh
    T_base: Array = field(default_factory=lambda: np.eye(4))

    def __post_init__(self) -> None:
        """Check the numbers."""
        _placed(self, "T_base")
