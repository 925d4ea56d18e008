"""What an INFORM job cannot do without, or cannot say: each reason is one sentence with the cure."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from zerorev.errors import NotExportableError
from zerorev.model.corner import CONTROLLERS
from zerorev.program.inform.text import SHARES, SLOWEST, feed_written, feeds_of, joint_moves, share_written
from zerorev.program.neutral import Program

__all__ = ["cannot_say", "needs", "refuse_calls", "refuse_unwritable", "too_slow"]


def needs(program: Program) -> Iterator[str]:
    """Why no job can be written of a program."""
    robot, settings = program.robot, program.settings
    if robot.pulses_per_deg is None:
        yield (
            f"the pulses per degree of {robot.name} are not known, and an INFORM job has its positions in pulses: put "
            "pulses_per_deg into the robot's file, six numbers with their signs from the parameters of your controller "
            "(RC in ALL.PRM of a backup), or from pulses and angles that the pendant shows in two postures"
        )
    if settings.tool_number is None:
        yield "an INFORM job names its tool by number: put tool_number into the job, the number on the controller"
    for place, calls in settings.calls.places():
        for call in calls:
            if call.arguments:
                yield f"{call}, called {place}, has arguments, which CALL JOB does not take: call a job that needs none"


def cannot_say(program: Program) -> Iterator[str]:
    """Which settings have no place in a job of pulses, and the corner of a plan that was made for no controller."""
    settings = program.settings
    kind = settings.turning.kind
    if why := CONTROLLERS["inform"].refused.get(kind):
        yield f"the plan has a corner of kind {kind}: {why}. Plan again with controller: inform"
    for what, given, why in (
        ("header", settings.header, "lines that begin with & are KUKA's"),
        ("external_axes", settings.external_axes, "external axes are not written in INFORM"),
        ("robroot", settings.robroot, "positions are pulses of the axes, for which it does not matter"),
        ("base_number", settings.base_number, "positions are pulses of the axes, in no frame"),
    ):
        if given not in (None, ()):
            yield f"{what} has no place in an INFORM job ({why}): leave it out"


def too_slow(program: Program) -> Iterator[str]:
    """Which speeds come out as nothing in the digits that a job has."""
    for leg, feed in feeds_of(program):
        if float(feed_written(feed)) <= 0:
            yield (
                f"the feed of the {leg}, {feed * 1e3:g} mm/s, rounds to zero: V= has one decimal, so a feed must be "
                f"{SLOWEST * 1e3:g} mm/s or more"
            )
    slowest = [
        (share, hole.id)
        for hole in program.holes
        for _, share in joint_moves(program.robot, hole)
        if float(share_written(share)) < SHARES[0]
    ]
    if slowest:
        share, hole_id = min(slowest)
        yield (
            f"the joint moves at the corner of hole {hole_id} need {share:.2g} % of what the joints can, which rounds "
            "to zero: VJ= has two decimals; a greater feed_mm_s, or corner: stop"
        )


def refuse_unwritable(program: Program) -> None:
    """Refuse what no text can be written of.

    Raises:
        NotExportableError: there is any.
    """
    if reasons := (*needs(program), *too_slow(program)):
        raise NotExportableError(reasons)


def refuse_calls(program: Program, own: Iterable[str]) -> None:
    """Refuse a call that would start the job itself, or a part of it.

    Raises:
        NotExportableError: there is one.
    """
    ours = {name.upper() for name in own}
    if reasons := tuple(
        f"{call.name}, called {place}, is this job itself"
        for place, calls in program.settings.calls.places()
        for call in calls
        if call.name.upper() in ours
    ):
        raise NotExportableError(reasons)
