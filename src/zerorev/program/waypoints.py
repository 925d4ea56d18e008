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


Leg = Literal["approach", "lead-in", "plunge", "spin", "retract", "depart"]


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


def waypoints(
    profile: Profile, lead_in: float, reach: float = 0.0, last: float = 0.0, spin: int = 0
) -> tuple[tuple[Waypoint, ...], int]:
    """The points of a motion, the lead-in before it, and the index of the corner among them.

    Each segment is split into equal moves that turn the tool by `GREATEST_TURN` at most.

    Args:
        profile: of the motion.
        lead_in: its length [m].
        reach: how far from the corner joint moves begin and end [m]; 0: there are none.
        last: of the way in, has a feed of its own [m]; 0: none has.
        spin: on how many joint moves the tool spins on, just before the corner.
    """
    begin = profile.corner - spin
    turns = {*profile.turns, begin}
    start = Waypoint(float(profile.standoff[0]), float(profile.psi[0]), "lead-in", "start of the stroke")
    points = [start]
    if lead_in > 0:
        ahead = Waypoint(
            start.standoff + lead_in, start.psi + float(profile.twist_rate[0]) * lead_in, "lead-in", "lead-in point"
        )
        points = [ahead, *_split(ahead, start)]
    corner = 0
    for k in range(1, len(profile.standoff)):
        leg: Leg = "plunge" if k <= begin else "spin" if k <= profile.corner else "retract"
        said = _said_of(profile, k) if k == profile.corner or not begin <= k < profile.corner else "spins on from here"
        end = Waypoint(float(profile.standoff[k]), float(profile.psi[k]), leg, said)
        if leg == "spin":
            points.append(replace(end, linear=False))
            corner = len(points) - 1
            continue
        from_turn, to_turn = k - 1 in turns, k in turns
        if k <= profile.corner and last > 0 and points[-1].standoff > last > end.standoff + reach * to_turn:
            slower = replace(_on_the_way(points[-1], end, points[-1].standoff - last), comment="the last of the way in")
            points.extend(_joint_moves(points[-1], slower, from_turn, False, reach))
            from_turn = False
        points.extend(_joint_moves(points[-1], end, from_turn, to_turn, reach))
        if k == begin:
            corner = len(points) - 1
    return tuple(points), corner


def _said_of(profile: Profile, k: int) -> str:
    """What a breakpoint is."""
    if k == profile.corner:
        below = -float(profile.standoff[k])
        return "target" if below == 0 else f"corner, {below * 1e3:.4g} mm below the target"
    if k in profile.turns:
        inwards = profile.standoff[k] < profile.standoff[k - 1]
        return "chips are broken" if inwards else "drawn back"
    return "end of the stroke" if k == len(profile.standoff) - 1 else "breakpoint"


def _joint_moves(start: Waypoint, end: Waypoint, from_turn: bool, to_turn: bool, reach: float) -> list[Waypoint]:
    """The points of a straight piece after its start, the pieces next to where the tool turns round as joint moves."""
    length = abs(end.standoff - start.standoff)
    first, last = reach * from_turn, reach * to_turn
    if reach == 0 or first + last == 0:
        return _split(start, end)
    if first + last >= length:
        return [replace(end, linear=False)]
    points, here = list[Waypoint](), start
    if first > 0:
        here = replace(_on_the_way(start, end, first), comment="end of the joint moves", linear=False)
        points.append(here)
    if last == 0:
        return [*points, *_split(here, end)]
    enter = replace(_on_the_way(start, end, length - last), comment="begin of the joint moves")
    return [*points, *_split(here, enter), replace(end, linear=False)]


def _on_the_way(start: Waypoint, end: Waypoint, way: float) -> Waypoint:
    """The point so far [m] behind the start of a straight piece."""
    share = way / abs(end.standoff - start.standoff)
    return replace(
        end,
        standoff=start.standoff + share * (end.standoff - start.standoff),
        psi=start.psi + share * (end.psi - start.psi),
    )


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
