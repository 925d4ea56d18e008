"""A hole that is drilled in several strokes, the drill pulled out between them: each with its answer, and together."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import pairwise

import numpy as np

from zerorev.model._arrays import Array
from zerorev.model.cycle import Cycle
from zerorev.model.finding import Finding
from zerorev.model.hole import Hole
from zerorev.model.job import Settings
from zerorev.model.plan import HolePlan, Stroke
from zerorev.model.robot import Robot
from zerorev.model.strokes import of_strokes, stroke_hole
from zerorev.model.tool import Tool
from zerorev.motion.drilling import Drilling
from zerorev.motion.joint_path import direction_changes
from zerorev.planning.answered import answered
from zerorev.planning.why_none import why_infeasible
from zerorev.program.between import time_of_moves
from zerorev.program.ways import Way, stop_of_answer
from zerorev.search.pecks import Pecks, pecking

__all__ = ["pecked", "strokes_together"]

AT_REST = 1e-7  # [rad] by which a joint moves that does not
SAMPLES = 65  # of a way at constant spin, on which joints may turn round


def pecked(drilling: Drilling, settings: Settings, cycle: Cycle) -> HolePlan:
    """The answer of a hole with a motion for each of its strokes, each of them checked.

    Args:
        drilling: robot, tool and hole.
        settings: how.
        cycle: how deep each stroke goes.
    """
    hole, depths = drilling.hole, cycle.strokes(drilling.hole.depth)
    found = pecking(drilling, settings, depths)
    if found is None:
        return HolePlan(hole, "infeasible", drilling.wrist_offset, findings=why_infeasible(drilling, settings))
    answers = []
    for number, (depth, motion) in enumerate(zip(depths, found.strokes, strict=True), 1):
        of_it = stroke_hole(hole, number, depth, motion.evaluation.motion, cycle.dwell)
        answers.append(answered(replace(drilling, hole=of_it), settings, "evaluated", motion))
    return strokes_together(drilling.robot, drilling.tool, settings, hole, answers, _peck_findings(hole, found))


def strokes_together(
    robot: Robot, tool: Tool, settings: Settings, hole: Hole, answers: list[HolePlan], findings: tuple[Finding, ...]
) -> HolePlan:
    """The answer of a hole, of those of its strokes.

    Args:
        robot: the arm.
        tool: on its flange.
        settings: how.
        hole: all of it.
        answers: of its strokes, each with a motion.
        findings: of the hole, besides those of the strokes.
    """
    ways = [(each, stop_of_answer(robot, tool, settings, each).way) for each in answers]
    in_air, time = [0], sum(each.cycle_time or 0.0 for each in answers)
    for (one, leaving), (other, arriving) in pairwise(ways):
        in_air.append(_reversals_between(one, leaving, other, arriving))
        time += time_of_moves(robot, np.array([leaving.after.joints, arriving.ahead.joints]))
    strokes = [Stroke(each, count) for each, count in zip(answers, in_air, strict=True)]
    return of_strokes(hole, strokes, cycle_time=time, findings=findings)


def _peck_findings(hole: Hole, found: Pecks) -> tuple[Finding, ...]:
    """How many strokes follow one another without a reversal in the air, and what ends that."""
    count = len(found.strokes)
    if found.in_a_row == count:
        return ()
    message = (
        f"{found.in_a_row or 'none'} of {count} strokes follow one another without a reversal in the air, more were "
        f"not found: {found.ended}; from there on the joints turn back outside the hole"
    )
    return (Finding("info", "peck", message, hole.id),)


def _reversals_between(one: HolePlan, leaving: Way, other: HolePlan, arriving: Way) -> int:
    """Direction changes of the joints from the way out of one stroke to the way in of the next, outside the material.

    Args:
        one: the stroke that is left, with a motion.
        leaving: its way.
        other: the stroke that follows, with a motion.
        arriving: its way.
    """
    assert one.motion is not None
    assert other.motion is not None
    path = np.concatenate([
        one.motion.joints[-2:],
        *_constant(leaving, inwards=False),
        *_constant(arriving, inwards=True),
        arriving.lead_in.joints[None],
        other.motion.joints[:2],
    ])  # fmt: skip
    return int(direction_changes(np.diff(path, axis=0), AT_REST).sum())


def _constant(way: Way, *, inwards: bool) -> Iterator[Array]:
    """Joints along the approach or the retract, at constant spin [rad], shape (n, 6)."""
    line, length = (way.ahead, way.approach.length) if inwards else (way.after, way.retract.length)
    if length > 0:  # the lines begin where these end
        back = line.path(line.standoff - np.linspace(0.0, length, SAMPLES), line.joints)
        yield back if inwards else back[::-1]
