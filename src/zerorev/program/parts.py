"""A program of several files as one: the file that is started, and the parts that it calls."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace

from zerorev.errors import InputError
from zerorev.model.written import Statement, WrittenProgram

__all__ = ["joined"]


def joined(
    name: str, file: str, statements: Sequence[Statement], parts: Sequence[tuple[str, WrittenProgram]], frames: str
) -> WrittenProgram:
    """The program that several files are together.

    Args:
        name: of the program.
        file: that is started.
        statements: in it.
        parts: file and program of each part, in the order in which they are called.
        frames: what the language calls tool and part frame, for a message.

    Raises:
        InputError: a part has another tool or part frame than the first one.
    """
    read = [(_short(path), part) for path, part in parts]
    first, last = read[0][1], read[-1][1]
    for path, part in read:
        if (part.tool, part.base) != (first.tool, first.base):
            accepted = "the frames of the first part"
            raise InputError(f"{frames} differs from that of the first part", where=path, accepted=accepted)
    head = [_in_file(statement, _short(file)) for statement in statements]
    for path, part in read:
        head += [_in_file(each, path) for each in (*part.head, *(part.tail if part is not last else ()))]
    holes = tuple(
        replace(
            hole,
            statements=tuple(_in_file(each, path) for each in hole.statements),
            way=tuple(_in_file(each, path) for each in hole.way),
            file=path,
        )
        for path, part in read
        for hole in part.holes
    )
    tail = tuple(_in_file(each, read[-1][0]) for each in last.tail)
    sizes = tuple(len(part.holes) for _, part in read)
    return WrittenProgram(name, first.tool, first.base, holes, tuple(head), tail, sizes)


def _short(path: str) -> str:
    return re.split(r"[/\\]", path)[-1]


def _in_file(statement: Statement, file: str) -> Statement:
    return replace(statement, file=file)
