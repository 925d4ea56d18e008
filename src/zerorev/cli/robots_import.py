"""`zerorev robots import`: a robot file out of a robot description or a table of link parameters."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from zerorev.cli.common import FINE, Output, check_outputs, robots_app
from zerorev.errors import InputError
from zerorev.report.words import terminal

__all__ = ["import_"]

Many = Annotated[tuple[str, ...], Parameter(allow_leading_hyphen=True, negative=())]


@robots_app.command(name="import")
def import_(
    file: Path,
    /,
    *,
    tip: str | None = None,
    name: str | None = None,
    manufacturer: str = "",
    limit: Many = (),
    argument: Many = (),
    output: Output = None,
) -> int:
    """Make a robot file of a URDF, a xacro file (extra `xacro`) or a table of link parameters.

    The robot is compared with the file at 200 random joint angles; an arm that is not of the class is refused, with
    each condition that fails and by how much.

    Args:
        file: URDF (.urdf, .xml), xacro (.xacro), or link parameters (.yaml, format zerorev.dh/1:
            docs/howto/own_robot.md). A xacro file may hold expressions of Python, which are evaluated: import your own.
        tip: The link in which the controller counts its tools, where it is not the one that is chosen.
        name: How jobs call the robot; by default as the file does.
        manufacturer: Who makes it (KUKA, ABB, FANUC, Yaskawa, ...), which decides the language of its programs.
        limit: JOINT=LOWER:UPPER:SPEED in deg and deg/s, where the file states none, or others; once a joint.
        argument: NAME=VALUE of a xacro file; once an argument.
        output: Where to write the robot file (YAML); by default it is printed.
    """
    from zerorev.files.output import write_text
    from zerorev.motion.from_axes import EQUAL
    from zerorev.motion.importing import import_robot, robot_file

    check_outputs([output], file)
    limits = {joint: _limit(numbers) for joint, numbers in _pairs(limit, "--limit", "JOINT=LOWER:UPPER:SPEED")}
    found = import_robot(
        file, tip=tip, name=name, manufacturer=manufacturer, limits=limits,
        arguments=dict(_pairs(argument, "--argument", "NAME=VALUE")),
    )  # fmt: skip
    text = robot_file(found.robot)
    if output is None:
        terminal.print_plain(text)
    else:
        write_text(output, text)
    for note in found.notes:
        terminal.note(note)
    where = "" if output is None else f", written to {output}"
    terminal.say(f"{found.robot.name}: equal to {file.name} within {EQUAL:g} m at 200 random joint angles{where}")
    return FINE


def _pairs(given: Sequence[str], where: str, accepted: str) -> list[tuple[str, str]]:
    pairs = [tuple(each.split("=", 1)) for each in given]
    for pair in pairs:
        if len(pair) != 2 or not all(pair):
            raise InputError(f"is '{'='.join(pair)}'", where=where, accepted=accepted)
    return [(pair[0], pair[1]) for pair in pairs]


def _limit(text: str) -> tuple[float | None, float | None, float | None]:
    parts = [part.strip() for part in text.split(":")]
    try:
        numbers = [float(part) if part else None for part in parts]
    except ValueError:
        numbers = []
    if not 2 <= len(numbers) <= 3:
        raise InputError(f"is '{text}'", where="--limit", accepted="LOWER:UPPER or LOWER:UPPER:SPEED, in deg and deg/s")
    lower, upper, speed = (*numbers, None)[:3]
    return lower, upper, speed
