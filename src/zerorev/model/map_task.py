"""What a workspace map asks: targets and directions, and one question put to each pair of them."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
import numpy.typing as npt

from zerorev.errors import InputError
from zerorev.model._arrays import Array, unit
from zerorev.model.hole import Hole, psi_zero_vector
from zerorev.model.job import Settings, check_robot
from zerorev.model.quantity import in_words, quantity
from zerorev.model.robot import Robot
from zerorev.model.tool import Tool

__all__ = ["SETTINGS", "MapTask", "Question", "cone", "sphere"]

SETTINGS = ("min_rate", "psi_bound", "legs", "max_twist", "limit_margin")
"""Names of the settings that a map heeds; and `cycle`, which has a form of its own."""

NOMINAL_DEPTH = 1e-3  # [m] of a hole whose depth is not examined
GOLDEN_TURN = np.pi * (3 - np.sqrt(5))
BASE_WALL = 0.05  # [m] that a robot's base reaches, at the very least, beyond where axis 2 turns about axis 1


@dataclass(frozen=True)
class Question:
    """What is asked in each cell of a map.

    Attributes:
        robot: the arm.
        tool: the drill on its flange.
        quantity: which number is wanted (`model.quantity`).
        settings: of which those named in `SETTINGS`, and the cycle, count.
        psi_reference: `base_y`, `nearest_base`, or a vector in the base frame.
        depth: stroke [m] where the quantity needs one, else None.
        seed: of the swarm.
    """

    robot: Robot
    tool: Tool
    quantity: str = "deepest"
    settings: Settings = field(default_factory=Settings)
    psi_reference: str | tuple[float, ...] = "base_y"
    depth: float | None = None
    seed: int = 0

    def __post_init__(self) -> None:
        """Check that what the quantity needs is there, and nothing that it does not look at."""
        wanted = quantity(self.quantity)
        if (self.depth is None) == wanted.needs_depth:
            what = "is missing" if self.depth is None else f"is not used by {self.quantity}"
            accepted = f"a stroke for {in_words(lambda each: each.needs_depth, 'and')}; none for the others"
            raise InputError(what, where="depth_mm", accepted=accepted)
        if self.depth is not None and not 0 < self.depth < np.inf:
            raise InputError(f"a depth of {self.depth * 1e3:g} mm", where="depth_mm", accepted="a finite depth above 0")
        check_robot(self.robot, self.settings)
        if self.settings.legs == "free" and not wanted.free_legs:
            raise InputError("free", where="legs", accepted=f"straight: {self.quantity} knows no other")
        kind = self.settings.cycle.kind
        if (kind == "chip_break" and not wanted.cycles) or (kind == "peck" and wanted.needs_depth):
            accepted = f"single: {self.quantity} knows no other" if kind == "chip_break" else "single, a map a stroke"
            raise InputError(kind, where="cycle, kind", accepted=accepted)

    def hole(self, target: Array, direction: Array, name: str = "cell", depth: float | None = None) -> Hole:
        """The hole of a cell.

        Args:
            target: [m], shape (3,).
            direction: unit vector, shape (3,).
            name: how messages call it.
            depth: [m]; by default that of the question, or a nominal one.

        Raises:
            InputError: the spin cannot be counted from the reference, which lies along the drill axis.
        """
        given = self.psi_reference
        reference = given if isinstance(given, str) else np.array(given)
        psi_zero = psi_zero_vector(reference, target, direction, self.tool, np.eye(4), name)
        return Hole(name, target, direction, depth or self.depth or NOMINAL_DEPTH, psi_zero)


@dataclass(frozen=True)
class MapTask:
    """A whole map; its cells are numbered targets first, directions within.

    Attributes:
        question: what is asked in each cell.
        axes: coordinates of a box of targets [mm], one array each for x, y and z; or of points, shape (3, P).
        directions: unit vectors into the material, shape (D, 3).
        ids: of the points; None for a box.
        T_base_part: the frame of axes and directions, shape (4, 4), translation [m]; by default the base frame.
    """

    question: Question
    axes: tuple[Array, Array, Array]
    directions: Array
    ids: tuple[str, ...] | None = None
    T_base_part: Array = field(default_factory=lambda: np.eye(4))

    def __post_init__(self) -> None:
        """Check that the spin can be counted in every direction, and that the robot does not stand in every target."""
        for n, direction in enumerate(self.drills):
            self.question.hole(self.target_mm(0) / 1e3, direction, f"directions[{n}]")
        if self.base_radius_mm and self.cells_in_base == self.cells:
            raise InputError("every target lies inside the robot's base", where="targets", accepted=self.outside)

    @property
    def dims(self) -> tuple[str, ...]:
        """Names of the dimensions of the map."""
        return ("x", "y", "z", "direction") if self.ids is None else ("point", "direction")

    @property
    def shape(self) -> tuple[int, ...]:
        """Cells along each dimension."""
        targets = tuple(len(axis) for axis in self.axes) if self.ids is None else (len(self.ids),)
        return (*targets, len(self.directions))

    @property
    def cells(self) -> int:
        """How many there are."""
        return int(np.prod(self.shape))

    def target_mm(self, places: npt.NDArray[np.int64] | int) -> Array:
        """Targets [mm] in the base frame by their numbers, shape (..., 3)."""
        where = np.unravel_index(np.asarray(places), self.shape[:-1])
        index = where if self.ids is None else where * 3
        targets = np.stack([axis[at] for axis, at in zip(self.axes, index, strict=True)], axis=-1)
        return targets if self.of_base else targets @ self.T_base_part[:3, :3].T + self.T_base_part[:3, 3] * 1e3

    @property
    def of_base(self) -> bool:
        """Whether the part frame is the base frame."""
        return bool((self.T_base_part == np.eye(4)).all())

    @property
    def drills(self) -> Array:
        """The directions in the base frame, shape (D, 3)."""
        return self.directions if self.of_base else self.directions @ self.T_base_part[:3, :3].T

    @property
    def base_radius_mm(self) -> float:
        """Within which of axis 1, and below the shoulder, there is surely the robot's own base [mm]."""
        return (abs(self.question.robot.arm.a1) + BASE_WALL) * 1e3

    def in_base(self, target_mm: Array) -> npt.NDArray[np.bool_]:
        """Which targets [mm], shape (..., 3), lie inside the robot's base."""
        radius = np.hypot(target_mm[..., 0], target_mm[..., 1])
        below = target_mm[..., 2] < self.question.robot.arm.c1 * 1e3
        return np.asarray((radius < self.base_radius_mm) & below)

    @cached_property
    def cells_in_base(self) -> int:
        """How many cells have a target inside the robot's base."""
        if self.ids is not None or not self.of_base:
            inside = self.in_base(self.target_mm(np.arange(self.cells // len(self.directions)))).sum()
        else:
            x, y, z = self.axes
            below = (z < self.question.robot.arm.c1 * 1e3).sum()
            inside = (np.hypot(x[:, None], y) < self.base_radius_mm).sum() * below
        return int(inside) * len(self.directions)

    @property
    def outside(self) -> str:
        """Where targets may lie, for messages."""
        shoulder = self.question.robot.arm.c1 * 1e3
        return f"targets {self.base_radius_mm:g} mm or more from axis 1, or {shoulder:g} mm or more above its foot"


def sphere(count: int) -> Array:
    """Directions spread evenly over the sphere, a Fibonacci spiral, shape (count, 3)."""
    height = 1 - 2 * (np.arange(count) + 0.5) / count
    return _spiral(height, count)


def cone(axis: Array, half_angle: float, count: int) -> Array:
    """Directions spread evenly over the cap of a cone, the first its axis, the last on its rim, shape (count, 3).

    Args:
        axis: of any length, shape (3,).
        half_angle: from axis to rim [rad].
        count: how many; one alone is the axis.
    """
    height = 1 - (1 - np.cos(half_angle)) * np.arange(count) / max(count - 1, 1)
    z = unit(axis, "axis")
    x = np.cross(np.eye(3)[np.argmin(np.abs(z))], z)
    x /= np.linalg.norm(x)
    found = _spiral(height, count) @ np.stack([x, np.cross(z, x), z])
    return np.asarray(found / np.linalg.norm(found, axis=1, keepdims=True))


def _spiral(height: Array, count: int) -> Array:
    turn, radius = GOLDEN_TURN * np.arange(count), np.sqrt(np.maximum(0.0, 1 - height**2))
    return np.stack([radius * np.cos(turn), radius * np.sin(turn), height], axis=-1)
