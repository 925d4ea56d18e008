"""`zerorev export`: a plan as a robot program."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from cyclopts import Parameter

from zerorev.cli.common import FINE, Output, Whole, app, check_outputs, of_tool
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
    tool: Whole | None = None,
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
        tool: Of a plan of several tools: only the program of this one, from 1; by default each has its own, NAME of the
            first, NAME_tool_2 and so on of the others.
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

    ids, written = _ids(answer, only), []
    for each, place in _wanted(answer, tool, output, alone=retract is not None):
        called = program_of(each, start, ids) if retract is None else retract_name(each, retract)
        if place is None:
            file, mark = program_file(called, dialect_for(each, controller).name), plan_mark(each.name, plan.name)
            check_replaceable(plan.parent, [file], mark, INSTEAD)
        name = place.stem if place else None
        if retract is not None:
            program = retract_program(each, retract, controller, name=name, plan_file=plan.name)
        else:
            with terminal.progress("checking", len(each.holes)) as progress:
                program = to_program(
                    each,
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
        written.append((program, each, place))
    for program, each, place in written:
        _write(program, each, plan, place)
    return FINE


def _wanted(plan: Plan, tool: int | None, output: Path | None, *, alone: bool) -> list[tuple[Plan, Path | None]]:
    """The plans of the tools whose programs are wanted, and where each goes."""
    if tool is not None:
        return [(of_tool(plan, tool), output)]
    tools = plan.of_all_tools
    if alone and len(tools) > 1:
        raise InputError("is missing", where="--tool", accepted=f"1 to {len(tools)}: the tool that is in the hole")
    places = [
        output if output is None or n == 1 else output.with_name(f"{output.stem}_tool_{n}{output.suffix}")
        for n in range(1, len(tools) + 1)
    ]
    return list(zip(tools, places, strict=True))


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
