"""Figures of a plan, one function a figure; matplotlib is imported here and nowhere else."""

from __future__ import annotations

import re
from collections.abc import Callable, Collection, Iterator
from dataclasses import replace
from pathlib import Path

from matplotlib.figure import Figure

from zerorev.files.output import make_folder, write_bytes
from zerorev.model.plan import HolePlan, Plan
from zerorev.model.strokes import by_stroke, ids_of_strokes
from zerorev.report.figures.joints import joint_angles
from zerorev.report.figures.plane import twist_plane
from zerorev.report.figures.rates import critical_rates
from zerorev.report.figures.style import png
from zerorev.workers import HERE, Machines, Workers

__all__ = ["FIGURES", "critical_rates", "drawn", "file_stems", "joint_angles", "twist_plane", "write_figures"]

FIGURES: dict[str, Callable[[Plan, HolePlan], Figure]] = {
    "joint_angles": joint_angles,
    "twist_plane": twist_plane,
    "critical_rates": critical_rates,
}
LONGEST_STEM = 80


def write_figures(
    plan: Plan,
    folder: Path,
    progress: Callable[[int, int], None] | None = None,
    *,
    ids: Collection[str] | None = None,
    machines: Machines = HERE,
) -> list[Path]:
    """Write each figure of each hole or stroke that has a motion as `HOLE_FIGURE.png`; infeasible holes are skipped.

    Args:
        plan: what to draw.
        folder: where to; made if its parent exists.
        progress: called with the number of holes drawn and in all.
        ids: of the holes to draw; None: all.
        machines: to draw on; the files are the same.

    Returns:
        the files, hole by hole.

    Raises:
        OutputError: the folder cannot be made, or a file cannot be written.
    """
    make_folder(folder)
    files = []
    drilled = [hole for hole in plan.holes if hole.motion is not None and (ids is None or hole.hole.id in ids)]
    count = sum(max(len(hole.strokes), 1) for hole in drilled)
    for n, (name, picture) in enumerate(drawn(plan, ids=ids, machines=machines), 1):
        write_bytes(folder / name, picture)
        files.append(folder / name)
        if progress is not None and n % len(FIGURES) == 0:
            progress(n // len(FIGURES), count)
    return files


def drawn(plan: Plan, *, ids: Collection[str] | None = None, machines: Machines = HERE) -> Iterator[tuple[str, bytes]]:
    """The name and the content (PNG) of each figure of each hole that has a motion, in the order of the plan.

    Args:
        plan: what to draw.
        ids: of the holes to draw; None: all.
        machines: to draw on; the pictures are the same.
    """
    ids = None if ids is None else ids_of_strokes(plan, ids)
    plan = by_stroke(plan)
    chosen = [
        (stem, hole)
        for hole, stem in zip(plan.holes, file_stems(plan), strict=True)
        if hole.motion is not None and (ids is None or hole.hole.id in ids)
    ]
    with Workers(_Artist(replace(plan, holes=(), transitions=())), machines) as artists:
        for pictures in artists.map(chosen, len(chosen)):
            yield from pictures


class _Artist:
    """Draws all figures of one hole; goes to the workers as it is."""

    def __init__(self, head: Plan) -> None:
        self.head = head

    def __call__(self, chosen: tuple[str, HolePlan]) -> list[tuple[str, bytes]]:
        stem, hole = chosen
        return [(f"{stem}_{name}.png", png(draw(self.head, hole))) for name, draw in FIGURES.items()]


def file_stems(plan: Plan) -> list[str]:
    """A file name's beginning for each hole: its id in letters that every file system takes, and no two alike."""
    taken: set[str] = set()
    stems = []
    for hole in plan.holes:
        plain = re.sub(r"[^A-Za-z0-9.-]+", "_", hole.hole.id).strip("._")[:LONGEST_STEM] or "hole"
        stem, n = plain, 1
        while stem.lower() in taken:
            n += 1
            stem = f"{plain}-{n}"
        taken.add(stem.lower())
        stems.append(stem)
    return stems
