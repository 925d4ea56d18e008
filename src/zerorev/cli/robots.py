"""`zerorev robots`: what ships with zerorev."""

from __future__ import annotations

from zerorev.cli.common import FINE, app
from zerorev.report.words import terminal

__all__ = ["robots"]


@app.command
def robots(name: str | None = None, /, *, json: bool = False) -> int:
    """List the robots that ship with zerorev, or show one: every number, its source, and what to beware of.

    Args:
        name: One of the list, or the path of a robot file.
        json: Print JSON on standard output, and nothing else there.
    """
    from zerorev.files.io import read_robot, robot_names
    from zerorev.report.words import tables

    found = [read_robot(each) for each in ([name] if name else robot_names())]
    if json:
        sheets = [tables.robot_sheet(robot) for robot in found]
        terminal.print_json(sheets[0] if name else sheets)
    elif name:
        terminal.out().print(tables.robot_heading(found[0]), tables.robot_table(found[0]), sep="\n")
        terminal.print_lines(tables.robot_lines(found[0]))
    else:
        terminal.out().print(tables.robots_table(found))
        if note := tables.robots_note(found):
            terminal.out().print(note)
    return FINE
