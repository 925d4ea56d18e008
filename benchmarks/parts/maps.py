"""Workspace maps: the plane of the thesis' Table 5, finer ones, and those of its figures, on one process and two."""

from __future__ import annotations

import tempfile
import time
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np

from benchmarks.box import content
from benchmarks.parts import Options
from benchmarks.table import Goal, Section
from benchmarks.timing import Timed, duration, in_turns
from zerorev.files.map_file import read_map_file
from zerorev.maps.run import run_map
from zerorev.maps.workspace import read_workspace_map
from zerorev.model._arrays import Array
from zerorev.model.map_task import MapTask
from zerorev.thesis.reproduce.published import TABLE_5, TABLE_5_Y_MM, TABLE_5_Z_MM
from zerorev.thesis.reproduce.workspace import PLANES_MM, SPACING_MM
from zerorev.workers import HERE, Machines

__all__ = ["run"]

MAP = Path(__file__).parents[2] / "examples" / "maps" / "table5_plane.yaml"
STEP_MM, SAME_MM = 5.0, 0.05  # of the thesis' search; of a cell and its mirror
MOST_ROUNDS = 5
MANY, COARSE_MM = 2000, 200.0  # cells below which the planes of the figures are coarser, and how much


def run(options: Options) -> Section:
    """Time the plane of Table 5, look at its depths, then time finer planes; each run begins a new folder."""
    plane = read_map_file(MAP)
    work = {"wall": partial(_run, plane, 1)}
    by_wall = in_turns(work, min(options.rounds, MOST_ROUNDS), time.perf_counter)["wall"]
    by_core = in_turns(work, min(options.rounds, MOST_ROUNDS))["wall"]
    cells = plane.cells
    rows = [_row(f"Table 5: {cells} cells", cells, 1, by_wall), _row("the same, processor time", cells, 1, by_core)]
    failures, each = _wrong(plane), dict[str, float]()
    larger = {f"finer: {finer.cells:,} cells": finer for finer in (_finer(plane, round(n**0.5)) for n in options.jobs)}
    figures = _figures(plane, SPACING_MM if options.cells > MANY else COARSE_MM)
    named = f"planes of Figures 21 to 24: {figures.cells:,} cells"
    for name, task in (larger | {named: figures}).items():
        made = []
        for workers in (1, 2):
            began = time.perf_counter()
            made.append(_content(task, workers))
            each[f"{name}, {workers}"] = taken = time.perf_counter() - began
            rows.append(_row(name, task.cells, workers, Timed((0.0,), (taken,))))
        if made[0] != made[1]:
            failures.append(f"{name}: two processes wrote other bytes than one")
    return Section(
        name="map",
        title="Workspace maps: the deepest stroke along +X on planes across X",
        columns=("map", "processes at most", "whole run", "a cell"),
        rows=rows,
        notes=[
            "From an empty folder to the finished map, kernels compiled, without the start of Python; a second process"
            " is started once it is worth it, which takes some two seconds of its own. Each map is compared byte for"
            " byte between one process and two. The first are of the plane X = 500 mm; Figures 21 to 24 show"
            f" {len(PLANES_MM)} planes, X = {PLANES_MM[0]:g} to {PLANES_MM[-1]:g} mm, on one side of the robot as in"
            " the thesis, here at 50 mm."
        ],
        goals=[
            Goal("Table 5's plane, 81 cells", "thesis two days", "2 s on two cores", duration(by_wall.median)),
            Goal(
                "all planes of Figures 21 to 24 at 50 mm", "", "1 min", duration(each[f"{named}, 2"]) + " on two cores"
            ),
        ],
        failures=failures,
        figures={"plane": by_wall.seconds, "larger": each},
    )


def _row(name: str, cells: int, workers: int, timed: Timed[float]) -> tuple[str, ...]:
    return name, str(workers), duration(timed.median), duration(timed.median / cells)


def _finer(plane: MapTask, side: int) -> MapTask:
    x, y, z = (np.linspace(axis[0], axis[-1], side) for axis in plane.axes)
    return replace(plane, axes=(x[:1], y, z))


def _figures(plane: MapTask, spacing: float) -> MapTask:
    """The planes of Figures 21 to 24."""
    y = np.arange(0, max(TABLE_5_Y_MM) + 1, spacing)
    z = np.arange(min(TABLE_5_Z_MM), max(TABLE_5_Z_MM) + 1, spacing)
    return replace(plane, axes=(np.array(PLANES_MM), y, z))


def _run(task: MapTask, workers: int, _: int) -> float:
    with tempfile.TemporaryDirectory() as folder:
        run_map(task, Path(folder) / "map.zarr", Machines(workers))
    return 0.0


def _content(task: MapTask, workers: int) -> dict[str, bytes]:
    with tempfile.TemporaryDirectory() as folder:
        run_map(task, Path(folder) / "map.zarr", Machines(workers))
        return content(Path(folder))


def _depths(task: MapTask) -> Array:
    """Deepest strokes [mm], a row a Z and a column a Y, 0 where there is none."""
    with tempfile.TemporaryDirectory() as folder:
        run_map(task, Path(folder) / "map.zarr", HERE)
        found = read_workspace_map(Path(folder) / "map.zarr")
    return np.nan_to_num(found["deepest_mm"].values[0, :, :, 0].T)


def _wrong(plane: MapTask) -> list[str]:
    """Cells that are less deep than the thesis has them, and cells that are not like their mirror."""
    order = (plane.axes[0], np.array(TABLE_5_Y_MM, dtype=float), np.array(TABLE_5_Z_MM, dtype=float))
    depths, thesis = _depths(replace(plane, axes=order)), np.array(TABLE_5, dtype=float)
    failures = []
    if (short := thesis - STEP_MM - depths).max() > 0:
        failures.append(f"{(short > 0).sum()} cells of Table 5 are more than 5 mm deeper in the thesis")
    if (apart := np.abs(depths - depths[:, ::-1])).max() > SAME_MM:
        failures.append(f"a cell and its mirror in Y are {apart.max():.2f} mm apart")
    return failures
