"""What the parts of the benchmark hand in, and the page that is made of it."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from string import Template

import numpy as np

from zerorev.files.output import write_text

__all__ = ["Goal", "Section", "load", "page", "save"]

MOST_FAILURES = 12  # printed on the page; the JSON file has all
TEMPLATE = Path(__file__).parent / "page.md"


@dataclass(frozen=True)
class Goal:
    """One line of the table of goals.

    Attributes:
        work: what is done.
        reference: figures of others, or earlier ones.
        goal: what must be reached.
        measured: what was.
    """

    work: str
    reference: str
    goal: str
    measured: str


@dataclass(frozen=True)
class Section:
    """What one part of the benchmark found.

    Attributes:
        name: of the part.
        title: heading on the page.
        columns: of the table.
        rows: of the table, in words.
        notes: a paragraph each, below the table.
        goals: lines for the table of goals.
        failures: what does not hold, one sentence each; empty where all is well.
        figures: what was measured, as numbers, for machines.
    """

    name: str
    title: str
    columns: tuple[str, ...]
    rows: Sequence[Sequence[str]]
    notes: Sequence[str] = ()
    goals: Sequence[Goal] = ()
    failures: Sequence[str] = ()
    figures: Mapping[str, object] | None = None


def save(section: Section, folder: Path) -> None:
    """Write a section as JSON."""
    folder.mkdir(parents=True, exist_ok=True)
    write_text(folder / f"{section.name}.json", json.dumps(asdict(section), indent=1, default=_plain) + "\n")


def _plain(value: object) -> object:
    """A NumPy number as one of Python's."""
    if isinstance(value, np.generic):
        return value.item()
    raise TypeError(f"{type(value).__name__} has no place in a JSON file")


def load(name: str, folder: Path) -> Section | None:
    """A section that was written before, or None."""
    path = folder / f"{name}.json"
    if not path.exists():
        return None
    data = json.loads(path.read_text(encoding="utf-8"))
    return Section(**{**data, "goals": [Goal(**goal) for goal in data["goals"]]})


def page(sections: Sequence[Section], machine: str) -> str:
    """The page in Markdown.

    Args:
        sections: in their order.
        machine: what ran them, when, with what versions.
    """
    columns = ("work, one core, compiled", "reference", "must reach", "measured")
    goals = [(goal.work, goal.reference, goal.goal, goal.measured) for section in sections for goal in section.goals]
    parts = []
    for section in sections:
        failures = [f"**Does not hold:** {failure}." for failure in section.failures[:MOST_FAILURES]]
        if (more := len(section.failures) - MOST_FAILURES) > 0:
            failures.append(f"And {more} more of the kind.")
        parts += [f"## {section.title}", _table(section.columns, section.rows), *filter(None, section.notes), *failures]
    text = Template(TEMPLATE.read_text(encoding="utf-8"))
    return text.substitute(goals=_table(columns, goals), machine=machine, sections="\n\n".join(parts))


def _table(columns: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    lines = [columns, ["---"] * len(columns), *rows]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)
