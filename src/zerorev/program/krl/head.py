"""The comment block of a KRL program: what an operator should read before pressing start."""

from __future__ import annotations

from collections.abc import Iterable

from zerorev.model.finding import Finding
from zerorev.program.krl.controller import not_set
from zerorev.program.krl.names import LONGEST_ID, label
from zerorev.program.krl.text import comment
from zerorev.program.neutral import Program
from zerorev.program.plan_mark import MARK

__all__ = ["RULE", "head", "mark", "part_head"]

RULE = "; " + "-" * 98

SAFETY = (
    "Run the program in T1 first, the spindle off and no part in place.",
    "PTP moves are checked against the surface of the part alone, and the first one not at all: not for fixtures, "
    "the cell or the arm's own links.",
    "$TOOL, $BASE and the speeds are set at the top: after a reset do not start from a line further down.",
    "After a stop in a hole pull the drill out along the drill axis (tool X) before a new start: a PTP comes first.",
)

FRAMES = (
    "$TOOL has X along the plunge, so A and B are constant along a hole and only C varies: it falls by as much as psi "
    "grows. C is written within (-180, 180]. No LIN turns the tool by more than 120 deg: the short way round is meant.",
)


def head(program: Program, findings: tuple[Finding, ...], version: str) -> list[str]:
    """The comment block: what an operator should read before pressing start."""
    settings = program.settings
    spindle = "not given" if settings.spindle_rpm is None else f"{settings.spindle_rpm:g} rev/min"
    blend = f"{settings.corner_blend * 1e3:g} mm" if settings.corner_blend > 0 else "none: exact stop"
    deepened = ", corner placed deeper by the depth lost to the blend" if settings.deepen_corner else ""
    reversals = sum(sum(hole.reversals_per_joint) for hole in program.holes)
    facts = (
        ("Plan      ", program.name),
        ("Robot     ", f"{program.robot.manufacturer} {program.robot.model} ({program.robot.name})"),
        ("Tool      ", program.tool.name),
        ("Feeds     ", f"plunge {settings.feed_plunge * 1e3:g} mm/s, retract {settings.feed_retract * 1e3:g} mm/s"),
        ("Spindle   ", spindle),
        ("Blend     ", f"{blend} at the target{deepened}"),
        ("Holes     ", f"{len(program.holes)}, with {reversals} joint reversals in all"),
    )
    ids = {hole.id for hole in program.holes} | {finding.hole for finding in findings if finding.hole is not None}
    lines = [RULE, *comment(f"Written by zerorev {version}"), *mark(program)]
    for first, text in facts:
        lines += comment(text, first=first, longest=3 * LONGEST_ID)
    for finding in findings:
        at = f"hole {label(finding.hole)}: " if finding.hole is not None else ""
        lines += comment(at + _with_labels(finding.message, ids), first=f"{finding.level}: ".ljust(10))
    return [*lines, ";", *_sentences(program), RULE]


def part_head(program: Program, title: str, version: str) -> list[str]:
    """The block of a part, which is started by the program and says of itself only what has to be known there.

    Args:
        program: of which it is a part.
        title: which part.
        version: of zerorev.
    """
    return [
        RULE,
        *comment(f"Written by zerorev {version}"),
        *mark(program),
        *comment(title),
        ";",
        *_sentences(program),
        RULE,
    ]


def _sentences(program: Program) -> list[str]:
    return [
        line
        for text in (*SAFETY[:2], *not_set(program.settings), *SAFETY[2:], *FRAMES)
        for line in comment(text, first="- ")
    ]


def mark(program: Program) -> list[str]:
    """Whose program this is, as `plan_mark` finds it again."""
    return comment(f"{program.mark} {program.plan_file}", first=MARK) if program.plan_file else []


def _with_labels(message: str, ids: Iterable[str]) -> str:
    """A message with ids that a comment cannot have as they are called as elsewhere in the program."""
    for hole_id in sorted(ids, key=len, reverse=True):
        if (called := label(hole_id)) != hole_id:
            message = message.replace(hole_id, called)
    return message
