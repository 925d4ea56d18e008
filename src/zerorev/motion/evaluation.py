"""What a motion does to the joints: reversals as located events, travel, slowest motion, distance to limits."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from zerorev.kernels.layout import TwistPlane
from zerorev.kernels.motion import follow, turning_points
from zerorev.model._arrays import Array
from zerorev.model.finding import Finding, FindingKind
from zerorev.model.hole import Hole
from zerorev.model.job import Settings
from zerorev.model.plan import Event, LegName, Motion, Score
from zerorev.model.profile import Profile
from zerorev.model.resized import resized_profile
from zerorev.model.robot import Robot
from zerorev.model.tool import Tool
from zerorev.motion.drilling import Drilling
from zerorev.motion.joint_path import JUMP, SAMPLES, JointPath, choose_turns, joint_path

__all__ = ["Evaluation", "evaluate", "evaluated", "event_distance", "meets_threshold", "steady_rates"]

FEW_TURNS = 32  # reversals for which there is room at first


@dataclass(frozen=True)
class Evaluation:
    """A motion examined: its joints and score where it can be run, and what is wrong where it cannot.

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
    return evaluated(Drilling(robot, tool, hole, settings.limit_margin if settings else 0.0), profile, branch, settings)


def evaluated(drilling: Drilling, profile: Profile, branch: int, settings: Settings | None = None) -> Evaluation:
    """`evaluate` of a hole whose twist plane is known."""
    robot, plane, near = drilling.robot, drilling.plane, settings.near_joints if settings else None
    events, min_rate = _turning_points(robot, plane, profile, branch)
    # travel and extents are taken through the very points where a joint turns
    turns = np.array([(segment, place) for segment, place, _ in events if place > 0.0]).reshape(-1, 2)
    joints, low, high, moved = np.empty((profile.psi.size, 6)), np.empty(6), np.empty(6), np.empty((2, 6))
    runs = follow(
        robot.arm, plane, branch, profile.standoff, profile.psi, profile.corner, SAMPLES, turns, JUMP,
        joints, low, high, moved,
    )  # fmt: skip
    full_turns, over = choose_turns(low, high, drilling.limits, near) if runs else (np.zeros(6), ())
    if over or not runs:
        path = joint_path(drilling, profile, branch, near=near)
        if path.runs:
            segments = turns[:, 0].astype(int)
            through = profile.distance[segments] + turns[:, 1] * np.abs(np.diff(profile.standoff))[segments]
            path = joint_path(drilling, profile, branch, near=near, through=through.tolist())
        return Evaluation(None, None, _faults(drilling, branch, path))
    legs = profile.leg_lengths
    limits = robot.limits
    score = Score(
        reversals_per_joint=tuple(sum(event.joint == i + 1 for _, _, event in events) for i in range(6)),
        events=tuple(event for _, _, event in events),
        travel=float(moved.sum()),
        min_rate=min_rate,
        mean_rate=(moved / legs[:, None]).min(axis=0),
        limit_distance=np.minimum(low + full_turns - limits.lower, limits.upper - high - full_turns),
    )
    return Evaluation(Motion(profile, branch, joints + full_turns), score, ())


def steady_rates(score: Score, settings: Settings) -> Array:
    """Rates of the joints that do not reverse, by the rule of the motion threshold [rad/m], shape (n,) (theory §5)."""
    rates = score.min_rate if settings.min_rate_rule == "pointwise" else score.mean_rate
    return np.asarray(rates[np.array(score.reversals_per_joint) == 0])


def meets_threshold(score: Score, settings: Settings) -> bool:
    """Whether every joint that does not reverse keeps the motion threshold, by the settings' rule (theory §5)."""
    # the search keeps the threshold to the last bits of its own sampling, so do not ask for more here
    return bool((steady_rates(score, settings) >= settings.min_rate * (1 - 1e-6)).all())


def _faults(drilling: Drilling, branch: int, path: JointPath) -> tuple[Finding, ...]:
    found: list[tuple[FindingKind, str]] = []
    if path.fault is not None:
        found.append(("unreachable", f"branch {branch} cannot reach {path.fault * 1e3:.2f} mm of stand-off"))
    if path.jump is not None:
        found.append(("jump", f"branch {branch} jumps at {path.jump * 1e3:.2f} mm of stand-off"))
    for i in (joint - 1 for joint in path.over_limit):
        low, high = np.rad2deg([path.joints[:, i].min(), path.joints[:, i].max()])
        allowed = np.rad2deg([drilling.limits.lower[i], drilling.limits.upper[i]])
        name = drilling.robot.joint_names[i]
        message = f"{name} runs from {low:.2f} to {high:.2f} deg, allowed are {allowed[0]:g} to {allowed[1]:g} deg"
        if drilling.limit_margin:
            message += f", {np.rad2deg(drilling.limit_margin):g} deg within its limits"
        found.append(("limit", message))
    return tuple(Finding("error", kind, message, drilling.hole.id) for kind, message in found)


def event_distance(profile: Profile, event: Event) -> float:
    """Path distance [m] of an event."""
    out = event.standoff - profile.standoff[profile.corner]
    return float(profile.distance[profile.corner] + (out if event.leg == "retract" else -out))


def _turning_points(
    robot: Robot, plane: TwistPlane, profile: Profile, branch: int
) -> tuple[list[tuple[int, float, Event]], Array]:
    """Reversals in order with their segments and fractions, and the least |rate| of each joint [rad/m], shape (6,)."""
    slowest, room = np.empty(6), FEW_TURNS
    while True:
        turns = np.empty((room, 3))
        count = turning_points(
            robot.arm, plane, branch, profile.standoff, profile.psi, profile.corner, robot.nil_rate, slowest, turns
        )  # fmt: skip
        if count <= room:
            break
        room = count
    found = []
    for joint, at, place in sorted(turns[:count].tolist(), key=lambda turn: (turn[1] + turn[2], turn[0])):
        segment = int(at)
        start, end = profile.standoff[segment : segment + 2]
        leg: LegName = "plunge" if segment < profile.corner else "retract"
        where: LegName = "target" if place == 0.0 and segment == profile.corner else leg
        found.append((segment, place, Event(int(joint), where, float(start + place * (end - start)))))
        if place > 0.0:  # to turn round within a segment a joint has to stop
            slowest[int(joint) - 1] = 0.0
    return found, slowest
