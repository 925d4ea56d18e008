"""The box of the great map, one million cells in front of a KR 6, and evenly thinned grids of it."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import yaml

from zerorev.files.map_file import read_map_file
from zerorev.model.map_task import MapTask

__all__ = ["GREAT_MAP", "content", "thinned", "write_map_file"]

GREAT_MAP = Path(__file__).parents[1] / "examples" / "maps" / "million_cells.yaml"


def thinned(cells: int, path: Path = GREAT_MAP) -> MapTask:
    """The map of a file on fewer of its targets, at least so many cells; all of it where it has no more.

    What is kept of each axis is spread evenly over it and about its middle, so that the share of the cells that are out
    of reach stays what it is, and with it what a cell costs in the mean.

    Args:
        cells: at least so many.
        path: a map file with a box of targets.
    """
    task = read_map_file(path)
    sizes = [len(axis) for axis in task.axes]
    keep = [max(1, round(size * (cells / task.cells) ** (1 / 3))) for size in sizes]
    while _product(keep) * len(task.directions) < min(cells, task.cells):  # the sparsest axis first
        n = min((n for n in range(3) if keep[n] < sizes[n]), key=lambda n: keep[n] / sizes[n])
        keep[n] += 1
    x, y, z = (
        axis[[int((k + 0.5) * len(axis) / count) for k in range(count)]]
        for axis, count in zip(task.axes, keep, strict=True)
    )
    return replace(task, axes=(x, y, z))


def write_map_file(task: MapTask, path: Path, source: Path = GREAT_MAP) -> None:
    """A map file of a thinned box.

    Args:
        task: of which the targets are taken.
        path: the file.
        source: the map file that it was thinned from; what else it says stays.
    """
    data = yaml.safe_load(source.read_text(encoding="utf-8"))
    data["targets"] = {f"{name}_mm": axis.tolist() for name, axis in zip("xyz", task.axes, strict=True)}
    path.write_text(yaml.safe_dump(data, sort_keys=False), encoding="utf-8")


def content(folder: Path) -> dict[str, bytes]:
    """Every file in a folder, by its path."""
    return {str(file.relative_to(folder)): file.read_bytes() for file in folder.rglob("*") if file.is_file()}


def _product(counts: list[int]) -> int:
    x, y, z = counts
    return x * y * z
