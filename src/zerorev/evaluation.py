"""What a motion does to the joints: reversals as located events, travel, slowest motion, distance to limits."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from zerorev.model._arrays import Array
from zerorev.model.hole import Hole
from zerorev.model.job import Settings
from zerorev.model.plan import Event, Finding, LegName, Motion, Score
from zerorev.model.profile import Profile
from zerorev.model.resized import resized_profile
from zerorev.model.robot import Robot
from zerorev.model.tool import Tool
from zerorev.motion import JointPath, joint_path, outward_rates

__all__ = ["Evaluation", "evaluate", "event_distance", "meets_threshold", "steady_rates"]

SAMPLES_PER_LEG, SAMPLES_PER_SEGMENT = 200, 32  # at least
CLOSER_LOOK = 33  # points between the neighbours of a sample where a joint comes nearest to rest
CLOSER_LOOKS = 3  # each 16 times closer: a joint that turns round and back within 1/800,000 of a leg is seen
ROOT_LOOKS = 9  # each 32 times closer, from a sample's distance to the last bits


@dataclass(frozen=True)
class Evaluation:
    """A motion looked at: its joints and score where it can be run, and what is wrong where it cannot.

    Attributes:
        motion: the joints at the breakpoints, or None.
        score: or None.
        findings: fault, jump, limit.
    """

    motion: Motion | None
    score: Score | None
    findings: tuple[Finding, ...]

    def resized(self, factor: float) -> Evaluation:
        """The evaluation of the same motion at another size (`model.resized`); of one that can be run.

        Args:
            factor: of the lengths; a power of two changes no digit.
        """
        assert self.motion is not None
        assert self.score is not None
        score = self.score
        return replace(
            self,
            motion=replace(self.motion, profile=resized_profile(self.motion.profile, factor)),
            score=replace(
                score,
                events=tuple(replace(event, standoff=event.standoff * factor) for event in score.events),
                min_rate=score.min_rate / factor,
                mean_rate=score.mean_rate / factor,
            ),
        )


def evaluate(
    robot: Robot, tool: Tool, hole: Hole, profile: Profile, branch: int, settings: Settings | None = None
) -> Evaluation:
    """Evaluate one motion on one branch.

    Args:
        robot: the arm.
        tool: the drill.
        hole: what is drilled.
        profile: the spin along the path.
        branch: 0..7.
        settings: whose `near_joints` chooses the turns.
    """
    near = settings.near_joints if settings else None
    path = joint_path(robot, tool, hole, profile, branch, near=near)
    if not path.runs:
        return Evaluation(None, None, _faults(robot, hole, branch, path))
    events, min_rate = _turning_points(robot, tool, hole, profile, branch)
    # travel and extents are taken through the very points where a joint turns
    turns = [event_distance(profile, event) for event in events if event.leg != "target"]
    if turns:
        path = joint_path(robot, tool, hole, profile, branch, near=near, through=turns)
        if not path.runs:
            return Evaluation(None, None, _faults(robot, hole, branch, path))
    variation = _variation(profile, path)
    legs = np.abs(np.diff(profile.distance[[0, profile.corner, -1]]))
    counts = tuple(sum(event.joint == i + 1 for event in events) for i in range(6))
    limits = robot.limits
    score = Score(
        reversals_per_joint=counts,
        events=events,
        travel=float(variation.sum()),
        min_rate=min_rate,
        mean_rate=(variation / legs[:, None]).min(axis=0),
        limit_distance=np.minimum(path.joints - limits.lower, limits.upper - path.joints).min(axis=0),
    )
    return Evaluation(path.at_breakpoints(profile, branch), score, ())


def steady_rates(score: Score, settings: Settings) -> Array:
    """Rates of the joints that do not reverse, by the rule of the motion threshold [rad/m], shape (n,) (theory §5)."""
    rates = score.min_rate if settings.min_rate_rule == "pointwise" else score.mean_rate
    return np.asarray(rates[np.array(score.reversals_per_joint) == 0])


def meets_threshold(score: Score, settings: Settings) -> bool:
    """Whether every joint that does not reverse keeps the motion threshold, by the settings' rule (theory §5)."""
    # the search keeps the threshold to the last bits of its own sampling, so do not ask for more here
    return bool((steady_rates(score, settings) >= settings.min_rate * (1 - 1e-6)).all())


def _faults(robot: Robot, hole: Hole, branch: int, path: JointPath) -> tuple[Finding, ...]:
    found = []
    if path.fault is not None:
        found.append(("unreachable", f"branch {branch} cannot reach {path.fault * 1e3:.2f} mm of stand-off"))
    if path.jump is not None:
        found.append(("jump", f"branch {branch} jumps at {path.jump * 1e3:.2f} mm of stand-off"))
    for i in (joint - 1 for joint in path.over_limit):
        low, high = np.rad2deg([path.joints[:, i].min(), path.joints[:, i].max()])
        allowed = np.rad2deg([robot.limits.lower[i], robot.limits.upper[i]])
        name = robot.joint_names[i]
        found.append(
            ("limit", f"{name} runs from {low:.2f} to {high:.2f} deg, allowed are {allowed[0]:g} to {allowed[1]:g} deg")
        )
    return tuple(Finding("error", kind, message, hole.id) for kind, message in found)


def event_distance(profile: Profile, event: Event) -> float:
    """Path distance [m] of an event."""
    out = event.standoff - profile.standoff[profile.corner]
    return float(profile.distance[profile.corner] + (out if event.leg == "retract" else -out))


def _variation(profile: Profile, path: JointPath) -> Array:
    """Angle moved by each joint on each leg [rad], shape (2, 6)."""
    corner = np.searchsorted(path.distance, profile.distance[profile.corner] - 1e-12)
    steps = np.abs(np.diff(path.joints, axis=0))
    return np.array([steps[:corner].sum(axis=0), steps[corner:].sum(axis=0)])


def _turning_points(
    robot: Robot, tool: Tool, hole: Hole, profile: Profile, branch: int
) -> tuple[tuple[Event, ...], Array]:
    """Reversals as events in order of motion, and the least |rate| of each joint [rad/m], shape (6,).

    Each segment of the profile is sampled; where a joint comes nearest to rest between two samples it is looked at
    again, closely, so that a joint that turns round and back between two samples is not missed; a change of sign is
    then located by bisection.
    """
    twist_rate, steps = profile.twist_rate, np.diff([profile.standoff, profile.psi])
    along = np.where(np.arange(twist_rate.size) < profile.corner, -1.0, 1.0)

    def rates(k: npt.NDArray[np.int64], x: Array) -> Array:
        """Rates along the motion at fractions x of segments k."""
        standoff, psi = profile.standoff[k] + x * steps[0, k], profile.psi[k] + x * steps[1, k]
        return along[k, None] * outward_rates(robot, tool, hole, branch, standoff, psi, twist_rate[k])

    plunge, retract = profile.standoff[[0, -1]] - profile.standoff[profile.corner]
    share = np.abs(steps[0]) / np.where(along < 0, plunge, retract)
    samples = np.maximum(np.ceil(SAMPLES_PER_LEG * share).astype(int), SAMPLES_PER_SEGMENT)
    k = np.repeat(np.arange(along.size), samples)
    x = (np.arange(k.size) - (np.cumsum(samples) - samples)[k]) / (samples[k] - 1)
    r = rates(k, x)
    for _ in range(CLOSER_LOOKS):
        near_k, near_x = _closer_looks(k, x, np.abs(r), robot.nil_rate)
        if not near_k.size:
            break
        k, x, r = np.append(k, near_k), np.append(x, near_x), np.concatenate([r, rates(near_k, near_x)])
        # the ends of a closer look are known already
        _, order = np.unique(2.0 * k + x, return_index=True)
        k, x, r = k[order], x[order], r[order]
    events: list[tuple[float, Event]] = []
    for i in range(6):
        # NaN, a path that touches a singularity, tells no direction either
        signs = np.where(np.abs(r[:, i]) > robot.nil_rate, np.sign(r[:, i]), 0.0)
        moving = np.flatnonzero(signs)
        for turned in np.flatnonzero(signs[moving[:-1]] * signs[moving[1:]] < 0).tolist():
            last, n = int(moving[turned]), int(moving[turned + 1])
            segment = int(k[n])
            # a segment's first sample turns at the breakpoint itself, any other since the joint last moved
            at_first = n == 0 or k[n - 1] != segment
            low = x[last] if k[last] == segment else 0.0
            place = 0.0 if at_first else _root(lambda y, i=i, on=k[n : n + 1]: rates(on, y)[:, i], low, x[n])
            start, end = profile.standoff[segment : segment + 2]
            leg: LegName = "plunge" if segment < profile.corner else "retract"
            where: LegName = "target" if at_first and segment == profile.corner else leg
            events.append((segment + place, Event(i + 1, where, float(start + place * (end - start)))))
    events.sort(key=lambda entry: (entry[0], entry[1].joint))
    return tuple(event for _, event in events), np.fmin(np.inf, np.fmin.reduce(np.abs(r), axis=0))


def _closer_looks(k: npt.NDArray[np.int64], x: Array, speed: Array, nil: float) -> tuple[npt.NDArray[np.int64], Array]:
    """More samples x of segments k where a joint is slowest; speed of the samples in order, shape (N, 6)."""
    joined = (k[1:] == k[:-1])[:, None]
    before, after = np.full((2, *speed.shape), np.inf)
    np.copyto(before[1:], speed[:-1], where=joined)
    np.copyto(after[:-1], speed[1:], where=joined)
    # neither a joint that stands still nor one of constant speed dips, whatever their last digits do
    rise = np.fmax(before, after) - speed
    dips = (speed <= before) & (speed <= after) & (speed > nil) & (rise > 1e-6 * speed)
    found = np.flatnonzero(dips.any(axis=1))
    low, high = np.maximum(found - 1, 0), np.minimum(found + 1, x.size - 1)
    low, high = np.where(k[low] == k[found], low, found), np.where(k[high] == k[found], high, found)
    return np.tile(k[found], CLOSER_LOOK), np.linspace(x[low], x[high], CLOSER_LOOK).ravel()


def _root(rate, low: float, high: float) -> float:  # type: ignore[no-untyped-def]
    """Where a rate first has the sign that it has at `high`, of many points at once: a call costs more than a point."""
    sign = np.sign(rate(np.array([high]))[0])
    for _ in range(ROOT_LOOKS):
        points = np.linspace(low, high, CLOSER_LOOK)
        first = max(int(np.argmax(np.sign(rate(points)) == sign)), 1)
        low, high = float(points[first - 1]), float(points[first])
    return (low + high) / 2
