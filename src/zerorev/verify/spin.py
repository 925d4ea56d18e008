"""Does the tool spin on at the corner as asked: as long as stated, by as much as the two legs let it, creeping in."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from zerorev.model.hole import Hole
from zerorev.model.plan import HolePlan, Motion
from zerorev.model.robot import Robot
from zerorev.model.settings import Settings
from zerorev.model.tool import Tool
from zerorev.verify.arm import skeleton

__all__ = ["spins_as_asked"]

TURN = 1e-7  # [rad]: a plan file may have rounded its angles a little
TIME = 1e-6  # relative
PLACE = 1e-9  # [m] for an arm of size 1
POINTS = 17  # of a joint move


def spins_as_asked(robot: Robot, tool: Tool, settings: Settings, hole_plan: HolePlan, motion: Motion) -> Iterator[str]:
    """What is stated of the spin must be that of the motion, and that be right for the time.

    Args:
        robot: the arm.
        tool: the drill.
        settings: those of the hole, which ask for a spin.
        hole_plan: with what it states of its corner.
        motion: of the hole.
    """
    corner, profile = hole_plan.corner, motion.profile
    if corner is None or corner.kind != "spin" or not corner.spin_moves or corner.dwell is None or corner.spin is None:
        yield "the tool is to spin on at the corner, and the plan does not say by how much and for how long"
        return
    last = profile.corner
    first = last - corner.spin_moves
    if first < 1:
        yield f"the tool spins on in {corner.spin_moves} joint moves, and {last} breakpoints lie before the corner"
        return
    if not 0 < corner.dwell <= settings.cycle.dwell * (1 + TIME):
        yield f"the tool spins on for {corner.dwell:g} s, asked are {settings.cycle.dwell:g} s"
        return
    standoff, psi = profile.standoff[first : last + 1], profile.psi[first : last + 1]
    creep = settings.creep_in(corner.dwell)
    share = np.arange(corner.spin_moves + 1) / corner.spin_moves
    place = PLACE * robot.size
    if np.abs(standoff - standoff[-1] - creep * (1 - share)).max() > place:
        yield f"the tool does not creep in by {creep * 1e6:.4g} um, evenly, while it spins on"
    turned = float(psi[-1] - psi[0])
    if np.abs(psi - psi[0] - turned * share).max() > TURN or abs(turned - corner.spin) > TURN:
        yield f"the tool spins on by {np.rad2deg(turned):.6g} deg, the plan says {np.rad2deg(corner.spin):.6g} deg"
    wanted = _right_for(settings, profile.twist_rate[[first - 1, last]].tolist(), creep, corner.dwell)
    if abs(wanted - turned) > TURN + 2 * TIME * abs(wanted):
        yield (
            f"the tool spins on by {np.rad2deg(turned):.6g} deg, right for {corner.dwell:g} s on these legs is "
            f"{np.rad2deg(wanted):.6g} deg"
        )
    along = _leaves(robot, tool, hole_plan.hole, motion, first)
    if along > settings.corner_tolerance:
        yield f"the tip leaves its place along the axis by {along * 1e6:.4g} um while the tool spins on"


def _right_for(settings: Settings, slopes: list[float], creep: float, time: float) -> float:
    """By how much the tool spins on [rad]: with the mix of the two velocities in which the tip goes in by the creep."""
    feeds = settings.feed_inwards(0.0), settings.feed_retract
    # shares of the velocities: a feed_0 - b feed_1 = creep / time, a + b = 1
    a, b = np.linalg.solve([[feeds[0], -feeds[1]], [1.0, 1.0]], [creep / time, 1.0])
    return float(time * (b * feeds[1] * slopes[1] - a * feeds[0] * slopes[0]))


def _leaves(robot: Robot, tool: Tool, hole: Hole, motion: Motion, first: int) -> float:
    """How far the tip leaves its place along the axis on the joint moves to the corner, at most [m]."""
    profile, share, greatest = motion.profile, np.linspace(0.0, 1.0, POINTS), 0.0
    for k in range(first, profile.corner):
        joints = motion.joints[k] + share[:, None] * (motion.joints[k + 1] - motion.joints[k])
        body = skeleton(robot.arm, joints)
        tip = body.flange + np.einsum("ijn,j->in", body.R_base_flange, tool.T_flange_tcp[:3, 3])
        found = (hole.target[:, None] - tip).T @ hole.direction
        wanted = profile.standoff[k] + share * (profile.standoff[k + 1] - profile.standoff[k])
        greatest = max(greatest, float(np.abs(found - wanted).max()))
    return greatest
