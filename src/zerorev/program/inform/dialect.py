"""INFORM among the dialects."""

from __future__ import annotations

from collections.abc import Sequence

from zerorev.errors import InputError
from zerorev.model.corner import CONTROLLERS
from zerorev.model.finding import Finding
from zerorev.model.written import WrittenProgram
from zerorev.program.dialect import Dialect, ProgramFile
from zerorev.program.inform.examine import examine
from zerorev.program.inform.names import INFORM_NAMES
from zerorev.program.inform.read import alike, read_job
from zerorev.program.inform.write import inform_jobs, most_holes
from zerorev.program.neutral import Program
from zerorev.program.notes import notes
from zerorev.program.parts import joined

__all__ = ["INFORM"]

SUFFIX = ".JBI"


def _write(program: Program, name: str, findings: tuple[Finding, ...], version: str | None) -> tuple[ProgramFile, ...]:
    jobs = inform_jobs(program, name=name, findings=findings, version=version)
    return tuple(ProgramFile(each + SUFFIX, text) for each, text in jobs.items())


def _read(files: Sequence[ProgramFile]) -> WrittenProgram:
    main, *others = files
    started = read_job(main.text, main.name)
    if others and (started.holes or started.tail):
        raise InputError("it moves the robot itself", where=main.name, accepted="a job that only calls its parts")
    parts = [(file.name, read_job(file.text, file.name)) for file in others]
    for name, job in parts or [(main.name, started)]:
        if not job.holes:
            raise InputError("the job has no holes", where=name, accepted="a job that zerorev has exported")
    return joined(started.name, main.name, started.head, parts, "TOOL") if parts else started


def _parts(file: ProgramFile) -> tuple[str, ...]:
    job, found = read_job(file.text, file.name), list[str]()
    if job.holes or job.tail:
        return ()
    for call in job.head:
        if call.words == ("CALL", "JOB:", expected := INFORM_NAMES.part(job.name, len(found) + 1)):
            found.append(expected)
    return tuple(name + SUFFIX for name in found)


def _most_holes(program: Program) -> int | None:
    return most_holes(program, (*notes(program), *examine(program)))


INFORM = Dialect(
    CONTROLLERS["inform"],
    SUFFIX,
    alike,
    INFORM_NAMES.of,
    _write,
    _read,
    _parts,
    examine=examine,
    most_holes=_most_holes,
)
