"""What INFORM asks of a program beyond what all languages do: settings, digits of speeds, whole pulses."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from zerorev.model.finding import Finding
from zerorev.program.inform.needs import cannot_say, needs, too_slow
from zerorev.program.inform.rounded import rounded
from zerorev.program.inform.text import feed_written, feeds_of, joint_moves, share_written
from zerorev.program.neutral import Program
from zerorev.program.rounding import listed_joints

__all__ = ["examine"]

FEED_OFF = 1e-3  # relative: a feed that is nearer is not worth a word
FAR_OFF = 0.1  # relative: a feed beyond this is a warning


def examine(program: Program) -> tuple[Finding, ...]:
    """Findings; an error among them stops the export."""
    errors = [*needs(program), *cannot_say(program)]
    slow = list(too_slow(program))
    found = [Finding("error", "controller", each) for each in errors]
    found += [Finding("error", "printable", each) for each in slow]
    if not slow:
        found += [*_feeds(program), *_corner_feeds(program)]
    if program.robot.pulses_per_deg is not None:
        found += _pulses(program)
    return tuple(found)


def _feeds(program: Program) -> Iterator[Finding]:
    """Feeds of the straight moves, which have one decimal of a mm/s."""
    for leg, feed in feeds_of(program):
        written = float(feed_written(feed))
        off = written / (feed * 1e3) - 1
        if abs(off) > FEED_OFF:
            message = (
                f"the feed of the {leg} is {written:g} mm/s instead of {feed * 1e3:g} ({off:+.1%}): V= has one decimal"
            )
            yield Finding("warning" if abs(off) > FAR_OFF else "info", "controller", message)


def _corner_feeds(program: Program) -> Iterator[Finding]:
    """The feed of the joint moves, which comes of a share of what the joints can, with two decimals."""
    offs = [
        (float(share_written(share)) / share - 1, move, hole)
        for hole in program.holes
        for move, share in joint_moves(program.robot, hole)
    ]
    if not offs:
        return
    off, move, hole = max(offs, key=lambda each: abs(each[0]))
    if abs(off) > FAR_OFF:
        count = sum(abs(each[0]) > FAR_OFF for each in offs)
        message = (
            f"{count:,} joint moves at the corner have a feed that is more than {FAR_OFF:.0%} off, since VJ= has two "
            f"decimals: in the {move.leg} of hole {hole.id} {move.feed * (1 + off) * 1e3:.3g} mm/s instead of "
            f"{move.feed * 1e3:g}; a greater feed_mm_s, or corner: stop"
        )
        yield Finding("warning", "controller", message)


def _pulses(program: Program) -> Iterator[Finding]:
    """Where whole pulses bring the drill, and what they do to slow joints."""
    names = program.robot.joint_names
    holes = [(rounded(program, hole), hole) for hole in program.holes]
    off, tilt = max(each.off_axis for each, _ in holes), max(each.tilt for each, _ in holes)
    along = max(each.along for each, _ in holes)
    yield Finding(
        "info",
        "controller",
        f"positions are whole pulses: points lie up to {off * 1e6:.1f} um beside the drill axis and up to "
        f"{along * 1e6:.1f} um deeper or less deep than planned, the drill up to {np.rad2deg(tilt):.4f} deg tilted",
    )
    turned = [(each.reversals > np.array(hole.reversals_per_joint), hole.id) for each, hole in holes]
    yield from listed_joints(
        names,
        turned,
        "in whole pulses {which} would turn back where the plan does not, since a joint moves too little there, and "
        "the program cannot be certified. A greater min_rate_deg_per_mm, or a greater blend_mm with longer joint moves",
    )
    yield from listed_joints(
        names,
        [(each.standing & ~more, hole_id) for (each, _), (more, hole_id) in zip(holes, turned, strict=True)],
        "{which} moves by less than a pulse on a joint move at the corner and stands there: no reversal, but the "
        "program cannot be certified. A greater min_rate_deg_per_mm or blend_mm",
    )
