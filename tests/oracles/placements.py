"""A part that stands off where it was modelled: the hole that it carries, and whether its motion still runs."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from zerorev.model.hole import Hole
from zerorev.motion.evaluation import evaluate
from zerorev.verify.arm import posture_of
from zerorev.verify.measure import reversals
from zerorev.verify.path import Track, blend, follow


def rotation(vector):
    """The rotation by a rotation vector [rad], by Rodrigues' formula."""
    angle = float(np.linalg.norm(vector))
    x, y, z = np.asarray(vector) / angle if angle > 0 else (0.0, 0.0, 1.0)
    K = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + np.sin(angle) * K + (1 - np.cos(angle)) * K @ K


def moved_hole(hole, T_base_part, error):
    """The hole under a placement error: shift [m] and rotation vector [rad] along the axes of the part frame."""
    origin, axes = T_base_part[:3, 3], T_base_part[:3, :3]
    R = rotation(axes @ error[3:])
    target = origin + axes @ error[:3] + R @ (hole.target - origin)
    direction, psi_zero = R @ hole.direction, R @ hole.psi_zero
    return Hole(hole.id, target, direction, hole.depth, psi_zero)


def random_error(rng, within, *, outermost):
    """An error within a tolerance: anywhere, or in a corner of the shift with the greatest turn."""
    shift, axis = rng.uniform(-1, 1, 3), rng.normal(size=3)
    axis /= np.linalg.norm(axis)
    if outermost:
        return np.concatenate([np.sign(shift) * within.position, axis * within.rotation])
    return np.concatenate([shift * within.position, axis * within.rotation * rng.uniform() ** (1 / 3)])


def faults(robot, tool, settings, T_base_part, hole_plan, error):
    """What is wrong with a plan's motion under an error, by the evaluation and on samples of its blended corner."""
    hole, motion = moved_hole(hole_plan.hole, T_base_part, error), hole_plan.motion
    near = replace(settings, near_joints=tuple((motion.joints[0] + motion.joints[-1]) / 2))
    found = evaluate(robot, tool, hole, motion.profile, motion.branch, near)
    if found.score is None:
        return [finding.kind for finding in found.findings]
    wrong = ["reversal"] * found.score.reversals
    if (found.score.limit_distance < 0).any() or np.abs(found.motion.joints - motion.joints).max() > np.pi:
        wrong.append("limit")
    if settings.blend > 0:
        curve = blend(motion.profile, motion.profile.corner, settings.blend, 2000)
        posture = posture_of(robot.arm, motion.joints[0])
        joints = follow(robot, tool, hole, curve, posture, motion.joints[motion.profile.corner])
        ways = np.sign(motion.joints[-1] - motion.joints[0])
        turned = reversals(Track(curve, joints))
        ends = np.sign(joints[-1] - joints[0])
        if not np.isfinite(joints).all() or any(turned) or (ends != ways).any():
            wrong.append("blend")
    return wrong
