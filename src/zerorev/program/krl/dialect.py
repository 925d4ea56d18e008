"""KRL among the dialects."""

from __future__ import annotations

from collections.abc import Sequence

from zerorev.model.finding import Finding
from zerorev.model.written import WrittenProgram
from zerorev.program.dialect import Dialect, ProgramFile
from zerorev.program.krl.names import identifier
from zerorev.program.krl.read import read_krl
from zerorev.program.krl.source import alike
from zerorev.program.krl.write import refuse_other_makers, to_krl
from zerorev.program.neutral import Program

__all__ = ["KRL"]

SUFFIX = ".src"


def _write(program: Program, name: str, findings: tuple[Finding, ...], version: str | None) -> tuple[ProgramFile, ...]:
    return (ProgramFile(name + SUFFIX, to_krl(program, name=name, findings=findings, version=version)),)


def _read(files: Sequence[ProgramFile]) -> WrittenProgram:
    return read_krl(files[0].text, files[0].name)


KRL = Dialect("krl", "KUKA", SUFFIX, alike, identifier, refuse_other_makers, _write, _read)
