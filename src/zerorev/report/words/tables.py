"""What the terminal shows of a plan, its findings and the robots, as rich's tables and texts."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np
from rich import box
from rich.table import Table
from rich.text import Text

from zerorev.files.conversion import robot_data
from zerorev.model.finding import Finding, Level
from zerorev.model.job import Settings
from zerorev.model.plan import HolePlan, Plan, Score, named_holes
from zerorev.model.robot import Robot
from zerorev.model.strokes import each_stroke
from zerorev.report.words.as_shown import controller_rows, turning_note
from zerorev.report.words.lost_motion import HEADING, lost_motion_cell

__all__ = [
    "NO_BASELINE",
    "branch_cell",
    "finding_lines",
    "hole_check",
    "hole_findings",
    "no_baseline",
    "plan_table",
    "reversals_cell",
    "robot_heading",
    "robot_lines",
    "robot_sheet",
    "robot_table",
    "robots_note",
    "robots_table",
    "slowest",
    "spins_cell",
    "stroke_lines",
]

NO_BASELINE = "? → …: with constant spin the hole cannot be run at all"
PROOFS = {"certified": "green", "undecided": "yellow", "refuted": "bold red"}
LEVELS = {"error": "bold red", "warning": "yellow", "info": "cyan"}
MESSAGES_SHOWN = {"error": 8, "warning": 3, "info": 1}  # of one kind of finding; what is left is counted


def plan_table(plan: Plan) -> Table:
    """One row per hole: reversals, travel, branch, spins, slowest joint, deepest stroke, time, outcome of the check.

    And the predicted lost motion, where there is one at all. Under a hole of several strokes a row for each of them.
    """
    weighed = any(hole.lost_motion is not None for hole in plan.holes)
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    table.add_column(Text("hole"), no_wrap=True)
    table.add_column(Text("reversals\nbaseline → plan"), justify="right")
    table.add_column(Text("travel\n[deg]"), justify="right")
    table.add_column(Text("branch"), justify="right")
    table.add_column(Text("spins\n[deg]"), justify="right")
    table.add_column(Text("slowest joint\n[deg/mm]"), justify="right")
    table.add_column(Text("deepest\n[mm]"), justify="right")
    table.add_column(Text("time\n[s]"), justify="right")
    if weighed:
        table.add_column(Text(HEADING), justify="right")
    table.add_column(Text("verified"))
    for hole in plan.holes:
        strokes = [(f"  {name}, {answer.hole.depth * 1e3:.6g} mm", answer, in_air) for name, answer, in_air in
                   stroke_lines(hole)]  # fmt: skip
        for name, answer, in_air in [(hole.hole.id, hole, 0), *strokes]:
            *cells, verdict = _cells(plan, answer, in_air)
            lost = [Text(lost_motion_cell(answer.lost_motion))] if weighed else []
            table.add_row(Text(name), *cells, *lost, verdict)
    return table


def stroke_lines(hole: HolePlan) -> list[tuple[str, HolePlan, int]]:
    """Of each stroke of a hole of several: how its line is called, its answer, the reversals in the air before it."""
    return [(f"stroke {n}", stroke.answer, stroke.reversals_in_air) for n, stroke in enumerate(hole.strokes, 1)]


def _cells(plan: Plan, hole: HolePlan, in_air: int) -> list[Text]:
    motion, score = hole.motion, hole.score
    if motion is None or score is None:
        cells = ("infeasible", *"––––", _deepest(hole), *"––")
        return [Text(cell, style="red" if n == 0 else "") for n, cell in enumerate(cells)]
    slow = slowest(score, plan.settings)
    return [
        Text(reversals_cell(hole, in_air), style="green" if score.reversals == 0 else "yellow"),
        Text(_number(np.rad2deg(score.travel), 1)),
        Text(branch_cell(hole)),
        Text(spins_cell(hole)),
        Text("–" if slow is None else f"{_number(np.rad2deg(slow[0]) * 1e-3, 4)} {plan.robot.joint_names[slow[1]]}"),
        Text(_deepest(hole)),
        Text("–" if hole.cycle_time is None else _number(hole.cycle_time, 1)),
        hole_check(hole),
    ]


def reversals_cell(hole: HolePlan, in_air: int = 0) -> str:
    """Reversals of the baseline and of the motion; and how many are in the air before, where there are any."""
    before = "?" if hole.baseline is None else str(hole.baseline.reversals)
    after = "?" if hole.score is None else str(hole.score.reversals)
    return f"{before} → {after}" + (f", {in_air} in the air" if in_air else "")


def branch_cell(hole: HolePlan) -> str:
    """The branch of the motion, or those of the strokes."""
    found = {answer.motion.branch for answer in each_stroke(hole) if answer.motion is not None}
    return ", ".join(map(str, sorted(found)))


def spins_cell(hole: HolePlan) -> str:
    """Spins [deg] at start, target and end; the dots between them stand for what a long profile has there.

    Of a hole of several strokes how many there are: each has spins of its own.

    Args:
        hole: with a motion.
    """
    if hole.strokes:
        return f"{len(hole.strokes)} strokes"
    assert hole.motion is not None
    profile = hole.motion.profile
    ends = [float(profile.psi[at]) for at in (0, profile.corner, -1)]
    between = "  " if len(profile.psi) == len(ends) else " … "
    return between.join(_number(spin, 2) for spin in np.rad2deg(ends))


def no_baseline(holes: Iterable[HolePlan]) -> bool:
    """Whether the reversals of some hole in a table begin with a `?`, which `NO_BASELINE` explains."""
    return any(hole.baseline is None and hole.score is not None for hole in holes)


def hole_check(hole: HolePlan) -> Text:
    """Whether the check of a motion passed, and what is proven of it."""
    checked = hole.verified
    verdict = Text("no", style="yellow") if checked is None else Text("yes", style="green")
    if checked is not None and not checked.passed:
        verdict = Text("FAILED", style="bold red")
    if hole.certificate is not None:
        verdict.append(f", {hole.certificate.verdict}", PROOFS[hole.certificate.verdict])
    if (within := hole.certified_within) is not None:
        verdict.append(f" within {within.position * 1e3:.6g} mm, {np.rad2deg(within.rotation):.6g} deg", "green")
    return verdict


def _deepest(hole: HolePlan) -> str:
    return "–" if hole.deepest is None else _number(hole.deepest * 1e3, 1)


def finding_lines(findings: Iterable[Finding]) -> list[Text]:
    """Findings, the gravest first; those that say the same share a line, and of many of a kind a few stand for all."""
    kinds: dict[tuple[str, str], dict[str, list[str]]] = {}
    for finding in findings:
        messages = kinds.setdefault((finding.level, finding.kind), {})
        messages.setdefault(finding.message, []).extend([] if finding.hole is None else [finding.hole])
    lines = []
    width = max((len(kind) for _, kind in kinds), default=0) + 1
    for (level, kind), messages in sorted(kinds.items(), key=lambda entry: list(LEVELS).index(entry[0][0])):
        shown = list(messages.items())[: MESSAGES_SHOWN[level]]
        for message, holes in shown:
            where = f"{named_holes(holes)}: " if holes else ""
            lines.append(Text.assemble((f"{level:<8}", LEVELS[level]), (f"{kind:<{width}}", "bold"), where, message))
        if rest := list(messages.items())[len(shown) :]:
            lines.append(Text.assemble(" " * (8 + width), (_likewise(shown, rest), "dim")))
    return lines


def _likewise(shown: Sequence[tuple[str, list[str]]], rest: Sequence[tuple[str, list[str]]]) -> str:
    """Of which other holes the same kind of finding is said; what more is said of the holes above is counted."""
    above = {hole for _, holes in shown for hole in holes}
    others = [hole for _, holes in rest for hole in holes if hole not in above]
    more = sum(above.issuperset(holes) for _, holes in rest)
    parts = [f"likewise {named_holes(others)}"] if others else []
    parts += [f"{more:,} more like {'this' if len(shown) == 1 else 'these'}"] if more else []
    return f"and {' and '.join(parts)}"


def hole_findings(hole: HolePlan) -> list[Finding]:
    """What is to be said of one hole: its findings, what its check found wrong, and what its certificate left open."""
    found = list(hole.findings)
    if hole.verified is not None and not hole.verified.passed:
        failures = hole.verified.failures or ("the check failed",)
        failed = [Finding("error", "verification", failure, hole.hole.id) for failure in failures]
        found += [finding for finding in failed if finding not in found]
    if hole.certificate is not None:
        level: Level = "error" if hole.certificate.verdict == "refuted" else "warning"
        found += [Finding(level, "certificate", reason, hole.hole.id) for reason in hole.certificate.reasons]
    return found


def slowest(score: Score | None, settings: Settings) -> tuple[float, int] | None:
    """Rate [rad/m] and index of the slowest joint that does not reverse, by the rule of the motion threshold."""
    if score is None:
        return None
    rates = score.min_rate if settings.min_rate_rule == "pointwise" else score.mean_rate
    steady = [(float(rates[i]), i) for i in range(6) if score.reversals_per_joint[i] == 0]
    return min((pair for pair in steady if np.isfinite(pair[0])), default=None)


def robots_table(robots: Iterable[Robot]) -> Table:
    """One row per robot: name, maker, model, reach of the wrist centre, rated load, joint limits."""
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    for heading in ("name", "maker", "model"):
        table.add_column(Text(heading), no_wrap=True)
    table.add_column(Text("reach of the\nwrist [mm]"), justify="right")
    table.add_column(Text("load\n[kg]"), justify="right")
    table.add_column(Text("joint limits [deg]"))
    for robot in robots:
        limits = np.rad2deg(np.array([robot.limits.lower, robot.limits.upper])).T
        ranges = "  ".join(f"{name} {_range(*pair)}" for name, pair in zip(robot.joint_names, limits, strict=True))
        table.add_row(
            robot.name, robot.manufacturer, robot.model, f"{robot.wrist_reach * 1e3:.0f}", _load(robot), ranges
        )
    return table


def _load(robot: Robot) -> str:
    return "" if robot.rated_load is None else f"{robot.rated_load:g}"


def robots_note(robots: Iterable[Robot]) -> Text | None:
    """What stands under the table of robots: of which the controller does not show the joints that turn."""
    notes: dict[str, list[str]] = {}
    for robot in robots:
        notes.setdefault(turning_note(robot), []).append(robot.name)
    lines = [f"{', '.join(names)}: {note}" for note, names in notes.items() if note]
    return Text("\n".join(lines), style="dim") if lines else None


def robot_sheet(robot: Robot) -> dict[str, Any]:
    """The robot as plain data: what a plan file holds of it, with sources and caveats."""
    return robot_data(robot) | {
        "wrist_reach_mm": round(robot.wrist_reach * 1e3, 6),
        "sources": dict(robot.sources),
        "second_sources": list(robot.second_sources),
        "caveats": list(robot.caveats),
    }


def robot_heading(robot: Robot) -> Text:
    """Name, maker and model, the lengths of the arm, and how its controller counts."""
    lengths = "  ".join(
        f"{name} {_plain(getattr(robot.arm, name) * 1e3)}" for name in ("a1", "a2", "b", "c1", "c2", "c3", "c4")
    )
    return Text.assemble(
        (robot.name, "bold"), f"   {robot.manufacturer} {robot.model}\n\n", ("lengths [mm]   ", "bold"), lengths,
        ("\nwrist reach    ", "bold"), f"{robot.wrist_reach * 1e3:.0f} mm from axis 1",
        *(part for name, text in controller_rows(robot) for part in ((f"\n{name:<15}", "bold"), text)),
    )  # fmt: skip


def robot_table(robot: Robot) -> Table:
    """One row per joint: sign, offset, limits, speed."""
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    table.add_column(Text("joint"))
    for heading in ("sign", "offset\n[deg]", "lower\n[deg]", "upper\n[deg]", "speed\n[deg/s]"):
        table.add_column(Text(heading), justify="right")
    limits = robot.limits
    for i, name in enumerate(robot.joint_names):
        angles = np.rad2deg([robot.arm.offset[i], limits.lower[i], limits.upper[i], limits.speed[i]])
        table.add_row(name, f"{robot.arm.sign[i]:+g}", *(_plain(angle) for angle in angles))
    return table


def robot_lines(robot: Robot) -> list[Text]:
    """Where each group of numbers comes from, what else was compared, and what to beware of."""
    lines = [Text("where the numbers come from", style="bold")]
    lines += [Text(f"  {group:<14} {source}") for group, source in robot.sources.items()]
    for heading, entries in (("compared with", robot.second_sources), ("beware", robot.caveats)):
        if entries:
            lines += [Text(""), Text(heading, style="bold"), *(Text(f"  - {entry}") for entry in entries)]
    return lines


def _range(lower: float, upper: float) -> str:
    lower, upper = round(float(lower), 1), round(float(upper), 1)
    return f"±{upper:g}" if lower == -upper else f"{lower:g}..{upper:g}"


def _plain(value: float) -> str:
    return f"{round(float(value), 3) + 0.0:g}"


def _number(value: float, digits: int) -> str:
    return f"{round(float(value), digits) + 0.0:.{digits}f}"
