"""What of the twist plane comes too near to what stands around the arm."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from zerorev.collision.arms import setting_of
from zerorev.collision.poses import poses_keep
from zerorev.model._arrays import Array
from zerorev.model.settings import Settings
from zerorev.motion.drilling import Drilling
from zerorev.report.scene.regions import Region, regions
from zerorev.report.scene.twist_map import SHAPE

__all__ = ["ClearanceZone", "clearance_zone"]


@dataclass(frozen=True)
class ClearanceZone:
    """Where a branch does not keep the clearance, nor two bodies of the arm apart, over the stroke and a turn of spin.

    Attributes:
        branch: 0..7.
        clearance: that is asked for [m].
        standoff: [m], shape (S,).
        psi: [rad], shape (P,), from -pi to pi.
        near: whether it is not kept, shape (S, P); False out of reach.
        region: its outlines.
    """

    branch: int
    clearance: float
    standoff: Array
    psi: Array
    near: npt.NDArray[np.bool_]
    region: Region


def clearance_zone(
    drilling: Drilling, settings: Settings, branch: int, corner: float = 0.0, shape: tuple[int, int] = SHAPE
) -> ClearanceZone | None:
    """The zone of a hole and a branch, as `twist_map` spans it; some tens of milliseconds.

    Args:
        drilling: robot, tool and hole: whose stroke it spans.
        settings: with what stands around, and the clearance.
        branch: 0..7.
        corner: stand-off of the motion's corner [m], below 0 where it is placed deeper.
        shape: how many stand-offs and spins.

    Returns:
        None where nothing is known to stand around.
    """
    setting = setting_of(drilling.robot, drilling.tool, settings)
    if setting is None:
        return None

    def zone_at(s: Array, p: Array) -> npt.NDArray[np.uint8]:
        reached = ~np.isnan(drilling.angles(s, p)[..., branch, 0])
        return (reached & ~poses_keep(setting, drilling, branch, s, p)).astype(np.uint8)

    standoff, psi = np.linspace(corner, drilling.hole.depth, shape[0]), np.linspace(-np.pi, np.pi, shape[1])
    s, p = np.meshgrid(standoff, psi, indexing="ij")
    near = zone_at(s.ravel(), p.ravel()).reshape(shape)
    (region,) = regions(standoff, psi, near, (1,), zone_at)
    return ClearanceZone(branch, settings.clearance, standoff, psi, near > 0, region)
