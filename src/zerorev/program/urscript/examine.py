"""What URScript asks of a program beyond what every language does."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from itertools import pairwise

import numpy as np

from zerorev.model.finding import Finding
from zerorev.model.job import Settings
from zerorev.program.letters import settled
from zerorev.program.neutral import HoleProgram, Move, Program
from zerorev.program.notes import segments
from zerorev.program.urscript.names import KEPT, URSCRIPT_NAMES
from zerorev.program.urscript.write import FEW_DECIMALS

__all__ = ["MOST_MOVES", "examine", "most_holes"]

MOST_MOVES = 250  # of one file: RoboDK sends longer programs of this controller step by step from a PC
SAME_RATE = 1e-6  # [rad/m] between two moves that are in line


def most_holes(program: Program) -> int | None:
    """How many holes one file may have, at least one."""
    moves = max(len(hole.way) + 1 + len(hole.moves) for hole in program.holes)
    return max(1, MOST_MOVES // moves)


def examine(program: Program) -> tuple[Finding, ...]:
    """The findings of the language; an error among them stops the export."""
    return (
        *(Finding("error", "controller", reason) for reason in _refused(program)),
        *(finding for hole in program.holes for finding in _overlaps(hole)),
        *_blends(program),
        *_payload(program),
    )


def _refused(program: Program) -> Iterator[str]:
    """Settings that URScript has no form for."""
    settings = program.settings
    own = "the program has the values themselves"
    for name, why in (
        ("header", "a URScript file has no header"),
        ("robroot", "points count from the robot's own base, and the controller knows no world"),
        ("external_axes", "a URScript move has six joints"),
        ("tool_number", f"tools have no numbers, and {own} (set_tcp, set_payload)"),
        ("base_number", f"frames have no numbers, and {own}"),
    ):
        if getattr(settings, name) not in (None, ()):
            yield f"{name} cannot be written in URScript: {why}; take it out of the job"
    yield from _calls_refused(settings, program.name)


def _calls_refused(settings: Settings, name: str) -> Iterator[str]:
    own = URSCRIPT_NAMES.of(name)
    for place, calls in settings.calls.places():
        for call in calls:
            if call.name in KEPT:
                yield f"{call.name}, called {place}, is a word of URScript, or moves the robot or changes how it moves"
            elif call.name == own:
                yield f"{call.name}, called {place}, is this program itself"
            elif any("#" in argument for argument in call.arguments):
                yield f"{call}, called {place}: an argument of URScript has no #, which begins a comment"


def _overlaps(hole: HoleProgram) -> tuple[Finding, ...]:
    """Blends at both ends of a move must leave something of it: else the controller leaves the whole move out."""
    begins = (0.0, *(_printed(move.blend) for move in hole.moves))
    for before, move in zip(begins, hole.moves, strict=False):
        if (both := before + _printed(move.blend)) >= move.length:
            message = (
                f"the blends at the ends of a move of {move.length * 1e3:.4g} mm ({move.leg}) take {both * 1e3:.4g} mm "
                "of it: the controller skips such a move, and the hole would not be drilled; a smaller blend_mm, or "
                "the plan made again with controller: urscript"
            )
            return (Finding("error", "controller", message, hole.id),)
    return ()


def _printed(blend: float) -> float:
    return float(settled(blend, FEW_DECIMALS)) if blend > 0 else 0.0


def _blends(program: Program) -> tuple[Finding, ...]:
    """What is not known of movel blends at the feeds of a drill."""
    found, settings = [], program.settings
    if settings.turning.kind == "blend":
        message = (
            "the corner is a blend of two movel: at the feeds of a drill such blends are not to be trusted (a user "
            "measured 10 mm/s of the tip within a blend between moves of 1 mm/s); corner: joint is usual"
        )
        found.append(Finding("warning", "controller", message))
    if bent := [hole.id for hole in program.holes if any(_bends(hole))]:
        at = "at every hole" if len(bent) == len(program.holes) else f"at {len(bent)} of {len(program.holes)} holes"
        message = (
            f"movel blends into movel where the twist rate changes ({at}): how fast and how far the controller blends "
            "there at the feed of a drill is open; legs: straight has no such blend within the stroke"
        )
        found.append(Finding("warning", "controller", message))
    return tuple(found)


def _bends(hole: HoleProgram) -> Iterable[bool]:
    """At each blend between two straight moves that run the same way: whether the twist rate changes there."""
    rates = [((move.psi - psi) / (move.standoff - standoff), move) for standoff, psi, move in segments(hole)]
    return (
        _same_leg(move, after) and move.blend > 0 and abs(rate - rate_after) > SAME_RATE
        for (rate, move), (rate_after, after) in pairwise(rates)
    )


def _same_leg(move: Move, after: Move) -> bool:
    out = ("retract", "depart")
    return move.linear and after.linear and (move.leg in out) == (after.leg in out)


def _payload(program: Program) -> tuple[Finding, ...]:
    if program.tool.load is not None and np.linalg.norm(program.tool.load.com) > 0:
        return ()
    what = "no mass_kg" if program.tool.load is None else "its centre of mass in the flange"
    message = (
        f"the tool {program.tool.name} has {what}: payload and centre of mass must be right on the controller (set_"
        "payload), or the arm sags, and a protective stop may leave the drill in the hole"
    )
    return (Finding("warning", "controller", message),)
