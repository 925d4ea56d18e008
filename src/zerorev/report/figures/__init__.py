"""Figures of a plan, one function a figure; matplotlib is imported here and nowhere else."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from pathlib import Path

from matplotlib.figure import Figure

from zerorev.files.output import make_folder, write_bytes
from zerorev.model.plan import HolePlan, Plan
from zerorev.report.figures.joints import joint_angles
from zerorev.report.figures.plane import twist_plane
from zerorev.report.figures.rates import critical_rates
from zerorev.report.figures.style import png

__all__ = ["FIGURES", "critical_rates", "drawn", "file_stems", "joint_angles", "twist_plane", "write_figures"]

FIGURES: dict[str, Callable[[Plan, HolePlan], Figure]] = {
    "joint_angles": joint_angles,
    "twist_plane": twist_plane,
    "critical_rates": critical_rates,
}
LONGEST_STEM = 80


def write_figures(plan: Plan, folder: Path, progress: Callable[[int, int], None] | None = None) -> list[Path]:
    """Write each figure of each hole that has a motion as `HOLE_FIGURE.png`; infeasible holes are skipped.

    Args:
        plan: what to draw.
        folder: where to; made if its parent exists.
        progress: called with the number of holes drawn and in all.

    Returns:
        the files, hole by hole.

    Raises:
        OutputError: the folder cannot be made, or a file cannot be written.
    """
    make_folder(folder)
    files = []
    for n, (name, picture) in enumerate(drawn(plan), 1):
        write_bytes(folder / name, picture)
        files.append(folder / name)
        if progress is not None and n % len(FIGURES) == 0:
            progress(n // len(FIGURES), sum(hole.motion is not None for hole in plan.holes))
    return files


def drawn(plan: Plan) -> Iterator[tuple[str, bytes]]:
    """The name and the content (PNG) of each figure of each hole that has a motion."""
    for hole, stem in zip(plan.holes, file_stems(plan), strict=True):
        if hole.motion is not None:
            for name, draw in FIGURES.items():
                yield f"{stem}_{name}.png", png(draw(plan, hole))


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
