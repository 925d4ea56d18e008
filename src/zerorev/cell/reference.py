"""What a controller makes of a program: stand-off and spin over time, and the joints that follow from them.

Controllers blend a corner with a parabola, ramp the feed up and down, and smooth what is left. Smoothed are stand-off
and spin, not joints, so that the tip stays on the axis. A feed at which a joint, a drive or the turning tool would be
too fast is slowed, as a controller does; the speed that is reached is part of the answer.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from zerorev.cell.followed import STEP, Followed, dynamics_of
from zerorev.errors import InputError
from zerorev.kernels.arm import angles_along
from zerorev.model._arrays import Array
from zerorev.model.dynamics import nominal_drives
from zerorev.motion.drilling import Drilling
from zerorev.program.neutral import HoleProgram

__all__ = ["Manner", "Track", "followed", "track_of"]

ORIENTATION_SPEED = float(np.deg2rad(200.0))  # [rad/s] $VEL.ORI
EFFORT = 0.8  # share of the greatest torque that a motion may ask for
MOST_SLOWINGS = 12
FITS = 1.002
LONGEST = 300.0  # [s] of a motion: of more nodes than that there is no room for


@dataclass(frozen=True)
class Manner:
    """How a controller runs a program.

    Attributes:
        acceleration: of the tip along its path [m/s^2].
        smoothing: width of each of two moving averages [s].
        corner: radius of the blend at the corner [m]; None: as programmed.
        feed: of both legs [m/s]; None: as programmed.
    """

    acceleration: float = 2.0
    smoothing: float = 30e-3
    corner: float | None = None
    feed: float | None = None


@dataclass(frozen=True)
class Track:
    """A program's points in the twist plane, n of them.

    Attributes:
        points: stand-off [m] and spin [rad], shape (n, 2).
        feed: of the moves between them [m/s], shape (n - 1,).
        blend: radii at the points [m], shape (n,); 0 at the first and the last.
        wait: for which the tool stands at the points [s], shape (n,).
        start: joints at the first point, with turns [rad], shape (6,).
    """

    points: Array
    feed: Array
    blend: Array
    wait: Array
    start: Array


def track_of(program: HoleProgram, manner: Manner) -> Track:
    """The points of a hole's moves, with feeds and blends as the controller is asked for them.

    Args:
        program: of the hole.
        manner: may ask for another feed, or another blend at the corner.
    """
    first, moves = program.start, program.moves
    points = np.array([(first.standoff, first.psi), *((move.standoff, move.psi) for move in moves)])
    feed = np.array([move.feed if manner.feed is None else manner.feed for move in moves])
    blend = np.array([0.0, *(move.blend for move in moves)])
    blend[-1] = 0.0
    if manner.corner is not None:
        length = np.abs(np.diff(points[:, 0]))
        corner = program.corner + 1
        blend[corner] = min(manner.corner, length[corner - 1] / 2, length[corner] / 2)
    return Track(points, feed, blend, np.array([0.0, *(move.wait for move in moves)]), first.joints)


def followed(drilling: Drilling, branch: int, track: Track, manner: Manner) -> Followed:
    """The reference of a track, slowed until the arm can run it.

    Args:
        drilling: of a robot with dynamics.
        branch: 0..7.
        track: of the program.
        manner: of the controller.

    Raises:
        InputError: the robot has no dynamics; the track leaves the reach of the branch, or takes too long.
    """
    masses = dynamics_of(drilling.robot)
    drives = nominal_drives(masses.payload)
    slowed = 1.0
    for _ in range(MOST_SLOWINGS):
        found = _at_feed(drilling, branch, replace(track, feed=track.feed * slowed), manner, slowed)
        spin = np.abs(np.gradient(found.psi, STEP)).max() / ORIENTATION_SPEED
        ratio = max(spin, float((np.abs(found.qd) / drilling.robot.limits.speed).max()))
        if masses.effort_limit is not None:
            asked = np.abs(found.loaded[0] + drives.inertia * found.qdd) + drives.coulomb
            ratio = max(ratio, float((asked / (EFFORT * masses.effort_limit)).max()))
        if ratio <= FITS:
            break
        slowed /= ratio
    return found


def _at_feed(drilling: Drilling, branch: int, track: Track, manner: Manner, slowed: float) -> Followed:
    lasts = float((np.abs(np.diff(track.points[:, 0])) / track.feed).sum() + track.wait.sum())
    if lasts > LONGEST:
        raise InputError(
            f"the motion takes {lasts:,.0f} s at this feed",
            where=f"hole {drilling.hole.id}",
            accepted=f"a greater feed: at most {LONGEST:g} s are simulated",
        )
    standoff, psi = _over_time(track, manner).T
    q = np.empty((standoff.size, 6))
    angles_along(
        drilling.robot.arm, drilling.plane, np.ascontiguousarray(standoff), np.ascontiguousarray(psi), branch, q
    )
    if np.isnan(q).any():
        raise InputError("the motion leaves the reach of its branch", where=f"hole {drilling.hole.id}")
    q = np.unwrap(q, axis=0)
    q += 2 * np.pi * np.round((track.start - q[0]) / (2 * np.pi))
    qd = np.gradient(q, STEP, axis=0)
    return Followed(drilling, standoff, psi, q, qd, np.gradient(qd, STEP, axis=0), slowed)


def _over_time(track: Track, manner: Manner) -> Array:
    """Stand-off and spin at nodes, shape (N, 2): blended, ramped up and down, smoothed."""
    pieces = _pieces(track)
    ends = np.cumsum([piece[0] for piece in pieces])
    whole, first, last = float(ends[-1]), float(track.feed[0]), float(track.feed[-1])
    up, down = min(first / manner.acceleration, whole), min(last / manner.acceleration, whole)
    lasting = whole + (up + down) / 2
    t = np.arange(0.0, lasting + STEP, STEP)
    # the feed grows and shrinks evenly: so does the time along the path
    along = t - up / 2
    along = np.where(t < up, t**2 / (2 * up), along)
    left = np.maximum(lasting - t, 0.0)
    along = np.minimum(along, np.where(left < down, whole - left**2 / (2 * down), along))
    along = np.clip(along, 0.0, whole)
    piece = np.minimum(np.searchsorted(ends, along), len(pieces) - 1)
    begun = np.concatenate([[0.0], ends[:-1]])
    path = np.empty((t.size, 2))
    for k, (duration, a, c, b, rate, gain) in enumerate(pieces):
        own = piece == k
        since = along[own] - begun[k]
        u = np.minimum(rate * since + 0.5 * gain * since**2, 1.0)[:, None] if duration > 0 else np.ones((own.sum(), 1))
        path[own] = (1 - u) ** 2 * a + 2 * u * (1 - u) * c + u**2 * b
    width = max(round(manner.smoothing / STEP), 0)
    for _ in range(2 if width > 1 else 0):
        before, after = np.tile(path[:1], (width, 1)), np.tile(path[-1:], (width, 1))
        summed = np.cumsum(np.concatenate([before, path, after]), axis=0)
        path = (summed[width:] - summed[:-width]) / width
    return path


def _pieces(track: Track) -> Sequence[tuple[float, Array, Array, Array, float, float]]:
    """Straight moves and parabolas between them: duration [s], the three points, and how the parameter grows."""
    points, found = track.points, []
    at = points[0]
    for k, (target, speed) in enumerate(zip(points[1:], track.feed, strict=True), start=1):
        radius = track.blend[k]
        length = abs(target[0] - points[k - 1][0])
        enter = target + (points[k - 1] - target) * (radius / length)
        run = abs(enter[0] - at[0])
        if run > 0:
            found.append((run / speed, at, (at + enter) / 2, enter, speed / run, 0.0))
        at = enter
        if track.wait[k] > 0:
            found.append((float(track.wait[k]), at, at, at, 1 / float(track.wait[k]), 0.0))
        if radius > 0:
            after, away = points[k + 1], track.feed[k]
            leave = target + (after - target) * (radius / abs(after[0] - target[0]))
            duration = 4 * radius / (speed + away)
            begin, end = speed / (2 * radius), away / (2 * radius)
            found.append((duration, enter, target, leave, begin, (end - begin) / duration))
            at = leave
    return found
