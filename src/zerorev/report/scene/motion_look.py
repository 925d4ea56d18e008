"""What is shown of one motion: its reversals and where they lie, travel and margins; or why the robot cannot run it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from zerorev.files.units import deg, deg_per_mm, mm
from zerorev.model._arrays import Array
from zerorev.model.job import Settings
from zerorev.model.plan import Event, Motion, Score
from zerorev.model.profile import Profile
from zerorev.model.robot import JointLimits, Robot
from zerorev.motion.drilling import Drilling
from zerorev.motion.evaluation import Evaluation, evaluated, event_distance, meets_threshold, steady_rates
from zerorev.motion.joint_path import JUMP, JointPath, joint_path
from zerorev.report.words.as_shown import turning_names

__all__ = ["Curves", "Fault", "Look", "Mark", "curves", "held", "look", "signed_distance"]


@dataclass(frozen=True)
class Mark:
    """A reversal and its place on the twist map.

    Attributes:
        joint: 1 to 6.
        name: of the joint, as its maker calls it.
        distance: path distance from the corner [m], negative on the plunge leg.
        psi: spin there [rad].
        leg: `plunge`, `target` or `retract`.
    """

    joint: int
    name: str
    distance: float
    psi: float
    leg: str


@dataclass(frozen=True)
class Fault:
    """A stretch of the motion that cannot be run.

    Attributes:
        kind: `unreachable`, `jump` or `limit`.
        joint: 1 to 6 where it is one joint's limit, or None.
        start: path distance from the corner [m], negative on the plunge leg.
        end: where it ends [m]; the same where it is one point.
    """

    kind: str
    joint: int | None
    start: float
    end: float


@dataclass(frozen=True)
class Look:
    """One motion as a page shows it.

    Attributes:
        runs: whether the robot can run it.
        why: one sentence: what is wrong where it does not run, or what a user should see to; empty where all is well.
        faults: where it does not run.
        score: what it does to the joints, or None where it does not run.
        marks: its reversals, in order of motion.
        margin: least rate of the joints that do not reverse [rad/m], by the settings' rule; None where there is none.
        meets_threshold: whether the margin is as the settings ask.
        motion: with its joints, or None where it does not run.
    """

    runs: bool
    why: str
    faults: tuple[Fault, ...]
    score: Score | None
    marks: tuple[Mark, ...]
    margin: float | None
    meets_threshold: bool
    motion: Motion | None = None

    @property
    def reversals(self) -> int | None:
        """Count of direction changes over all joints, or None where it does not run."""
        return None if self.score is None else self.score.reversals


@dataclass(frozen=True)
class Curves:
    """Six joint curves along a motion, and along the same hole drilled with constant spin.

    Attributes:
        distance: path distance from the corner [m], negative on the plunge leg, shape (N,).
        joints: controller angles with turns [rad], shape (N, 6); NaN where out of reach.
        baseline: the same at the spin of the start, or None where that cannot be run.
        limits: of the robot.
        names: of the joints that turn.
    """

    distance: Array
    joints: Array
    baseline: Array | None
    limits: JointLimits
    names: tuple[str, ...]


def look(drilling: Drilling, profile: Profile, branch: int, settings: Settings) -> Look:
    """Look at one motion; a few milliseconds.

    Args:
        drilling: robot, tool and hole.
        profile: the spin along the path.
        branch: 0..7.
        settings: turns, and the motion threshold.
    """
    found = evaluated(drilling, profile, branch, settings)
    score = found.score
    if score is None:
        path = joint_path(drilling, profile, branch, near=settings.near_joints)
        faults = tuple(_faults(drilling.limits, profile, path))
        return Look(False, _why(drilling.robot, profile, path, found, branch), faults, None, (), None, False)
    marks = tuple(_mark(drilling.robot, profile, event) for event in score.events)
    steady = steady_rates(score, settings)
    meets = meets_threshold(score, settings)
    margin = float(steady.min()) if steady.size else None
    return Look(
        True, "" if meets else _too_slow(drilling.robot, score, settings), (), score, marks, margin, meets, found.motion
    )


def curves(drilling: Drilling, profile: Profile, branch: int, settings: Settings, samples: int = 200) -> Curves:
    """The six joint curves of a motion, drawn even where it cannot be run.

    Args:
        drilling: robot, tool and hole.
        profile: the spin along the path.
        branch: 0..7.
        settings: whose `near_joints` chooses the turns.
        samples: how many points, about.
    """
    robot, near = drilling.robot, settings.near_joints
    path = joint_path(drilling, profile, branch, near=near, samples=samples)
    still = joint_path(drilling, held(profile), branch, near=near, samples=samples)
    return Curves(
        signed_distance(profile, path.distance), path.joints, still.joints if still.runs else None, robot.limits,
        turning_names(robot),
    )  # fmt: skip


def held(profile: Profile) -> Profile:
    """The same path at the constant spin of its start: the baseline."""
    return replace(profile, psi=np.full_like(profile.psi, profile.psi[0]))


def signed_distance(profile: Profile, distance: Array) -> Array:
    """Path distance from the corner [m], negative on the plunge leg, of path distances from the start [m]."""
    return np.asarray(distance - profile.distance[profile.corner])


def _mark(robot: Robot, profile: Profile, event: Event) -> Mark:
    along = np.asarray(profile.distance[profile.corner] if event.leg == "target" else event_distance(profile, event))
    _, psi = profile.at(along)
    away = float(signed_distance(profile, along))
    return Mark(event.joint, robot.joint_names[event.joint - 1], away, float(psi), event.leg)


def _faults(limits: JointLimits, profile: Profile, path: JointPath) -> Iterator[Fault]:
    """Where along the motion the robot cannot follow: the stretches out of reach; else the jumps; else the limits."""
    distance = signed_distance(profile, path.distance)
    lost = np.isnan(path.joints[:, 0])
    if lost.any():
        yield from (Fault("unreachable", None, *stretch) for stretch in _stretches(distance, lost))
        return
    jumps = np.flatnonzero(np.abs(np.diff(path.joints, axis=0)).max(axis=1) > JUMP)
    yield from (Fault("jump", None, float(distance[n]), float(distance[n + 1])) for n in jumps)
    for i in (joint - 1 for joint in path.over_limit):
        angle = path.joints[:, i]
        beyond = (angle < limits.lower[i]) | (angle > limits.upper[i])
        yield from (Fault("limit", i + 1, *stretch) for stretch in _stretches(distance, beyond))


def _stretches(distance: Array, bad: np.ndarray) -> Iterator[tuple[float, float]]:
    """First and last place [m] of each run of bad samples, shapes (N,)."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], bad, [False]]).astype(np.int8)))
    for first, after in edges.reshape(-1, 2):
        yield float(distance[first]), float(distance[after - 1])


def _why(robot: Robot, profile: Profile, path: JointPath, found: Evaluation, branch: int) -> str:
    if path.fault is None and path.jump is None:
        return "; ".join(f"{each.message}, with every turn" for each in found.findings)
    if path.fault is not None:
        n = int(np.flatnonzero(np.isnan(path.joints[:, 0]))[0])
        return f"branch {branch} is out of reach {_place(profile, path, n)}"
    steps = np.abs(np.diff(path.joints, axis=0))
    n = int(np.flatnonzero(steps.max(axis=1) > JUMP)[0])
    name = robot.joint_names[int(steps[n].argmax())]
    return (
        f"{name} jumps by {deg(steps[n].max()):.0f} deg {_place(profile, path, n)}, at a singularity of branch {branch}"
    )


def _place(profile: Profile, path: JointPath, n: int) -> str:
    away = float(signed_distance(profile, path.distance[n]))
    leg = "at the target" if away == 0 else f"on the {'plunge' if away < 0 else 'retract'}"
    return f"{leg} at {mm(path.standoff[n]):.1f} mm of stand-off, {deg(path.psi[n]):.1f} deg of spin"


def _too_slow(robot: Robot, score: Score, settings: Settings) -> str:
    """Which joints that do not reverse are slower than the motion threshold."""
    rates = score.min_rate if settings.min_rate_rule == "pointwise" else score.mean_rate
    steady = np.array(score.reversals_per_joint) == 0
    slow = [robot.joint_names[i] for i in np.flatnonzero(steady & (rates < settings.min_rate))]
    least = float(steady_rates(score, settings).min())
    nearly = "stands still" if least <= robot.nil_rate else f"moves by only {deg_per_mm(least):.2g} deg/mm"
    return f"{', '.join(slow)} {nearly}; the motion threshold is {deg_per_mm(settings.min_rate):.2g} deg/mm"
