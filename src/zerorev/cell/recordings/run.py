"""A recording cut to its drilling motion: its tip along and across the drill axis, over path distance (fig. 33)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from zerorev.cell.recordings.alignment import Alignment, aligned
from zerorev.cell.recordings.tip import PlannedHole, Tip, tip_of
from zerorev.errors import InputError
from zerorev.model._arrays import Array
from zerorev.model.finding import Finding
from zerorev.model.recording import LEAST_SAMPLES, Recording

__all__ = ["Axis", "DrillingRun", "across", "drilling_run"]

OFF_AXIS = 2e-3  # [m] no arm that follows its command is so far off its line
OFF_LINE = 1e-4  # [m] a commanded tip that is farther off the line of its motion is not drilling yet
OFF_TURN = 2e-3  # [m] beside the blend
OFF_DIRECTION = np.radians(2.0)
MOVES = 0.01  # of the feed: below it the tip rests
LEAST_STROKE = 1e-4  # [m]
UPRIGHT = np.sin(np.radians(5.0))


@dataclass(frozen=True)
class Axis:
    """The line of a drilling motion.

    Attributes:
        point: on it [m], the target where a plan gives it, shape (3,).
        direction: unit, into the material, shape (3,).
        stroke: [m].
        commanded: whether it is what was commanded; else it fits what was measured.
    """

    point: Array
    direction: Array
    stroke: float
    commanded: bool


@dataclass(frozen=True)
class DrillingRun:
    """One drilling motion: there and back along an axis.

    Attributes:
        recording: of which it is a part.
        alignment: where the program begins in it.
        rows: samples of the motion, what rests at both ends left out.
        axis: of the motion.
        feed: of the tip, the median where it moves [m/s].
        path: path distance of the samples, 0 at the turn, never falling [m], shape (n,).
        lateral: measured tip across the axis, horizontal and vertical part [m], shape (n, 2).
        tip: measured [m], shape (n, 3).
        findings: of the tip, and of the rate.
    """

    recording: Recording
    alignment: Alignment
    rows: slice
    axis: Axis
    feed: float
    path: Array
    lateral: Array
    tip: Array
    findings: tuple[Finding, ...]


def drilling_run(recording: Recording, planned: PlannedHole | None = None) -> DrillingRun:
    """The drilling motion in a recording.

    Args:
        recording: of one run.
        planned: the hole that is drilled; None: the axis is that of the recorded tip.

    Raises:
        InputError: nothing moves, the tip is not known, or it is not on the planned hole's axis.
    """
    alignment, tip = aligned(recording), tip_of(recording, planned)
    steady = tip.led if tip.commanded is not None else _smoothed(tip.measured, _width(len(tip.measured)))
    rest = max(alignment.sample - 1, 0)  # where the first step of the motion begins
    if planned is not None:
        axis = Axis(planned.drilling.hole.target, planned.drilling.hole.direction, planned.drilling.hole.depth, True)
        begin, end = _on_axis(recording, tip, steady, axis, planned)
    else:
        axis = _line(recording, steady[rest:], tip.commanded is not None)
        begin, end = rest, len(steady)
    rows, feed = _moving(recording, steady, max(begin, rest), end)
    depth = (steady[rows] - axis.point) @ axis.direction
    return DrillingRun(
        recording, alignment, rows, axis, feed, _path(depth, exact=tip.commanded is not None),
        across(tip.measured[rows] - axis.point, axis.direction), tip.measured[rows], tip.findings,
    )  # fmt: skip


def across(vectors: Array, direction: Array) -> Array:
    """Parts across a direction, shape (n, 2): the horizontal one, to the left along it, and the upward one.

    For a direction within 5 deg of the vertical they are along the base's X and Y, made perpendicular to it.
    """
    up = np.array([0.0, 0.0, 1.0])
    left = np.cross(up, direction)
    if np.linalg.norm(left) < UPRIGHT:
        left = np.array([1.0, 0.0, 0.0]) - direction[0] * direction
    left /= np.linalg.norm(left)
    return np.stack([vectors @ left, vectors @ np.cross(direction, left)], axis=-1)


def _on_axis(recording: Recording, tip: Tip, steady: Array, axis: Axis, planned: PlannedHole) -> tuple[int, int]:
    """The samples about the turn in which the tip is on the planned axis, within the lead-in.

    Raises:
        InputError: another hole, robot or tool: there are none, or the turn is not at the target.
    """
    apart = steady - axis.point
    depth = apart @ axis.direction
    off = np.linalg.norm(apart - depth[:, None] * axis.direction, axis=1)
    aslant = np.zeros(len(off))
    if tip.pointing is not None:
        aslant = np.arccos(np.clip(tip.pointing @ axis.direction, -1.0, 1.0))
    near = (off < OFF_AXIS) & (depth > -axis.stroke - planned.lead_in - OFF_TURN)
    good = near & (aslant < OFF_DIRECTION)
    where = f"{recording.source}, hole {planned.drilling.hole.id}"
    accepted = "the recording of this plan's hole, robot and tool"
    if not good.any():
        aside = near.any() and not good.any()
        what = (
            f"the drill points {np.degrees(aslant[near].min()):.1f} deg or more off the plan's axis"
            if aside
            else f"the tip stays {off.min() * 1e3:.1f} mm or more off the plan's axis"
        )
        raise InputError(f"the recorded motion is not the plan's: {what}", where=where, accepted=accepted)
    turn = int(np.argmax(np.where(good, depth, -np.inf)))
    short = planned.motion.profile.standoff.min() * -1.0 - depth[turn]
    if not -OFF_TURN <= short <= planned.blend + OFF_TURN:
        beyond = f"{abs(short) * 1e3:.1f} mm {'before' if short > 0 else 'beyond'}"
        raise InputError(
            f"the recorded motion is not the plan's: on its axis it turns {beyond} the target",
            where=where,
            accepted=accepted,
        )
    begin, end = _about(good, turn)
    # what moves to the hole and away from it crosses the axis, too: only as long as it stays on one line
    sideways = apart - depth[:, None] * axis.direction
    middle = np.median(sideways[begin:end], axis=0)
    room = OFF_LINE if tip.commanded is not None else 4 * OFF_LINE
    return _about(good & (np.linalg.norm(sideways - middle, axis=1) < room), turn)


def _about(good: npt.NDArray[np.bool_], at: int) -> tuple[int, int]:
    """The range of samples about one that are all good."""
    gaps = np.flatnonzero(~good)
    n = int(np.searchsorted(gaps, at))
    return (int(gaps[n - 1]) + 1 if n else 0), max(int(gaps[n]) if n < gaps.size else len(good), at + 1)


def _line(recording: Recording, points: Array, commanded: bool) -> Axis:
    """The line that fits a there and back best; its point is the turn.

    Raises:
        InputError: nothing moves, or not along one line.
    """
    away = np.linalg.norm(points - points[0], axis=1)
    turn = int(np.argmax(away))
    stroke = float(away[turn])
    if stroke < LEAST_STROKE:
        raise InputError(
            f"the tip moves by {stroke * 1e3:.3f} mm", where=recording.source, accepted="the recording of a motion"
        )
    centre = points.mean(axis=0)
    direction = np.linalg.svd((points - centre).T @ (points - centre))[2][0]
    if direction @ (points[turn] - points[0]) < 0:
        direction = -direction
    depth = (points - centre) @ direction
    off = np.linalg.norm(points - centre - depth[:, None] * direction, axis=1).max()
    if off > OFF_AXIS:
        raise InputError(
            f"the tip leaves the line of its motion by {off * 1e3:.1f} mm", where=recording.source,
            accepted="the recording of one straight drilling motion, or --plan, which says where its axis is",
        )  # fmt: skip
    return Axis(centre + depth[turn] * direction, direction, stroke, commanded)


def _moving(recording: Recording, steady: Array, begin: int, end: int) -> tuple[slice, float]:
    """The samples between the rests at both ends, and the feed [m/s]: the median where the tip is not much slower.

    Raises:
        InputError: nothing moves.
    """
    if end - begin < LEAST_SAMPLES:
        raise InputError(f"{end - begin} samples of the motion", where=recording.source,
                         accepted=f"{LEAST_SAMPLES} or more")  # fmt: skip
    speed = np.linalg.norm(np.diff(steady[begin:end], axis=0), axis=1) / np.diff(recording.time[begin:end])
    fast = speed > 0.5 * np.quantile(speed, 0.99)
    feed = float(np.median(speed[fast])) if fast.any() else 0.0
    moves = np.flatnonzero(speed >= MOVES * feed)
    if feed <= 0 or moves[-1] - moves[0] + 2 < LEAST_SAMPLES:
        raise InputError("the tip does not move", where=recording.source, accepted="the recording of a motion")
    return slice(begin + int(moves[0]), begin + int(moves[-1]) + 2), feed


def _path(depth: Array, *, exact: bool) -> Array:
    """Path distance [m], 0 at the greatest depth: what was run along the axis, noise of a measured tip left out."""
    turn = int(np.argmax(depth))
    if not exact:  # each leg runs one way: what goes back is noise
        depth = np.concatenate([np.maximum.accumulate(depth[: turn + 1]), np.maximum.accumulate(depth[:turn:-1])[::-1]])
    run = np.concatenate([[0.0], np.cumsum(np.abs(np.diff(depth)))])
    return np.asarray(run - run[turn])


def _width(samples: int) -> int:
    """An odd number of samples to smooth a measured tip over: a fiftieth of the recording."""
    return max(5, samples // 50 | 1)


def _smoothed(points: Array, width: int) -> Array:
    """A moving mean over samples, shorter at the ends so that it stays centred."""
    count = len(points)
    total = np.concatenate([np.zeros((1, points.shape[1])), np.cumsum(points - points[0], axis=0)])
    at = np.arange(count)
    half = np.minimum(np.minimum(at, count - 1 - at), width // 2)
    smooth: Array = (total[at + half + 1] - total[at - half]) / (2 * half + 1)[:, None] + points[0]
    return smooth
