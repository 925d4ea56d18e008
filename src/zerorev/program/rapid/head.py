"""The comment block of a RAPID program: what an operator should read before pressing start."""

from __future__ import annotations

from collections.abc import Iterator

from zerorev.program.neutral import Program
from zerorev.program.rapid.controller import not_set
from zerorev.program.rapid.names import part_frame, procedure, tool

__all__ = ["CORNERS", "sentences"]

CORNERS = {
    "joint": "At the target MoveL hands over to two MoveAbsJ, which meet in a zone: no joint has to stop there or turn "
    "round. Open: that none stops has not been seen on a controller. Watch the joints, and the event log (50024, "
    "corner path failure: a zone became a stop).",
    "spin": "At the target MoveL hands over to MoveAbsJ, on some of which the tool spins on; they meet in zones, so "
    "that no joint has to rest there. Open: that none stops has not been seen on a controller, and zones so small may "
    "be taken for stops. Watch the joints, and the event log (50024, corner path failure: a zone became a stop).",
    "blend": "At the target two MoveL, straight in and straight back, meet in a zone. Open: whether a controller takes "
    "that without a stop of all joints, and how deep. Try it in RobotStudio first; corner: joint avoids it.",
    "stop": "At the target there is an exact stop: all joints rest there, which is what the method is to avoid.",
}


def sentences(program: Program, name: str) -> Iterator[str]:
    """What has to be known before the program, or a part of it, is started."""
    yield "Run the program in manual mode at reduced speed first, the spindle off and no part in place."
    yield (
        "MoveAbsJ between holes are checked against the surface of the part alone, and the first one not at all: not "
        "for fixtures, the cell or the arm's own links."
    )
    yield from not_set(program.settings)
    yield (
        f"Start at the first line of {procedure(name)}, by a call or with the program pointer there; never from a line "
        "further down: what is set at the top holds for all."
    )
    yield (
        f"After a stop in a hole jog the drill out along its axis, Z of {tool(name)}, before a new start: a MoveAbsJ "
        "comes first. If the controller then asks to regain the path, do not: move the program pointer."
    )
    yield CORNERS[program.settings.turning.kind]
    yield (
        f"{tool(name)} has Z along the plunge and holds what the tool weighs; {part_frame(name)} is the part frame. Do "
        "not correct it by hand for a part that was measured again: joint targets would stay where they are."
    )
    yield (
        "Do not put z0, z1 or the like in the place of the zones: theirs are larger for the turn of the tool than for "
        "its tip, and bring reversals back."
    )
    yield (
        "ConfL is off: a straight move continues in the posture that it begins in. Of a configuration's last number "
        "the middle bit (wrist centre behind the lower arm) has not been compared with a controller."
    )
