"""Is a program that was read back the one that `export` writes of a plan: statement by statement, in order.

The plan is exported again, in memory, and both texts are read by the same reader. Everything that the controller reads
must be equal: what is set before the first move and in which order, the moves, their feeds and blends, and nothing
else. Comments, white space, capitals and the header of the file may differ. A number of a point or a frame may differ
by one in its last printed digit, for a plan in memory and the same plan in a file differ in their last bits; every
other number must be equal.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from decimal import Decimal

from zerorev.errors import InputError
from zerorev.model.plan import Plan
from zerorev.model.written import Drilled, Statement, Word, WrittenHole, WrittenProgram
from zerorev.program.krl.read import read_krl
from zerorev.program.krl.text import identifier
from zerorev.program.krl.write import to_krl
from zerorev.program.neutral import Program, build_program, refusals

__all__ = ["Expected", "as_exported", "expected"]

MOST = 3  # differences that are named, per hole
ANGLES = ("A", "B", "C")


def as_exported(plan: Plan, program: WrittenProgram, file_name: str = "") -> tuple[Drilled, ...]:
    """What a program has for each hole of a plan, and what of it `export` does not write of this plan.

    Args:
        plan: verified; holes may have been left out of the program.
        program: as read back.
        file_name: of the program, without its ending: the program in it may be called so, or as the plan is.

    Raises:
        InputError: the program drills more holes than the plan.
        NotExportableError: the robot is not one for the program's language.
    """
    return expected(plan).beside(program, file_name)


def expected(plan: Plan) -> Expected:
    """What `export` writes of a plan, read back.

    Args:
        plan: verified.

    Raises:
        NotExportableError: the robot is not one for the program's language.
    """
    refused = refusals(plan)
    moving = tuple(hole.hole.id for hole in plan.holes if hole.motion is not None)
    if None in refused or all(hole_id in refused for hole_id in moving):
        return Expected(plan, refused, moving)
    exported = build_program(plan, skip_failed=True)
    program = _read_again(exported)
    holes = {hole.id: written for hole, written in zip(exported.holes, program.holes, strict=True)}
    return Expected(plan, refused, moving, exported, program.head, holes)


def _read_again(program: Program) -> WrittenProgram:
    return read_krl(to_krl(program, findings=(), version="as read back"))


@dataclass(frozen=True)
class Expected:
    """What the program of a plan must be.

    Attributes:
        plan: whose.
        refused: why a hole must not be exported, by its id.
        moving: ids of the holes that have a motion.
        exported: the moves of all that may be exported; None where nothing may.
        head: what stands before them.
        holes: what is written for each, by its id.
    """

    plan: Plan
    refused: Mapping[str | None, str]
    moving: tuple[str, ...]
    exported: Program | None = None
    head: tuple[Statement, ...] = ()
    holes: Mapping[str, WrittenHole] = field(default_factory=dict)

    def beside(self, program: WrittenProgram, file_name: str = "") -> tuple[Drilled, ...]:
        """What a program has for each hole of the plan, as `as_exported`."""
        drilled = dict(zip(self.moving, _paired(program, [self.holes.get(own) for own in self.moving]), strict=True))
        names = {identifier(self.plan.name), identifier(file_name or self.plan.name)}
        before = (*_name_differs(program, names), *self._head_differs(program, drilled))
        return tuple(self._hole(hole.hole.id, drilled.get(hole.hole.id), before) for hole in self.plan.holes)

    def _head_differs(self, program: WrittenProgram, drilled: Mapping[str, WrittenHole | None]) -> Iterator[str]:
        """All but the name; the speed at which the tool may turn depends on which holes are drilled."""
        if self.exported is None:
            return
        kept = tuple(hole for hole in self.exported.holes if drilled[hole.id] is not None)
        whole = len(kept) in (0, len(self.exported.holes))
        head = self.head if whole else _read_again(replace(self.exported, holes=kept)).head
        yield from _differences(program.head[1:], head[1:], program.holes[0].line)

    def _hole(self, hole_id: str, hole: WrittenHole | None, before: tuple[str, ...]) -> Drilled:
        if hole is None:
            return Drilled(None)
        if (wanted := self.holes.get(hole_id)) is None:
            why = self.refused.get(hole_id) or self.refused.get(None, "no reason given")
            return Drilled(hole, (f"line {hole.line}: the program drills this hole, which export refuses: {why}",))
        return Drilled(hole, (*before, *_differences(hole.statements, wanted.statements)))


def _paired(program: WrittenProgram, wanted: Sequence[WrittenHole | None]) -> list[WrittenHole | None]:
    """The program's hole for each of the plan's, in order: the one with the same moves, or else the next in turn.

    Comments do not name the holes: a controller does not read them, and neither does this.
    """
    spare = len(wanted) - len(program.holes)
    if spare < 0:
        holes = zip(program.holes, wanted, strict=False)
        extra = next((hole for hole, own in holes if own is None or not _alike(hole, own)), program.holes[len(wanted)])
        raise InputError(
            f"a hole that the plan does not have: the program drills {len(program.holes)}, the plan {len(wanted)}",
            where=f"program {program.name}, line {extra.line}",
            accepted="the holes of the plan from which it was exported, in their order",
        )
    paired: list[WrittenHole | None] = []
    for hole in program.holes:
        ahead = wanted[len(paired) : len(paired) + spare + 1]
        skipped = next((k for k, own in enumerate(ahead) if own is not None and _alike(hole, own)), 0)
        paired += [None] * skipped
        paired.append(hole)
        spare -= skipped
    return paired + [None] * spare


def _alike(hole: WrittenHole, wanted: WrittenHole) -> bool:
    return not any(_differences(hole.statements, wanted.statements))


def _name_differs(program: WrittenProgram, names: set[str]) -> Iterator[str]:
    if program.name.upper() not in {name.upper() for name in names}:
        line, accepted = program.head[0].line, " or ".join(sorted(names))
        yield f"line {line}: the program is called {program.name}; of this plan, or in this file, it is {accepted}"


def _differences(found: Sequence[Statement], wanted: Sequence[Statement], end: int = 0) -> Iterator[str]:
    """The first few statements that are not the ones expected.

    Args:
        found: in the program.
        wanted: as `export` writes them.
        end: line before which a statement that is missing at the end would stand; 0: after the last one found.
    """
    count = 0
    for own, other in zip(found, wanted, strict=False):
        if not _equal(own.words, other.words):
            yield f"line {own.line}: '{own.source}' stands where the plan has '{other.source}'"
            count += 1
            if count == MOST or len(found) != len(wanted):
                return  # what follows is out of step
    for own in found[len(wanted) :]:
        yield f"line {own.line}: '{own.source}' is not in the plan"
        return
    for other in wanted[len(found) :]:
        yield f"line {end or found[-1].line}: '{other.source}' is missing {'before' if end else 'after'} it"
        return


def _equal(found: Sequence[Word], wanted: Sequence[Word]) -> bool:
    if len(found) != len(wanted):
        return False
    rounded = "{" in wanted
    names = ("", *wanted)
    return all(
        own == other
        or (
            rounded
            and isinstance(own, Decimal)
            and isinstance(other, Decimal)
            and _rounds_alike(own, other, turns=name in ANGLES)
        )
        for own, other, name in zip(found, wanted, names, strict=False)
    )


def _rounds_alike(found: Decimal, wanted: Decimal, *, turns: bool) -> bool:
    """Whether a number is the one expected but for one in its last printed digit.

    Angles are written within (-180, 180], so that the one next to 180 is close to -180.
    """
    unit, off = Decimal(1).scaleb(int(wanted.as_tuple().exponent)), abs(found - wanted)
    return off <= unit or (turns and abs(off - 360) <= unit and min(found, wanted) > -180 and max(found, wanted) <= 180)
