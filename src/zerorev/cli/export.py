"""`zerorev export`: a plan as a robot program."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from cyclopts import Parameter

from zerorev.cli.common import FINE, Output, Whole, app, check_outputs
from zerorev.errors import InputError
from zerorev.report.words import terminal

if TYPE_CHECKING:
    from zerorev.model.plan import Plan
    from zerorev.program.export import Exported

__all__ = ["export"]

INSTEAD = "-o FILE names another, or this one to replace it"


@app.command
def export(
    plan: Path,
    /,
    *,
    controller: str | None = None,
    output: Output = None,
    skip_failed: bool = False,
    holes_per_program: Whole | None = None,
    start: Annotated[str | None, Parameter(name="--from")] = None,
    only: str | None = None,
    retract: str | None = None,
) -> int:
    """Write a plan as a robot program, after a last check of its speeds, turns and poses.

    A plan file that plan or check has checked on this machine is not checked again, as long as it is unchanged.

    Args:
        plan: The plan file (JSON).
        controller: The robot's controller: krl (KUKA), rapid (ABB), tp (FANUC), urscript (Universal Robots) or inform
            (Yaskawa); by default the one that the plan was made for, or that of the robot's maker.
        output: The program's file, which is replaced if it is there; by default beside the plan, called as the plan is,
            and only a program of this very plan is replaced.
        skip_failed: Leave out the holes that must not be exported instead of refusing them all.
        holes_per_program: Most holes of one file, in place of the job's own setting: a longer program is split into
            NAME_1 and so on, which NAME calls.
        start: Only the hole of this id and those that are drilled after it.
        only: Only the holes of these ids, separated by commas.
        retract: Instead, a program that pulls the drill out of the hole of this id, in which the robot has stopped,
            along the drill axis from wherever it stands.
    """
    from zerorev.files.checked_files import is_checked
    from zerorev.files.io import plan_from_text, plan_text

    if holes_per_program is not None and holes_per_program < 1:
        raise InputError("out of range", where="--holes-per-program", accepted="1 or more")
    if retract is not None and (skip_failed or holes_per_program or start is not None or only is not None):
        raise InputError("stands beside options of another program", where="--retract", accepted="it alone, with -o")
    check_outputs((output,), plan)
    text = plan_text(plan)
    answer = plan_from_text(text, str(plan))
    if is_checked(text):
        from zerorev.verify.check import known_as_checked

        answer = known_as_checked(answer)

    from zerorev.program.dialects import dialect_for, program_file
    from zerorev.program.export import export as to_program
    from zerorev.program.export import program_of, retract_name, retract_program
    from zerorev.program.plan_mark import check_replaceable, plan_mark

    ids = _ids(answer, only)
    called = program_of(answer, start, ids) if retract is None else retract_name(answer, retract)
    if output is None:
        file, mark = program_file(called, dialect_for(answer, controller).name), plan_mark(answer.name, plan.name)
        check_replaceable(plan.parent, [file], mark, INSTEAD)
    name = output.stem if output else None
    if retract is not None:
        program = retract_program(answer, retract, controller, name=name, plan_file=plan.name)
    else:
        with terminal.progress("checking", len(answer.holes)) as progress:
            program = to_program(
                answer,
                controller,
                skip_failed=skip_failed,
                name=name,
                plan_file=plan.name,
                holes_per_program=holes_per_program,
                start=start,
                only=ids,
                workers=None,
                progress=progress,
            )
    _write(program, answer, plan, output)
    return FINE


def _ids(plan: Plan, only: str | None) -> list[str] | None:
    """The ids of --only; commas may belong to one."""
    if only is None:
        return None
    whole = any(hole.hole.id == only for hole in plan.holes)
    return [only] if whole else [part.strip() for part in only.split(",") if part.strip()]


def _write(program: Exported, answer: Plan, plan: Path, output: Path | None) -> None:
    """Show what was found, and write the files."""
    from zerorev.files.output import write_text
    from zerorev.program.plan_mark import check_replaceable, plan_mark
    from zerorev.report.words import tables

    main, *others = program.files
    target = output or plan.with_name(main.name)
    terminal.print_lines(tables.finding_lines(program.findings))
    mark = plan_mark(answer.name, plan.name)
    check_replaceable(target.parent, [file.name for file in others], mark, INSTEAD)
    for file in others:  # the one that is started comes last, when all that it calls is there
        write_text(target.with_name(file.name), file.text)
    write_text(target, main.text)
    beside = f", and its {len(others)} parts beside it" if others else ""
    terminal.say(f"program {program.name} written to {target}{beside}")
    if target.name != main.name:
        terminal.note(f"the controller wants this file called {main.name}")
