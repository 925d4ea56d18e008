"""How near a motion comes to what stands around the arm, as plain data: mm and degrees."""

from __future__ import annotations

from typing import Any

import numpy as np

from zerorev.collision.arms import Setting, setting_of
from zerorev.collision.poses import poses_nearest
from zerorev.files.units import deg, mm
from zerorev.model._arrays import Array
from zerorev.model.body import Capsule
from zerorev.model.plan import Clearance, Motion
from zerorev.model.profile import Profile
from zerorev.model.settings import Settings
from zerorev.motion.drilling import Drilling
from zerorev.planning.clearance import Approached, approached, too_near
from zerorev.report.scene.packing import packed

__all__ = ["least_data", "nearest_data"]

SAMPLES = 65  # of a stroke
AT_TARGET = 5e-5  # [m] from the target it is not said how far


def least_data(
    drilling: Drilling, settings: Settings, motion: Motion | None, *, fast: bool = False
) -> dict[str, Any] | None:
    """The least clearance of a motion, where, and between what; None where nothing stands around, or it cannot be run.

    It is that of the plan, of all of the hole's own moves.

    Args:
        drilling: robot, tool and hole.
        settings: with what stands around, and the clearance.
        motion: with its joints.
        fast: whether that of samples of the stroke alone is enough, as while it is dragged.
    """
    if motion is None:
        return None
    found = (_sampled if fast else approached)(drilling, settings, motion)
    if found is None:
        return None
    near, why = found.clearance, too_near(found.clearance, settings)
    away, where = _where(motion.profile, found)
    text = f"{round(float(mm(near.least)), 2) + 0.0:.2f}".replace("-", "−")
    return {
        "least": text, "between": " – ".join(near.between), "where": where, "x": float(mm(away)),
        "psi": float(deg(found.psi)), "low": why is not None, "why": why or "",
    }  # fmt: skip


def _sampled(drilling: Drilling, settings: Settings, motion: Motion) -> Approached | None:
    """Where samples of the stroke come nearest."""
    setting = setting_of(drilling.robot, drilling.tool, settings)
    if setting is None:
        return None
    way = motion.profile.distance
    standoff, psi = motion.profile.at(np.union1d(way, np.linspace(way[0], way[-1], SAMPLES)))
    apart, pair, _ = poses_nearest(setting, drilling, motion.branch, standoff, psi)
    if np.isnan(pair).all():
        return None
    n = int(np.nanargmin(apart))
    near = Clearance(float(apart[n]), float(standoff[n]), setting.names(int(pair[n])), certified=False)
    return Approached(near, float(psi[n]))


def _where(profile: Profile, found: Approached) -> tuple[float, str]:
    """Path distance from the corner [m], negative on the plunge, and the place in words."""
    standoff = found.clearance.standoff
    assert standoff is not None
    corner, begin = profile.distance[profile.corner], float(profile.standoff[0])
    away = standoff - float(profile.standoff[profile.corner])
    if away < AT_TARGET:
        return 0.0, "at the target"
    inside = min(away, float(corner))
    plunge, retract = (float(profile.at(np.asarray(corner + side * inside))[1]) for side in (-1, 1))
    before = abs(found.psi - plunge) <= abs(found.psi - retract)
    if standoff > begin + AT_TARGET:
        text = f"{mm(standoff - begin):.1f} mm {'before' if before else 'after'} the stroke"
    else:
        text = f"{mm(away):.1f} mm out on the {'plunge' if before else 'retract'}"
    return -away if before else away, text


def nearest_data(
    drilling: Drilling, settings: Settings, branch: int, standoff: Array, psi: Array
) -> dict[str, Any] | None:
    """What is nearest to what at the poses of a motion; None where nothing stands around.

    Args:
        drilling: robot, tool and hole.
        settings: with what stands around, and the clearance.
        branch: 0..7.
        standoff: [m], shape (n,).
        psi: [rad], shape (n,).
    """
    setting = setting_of(drilling.robot, drilling.tool, settings)
    if setting is None or not (setting.drilled & setting.against).any():
        return None
    apart, pair, points = poses_nearest(setting, drilling, branch, standoff, psi)
    reached = ~np.isnan(pair)
    kinds, of = np.unique(pair[reached].astype(int), return_inverse=True)
    numbers = np.full(pair.size, -1)
    numbers[reached] = of.ravel()
    for n, kind in enumerate(kinds.tolist()):
        points[numbers == n] = _on_surfaces(setting, kind, points[numbers == n])
    return {
        "pairs": [list(setting.names(kind)) for kind in kinds.tolist()],
        "pair": packed(numbers, "<f4"),
        "apart_mm": packed(mm(np.maximum(apart, 0.0))),
        "points_mm": packed(mm(points.reshape(-1, 6))),
        "asked_mm": float(mm(settings.clearance)),
    }


def _on_surfaces(setting: Setting, pair: int, points: Array) -> Array:
    """Nearest points of both solids of a pair, shape (n, 2, 3): a capsule's are given on its line."""
    shape = setting.bodies[setting.arms.pairs[pair, 0]].shape
    radius = shape.radius if isinstance(shape, Capsule) else 0.0
    way = points[:, 1] - points[:, 0]
    far = np.linalg.norm(way, axis=1, keepdims=True)
    share = np.divide(np.minimum(radius, far), far, out=np.zeros_like(far), where=far > 0)
    return np.stack([points[:, 0] + share * way, points[:, 1]], axis=1)
