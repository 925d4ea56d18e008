"""`zerorev export`: a plan as a robot program."""

from __future__ import annotations

from pathlib import Path

from zerorev.cli.common import FINE, Output, Whole, app, check_outputs
from zerorev.errors import InputError
from zerorev.report.words import terminal

__all__ = ["export"]

INSTEAD = "-o FILE names another, or this one to replace it"


@app.command
def export(
    plan: Path,
    /,
    *,
    controller: str = "krl",
    output: Output = None,
    skip_failed: bool = False,
    holes_per_program: Whole | None = None,
) -> int:
    """Write a plan as a robot program, after a last check of its speeds, turns and poses.

    A plan file that plan or check has checked on this machine is not checked again, as long as it is unchanged.

    Args:
        plan: The plan file (JSON).
        controller: The robot's controller: krl (KUKA).
        output: The program's file, which is replaced if it is there; by default beside the plan, called as the plan is,
            and only a program of this very plan is replaced.
        skip_failed: Leave out the holes that must not be exported instead of refusing them all.
        holes_per_program: Most holes of one file, in place of the job's own setting: a longer program is split into
            NAME_1 and so on, which NAME calls.
    """
    from zerorev.files.checked_files import is_checked
    from zerorev.files.io import plan_from_text, plan_text
    from zerorev.files.output import write_text

    if holes_per_program is not None and holes_per_program < 1:
        raise InputError("out of range", where="--holes-per-program", accepted="1 or more")
    check_outputs((output,), plan)
    text = plan_text(plan)
    answer = plan_from_text(text, str(plan))
    if is_checked(text):
        from zerorev.verify.check import known_as_checked

        answer = known_as_checked(answer)

    from zerorev.program.dialects import program_file
    from zerorev.program.export import export as to_program
    from zerorev.program.plan_mark import check_replaceable, plan_mark
    from zerorev.report.words import tables

    mark = plan_mark(answer.name, plan.name)
    if output is None:
        check_replaceable(plan.parent, [program_file(answer.name, controller)], mark, INSTEAD)
    name = output.stem if output else None
    with terminal.progress("checking", len(answer.holes)) as progress:
        program = to_program(
            answer,
            controller,
            skip_failed=skip_failed,
            name=name,
            plan_file=plan.name,
            holes_per_program=holes_per_program,
            workers=None,
            progress=progress,
        )
    main, *others = program.files
    target = output or plan.with_name(main.name)
    terminal.print_lines(tables.finding_lines(program.findings))
    check_replaceable(target.parent, [file.name for file in others], mark, INSTEAD)
    for file in others:  # the one that is started comes last, when all that it calls is there
        write_text(target.with_name(file.name), file.text)
    write_text(target, main.text)
    beside = f", and its {len(others)} parts beside it" if others else ""
    terminal.say(f"program {program.name} written to {target}{beside}")
    if target.name != main.name:
        terminal.note(f"the controller wants this file called {main.name}")
    return FINE
