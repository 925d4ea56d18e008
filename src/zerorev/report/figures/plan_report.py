"""A plan as one page to be printed and filed: what was asked, what was found, and what to look at first."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable
from importlib.metadata import version
from typing import Any, NamedTuple

from markupsafe import Markup

from zerorev.model.plan import HolePlan, Plan
from zerorev.report.figures.joints import joint_angles
from zerorev.report.figures.part_view import part_view
from zerorev.report.figures.plane import twist_plane
from zerorev.report.figures.style import png
from zerorev.report.templates import environment
from zerorev.report.words.answer import sequence_line
from zerorev.report.words.plan_facts import (
    all_findings,
    grouped,
    hole_notes,
    job_facts,
    move_row,
    robot_facts,
    summary_facts,
    table_rows,
    tool_facts,
    verdict,
    why_bad,
    worst_holes,
)  # fmt: skip
from zerorev.report.words.settings_rows import settings_rows
from zerorev.visible import one_line

__all__ = ["plan_report"]

DRAWN = 3  # of the worst holes
LISTED = 5


class Picture(NamedTuple):
    """A picture as PNG, and what it shows."""

    data: bytes
    words: str


def plan_report(plan: Plan, source: str) -> str:
    """The page as HTML, whole in itself: no script, nothing from elsewhere. The same plan makes the same page.

    Args:
        plan: what was found; of several tools each has a section of its own.
        source: the file that it comes from, as the page names it.
    """
    return (
        environment("zerorev.report.figures", _shown)
        .get_template("plan_report.html.j2")
        .render(
            version=version("zerorev"),
            title=plan.name,
            kind="Drilling plan" if plan.strokes == "asked" else "Deepest strokes",
            source=source,
            tools=[_of_tool(each) for each in plan.of_all_tools],
        )
    )


def _of_tool(plan: Plan) -> dict[str, Any]:
    """What the page says of a tool, the robot and the holes that it drills."""
    found = all_findings(plan)
    levels = Counter(finding.level for finding in found)
    worst = worst_holes(plan)
    drawn = [hole for hole in worst if hole.motion is not None][:DRAWN]
    return {
        "name": plan.tool.name,
        "verdict": verdict(plan, levels["error"]),
        "summary": summary_facts(plan, levels),
        "asked": (("Job", job_facts(plan)), ("Robot", robot_facts(plan)), ("Tool", tool_facts(plan))),
        "settings": settings_rows(plan.settings),
        "worst": [(hole.hole.id, why_bad(plan, hole)) for hole in worst[:LISTED]],
        "findings": grouped(found),
        "overview": Picture(png(part_view(plan)), "Holes on the part, and the way from one to the next"),
        "pictures": [picture for hole in drawn for picture in _pictures(plan, hole)],
        "rows": [row for n, hole in enumerate(plan.in_order, 1) for row in table_rows(plan, hole, n)],
        "weighed": any(hole.lost_motion is not None for hole in plan.holes),
        "notes": hole_notes(plan),
        "moves": [move_row(move) for move in plan.transitions],
        "sequence": sequence_line(plan.transitions, plan.cycle_time) if plan.transitions else "",
    }


def _shown(value: Any) -> Any:
    """Text of unknown origin with nothing unseen in it; it is escaped besides."""
    return one_line(value) if isinstance(value, str) and not isinstance(value, Markup) else value


def _pictures(plan: Plan, hole: HolePlan) -> Iterable[Picture]:
    with_what = f"with the motions of its {len(hole.strokes)} strokes" if hole.strokes else "with the motion"
    along = "its strokes" if hole.strokes else "the motion"
    yield Picture(png(joint_angles(plan, hole)), f"Joint angles of hole {hole.hole.id} along {along}")
    yield Picture(png(twist_plane(plan, hole)), f"Twist plane of hole {hole.hole.id}, {with_what}")
