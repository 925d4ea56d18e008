"""The check of the project's English: words that a reader whose first language is another stumbles over (`make lint`).

`python tools/plain_english.py [PATH ...]` reads the text that people read: Python with its names, pages, job files,
and what the app sends to a browser. Each word of `plain_english.txt` that it finds is printed as FILE:LINE, with what
to write instead, and it exits with 1. A line that quotes somebody else's words, or needs a word of a library, ends with
the mark "plain English: quoted".
"""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).parents[1]
WORDS = Path(__file__).with_suffix(".txt")
READ = {".py", ".md", ".js", ".css", ".html", ".yaml", ".yml", ".toml", ".cff"}
UNREAD = ("tests/golden/", "tests/data/", "tests/test_plain_english.py", "tools/plain_english.py")
QUOTED = "plain English: quoted"
BEGIN = r"(?:(?<![a-z])|(?<=\\n))"  # not within a word; the n of an escaped line feed is none of it
GAP = r"(?:_|\s+(?:#:?\s+|//\s+|\*\s+)?)"  # between two words of a phrase: also from a line to the next


class Word(NamedTuple):
    """A word or phrase that is not plain.

    Attributes:
        pattern: what it looks like.
        instead: what to write.
    """

    pattern: re.Pattern[str]
    instead: str


def words(listed: str) -> list[Word]:
    """The words of a list, in its order."""
    found = []
    for line in listed.splitlines():
        if line and not line.startswith("#"):
            pattern, instead = line.split(" -> ")
            form = rf"{BEGIN}(?:{pattern.replace(' ', GAP)})(?![a-z])"
            found.append(Word(re.compile(form, re.IGNORECASE), instead))
    return found


def findings(text: str, listed: list[Word]) -> list[tuple[int, str, str]]:
    """Line, words and what to write instead, of each place in a text that is not plain."""
    lines = text.splitlines()
    found = []
    for word in listed:
        for place in word.pattern.finditer(text):
            line = text.count("\n", 0, place.start())
            if QUOTED not in lines[line]:
                found.append((line + 1, " ".join(place.group().split()), word.instead))
    return sorted(found)


def main(paths: list[str]) -> int:
    """Print what is not plain in some files, or in all that are under version control; 1 if there is any."""
    listed = words(WORDS.read_text(encoding="utf-8"))
    if not paths:
        command = ["git", "ls-files", "--cached", "--others", "--exclude-standard"]
        paths = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True).stdout.splitlines()
    count = 0
    for path in map(Path, paths):
        if path.suffix not in READ or path.as_posix().startswith(UNREAD) or not (ROOT / path).is_file():
            continue
        for line, found, instead in findings((ROOT / path).read_text(encoding="utf-8"), listed):
            count += 1
            sys.stdout.write(f'{path}:{line}: "{found}": write {instead}\n')
    return min(count, 1)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
