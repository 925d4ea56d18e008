"""How the product judges a text that was made of an exported program: refused, refuted, or certified."""

from __future__ import annotations

from dataclasses import dataclass

from zerorev.errors import InputError
from zerorev.model.plan import Plan
from zerorev.model.written import WrittenProgram
from zerorev.program.as_exported import Expected, expected
from zerorev.program.dialect import Dialect, ProgramFile
from zerorev.program.export import export
from zerorev.verify.certificate.program import certify_program

__all__ = ["Judge"]


@dataclass(frozen=True)
class Judge:
    """A plan, and its program of one file.

    Attributes:
        plan: whose program is edited.
        dialect: in which it is written.
        text: as exported.
        wanted: what `export` writes of the plan.
    """

    plan: Plan
    dialect: Dialect
    text: str
    wanted: Expected

    @classmethod
    def of(cls, plan: Plan, dialect: Dialect) -> Judge:
        """The judge of the programs of a plan."""
        return cls(plan, dialect, export(plan, version="test").text, expected(plan, dialect))

    def read(self, text: str) -> WrittenProgram:
        """What the product reads.

        Raises:
            InputError: it refuses the text.
        """
        return self.dialect.read((ProgramFile(f"here{self.dialect.suffix}", text),))

    def judged(self, text: str) -> tuple[WrittenProgram | None, tuple[str, ...]]:
        """The program, and why it is refused or refuted, by reading and comparing alone; no ball arithmetic."""
        try:
            program = self.read(text)
            drilled = self.wanted.beside(program)  # refuses more holes than the plan has
        except InputError as refused:
            return None, (str(refused),)
        return program, tuple(reason for own in drilled for reason in own.wrong)

    def certified(self, program: WrittenProgram) -> bool:
        """Whether every hole is proven, as it is printed."""
        proofs = certify_program(self.plan, program, self.wanted.beside(program)).holes
        return all(hole.certificate.verdict == "certified" for hole in proofs)
