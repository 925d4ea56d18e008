"""RAPID among the dialects."""

from __future__ import annotations

from collections.abc import Sequence

from zerorev.model.corner import CONTROLLERS
from zerorev.model.finding import Finding
from zerorev.model.written import WrittenProgram
from zerorev.program.dialect import Dialect, ProgramFile
from zerorev.program.neutral import Program
from zerorev.program.rapid.examine import examine
from zerorev.program.rapid.modules import parts_called, read_modules
from zerorev.program.rapid.names import RAPID_NAMES
from zerorev.program.rapid.retract import retract_to_rapid
from zerorev.program.rapid.source import alike
from zerorev.program.rapid.write import most_holes, rapid_modules
from zerorev.program.retract import Retract

__all__ = ["RAPID"]

SUFFIX = ".mod"


def _write(program: Program, name: str, findings: tuple[Finding, ...], version: str | None) -> tuple[ProgramFile, ...]:
    modules = rapid_modules(program, name=name, findings=findings, version=version)
    return tuple(ProgramFile(each + SUFFIX, text) for each, text in modules.items())


def _read(files: Sequence[ProgramFile]) -> WrittenProgram:
    return read_modules([(file.text, file.name) for file in files])


def _parts(file: ProgramFile) -> tuple[str, ...]:
    return tuple(name + SUFFIX for name in parts_called(file.text, file.name))


def _retract(retract: Retract, name: str, version: str) -> ProgramFile:
    return ProgramFile(name + SUFFIX, retract_to_rapid(retract, name, version))


RAPID = Dialect(
    CONTROLLERS["rapid"],
    SUFFIX,
    alike,
    RAPID_NAMES.of,
    _write,
    _read,
    _parts,
    _retract,
    examine=examine,
    most_holes=most_holes,
)
