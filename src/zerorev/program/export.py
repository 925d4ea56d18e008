"""From a plan to the text of a program: build, preflight, write in the dialect of a controller."""

from __future__ import annotations

from collections.abc import Callable, Collection, Generator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from importlib.metadata import version as installed_version
from typing import TypeVar

from zerorev.errors import NotExportableError
from zerorev.model.finding import Finding
from zerorev.model.plan import HolePlan, Plan
from zerorev.model.strokes import by_stroke, ids_of_strokes
from zerorev.program.dialect import ProgramFile
from zerorev.program.dialects import dialect_for
from zerorev.program.neutral import build_program
from zerorev.program.preflight import preflight
from zerorev.program.retract import retract_of
from zerorev.program.rounding import turned_by_digits
from zerorev.program.selection import Selection, number_of, selection
from zerorev.verify.check import subject, verify_hole
from zerorev.workers import Machines, Workers

__all__ = ["Exported", "export", "exporting", "program_of", "retract_name", "retract_program"]

T = TypeVar("T")

LONG, LARGE = 5_000, 4_000_000  # lines, bytes of one file


@dataclass(frozen=True)
class Exported:
    """A program, ready to be written to a file.

    Attributes:
        files: the one that is started first.
        findings: warnings and infos of the preflight.
        name: of the program.
        holes: how many are in it.
    """

    files: tuple[ProgramFile, ...]
    findings: tuple[Finding, ...]
    name: str
    holes: int

    @property
    def text(self) -> str:
        """Of the file that is started."""
        return self.files[0].text


def export(
    plan: Plan,
    controller: str | None = None,
    *,
    skip_failed: bool = False,
    name: str | None = None,
    plan_file: str = "",
    holes_per_program: int | None = None,
    start: str | None = None,
    only: Sequence[str] | None = None,
    version: str | None = None,
    workers: int | None = 1,
    progress: Callable[[int, int], None] | None = None,
) -> Exported:
    """Write a verified plan as a robot program.

    What the plan says of its own verification is not taken on trust: a hole that was not checked just as it is here, in
    this process or one of its workers, is checked once more.

    Args:
        plan: what to run; each of several strokes of a hole is written as a hole of its own.
        controller: one of `DIALECTS`; None: the one that the plan was made for, or that of the robot's maker.
        skip_failed: leave out the holes that must not be exported instead of refusing; a finding names each.
        name: of the program; by default the plan's.
        plan_file: name of the file that the plan is in; it stands in the program, so that the next export of the plan
            may replace it.
        holes_per_program: most holes of one file, in place of the plan's own setting.
        start: id of the hole with which the program begins, in the order in which they are drilled; None: the first.
        only: ids of the holes that are wanted, drilled in their order; None: all.
        version: of zerorev, for the comment block; by default the installed one.
        workers: processes that check the holes; the program is the same.
        progress: called with (holes checked, holes in all) before the first and after each.

    Raises:
        InputError: unknown controller; a hole that the plan does not have.
        NotExportableError: the robot is another maker's, a hole has no verified motion, or the preflight found an
            error.
    """
    steps = exporting(
        plan,
        controller,
        skip_failed=skip_failed,
        name=name,
        plan_file=plan_file,
        holes_per_program=holes_per_program,
        start=start,
        only=only,
        version=version,
        workers=workers,
    )
    count = len(by_stroke(plan).holes)
    return _finished(steps, lambda checked: progress(checked, count) if progress else None)


def _finished(steps: Generator[None, None, T], reached: Callable[[int], object] = lambda checked: None) -> T:
    """What steps come to; called with how many are made, before the first and after each."""
    checked = 0
    while True:
        reached(checked)
        try:
            next(steps)
        except StopIteration as end:
            found: T = end.value
            return found
        checked += 1


def exporting(
    plan: Plan,
    controller: str | None = None,
    *,
    skip_failed: bool = False,
    name: str | None = None,
    plan_file: str = "",
    holes_per_program: int | None = None,
    start: str | None = None,
    only: Sequence[str] | None = None,
    version: str | None = None,
    workers: int | None = 1,
) -> Generator[None, None, Exported]:
    """The same as `export`, step by step: comes back after each hole that was checked, and returns the program."""
    dialect = dialect_for(plan, controller)
    wanted, plan = _selection(plan, start, only), by_stroke(plan)
    verified = yield from _verified(plan, workers, wanted.ids)
    program = build_program(verified, skip_failed=skip_failed, only=wanted.ids, plan_file=plan_file)
    program = replace(
        program,
        findings=(*wanted.findings, *program.findings),
        parts=_parts(
            len(program.holes),
            holes_per_program or plan.settings.holes_per_program or dialect.most_holes(program),
        ),
    )
    findings = (*preflight(program, plan, dialect.controller), *dialect.examine(program))
    _refuse_errors(findings)
    called = dialect.program_name(name or wanted.name)
    files = dialect.write(program, called, findings, version)
    if not dialect.weighs_digits and (
        turned := turned_by_digits(plan, [hole.id for hole in program.holes], dialect.read(files))
    ):
        findings = (*findings, *turned)
        files = dialect.write(program, called, findings, version)
    return Exported(files, (*findings, *_sizes(files)), called, len(program.holes))


def _parts(holes: int, most: int | None) -> tuple[int, ...]:
    """How many holes each part has; none where all fit into one file."""
    if most is None or holes <= most:
        return ()
    return (*[most] * (holes // most), *[holes % most] * (holes % most > 0))


def _sizes(files: tuple[ProgramFile, ...]) -> tuple[Finding, ...]:
    """What is said of files that a controller may not take, or that nobody can look through."""
    cure = "holes_per_program in the job, or --holes-per-program, splits it into parts"
    found = []
    for file in files:
        lines, size = file.text.count("\n"), len(file.text)
        if size > LARGE:
            message = f"{file.name} has {size / 1e6:.1f} MB: a controller may not load more than 4 MB; {cure}"
            found.append(Finding("warning", "program_size", message))
        elif lines > LONG:
            found.append(Finding("info", "program_size", f"{file.name} has {lines:,} lines; {cure}"))
    return tuple(found)


def retract_program(
    plan: Plan,
    hole_id: str,
    controller: str | None = None,
    *,
    name: str | None = None,
    plan_file: str = "",
    version: str | None = None,
) -> Exported:
    """A program that brings the drill out of a hole in which the robot has stopped, from wherever it stands.

    Args:
        plan: whose hole it is.
        hole_id: of the hole.
        controller: one of `DIALECTS`; None: the one that the plan was made for, or that of the robot's maker.
        name: of the program; by default the plan's, and which hole.
        plan_file: see `export`.
        version: of zerorev, for the comment block; by default the installed one.

    Raises:
        InputError: unknown controller; a hole that the plan does not have.
        NotExportableError: the robot is another maker's, the hole has no verified motion, or the drill cannot be
            brought out straight.
    """
    dialect = dialect_for(plan, controller)
    if dialect.retract_text is None:
        why = f"a program that brings the drill out of a hole is not offered in {dialect.controller.language}: "
        why += dialect.no_retract
        raise NotExportableError((why,))
    hole_id = ids_of_strokes(plan, [hole_id])[-1]
    plan = by_stroke(plan)
    called = dialect.program_name(name or retract_name(plan, hole_id))
    number_of(plan, hole_id, "retract")
    way = retract_of(_finished(_verified(plan, 1, [hole_id])), hole_id, plan_file)
    _refuse_errors(preflight(way.program, plan, dialect.controller))
    text = dialect.retract_text(way, called, version or installed_version("zerorev"))
    return Exported((dialect.file(called, text),), way.findings, called, 1)


def program_of(plan: Plan, start: str | None = None, only: Sequence[str] | None = None) -> str:
    """What a program is called after, of a plan or of a part of it: see `export`.

    Raises:
        InputError: a hole that the plan does not have.
    """
    return _selection(plan, start, only).name


def _selection(plan: Plan, start: str | None, only: Sequence[str] | None) -> Selection:
    """The strokes that are wanted, of a plan of holes."""
    first = None if start is None else ids_of_strokes(plan, [start])[0]
    return selection(by_stroke(plan), first, None if only is None else ids_of_strokes(plan, only))


def retract_name(plan: Plan, hole_id: str) -> str:
    """What a retract program is called after; of a hole of several strokes the last one is meant.

    Raises:
        InputError: a hole that the plan does not have.
    """
    hole_id, plan = ids_of_strokes(plan, [hole_id])[-1], by_stroke(plan)
    return f"{plan.name}_out_{number_of(plan, hole_id, 'retract')}"


def _verified(plan: Plan, workers: int | None, ids: Collection[str] | None = None) -> Generator[None, None, Plan]:
    """The plan with each hole that passed its check held to it again, unless this very hole was checked before.

    Holes that are not wanted are left as they are.

    A plan file may have been altered since; a hole that was replaced in memory has another fingerprint.
    """
    holes = []
    with Workers(partial(verify_hole, plan.robot, plan.tool, plan.settings), Machines(workers)) as checkers:
        left = [hole for hole in plan.holes if _is_open(plan, hole, ids)]
        outcomes = checkers.map(left, len(left))
        for hole in plan.holes:
            holes.append(replace(hole, verified=next(outcomes)) if _is_open(plan, hole, ids) else hole)
            yield
    return replace(plan, holes=tuple(holes))


def _is_open(plan: Plan, hole: HolePlan, ids: Collection[str] | None) -> bool:
    """Whether a hole that is wanted is said to have passed, but not known to."""
    if ids is not None and hole.hole.id not in ids:
        return False
    if hole.verified is None or not hole.verified.passed:
        return False
    return hole.verified.subject != subject(plan.robot, plan.tool, plan.settings, hole)


def _refuse_errors(findings: Sequence[Finding]) -> None:
    if errors := [finding for finding in findings if finding.level == "error"]:
        raise NotExportableError(tuple(_sentence(finding) for finding in errors))


def _sentence(finding: Finding) -> str:
    return finding.message if finding.hole is None else f"hole {finding.hole}: {finding.message}"
