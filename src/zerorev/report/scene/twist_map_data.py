"""The twist map and the motion over it as plain data, as the component in the browser takes them: mm and deg."""

from __future__ import annotations

import base64
from typing import Any

import numpy as np

from zerorev.files.units import deg, deg_per_mm, mm
from zerorev.model.profile import Profile
from zerorev.model.robot import Robot
from zerorev.motion.drilling import Drilling
from zerorev.motion.loads import twins_lost_motion
from zerorev.report.scene.clearance import ClearanceZone
from zerorev.report.scene.load_lines import senses
from zerorev.report.scene.motion_look import Look
from zerorev.report.scene.palette import DASHES, JOINT_COLOURS, JOINT_INKS
from zerorev.report.scene.twist_map import LIMITED, NEAR_SINGULAR, UNREACHED, TwistMap
from zerorev.report.words.lost_motion import lost_motion_words

__all__ = ["loads_data", "map_data", "motion_data", "zone_data"]

FLOOR, CAP = 0.3, 10.0  # [deg/mm] twist spreads that the shades tell apart


def motion_data(robot: Robot, profile: Profile, seen: Look) -> dict[str, Any]:
    """A motion as the map's component takes it; small, since it is sent at every step of a drag.

    Args:
        robot: the arm.
        profile: the spin along the path.
        seen: what was seen of it.
    """
    score = seen.score
    counts = score.reversals_per_joint if score else (None,) * 6
    return {
        "points": np.stack([mm(profile.standoff), deg(profile.psi)], axis=-1).tolist(),
        "runs": seen.runs,
        "why": seen.why,
        "faults": [
            {"kind": each.kind, "start": float(mm(each.start)), "end": float(mm(each.end))} for each in seen.faults
        ],
        "marks": [
            {"joint": each.joint, "name": each.name, "x": round(float(mm(each.distance)), 4), "leg": each.leg,
             "colour": JOINT_COLOURS[each.joint - 1], "ink": JOINT_INKS[each.joint - 1]}
            for each in seen.marks
        ],
        "reversals": seen.reversals,
        "joints": [
            {"name": name, "count": "–" if count is None else count, "colour": JOINT_COLOURS[i], "dash": _dash(i, 1.5),
             "title": _joint_title(name, i, seen)}
            for i, (name, count) in enumerate(zip(robot.joint_names, counts, strict=True))
        ],
        "travel": f"{deg(score.travel):.1f}" if score else "",
        "margin": "" if seen.margin is None else _rate(seen.margin),
        "limit": f"{deg(score.limit_distance.min()):.1f}" if score else "",
    }  # fmt: skip


def loads_data(drilling: Drilling, profile: Profile, branch: int, thrust: float) -> dict[str, Any]:
    """What the gears make of a motion, beside `motion_data`: microseconds, so that it follows a drag, too.

    Args:
        drilling: robot, tool and hole.
        profile: the spin along the path.
        branch: 0..7.
        thrust: of the drill while it plunges [N].

    Returns:
        `lost`: the predicted lost motion at the tip in words, and with the legs swapped; None for a robot without
        dynamics. `senses`: which ways the joints turn on either leg, or None.
    """
    if drilling.robot.dynamics is None:
        return {"lost": None, "senses": None}
    lost = twins_lost_motion(drilling, profile, branch, thrust)
    return {"lost": lost_motion_words(lost), "senses": None if lost is None else senses(drilling, profile, branch)}


def _joint_title(name: str, i: int, seen: Look) -> str:
    if seen.score is None:
        return name
    rate, away = _rate(seen.score.min_rate[i]), deg(seen.score.limit_distance[i])
    return f"{name}: slowest at {rate} deg/mm, {away:.1f} deg from its nearest limit"


def _rate(rate: float) -> str:
    """A joint's rate [rad/m] in deg/mm, as short as says anything."""
    value = float(deg_per_mm(rate))
    return f"{value:.3f}" if value >= 0.0005 else "under 0.001"


def _dash(i: int, scale: float = 2.0) -> list[float]:
    dash = DASHES[i]
    return [] if isinstance(dash, str) else [length * scale for length in dash[1]]


def map_data(robot: Robot, found: TwistMap) -> dict[str, Any]:
    """A map as its component takes it: mm and deg, grids as bytes in base64.

    Args:
        robot: the arm.
        found: the map.
    """
    finite = found.spread[np.isfinite(found.spread)]
    least = float(np.quantile(finite, 0.005)) if finite.size else FLOOR
    floor = float(f"{min(max(least, FLOOR), CAP / 4):.1g}")
    with np.errstate(invalid="ignore"):
        level = 254 * np.log(np.clip(found.spread, floor, CAP) / floor) / np.log(CAP / floor)
    shades = np.where(np.isnan(level), 255, np.round(level)).astype(np.uint8)
    return {
        "branch": found.branch,
        "reach": float(mm(found.standoff[-1] - found.standoff[0])),
        "corner": float(mm(found.standoff[0])),
        "shape": list(found.zone.shape),
        "spread": _coded(shades),
        "spread_range": [floor, CAP],
        "zone": _coded(found.zone),
        "limited": _coded(found.limited),
        "singular": _coded(found.singular),
        "best": _coded(found.best.astype(np.uint8)),
        "regions": [
            {
                "zone": region.zone,
                "rings": [_flat(ring, found) for ring in region.rings],
                "edges": [_flat(edge, found) for edge in region.edges],
            }
            for region in found.regions
        ],
        "lines": [{"joint": line.joint, "points": _flat(line.points, found)} for line in found.lines],
        "loads": [
            {
                "joint": line.joint,
                "sense": line.sense,
                "level": f"{line.level:.0%}",
                "legs": line.legs,
                "points": _flat(line.points, found),
            }
            for line in found.load_lines
        ],
        "joints": [
            {"name": name, "colour": JOINT_COLOURS[i], "ink": JOINT_INKS[i], "dash": _dash(i)}
            for i, name in enumerate(robot.joint_names)
        ],
        "stuck": [robot.joint_names[joint - 1] for joint in found.stuck],
        "legend": _legend(robot, found),
    }


def zone_data(found: ClearanceZone) -> dict[str, Any]:
    """Where the clearance is not kept, beside `map_data`.

    Args:
        found: of the hole and the branch of the map.
    """
    asked = f"nearer than {mm(found.clearance):g} mm" if found.clearance > 0 else "touching"
    return {
        "branch": found.branch,
        "near": _coded(found.near.astype(np.uint8)),
        "rings": [_flat(ring, found) for ring in found.region.rings],
        "edges": [_flat(edge, found) for edge in found.region.edges],
        "text": f"{asked} to part, fixtures or itself",
    }


def _legend(robot: Robot, found: TwistMap) -> list[dict[str, Any]]:
    """Which zones there are, and of which joint."""
    out = []
    for zone, text, bits, names in (
        (NEAR_SINGULAR, "near-singular", found.singular, ("shoulder", "elbow", "wrist")),
        (LIMITED, "over a joint limit", found.limited, robot.joint_names),
        (UNREACHED, "out of reach", None, ()),
    ):
        there = found.zone == zone
        if there.any():
            whose = [] if bits is None else [name for i, name in enumerate(names) if (bits[there] & (1 << i)).any()]
            out.append({"zone": zone, "text": text + (f" ({', '.join(whose)})" if whose else "")})
    return out


def _flat(points: np.ndarray, found: TwistMap | ClearanceZone) -> list[float]:
    """Path distance from the corner [mm] and spin [deg] of each point, one after the other."""
    away = mm(points[:, 0] - found.standoff[0])
    flat: list[float] = np.round(np.stack([away, deg(points[:, 1])], axis=-1), 3).ravel().tolist()
    return flat


def _coded(grid: np.ndarray) -> str:
    return base64.b64encode(np.ascontiguousarray(grid).tobytes()).decode()
