"""A corner made of two joint moves, once more from the model alone: how far the tool leaves the drill axis on them."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from zerorev.model._arrays import Array
from zerorev.model.hole import Hole
from zerorev.model.plan import Motion
from zerorev.model.robot import Robot
from zerorev.model.tool import Tool
from zerorev.verify.arm import posture_of, skeleton
from zerorev.verify.lever import line_rates
from zerorev.verify.path import Path, follow

__all__ = ["CornerFigures", "corner_figures", "triangle_figures"]

NIL_STEP = 1e-12  # [rad] a difference of angles that may be their rounding
ACROSS, OUTWARDS = 65, 33  # places on the side opposite to the corner, and from the corner to each of them


class CornerFigures(NamedTuple):
    """What two joint moves do that replace the corner of a motion; NaN where they are out of reach.

    Attributes:
        joints: controller angles with turns at entry, corner and exit [rad], and before the corner where each move on
            which the tool spins on begins, shape (n, 6).
        off_axis: greatest distance of the tip from the drill axis [m], of any blend of the two moves.
        tilt: greatest angle of the tool against the drill axis [rad], of any blend of the two moves.
        keeps: for each joint whether it goes the same way on both moves as on the leg from which, or into which, they
            lead; where it does not move it may go either way.
    """

    joints: Array
    off_axis: float
    tilt: float
    keeps: tuple[bool, ...]


def corner_figures(robot: Robot, tool: Tool, hole: Hole, motion: Motion, reach: float, spin: int = 0) -> CornerFigures:
    """What the joint moves of a motion's corner do.

    A move that is linear in the joints keeps the direction of each of them, so that its two ends tell it.

    Args:
        robot: the arm.
        tool: the drill.
        hole: the drill axis.
        motion: whose corner.
        reach: stand-off above the corner at which the joint moves begin and end [m], within the two segments that meet
            there.
        spin: on how many moves the tool spins on, just before the corner.
    """
    profile, k = motion.profile, motion.profile.corner
    slopes, ways = profile.twist_rate[k - spin - 1 : k + 1], np.array([-1.0] * (spin + 1) + [1.0])
    knots = slice(k - spin, k + 1)
    standoff = np.array([reach + profile.standoff[k - spin], *profile.standoff[knots], profile.standoff[k] + reach])
    enter, leave = profile.psi[k - spin] + slopes[0] * reach, profile.psi[k] + slopes[-1] * reach
    psi = np.array([enter, *profile.psi[knots], leave])
    stated = motion.joints[k]
    joints = follow(robot, tool, hole, Path(standoff, psi, (), 1 + spin), posture_of(robot.arm, stated), stated)
    # each move is held to how the leg goes at its end that is farther from the corner
    ends = np.ascontiguousarray(joints[[*range(spin + 1), spin + 2]])
    rates = line_rates(robot, tool, hole, ends, ways, ways * slopes)
    moved, nil = np.diff(joints, axis=0), NIL_STEP + robot.nil_rate * reach
    against = ((np.abs(moved) > nil) & (np.abs(rates) > robot.nil_rate) & (moved * rates < 0)) | ~np.isfinite(rates)
    keeps = tuple(not any(column) for column in against.T.tolist())
    each = [triangle_figures(robot, tool, hole, joints[n : n + 3]) for n in range(spin + 1)]
    off_axis, tilt = (max(values) for values in zip(*each, strict=True))
    return CornerFigures(joints, off_axis, tilt, keeps)


def triangle_figures(robot: Robot, tool: Tool, hole: Hole, joints: Array) -> tuple[float, float]:
    """How far the tool leaves the drill axis between three joint vectors: of any blend of the moves between them.

    Args:
        robot: the arm.
        tool: the drill.
        hole: the drill axis.
        joints: at entry, corner and exit [rad], shape (3, 6).

    Returns:
        Greatest distance of the tip from the axis [m], greatest angle of the tool against it [rad].
    """
    entry, corner, leave = joints
    across, outwards = np.linspace(0.0, 1.0, ACROSS)[:, None], np.linspace(0.0, 1.0, OUTWARDS)[:, None, None]
    opposite = entry + across * (leave - entry)
    body = skeleton(robot.arm, (corner + outwards * (opposite - corner)).reshape(-1, 6))
    T = tool.T_flange_tcp
    tip = body.flange + np.einsum("ijn,j->in", body.R_base_flange, T[:3, 3])
    beside = tip - hole.target[:, None]
    beside -= hole.direction[:, None] * (hole.direction @ beside)
    chord = np.einsum("ijn,j->in", body.R_base_flange, T[:3, 2]) + hole.direction[:, None]
    half_sine = np.minimum(np.linalg.norm(chord, axis=0).max() / 2, 1.0)
    return float(np.linalg.norm(beside, axis=0).max()), 2 * float(np.arcsin(half_sine))
