"""`zerorev check`: a plan once more, from what its file states alone."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from cyclopts import Parameter

from zerorev.cli.common import FINE, FOUND, Whole, app, check_outputs, need, need_report
from zerorev.cli.proofs import Proofs
from zerorev.cli.tolerances import Tolerances
from zerorev.errors import InputError
from zerorev.report.words import terminal

if TYPE_CHECKING:
    from zerorev.model.finding import Finding
    from zerorev.model.plan import Plan
    from zerorev.model.written import Drilled, WrittenProgram
    from zerorev.planning.restated import Checked
    from zerorev.program.dialect import Dialect

__all__ = ["check"]

Programs = Annotated[tuple[Path, ...], Parameter(negative=())]


@app.command
def check(
    plan: Path,
    /,
    *,
    certify: bool = False,
    program: Programs = (),
    tolerance: bool = False,
    tolerance_mm: float | None = None,
    tolerance_deg: float | None = None,
    tolerance_ratio: float | None = None,
    proof: bool = False,
    proof_sample: Whole | None = None,
    report: Path | None = None,
    json: bool = False,
) -> int:
    """Check a plan again, from the robot, the tool and the holes that it states.

    Every motion is followed, and every figure that the file states is computed again; one that differs is an error that
    names it, with the value stated and the value found. A certificate is not proven again without --certify, and not
    shown.

    Args:
        plan: The plan file (JSON).
        certify: Prove it besides, on the continuous motion instead of samples, and write check and proof into the plan
            file; what is refuted or cannot be decided is said.
        program: With --certify: prove this program (.src, .mod, .ls), exported from the plan, instead: the rounded
            numbers that stand in it, lead-in and all. The plan file is left as it is. Once for each of a plan of
            several tools.
        tolerance: With --certify: find for each hole the largest tolerance of the part's placement within which it can
            be certified, and write it into the plan file.
        tolerance_mm: With --certify: certify each hole for every part frame whose origin is at most so far [mm] off the
            stated one along each of its axes, and that is turned by at most --tolerance-deg.
        tolerance_deg: Beside --tolerance-mm: the greatest angle [deg], about any axis through the stated origin.
        tolerance_ratio: Beside --tolerance: how many mm of it go with 1 deg; 10 by default.
        proof: Check what the plan states of its optimality, and of its deepest strokes: search again with a log of all
            that the search leaves out, and check the log box by box in ball arithmetic. A hole takes minutes.
        proof_sample: With --proof: check so many boxes of each log, at random, instead of all.
        report: Page with everything about the checked plan to write (HTML), to be printed or filed; it needs no
            network.
        json: Print the checked plan as JSON on standard output, and nothing else there; with --program, what is proven
            of each hole of the program, of several a list; with --proof, `proofs` besides.
    """
    from zerorev.files.checked_files import remember
    from zerorev.files.io import plan_from_text, plan_text, plan_to_json, write_plan
    from zerorev.files.output import check_file

    if program and not certify:
        raise InputError("a program is only read to be certified", where="--program", accepted="--certify beside it")
    asked = Tolerances(tolerance, tolerance_mm, tolerance_deg, tolerance_ratio)
    asked.check(certify=certify, program=bool(program))
    proofs = Proofs(proof, proof_sample)
    proofs.check(program=bool(program))
    if report is not None and len(program) > 1:
        raise InputError("a page is of one program", where="--program", accepted="one, beside --report")
    if certify or proof:
        need("flint", "python-flint", "--certify" if certify else "--proof", "certify")
    check_outputs((report,), plan, *program)
    need_report(report)
    if certify and not program:
        check_file(plan)
    text = plan_text(plan)
    stated = plan_from_text(text, str(plan))
    if program:
        from zerorev.program.dialects import dialect_of, read_program

        read = [(path, read_program(path), dialect_of(path)) for path in program]

    from zerorev.planning.restated import check_plan, without_proofs
    from zerorev.report.words.outcome import curves

    with terminal.progress("checking", len(stated.holes)) as progress:
        checked = check_plan(stated, workers=None, progress=progress)
    if checked.as_stated and _passed(stated) <= _passed(checked.plan):
        remember(text)
    if program:
        with terminal.busy("proving"):
            proven = [_proven(checked, written, dialect, path.stem) for path, written, dialect in read]
        answers = [answer for answer, _ in proven]
    elif certify:
        with terminal.busy("proving"):
            checked = replace(checked, plan=asked.certified(checked.plan))
        write_plan(checked.marked(rewritten=True), plan)
        remember(plan_text(plan))
        answers = [checked.marked()]
    else:
        answers = [without_proofs(checked.marked())]
    found = proofs.checked(checked.plan)
    if report is not None:
        from zerorev.cli.answering import write_report

        said = write_report(answers[0], report, plan.name)
    if json and program:
        listed = [
            _proofs(plan_to_json(answer), written.name, [each.message for each in unexamined])
            for (answer, unexamined), (_, written, _) in zip(proven, read, strict=True)
        ]
        terminal.print_json(listed[0] if len(listed) == 1 else listed)
    elif json:
        terminal.print_json(plan_to_json(answers[0]) | proofs.as_json(found))
    else:
        for n, answer in enumerate(answers):
            _show_plan(answer)
            if program:
                terminal.say(f"the certificates are of {program[n]} as it was read back; {plan} is left as it is")
            elif certify:
                terminal.say(f"check and certificates written into {plan}")
            if certify and (proven_for := curves(answer.holes)):
                terminal.say(proven_for)
        proofs.show(found)
        if report is not None:
            terminal.say(said)
    verdicts = [_verdict(answer, certify=certify) or asked.verdict(answer) for answer in answers]
    return max(verdicts) or proofs.verdict(found)


def _proven(checked: Checked, written: WrittenProgram, dialect: Dialect, stem: str) -> tuple[Plan, tuple[Finding, ...]]:
    """The plan of the tool that a program is of, with the program's certificates, and what it leaves unexamined."""
    from zerorev.model.strokes import together
    from zerorev.program.notes import calls, only_numbered
    from zerorev.verify.certificate.program import certify_program

    own, strokes, drilled = _of_the_program(checked, written, dialect, stem)
    proven = together(own.plan, certify_program(strokes, written, drilled))
    unexamined = (*calls(proven.settings), *only_numbered(written))
    return replace(own, plan=replace(proven, findings=(*proven.findings, *unexamined))).marked(), unexamined


def _of_the_program(
    checked: Checked, written: WrittenProgram, dialect: Dialect, stem: str
) -> tuple[Checked, Plan, tuple[Drilled, ...]]:
    """The plan of the tool that a program is of, the one from which it differs least: it, its strokes, what is drilled.

    Raises:
        InputError: the program drills more holes than any of them.
    """
    from zerorev.model.strokes import by_stroke
    from zerorev.program.as_exported import as_exported

    found: list[tuple[Checked, Plan, tuple[Drilled, ...]]] = []
    why: InputError | None = None
    for each in (checked, *checked.further):
        alone = replace(each, plan=replace(each.plan, further=()), further=())
        strokes = by_stroke(alone.plan)
        try:
            found.append((alone, strokes, as_exported(strokes, written, dialect, stem)))
        except InputError as error:
            why = why or error
    if not found and why is not None:
        raise why

    def apart(one: tuple[Checked, Plan, tuple[Drilled, ...]]) -> int:
        return sum(len(hole.wrong) + (hole.hole is None) for hole in one[2])

    return min(found, key=apart)


def _passed(plan: Plan) -> set[tuple[int, str]]:
    """Tools and ids of the holes that are said to have passed the check."""
    return {
        (number, hole.hole.id)
        for number, each in enumerate(plan.of_all_tools)
        for hole in each.holes
        if hole.verified is not None and hole.verified.passed
    }


def _verdict(answer: Plan, *, certify: bool = False) -> int:
    from zerorev.report.words.answer import Shown

    shown = [Shown(each, each.holes) for each in answer.of_all_tools]
    return FINE if all(each.sound and (each.certified or not certify) for each in shown) else FOUND


def _proofs(plan: dict[str, Any], program: str, unexamined: list[str]) -> dict[str, Any]:
    """What is proven of a program's holes, without the plan around it: in a plan file it would pass for the plan's."""
    holes = [{key: hole[key] for key in ("id", "verified", "certificate")} for hole in plan["holes"]]
    return {"format": "zerorev.program_certificate/1", "program": program, "not_examined": unexamined, "holes": holes}


def _show_plan(answer: Plan) -> None:
    from zerorev.report.words.answer import Shown

    for number, each in enumerate(answer.of_all_tools, 1):
        if answer.further:
            terminal.say(f"tool {number}: {each.tool.name}")
        Shown(each, each.holes).show()
