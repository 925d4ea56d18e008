"""URScript among the dialects."""

from __future__ import annotations

from collections.abc import Sequence

from zerorev.model.corner import CONTROLLERS
from zerorev.model.finding import Finding
from zerorev.model.written import WrittenProgram
from zerorev.program.dialect import Dialect, ProgramFile
from zerorev.program.neutral import Program
from zerorev.program.retract import Retract
from zerorev.program.urscript.examine import examine, most_holes
from zerorev.program.urscript.files import parts_called, read_files
from zerorev.program.urscript.names import URSCRIPT_NAMES
from zerorev.program.urscript.retract import retract_to_urscript
from zerorev.program.urscript.source import alike
from zerorev.program.urscript.write import urscript_files

__all__ = ["URSCRIPT"]

SUFFIX = ".script"


def _write(program: Program, name: str, findings: tuple[Finding, ...], version: str | None) -> tuple[ProgramFile, ...]:
    files = urscript_files(program, name, findings, version)
    return tuple(ProgramFile(each + SUFFIX, text) for each, text in files.items())


def _read(files: Sequence[ProgramFile]) -> WrittenProgram:
    return read_files([(file.text, file.name) for file in files])


def _parts(file: ProgramFile) -> tuple[str, ...]:
    return tuple(name + SUFFIX for name in parts_called(file.text, file.name))


def _retract(retract: Retract, name: str, version: str) -> ProgramFile:
    return ProgramFile(name + SUFFIX, retract_to_urscript(retract, name, version))


URSCRIPT = Dialect(
    CONTROLLERS["urscript"],
    SUFFIX,
    alike,
    URSCRIPT_NAMES.of,
    _write,
    _read,
    _parts,
    _retract,
    examine=examine,
    most_holes=most_holes,
)
