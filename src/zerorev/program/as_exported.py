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
from itertools import groupby

from zerorev.errors import InputError, NotExportableError
from zerorev.model.controller import ROBROOT
from zerorev.model.plan import Plan
from zerorev.model.written import Drilled, Statement, WrittenHole, WrittenProgram
from zerorev.program.dialect import Dialect
from zerorev.program.neutral import Program, build_program
from zerorev.program.refusals import refusals, refuse_other_makers

__all__ = ["Expected", "as_exported", "expected"]

MOST = 3  # differences that are named, per hole


def as_exported(plan: Plan, program: WrittenProgram, dialect: Dialect, file_name: str = "") -> tuple[Drilled, ...]:
    """What a program has for each hole of a plan, and what of it `export` does not write of this plan.

    Args:
        plan: verified; holes may have been left out of the program.
        program: as read back.
        dialect: in which it is written.
        file_name: of the program, without its ending: the program in it may be called so, or as the plan is.

    Raises:
        InputError: the program drills more holes than the plan.
        NotExportableError: the robot is not one for the program's language.
    """
    return expected(plan, dialect).beside(program, file_name)


def expected(plan: Plan, dialect: Dialect) -> Expected:
    """What `export` writes of a plan, read back.

    Args:
        plan: verified.
        dialect: in which it would be written.

    Raises:
        NotExportableError: the robot is not one for the program's language.
    """
    refuse_other_makers(dialect.name, plan.robot)
    refused = refusals(plan)
    moving = tuple(hole.hole.id for hole in plan.in_order if hole.motion is not None)
    if None in refused or all(hole_id in refused for hole_id in moving):
        return Expected(plan, dialect, refused, moving)
    try:
        exported = build_program(plan, skip_failed=True)
    except NotExportableError as refusal:  # a move between two holes
        return Expected(plan, dialect, {None: "; ".join(refusal.reasons)}, moving)
    program = _with_end(plan, _read_again(exported, dialect), dialect)
    holes = {hole.id: written for hole, written in zip(exported.holes, program.holes, strict=True)}
    return Expected(plan, dialect, refused, moving, program, holes)


def _read_again(program: Program, dialect: Dialect, name: str = "") -> WrittenProgram:
    return dialect.read(dialect.write(program, dialect.program_name(name or program.name), (), "as read back"))


def _with_end(plan: Plan, program: WrittenProgram, dialect: Dialect) -> WrittenProgram:
    """The program with what is called after the job in its `tail`: a reader cannot know it from the last hole's."""
    last, count = program.holes[-1], len(plan.settings.calls.after_job)
    if count == 0:
        return program
    count += dialect.at_rest
    calls = last.statements[-count:]
    if program.tail or program.parts or calls[0].line <= last.moves[-1].line:
        return program
    last = replace(last, statements=last.statements[:-count])
    return replace(program, holes=(*program.holes[:-1], last), tail=calls)


@dataclass(frozen=True)
class Expected:
    """What the program of a plan must be.

    Attributes:
        plan: whose.
        dialect: in which it is written.
        refused: why a hole must not be exported, by its id.
        moving: ids of the holes that have a motion, as they are drilled.
        program: of all that may be exported, read back; None where nothing may.
        holes: what is written for each, by its id.
    """

    plan: Plan
    dialect: Dialect
    refused: Mapping[str | None, str]
    moving: tuple[str, ...]
    program: WrittenProgram | None = None
    holes: Mapping[str, WrittenHole] = field(default_factory=dict)

    def beside(self, program: WrittenProgram, file_name: str = "") -> tuple[Drilled, ...]:
        """What a program has for each hole of the plan, as `as_exported`."""
        program = _with_end(self.plan, program, self.dialect)
        drilled = dict(
            zip(self.moving, _paired(program, [self.holes.get(own) for own in self.moving], self.dialect), strict=True)
        )
        names = {self.dialect.program_name(name) for name in (self.plan.name, file_name or self.plan.name)}
        before = tuple(_name_differs(program, names))
        around: dict[str, tuple[str, ...]] = {}
        kept = tuple(hole_id for hole_id in self.holes if drilled[hole_id] is not None)
        try:
            wanted = self._of(kept, program, drilled)
        except NotExportableError as refusal:  # a move between two holes
            before += tuple(f"export refuses these holes one after the other: {why}" for why in refusal.reasons)
        else:
            if wanted is not None:
                before += self._head_differs(kept, wanted, program)
                around = self._around(kept, wanted, program, drilled)
        return tuple(
            self._hole(hole.hole.id, drilled.get(hole.hole.id), (*before, *around.get(hole.hole.id, ())))
            for hole in self.plan.holes
        )

    def _head_differs(self, kept: tuple[str, ...], wanted: WrittenProgram, program: WrittenProgram) -> tuple[str, ...]:
        """What differs before the first hole, but for the program's name.

        Where the plan does not say where the robot stands, the program may ask the controller for it: the part frame is
        one of the robot's own base.
        """
        line = program.holes[0].line
        found = tuple(_differences(program.head[1:], wanted.head[1:], self.dialect, line))
        known = self.plan.settings.robroot is not None or not self.dialect.asks_for_base
        if not found or known or program.parts:
            return found
        asking = replace(self.plan, settings=replace(self.plan.settings, robroot=ROBROOT))
        other = _read_again(build_program(asking, skip_failed=True, only=kept), self.dialect)
        return found if any(_differences(program.head[1:], other.head[1:], self.dialect, line)) else ()

    def _of(
        self, kept: tuple[str, ...], program: WrittenProgram, drilled: Mapping[str, WrittenHole | None]
    ) -> WrittenProgram | None:
        """The program of some of the holes, on which its head and the ways between them depend; None of no holes.

        It is split into parts as the one that was read, of which any number of holes is right.
        """
        if not kept or (len(kept) == len(self.holes) and not program.parts):
            return self.program if kept else None
        wanted = build_program(self.plan, skip_failed=True, only=kept)
        if not program.parts:
            return _with_end(self.plan, _read_again(wanted, self.dialect), self.dialect)
        files = [hole.file for hole_id in kept if (hole := drilled[hole_id])]
        parts = tuple(len(list(same)) for _, same in groupby(files))
        return _read_again(replace(wanted, parts=parts), self.dialect, program.name)

    def _around(
        self,
        kept: tuple[str, ...],
        wanted: WrittenProgram,
        program: WrittenProgram,
        drilled: Mapping[str, WrittenHole | None],
    ) -> dict[str, tuple[str, ...]]:
        """What differs on the way to each hole, and after the last one."""
        found: dict[str, tuple[str, ...]] = {}
        for hole_id, own in zip(kept, wanted.holes, strict=True):
            hole = drilled[hole_id]
            assert hole is not None
            found[hole_id] = tuple(_differences(hole.way, own.way, self.dialect, hole.line))
        end = program.holes[-1].moves[-1].line + 1
        found[kept[-1]] += tuple(_differences(program.tail, wanted.tail, self.dialect, end))
        return found

    def _hole(self, hole_id: str, hole: WrittenHole | None, before: tuple[str, ...]) -> Drilled:
        if hole is None:
            return Drilled(None)
        if (wanted := self.holes.get(hole_id)) is None:
            why = self.refused.get(hole_id) or self.refused.get(None, "no reason given")
            return Drilled(
                hole, (f"{hole.statements[0].at}: the program drills this hole, which export refuses: {why}",)
            )
        return Drilled(hole, (*before, *_differences(hole.statements, wanted.statements, self.dialect)))


def _paired(
    program: WrittenProgram, wanted: Sequence[WrittenHole | None], dialect: Dialect
) -> list[WrittenHole | None]:
    """The program's hole for each of the plan's, in order: the one with the same moves, or else the next in turn.

    Comments do not name the holes: a controller does not read them, and neither does this.
    """
    spare = len(wanted) - len(program.holes)
    if spare < 0:
        holes = zip(program.holes, wanted, strict=False)
        extra = next(
            (hole for hole, own in holes if own is None or not _alike(hole, own, dialect)), program.holes[len(wanted)]
        )
        raise InputError(
            f"a hole that the plan does not have: the program drills {len(program.holes)}, the plan {len(wanted)}",
            where=f"program {program.name}, line {extra.line}",
            accepted="the holes of the plan from which it was exported, in their order",
        )
    paired: list[WrittenHole | None] = []
    for hole in program.holes:
        ahead = wanted[len(paired) : len(paired) + spare + 1]
        skipped = next((k for k, own in enumerate(ahead) if own is not None and _alike(hole, own, dialect)), 0)
        paired += [None] * skipped
        paired.append(hole)
        spare -= skipped
    return paired + [None] * spare


def _alike(hole: WrittenHole, wanted: WrittenHole, dialect: Dialect) -> bool:
    return not any(_differences(hole.statements, wanted.statements, dialect))


def _name_differs(program: WrittenProgram, names: set[str]) -> Iterator[str]:
    if program.name.upper() not in {name.upper() for name in names}:
        line, accepted = program.head[0].line, " or ".join(sorted(names))
        yield f"line {line}: the program is called {program.name}; of this plan, or in this file, it is {accepted}"


def _differences(
    found: Sequence[Statement], wanted: Sequence[Statement], dialect: Dialect, end: int = 0
) -> Iterator[str]:
    """The first few statements that are not the ones expected.

    Args:
        found: in the program.
        wanted: as `export` writes them.
        dialect: says which statements are alike.
        end: line before which a statement that is missing at the end would stand; 0: after the last one found.
    """
    count = 0
    for own, other in zip(found, wanted, strict=False):
        if not dialect.alike(own.words, other.words):
            yield f"{own.at}: '{own.source}' stands where the plan has '{other.source}'"
            count += 1
            if count == MOST or len(found) != len(wanted):
                return  # what follows is out of step
    for own in found[len(wanted) :]:
        yield f"{own.at}: '{own.source}' is not in the plan"
        return
    for other in wanted[len(found) :]:
        at = f"line {end}" if end or not found else found[-1].at
        yield f"{at}: '{other.source}' is missing {'before' if end else 'after'} it"
        return
