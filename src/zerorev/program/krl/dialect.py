"""KRL among the dialects."""

from __future__ import annotations

from collections.abc import Sequence

from zerorev.model.corner import CONTROLLERS
from zerorev.model.finding import Finding
from zerorev.model.written import WrittenProgram
from zerorev.program.dialect import Dialect, ProgramFile
from zerorev.program.krl.modules import parts_called, read_modules
from zerorev.program.krl.names import KRL_NAMES
from zerorev.program.krl.retract import retract_to_krl
from zerorev.program.krl.source import alike
from zerorev.program.krl.write import krl_modules
from zerorev.program.neutral import Program
from zerorev.program.retract import Retract

__all__ = ["KRL"]

SUFFIX = ".src"


def _write(program: Program, name: str, findings: tuple[Finding, ...], version: str | None) -> tuple[ProgramFile, ...]:
    modules = krl_modules(program, name=name, findings=findings, version=version)
    return tuple(ProgramFile(each + SUFFIX, text) for each, text in modules.items())


def _read(files: Sequence[ProgramFile]) -> WrittenProgram:
    return read_modules([(file.text, file.name) for file in files])


def _parts(file: ProgramFile) -> tuple[str, ...]:
    return tuple(name + SUFFIX for name in parts_called(file.text, file.name))


def _retract(retract: Retract, name: str, version: str) -> ProgramFile:
    return ProgramFile(name + SUFFIX, retract_to_krl(retract, name, version))


KRL = Dialect(
    CONTROLLERS["krl"], SUFFIX, alike, KRL_NAMES.of, _write, _read, _parts, _retract, at_rest=1, asks_for_base=True
)
