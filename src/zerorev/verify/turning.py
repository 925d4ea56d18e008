"""Where the joints of a motion turn round, and how slow they get: from rates, not from steps between samples.

The rates are the check's own (`verify.lever`). Each segment of the profile is sampled; where a joint is slowest between
its neighbours the interval is narrowed until its minimum is found, so that a joint that turns round and back between
two samples is seen, too; a change of sign is then located.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from zerorev.model._arrays import Array
from zerorev.model.hole import Hole
from zerorev.model.plan import Event, LegName
from zerorev.model.profile import Profile
from zerorev.model.robot import Robot
from zerorev.model.tool import Tool
from zerorev.verify.arm import posture_of
from zerorev.verify.lever import line_rates
from zerorev.verify.path import Path, follow

__all__ = ["Course", "Turning", "turning"]

STEPS_PER_LEG, LEAST_STEPS = 500, 24  # of each segment, its share of the leg
POINTS = 33  # of an interval that is narrowed
NARROWINGS, LOCATIONS = 3, 8  # each to a sixteenth, each to a thirty-second


class Course:
    """A motion as a function of segment and fraction of it.

    Attributes:
        profile: n breakpoints.
        segment: of each regular sample, shape (N,).
        fraction: of that segment, 0 to 1, both ends among them, shape (N,).
    """

    def __init__(self, robot: Robot, tool: Tool, hole: Hole, profile: Profile, start: Array) -> None:
        """Begin at joints.

        Args:
            robot: the arm.
            tool: the drill.
            hole: the drill axis.
            profile: spin along the path.
            start: joints at the first breakpoint [rad], shape (6,): their posture and turns are the motion's.
        """
        self.robot, self.tool, self.hole, self.profile, self._start = robot, tool, hole, profile, start
        self._posture = posture_of(robot.arm, start)
        self._steps = np.diff([profile.standoff, profile.psi])
        lengths = np.abs(self._steps[0])
        before = np.arange(lengths.size) < profile.corner
        leg = np.where(before, lengths[before].sum(), lengths[~before].sum())
        counts = np.maximum(LEAST_STEPS, np.ceil(STEPS_PER_LEG * lengths / leg - 1e-9)).astype(int) + 1
        self.segment = np.repeat(np.arange(lengths.size), counts)
        self.fraction = np.concatenate([np.linspace(0.0, 1.0, count) for count in counts])
        self._along = np.sign(self._steps[0])

    def joints(self, segment: npt.NDArray[np.intp], fraction: Array) -> Array:
        """Joints in order of motion [rad], shape (N, 6), turns as at the start; NaN out of reach or singular."""
        standoff, psi = self._place(segment, fraction)
        path = Path(standoff, psi, (), 0)
        return follow(self.robot, self.tool, self.hole, path, self._posture, self._start)

    def rates(self, segment: npt.NDArray[np.intp], fraction: Array) -> Array:
        """D theta / d path along the motion [rad/m], shape (N, 6), in any order."""
        along, slope = self._along[segment], self.profile.twist_rate[segment]
        joints = self.joints(segment, fraction)
        return line_rates(self.robot, self.tool, self.hole, joints, along, along * slope)

    def distance(self, segment: npt.NDArray[np.intp], fraction: Array) -> Array:
        """Path distance from the start of the motion [m]."""
        knots = self.profile.distance
        return np.asarray(knots[segment] + fraction * np.diff(knots)[segment])

    def _place(self, segment: npt.NDArray[np.intp], fraction: Array) -> tuple[Array, Array]:
        standoff, psi = self.profile.standoff[segment], self.profile.psi[segment]
        return standoff + fraction * self._steps[0, segment], psi + fraction * self._steps[1, segment]


class Turning(NamedTuple):
    """What the rates of a motion say.

    Attributes:
        events: reversals in order of motion.
        places: path distance of each [m], shape (M,).
        slowest: least |rate| of each joint [rad/m], shape (6,): 0 where it turns round within a segment.
    """

    events: tuple[Event, ...]
    places: Array
    slowest: Array


def turning(course: Course) -> Turning:
    """Reversals and slowest motion of the joints."""
    k, x, r = _sampled(course)
    speed, nil = np.abs(r), course.robot.nil_rate
    slowest = np.fmin.reduce(speed, axis=0)
    found = [
        (joint, a, b) for joint in range(6) for a, b in _changes(np.where(speed[:, joint] > nil, r[:, joint], 0.0))
    ]
    if not found:
        return Turning((), np.empty(0), slowest)
    joint, a, b = np.array(found).T
    segment = k[b]
    # the first sample of a segment turns at the breakpoint itself, any other since the joint last moved
    at_knot = k[b - 1] != segment
    low = np.where(at_knot, x[b], np.where(k[a] == segment, x[a], 0.0))
    place = _located(course, segment, joint, low, x[b], np.sign(r[b, joint]))
    slowest[joint[~at_knot]] = 0.0
    profile, corner = course.profile, course.profile.corner
    distance = course.distance(segment, place)
    events = []
    for i in range(len(found)):
        leg: LegName = "plunge" if segment[i] < corner else "retract"
        begin, end = profile.standoff[segment[i] : segment[i] + 2]
        where: LegName = "target" if at_knot[i] and segment[i] == corner else leg
        events.append(Event(int(joint[i]) + 1, where, float(begin + place[i] * (end - begin))))
    order = sorted(range(len(events)), key=lambda i: (distance[i], events[i].joint))
    return Turning(tuple(events[i] for i in order), distance[order], slowest)


def _sampled(course: Course) -> tuple[npt.NDArray[np.intp], Array, Array]:
    """Segments, fractions and rates in order of motion, closer where a joint is slowest."""
    k, x = course.segment, course.fraction
    r = course.rates(k, x)
    dips, joint = np.nonzero(_dips(k, r) & (np.abs(r) > course.robot.nil_rate))
    if not dips.size:
        return k, x, r
    before = np.where(k[np.maximum(dips - 1, 0)] == k[dips], np.maximum(dips - 1, 0), dips)
    after = np.minimum(dips + 1, k.size - 1)
    after = np.where(k[after] == k[dips], after, dips)
    low, high, rows = x[before], x[after], np.arange(dips.size)
    found = [(k, x, r)]
    for _ in range(NARROWINGS):
        points = np.linspace(low, high, POINTS, axis=1)
        on = np.repeat(k[dips], POINTS)
        closer = course.rates(on, points.ravel())
        found.append((on, points.ravel(), closer))
        least = np.nan_to_num(np.abs(closer.reshape(-1, POINTS, 6)[rows, :, joint]), nan=np.inf).argmin(axis=1)
        low, high = points[rows, np.maximum(least - 1, 0)], points[rows, np.minimum(least + 1, POINTS - 1)]
    k, x, r = (np.concatenate(parts) for parts in zip(*found, strict=True))
    order = np.lexsort((x, k))
    return k[order], x[order], r[order]


def _dips(k: npt.NDArray[np.intp], r: Array) -> npt.NDArray[np.bool_]:
    """Where a joint is no faster than at both neighbours of the same segment, and has their direction."""
    speed, sign = np.abs(r), np.sign(r)
    before, after = np.full((2, *r.shape), np.inf)
    same = (k[1:] == k[:-1])[:, None]
    # beyond a change of sign there is nothing to narrow down: the minimum is 0, and is located
    np.copyto(before[1:], np.where(sign[1:] == sign[:-1], speed[:-1], -1.0), where=same)
    np.copyto(after[:-1], np.where(sign[1:] == sign[:-1], speed[1:], -1.0), where=same)
    return np.asarray((speed <= before) & (speed <= after))


def _changes(r: Array) -> list[tuple[int, int]]:
    """Pairs of samples between which a rate changes its sign; where it is 0 or NaN it has none."""
    moving = np.flatnonzero(np.nan_to_num(r))
    turned = np.flatnonzero(np.sign(r[moving[1:]]) != np.sign(r[moving[:-1]]))
    return [(int(moving[i]), int(moving[i + 1])) for i in turned]


def _located(
    course: Course, segment: npt.NDArray[np.intp], joint: npt.NDArray[np.intp], low: Array, high: Array, sign: Array
) -> Array:
    """Where rates first have the signs that they have at `high`, as a fraction of the segment."""
    rows = np.arange(joint.size)
    for _ in range(LOCATIONS if (low < high).any() else 0):
        points = np.linspace(low, high, POINTS, axis=1)
        rates = course.rates(np.repeat(segment, POINTS), points.ravel()).reshape(-1, POINTS, 6)[rows, :, joint]
        first = np.maximum((np.sign(rates) == sign[:, None]).argmax(axis=1), 1)
        low, high = points[rows, first - 1], points[rows, first]
    return (low + high) / 2
