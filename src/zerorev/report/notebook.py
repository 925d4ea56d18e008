"""Plans and depths as a notebook shows them: a table, the findings, one picture.

All of it is text of unknown origin (ids come from the user's files), so every piece of it is made visible and escaped.
"""

from __future__ import annotations

import base64
import html
from collections.abc import Iterable, Iterator, Sequence
from importlib.util import find_spec

import numpy as np

from zerorev.model._arrays import Array
from zerorev.model.finding import Finding
from zerorev.model.plan import HolePlan, Plan
from zerorev.report.words.hole_rows import hole_row
from zerorev.report.words.lost_motion import HEADING, PREDICTED, WHERE_IT_HOLDS, lost_motion_cell
from zerorev.report.words.tables import (
    NO_BASELINE,
    finding_lines,
    hole_check,
    hole_findings,
    no_baseline,
    reversals_cell,
    stroke_lines,
)
from zerorev.visible import one_line

__all__ = ["ROWS", "html_of"]

ROWS = 20  # of the table; more holes are counted
COLUMNS = (
    "hole",
    "depth [mm]",
    "reversals<br>baseline → plan",
    "travel [deg]",
    "margin [mm]",
    "deepest [mm]",
    "verified",
)
LOST = HEADING.replace("\n", "<br>")  # fmt: skip
RIGHT, LEFT = "text-align: right", "text-align: left"
PICTURE = "max-width: 100%; width: 800px; background: white"


def html_of(answer: Plan | HolePlan) -> str:
    """The HTML of a plan (or of depths) or of one hole of it.

    A plan shows the joints of its first hole, tool by tool. A hole alone does not know its robot: it shows its spin.

    Args:
        answer: a plan, of which the first holes are shown, or the plan of a hole.
    """
    if isinstance(answer, HolePlan):
        return _div(_table([answer], np.eye(4)), _findings(hole_findings(answer)), _spin(answer))
    tools = answer.of_all_tools
    return _div(*(_of_tool(each, n if len(tools) > 1 else None) for n, each in enumerate(tools, 1)))


def _of_tool(answer: Plan, number: int | None) -> str:
    """What one tool does, with its number where there are several."""
    found = [*answer.findings, *(finding for hole in answer.holes for finding in hole_findings(hole))]
    robot = f"{answer.robot.manufacturer} {answer.robot.model}".strip() or answer.robot.name
    kind = "plan" if answer.strokes == "asked" else "depths"
    count = f"{len(answer.holes):,} hole{'' if len(answer.holes) == 1 else 's'}"
    tool = f"{'' if number is None else f'tool {number}: '}{_text(answer.tool.name)}"
    heading = f"<p><b>{_text(answer.name)}</b>: {kind} of {count}, {_text(robot)}, {tool}</p>"
    return _div(heading, _table(answer.holes, answer.T_base_part), _findings(found), _joints(answer))


def _table(holes: Sequence[HolePlan], T_base_part: Array) -> str:
    weighed = any(hole.lost_motion is not None for hole in holes[:ROWS])
    columns = (*COLUMNS[:-1], *([LOST] if weighed else []), COLUMNS[-1])
    head = "".join(f'<th style="{RIGHT if n else LEFT}">{column}</th>' for n, column in enumerate(columns))
    rows = "".join(
        "<tr>" + "".join(f'<td style="{RIGHT if n else LEFT}">{_text(cell)}</td>' for n, cell in enumerate(cells))
        + "</tr>"
        for cells in (cells for hole in holes[:ROWS] for cells in _lines(hole, T_base_part, weighed=weighed))
    )  # fmt: skip
    more = f"<p>and {len(holes) - ROWS:,} more</p>" if len(holes) > ROWS else ""
    said = f"<p>Lost motion: {_text(PREDICTED)}. {_text(WHERE_IT_HOLDS)}</p>" if weighed else ""
    legend = f"<p>{_text(NO_BASELINE)}</p>" if no_baseline(holes[:ROWS]) else ""
    return f"<table><thead><tr>{head}</tr></thead><tbody>{rows}</tbody></table>{more}{legend}{said}"


def _lines(hole: HolePlan, T_base_part: Array, *, weighed: bool) -> Iterator[Iterable[str]]:
    """The cells of a hole, then of each of its strokes, where there are several."""
    for name, answer, in_air in [(hole.hole.id, hole, 0), *stroke_lines(hole)]:
        yield _cells(name, answer, T_base_part, in_air, weighed=weighed)


def _cells(name: str, hole: HolePlan, T_base_part: Array, in_air: int, *, weighed: bool) -> Iterable[str]:
    row = hole_row(hole.hole, hole, T_base_part)
    deepest = None if hole.deepest is None else hole.deepest * 1e3
    yield name
    yield f"{row.depth:g}"
    yield "infeasible" if row.after is None else reversals_cell(hole, in_air)
    yield from ("–" if value is None else f"{value:.1f}" for value in (row.travel, row.margin, deepest))
    if weighed:
        yield lost_motion_cell(hole.lost_motion)
    yield "–" if row.after is None else hole_check(hole).plain


def _findings(found: Iterable[Finding]) -> str:
    lines = "\n".join(_text(line.plain) for line in finding_lines(found))
    return f'<pre style="white-space: pre-wrap; {LEFT}">{lines}</pre>' if lines else ""


def _joints(plan: Plan) -> str:
    """The joints of the first hole that has a motion, where matplotlib is there to draw them."""
    first = next((hole for hole in plan.holes if hole.motion is not None), None)
    if first is None or find_spec("matplotlib") is None:
        return ""
    from zerorev.report.figures.joints import joint_angles
    from zerorev.report.figures.style import png

    return _image(png(joint_angles(plan, first)), f"Joint angles of hole {first.hole.id} along the motion")


def _spin(hole: HolePlan) -> str:
    """The spin of a hole that has a motion, likewise."""
    if hole.motion is None or find_spec("matplotlib") is None:
        return ""
    from zerorev.report.figures.spin import spin_profile
    from zerorev.report.figures.style import png

    return _image(png(spin_profile(hole)), f"Spin of hole {hole.hole.id} along the motion")


def _image(picture: bytes, words: str) -> str:
    data = base64.b64encode(picture).decode("ascii")
    return f'<img src="data:image/png;base64,{data}" alt="{_text(words)}" style="{PICTURE}">'


def _div(*parts: str) -> str:
    return f"<div>{''.join(parts)}</div>"


def _text(text: str) -> str:
    return html.escape(one_line(text))
