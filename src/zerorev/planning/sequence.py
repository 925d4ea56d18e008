"""The holes of a job one after the other: which of its good motions each takes, in which order, and the moves between.

Each hole offers members (`zerorev.search.members`), each with its other turns within the limits. From what all offer,
members and an order are chosen (`zerorev.planning.choice`); a hole that takes another motion than the planned one is
checked again, and where it fails, is not offered that one any more.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, replace
from functools import partial
from itertools import product

import numpy as np

from zerorev.files.plan_conversion import written_motion
from zerorev.model._arrays import Array
from zerorev.model.job import Job, Settings
from zerorev.model.plan import HolePlan, Motion, Plan, Transition
from zerorev.model.profile import Profile
from zerorev.model.robot import Robot
from zerorev.model.tool import Tool
from zerorev.motion.drilling import Drilling
from zerorev.motion.evaluation import Evaluation, evaluated
from zerorev.motion.joint_path import FULL_TURN
from zerorev.planning.answered import with_another_motion
from zerorev.planning.choice import Member, Offer, chosen
from zerorev.planning.tool_turn import with_tool_turn
from zerorev.program.between import moves_between, time_of_moves
from zerorev.program.ways import Stop, Way, stop_of, stop_of_answer
from zerorev.search.members import members
from zerorev.search.rank import Candidate, Order
from zerorev.workers import HERE, Machines, Workers

__all__ = ["Sequenced", "moves_of", "sequenced", "time_of", "with_moves"]

MOST_TURNS = 16  # ways to turn the axes that one motion offers
ROUNDING = 1e-9


@dataclass(frozen=True)
class Sequenced:
    """What the sequence makes of a job's answers.

    Attributes:
        changed: answers with another motion than the best one, by the number of the hole.
        order: ids of the holes that have a motion, as they are drilled.
        transitions: the moves between them.
        cycle_time: of holes and moves together [s]; None where no hole has a motion.
    """

    changed: dict[int, HolePlan]
    order: tuple[str, ...]
    transitions: tuple[Transition, ...]
    cycle_time: float | None


def sequenced(
    job: Job,
    answers: Callable[[], Iterable[HolePlan]],
    *,
    choose: bool = True,
    machines: Machines = HERE,
    progress: Callable[[int, int], None] | None = None,
) -> Sequenced:
    """Choose motions and an order for the holes of a job.

    Args:
        job: robot, tool, holes, settings.
        answers: gives the answers of the holes in the order of the job, each time it is called.
        choose: whether motions may be chosen; else only the order, and the turns stay.
        machines: to run it on; the outcome is the same.
        progress: called with (holes done, holes in all).
    """
    count = len(job.holes)
    choose = choose and count > 1 and job.settings.posture_freedom > 0
    times: list[float | None] = []

    def timed() -> Iterator[HolePlan]:
        for answer in answers():
            times.append(answer.cycle_time)
            yield answer

    with Workers(partial(_offer, job.robot, job.tool, job.settings, choose), machines) as workers:
        offers: list[Offer] = []
        for offer in workers.map(timed(), count):
            offers.append(offer)
            if progress:
                progress(len(offers), count)
    changed: dict[int, HolePlan] = {}
    while True:
        order, taken = chosen(job, offers)
        other = {n: member for n, member in taken.items() if member is not offers[n][0] and n not in changed}
        failed = False
        with Workers(partial(_answered, job.robot, job.tool, job.settings), machines) as answerers:
            wanted = [(answer, other[n]) for n, answer in enumerate(answers()) if n in other] if other else []
            for n, another in zip(sorted(other), answerers.map(wanted, len(wanted)), strict=True):
                if another is None:  # it does not pass its check, so it is not offered any more
                    offers[n] = tuple(member for member in offers[n] if member is not other[n])
                    failed = True
                else:
                    changed[n] = replace(another, hole=job.holes[n])
        if not failed:
            break
        changed.clear()
    stops = []
    for n in order:
        member = taken[n]
        if (answer := changed.get(n, member.answer)) is not None:
            stops.append(_stop(job.robot, job.tool, job.settings, answer))
        else:
            motion = Motion(member.profile, member.branch, member.joints)
            stops.append(stop_of(job.robot, job.tool, job.settings, job.holes[n], motion))
    for n, final in changed.items():
        times[n] = final.cycle_time
    moves = moves_between(job.robot, job.tool, job.settings, stops)
    return Sequenced(changed, tuple(job.holes[n].id for n in order), moves, time_of(times, moves))


def moves_of(plan: Plan) -> tuple[Transition, ...]:
    """The moves between the holes of a plan in the order that it states.

    Args:
        plan: any; holes without a motion are passed over. Of the motions the digits count that a file has.
    """
    holes = [hole for hole in plan.in_order if hole.motion is not None]
    stops = [_stop(plan.robot, plan.tool, plan.settings, hole) for hole in holes]
    return moves_between(plan.robot, plan.tool, plan.settings, stops)


def with_moves(plan: Plan) -> Plan:
    """The plan with the moves between its holes, in the order that it has so far; holes that lack follow as listed.

    How far the tool turns over all of them is said, too.

    Args:
        plan: any.
    """
    plan = replace(plan, order=tuple(hole.hole.id for hole in plan.in_order if hole.motion is not None))
    moves = moves_of(plan)
    time = time_of((hole.cycle_time for hole in plan.holes), moves)
    return with_tool_turn(replace(plan, transitions=moves, cycle_time=time))


def time_of(holes: Iterable[float | None], moves: Iterable[Transition]) -> float | None:
    """What holes and the moves between them take together [s]; None where no hole has a motion.

    Args:
        holes: the time of each hole [s], or None.
        moves: between them.
    """
    times = [time for time in holes if time is not None]
    return sum(times) + sum(move.time for move in moves) if times else None


def _stop(robot: Robot, tool: Tool, settings: Settings, answer: HolePlan) -> Stop:
    """A hole's answer as a stop of the tour; of its motion the digits count that a file has."""
    strokes = tuple(replace(each, answer=_with_its_digits(each.answer)) for each in answer.strokes)
    return stop_of_answer(robot, tool, settings, replace(_with_its_digits(answer), strokes=strokes))


def _with_its_digits(answer: HolePlan) -> HolePlan:
    assert answer.motion is not None
    return replace(answer, motion=written_motion(answer.motion))


def _offer(robot: Robot, tool: Tool, settings: Settings, choose: bool, answer: HolePlan) -> Offer:
    """What one hole offers."""
    motion, score, settings = answer.motion, answer.score, settings.of(answer.hole)
    if motion is None or score is None:
        return ()
    if answer.strokes:
        stop = _stop(robot, tool, settings, answer)
        time = time_of_moves(robot, stop.way.arrival) + time_of_moves(robot, stop.departure)
        ends = stop.way.arrival[0], stop.departure[-1]
        return (Member(motion.profile, motion.branch, motion.joints, *ends, score.travel, time, answer),)
    drilling = Drilling(robot, tool, answer.hole, settings.limit_margin)
    planned = _member(drilling, settings, motion, score.travel)
    passed = answer.verified is not None and answer.verified.passed
    if not choose or not passed or answer.status != "planned":
        return (planned,)
    order = Order(drilling.without_motion(), settings)
    best = order.judged(motion.profile, motion.branch, Evaluation(motion, score, ()))
    assert best is not None
    found = [planned]
    in_one_go = settings.cycle.kind == "single" and settings.turning.kind != "spin"
    for one in members(drilling, settings, best) if in_one_go else (best,):
        if one is best or _affordable(order, one, best):
            found += _turned(drilling, settings, one, planned)
    return tuple(found)


def _member(drilling: Drilling, settings: Settings, motion: Motion, travel: float) -> Member:
    way = Way.of(drilling, motion, settings)
    time = time_of_moves(drilling.robot, way.arrival) + time_of_moves(drilling.robot, way.departure)
    return Member(motion.profile, motion.branch, motion.joints, way.arrival[0], way.departure[-1], travel, time)


def _affordable(order: Order, one: Candidate, best: Candidate) -> bool:
    """Whether a member costs no more than the freedom allows; travel is budgeted over the whole job instead."""
    settings = order.settings
    if settings.objective == "travel" and not settings.weights:
        return True
    least = order.rank(best).cost
    return order.rank(one).cost <= least + settings.posture_freedom * abs(least) + ROUNDING


def _turned(drilling: Drilling, settings: Settings, one: Candidate, planned: Member) -> Iterator[Member]:
    """A motion with each of its turns within the limits, but for the planned one; where turns are asked for, those."""
    motion = one.evaluation.motion
    assert motion is not None
    same = motion.branch == planned.branch and motion.profile is planned.profile
    member = planned if same else _member(drilling, settings, motion, one.score.travel)
    if not same:
        yield member
    if settings.near_joints is not None:
        return
    limits, points = drilling.limits, np.vstack([member.start, motion.joints, member.end])
    first = np.ceil((limits.lower - points.min(axis=0)) / FULL_TURN - ROUNDING).astype(int)
    last = np.floor((limits.upper - points.max(axis=0)) / FULL_TURN + ROUNDING).astype(int)
    ways = product(*(range(min(a, 0), max(b, 0) + 1) for a, b in zip(first.tolist(), last.tolist(), strict=True)))
    for _, way in zip(range(MOST_TURNS), (way for way in ways if any(way)), strict=False):
        yield member.turned(FULL_TURN * np.array(way))


def _answered(robot: Robot, tool: Tool, settings: Settings, task: tuple[HolePlan, Member]) -> HolePlan | None:
    """The answer of a hole that takes another member; None where that does not pass the check."""
    answer, member = task
    drilling = Drilling(robot, tool, answer.hole, settings.limit_margin)
    found = _with_turns(drilling, settings, member.profile, member.branch, member.joints)
    if found is None:
        return None
    again = with_another_motion(drilling, settings, answer, found)
    return again if again.verified is not None and again.verified.passed else None


def _with_turns(
    drilling: Drilling, settings: Settings, profile: Profile, branch: int, joints: Array
) -> Candidate | None:
    """A motion with the turns of some joints [rad], shape (n, 6); None where the limits do not allow them."""
    near = replace(settings, near_joints=tuple(joints.mean(axis=0).tolist()))
    found = Order(drilling.without_motion(), settings).judged(
        profile, branch, evaluated(drilling, profile, branch, near)
    )
    if found is None or found.evaluation.motion is None:
        return None
    return found if np.abs(found.evaluation.motion.joints[0] - joints[0]).max() < 1.0 else None
