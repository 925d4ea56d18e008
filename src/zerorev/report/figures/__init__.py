"""Figures of a plan, one function a figure; matplotlib is imported here and nowhere else."""

from __future__ import annotations

import re
from collections.abc import Callable, Collection, Iterable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

from matplotlib.figure import Figure

from zerorev.files.output import make_folder, write_bytes
from zerorev.model.plan import HolePlan, Plan
from zerorev.model.strokes import each_stroke
from zerorev.report.figures.joints import joint_angles
from zerorev.report.figures.plane import twist_plane
from zerorev.report.figures.rates import critical_rates
from zerorev.report.figures.style import png
from zerorev.workers import HERE, Machines, Workers

__all__ = ["FIGURES", "critical_rates", "drawn", "file_stems", "joint_angles", "picture_count", "twist_plane",
           "write_figures"]  # fmt: skip

FIGURES: dict[str, Callable[[Plan, HolePlan], Figure]] = {
    "joint_angles": joint_angles,
    "twist_plane": twist_plane,
    "critical_rates": critical_rates,
}
OF_ALL_STROKES = ("joint_angles", "twist_plane")  # what is drawn of a hole of several strokes besides, as a whole
LONGEST_STEM = 80


def write_figures(
    plan: Plan,
    folder: Path,
    progress: Callable[[int, int], None] | None = None,
    *,
    ids: Collection[str] | None = None,
    machines: Machines = HERE,
) -> list[Path]:
    """Write the figures of each hole that has a motion as `HOLE_FIGURE.png`, of every tool; others are skipped.

    Args:
        plan: what to draw.
        folder: where to; made if its parent exists.
        progress: called with the number of pictures drawn and in all.
        ids: of the holes to draw; None: all.
        machines: to draw on; the files are the same.

    Returns:
        the files, hole by hole and tool by tool, as `drawn` has them.

    Raises:
        OutputError: the folder cannot be made, or a file cannot be written.
    """
    make_folder(folder)
    files = []
    count = picture_count(plan, ids)
    for n, (name, picture) in enumerate(drawn(plan, ids=ids, machines=machines), 1):
        write_bytes(folder / name, picture)
        files.append(folder / name)
        if progress is not None:
            progress(n, count)
    return files


def picture_count(plan: Plan, ids: Collection[str] | None = None) -> int:
    """How many pictures `drawn` makes.

    Args:
        plan: what to draw.
        ids: of the holes to draw; None: all.
    """
    return sum(len(sheet.figures) for sheet in _sheets(plan) if sheet.wanted(ids))


def drawn(plan: Plan, *, ids: Collection[str] | None = None, machines: Machines = HERE) -> Iterator[tuple[str, bytes]]:
    """The name and the content (PNG) of each figure of each hole that has a motion, in the order of the plan.

    Of a hole of several strokes those of each stroke, as `HOLE_stroke_2_FIGURE.png`, and before them those that show
    all of them. Then likewise what the further tools do, as `HOLE_tool_2_FIGURE.png`.

    Args:
        plan: what to draw.
        ids: of the holes to draw; None: all.
        machines: to draw on; the pictures are the same.
    """
    sheets = _sheets(plan)
    stems = file_stems([sheet.words for sheet in sheets])
    chosen = [(stem, sheet) for stem, sheet in zip(stems, sheets, strict=True) if sheet.wanted(ids)]
    heads = tuple(replace(each, holes=(), transitions=(), further=()) for each in plan.of_all_tools)
    with Workers(_Artist(heads), machines) as artists:
        for pictures in artists.map(chosen, len(chosen)):
            yield from pictures


class _Sheet(NamedTuple):
    """What is drawn of a hole, or of a stroke of it, by one tool, from 0."""

    tool: int
    hole: str
    answer: HolePlan
    figures: tuple[str, ...]

    @property
    def words(self) -> str:
        """What its files are called by."""
        return self.answer.hole.id + (f" tool {self.tool + 1}" if self.tool else "")

    def wanted(self, ids: Collection[str] | None) -> bool:
        """Whether it is to be drawn where these holes are; None: all."""
        return self.answer.motion is not None and (ids is None or self.hole in ids)


def _sheets(plan: Plan) -> list[_Sheet]:
    """One per hole and stroke of every tool, those without a motion among them."""
    sheets = []
    for tool, each in enumerate(plan.of_all_tools):
        for hole in each.holes:
            if hole.strokes:
                sheets.append(_Sheet(tool, hole.hole.id, hole, OF_ALL_STROKES))
            sheets += [_Sheet(tool, hole.hole.id, stroke, tuple(FIGURES)) for stroke in each_stroke(hole)]
    return sheets


class _Artist:
    """Draws all figures of one sheet; goes to the workers as it is."""

    def __init__(self, heads: tuple[Plan, ...]) -> None:
        self.heads = heads

    def __call__(self, chosen: tuple[str, _Sheet]) -> list[tuple[str, bytes]]:
        stem, sheet = chosen
        head = self.heads[sheet.tool]
        return [(f"{stem}_{name}.png", png(FIGURES[name](head, sheet.answer))) for name in sheet.figures]


def file_stems(names: Iterable[str]) -> list[str]:
    """A file name's beginning for each name, in letters that every file system takes, and no two alike.

    Args:
        names: ids of holes, and words beside.
    """
    taken: set[str] = set()
    stems = []
    for name in names:
        plain = re.sub(r"[^A-Za-z0-9.-]+", "_", name).strip("._")[:LONGEST_STEM] or "hole"
        stem, n = plain, 1
        while stem.lower() in taken:
            n += 1
            stem = f"{plain}-{n}"
        taken.add(stem.lower())
        stems.append(stem)
    return stems
