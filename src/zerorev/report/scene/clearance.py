"""The data behind a picture of clearances: solids, the nearest points at a pose, and the zone of the twist plane."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from zerorev.collision.arms import Setting, setting_of
from zerorev.collision.near import moves, nearest_of, poses_apart
from zerorev.model._arrays import Array
from zerorev.model.body import Body, Obstacle
from zerorev.model.settings import Settings
from zerorev.motion.drilling import Drilling

__all__ = ["NearestNow", "clearance_zone", "nearest_at", "solids_of"]


@dataclass(frozen=True)
class NearestNow:
    """What is nearest to what at a pose.

    Attributes:
        distance: [m].
        between: the body, and what it is near to.
        points: on the line of a capsule, or in a box or a triangle, of both: base frame [m], shape (2, 3).
    """

    distance: float
    between: tuple[str, str]
    points: Array


def solids_of(drilling: Drilling, settings: Settings) -> tuple[tuple[Body, ...], tuple[Obstacle, ...]]:
    """The bodies of the arm with its tool, and what stands around; both empty where neither is stated.

    A body moves with its link: T_base_link (`motion.links.link_frames`; link 0 is the base) times its `T_link`.

    Args:
        drilling: robot, tool and hole.
        settings: with what stands around.
    """
    setting = setting_of(drilling.robot, drilling.tool, settings)
    return ((), ()) if setting is None else (setting.bodies, setting.obstacles)


def nearest_at(drilling: Drilling, settings: Settings, joints: Array, *, at_hole: bool = True) -> NearestNow | None:
    """The nearest points at a pose; None where nothing stands around.

    Args:
        drilling: robot, tool and hole.
        settings: with what stands around.
        joints: controller angles [rad], shape (6,).
        at_hole: whether a hole is drilled, so that the drill may be in the part.
    """
    setting = setting_of(drilling.robot, drilling.tool, settings)
    if setting is None:
        return None
    pairs = setting.against & (setting.drilled if at_hole else setting.all_pairs)
    found, points = nearest_of(setting, drilling.robot, moves(np.stack([joints, joints])), pairs)
    if found is None or points is None:
        return None
    return NearestNow(found.distance, found.between, np.stack([points.one, points.other]))


def clearance_zone(
    drilling: Drilling, settings: Settings, branch: int, standoff: npt.ArrayLike, psi: npt.ArrayLike
) -> Array | None:
    """How far the arm is from what stands around, less what is asked for, at points of the twist plane [m].

    Below 0 the clearance is not kept; NaN out of reach. None where nothing is known to stand around.

    Args:
        drilling: robot, tool and hole.
        settings: with what stands around, and the clearance.
        branch: 0..7.
        standoff: [m], any shape.
        psi: [rad], a shape that goes with it.
    """
    setting: Setting | None = setting_of(drilling.robot, drilling.tool, settings)
    if setting is None:
        return None
    s, p = np.broadcast_arrays(np.asarray(standoff, dtype=float), np.asarray(psi, dtype=float))
    return poses_apart(setting, drilling, branch, s.ravel(), p.ravel()).reshape(s.shape)
