"""The points of a hole's own moves and their feeds, from the approach to the retract: of plan and program alike."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import pairwise

from zerorev.model.plan import Corner, Motion
from zerorev.model.settings import Settings
from zerorev.program.waypoints import Waypoint, waypoints, with_blends
from zerorev.program.ways import Way

__all__ = ["feed_of", "moves_of", "points_of"]


def points_of(settings: Settings, motion: Motion, corner: Corner | None, way: Way) -> tuple[tuple[Waypoint, ...], int]:
    """The points of a hole's own moves, and the index of the corner among them.

    Args:
        settings: of the hole.
        motion: of the hole.
        corner: how it turns round; None: as a file of before it was said.
        way: to the motion and away from it.
    """
    last = settings.breakthrough_length if settings.breakthrough_feed is not None else 0.0
    reach, spin = (corner.reach, corner.spin_moves or 0) if corner else (0.0, 0)
    points, at = waypoints(motion.profile, way.lead_in.length, reach, last, spin)
    points = with_blends(points, at, settings, stop=corner is not None and corner.kind == "stop")
    if way.approach.length > 0:
        ahead = replace(points[0], standoff=points[0].standoff + way.approach.length)
        points, at = (ahead, replace(points[0], leg="approach"), *points[1:]), at + 1
    if way.retract.length > 0:
        out = points[-1].standoff + way.retract.length
        points = (*points, Waypoint(out, points[-1].psi, "depart", "retracted"))
    return points, at


def feed_of(settings: Settings, corner: Corner | None, before: Waypoint, point: Waypoint) -> float:
    """Of the move from one point to the next [m/s]; where the tool spins on the dwell gives it.

    Args:
        settings: with the feeds.
        corner: how the motion turns round.
        before: where the move begins.
        point: where it ends.
    """
    if point.leg == "spin" and corner is not None and corner.dwell and corner.spin_moves:
        return (before.standoff - point.standoff) * corner.spin_moves / corner.dwell
    inwards = point.leg in ("lead-in", "plunge")
    return settings.feed_inwards(max(before.standoff, point.standoff)) if inwards else settings.feed_retract


def moves_of(
    settings: Settings, motion: Motion, corner: Corner | None, way: Way
) -> Iterator[tuple[Waypoint, Waypoint, float]]:
    """The moves: where each begins and ends, and its feed [m/s].

    Args:
        settings: see `points_of`.
        motion: likewise.
        corner: likewise.
        way: likewise.
    """
    for before, point in pairwise(points_of(settings, motion, corner, way)[0]):
        yield before, point, feed_of(settings, corner, before, point)
