"""From a profile to the points of a program: lead-in, breakpoints, splits, joint moves, and the blend at each."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from zerorev.model.job import Settings
from zerorev.model.profile import Profile

__all__ = ["GREATEST_TURN", "Leg", "Waypoint", "waypoints", "with_blends"]

GREATEST_TURN = float(np.deg2rad(120.0))
"""Greatest turn of the tool in one move [rad]: at 180 deg the short way round is ambiguous (theory §5)."""


Leg = Literal["approach", "lead-in", "plunge", "retract", "depart"]


@dataclass(frozen=True)
class Waypoint:
    """A point of the twist plane that a program names.

    Attributes:
        standoff: [m].
        psi: spin [rad].
        leg: part of the motion that ends here; of the first point, the part that begins.
        comment: what the point is.
        blend: radius [m]; 0 is an exact stop.
        linear: whether the tip goes there straight; else all joints move evenly.
    """

    standoff: float
    psi: float
    leg: Leg
    comment: str
    blend: float = 0.0
    linear: bool = True


def waypoints(profile: Profile, lead_in: float, reach: float = 0.0) -> tuple[tuple[Waypoint, ...], int]:
    """The points of a motion, the lead-in before it, and the index of the corner among them.

    Each segment is split into equal moves that turn the tool by `GREATEST_TURN` at most.

    Args:
        profile: of the motion.
        lead_in: its length [m].
        reach: how far from the corner joint moves begin and end [m]; 0: there are none.
    """
    start = Waypoint(float(profile.standoff[0]), float(profile.psi[0]), "lead-in", "start of the stroke")
    points = [start]
    if lead_in > 0:
        ahead = Waypoint(
            start.standoff + lead_in, start.psi + float(profile.twist_rate[0]) * lead_in, "lead-in", "lead-in point"
        )
        points = [ahead, *_split(ahead, start)]
    corner = 0
    for k in range(1, len(profile.standoff)):
        leg: Leg = "plunge" if k <= profile.corner else "retract"
        last = k == len(profile.standoff) - 1
        comment = _corner(profile) if k == profile.corner else "end of the stroke" if last else "breakpoint"
        end = Waypoint(float(profile.standoff[k]), float(profile.psi[k]), leg, comment)
        if reach > 0 and k == profile.corner:
            points.extend(_split(points[-1], _before(points[-1], end, reach)))
            points.append(replace(end, linear=False))
        elif reach > 0 and k == profile.corner + 1:
            leave = replace(_before(end, points[-1], reach), leg=leg, comment="end of the joint moves", linear=False)
            points.append(leave)
            points.extend(_split(leave, end))
        else:
            points.extend(_split(points[-1], end))
        if k == profile.corner:
            corner = len(points) - 1
    return tuple(points), corner


def _before(start: Waypoint, end: Waypoint, reach: float) -> Waypoint:
    """The point so far [m] before the end of a straight piece of a motion."""
    share = reach / abs(end.standoff - start.standoff)
    return replace(
        end,
        standoff=end.standoff + share * (start.standoff - end.standoff),
        psi=end.psi + share * (start.psi - end.psi),
        comment="begin of the joint moves",
    )


def _corner(profile: Profile) -> str:
    below = -float(profile.standoff[profile.corner])
    return "target" if below == 0 else f"corner, {below * 1e3:.4g} mm below the target"


def _split(start: Waypoint, end: Waypoint) -> list[Waypoint]:
    """The points after `start` up to `end`, evenly spread, no two of them more than the greatest turn apart."""
    # the margin keeps a turn of just 120 deg in one move in spite of the last bits of it
    pieces = max(1, int(np.ceil(abs(end.psi - start.psi) / GREATEST_TURN - 1e-9)))
    between = [
        replace(
            end,
            standoff=start.standoff + k / pieces * (end.standoff - start.standoff),
            psi=start.psi + k / pieces * (end.psi - start.psi),
            comment=f"split {k} of {pieces - 1}",
        )
        for k in range(1, pieces)
    ]
    return [*between, end]


def with_blends(
    points: tuple[Waypoint, ...], corner: int, settings: Settings, *, stop: bool = False
) -> tuple[Waypoint, ...]:
    """The points with a blend at every inner one, clipped to a share of the shorter neighbouring move.

    A controller clips a greater radius in just this way, without telling; written here, the depth lost is known.

    Args:
        points: in order of motion; the first and the last stay exact stops.
        corner: index of the corner.
        settings: the radii that the job asks for.
        stop: whether the corner is an exact stop all the same.
    """
    lengths, share = np.abs(np.diff([point.standoff for point in points])), settings.blend_share
    at_corner = 0.0 if stop else settings.turning.radius
    radii = [
        min(at_corner if i == corner else settings.passing_blend, share * lengths[i - 1], share * lengths[i])
        for i in range(1, len(points) - 1)
    ]
    inner = [replace(point, blend=float(radius)) for point, radius in zip(points[1:-1], radii, strict=True)]
    return (points[0], *inner, points[-1])
