"""What a motion is judged by beside its reversals: the figure of each criterion, and their weighted sum.

`measure` computes the figures of an evaluated motion, in SI; a criterion (`zerorev.model.measures`) turns its figure
into a cost that is about 0 for the best and about 1 for a poor motion, so that weights mean the same for all of them.
Reversals and the motion threshold are not weighed against any of this: they come first (theory §3.1). The thesis weighs
them by 6/7 against 1/7 (eq. 4.7), which comes to the same, and `thesis_objective` is that sum.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from zerorev.model._arrays import Array
from zerorev.model.job import Settings
from zerorev.model.measures import CRITERIA, Criterion, Measures, V
from zerorev.model.plan import Score
from zerorev.model.robot import Robot
from zerorev.motion.drilling import Drilling
from zerorev.motion.evaluation import Evaluation, steady_rates
from zerorev.motion.joint_path import joints_along, sample_distances
from zerorev.motion.kinematics import jacobian
from zerorev.motion.loads import lost_motion

__all__ = [
    "AT_POSES",
    "Poses",
    "Reversals",
    "WeighedCriteria",
    "compliance",
    "from_singular",
    "manipulability",
    "measure",
    "objective_of",
    "thesis_objective",
    "worst",
]

SAMPLES = 400  # poses of a motion at which the criteria of a pose are computed


@dataclass(frozen=True)
class Poses:
    """The arm at many points, of one motion or of many.

    Attributes:
        drilling: robot, tool and hole.
        settings: for the stiffness of the joints.
        joints: controller angles [rad], shape (..., 6).
    """

    drilling: Drilling
    settings: Settings
    joints: Array

    @cached_property
    def compliance(self) -> tuple[Array, Array]:
        """Give of the tip along and across the drill axis [m/N], each (...,); NaN where no stiffness is known."""
        stiffness, direction = self.settings.joint_stiffness, self.drilling.hole.direction
        if stiffness is None:
            unknown = np.full(self.joints.shape[:-1], np.nan)
            return unknown, unknown
        return compliance(jacobian(self.drilling.robot, self.drilling.tool, self.joints), stiffness, direction)


AT_POSES: dict[str, Callable[[Poses], Array]] = {
    "compliance_axial": lambda poses: poses.compliance[0],
    "compliance_lateral": lambda poses: poses.compliance[1],
    "manipulability": lambda poses: manipulability(poses.drilling.robot, poses.joints),
}
"""The criteria of a pose, whose figure of a motion is that of its worst pose: figures [SI], shape (...,)."""


def worst(poses: Poses, names: Iterable[str] = tuple(AT_POSES)) -> dict[str, Array]:
    """Of criteria of a pose the worst figure over the last axis of the poses, each (...,).

    Args:
        poses: of motions, or of legs.
        names: of the criteria.
    """
    figures = {name: AT_POSES[name](poses) for name in names}
    return {
        name: each.min(axis=-1) if CRITERIA[name].more_is_better else each.max(axis=-1)
        for name, each in figures.items()
    }


@dataclass(frozen=True)
class WeighedCriteria:
    """A weighted sum of criteria.

    Attributes:
        terms: weight and criterion, each.
    """

    terms: tuple[tuple[float, Criterion], ...]

    def __call__(self, motion: Measures[V]) -> V:
        """Cost of the motion, or of each of many."""
        (weight, criterion), *others = self.terms
        cost = weight * criterion(motion)
        for weight, criterion in others:
            cost = cost + weight * criterion(motion)
        return cost


def objective_of(settings: Settings) -> WeighedCriteria:
    """What the settings ask to be least: the weighted sum, or the one criterion that the objective names."""
    weights = settings.weights or ((settings.objective, 1.0),)
    return WeighedCriteria(tuple((weight, CRITERIA[name]) for name, weight in weights))


def measure(drilling: Drilling, evaluation: Evaluation, settings: Settings) -> Measures[float]:
    """What the criteria measure of a motion that can be run, on its legs.

    Args:
        drilling: robot, tool and hole.
        evaluation: of the motion, with a score.
        settings: for the rule of the motion threshold, the feed of the plunge and the stiffness of the joints.
    """
    motion, score = evaluation.motion, evaluation.score
    assert motion is not None
    assert score is not None
    profile, limits, steady = motion.profile, drilling.robot.limits, steady_rates(score, settings)
    # where the tool spins on at the corner it turns at a speed between those of the two legs, not by the feed
    plunge, drilled = profile.corner, profile.corner - profile.just_before_corner(settings.creep)
    lost = lost_motion(drilling, profile, motion.branch, settings.thrust)
    points = profile.at(sample_distances(profile, SAMPLES))
    poses = Poses(drilling, settings, joints_along(drilling, motion.branch, *points))
    return Measures(
        travel=score.travel,
        margin=float(steady.min()) if steady.size else 0.0,
        plunge_rotation=float(np.abs(np.diff(profile.psi)[:plunge]).sum()),
        tool_speed_change=float(np.abs(profile.twist_rate[:drilled]).max() * settings.feed_plunge),
        limit_distance=float((2 * score.limit_distance / (limits.upper - limits.lower)).min()),
        lost_motion=np.nan if lost is None else lost,
        **{name: float(figure) for name, figure in worst(poses).items()},
    )


def compliance(J: Array, stiffness: tuple[float, ...] | None, direction: Array) -> tuple[Array, Array]:
    """Give of the tip to a force along the drill axis, and across it the way it gives most [m/N], each (...,).

    Links and drill are taken as rigid: C = J diag(1/k) J^T, its part for places (thesis sec. 5.4.2: the main
    compliance of a robot is its joints').

    Args:
        J: Jacobians at the TCP, shape (..., 6, 6).
        stiffness: of the joints [N m/rad], shape (6,); None: unknown, and the answer is NaN.
        direction: unit vector along the drill axis, shape (3,).
    """
    if stiffness is None:
        return np.full(J.shape[:-2], np.nan), np.full(J.shape[:-2], np.nan)
    # the drill axis, and two directions across it
    frame = np.linalg.svd(direction[None])[2]
    A = frame @ J[..., :3, :] / np.sqrt(stiffness)
    C = A @ np.swapaxes(A, -1, -2)
    mean, half = (C[..., 1, 1] + C[..., 2, 2]) / 2, (C[..., 1, 1] - C[..., 2, 2]) / 2
    return C[..., 0, 0], mean + np.hypot(half, C[..., 1, 2])


def manipulability(robot: Robot, joints: Array) -> Array:
    """Yoshikawa's manipulability |det J| without a unit [1], shape (...,).

    At every point of the tool the determinant is the product of both links and the sine between them, the distance of
    the wrist centre from axis 1 as seen along axis 2, and the sine of joint 5. Divided by both links and the greatest
    such distance it lies between 0 (singular) and 1.

    Args:
        robot: the arm.
        joints: controller angles [rad], shape (..., 6).
    """
    return np.asarray(from_singular(robot, joints).prod(axis=-1))


def from_singular(robot: Robot, joints: Array) -> Array:
    """How far the shoulder, the elbow and the wrist are from singular [1], shape (..., 3): each 0 to 1.

    They are the factors of `manipulability`: the share of its greatest reach at which the wrist centre lies from axis 1
    as seen along axis 2, the sine between upper arm and forearm, and the sine of joint 5.

    Args:
        robot: the arm.
        joints: controller angles [rad], shape (..., 6).
    """
    arm = robot.arm
    _, q2, q3, _, q5, _ = np.moveaxis(joints * np.array(arm.sign) - np.array(arm.offset), -1, 0)
    forearm = np.hypot(arm.a2, arm.c3)
    elbow = (arm.c3 * np.sin(q3) + arm.a2 * np.cos(q3)) / forearm
    ahead = arm.a1 + arm.c2 * np.sin(q2) + arm.a2 * np.cos(q2 + q3) + arm.c3 * np.sin(q2 + q3)
    return np.asarray(np.abs(np.stack([ahead / (abs(arm.a1) + arm.c2 + forearm), elbow, np.sin(q5)], axis=-1)))


@dataclass(frozen=True)
class Reversals:
    """Weighted share of the joints' reversals: N_rev / 6 where all weigh the same (eq. 4.7, first term)."""

    weights: tuple[float, ...] = (1.0,) * 6

    def __call__(self, score: Score) -> float:
        """Cost of the motion."""
        return float(np.dot(self.weights, score.reversals_per_joint)) / float(sum(self.weights))


def thesis_objective(evaluation: Evaluation) -> float:
    """Thesis eq. 4.7: 6/7 of the weight on reversals, 1/7 on travel, +1 for each of fault, jump and limit."""
    score = evaluation.score
    if score is None:
        return float(len({finding.kind for finding in evaluation.findings}))
    return 6 / 7 * Reversals()(score) + 1 / 7 * score.travel / CRITERIA["travel"].scale
