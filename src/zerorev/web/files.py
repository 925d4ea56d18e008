"""Files from and for the browser, read and written in a process of their own, between which a plan goes in pieces."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import fields, replace
from typing import Any

from zerorev.errors import InputError
from zerorev.files.cad.as_listed import Asked, cad_holes, read_cad
from zerorev.files.cad.listed_csv import csv_of
from zerorev.files.cell_file import cell_from_text
from zerorev.files.io import job_from_text, plan_from_text, plan_to_json
from zerorev.files.other_kinds import is_plan
from zerorev.files.text import json_text
from zerorev.files.validation import inside
from zerorev.model.job import Job
from zerorev.model.plan import Plan
from zerorev.model.ranges import Cell

__all__ = ["cut", "job_written", "parsed", "pieces", "plan_written", "read", "read_cad_file", "read_cell", "whole"]

HOLES = 200  # of a piece
BYTES = 2**20  # of a piece


def parsed(text: str, name: str) -> Job | Plan:
    """The job or the plan of a text; no file of this machine is opened but what ships with zerorev.

    Args:
        text: of a file.
        name: that it had, for messages.

    Raises:
        InputError: neither, or one that cannot be used.
    """
    return plan_from_text(text, name) if is_plan(text, name) else job_from_text(text, name)


def pieces(whole: Job | Plan) -> Iterator[Any]:
    """A job or a plan in pieces that are pickled in a moment each."""
    values = {field.name: getattr(whole, field.name) for field in fields(whole)}
    holes = values.pop("holes")
    yield type(whole), values
    for start in range(0, len(holes), HOLES):
        yield holes[start : start + HOLES]


def whole(pieces: Iterable[Any]) -> Any:
    """The job or the plan of `pieces`."""
    kind, values = next(iterator := iter(pieces))
    return kind(**values, holes=tuple(hole for piece in iterator for hole in piece))


def cut(content: bytes) -> Iterator[bytes]:
    """Bytes in pieces."""
    return (content[start : start + BYTES] for start in range(0, len(content), BYTES))


# --- tasks of `zerorev.apart` -------------------------------------------------------------------------------------


def read(given: Iterator[Any]) -> Iterator[Any]:
    """From a file's name and its content in bytes to the pieces of its job or plan.

    Raises:
        InputError: neither, or one that cannot be used.
    """
    name = next(given)
    return pieces(parsed(_text(given, name, "a job file (YAML) or a plan file (JSON)"), name))


def read_cell(given: Iterator[Any]) -> Iterator[Cell]:
    """From a file's name and its content in bytes to what it says of an arm.

    Raises:
        InputError: not a cell file, or one that cannot be used.
    """
    name = next(given)
    yield cell_from_text(_text(given, name, "a cell file (YAML)"), name)


def read_cad_file(given: Iterator[Any]) -> Iterator[Any]:
    """From a CAD file's name, the unit of its numbers or None, a point of the robot [mm], and its content in bytes.

    What comes of them is its holes as a table that a person looks through and edits, and what was assumed, in words.

    Raises:
        InputError: not a CAD file, or one that cannot be used.
    """
    name, unit, robot = next(given), next(given), next(given)
    content = b"".join(given)
    with inside(name):
        asked = Asked(unit=unit)
        listed = cad_holes(read_cad(content, name, asked, here=True), asked, robot)
    yield csv_of(listed)
    yield [*(finding.message for finding in listed.said), *listed.notes]


def _text(given: Iterator[bytes], name: str, accepted: str) -> str:
    try:
        return b"".join(given).decode("utf-8-sig")
    except UnicodeDecodeError:
        raise InputError("is not text", where=name, accepted=f"{accepted}, in UTF-8") from None


def plan_written(given: Iterator[Any]) -> Iterator[bytes]:
    """From the pieces of a plan to those of its file, with the moves between its holes.

    Raises:
        InputError: the plan holds a number that no plan file may hold.
    """
    from zerorev.planning.sequence import with_moves

    plan = whole(given)
    plan = replace(with_moves(plan), further=tuple(with_moves(each) for each in plan.further))
    return cut(json_text(plan_to_json(plan)).encode())


def job_written(given: Iterator[Any]) -> Iterator[tuple[str, str]]:
    """From the pieces of a job to its files, each by its name.

    Raises:
        InputError: its holes count their spins from different references, and a job file has one.
    """
    from zerorev.files.job_data import job_files

    yield from job_files(whole(given)).items()
