"""The command line: arguments in, calls out.

Whatever takes long to import is imported by the command that needs it, so that `--help` answers at once.
"""

from __future__ import annotations

import math
import os
import sys
import traceback
from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

from cyclopts import App, CycloptsError, Parameter

from zerorev.errors import InputError, NotExportableError, OutputError, ZerorevError
from zerorev.report import terminal

if TYPE_CHECKING:
    from zerorev.model.plan import Plan

__all__ = ["app", "main"]

FINE, FOUND, BAD_INPUT, BUG, INTERRUPTED, PIPE_CLOSED = 0, 1, 2, 70, 130, 141
MOST_NUMBERS = 10_000  # of one range on the command line

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
def plan(
    job: Path,
    /,
    *,
    output: Output = None,
    figures: Path | None = None,
    workers: int | None = None,
    json: bool = False,
) -> int:
    """Find the drilling motion of each hole of a job, and check it.

    With -o the finished holes are kept in PLAN.json.part on the way; after an interruption the same command goes on
    from there.

    Args:
        job: The job file (YAML): robot, tool, holes.
        output: Where to write the plan (JSON). Without it the answer is only shown.
        figures: Folder for three pictures a hole; it is made if its parent exists.
        workers: Processes to run it on; by default all cores where the job is large. The plan is the same.
        json: Print the plan as JSON on standard output, and nothing else there.
    """
    from zerorev.model.files import read_job
    from zerorev.model.output import check_file, check_folder

    if output is not None:
        check_file(output)
        _not_over(output, job)
    if figures is not None:
        _need("matplotlib", "matplotlib", "--figures", "figures")
        check_folder(figures)
    wanted = read_job(job)

    from zerorev.run import run

    return FINE if run(wanted, "asked", output, workers, json=json, figures=figures) else FOUND


@app.command
def depth(
    job: Path,
    /,
    *,
    output: Output = None,
    legs: Literal["straight", "free"] | None = None,
    psi_bound_deg: float | None = None,
    min_rate_deg_per_mm: float | None = None,
    max_twist_deg_per_mm: float | None = None,
    workers: int | None = None,
    json: bool = False,
) -> int:
    """Find the deepest stroke of each hole that has no reversal, and the motion that reaches it, and check that.

    The holes need no depth_mm. What DEPTHS.json holds is checked and exported as a plan is. The finished holes are kept
    in DEPTHS.json.part on the way; after an interruption the same command goes on from there.

    Args:
        job: The job file (YAML): robot, tool, holes.
        output: Where to write depths and plans (JSON). Without it the answer is only shown.
        legs: straight or free, instead of the job's.
        psi_bound_deg: Spins stay within +- this, instead of the job's bound.
        min_rate_deg_per_mm: Every joint moves so much at every point, instead of the job's motion threshold.
        max_twist_deg_per_mm: Greatest twist rate of free legs, instead of the job's.
        workers: Processes to run it on; by default all cores where the job is large. The answer is the same.
        json: Print what the file holds as JSON on standard output, and nothing else there.
    """
    from zerorev.model.files import read_job
    from zerorev.model.output import check_file

    if output is not None:
        check_file(output)
        _not_over(output, job)
    options = {
        "legs": legs,
        "psi_bound_deg": psi_bound_deg,
        "min_rate_deg_per_mm": min_rate_deg_per_mm,
        "max_twist_deg_per_mm": max_twist_deg_per_mm,
    }
    given = {key: value for key, value in options.items() if value is not None}
    wanted = read_job(job, depth_needed=False, options=given)

    from zerorev.run import run

    return FINE if run(wanted, "deepest", output, workers, json=json) else FOUND


@app.command
def rates(job: Path, /, *, psi_deg: float | None = None, json: bool = False) -> int:
    """Show the critical twist rates of each hole and what they foretell, before any search.

    Args:
        job: The job file (YAML): robot, tool, holes.
        psi_deg: Show the rates at this spin on every branch that reaches, instead of where zero reversals are cheapest.
        json: Print JSON on standard output, and nothing else there.
    """
    from zerorev.model.files import read_job

    wanted = read_job(job)

    from zerorev.critical import critical_at
    from zerorev.prediction import predict
    from zerorev.report import rates as shown

    if psi_deg is not None:
        at, psi = partial(critical_at, wanted.robot, wanted.tool), math.radians(psi_deg)
        found = [(hole, each) for hole in wanted.holes for each in at(hole, psi)]
        if json:
            terminal.print_json([{"id": hole.id} | shown.rates_data(each) for hole, each in found])
        else:
            terminal.out().print(shown.rates_table(wanted, found))
        return FINE
    foretold = [predict(wanted.robot, wanted.tool, hole, wanted.settings) for hole in wanted.holes]
    if json:
        pairs = zip(wanted.holes, foretold, strict=True)
        terminal.print_json([shown.foretold_data(hole, each) for hole, each in pairs])
    else:
        terminal.out().print(shown.foretold_table(wanted, foretold))
    return FINE


@app.command
def offset(
    job: Path,
    /,
    *,
    output: Output = None,
    offsets_mm: str = "0:200:10",
    angles_deg: str | None = None,
    figure: Path | None = None,
    json: bool = False,
) -> int:
    """Find how deep each hole goes as the tool is offset from the wrist, and the least offset that drills the job.

    Args:
        job: The job file (YAML): robot, tool, holes.
        output: Where to write the answer (JSON). Without it the answer is only shown.
        offsets_mm: Distances of the drill axis from the wrist centre, START:STOP:STEP or a list: 30,60,90.
        angles_deg: Where the axis lies as seen from the wrist centre, likewise; by default where it lies now.
        figure: Picture to draw (PNG).
        json: Print the answer as JSON on standard output, and nothing else there.
    """
    from zerorev.model.files import read_job
    from zerorev.model.output import check_file, write_bytes, write_text

    for path in (output, figure):
        if path is not None:
            check_file(path)
            _not_over(path, job)
    if figure is not None:
        _need("matplotlib", "matplotlib", "--figure", "figures")
    offsets = [value / 1e3 for value in _numbers(offsets_mm, "--offsets-mm")]
    angles = None if angles_deg is None else [math.radians(value) for value in _numbers(angles_deg, "--angles-deg")]
    wanted = read_job(job)

    from zerorev.model.text import json_text
    from zerorev.report import offset as shown
    from zerorev.tool_offset import least_offset, offset_curve

    strokes = len(wanted.holes) * len(offsets) * len(angles or [0])
    with terminal.progress("deepest strokes", strokes) as progress:
        curve = offset_curve(wanted.robot, wanted.tool, wanted.holes, wanted.settings, offsets, angles, progress)
    with terminal.busy("closing in on the least offset"):
        least = least_offset(wanted, curve)
    data = shown.offset_data(wanted, curve, least)
    if output is not None:
        write_text(output, json_text(data))
    if figure is not None:
        from zerorev.report.figures.offset import tool_offset
        from zerorev.report.figures.style import png

        write_bytes(figure, png(tool_offset(wanted, curve, least)))
    if json:
        terminal.print_json(data)
    else:
        terminal.out().print(shown.offset_table(wanted, curve, least))
        terminal.print_lines(shown.offset_lines(wanted, curve, least))
        for what, path in (("answer", output), ("figure", figure)):
            if path is not None:
                terminal.say(f"{what} written to {path}")
    return FOUND if least is None else FINE


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
def check(plan: Path, /, *, certify: bool = False, program: Path | None = None, json: bool = False) -> int:
    """Check a plan anew, from the robot, the tool and the holes that it states.

    Args:
        plan: The plan file (JSON).
        certify: Prove it besides, on the continuous motion instead of samples, and write check and proof into the plan
            file; what is refuted or cannot be decided is said.
        program: With --certify: prove this program (.src), exported from the plan, instead: the rounded numbers that
            stand in it, lead-in and all. The plan file is left as it is.
        json: Print the checked plan as JSON on standard output, and nothing else there; with --program, what is proven
            of each hole of the program.
    """
    from zerorev.model.files import plan_to_json, read_plan, write_plan
    from zerorev.model.output import check_file

    if program is not None and not certify:
        raise InputError("a program is only read to be certified", where="--program", accepted="--certify beside it")
    if certify:
        _need("flint", "python-flint", "--certify", "certify")
    if certify and program is None:
        check_file(plan)
    answer = read_plan(plan)
    if program is not None:
        from zerorev.program.read_back import holes_of, read_program

        written = read_program(program)
        drilled = holes_of(written, answer)

    from zerorev.verify import verify_plan

    with terminal.busy("checking"):
        answer = verify_plan(answer)
    if program is not None:
        from zerorev.verify.certificate_program import certify_program

        with terminal.busy("proving"):
            answer = certify_program(answer, written, drilled)
    elif certify:
        from zerorev.verify.certificate import certify_plan

        with terminal.busy("proving"):
            answer = certify_plan(answer)
        write_plan(answer, plan)
    if json and program is not None:
        terminal.print_json(_proofs(plan_to_json(answer), written.name))
    elif json:
        terminal.print_json(plan_to_json(answer))
    else:
        _show_plan(answer)
        if program is not None:
            terminal.say(f"the certificates are of {program} as it was read back; {plan} is left as it is")
        elif certify:
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
        except KeyboardInterrupt as interrupt:
            terminal.complain(str(interrupt) or "interrupted; no file was left half-written")
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
    from zerorev.report.answer import Shown

    shown = Shown(answer, answer.holes)
    return FINE if shown.sound and (shown.certified or not certify) else FOUND


def _proofs(plan: dict[str, Any], program: str) -> dict[str, Any]:
    """What is proven of a program's holes, without the plan around it: in a plan file it would pass for the plan's."""
    holes = [{key: hole[key] for key in ("id", "verified", "certificate")} for hole in plan["holes"]]
    return {"format": "zerorev.program_certificate/1", "program": program, "holes": holes}


def _not_over(output: Path, source: Path) -> None:
    if output.exists() and source.exists() and output.samefile(source):
        raise OutputError(str(output), "it is the file that is read")


def _numbers(text: str, where: str) -> list[float]:
    """Numbers of START:STOP:STEP, the stop among them where a step meets it, or of a list with commas."""
    accepted = "START:STOP:STEP with a step above 0, or numbers with commas between them"
    parts = text.split(":")
    try:
        numbers = [float(part) for part in (parts if len(parts) == 3 else text.split(","))]
    except ValueError:
        raise InputError(f"'{text}' is not numbers", where=where, accepted=accepted) from None
    if not all(map(math.isfinite, numbers)):
        raise InputError(f"'{text}' is not finite", where=where, accepted=accepted)
    if len(parts) != 3:
        return numbers
    start, stop, step = numbers
    if step <= 0 or stop < start or (stop - start) / step > MOST_NUMBERS:
        raise InputError(f"'{text}' is no range", where=where, accepted=f"{accepted}, {MOST_NUMBERS} steps at most")
    return [start + n * step for n in range(int((stop - start) / step + 1e-9) + 1)]


def _need(module: str, package: str, option: str, extra: str) -> None:
    from importlib.util import find_spec

    if find_spec(module) is None:
        raise InputError(
            f"needs {package}, which is not installed", where=option, accepted=f"pip install 'zerorev[{extra}]'"
        )


def _show_plan(answer: Plan) -> None:
    from zerorev.report.answer import Shown

    Shown(answer, answer.holes).show()


if __name__ == "__main__":
    sys.exit(main())
