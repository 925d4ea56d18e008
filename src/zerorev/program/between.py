"""The moves from hole to hole: all axes at once, from where one hole is left to where the next one is approached.

A move that would dip behind the surface rises over it along the drill axes of both holes, further than the safe height
of the job where it must; a safe height of 0 forbids it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from zerorev.collision.moves import EXACT, Nearest, nearest
from zerorev.collision.near import Nearest as Met
from zerorev.collision.shapes import Capsules, capsules_of
from zerorev.kernels.tour import move_time
from zerorev.model._arrays import Array
from zerorev.model.finding import Finding
from zerorev.model.job import Settings
from zerorev.model.plan import Transition
from zerorev.model.robot import JointLimits, Robot
from zerorev.model.tool import Tool
from zerorev.program.clear_moves import Around
from zerorev.program.ways import Stop

__all__ = ["HOME", "LONG_TURN", "THROUGH", "accelerations", "moves_between", "time_of_moves"]

RAMP = 0.3  # [s] within which an axis reaches its greatest speed, where the robot's file does not say: a guess
LONG_TURN = float(np.deg2rad(90.0))  # of one axis
THROUGH = 1e-3  # [m] a tool that dips this far behind the surface has not just touched it
SLACK = 2 * EXACT
RISES = (5e-3, 10e-3, 20e-3, 50e-3, 100e-3, 200e-3, 400e-3)  # [m] tried one after the other, for an arm of size 1
HOME = "the home position"


@dataclass(frozen=True)
class _Leg:
    """A move between two stops; None is the home position."""

    one: Stop | None
    other: Stop | None
    home: Array

    @property
    def joints(self) -> Array:
        """Where it begins, stops between, and ends [rad], shape (n, 6)."""
        one, other = self.one, self.other
        if one is not None and other is not None and one.shares_hole(other):
            one, other = one.rising(None), other.rising(None)  # from one stroke of a hole to the next
        departure = self.home if one is None else one.departure
        arrival = self.home if other is None else other.way.arrival
        return np.concatenate([departure, arrival])

    @property
    def planes(self) -> Array:
        """The surface at both ends, shape (2, 4); of a move from or to the home position, that of the hole, twice."""
        planes = [stop.plane for stop in (self.one, self.other) if stop is not None]
        return np.array([planes[0], planes[-1]])

    @property
    def hole(self) -> str | None:
        """The hole that a finding names: the one it leads to, or the last one."""
        stop = self.other or self.one
        return None if stop is None else stop.hole.id

    @property
    def name(self) -> str:
        """How a message calls it."""
        start, to = (HOME if stop is None else stop.hole.id for stop in (self.one, self.other))
        return f"from {start} to {to}"

    def rising(self, height: float) -> _Leg:
        """The same through points at a height over the surface [m]."""
        one, other = (None if stop is None else stop.rising(height) for stop in (self.one, self.other))
        return replace(self, one=one, other=other)


@dataclass(frozen=True)
class _Part:
    """What the arm must not touch."""

    robot: Robot
    capsules: Capsules
    thickness: float | None

    @property
    def lines(self) -> Capsules:
        """The bodies without the thickness that is guessed: no guess leads a move another way, or stops a program."""
        return replace(self.capsules, radius=0 * self.capsules.radius)

    def nearest(self, legs: Sequence[_Leg], bodies: Capsules) -> list[Nearest]:
        """Where each move comes nearest."""
        if not legs:
            return []
        paths = [leg.joints for leg in legs]
        moves = np.concatenate([np.stack([path[:-1], path[1:]], axis=1) for path in paths])
        counts = [len(path) - 1 for path in paths]
        planes = np.repeat(np.array([leg.planes for leg in legs]), counts, axis=0)
        found = nearest(self.robot, bodies, moves, planes, self.thickness)
        ends = np.cumsum([0, *counts]).tolist()
        return [min(found[a:b], key=lambda each: each.clearance) for a, b in pairwise(ends)]

    def behind(self, joints: Array, planes: Array) -> bool:
        """Whether a posture [rad], shape (1, 6), lies behind the surface at a hole, shape (2, 4)."""
        standing = np.repeat(joints[None], 2, axis=1)
        return nearest(self.robot, self.lines, standing, planes[None], self.thickness)[0].clearance < -THROUGH


def accelerations(limits: JointLimits) -> Array:
    """Greatest accelerations of the joints [rad/s^2], shape (6,): as the robot's file has them, or guessed."""
    return np.asarray(limits.speed / RAMP) if limits.acceleration is None else limits.acceleration


def time_of_moves(robot: Robot, joints: Array) -> float:
    """Time of moves of all axes at once through some points, with a stop at each [s].

    Args:
        robot: the arm.
        joints: the points [rad], shape (n, 6).
    """
    limits = robot.limits
    own = accelerations(limits)
    return sum(float(move_time(one, other, limits.speed, own)) for one, other in pairwise(joints))


def moves_between(robot: Robot, tool: Tool, settings: Settings, stops: Sequence[Stop]) -> tuple[Transition, ...]:
    """The moves from hole to hole in their order, with what a user should know of them.

    Args:
        robot: the arm.
        tool: on its flange.
        settings: with the home position, and what is asked of clearance.
        stops: in order.
    """
    home = np.empty((0, 6)) if settings.home_joints is None else np.array([settings.home_joints])
    legs = [_Leg(one, other, home) for one, other in pairwise(stops)]
    if len(home) and stops:
        legs = [_Leg(None, stops[0], home), *legs, _Leg(stops[-1], None, home)]
    around = Around.of(robot, tool, settings)
    if settings.part_thickness == 0 or settings.surroundings.part is not None:
        led = [_led_over(around, robot, settings, leg, None) for leg in legs]
        return tuple(_transition(robot, settings, leg, None, (), around) for leg in led)
    part = _Part(robot, capsules_of(robot, tool), settings.part_thickness)
    closest = part.nearest(legs, part.capsules)
    through = _raised(part, settings, legs, closest)
    stays = replace(settings, safe_height=0.0)  # of a move that dips at any height
    led = [_led_over(around, robot, stays if k in through else settings, leg, part) for k, leg in enumerate(legs)]
    moved = [k for k, one in enumerate(led) if one.leg is not legs[k]]
    for k, near in zip(moved, part.nearest([led[k].leg for k in moved], part.capsules), strict=True):
        closest[k] = near
    return tuple(
        _transition(robot, settings, one, near.clearance, _findings(part, settings, one.leg, near, through.get(k)),
                    around)
        for k, (one, near) in enumerate(zip(led, closest, strict=True))
    )  # fmt: skip


class _Led(NamedTuple):
    """A move, and what it touches all the same."""

    leg: _Leg
    hit: Met | None


def _led_over(around: Around | None, robot: Robot, settings: Settings, leg: _Leg, part: _Part | None) -> _Led:
    """A move that touches what stands around, led over it where that can be; a safe height of 0 forbids it."""
    hit = None if around is None else around.hit(leg.joints)
    if around is None or hit is None or settings.safe_height == 0:
        return _Led(leg, hit)
    for rise in RISES:
        if rise * robot.size > (settings.safe_height or 0.0):
            higher = leg.rising(rise * robot.size)
            dips = part is not None and part.nearest([higher], part.lines)[0].clearance < -SLACK
            if not dips and around.hit(higher.joints) is None:
                return _Led(higher, None)
    return _Led(leg, hit)


def _raised(part: _Part, settings: Settings, legs: list[_Leg], closest: list[Nearest]) -> dict[int, Nearest]:
    """Replace the moves that dip behind the surface by such as rise over it, in place; those that dip all the same.

    Args:
        part: what must not be touched.
        settings: with the safe height.
        legs: the moves.
        closest: where each comes nearest, the thickness of the bodies included; replaced likewise.
    """
    lines, size = part.lines, part.robot.size
    # a line is no nearer to the part than what is thick about it; both are found to `EXACT`
    maybe = [k for k, near in enumerate(closest) if near.clearance < EXACT - SLACK]
    bare = part.nearest([legs[k] for k in maybe], lines)
    dips = {k: near for k, near in zip(maybe, bare, strict=True) if near.clearance < -SLACK}
    dipped = list(dips)
    for rise in () if settings.safe_height == 0 else RISES:
        if rise * size <= (settings.safe_height or 0.0):
            continue
        higher = [legs[k].rising(rise * size) for k in dips]
        for k, leg, near in zip(list(dips), higher, part.nearest(higher, lines), strict=True):
            if near.clearance >= -SLACK:
                legs[k] = leg
                del dips[k]
    raised = [k for k in dipped if k not in dips]
    for k, near in zip(raised, part.nearest([legs[k] for k in raised], part.capsules), strict=True):
        closest[k] = near
    return dips


def _transition(
    robot: Robot,
    settings: Settings,
    led: _Led,
    clearance: float | None,
    met: tuple[Finding, ...],
    around: Around | None,
) -> Transition:
    """A move as data, with what turns on it."""
    leg = led.leg
    joints, one, other = leg.joints, leg.one, leg.other
    turns = np.abs(np.diff(joints, axis=0)).sum(axis=0)
    axis = int(np.argmax(turns))
    start, to = (None if stop is None else stop.hole.id for stop in (one, other))
    found = []
    changes = one is not None and other is not None and one.branch != other.branch
    if changes and one is not None and other is not None:
        message = f"{leg.name} the arm changes its posture (branch {one.branch} to {other.branch})"
        found.append(Finding("warning", "posture_change", message, leg.hole))
    if turns[axis] > LONG_TURN:
        message = f"{leg.name} {robot.joint_names[axis]} turns by {np.rad2deg(turns[axis]):.0f} deg"
        found.append(Finding("warning", "long_turn", message, leg.hole))
    time = time_of_moves(robot, joints)
    near = None if around is None else around.clearance(joints)
    found += met
    if around is not None:
        found += around.findings(leg.name, led.hit, near, leg.hole)
    return Transition(start, to, joints, time, changes, float(turns[axis]), clearance, tuple(found), near)


def _findings(
    part: _Part, settings: Settings, leg: _Leg, closest: Nearest, through: Nearest | None
) -> tuple[Finding, ...]:
    """That a move passes through the part, or nearer to it than asked for."""
    if through is not None and through.clearance < -THROUGH:
        message = f"{leg.name} the {through.body} passes {-through.clearance * 1e3:.1f} mm behind the surface"
        at_home = leg.one is None or leg.other is None
        if at_home and part.behind(leg.home, leg.planes):
            message += ", where the home position lies, too: whether the part reaches so far is not known"
            return (Finding("warning", "near_part", message, leg.hole),)
        message += ", through the part (safe_height_mm leads it over; part_thickness_mm says where the part ends)"
        return (Finding("error", "through_part", message, leg.hole),)
    if closest.clearance >= settings.clearance - SLACK:
        return ()
    guess = " (how thick it is is a guess)" if closest.body == "wrist" else ""
    far = f"{abs(closest.clearance) * 1e3:.2f} mm"
    met = f"dips {far} behind the surface" if closest.clearance < -SLACK else f"comes within {far} of the part"
    wanted = f", and {settings.clearance * 1e3:g} mm are asked for (clearance_mm)" if settings.clearance > 0 else ""
    cure = "; retract_mm, approach_mm and safe_height_mm lead it further away"
    return (Finding("warning", "near_part", f"{leg.name} the {closest.body}{guess} {met}{wanted}{cure}", leg.hole),)
