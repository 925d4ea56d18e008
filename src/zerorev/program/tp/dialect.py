"""TP among the dialects."""

from __future__ import annotations

from collections.abc import Sequence

from zerorev.errors import InputError
from zerorev.model.corner import CONTROLLERS
from zerorev.model.finding import Finding
from zerorev.model.written import WrittenProgram
from zerorev.program.dialect import Dialect, ProgramFile
from zerorev.program.neutral import Program
from zerorev.program.parts import joined
from zerorev.program.tp.examine import examine
from zerorev.program.tp.names import TP_NAMES
from zerorev.program.tp.read import read_starter, read_tp
from zerorev.program.tp.source import alike
from zerorev.program.tp.write import SUFFIX, most_holes, too_large, write_tp

__all__ = ["TP"]


def _read(files: Sequence[ProgramFile]) -> WrittenProgram:
    """A program of one file, or of several as if it were one."""
    first, *others = files
    if not others:
        return read_tp(first.text, first.name)
    starter = read_starter(first.text, first.name)
    if starter is None:
        raise InputError("it moves the robot itself", where=first.name, accepted="a program that only calls its parts")
    parts = [(file.name, read_tp(file.text, file.name)) for file in others]
    return joined(starter[0], first.name, starter[1], parts, "the user frame")


def _parts(file: ProgramFile) -> tuple[str, ...]:
    """The files of the parts that a program calls; none where it moves the robot itself."""
    starter = read_starter(file.text, file.name)
    if starter is None:
        return ()
    (name, statements), found = starter, list[str]()
    for statement in statements:
        if statement.words == ("CALL", part := TP_NAMES.part(name, len(found) + 1)):
            found.append(part)
    return tuple(name + SUFFIX for name in found)


def _examine(program: Program) -> tuple[Finding, ...]:
    return (*examine(program), *too_large(program))


TP = Dialect(CONTROLLERS["tp"], SUFFIX, alike, TP_NAMES.of, write_tp, _read, _parts, None, _examine, most_holes)
