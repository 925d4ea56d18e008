"""The motion that a page shows, simulated on many possible arms, as `zerorev simulate` does it."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace
from types import MappingProxyType

from zerorev.cell.ensemble import HoleStudy, study
from zerorev.cell.possible import possible_arms
from zerorev.cell.reference import Manner
from zerorev.errors import InputError
from zerorev.planning.hole import plan
from zerorev.planning.job import unanswered
from zerorev.web.computing import Work
from zerorev.web.real_arm import Asked, Simulated
from zerorev.web.state import State, Steered, shown, shown_stroke
from zerorev.workers import Machines

__all__ = ["simulate"]

BLOCK = 5  # arms between two signs of life


def simulate(work: Work, asked: Asked) -> bool:
    """Begin to simulate the motion that is shown of the selected hole, planned or made by hand.

    Args:
        work: of the page; what is found comes into its session's state as it grows.
        asked: how.

    Returns:
        whether it has begun: nothing else is under way, and there is a motion.
    """
    state, motion = work.session.state, shown(work.session.state)
    hole = state.hole
    if state.job is None or hole is None or motion is None:
        return False
    robot, tool = state.job.robot, state.job.tool

    def take(now: State, found: Sequence[Simulated | None]) -> State | None:
        job = now.job
        if (
            job is None
            or job.robot is not robot
            or job.tool is not tool
            or all(each.id != hole.id for each in job.holes)
        ):
            return None
        newest = next((each for each in reversed(found) if each is not None), None)
        if newest is None:
            return now
        return replace(now, arm=replace(now.arm, simulated=MappingProxyType({**now.arm.simulated, hole.id: newest})))

    known = state.arm.cell.conditioning
    measured = 0 if known is None else len(known.baseline.keys() & state.answers.keys())
    blocks = math.ceil(asked.arms / BLOCK) * (1 + measured)
    title = f"simulating hole {hole.id} on {asked.arms:,} arms"
    return work.start(title, blocks, lambda: _simulated(state, motion, asked), take, each="block", gives_way=True)


def _simulated(state: State, motion: Steered, asked: Asked) -> Iterator[Simulated | None]:
    """What is known after each block of arms; None while the arms are still being chosen.

    Raises:
        InputError: the motion cannot be run, or no arm is near what was measured.
    """
    job, hole, cell = state.job, state.hole, state.arm.cell
    assert job is not None
    assert hole is not None
    answer = shown_stroke(state)
    if answer is None or state.steered is not None:
        answer = plan(job.robot, job.tool, replace(hole, profile=motion.profile, branch=motion.branch), job.settings)
    measured = {} if cell.conditioning is None else cell.conditioning.baseline
    recorded = tuple(each for key, each in state.answers.items() if key in measured)
    arms = yield from possible_arms(
        unanswered(job, state.strokes, recorded), cell, asked.arms, asked.seed, block=BLOCK, machines=Machines()
    )
    for found in study(
        unanswered(job, state.strokes, (answer,)), arms.sets, manner=Manner(feed=asked.feed), thrust=asked.thrust,
        motions=(), machines=Machines(), block=BLOCK, growing=True,
    ):  # fmt: skip
        if not isinstance(found, HoleStudy):
            raise InputError(f"it cannot be simulated: {found[1]}", where=f"hole {found[0]}")
        yield Simulated(hole, motion, job.settings, cell, asked, arms, found)
