"""Whole jobs: hole after hole on as many processor cores as wanted, and never twice; then the sequence of them."""

from __future__ import annotations

from collections.abc import Callable, Generator
from dataclasses import replace

from zerorev.files.part import Part
from zerorev.files.plan_conversion import as_written
from zerorev.model.hole import Hole
from zerorev.model.job import Job, Settings
from zerorev.model.plan import HolePlan, Plan, Strokes
from zerorev.model.robot import Robot
from zerorev.model.tool import Tool
from zerorev.planning.hole import lever_findings, plan, plan_deepest
from zerorev.planning.likely_mistakes import likely_mistakes
from zerorev.planning.sequence import Sequenced, sequenced
from zerorev.planning.tool_turn import with_tool_turn
from zerorev.planning.tried_otherwise import TriedOtherwise
from zerorev.workers import HERE, Machines, Workers, interrupts_held_back

__all__ = ["answers", "in_sequence", "plan_job", "unanswered"]


def plan_job(
    job: Job,
    progress: Callable[[int, int], None] | None = None,
    *,
    strokes: Strokes = "asked",
    workers: int | None = 1,
    scheduler: str | None = None,
) -> Plan:
    """Plan every hole of a job, tool by tool; what is wrong with one hole is a finding, the others are still planned.

    Args:
        job: robot, tool, holes, settings.
        progress: called with (holes done, holes in all) before the first and after each hole, tool by tool.
        strokes: those `asked` for, or of each hole the `deepest` without a reversal (`plan_deepest`).
        workers: processes to run it on; None: one per core where the job is large enough. The plan is the same. A
            script that asks for more than one must be safe to import (`if __name__ == "__main__":`), as everywhere in
            Python.
        scheduler: address of a `dask.distributed` scheduler to run it on instead, with `workers` None.

    Raises:
        InputError: fewer than one worker, or workers and a scheduler.
        ZerorevError: a worker ended before its time, or the cluster is lost.
    """
    found: list[HolePlan] = []
    tried = TriedOtherwise(job)
    if progress:
        progress(0, len(job.holes))
    for answer in answers(job, strokes=strokes, machines=Machines(workers, scheduler)):
        found.append(answer)
        tried.add(answer)
        if progress:
            progress(len(found), len(job.holes))
    # the same sequence as of a plan file's digits, so that a run which is resumed from some ends alike
    written = [as_written(answer) for answer in found]
    sequence = sequenced(job, lambda: written, choose=strokes == "asked", machines=Machines(workers, scheduler))
    holes = tuple(sequence.changed.get(n, answer) for n, answer in enumerate(found))
    whole = in_sequence(unanswered(job, strokes, holes), sequence)
    whole = with_tool_turn(replace(whole, findings=(*whole.findings, *tried.findings())))
    further = [plan_job(each, progress, strokes=strokes, workers=workers, scheduler=scheduler) for each in job.further]
    return replace(whole, further=tuple(further))


def unanswered(job: Job, strokes: Strokes, holes: tuple[HolePlan, ...] = ()) -> Plan:
    """The plan of a job but for its holes, or with these."""
    findings = (*lever_findings(job.robot, job.tool), *likely_mistakes(job), *job.said)
    return Plan(job.robot, job.tool, job.settings, holes, job.T_base_part, job.name, findings, strokes)


def in_sequence(plan: Plan, sequence: Sequenced) -> Plan:
    """The plan with the order of its holes and the moves between them.

    Args:
        plan: of the same job.
        sequence: of its holes.
    """
    return replace(plan, order=sequence.order, transitions=sequence.transitions, cycle_time=sequence.cycle_time)


def answers(
    job: Job, *, strokes: Strokes = "asked", machines: Machines = HERE, part: Part | None = None
) -> Generator[HolePlan, None, None]:
    """The answers in the order of the job, each as soon as it and those before it are there.

    Args:
        job: robot, tool, holes, settings.
        strokes: those `asked` for, or of each hole the `deepest` without a reversal.
        machines: to run it on; the answers are the same.
        part: holes that are finished come from it, and each that is new is kept in it before it is given out.

    Raises:
        OutputError: the part cannot be written.
        ZerorevError: a worker ended before its time, or the cluster is lost.
    """
    done = 0
    if part is not None:
        for answer in part.answers():
            done += 1
            yield answer
    left = job.holes[done:]
    with Workers(_Planner(job.robot, job.tool, job.settings, strokes), machines) as planners:
        for answer in planners.map(left, len(left)):
            if part is not None:
                with interrupts_held_back():  # a hole is kept and counted, or neither
                    part.append(answer)
            yield answer


class _Planner:
    """What one hole of the job is answered by; goes to the workers as it is."""

    def __init__(self, robot: Robot, tool: Tool, settings: Settings, strokes: Strokes) -> None:
        self.robot, self.tool, self.settings, self.strokes = robot, tool, settings, strokes

    def __call__(self, hole: Hole) -> HolePlan:
        return (plan if self.strokes == "asked" else plan_deepest)(self.robot, self.tool, hole, self.settings)
