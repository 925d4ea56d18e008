"""What a controller's language must offer, and the files that a program consists of."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from zerorev.model._arrays import transform
from zerorev.model.corner import Controller
from zerorev.model.finding import Finding
from zerorev.model.written import Word, WrittenProgram
from zerorev.program.neutral import Program
from zerorev.program.retract import Retract

__all__ = ["Z_ALONG_PLUNGE", "Dialect", "ProgramFile"]

Z_ALONG_PLUNGE = transform(np.diag([1.0, -1.0, -1.0]), np.zeros(3))
"""The tool frame as most languages have it, in the tcp frame: Z along the plunge (Z = -Z_tcp), X = X_tcp."""


@dataclass(frozen=True)
class ProgramFile:
    """A file of a program.

    Attributes:
        name: with its ending, as the controller wants it.
        text: lines ended by a newline.
    """

    name: str
    text: str


@dataclass(frozen=True)
class Dialect:
    """The language of one maker's controllers.

    Attributes:
        controller: what is known of these; its name is that of the folder, and what `--controller` takes.
        suffix: of the file that is given to the reader, with its dot.
        alike: (words found, words expected) -> whether two statements are the same but for the last printed digits.
        program_name: makes a name that the controller accepts of any text.
        write: (program, name, findings, version of zerorev) -> its files, the one that is started first.
        read: what `write` has written, the file that is started first; raises `InputError` at a statement of another
            form than `write` writes, for it might move the robot in a way that nobody has examined.
        parts: of the file that is started -> the names of the others, in order.
        retract: (way out of a hole, name, version of zerorev) -> the file of a program; None: not offered.
        examine: what the language asks of a program beyond what all do; an error among the findings stops the export.
        most_holes: how many holes one file may have, so that the controller takes it; None: any number.
        at_rest: how many statements stand before those that call programs of the controller.
        asks_for_base: whether the part frame may be counted from where the controller says that the robot stands.
    """

    controller: Controller
    suffix: str
    alike: Callable[[Sequence[Word], Sequence[Word]], bool]
    program_name: Callable[[str], str]
    write: Callable[[Program, str, tuple[Finding, ...], str | None], tuple[ProgramFile, ...]]
    read: Callable[[Sequence[ProgramFile]], WrittenProgram]
    parts: Callable[[ProgramFile], tuple[str, ...]]
    retract: Callable[[Retract, str, str], ProgramFile] | None = None
    examine: Callable[[Program], tuple[Finding, ...]] = lambda program: ()
    most_holes: Callable[[Program], int | None] = lambda program: None
    at_rest: int = 0
    asks_for_base: bool = False

    @property
    def name(self) -> str:
        """Of its folder."""
        return self.controller.name
