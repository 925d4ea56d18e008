"""What the report of a plan says, as texts: facts, findings, a row per hole and per move between holes."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence
from typing import Literal, NamedTuple

import numpy as np

from zerorev.files.moved_job import frame_text
from zerorev.files.units import deg, mm
from zerorev.model.cycle import Cycle
from zerorev.model.finding import Finding, Level
from zerorev.model.plan import HolePlan, Plan, Transition, named_holes
from zerorev.report.words.answer import how_deep, minutes
from zerorev.report.words.as_shown import controller_rows
from zerorev.report.words.hole_rows import part_data, standing
from zerorev.report.words.lost_motion import PREDICTED, lost_motion_cell
from zerorev.report.words.tables import (
    NO_BASELINE,
    branch_cell,
    hole_check,
    hole_findings,
    no_baseline,
    reversals_cell,
    slowest,
    spins_cell,
    stroke_lines,
)  # fmt: skip

__all__ = [
    "Fact",
    "Move",
    "Row",
    "Said",
    "all_findings",
    "grouped",
    "hole_notes",
    "job_facts",
    "move_row",
    "robot_facts",
    "summary_facts",
    "table_rows",
    "tool_facts",
    "verdict",
    "why_bad",
    "worst_holes",
]  # fmt: skip

LEVELS: tuple[Level, ...] = ("error", "warning", "info")
MESSAGES = {"error": 1_000, "warning": 8, "info": 1}  # of one kind of finding; the rest are counted
GRAVE = {"failed": 0, "infeasible": 1, "reversals": 2, "zero": 3, "unplanned": 4}
Tone = Literal["good", "warn", "bad", ""]


class Fact(NamedTuple):
    """A line of the summary, or of a list of what was asked."""

    name: str
    value: str
    tone: Tone = ""


class Row(NamedTuple):
    """One hole in the table, as texts; the figures in mm, degrees and seconds."""

    number: str
    id: str
    target: str
    direction: str
    depth: str
    reversals: str
    travel: str
    branch: str
    spins: str
    slowest: str
    deepest: str
    lost_motion: str
    time: str
    verified: str
    tone: Tone


class Move(NamedTuple):
    """One move between holes, as texts."""

    start: str
    to: str
    time: str
    posture: str
    turn: str
    clearance: str
    said: tuple[str, ...]
    tone: Tone


class Said(NamedTuple):
    """A finding, with the holes of which it is said."""

    level: Level
    kind: str
    where: str
    message: str


def worst_holes(plan: Plan) -> list[HolePlan]:
    """The holes of a plan, the worst first: check failed, no motion, most reversals, slowest joint."""

    def badness(hole: HolePlan) -> tuple[int, int, float]:
        slow = slowest(hole.score, plan.settings)
        count = 0 if hole.score is None else hole.score.reversals
        return GRAVE[standing(hole)], -count, np.inf if slow is None else slow[0]

    return sorted(plan.holes, key=badness)


def all_findings(plan: Plan) -> list[Finding]:
    """Those of the plan, then of each hole with what its check found, then of each move between holes."""
    of_holes = [finding for hole in plan.holes for finding in hole_findings(hole)]
    return [*plan.findings, *of_holes, *(finding for move in plan.transitions for finding in move.findings)]


def verdict(plan: Plan, errors: int) -> Fact:
    """Whether all is well with a plan, in a sentence."""
    unsound = sum(hole.verified is None or not hole.verified.passed for hole in plan.holes)
    if not unsound and not errors:
        return Fact("All is well", "every hole has a motion that passed the check, and no finding is an error", "good")
    have = "has" if unsound == 1 else "have"
    parts = [f"{unsound:,} of {len(plan.holes):,} holes {have} no motion that passed the check"] * bool(unsound)
    parts += [f"{errors:,} finding{' is an error' if errors == 1 else 's are errors'}"] * bool(errors)
    return Fact("Something is wrong", " and ".join(parts), "bad")


def summary_facts(plan: Plan, levels: Counter[Level]) -> list[Fact]:
    """What was found, in a few figures."""
    scored = [hole for hole in plan.holes if hole.score is not None]
    after = sum(hole.score.reversals for hole in scored if hole.score is not None)
    before = sum(hole.baseline.reversals for hole in scored if hole.baseline is not None)
    fixed = sum(hole.baseline is None for hole in scored)
    without = f" ({fixed:,} of {len(scored):,} cannot be run so)" if fixed else ""
    reversals = f"{before:,} at constant spin{without} → {after:,} as planned"
    passed = sum(hole.verified is not None and hole.verified.passed for hole in plan.holes)
    facts = [
        Fact("holes", f"{len(scored):,} of {len(plan.holes):,} have a motion", _tone(len(scored) == len(plan.holes))),
        Fact("reversals", reversals if scored else "no motion", "warn" if after else _tone(bool(scored))),
        Fact("checked", f"{passed:,} of {len(plan.holes):,} passed", _tone(passed == len(plan.holes))),
    ]
    certified = Counter(hole.certificate.verdict for hole in plan.holes if hole.certificate is not None)
    if certified:
        words = ", ".join(f"{count:,} {verdict}" for verdict, count in sorted(certified.items()))
        facts.append(Fact("certificates", words, "bad" if certified["refuted"] else ""))
    if plan.cycle_time is not None:
        facts.append(Fact("cycle time", minutes(plan.cycle_time)))
    if plan.transitions:
        changes = sum(move.changes_posture for move in plan.transitions)
        moves = f"{len(plan.transitions):,} moves, {changes or 'no'} change{'' if changes == 1 else 's'} of posture"
        facts.append(Fact("between holes", moves))
    said = ", ".join(f"{levels[level]:,} {level}{'' if levels[level] == 1 or level == 'info' else 's'}"
                     for level in LEVELS if levels[level])  # fmt: skip
    tone: Tone = "bad" if levels["error"] else "warn" if levels["warning"] else ""
    return [*facts, Fact("findings", said or "none", tone)]


def _tone(fine: bool) -> Tone:
    return "good" if fine else "bad"


def job_facts(plan: Plan) -> list[Fact]:
    """The job: its part and its holes, and how they are drilled."""
    frame = frame_text(plan.T_base_part)
    settings = plan.settings
    depths = np.array([float(mm(hole.hole.depth)) for hole in plan.holes])
    spread = f"{depths.min():g} mm" if np.ptp(depths) < 1e-6 else f"{depths.min():g} to {depths.max():g} mm"
    return [
        Fact("name", plan.name),
        Fact("holes", f"{len(plan.holes):,}, {spread} deep"),
        Fact("part frame", f"({_listed(frame['xyz_mm'])}) mm, roll pitch yaw ({_listed(frame['rpy_deg'])}) deg"),
        Fact("feed", f"{settings.feed_plunge * 1e3:g} mm/s plunge, {settings.feed_retract * 1e3:g} mm/s retract"),
        *([Fact("spindle", f"{settings.spindle_rpm:g} rpm")] if settings.spindle_rpm else []),
        *([Fact("cycle", cycles)] if (cycles := _cycles(plan)) else []),
        Fact("motions", how_deep(settings)),
    ]


def _cycles(plan: Plan) -> str:
    """How the holes are drilled, and how many so where they differ; empty where all are drilled in one go."""
    counts = Counter(plan.settings.of(hole.hole).cycle.said for hole in plan.holes)
    if list(counts) == [Cycle().said]:
        return ""
    return "; ".join(f"{words} ({count:,})" if len(counts) > 1 else words for words, count in counts.items())


def robot_facts(plan: Plan) -> list[Fact]:
    """The robot: names, reach and limits, and how its controller counts."""
    robot = plan.robot
    limits = np.rad2deg(np.array([robot.limits.lower, robot.limits.upper])).T
    ranges = [f"{name} {low:g} to {high:g}" for name, (low, high) in zip(robot.joint_names, limits, strict=True)]
    return [
        Fact("name", robot.name),
        Fact("maker and model", f"{robot.manufacturer} {robot.model}".strip() or "–"),
        Fact("reach of the wrist", f"{robot.wrist_reach * 1e3:.0f} mm"),
        Fact("joint limits [deg]", "; ".join(ranges)),
        *(Fact(name, text) for name, text in controller_rows(robot)),
    ]


def tool_facts(plan: Plan) -> list[Fact]:
    """The tool: where its tip is, and its mass."""
    frame, load = frame_text(plan.tool.T_flange_tcp), plan.tool.load
    return [
        Fact("name", plan.tool.name),
        Fact("tip in the flange frame", f"({_listed(frame['xyz_mm'])}) mm"),
        Fact("roll pitch yaw", f"({_listed(frame['rpy_deg'])}) deg"),
        Fact("mass", "not stated" if load is None else f"{load.mass:g} kg"),
    ]


def why_bad(plan: Plan, hole: HolePlan) -> str:
    """What is bad about one of the worst holes."""
    stands = standing(hole)
    grave = next((finding.message for finding in hole_findings(hole) if finding.level == "error"), "")
    if stands in ("failed", "infeasible"):
        return grave or "no motion"
    assert hole.score is not None
    slow, count = slowest(hole.score, plan.settings), hole.score.reversals
    parts = [f"{count} reversal{'' if count == 1 else 's'}"] * bool(count)
    if slow is not None:
        parts.append(f"{plan.robot.joint_names[slow[1]]} moves {np.rad2deg(slow[0]) / 1e3:.4f} deg/mm at its slowest")
    if hole.deepest is not None:
        parts.append(f"{float(mm(hole.deepest - hole.hole.depth)):.1f} mm margin in depth")
    return "; ".join(parts)


def grouped(found: Sequence[Finding]) -> list[Said]:
    """The findings, the gravest first; those that say the same share a line, and of many of a kind a few are shown."""
    lines: dict[tuple[Level, str, str], list[str]] = {}
    for finding in found:
        holes = lines.setdefault((finding.level, finding.kind, finding.message), [])
        holes += [] if finding.hole is None else [finding.hole]
    said: list[Said] = []
    for level, kind in sorted({line[:2] for line in lines}, key=lambda group: (LEVELS.index(group[0]), group[1])):
        of_kind = [(message, holes) for (at, name, message), holes in lines.items() if (at, name) == (level, kind)]
        shown = of_kind[: MESSAGES[level]]
        said += [Said(level, kind, named_holes(holes) if holes else "", message) for message, holes in shown]
        if rest := of_kind[len(shown) :]:
            holes = [hole for _, holes in rest for hole in holes]
            where = named_holes(holes) if holes else ""
            said.append(Said(level, kind, where, f"likewise, {len(rest):,} more of this kind"))
    return said


def table_rows(plan: Plan, hole: HolePlan, number: int) -> list[Row]:
    """A hole as it stands in the table, drilled as the `number`-th; under it its strokes, where there are several."""
    strokes = [_row(plan, answer, "", in_air)._replace(id=name) for name, answer, in_air in stroke_lines(hole)]
    return [_row(plan, hole, f"{number}", 0), *strokes]


def _row(plan: Plan, hole: HolePlan, number: str, in_air: int) -> Row:
    target, direction, depth = part_data(hole.hole, plan.T_base_part)
    place = (_listed(np.round(target, 3)), _listed(np.round(direction, 4)), f"{depth:g}")
    deepest = "–" if hole.deepest is None else f"{float(mm(hole.deepest)):.1f}"
    if hole.motion is None or hole.score is None:
        return Row("–", hole.hole.id, *place, "no motion", "–", "–", "–", "–", deepest, "–", "–", "–", "bad")
    slow = slowest(hole.score, plan.settings)
    tones: dict[str, Tone] = {"zero": "", "reversals": "warn", "failed": "bad"}
    return Row(
        number, hole.hole.id, *place, reversals_cell(hole, in_air), f"{float(deg(hole.score.travel)):.1f}",
        branch_cell(hole), spins_cell(hole),
        "–" if slow is None else f"{np.rad2deg(slow[0]) / 1e3:.4f} {plan.robot.joint_names[slow[1]]}", deepest,
        lost_motion_cell(hole.lost_motion), "–" if hole.cycle_time is None else f"{hole.cycle_time:.1f}",
        hole_check(hole).plain, tones[standing(hole)],
    )  # fmt: skip


def hole_notes(plan: Plan) -> list[str]:
    """What stands under the table of holes."""
    notes = [NO_BASELINE] if no_baseline(plan.holes) else []
    if any(hole.deepest is not None for hole in plan.holes):
        notes.append(f"deepest: the deepest stroke without a reversal; {how_deep(plan.settings)}")
    if any(hole.lost_motion is not None for hole in plan.holes):
        notes.append(f"lost motion: {PREDICTED}")
    return [*notes, "target and direction: in the part frame, direction into the material"]


def move_row(move: Transition) -> Move:
    """A move between holes as it stands in the table."""
    levels = {finding.level for finding in move.findings}
    clearance = "–" if move.clearance is None else f"{round(float(mm(move.clearance)), 1) + 0.0:.1f}"
    return Move(
        move.start or "home",
        move.to or "home",
        f"{move.time:.2f}",
        "changes" if move.changes_posture else "",
        f"{float(deg(move.largest_axis_move)):.1f}",
        clearance,
        tuple(finding.message for finding in move.findings),
        "bad" if "error" in levels else "warn" if "warning" in levels else "",
    )


def _listed(values: Iterable[float]) -> str:
    return ", ".join(f"{value + 0.0:g}" for value in values)
