"""Commands that a page shows, with the lines of their output that it shows."""

from __future__ import annotations

import os
import re
import shlex
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

BLOCK = re.compile(r"(?ms)^```(\w+)([^\n]*)\n(.*?)^```$")
NUMBER = re.compile(r"[+-]?\d+(?:\.\d+)?")
AXIS = re.compile(r"A[1-6]")
COLUMNS = 250


@dataclass(frozen=True)
class Command:
    """A command as a page shows it.

    Attributes:
        arguments: what follows `$ zerorev`.
        lines: of its output, as shown; `...` stands for any number of lines, or for the rest of a line.
    """

    arguments: list[str]
    lines: list[str]


def blocks(page: Path, language: str) -> list[tuple[str, str]]:
    """What stands after the language, and the text, of every fenced block of a page."""
    found = BLOCK.findall(page.read_text(encoding="utf-8"))
    return [(after.strip(), text) for name, after, text in found if name == language]


def commands(page: Path) -> list[Command]:
    """The commands of a page's `console` blocks, in order."""
    found: list[Command] = []
    for _, text in blocks(page, "console"):
        for line in text.splitlines():
            if line.startswith("$ "):
                program, *arguments = shlex.split(line[2:])
                assert program == "zerorev", line
                found.append(Command(arguments, []))
            elif line.strip():
                found[-1].lines.append(line)
    return found


def run(command: Command, folder: Path) -> tuple[int, str]:
    """Run it in a folder: exit code, and what it wrote."""
    done = subprocess.run(
        [sys.executable, "-m", "zerorev.cli", *command.arguments], cwd=folder, capture_output=True, text=True,
        timeout=600, env={**os.environ, "COLUMNS": str(COLUMNS)},
    )  # fmt: skip
    return done.returncode, done.stdout + done.stderr


def same(shown: str, written: str) -> bool:
    """Whether a line is as shown: words alike, numbers within 1 % and one of the last digit, axes any.

    Which of two axes that are equally slow is named, and the last digit, differ between machines.
    """
    rest = shown.rstrip().endswith("...")
    wanted = shown.rstrip().removesuffix("...").split()
    given = written.split()
    if len(given) < len(wanted) or (len(given) > len(wanted) and not rest):
        return False
    return all(_same_word(a, b) for a, b in zip(wanted, given, strict=False))


def _same_word(shown: str, written: str) -> bool:
    numbers, others = NUMBER.findall(shown), NUMBER.findall(written)
    if NUMBER.sub("#", AXIS.sub("A", shown)) != NUMBER.sub("#", AXIS.sub("A", written)):
        return False
    if AXIS.fullmatch(shown) and AXIS.fullmatch(written):
        return True
    return all(
        abs(float(a) - float(b)) <= 0.01 * abs(float(a)) + 10.0 ** -len(a.partition(".")[2]) * ("." in a)
        for a, b in zip(numbers, others, strict=True)
    )


def missing(command: Command, output: str) -> str | None:
    """The first shown line that the output does not have, in order; None where all are there."""
    written = [line for line in output.splitlines() if line.strip() and not line.startswith("note:")]  # of progress
    place, free = 0, False
    for line in command.lines:
        if line.strip() == "...":
            free = True
            continue
        at = next((k for k in range(place, len(written)) if same(line, written[k])), None)
        if at is None or (at > place and not free):
            return f"{line!r} after {written[place - 1]!r}" if place else repr(line)
        place, free = at + 1, False
    return None if free or place == len(written) else f"more is written: {written[place]!r}"
