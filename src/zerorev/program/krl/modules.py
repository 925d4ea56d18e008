"""A KRL program of several files read back: the one that is started, and the parts that it calls."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace

from zerorev.errors import InputError
from zerorev.model.written import Statement, WrittenProgram
from zerorev.program.krl.names import KRL_NAMES
from zerorev.program.krl.read import read_krl, read_starter

__all__ = ["parts_called", "read_modules"]


def read_modules(files: Sequence[tuple[str, str]]) -> WrittenProgram:
    """Read the text of a program of several files as if it were one.

    Args:
        files: text and name of each: the one that is started, then the parts that it calls, in order.

    Raises:
        InputError: as `read_krl`; parts that are not of one kind.
    """
    (text, file), *others = files
    if not others:
        return read_krl(text, file)
    starter = read_starter(text, file)
    if starter is None:
        raise InputError("it moves the robot itself", where=file, accepted="a program that only calls its parts")
    read = [(_short(name), read_krl(text, name)) for text, name in others]
    first, last = read[0][1], read[-1][1]
    for name, part in read:
        if (part.tool, part.base) != (first.tool, first.base):
            accepted = "the frames of the first part"
            raise InputError("$TOOL or $BASE differs from that of the first part", where=name, accepted=accepted)
    head = [_in_file(statement, _short(file)) for statement in starter[1]]
    for name, part in read:
        head += [_in_file(each, name) for each in (*part.head, *(part.tail if part is not last else ()))]
    holes = tuple(
        replace(
            hole,
            statements=tuple(_in_file(each, name) for each in hole.statements),
            way=tuple(_in_file(each, name) for each in hole.way),
            file=name,
        )
        for name, part in read
        for hole in part.holes
    )
    tail = tuple(_in_file(each, read[-1][0]) for each in last.tail)
    sizes = tuple(len(part.holes) for _, part in read)
    return WrittenProgram(starter[0], first.tool, first.base, holes, tuple(head), tail, sizes)


def parts_called(text: str, file: str = "program") -> tuple[str, ...]:
    """The names of the parts that a program calls; none where it moves the robot itself.

    Raises:
        InputError: a statement that `export` does not write.
    """
    starter, found = read_starter(text, file), list[str]()
    if starter is None:
        return ()
    name, calls = starter
    for call in calls:
        if call.words == ((expected := KRL_NAMES.part(name, len(found) + 1)).upper(), "(", ")"):
            found.append(expected)
    return tuple(found)


def _short(path: str) -> str:
    return re.split(r"[/\\]", path)[-1]


def _in_file(statement: Statement, file: str) -> Statement:
    return replace(statement, file=file)
