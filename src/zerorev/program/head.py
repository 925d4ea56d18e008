"""The comment block of a program: what an operator should read before pressing start, in any language."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np

from zerorev.model.finding import Finding
from zerorev.program.letters import Comments, fixed
from zerorev.program.names import LONGEST_ID, label
from zerorev.program.neutral import HoleProgram, Program
from zerorev.program.plan_mark import MARK

__all__ = ["about", "head", "listed", "mark", "part_head"]


def head(
    program: Program, findings: tuple[Finding, ...], version: str, comments: Comments, sentences: Sequence[str]
) -> list[str]:
    """The comment block.

    Args:
        program: which.
        findings: stated in it.
        version: of zerorev.
        comments: of the language.
        sentences: what has to be known before it is started.
    """
    settings = program.settings
    spindle = "not given" if settings.spindle_rpm is None else f"{settings.spindle_rpm:g} rev/min"
    deepened = ", corner placed deeper by the depth lost to the blend" if settings.deepen_corner else ""
    reversals = sum(sum(hole.reversals_per_joint) for hole in program.holes)
    facts = (
        ("Plan      ", program.name),
        ("Robot     ", f"{program.robot.manufacturer} {program.robot.model} ({program.robot.name})"),
        ("Tool      ", program.tool.name),
        ("Feeds     ", f"plunge {settings.feed_plunge * 1e3:g} mm/s, retract {settings.feed_retract * 1e3:g} mm/s"),
        ("Spindle   ", spindle),
        ("Blend     ", f"{_blend(program)} at the target{deepened}"),
        ("Holes     ", f"{len(program.holes)}, with {reversals} joint reversals in all"),
    )
    ids = {hole.id for hole in program.holes} | {finding.hole for finding in findings if finding.hole is not None}
    lines = [comments.rule, *comments.lines(f"Written by zerorev {version}"), *mark(program, comments)]
    for first, text in facts:
        lines += comments.lines(text, first=first, longest=3 * LONGEST_ID)
    for finding in findings:
        at = f"hole {label(finding.hole, comments)}: " if finding.hole is not None else ""
        message = at + _with_labels(finding.message, ids, comments)
        lines += comments.lines(message, first=f"{finding.level}: ".ljust(10))
    return [*lines, comments.sign, *listed(sentences, comments), comments.rule]


def part_head(program: Program, title: str, version: str, comments: Comments, sentences: Sequence[str]) -> list[str]:
    """The block of a part, which is started by the program and says of itself only what has to be known there.

    Args:
        program: of which it is a part.
        title: which part.
        version: of zerorev.
        comments: of the language.
        sentences: what has to be known before it is started.
    """
    return [
        comments.rule,
        *comments.lines(f"Written by zerorev {version}"),
        *mark(program, comments),
        *comments.lines(title),
        comments.sign,
        *listed(sentences, comments),
        comments.rule,
    ]


def mark(program: Program, comments: Comments) -> list[str]:
    """Whose program this is, as `plan_mark` finds it again."""
    return comments.lines(f"{program.mark} {program.plan_file}", first=MARK) if program.plan_file else []


def about(hole: HoleProgram, joint_names: Sequence[str], comments: Comments) -> list[str]:
    """What is said of one hole: its stroke, its reversals, and the points of its moves.

    Args:
        hole: which.
        joint_names: as the controller shows them.
        comments: of the language.
    """
    places = [(hole.start.standoff, hole.start.psi), *((move.standoff, move.psi) for move in hole.moves)]
    standoff = " ".join(fixed(s * 1e3, 3) for s, _ in places)
    psi = " ".join(fixed(np.rad2deg(p)) for _, p in places)
    reversals = " ".join(f"{count:d}" for count in hole.reversals_per_joint)
    stroke = f"stroke {fixed(hole.depth * 1e3, 3)} mm, lead-in {fixed(hole.lead_in * 1e3, 3)} mm"
    if hole.corner_move.wait > 0:
        stroke += f", stands at the target for {hole.corner_move.wait:.2f} s"
    return [
        *comments.lines(f"{stroke}, reversals of {joint_names[0]} to {joint_names[-1]}: {reversals}"),
        *comments.lines(f"stand-off [mm] {standoff}"),
        *comments.lines(f"psi [deg] {psi}"),
    ]


def _blend(program: Program) -> str:
    settings = program.settings
    kind = settings.turning.kind
    if kind in ("joint", "spin"):
        spins = ", on some of which the tool spins on" if kind == "spin" else ""
        return f"joint moves from {settings.turning.reach * 1e3:g} mm or less{spins}"
    return f"{settings.blend * 1e3:g} mm" if kind == "blend" else "none: exact stop"


def listed(sentences: Sequence[str], comments: Comments) -> list[str]:
    """Sentences one below the other, each with a dash."""
    return [line for text in sentences for line in comments.lines(text, first="- ")]


def _with_labels(message: str, ids: Iterable[str], comments: Comments) -> str:
    """A message with ids that a comment cannot have as they are called as elsewhere in the program."""
    for hole_id in sorted(ids, key=len, reverse=True):
        if (called := label(hole_id, comments)) != hole_id:
            message = message.replace(hole_id, called)
    return message
