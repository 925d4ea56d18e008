"""What a controller's language must offer, and the files that a program consists of."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from zerorev.errors import InputError
from zerorev.model._arrays import transform
from zerorev.model.corner import Controller
from zerorev.model.finding import Finding
from zerorev.model.written import Word, WrittenProgram
from zerorev.program.names import Names
from zerorev.program.neutral import Program
from zerorev.program.parts import joined
from zerorev.program.reading import Starter
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
        suffix: of its files, with its dot.
        names: what the controller accepts as the name of a program.
        alike: (words found, words expected) -> whether two statements are the same but for the last printed digits.
        texts: (program, name, findings, version of zerorev) -> the text of each file by its name without the ending,
            the one that is started first.
        read_text: (text, file) -> what `texts` has written into a file that moves the robot; raises `InputError` at a
            statement of another form than `texts` writes, for it might move the robot in a way that nobody has
            examined.
        read_starter: (text, file) -> what one calls that moves nothing itself; None: it does.
        call: words of the statement that calls a part, of its name.
        frames: what the language calls tool and part frame, for a message.
        retract_text: (way out of a hole, name, version of zerorev) -> the text of a program; None: not offered.
        examine: what the language asks of a program beyond what all do; an error among the findings stops the export.
        most_holes: how many holes one file may have, so that the controller takes it; None: any number.
        at_rest: how many statements stand before those that call programs of the controller.
        asks_for_base: whether the part frame may be counted from where the controller says that the robot stands.
        no_retract: why no way out of a hole is offered, and what to do instead, for a message.
        weighs_digits: whether `examine` itself says which joints the digits of a program turn round.
    """

    controller: Controller
    suffix: str
    names: Names
    alike: Callable[[Sequence[Word], Sequence[Word]], bool]
    texts: Callable[[Program, str, tuple[Finding, ...], str | None], Mapping[str, str]]
    read_text: Callable[[str, str], WrittenProgram]
    read_starter: Callable[[str, str], Starter | None]
    call: Callable[[str], tuple[Word, ...]]
    frames: str
    retract_text: Callable[[Retract, str, str], str] | None = None
    examine: Callable[[Program], tuple[Finding, ...]] = lambda program: ()
    most_holes: Callable[[Program], int | None] = lambda program: None
    at_rest: int = 0
    asks_for_base: bool = False
    weighs_digits: bool = False
    no_retract: str = ""

    @property
    def name(self) -> str:
        """Of its folder."""
        return self.controller.name

    def program_name(self, text: str) -> str:
        """A name that the controller accepts, made of any text."""
        return self.names.of(text)

    def file(self, name: str, text: str) -> ProgramFile:
        """The file of a program of that name."""
        return ProgramFile(name + self.suffix, text)

    def write(
        self, program: Program, name: str, findings: tuple[Finding, ...], version: str | None
    ) -> tuple[ProgramFile, ...]:
        """The files of a program, the one that is started first.

        Args:
            program: what to write.
            name: of the program, as `program_name` makes it.
            findings: stated in it.
            version: of zerorev, stated in it; None: the installed one.

        Raises:
            NotExportableError: what the language cannot say.
        """
        return tuple(self.file(*each) for each in self.texts(program, name, findings, version).items())

    def read(self, files: Sequence[ProgramFile]) -> WrittenProgram:
        """What `write` has written, of several files as if it were one.

        Args:
            files: the one that is started, then the parts that it calls, in order.

        Raises:
            InputError: a statement of another form than `write` writes; parts that are not of one kind.
        """
        main, *others = files
        if not others:
            return self.read_text(main.text, main.name)
        starter = self.read_starter(main.text, main.name)
        if starter is None:
            accepted = "a program that only calls its parts"
            raise InputError("it moves the robot itself", where=main.name, accepted=accepted)
        name, statements = starter
        parts = [(file.name, self.read_text(file.text, file.name)) for file in others]
        return joined(name, main.name, statements, parts, self.frames)

    def parts(self, file: ProgramFile) -> tuple[str, ...]:
        """The files of the parts that a program calls; none where it moves the robot itself.

        Raises:
            InputError: a statement of another form than `write` writes.
        """
        starter, found = self.read_starter(file.text, file.name), list[str]()
        if starter is None:
            return ()
        name, statements = starter
        for statement in statements:
            if statement.words == self.call(part := self.names.part(name, len(found) + 1)):
                found.append(part)
        return tuple(part + self.suffix for part in found)
