"""A file of what is finished of long work, a line each, so that a run that was killed can be resumed."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from zerorev.files.output import write_text

__all__ = ["Finished"]


class Finished:
    """Lines of JSON, each one thing that is finished and what it was made with; a line that was cut short is left out.

    Attributes:
        known: what was there before and was made with the same, by key.
    """

    def __init__(self, path: Path, made_with: Mapping[str, Any], key: Callable[[dict[str, Any]], Any]) -> None:
        """Read what is there; what was made with something else is dropped from the file.

        Args:
            path: of the file.
            made_with: all that the results depend on.
            key: of an entry.
        """
        self._path, self._made_with = path, json.loads(json.dumps(made_with))
        path.parent.mkdir(parents=True, exist_ok=True)
        lines = path.read_text(encoding="utf-8", errors="replace").splitlines() if path.exists() else []
        entries = [entry for line in lines if (entry := self._entry(line)) is not None]
        write_text(path, "".join(self._line(entry) for entry in entries))
        self.known = {key(entry): entry for entry in entries}

    def add(self, entry: Mapping[str, Any]) -> None:
        """Write one more, through to the disk."""
        with self._path.open("a", encoding="utf-8") as stream:
            stream.write(self._line(entry))
            stream.flush()
            os.fsync(stream.fileno())

    def remove(self) -> None:
        """Remove the file: all is finished."""
        self._path.unlink(missing_ok=True)

    def _line(self, entry: Mapping[str, Any]) -> str:
        return json.dumps({"made_with": self._made_with, **entry}) + "\n"

    def _entry(self, line: str) -> dict[str, Any] | None:
        try:
            entry = json.loads(line)
        except ValueError:
            return None
        if not isinstance(entry, dict) or entry.pop("made_with", None) != self._made_with:
            return None
        return entry
