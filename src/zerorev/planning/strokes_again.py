"""What the strokes of a hole come to together, computed again from what a plan file states of each of them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from zerorev.files.plan_differences import differ
from zerorev.files.units import mm
from zerorev.model.job import Settings
from zerorev.model.plan import HolePlan, Verification
from zerorev.model.robot import Robot
from zerorev.model.strokes import of_strokes
from zerorev.model.tool import Tool
from zerorev.planning.pecks import strokes_together

__all__ = ["strokes_again", "strokes_differ", "with_checks", "with_findings_of"]

PLACE = 1e-9  # [m]


def strokes_again(robot: Robot, tool: Tool, settings: Settings, stated: HolePlan) -> HolePlan:
    """The answer of a hole, put together again from the answers of its strokes.

    Args:
        robot: the arm.
        tool: the drill.
        settings: as planned.
        stated: with several strokes.
    """
    answers = [stroke.answer for stroke in stated.strokes]
    return strokes_together(robot, tool, settings, stated.hole, answers, ())


def with_findings_of(found: HolePlan, again: HolePlan) -> HolePlan:
    """The answer with what only a search can say of the hole.

    Args:
        found: put together from its strokes.
        again: planned once more.
    """
    own = tuple(each for each in again.findings if each.kind in ("peck", "deepest"))
    return replace(
        found, deepest=again.deepest, deepest_at_most=again.deepest_at_most, findings=(*own, *found.findings)
    )


def strokes_differ(settings: Settings, stated: HolePlan, found: HolePlan, again: HolePlan) -> Iterator[str]:
    """The strokes have to be those that are asked for, and no worse than those that are found by searching again.

    Args:
        settings: as planned.
        stated: with several strokes.
        found: put together again from those.
        again: planned once more.
    """
    depths = np.array([stroke.answer.hole.depth for stroke in stated.strokes])
    asked = np.array(stated.hole.drilled_by(settings.cycle).strokes(stated.hole.depth))
    if depths.shape != asked.shape or not np.allclose(depths, asked, rtol=0, atol=PLACE):
        yield differ("strokes, depth_mm", mm(depths).tolist(), mm(asked).tolist())
    for name, here, there in (
        ("reversals", _reversals(found), _reversals(again)),
        ("reversals_in_air", _in_air(found), _in_air(again)),
    ):
        if there < here:
            yield f"{differ(name, here, there)} by searching again"
            return


def with_checks(stated: HolePlan, checks: Sequence[Verification | None]) -> HolePlan:
    """The answer of a hole with the outcome of the check of each of its strokes.

    Args:
        stated: with several strokes.
        checks: one each.
    """
    strokes = [
        replace(stroke, answer=replace(stroke.answer, verified=verified))
        for stroke, verified in zip(stated.strokes, checks, strict=True)
    ]
    return of_strokes(stated.hole, strokes, cycle_time=stated.cycle_time)


def _reversals(answer: HolePlan) -> int:
    return 0 if answer.score is None else answer.score.reversals


def _in_air(answer: HolePlan) -> int:
    return sum(stroke.reversals_in_air for stroke in answer.strokes)
