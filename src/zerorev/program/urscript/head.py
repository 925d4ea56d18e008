"""The comment block of a URScript program: what an operator should read before pressing play."""

from __future__ import annotations

from collections.abc import Iterator

from zerorev.model.controller import Calls
from zerorev.program.neutral import Program

__all__ = ["AXES", "sentences"]

AXES = ("base", "shoulder", "elbow", "wrist 1", "wrist 2", "wrist 3")

FIRST_RUN = (
    "Run it in simulation on the pendant first. Then in manual mode, the speed slider low, a hand on the enabling "
    "device or the emergency stop, the spindle off and no part in place.",
    "movej moves without a time are checked against the surface of the part alone, and the first one not at all: not "
    "for fixtures, the cell or the arm's own links.",
)
AFTERWARDS = (
    "Tool, part frame and speeds are set from the top on: always start from there.",
    "The feeds hold at 100 percent of the speed slider. A limit of the safety configuration that binds (reduced mode, "
    "speed, power) slows or stops the robot with the drill in the material: compare them before.",
    "A protective stop, an emergency stop, stopj and the end of the program leave the drill in the hole. Pull it out "
    "along its own axis (tool Z: Move tab, feature Tool) before a new start: every hole begins with a movej. Freedrive "
    "does not keep the axis.",
)
OPEN = (
    "Open, not tried on a controller: how fast and how far a movel or movej blends at the feeds of a drill, also where "
    "one passes into the other, whether a blended movej keeps its time, and so what depth the corner loses. Drill in "
    "air and measure first.",
)
FRAMES = (
    "The tool has Z along the plunge. Points stand in the part frame (part), which is given from the controller's "
    "base; joints in radians from base to wrist 3. No movel turns the tool by more than 120 deg: the short way round "
    "is meant.",
)


def sentences(program: Program, name: str, parts: tuple[str, ...] = ()) -> tuple[str, ...]:
    """What has to be known before the program, or a part of it, is started.

    Args:
        program: which.
        name: of the function that is started.
        parts: names of the functions that it calls.
    """
    return (*_start(name, parts), *FIRST_RUN, *_not_set(program), *AFTERWARDS, *OPEN, *FRAMES)


def _start(name: str, parts: tuple[str, ...]) -> Iterator[str]:
    files = ", ".join(f"{each}.script" for each in (*parts, name))
    nodes = f"Script nodes with the files {files}, in this order" if parts else f"a Script node with the file {files}"
    yield (
        f"On the pendant: {nodes}, and after them a Script line {name}(). The program on the pendant must have another "
        "name."
    )


def _not_set(program: Program) -> Iterator[str]:
    payload = "Spindle and coolant" if program.tool.load is not None else "Spindle, coolant and payload"
    by_calls = "" if program.settings.calls == Calls() else ", but by the calls that the job states"
    yield f"{payload} are not set here{by_calls}. The spindle must run before the drill enters."
