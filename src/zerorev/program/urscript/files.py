"""A URScript program of several files read back: the one that is started, and the parts that it calls."""

from __future__ import annotations

from collections.abc import Sequence

from zerorev.errors import InputError
from zerorev.model.written import WrittenProgram
from zerorev.program.parts import joined
from zerorev.program.urscript.names import URSCRIPT_NAMES
from zerorev.program.urscript.read import read_starter, read_urscript

__all__ = ["parts_called", "read_files"]


def read_files(files: Sequence[tuple[str, str]]) -> WrittenProgram:
    """Read the text of a program of several files as if it were one.

    Args:
        files: text and name of each: the one that is started, then the parts that it calls, in order.

    Raises:
        InputError: as `read_urscript`; parts that are not of one kind.
    """
    (text, file), *others = files
    if not others:
        return read_urscript(text, file)
    starter = read_starter(text, file)
    if starter is None:
        raise InputError("it moves the robot itself", where=file, accepted="a program that only calls its parts")
    parts = [(name, read_urscript(text, name)) for text, name in others]
    return joined(starter[0], file, starter[1], parts, "set_tcp or part")


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
        if call.words == ((expected := URSCRIPT_NAMES.part(name, len(found) + 1)), "(", ")"):
            found.append(expected)
    return tuple(found)
