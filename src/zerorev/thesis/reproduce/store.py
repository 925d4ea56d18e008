"""Finished sections on disk: each is written whole when it is done, and taken up again as long as it is not stale."""

from __future__ import annotations

import hashlib
import json
from functools import cache
from importlib.metadata import version
from importlib.resources import files
from importlib.resources.abc import Traversable
from pathlib import Path
from typing import Any

from zerorev.files.output import as_output_error, make_folder, write_bytes, write_text
from zerorev.files.text import json_text
from zerorev.thesis.reproduce.context import Context
from zerorev.thesis.reproduce.section import Section

__all__ = ["Store", "fingerprint"]

FORMAT = "zerorev.section/1"
SOURCES = (".py", ".yaml", ".j2")


class Store:
    """The folder of a reproduction: `sections`, `figures` and `tables` beside its page.

    Args:
        folder: made if its parent exists.
        context: that its sections were or will be made with.
    """

    def __init__(self, folder: Path, context: Context) -> None:
        self.folder, self.mark = folder, fingerprint(context)
        self.sections, self.figures, self.tables = (folder / name for name in ("sections", "figures", "tables"))
        for each in (folder, self.sections, self.figures, self.tables):
            make_folder(each)

    def read(self, key: str) -> Section | None:
        """A finished section, or None where there is none, or one of another version, of other seeds, or damaged."""
        try:
            data = json.loads((self.sections / f"{key}.json").read_text(encoding="utf-8"))
            if data["format"] != FORMAT or data["made_with"] != self.mark:
                return None
            pictures = {}
            for name, digest in data["digests"].items():
                pictures[name] = (self.figures / f"{name}.png").read_bytes()
                if hashlib.sha256(pictures[name]).hexdigest() != digest:
                    return None
            section = Section.of(data["section"], pictures)
        except (OSError, ValueError, LookupError, TypeError, AttributeError):
            return None
        if not all((self.tables / f"{table.name}.csv").is_file() for table in section.tables):
            return None
        return section

    def write(self, key: str, section: Section) -> None:
        """Keep a section: its figures and tables first, and last the file that says that it is finished.

        Raises:
            OutputError: a file cannot be written.
        """
        path = self.sections / f"{key}.json"
        with as_output_error(path):
            path.unlink(missing_ok=True)
        for picture in section.pictures:
            write_bytes(self.figures / f"{picture.name}.png", picture.png)
        for table in section.tables:
            write_text(self.tables / f"{table.name}.csv", table.csv())
        digests = {picture.name: hashlib.sha256(picture.png).hexdigest() for picture in section.pictures}
        data = {"format": FORMAT, "made_with": self.mark, "digests": digests, "section": section.data()}
        write_text(path, json_text(data))


def fingerprint(context: Context) -> dict[str, Any]:
    """What a section depends on: when any of it differs, the section is made again."""
    return {
        "version": version("zerorev"),
        "sources": _digest_of_sources(),
        "seeds": context.seeds,
        "map_size": context.map_size,
        "robot": context.robot.name,
        "tool": context.tool.name,
    }


@cache
def _digest_of_sources() -> str:
    digest = hashlib.sha256()
    _feed(digest, files("zerorev"))
    return digest.hexdigest()[:16]


def _feed(digest: Any, folder: Traversable) -> None:
    for entry in sorted(folder.iterdir(), key=lambda each: each.name):
        if entry.is_dir():
            _feed(digest, entry)
        elif entry.name.endswith(SOURCES):
            digest.update(entry.name.encode() + entry.read_bytes())
