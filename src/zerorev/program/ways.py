"""The way to a hole and away from it: in the air, outside the stroke and its lead-in.

A hole is approached and left along its drill axis at constant spin; joints may reverse there, and the arm stops where
the lead-in begins and where the stroke has ended, so no reversal reaches the material. From there on all axes move at
once, at first to a point of the drill axis at a safe height over the surface.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from zerorev.collision.arms import setting_of
from zerorev.model._arrays import Array
from zerorev.model.finding import Finding
from zerorev.model.hole import Hole
from zerorev.model.job import Settings
from zerorev.model.plan import HolePlan, Motion
from zerorev.model.robot import Robot
from zerorev.model.strokes import each_stroke
from zerorev.model.tool import Tool
from zerorev.motion.drilling import Drilling
from zerorev.program.lead_in import LeadIn, find_lead_in
from zerorev.program.outward import Line, Outward, outward

__all__ = ["Stop", "Way", "stop_of", "stop_of_answer"]

SAME = 1e-9  # [m], and of a unit vector: two strokes of one hole


@dataclass(frozen=True)
class Way:
    """How a motion is reached and left.

    Attributes:
        lead_in: before the stroke.
        approach: before the lead-in, at constant spin.
        retract: after the stroke, likewise.
        ahead: on beyond the approach, outwards along the drill axis.
        after: on beyond the retract, likewise.
        surface: stand-off at which the stroke begins [m].
        safe_height: over the surface, through which all axes move [m]; None: none.
        findings: what is shorter than it should be, and why.
    """

    lead_in: LeadIn
    approach: Outward
    retract: Outward
    ahead: Line
    after: Line
    surface: float
    safe_height: float | None
    findings: tuple[Finding, ...]

    @classmethod
    def of(cls, drilling: Drilling, motion: Motion, settings: Settings) -> Way:
        """The way to a motion and away from it, each part as long as asked for, or as long as possible.

        Args:
            drilling: robot, tool and hole.
            motion: of the hole.
            settings: that ask.
        """
        profile = motion.profile
        setting = setting_of(drilling.robot, drilling.tool, settings)
        lead_in = find_lead_in(drilling, motion, settings.lead_in, setting)
        surface = float(profile.standoff[0])
        first = float(profile.psi[0]) + float(profile.twist_rate[0]) * lead_in.length
        ahead = Line(drilling, motion.branch, surface + lead_in.length, first, 0.0, lead_in.joints, None, setting)
        after = Line(drilling, motion.branch, surface, float(profile.psi[-1]), 0.0, motion.joints[-1], None, setting)
        approach, retract = outward(ahead, settings.approach, 0.0), outward(after, settings.retract, 0.0)
        way = cls(lead_in, approach, retract, ahead.beyond(approach), after.beyond(retract), surface, None, ())
        way = replace(way, safe_height=settings.safe_height)
        found = (
            *_shorter(drilling, "approach", settings.approach, approach),
            *_shorter(drilling, "retract", settings.retract, retract),
        )
        if settings.safe_height is not None:
            for name, line in (("on arrival", way.ahead), ("on leaving", way.after)):
                height = way._rise(line, settings.safe_height)
                above = replace(height, length=height.length + line.standoff - surface)
                found += tuple(_shorter(drilling, f"safe height {name}", settings.safe_height, above))
        return replace(way, findings=(*lead_in.findings, *found))

    @cached_property
    def arrival(self) -> Array:
        """Joints through which moves of all axes lead, the last where the linear moves begin [rad], shape (n, 6)."""
        return self._through(self.ahead)[::-1]

    @cached_property
    def departure(self) -> Array:
        """The same on leaving, the first where the linear moves end [rad], shape (n, 6)."""
        return self._through(self.after)

    def _through(self, line: Line) -> Array:
        if self.safe_height is None:
            return line.joints[None]
        above = self._rise(line, self.safe_height)
        return np.array([line.joints, above.joints] if above.length > 0 else [line.joints])

    def _rise(self, line: Line, height: float) -> Outward:
        return outward(line, height - (line.standoff - self.surface), 0.0)


@dataclass(frozen=True)
class Stop:
    """A hole on the tour.

    Attributes:
        hole: which.
        branch: of the motion.
        way: to it and away.
        leaving: the way away, where the hole is drilled in several strokes: that of the last one.
    """

    hole: Hole
    branch: int
    way: Way
    leaving: Way | None = None

    @property
    def plane(self) -> Array:
        """The surface: unit direction into the part, and its product with a point of the surface [m], shape (4,)."""
        into = self.hole.direction
        return np.array([*into, into @ self.hole.target - self.hole.depth])

    @property
    def departure(self) -> Array:
        """Joints through which moves of all axes lead away [rad], shape (n, 6)."""
        return (self.leaving or self.way).departure

    def rising(self, height: float | None) -> Stop:
        """The same through points at a height over the surface [m]; None: straight from the stop and to it."""
        leaving = None if self.leaving is None else replace(self.leaving, safe_height=height)
        return replace(self, way=replace(self.way, safe_height=height), leaving=leaving)

    def shares_hole(self, other: Stop) -> bool:
        """Whether another stop is of the same hole: another stroke."""
        along = np.abs(self.hole.direction - other.hole.direction).max() < SAME
        return bool(along and np.abs(self.hole.entry - other.hole.entry).max() < SAME)


def stop_of(robot: Robot, tool: Tool, settings: Settings, hole: Hole, motion: Motion) -> Stop:
    """A hole with its motion as a stop of the tour.

    Args:
        robot: the arm.
        tool: on its flange.
        settings: how the way is to be.
        hole: which.
        motion: of the hole.
    """
    way = Way.of(Drilling(robot, tool, hole, settings.limit_margin), motion, settings)
    return Stop(hole, motion.branch, way)


def stop_of_answer(robot: Robot, tool: Tool, settings: Settings, answer: HolePlan) -> Stop:
    """A hole's answer, with a motion, as a stop of the tour: of several strokes from the first to the last.

    Args:
        robot: the arm.
        tool: on its flange.
        settings: how the way is to be.
        answer: of the hole.
    """
    ends = each_stroke(answer)
    assert ends[0].motion is not None
    assert ends[-1].motion is not None
    first = stop_of(robot, tool, settings, ends[0].hole, ends[0].motion)
    if len(ends) == 1:
        return first
    last = stop_of(robot, tool, settings, ends[-1].hole, ends[-1].motion)
    return replace(first, hole=answer.hole, leaving=last.way)


def _shorter(drilling: Drilling, name: str, wanted: float, way: Outward) -> Iterator[Finding]:
    if way.why:
        message = f"{name} of {way.length * 1e3:.3f} mm instead of {wanted * 1e3:g} mm: further out {way.why}"
        yield Finding("warning", "approach", message, drilling.hole.id)
