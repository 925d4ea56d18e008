"""From the plan to the plain data of its file; millimetres and degrees begin here. `plan_conversion` goes back."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from zerorev.files.conversion import frame_data, robot_data, settings_data, tool_data
from zerorev.files.plan_schema import DepthFile, PlanFile
from zerorev.files.solids import surroundings_data
from zerorev.files.stated_forms import data_of
from zerorev.files.units import deg, deg_per_mm, mm, plain
from zerorev.model._arrays import Array
from zerorev.model.hole import Hole
from zerorev.model.plan import Corner, HolePlan, LostMotion, Motion, Plan, Score, Stroke, Strokes
from zerorev.model.stated import stated
from zerorev.model.strokes import shifted

__all__ = ["FORMS", "MOTION", "SCORE", "answer_data", "asked_data", "further_data", "plan_data", "plan_head",
           "sequence_data", "twist_spread", "with_further_strokes"]  # fmt: skip

FORMS: dict[Strokes, type[PlanFile] | type[DepthFile]] = {"asked": PlanFile, "deepest": DepthFile}
"""What file a plan becomes, by its strokes."""

MOTION = ("branch", "standoff_mm", "psi_deg", "joints_deg")
SCORE = ("reversals", *(each.path[-1] for each in stated(Score)), "events")


def plan_data(plan: Plan) -> dict[str, Any]:
    """The plan as plain data, in the form of a plan file or, where its strokes are the deepest, of a depth file."""
    head = plan_head(plan)
    findings = head.pop("findings")
    holes = [with_further_strokes(answer_data(hole, plan.strokes), plan, n) for n, hole in enumerate(plan.holes)]
    return head | {"holes": holes} | sequence_data(plan) | {"findings": findings} | further_data(plan)


def further_data(plan: Plan) -> dict[str, Any]:
    """What the further tools do, as it stands at the end of the file; nothing where there is one tool."""
    tools = [
        {"name": each.name, "tool": tool_data(each.tool), "settings": settings_data(each.settings)}
        | {"holes": [answer_data(hole, "asked") for hole in each.holes]}
        | sequence_data(each)
        | {"findings": [data_of(finding) for finding in each.findings]}
        for each in plan.further
    ]
    return {"tools": tools} if tools else {}


def with_further_strokes(entry: dict[str, Any], plan: Plan, number: int) -> dict[str, Any]:
    """A hole as it stands in the file with the strokes of the further tools among its own.

    Args:
        entry: the hole as the first tool alone leaves it.
        plan: with the plans of the further tools.
        number: of the hole, from 0.
    """
    own = entry.get("plan", entry)
    if own["strokes"] is None:
        return entry
    hole_depth = own["depth_mm"] * 1e-3
    further = [
        data_of(replace(stroke, tool=tool)) | _stroke_data(hole_depth, stroke.answer) | {"answer": None}
        for tool, each in enumerate(plan.further, 1)
        for stroke in _strokes_of(each.holes[number])
    ]
    own["strokes"] += plain(further)
    return entry


def sequence_data(plan: Plan) -> dict[str, Any]:
    """The order of the holes and the moves between them, as they stand in the file after the holes."""
    if not plan.order:
        return {"order": None, "transitions": None, "cycle_time_s": None}
    moves = [
        {"from": move.start, "to": move.to, "joints_deg": deg(move.joints)}
        | data_of(move)
        | ({} if move.around is None else {"around": data_of(move.around)})
        | {"findings": [data_of(finding) for finding in move.findings]}
        for move in plan.transitions
    ]
    return dict(plain({"order": plan.order, "transitions": moves, "cycle_time_s": plan.cycle_time}))


def plan_head(plan: Plan) -> dict[str, Any]:
    """What the file says of all holes; their list goes before the last entry, `findings`."""
    return {
        "format": FORMS[plan.strokes].model_fields["format"].description,
        "name": plan.name,
        "robot": robot_data(plan.robot),
        "tool": tool_data(plan.tool),
        "part_frame": frame_data(plan.T_base_part),
        "settings": settings_data(plan.settings),
        **_around(plan),
        "findings": [data_of(finding) for finding in plan.findings],
    }


def _around(plan: Plan) -> dict[str, Any]:
    """What stands around; where nothing does, there is no key of it."""
    around = plan.settings.surroundings
    return {"surroundings": surroundings_data(around)} if around.obstacles else {}


def answer_data(answer: HolePlan, strokes: Strokes) -> dict[str, Any]:
    """One hole's answer as it stands in the file."""
    data: dict[str, Any] = plain(_hole_data(answer))
    return data if strokes == "asked" else {"id": data["id"], "deepest_mm": data["deepest_mm"], "plan": data}


def asked_data(hole: Hole) -> dict[str, Any]:
    """What was asked of one hole."""
    return {
        "id": hole.id,
        "group": hole.group or None,
        "target_mm": mm(hole.target),
        "direction": hole.direction,
        "depth_mm": mm(hole.depth),
        "psi_zero": hole.psi_zero,
        "given": _given_data(hole),
        "cycle": None if hole.cycle is None else data_of(hole.cycle),
    }


def _hole_data(answer: HolePlan) -> dict[str, Any]:
    figures = data_of(answer)
    return {
        **asked_data(answer.hole),
        "deepest_mm": figures.pop("deepest_mm"),
        "deepest_at_most_mm": figures.pop("deepest_at_most_mm"),
        "status": answer.status,
        **_motion_data(answer.motion),
        **_score_data(answer.score),
        **_critical_data(answer.critical_rates),
        **figures,
        "optimality": _data(answer.optimality),
        "baseline": _data(answer.baseline),
        "verified": _data(answer.verified),
        "certificate": _data(answer.certificate),
        "certified_within": _data(answer.certified_within),
        "criteria": _data(answer.measures),
        "lost_motion": _lost_motion_data(answer.lost_motion),
        "corner": _corner_data(answer.corner),
        "strokes": _strokes_data(answer),
        **({} if answer.clearance is None else {"clearance": data_of(answer.clearance)}),
        "findings": [data_of(finding) for finding in answer.findings],
    }


def _data(noun: object) -> dict[str, Any] | None:
    return None if noun is None else data_of(noun)


def _lost_motion_data(lost: LostMotion | None) -> dict[str, Any] | None:
    return None if lost is None else data_of(lost) | {"events": [data_of(event) for event in lost.events]}


def _corner_data(corner: Corner | None) -> dict[str, Any] | None:
    return None if corner is None else data_of(corner) | {"interval_mm": mm(np.array(corner.interval))}


def _strokes_data(answer: HolePlan) -> list[dict[str, Any]] | None:
    """The strokes; of a hole with one motion that alone, which is known only where its feeds are."""
    own: list[dict[str, Any] | None] = [_hole_data(each.answer) for each in answer.strokes] or [None]
    said = answer.strokes_as_read or [
        data_of(each) | _stroke_data(answer.hole.depth, each.answer) for each in _strokes_of(answer)
    ]
    return [{**each, "answer": one} for each, one in zip(said, own, strict=True)] if said else None


def _strokes_of(answer: HolePlan) -> tuple[Stroke, ...]:
    """The strokes of one tool in a hole: its only motion, too; none where there is no motion, or no feed is known."""
    if answer.strokes:
        return answer.strokes
    return () if answer.motion is None or answer.feeds is None else (Stroke(answer),)


def _stroke_data(depth: float, own: HolePlan) -> dict[str, Any]:
    """A stroke of a hole of some depth [m], stand-offs counted from the hole's own target."""
    assert own.motion is not None
    assert own.feeds is not None
    motion = shifted(own.motion, depth - own.hole.depth)
    return {
        "depth_mm": mm(own.hole.depth),
        **{key: value for key, value in _motion_data(motion).items() if key != "branch"},
        "feeds_mm_s": dict(zip(("plunge", "retract"), mm(own.feeds), strict=True)),
        "corner": _corner_data(own.corner),
        "reversals_in_material": 0 if own.score is None else own.score.reversals,
    }


def _critical_data(kappa: Array | None) -> dict[str, Any]:
    if kappa is None:
        return {"critical_rates_deg_per_mm": None, "twist_spread_deg_per_mm": None}
    # of the digits that are written, so that a file that is read and written again stays the same
    written = plain(deg_per_mm(kappa))
    return {"critical_rates_deg_per_mm": written, "twist_spread_deg_per_mm": twist_spread(written)}


def twist_spread(written: Sequence[float | None] | None) -> float | None:
    """Greatest less least of the critical rates as a file has them; None where one is missing."""
    known = [rate for rate in written or () if rate is not None]
    return float(plain(max(known) - min(known))) if written is not None and len(known) == len(written) else None


def _given_data(hole: Hole) -> dict[str, Any] | None:
    if hole.profile is None and hole.branch is None:
        return None
    standoff_mm = None if hole.profile is None else mm(hole.profile.standoff)
    psi_deg = None if hole.profile is None else deg(hole.profile.psi)
    return {"standoff_mm": standoff_mm, "psi_deg": psi_deg, "branch": hole.branch}


def _motion_data(motion: Motion | None) -> dict[str, Any]:
    if motion is None:
        return dict.fromkeys(MOTION)
    joints, corner = deg(motion.joints), motion.profile.corner
    return {
        "branch": motion.branch,
        "standoff_mm": mm(motion.profile.standoff),
        "psi_deg": deg(motion.profile.psi),
        "joints_deg": {"start": joints[0], "target": joints[corner], "end": joints[-1], "breakpoints": joints},
    }


def _score_data(score: Score | None) -> dict[str, Any]:
    # the events stand in the middle
    places = dict.fromkeys(("reversals", "reversals_per_joint", "events"))
    if score is None:
        return places | dict.fromkeys(SCORE)
    return places | data_of(score) | {"events": [data_of(event) for event in score.events]}
