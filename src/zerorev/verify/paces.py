"""Are the feeds of a program the job's, its times those of a dwell, and does the tool wait nowhere else."""

from __future__ import annotations

from collections.abc import Iterator
from decimal import Decimal

import numpy as np

from zerorev.model._arrays import Array
from zerorev.model.plan import Corner
from zerorev.model.robot import Robot
from zerorev.model.settings import Settings
from zerorev.model.written import WrittenFrame, WrittenHole, WrittenJoints
from zerorev.verify.printed import angle_slack, half_a_unit, joints_of, length_slack

__all__ = ["paces_differ", "spins_differ", "waits_differ"]

PLACE = 1e-5  # [m]: on which side of a place a move lies
FEED = 1e-6  # [m/s]: six decimals
TIME = 1e-5  # relative, of a time that is computed from angles
WAIT = 1e-9  # [s]: a dwell is in hundredths, which every language prints
TIP = {"m/s": 1.0, "cm/min": 1e-2 / 60}  # [m/s]: units in which the speed of the tip is given


def paces_differ(
    settings: Settings, robot: Robot, written: WrittenHole, standoff: Array, inwards: range, spins: range
) -> Iterator[str]:
    """Feeds must be the job's; of a move that has a time, what comes of that.

    Args:
        settings: of the hole.
        robot: the arm.
        written: the moves.
        standoff: of their points [m], shape (n,).
        inwards: the moves at the feed of the way in.
        spins: those on which the tool spins on, which have none.
    """
    for k, move in enumerate(written.moves):
        if k in spins:
            continue
        feed = settings.feed_plunge if k in inwards else settings.feed_retract
        outer = max(float(standoff[k]), float(standoff[k + 1]))
        if k in inwards and settings.breakthrough_feed is not None:
            feed = settings.breakthrough_feed if outer <= settings.breakthrough_length + PLACE else feed
        value, unit = move.pace
        if (one := TIP.get(unit)) is not None:
            found, slack = float(value) * one, FEED + half_a_unit(value) * one
        else:
            # of a time, the digits of its last place, and of both ends
            ends = (written.start if k == 0 else written.moves[k - 1].end), move.end
            time, open_ = _time_by_share(robot, *ends, value) if unit == "%" else (value, half_a_unit(value))
            time = max(float(time), 1e-9)
            found = abs(float(standoff[k + 1] - standoff[k])) / time
            apart = sum(length_slack(robot, end) for end in ends)
            slack = FEED + (found * open_ + apart) / time
        if abs(found - feed) > slack:
            yield f"line {move.line} has a feed of {found * 1e3:g} mm/s, the plan {feed * 1e3:g} mm/s"


def spins_differ(robot: Robot, written: WrittenHole, spins: range, corner: Corner) -> Iterator[str]:
    """The moves on which the tool spins on must be joint moves, and take the time of the dwell, each the same.

    Args:
        robot: the arm.
        written: the moves.
        spins: which of them.
        corner: as planned.
    """
    wanted = (corner.dwell or 0.0) / len(spins)
    for k in spins:
        move, before = written.moves[k], written.start if k == 0 else written.moves[k - 1].end
        value, unit = move.pace
        if move.linear or unit not in ("s", "%"):
            yield f"line {move.line} is a straight move, or has no time, where the tool is to spin on"
            continue
        time, open_ = _time_by_share(robot, before, move.end, value) if unit == "%" else (value, half_a_unit(value))
        if abs(float(time) - wanted) > open_ + WAIT + TIME * wanted:
            yield f"line {move.line} takes {float(time):.4g} s, on which the tool is to spin on for {wanted:.4g} s"


def waits_differ(written: WrittenHole, corner: int, dwell: float) -> Iterator[str]:
    """The tool must stand at the corner as long as asked for, and nowhere else.

    Args:
        written: the moves.
        corner: how many of them lead there.
        dwell: as asked for [s].
    """
    for k, move in enumerate(written.moves, start=1):
        asked = dwell if k == corner else 0.0
        if abs(float(move.wait) - asked) > WAIT:
            yield f"line {move.line}: the tool stands at its end for {move.wait:f} s, the plan says {asked:g} s"


def _time_by_share(
    robot: Robot, begin: WrittenFrame | WrittenJoints, end: WrittenFrame | WrittenJoints, share: Decimal
) -> tuple[float, float]:
    """The time of a joint move by a share of what the joints can [%], and what its digits leave open of it [s].

    The joint that would need longest at its full speed sets the time.
    """
    assert isinstance(begin, WrittenJoints)
    assert isinstance(end, WrittenJoints)
    turned = np.abs(joints_of(robot, end) - joints_of(robot, begin)) / robot.limits.speed
    rounded = sum(angle_slack(robot, each) for each in (begin, end)) / float(robot.limits.speed.min())
    of_all = max(float(share), 1e-9) / 100
    time = float(turned.max()) / of_all
    return time, rounded / of_all + time * half_a_unit(share) / max(float(share), 1e-9)
