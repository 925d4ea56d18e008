"""`zerorev robots`: what ships with zerorev."""

from __future__ import annotations

import math
from pathlib import Path

from zerorev.cli.common import FINE, check_outputs, need, robots_app
from zerorev.errors import InputError
from zerorev.report.words import terminal

__all__ = ["robots"]


@robots_app.default
def robots(
    name: str | None = None,
    /,
    *,
    maker: str | None = None,
    reach_mm: str | None = None,
    payload_kg: str | None = None,
    figure: Path | None = None,
    json: bool = False,
) -> int:
    """List the robots that ship with zerorev, or show one: every number, its source, and what to beware of.

    Args:
        name: One of the list, or the path of a robot file.
        maker: Those of one maker, e.g. KUKA.
        reach_mm: Those whose wrist reaches so far from axis 1, FROM:TO in mm; either end may be left out, e.g. 2000:
        payload_kg: Those rated for such a load, FROM:TO in kg; those whose load is not known are left out.
        figure: Picture to draw (PNG): load against reach.
        json: Print JSON on standard output, and nothing else there.
    """
    from zerorev.files.io import read_robot, robot_names
    from zerorev.report.words import tables

    check_outputs([figure])
    if figure is not None:
        need("matplotlib", "matplotlib", "--figure", "figures")
    reach, load = _range(reach_mm, "--reach-mm"), _range(payload_kg, "--payload-kg")
    found = [read_robot(each) for each in ([name] if name else robot_names())]
    asked = [robot for robot in found if maker is None or robot.manufacturer.lower() == maker.lower()]
    asked = [robot for robot in asked if reach is None or reach[0] <= robot.wrist_reach * 1e3 <= reach[1]]
    unknown = [robot for robot in asked if load is not None and robot.rated_load is None]
    if load is not None:
        asked = [robot for robot in asked if robot.rated_load is not None and load[0] <= robot.rated_load <= load[1]]
    if figure is not None:
        from zerorev.files.output import write_bytes
        from zerorev.report.figures.catalogue import robot_catalogue
        from zerorev.report.figures.style import png

        write_bytes(figure, png(robot_catalogue(asked)))
    if json:
        sheets = [tables.robot_sheet(robot) for robot in asked]
        terminal.print_json(sheets[0] if name and sheets else sheets)
    elif name and asked:
        terminal.out().print(tables.robot_heading(asked[0]), tables.robot_table(asked[0]), sep="\n")
        terminal.print_lines(tables.robot_lines(asked[0]))
    else:
        terminal.out().print(tables.robots_table(asked))
        if note := tables.robots_note(asked):
            terminal.out().print(note)
        if len(asked) < len(found):
            terminal.say(f"{len(asked)} of {len(found)} robots")
    if unknown:
        terminal.note(f"the rated load of {len(unknown)} more is not known: {', '.join(each.name for each in unknown)}")
    return FINE


def _range(text: str | None, where: str) -> tuple[float, float] | None:
    if text is None:
        return None
    ends = text.split(":")
    try:
        lower, upper = (float(end) if end.strip() else None for end in ends)
    except ValueError:
        raise InputError(f"is '{text}'", where=where, accepted="FROM:TO, e.g. 100:200, 100: or :200") from None
    return (-math.inf if lower is None else lower), (math.inf if upper is None else upper)
