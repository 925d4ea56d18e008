"""The tool: where the tip of the drill sits on the flange, and which way it points."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from zerorev.errors import InputError
from zerorev.model._arrays import Array, finite, is_rigid, rotation_rpy, transform
from zerorev.model.body import Body
from zerorev.model.dynamics import Load

__all__ = ["Tool"]


@dataclass(frozen=True)
class Tool:
    """A drill on the flange.

    Attributes:
        name: how jobs call it.
        T_flange_tcp: tool centre point in the flange frame, shape (4, 4), translation [m]; Z_tcp points against the
            plunge.
        sources: where the numbers come from.
        load: what it weighs, or None where that is not known.
        bodies: solids on link 6, the flange; empty: none is stated, and capsules about its own lines stand for it.
    """

    name: str
    T_flange_tcp: Array
    sources: dict[str, str] = field(default_factory=dict, compare=False)
    load: Load | None = None
    bodies: tuple[Body, ...] = ()

    def __post_init__(self) -> None:
        """Check that the transform is a rigid motion."""
        T = finite(self.T_flange_tcp, (4, 4), f"tool {self.name}, T_flange_tcp")
        if not is_rigid(T):
            raise InputError("not a rotation and a translation", where=f"tool {self.name}, T_flange_tcp")
        object.__setattr__(self, "T_flange_tcp", T)
        if any(body.link != 6 for body in self.bodies):
            raise InputError("a body is not on the flange", where=f"tool {self.name}, bodies", accepted="link 6")

    @classmethod
    def from_mm_deg(
        cls, tcp_mm: tuple[float, float, float], rpy_deg: tuple[float, float, float], *, name: str = "tool"
    ) -> Tool:
        """Tool from the tip's place [mm] and roll, pitch, yaw [deg] in the flange frame.

        Raises:
            InputError: not finite numbers.
        """
        roll, pitch, yaw = np.deg2rad(finite(rpy_deg, (3,), f"tool {name}, rpy_deg"))
        return cls(name, transform(rotation_rpy(roll, pitch, yaw), finite(tcp_mm, (3,), f"tool {name}, tcp_mm") * 1e-3))
