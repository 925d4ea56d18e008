"""Whose program a file is, so that no export writes over the program of another plan."""

from __future__ import annotations

import hashlib
import json
import re
from collections.abc import Iterable
from pathlib import Path

from zerorev.errors import OutputError
from zerorev.files.output import as_output_error

__all__ = ["MARK", "check_replaceable", "plan_mark"]

MARK = "Plan file "
"""What stands before the mark in the comments of a program."""

_MARKED = re.compile(rf"{MARK}([0-9a-f]{{16}})\s".encode())
_HEAD = 2**20  # bytes: the mark is in the first lines, of some languages after all positions


def plan_mark(name: str, file: str) -> str:
    """16 hexadecimal digits by which the programs of a plan are known.

    A plan that was made again, in the file that it was in, has the same.

    Args:
        name: of the plan.
        file: name of the file that it is in, without its folder.
    """
    return hashlib.sha256(json.dumps([name, file]).encode()).hexdigest()[:16]


def check_replaceable(folder: Path, names: Iterable[str], mark: str, cure: str) -> None:
    """Make sure that what is called like a file that is to be written is a program of this plan.

    Args:
        folder: where the files are to be.
        names: of the files; capitals and small letters do not differ on a controller.
        mark: of the plan.
        cure: what to do where there is another file.

    Raises:
        OutputError: a file that is not, or of which it is not known; a folder that cannot be read.
    """
    wanted = {name.lower() for name in names}
    with as_output_error(folder):
        there = sorted(path for path in folder.iterdir() if path.name.lower() in wanted)
    for path in there:
        with as_output_error(path):
            found = _MARKED.search(_begin(path)) if path.is_file() else None
        if found is None or found[1].decode() != mark:
            raise OutputError(str(path), f"it is there, and it is not known to be a program of this plan; {cure}")


def _begin(path: Path) -> bytes:
    with path.open("rb") as stream:
        return stream.read(_HEAD)
