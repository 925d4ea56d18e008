"""The command line: arguments in, calls out.

Whatever takes long to import is imported by the command that needs it, so that `--help` answers at once.
"""

from __future__ import annotations

import os
import sys
import traceback
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from cyclopts import App, CycloptsError, Parameter

from zerorev.errors import InputError, NotExportableError, OutputError, ZerorevError
from zerorev.report import terminal

if TYPE_CHECKING:
    from zerorev.model.plan import Plan

__all__ = ["app", "main"]

FINE, FOUND, BAD_INPUT, BUG, INTERRUPTED, PIPE_CLOSED = 0, 1, 2, 70, 130, 141

ENDING = """
Exit codes:

- 0: all is well.
- 1: there is an answer, but something in it is wrong: a hole without a motion, a finding of level error, a failed
  check, a plan that must not become a program.
- 2: an argument, an input or an output that cannot be used.
- 70: a fault in zerorev itself.
- 130: interrupted.

No file is ever left half-written.
"""


def _version() -> str:
    from importlib.metadata import version

    return version("zerorev")


app = App(
    name="zerorev",
    help="Robotic drilling without joint reversals: plan the spin of the tool, prove it, write the robot program.",
    help_epilogue=ENDING,
    version=_version,
    default_parameter=Parameter(negative=(), show_default=False),
    help_format="markdown",
    suppress_keyboard_interrupt=False,
    result_action="return_value",
)

Output = Annotated[Path | None, Parameter(name=["--output", "-o"])]


@app.command
def plan(job: Path, /, *, output: Output = None, figures: Path | None = None, json: bool = False) -> int:
    """Find the drilling motion of each hole of a job, and check it.

    Args:
        job: The job file (YAML): robot, tool, holes.
        output: Where to write the plan (JSON). Without it the answer is only shown.
        figures: Folder for three pictures a hole; it is made if its parent exists.
        json: Print the plan as JSON on standard output, and nothing else there.
    """
    from zerorev.model.files import plan_to_json, read_job, write_plan
    from zerorev.model.output import check_file, check_folder

    if output is not None:
        check_file(output)
        _not_over(output, job)
    if figures is not None:
        _need("matplotlib", "matplotlib", "--figures", "figures")
        check_folder(figures)
    wanted = read_job(job)

    from zerorev.planning import plan_job

    with terminal.progress("planning", len(wanted.holes)) as progress:
        answer = plan_job(wanted, progress=progress)
    if output is not None:
        write_plan(answer, output)
    if figures is not None:
        from zerorev.report.figures import write_figures

        with terminal.progress("drawing", len(answer.holes)) as progress:
            write_figures(answer, figures, progress=progress)
    if json:
        terminal.print_json(plan_to_json(answer))
    else:
        _show_plan(answer)
        if output is not None:
            terminal.say(f"plan written to {output}")
        if figures is not None:
            terminal.say(f"figures written to {figures}")
        if output is None:
            terminal.say("no plan written; give -o PLAN.json to keep it")
    return _verdict(answer)


@app.command
def export(plan: Path, /, *, controller: str = "krl", output: Output = None, skip_failed: bool = False) -> int:
    """Write a plan as a robot program, after a last look at its speeds, turns and poses.

    Args:
        plan: The plan file (JSON).
        controller: The robot's controller: krl (KUKA).
        output: The program's file; by default beside the plan, called as the plan is.
        skip_failed: Leave out the holes that must not be exported instead of refusing them all.
    """
    from zerorev.model.files import read_plan
    from zerorev.model.output import check_file, write_text

    if output is not None:
        check_file(output)
        _not_over(output, plan)
    answer = read_plan(plan)

    from zerorev.program.export import export as to_program
    from zerorev.report import tables

    program = to_program(answer, controller, skip_failed=skip_failed, name=output.stem if output else None)
    target = output or plan.with_name(program.name + program.suffix)
    write_text(target, program.text)
    terminal.print_lines(tables.finding_lines(program.findings))
    terminal.say(f"program {program.name} written to {target}")
    if target.name != program.name + program.suffix:
        terminal.note(f"the controller wants this file called {program.name}{program.suffix}")
    return FINE


@app.command
def check(plan: Path, /, *, certify: bool = False, json: bool = False) -> int:
    """Check a plan anew, from the robot, the tool and the holes that it states.

    Args:
        plan: The plan file (JSON).
        certify: Prove it besides, on the continuous motion instead of samples, and write check and proof into the plan
            file; what is refuted or cannot be decided is said.
        json: Print the checked plan as JSON on standard output, and nothing else there.
    """
    from zerorev.model.files import plan_to_json, read_plan, write_plan
    from zerorev.model.output import check_file

    if certify:
        _need("flint", "python-flint", "--certify", "certify")
        check_file(plan)
    answer = read_plan(plan)

    from zerorev.verify import verify_plan

    with terminal.busy("checking"):
        answer = verify_plan(answer)
    if certify:
        from zerorev.verify.certificate import certify_plan

        with terminal.busy("proving"):
            answer = certify_plan(answer)
        write_plan(answer, plan)
    if json:
        terminal.print_json(plan_to_json(answer))
    else:
        _show_plan(answer)
        if certify:
            terminal.say(f"check and certificates written into {plan}")
    return _verdict(answer, certify=certify)


@app.command
def robots(name: str | None = None, /, *, json: bool = False) -> int:
    """List the robots that ship with zerorev, or show one: every number, its source, and what to beware of.

    Args:
        name: One of the list, or the path of a robot file.
        json: Print JSON on standard output, and nothing else there.
    """
    from zerorev.model.files import read_robot, robot_names
    from zerorev.report import tables

    found = [read_robot(each) for each in ([name] if name else robot_names())]
    if json:
        sheets = [tables.robot_sheet(robot) for robot in found]
        terminal.print_json(sheets[0] if name else sheets)
    elif name:
        terminal.out().print(tables.robot_heading(found[0]), tables.robot_table(found[0]), sep="\n")
        terminal.print_lines(tables.robot_lines(found[0]))
    else:
        terminal.out().print(tables.robots_table(found))
    return FINE


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line and return its exit code; no error leaves it but as one message.

    Args:
        arguments: without the program's name; by default those of the process.
    """
    terminal.replace_what_cannot_be_shown()
    with terminal.notices():
        try:
            result = app(
                arguments, exit_on_error=False, print_error=False, console=terminal.out(), error_console=terminal.err()
            )
            sys.stdout.flush()
        except (ZerorevError, CycloptsError) as error:
            terminal.complain(str(error).strip())
            # that a plan must not become a program is an answer, not a fault of the question
            return FOUND if isinstance(error, NotExportableError) else BAD_INPUT
        except KeyboardInterrupt:
            terminal.complain("interrupted; no file was left half-written")
            return INTERRUPTED
        except BrokenPipeError:
            os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())  # else the interpreter complains at its end
            return PIPE_CLOSED
        except Exception:
            traceback.print_exc()
            terminal.complain("a fault in zerorev itself; please report the lines above")
            return BUG
    return result if isinstance(result, int) else FINE


def _verdict(answer: Plan, *, certify: bool = False) -> int:
    wrong = any(finding.level == "error" for finding in answer.all_findings)
    checked = all(hole.verified is not None and hole.verified.passed for hole in answer.holes)
    certified = all(hole.certificate is not None and hole.certificate.verdict == "certified" for hole in answer.holes)
    return FINE if checked and (certified or not certify) and not wrong else FOUND


def _not_over(output: Path, source: Path) -> None:
    if output.exists() and source.exists() and output.samefile(source):
        raise OutputError(str(output), "it is the file that is read")


def _need(module: str, package: str, option: str, extra: str) -> None:
    from importlib.util import find_spec

    if find_spec(module) is None:
        raise InputError(
            f"needs {package}, which is not installed", where=option, accepted=f"pip install 'zerorev[{extra}]'"
        )


def _show_plan(answer: Plan) -> None:
    from zerorev.report import tables

    terminal.out().print(tables.plan_table(answer))
    terminal.print_lines(
        tables.finding_lines((*answer.all_findings, *tables.failed_checks(answer), *tables.open_proofs(answer)))
    )


if __name__ == "__main__":
    sys.exit(main())
