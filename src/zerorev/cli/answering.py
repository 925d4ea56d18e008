"""What the commands `plan` and `depth` share: a job is answered hole by hole, the answers are kept and shown."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable
from contextlib import closing, nullcontext
from dataclasses import dataclass, replace
from pathlib import Path

from zerorev.files.checked_files import remember
from zerorev.files.io import plan_to_json
from zerorev.files.part import Part
from zerorev.files.plan_conversion import as_written
from zerorev.files.text import read_text
from zerorev.model.job import Job
from zerorev.model.plan import HolePlan, Plan, Strokes
from zerorev.planning.job import answers, in_sequence, plan_job, unanswered
from zerorev.planning.sequence import sequenced
from zerorev.planning.tool_turn import ToolTurn
from zerorev.planning.tried_otherwise import TriedOtherwise
from zerorev.report.words import terminal
from zerorev.report.words.answer import Shown, minutes
from zerorev.workers import Machines

__all__ = ["Pictures", "run", "write_report"]


@dataclass(frozen=True)
class Pictures:
    """What is drawn of a plan.

    Attributes:
        figures: folder for the figures of holes; None: none.
        of: ids of the holes that are drawn there; None: all.
        report: where to write the plan as one page; None: nowhere.
        source: the file that the page names as where it comes from.
    """

    figures: Path | None = None
    of: tuple[str, ...] | None = None
    report: Path | None = None
    source: str = ""

    def __bool__(self) -> bool:
        return self.figures is not None or self.report is not None

    def draw(self, plan: Plan, processes: int | None) -> list[str]:
        """Draw them.

        Args:
            plan: what was found.
            processes: of this machine that do it.

        Returns:
            what was written, a line each.
        """
        written = []
        if self.figures is not None:
            from zerorev.report.figures import picture_count, write_figures

            with terminal.progress("drawing", picture_count(plan, self.of), "picture") as progress:
                write_figures(plan, self.figures, progress, ids=self.of, machines=Machines(processes))
            written.append(f"figures written to {self.figures}")
        if self.report is not None:
            written.append(write_report(plan, self.report, self.source))
        return written


def write_report(plan: Plan, target: Path, source: str) -> str:
    """Write a plan as one page, and say so.

    Args:
        plan: with its holes.
        target: where to.
        source: the file that it comes from.
    """
    from zerorev.files.output import write_text
    from zerorev.report.figures.plan_report import plan_report

    with terminal.busy("writing the report"):
        write_text(target, plan_report(plan, source))
    return f"report written to {target}"


def run(
    job: Job, strokes: Strokes, output: Path | None, machines: Machines, *, json: bool, pictures: Pictures | None = None
) -> bool:
    """Answer a job, write and show the answers.

    Args:
        job: robot, tool, holes, settings.
        strokes: those `asked` for, or of each hole the `deepest`.
        output: where to write the plan or depth file, if anywhere.
        machines: to run it on.
        json: show what the file holds, and nothing else.
        pictures: what is drawn, if anything.

    Returns:
        whether every hole has a checked motion and no finding is an error.

    Raises:
        KeyboardInterrupt: the user stopped it; says what is kept.
        ZerorevError: as `answers` has it.
    """
    began = time.monotonic()
    head = unanswered(job, strokes)
    kept, tried = list[HolePlan](), TriedOtherwise(job)
    with nullcontext() if output is None else Part(output, head, job.holes) as part:
        fresh = part is not None and part.done == 0
        _answer(job, strokes, machines, part, (tried.add, *((kept.append,) if part is None else ())))
        said = tried.findings()
        source = (lambda: map(as_written, kept)) if part is None else part.answers
        whole, changed = _in_sequence(job, head, source, machines)
        shown, turns = Shown(whole), ToolTurn(whole)
        keep = bool(pictures) or (json and output is None)
        holes = list[HolePlan]()
        for n, answer in enumerate(source()):
            final = changed.get(n, answer)
            shown.add(final)
            turns.add(final)
            if keep:
                holes.append(final)
        said = (*said, *turns.findings())
        whole = replace(whole, further=_of_the_further_tools(job, strokes, machines))
        others = [Shown(each, each.holes) for each in whole.further]
        if part is not None:
            part.finish(whole, changed, said)
    if output is not None and fresh:  # what was kept from another run was not checked by this one
        remember(read_text(output, "the plan file that was just written"))
    shown.say(said)
    whole = replace(whole, holes=tuple(holes), findings=(*head.findings, *said))
    drawn = pictures.draw(whole, machines.processes) if pictures else []
    if json and output is not None:
        terminal.print_file(output)
    elif json:
        terminal.print_json(plan_to_json(whole))
    else:
        if whole.further:
            terminal.say(f"tool 1: {whole.tool.name}")
        shown.show()
        for number, (each, of_it) in enumerate(zip(whole.further, others, strict=True), 2):
            terminal.say(f"tool {number}: {each.tool.name}")
            of_it.show()
        what = "plan" if strokes == "asked" else "depths"
        if output is not None:
            terminal.say(f"{what} written to {output}")
        for line in drawn:
            terminal.say(line)
        if output is None:
            terminal.say(f"no {what} written; give -o {what.upper()}.json to keep {'it' if what == 'plan' else 'them'}")
        # beside the answer, which is the same each time
        terminal.note(f"elapsed time {minutes(time.monotonic() - began)}")
    return shown.sound and all(of_it.sound for of_it in others)


def _of_the_further_tools(job: Job, strokes: Strokes, machines: Machines) -> tuple[Plan, ...]:
    """The plans of the further tools; of them nothing is kept where the run is interrupted."""
    found = []
    for number, each in enumerate(job.further, 2):
        with terminal.progress(f"tool {number}", len(each.holes)) as progress:
            found.append(
                plan_job(
                    each, progress, strokes=strokes, workers=machines.processes, scheduler=machines.scheduler
                )
            )  # fmt: skip
    return tuple(found)


def _in_sequence(
    job: Job, head: Plan, answers: Callable[[], Iterable[HolePlan]], machines: Machines
) -> tuple[Plan, dict[int, HolePlan]]:
    """The plan with the order of its holes and the moves between them, and the answers that it changes."""
    with terminal.progress("sequence", len(job.holes)) as progress:
        found = sequenced(job, answers, choose=head.strokes == "asked", machines=machines, progress=progress)
    return in_sequence(head, found), found.changed


def _answer(
    job: Job, strokes: Strokes, machines: Machines, part: Part | None, takers: tuple[Callable[[HolePlan], None], ...]
) -> None:
    """Hand out the answers of a job, with progress; an interruption says what is kept."""
    total, before = len(job.holes), part.done if part else 0
    if part and before:
        terminal.note(f"resuming after {before} of {total} holes in {part.path}")
    try:
        with (
            terminal.progress("planning" if strokes == "asked" else "deepest strokes", total) as progress,
            closing(answers(job, strokes=strokes, machines=machines, part=part)) as found,
        ):
            if progress:
                progress(before, total)
            for done, answer in enumerate(found, 1):
                for take in takers:
                    take(answer)
                if progress and done > before:
                    progress(done, total)
    except KeyboardInterrupt:
        if part and part.done:
            kept = f"{part.done} of {total} holes are kept in {part.path}"
            raise KeyboardInterrupt(f"interrupted; {kept}; the same command resumes") from None
        raise
