"""The hole: a drill axis, a stroke, and where the spin is counted from."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from zerorev.errors import InputError
from zerorev.model._arrays import UNIT_TOLERANCE, Array, finite, unit
from zerorev.model.cycle import Cycle
from zerorev.model.profile import Profile
from zerorev.model.tool import Tool

__all__ = ["REFERENCES", "Hole", "psi_zero_vector"]

REFERENCES = ("base_y", "nearest_base", "part_x", "part_y")


@dataclass(frozen=True)
class Hole:
    """One hole to drill, in the base frame.

    Attributes:
        id: how the user calls it.
        target: bottom of the stroke [m], shape (3,).
        direction: unit plunge direction, into the material, shape (3,).
        depth: stroke [m].
        psi_zero: direction of Y_tcp at psi = 0, shape (3,); made unit and perpendicular to `direction`. The default is
            Y_base, the reference `base_y`.
        profile: a given motion, evaluated instead of searched for.
        branch: the branch of the given motion (0..7); with no `profile`, the only branch to search.
        group: with which it is drilled where the job's order is by groups.
        cycle: how it is drilled; None: as the job says.
    """

    id: str
    target: Array
    direction: Array
    depth: float
    psi_zero: Array = field(default_factory=lambda: np.array([0.0, 1.0, 0.0]))
    profile: Profile | None = None
    branch: int | None = None
    group: str = ""
    cycle: Cycle | None = None

    def drilled_by(self, usual: Cycle) -> Cycle:
        """How it is drilled.

        Args:
            usual: where it does not say so itself.
        """
        return self.cycle or usual

    @property
    def entry(self) -> Array:
        """Where the stroke begins [m], shape (3,)."""
        return self.target - self.depth * self.direction

    def __post_init__(self) -> None:
        """Check the numbers; scale the direction; make psi_zero perpendicular to it."""
        where = f"hole {self.id}"
        direction = unit(self.direction, f"{where}, direction")
        object.__setattr__(self, "target", finite(self.target, (3,), f"{where}, target"))
        object.__setattr__(self, "direction", direction)
        object.__setattr__(self, "psi_zero", _perpendicular(self.psi_zero, direction, where))
        if not (np.isfinite(self.depth) and self.depth > 0):
            raise InputError(f"a depth of {self.depth * 1e3:g} mm", where=where, accepted="a finite depth above 0")
        if self.branch is not None and self.branch not in range(8):
            raise InputError(f"branch {self.branch}", where=where, accepted="0 to 7")
        if self.profile is not None:
            ends = self.profile.standoff[[0, -1]]
            if not np.allclose(ends, self.depth, rtol=0, atol=1e-9):
                raise InputError(
                    f"the given motion runs from {ends[0] * 1e3:g} to {ends[1] * 1e3:g} mm of stand-off",
                    where=where,
                    accepted=f"both ends at the depth, {self.depth * 1e3:g} mm",
                )


def psi_zero_vector(
    reference: str | Array, target: Array, direction: Array, tool: Tool, T_base_part: Array, where: str
) -> Array:
    """Y_tcp at psi = 0 in the base frame, unit, shape (3,) (conventions: frames).

    Args:
        reference: one of `REFERENCES`, or a vector in the part frame, shape (3,).
        target: bottom of the hole [m], base frame, shape (3,).
        direction: unit plunge direction, base frame, shape (3,).
        tool: needed for `nearest_base` alone.
        T_base_part: part frame, shape (4, 4).
        where: how a message names the hole.

    Raises:
        InputError: unknown reference, or one that is parallel to the drill axis.
    """
    if not isinstance(reference, str):
        return _perpendicular(T_base_part[:3, :3] @ unit(reference, "psi_reference"), direction, where)
    if reference == "nearest_base":
        return _nearest_base(target, direction, tool, where)
    axes = {"base_y": np.array([0.0, 1.0, 0.0]), "part_x": T_base_part[:3, 0], "part_y": T_base_part[:3, 1]}
    if reference not in axes:
        raise InputError(
            f"unknown reference '{reference}'", where="psi_reference", accepted=f"{', '.join(REFERENCES)}, or a vector"
        )
    return _perpendicular(axes[reference], direction, where, reference)


def _perpendicular(vector: Array, direction: Array, where: str, name: str = "psi reference") -> Array:
    given = unit(vector, f"{where}, {name}")
    across = given - (given @ direction) * direction
    length = float(np.linalg.norm(across))
    if abs(given @ direction) < UNIT_TOLERANCE and abs(length - 1) < UNIT_TOLERANCE:
        return given  # of a plan file: to stay as it is, digit for digit
    if length < 1e-6:
        raise InputError(
            f"{name} is parallel to the drill axis, so it cannot count the spin",
            where=where,
            accepted=f"another of {', '.join(REFERENCES)}, or a vector across the drill axis",
        )
    return across / length


def _nearest_base(target: Array, direction: Array, tool: Tool, where: str) -> Array:
    """Y_tcp at the spin that brings the flange closest to the base axis at the target (thesis sec. 3.1)."""
    R, tip = tool.T_flange_tcp[:3, :3], tool.T_flange_tcp[:3, 3]
    flange = -R.T @ tip  # the flange's origin in the tcp frame
    if np.hypot(flange[0], flange[1]) < 1e-9:
        raise InputError(
            "the flange lies on the drill axis, so no spin brings it nearer to the base",
            where=where,
            accepted="another psi_reference",
        )
    z = -direction
    x = np.cross(np.eye(3)[np.argmin(np.abs(z))], z)
    x /= np.linalg.norm(x)
    y = np.cross(z, x)
    centre = target + flange[2] * z

    # seen from above: the flange at psi = 0, and a quarter turn on
    first, second = (flange[0] * x + flange[1] * y)[:2], (flange[0] * y - flange[1] * x)[:2]

    def place(psi: Array | float) -> Array:
        across = np.multiply.outer(np.cos(psi), first) + np.multiply.outer(np.sin(psi), second)
        return np.asarray(centre[:2] + across)

    # one smooth period: a grid finds the valley, Newton's steps its bottom
    grid = np.linspace(-np.pi, np.pi, 721)
    psi = float(grid[np.argmin(np.linalg.norm(place(grid), axis=-1))])
    for _ in range(8):
        turning = np.cos(psi) * second - np.sin(psi) * first
        bend = turning @ turning - place(psi) @ (place(psi) - centre[:2])
        psi -= float(np.clip(place(psi) @ turning / max(bend, 1e-300), grid[0] - grid[1], grid[1] - grid[0]))
    return np.asarray(np.cos(psi) * y - np.sin(psi) * x)
