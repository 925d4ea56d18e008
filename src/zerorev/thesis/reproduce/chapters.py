"""The parts of the thesis that are reproduced, in its order."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from zerorev.errors import InputError
from zerorev.thesis.reproduce import (
    errata,
    experiments,
    fig26,
    kinematics,
    rates,
    sample,
    strokes,
    swarm,
    tuning,
    twist,
    workspace,
)
from zerorev.thesis.reproduce.context import Context
from zerorev.thesis.reproduce.section import Section

__all__ = ["CHAPTERS", "Part", "parts_of"]


@dataclass(frozen=True)
class Part:
    """One section of the page.

    Attributes:
        key: of its file and its place on the page.
        title: its heading.
        source: where the thesis has it.
        make: computes it.
        headings: of the two columns that hold ours.
    """

    key: str
    title: str
    source: str
    make: Callable[[Context], Section]
    headings: tuple[str, str] = ("ours, by its method", "ours, exact")


CELL = ("in the virtual cell", "")

CHAPTERS: dict[str, tuple[Part, ...]] = {
    "chapter4": (
        Part("kinematics", "The arm: two tables of one robot", "sec. 3.3 to 3.5, Tables 1 and 2", kinematics.make),
        Part("swarm", "How a swarm behaves", "sec. 4.1, Figures 5 and 7", swarm.make),
        Part("sample", "A sample drilling path", "sec. 4.4, Figures 10 and 11", sample.make),
        Part("tuning", "Eight trials", "sec. 4.5, Tables 3 and 4, Figures 12 to 19", tuning.make),
        Part("rates", "How often a swarm finds zero", "sec. 4.4 and 5.4", rates.make),
        Part("strokes", "The deepest stroke", "sec. 4.6, eq. 4.9 and 4.10", strokes.make),
        Part("workspace", "Where in the cell", "sec. 4.6, Table 5, Figures 20 to 25", workspace.make),
        Part("map", "The parameter map", "sec. 4.7, Figure 26, eq. 4.11 and 4.12", fig26.make),
        Part(
            "twist",
            "Symmetry, chaining, and where the rotation goes",
            "sec. 4.7 and 5.5, eq. 4.11 to 4.15, 5.4",
            twist.make,
        ),
        Part("errata", "Errata", "throughout", errata.make, ("as printed", "as needed")),
    ),
    "chapter5": (
        Part("joints", "The motions as run", "sec. 5.3, Figures 30 to 33, 37, 38, 41, 42", experiments.joints, CELL),
        Part("torques", "The torques", "sec. 5.2 and 5.4, Figures 28, 29, 34, 39, 43", experiments.torques, CELL),
        Part("deviation", "The deviation of the tip", "sec. 5.4, Figures 35, 36, 40, 44", experiments.deviation, CELL),
        Part("rests", "What the gain rests on", "sec. 5.5 and 6.2", experiments.rests, ("published", "planned")),
    ),
}
"""The chapters that can be reproduced."""


def parts_of(chapter: str) -> tuple[Part, ...]:
    """The parts of a chapter, or of `all`.

    Raises:
        InputError: no such chapter, or one that is not there yet.
    """
    known = ", ".join((*CHAPTERS, "all"))
    if chapter == "all":
        return tuple(part for parts in CHAPTERS.values() for part in parts)
    if chapter in CHAPTERS:
        return CHAPTERS[chapter]
    raise InputError(f"unknown chapter '{chapter}'", where="reproduce", accepted=known)
