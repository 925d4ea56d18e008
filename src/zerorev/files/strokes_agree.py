"""Strokes in a plan file repeat what their hole, their own answer or their tool says; here they are held to that."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from zerorev.errors import InputError
from zerorev.files.plan_differences import differ, leaves
from zerorev.files.plan_schema import PlanHole, StrokeForm, ToolPlanForm
from zerorev.files.stated_forms import agree
from zerorev.files.units import mm
from zerorev.model.hole import Hole

__all__ = ["further_strokes_agree", "same_axis", "stroke_differs"]

SHIFTED_MM = 1e-9  # by which stand-offs differ that are counted from two places


def further_strokes_agree(holes: Sequence[PlanHole], tools: Sequence[ToolPlanForm]) -> None:
    """Refuse strokes of a further tool among those of a hole that are not what is said of that tool."""
    for n, hole in enumerate(holes):
        said = [each for each in hole.strokes or () if getattr(each, "tool") > 0]  # noqa: B009
        found = [(t, own) for t, tool in enumerate(tools, 1) for own in _own_strokes(tool.holes[n])]
        if hole.strokes is None:
            continue
        where = f"holes[{n}] (hole {hole.id}), strokes"
        agree(f"{where}, those of further tools", len(said), len(found))
        for k, (each, (tool, own)) in enumerate(zip(said, found, strict=True)):
            at = f"{where}, no. {k + 1} of a further tool"
            agree(f"{at}, tool", getattr(each, "tool"), tool)  # noqa: B009
            agree(f"{at}, answer", each.answer, None)
            for what in stroke_differs(at, each, own, hole.depth_mm - own.depth_mm):
                raise InputError(what, where="further tools", accepted="a plan file as zerorev wrote it")


def stroke_differs(at: str, each: StrokeForm, own: PlanHole, up: float) -> Iterator[str]:
    """What is said of a stroke otherwise than of the motion that it is, a sentence each.

    Args:
        at: where it stands.
        each: the stroke.
        own: the hole, or the answer, that the motion stands in.
        up: how much further its stand-offs are counted from there [mm].
    """
    pairs: dict[str, tuple[Any, Any]] = {
        "depth_mm": (each.depth_mm, own.depth_mm),
        "standoff_mm": (each.standoff_mm, own.standoff_mm and [value + up for value in own.standoff_mm]),
        "psi_deg": (each.psi_deg, own.psi_deg),
        "reversals_in_material": (each.reversals_in_material, getattr(own, "reversals")),  # noqa: B009
    }
    for name, there, here in (("joints_deg", each.joints_deg, own.joints_deg), ("corner", each.corner, own.corner)):
        pairs[name] = (there and there.model_dump(), here and here.model_dump())
    for name, (stated, found) in pairs.items():
        one, other = dict(leaves(stated, f"{at}.{name}")), dict(leaves(found, f"{at}.{name}"))
        if one.keys() != other.keys():
            yield differ(f"{at}.{name}", stated, found)
            continue
        for path, value in one.items():
            there = other[path]
            near = isinstance(value, float) and isinstance(there, float) and abs(value - there) <= SHIFTED_MM
            if not (near or value == there):
                yield differ(path, value, there)


def same_axis(where: str, stroke: Hole, hole: Hole) -> None:
    """Refuse a stroke that does not lie on the axis of its hole, or that is not counted as that is."""
    for name, there, here in (
        ("target_mm", mm(stroke.entry), mm(hole.entry)),
        ("direction", stroke.direction, hole.direction),
        ("psi_zero", stroke.psi_zero, hole.psi_zero),
    ):
        agree(f"{where}.{name}, its distance from the hole's own", float(np.abs(there - here).max()), 0.0, SHIFTED_MM)


def _own_strokes(form: PlanHole) -> list[PlanHole]:
    """What a tool does in a hole, stroke by stroke."""
    if form.strokes is None:
        return []
    return [each.answer or form for each in form.strokes]
