"""The part of a plan that is finished: one line per hole, beside the file that they become.

A run that is interrupted, killed or out of power leaves it behind. The same command resumes, and what reads
plan files reads it, too.
"""

from __future__ import annotations

import hashlib
import json
import os
import re
import sys
import zlib
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from importlib.metadata import version
from pathlib import Path
from types import TracebackType
from typing import Any, BinaryIO

from zerorev.errors import InputError, OutputError
from zerorev.files.output import as_output_error, check_file, write_pieces
from zerorev.files.plan_conversion import answer_from
from zerorev.files.plan_data import (
    answer_data,
    asked_data,
    further_data,
    plan_head,
    sequence_data,
    with_further_strokes,
)
from zerorev.files.plan_schema import DepthHole, PlanHole
from zerorev.files.stated_forms import data_of
from zerorev.files.text import Document, json_pieces
from zerorev.files.units import plain
from zerorev.files.validation import checked
from zerorev.model.finding import Finding
from zerorev.model.hole import Hole
from zerorev.model.plan import HolePlan, Plan

__all__ = ["Part", "part_document"]

FORMAT = "zerorev.part/2"
ANSWERS = re.compile(r'\s*\{\s*"format":\s*"zerorev\.(?:plan|depth)/1",\s*"name":\s*("(?:[^"\\]|\\.)*")')
MOST_HEAD = 2**12  # [bytes] within which a file of answers says what it is
SUM = 9  # [bytes] at the end of a line: a blank, and the CRC-32 of what stands before it


class Part:
    """The finished holes of a job; used in a `with` statement, after which it is gone unless it can be resumed from.

    Attributes:
        path: of the file: that of the plan, with `.part` behind it.
        done: how many holes are finished, the first ones of the job.
    """

    def __init__(self, target: str | Path, plan: Plan, holes: Sequence[Hole]) -> None:
        """Begin a part, or continue with one that is there.

        Args:
            target: the file that it becomes.
            plan: all but its holes.
            holes: of the job.

        Raises:
            InputError: what is there is the part of something else.
            OutputError: it cannot be written, another run is writing it, or another job's answers are there, or no
                answers at all.
        """
        check_file(target)
        _check_replaced(Path(target), plan.name)
        self.path, self.done = Path(f"{target}.part"), 0
        check_file(self.path)
        self._target, self._strokes = target, plan.strokes
        self._form: type[PlanHole] | type[DepthHole] = PlanHole if plan.strokes == "asked" else DepthHole
        self._head = plan_head(plan)
        asked = json.dumps(plain([asked_data(hole) for hole in holes]))
        mark = {"zerorev": version("zerorev"), "asked": hashlib.sha256(asked.encode()).hexdigest(), "holes": len(holes)}
        first = _line({"format": FORMAT} | mark | {"head": self._head})
        with as_output_error(self.path):
            self._stream = self.path.open("a+b")
        try:
            self._go_on(first, [hole.id for hole in holes])
        except BaseException:
            self._stream.close()
            raise

    def _go_on(self, first: bytes, ids: list[str]) -> None:
        """Keep what is sound of what is there, and cut off the rest: a line that was not finished."""
        with as_output_error(self.path):
            _lock(self._stream, self.path)
            self._stream.seek(0)
            there = self._stream.readline()
            if there != first and (there.endswith(b"\n") or not first.startswith(there)):
                raise InputError(
                    "holds the finished holes of another job, of other settings or of another version",
                    where=str(self.path),
                    accepted="the command that began it; or delete it to begin again",
                )
            if there != first:
                self._stream.truncate(0)
                self._stream.write(first)
                self._stream.flush()
            self._start = end = len(first)
            for line, entry in _sound(self._stream):
                if self.done == len(ids) or entry.get("id") != ids[self.done]:
                    break
                self.done, end = self.done + 1, end + len(line)
            self._stream.truncate(end)

    def append(self, answer: HolePlan) -> None:
        """Keep the next hole's answer.

        Raises:
            InputError: it holds a number that no plan file may hold.
            OutputError: it cannot be written.
        """
        entry = answer_data(answer, self._strokes)
        checked(self._form, Document(f"hole {answer.hole.id}", entry))
        with as_output_error(self.path):
            self._stream.write(_line(entry))
            self._stream.flush()
        self.done += 1

    def answers(self) -> Iterator[HolePlan]:
        """The finished answers, as a plan file would hold them."""
        for i, entry in enumerate(self._entries()):
            where = f"{self.path}, line {i + 2}"
            form: PlanHole | DepthHole = checked(self._form, Document(where, entry))
            yield answer_from(form, where)

    def finish(self, plan: Plan, changed: Mapping[int, HolePlan], said: Sequence[Finding] = ()) -> None:
        """Write the file that it becomes, whole or not at all, and remove the part.

        Args:
            plan: with the order of the holes and the moves between them; its own holes do not matter.
            changed: answers that take the place of finished ones, by the number of the hole.
            said: findings of the whole plan that are known only at its end.

        Raises:
            OutputError: it cannot be written.
        """
        head = dict(self._head)
        findings = [*head.pop("findings"), *map(data_of, said)]
        entries = (
            with_further_strokes(answer_data(changed[n], self._strokes) if n in changed else entry, plan, n)
            for n, entry in enumerate(self._entries())
        )
        rest = sequence_data(plan) | {"findings": findings} | further_data(plan)
        write_pieces(self._target, json_pieces(head | {"holes": entries} | rest))
        self.done = 0

    def _entries(self) -> Iterator[dict[str, Any]]:
        self._stream.seek(self._start)
        return (entry for _, entry in _sound(self._stream))

    def __enter__(self) -> Part:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        if not self.done:
            self.path.unlink(missing_ok=True)
        with suppress(OSError):  # what could not be written, as on a full disk, it would try to write again
            self._stream.close()


def _check_replaced(target: Path, name: str) -> None:
    """Refuse to replace what a user would miss: answers of another job, a job, a program."""
    with as_output_error(target):
        if not target.exists():
            return
        with target.open("rb") as stream:
            head = stream.read(MOST_HEAD).decode("utf-8", "replace")
    if not head.strip():
        return
    found = ANSWERS.match(head)
    if found is None:
        raise OutputError(str(target), "it holds no answers of zerorev; delete it, or choose another name")
    if (there := json.loads(found[1], strict=False)) != name:
        raise OutputError(str(target), f"it holds those of the job '{there}'; delete it, or choose another name")


def part_document(text: str, file: str) -> Document | None:
    """A part as the plan of its finished holes, with a finding that says what it is; None where the text is not a part.

    Args:
        text: of the file.
        file: how messages name it.

    Raises:
        InputError: no hole is finished.
    """
    if not text.startswith(f'{{"format": "{FORMAT}"'):
        return None
    entries = [entry for _, entry in _sound(text.encode().splitlines(keepends=True))]
    match entries:
        case [{"head": {"findings": [*findings], **head}, "holes": int(count)}, _, *_]:
            message = (
                f"only {len(entries) - 1} of {count} holes are finished; the command that began it continues with it"
            )
            unfinished = {"level": "error", "kind": "unfinished", "message": message, "hole": None}
            return Document(file, head | {"holes": entries[1:], "findings": [*findings, unfinished]})
    raise InputError("holds no finished hole", where=file, accepted="one finished hole or more")


def _line(data: dict[str, Any]) -> bytes:
    entry = json.dumps(data, ensure_ascii=False, allow_nan=False).encode()
    return entry + _sum(entry) + b"\n"


def _sum(entry: bytes) -> bytes:
    return b" %08x" % zlib.crc32(entry)


def _sound(lines: Iterable[bytes]) -> Iterator[tuple[bytes, dict[str, Any]]]:
    """The lines up to the first that is cut short or damaged, each with what it holds."""
    for line in lines:
        text, end = line[: -SUM - 1], line[-SUM - 1 :]
        if end != _sum(text) + b"\n":
            return
        try:
            entry = json.loads(text)
        except (ValueError, RecursionError):
            return
        if not isinstance(entry, dict):
            return
        yield line, entry


def _lock(stream: BinaryIO, path: Path) -> None:
    """Keep other runs from writing the same part; the system unlocks it with the end of the process."""
    if sys.platform != "win32":
        import fcntl

        try:
            fcntl.flock(stream, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            raise OutputError(os.fspath(path), "another run is writing it") from None
