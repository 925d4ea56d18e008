"""The great map, through the command line: time per cell, memory and disk as the map grows towards a million cells."""

from __future__ import annotations

import shutil
import sys
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from itertools import pairwise
from pathlib import Path

import numpy as np
import xarray

from benchmarks.box import GREAT_MAP, thinned, write_map_file
from benchmarks.parts import Options
from benchmarks.table import Goal, Section
from benchmarks.timing import duration
from benchmarks.watched import Cost, watched
from zerorev.files.map_file import read_map_file
from zerorev.maps.cells import STATUS
from zerorev.maps.run import run_map
from zerorev.maps.workspace import read_workspace_map
from zerorev.model._arrays import Array
from zerorev.workers import HERE

__all__ = ["run"]

WORKERS = 2
SMALLER = (50, 10, 1)  # maps of so many times fewer cells
MIB = 2**20


@dataclass(frozen=True)
class _Ran:
    """One map.

    Attributes:
        found: the map.
        cost: of its command.
        disk: bytes of its files.
    """

    found: xarray.Dataset
    cost: Cost
    disk: int

    @property
    def cells(self) -> int:
        return int(self.found["status"].size)

    @property
    def each(self) -> float:
        """Seconds a cell, by the clock."""
        return self.cost.seconds / self.cells

    @property
    def answered(self) -> float:
        """Share of the cells."""
        return float((self.found["status"] == STATUS.index("answered")).mean())


def run(options: Options) -> Section:
    """Make maps of more and more cells of the same box; what was broken off is resumed."""
    folder = options.folder / f"map_great_{options.cells}"
    folder.mkdir(parents=True, exist_ok=True)
    run_map(thinned(1), folder / "first.zarr", HERE)  # so that the kernels are compiled
    ran = [_ran(folder, options.cells // smaller) for smaller in SMALLER]
    shutil.rmtree(folder)
    common = [_common(less, more) for less, more in pairwise(ran)]
    failures = [f"{each.cells:,} cells: some were never examined" for each in ran if (each.found["status"] < 0).any()]
    if apart := sum(apart for _, apart in common):
        failures.append(f"{apart:,} cells have another answer in a larger map")
    return Section(
        name="map_great",
        title="Workspace maps: towards a million cells",
        columns=("cells", "whole run", "cells a second", "a cell", "each cell more than the row above",
                 "processor's time, a cell", "most memory of a process", "of all at once", "on disk",
                 "cells answered"),
        rows=[_row(each, before) for before, each in zip([None, *ran], ran, strict=False)],
        notes=_notes(ran, sum(cells for cells, _ in common)),
        goals=_goals(ran),
        failures=failures,
        figures={"runs": [{"cells": each.cells, "answered": each.answered, "disk": each.disk} | asdict(each.cost)
                          for each in ran]},
    )  # fmt: skip


def _ran(folder: Path, cells: int) -> _Ran:
    source, target = folder / f"{cells}.yaml", folder / f"{cells}.zarr"
    write_map_file(thinned(cells), source)
    command = [sys.executable, "-m", "zerorev.cli", "map", str(source), "-o", str(target), "--workers", str(WORKERS)]
    cost = watched(command, folder / f"{cells}.json")
    disk = sum(file.stat().st_size for file in target.rglob("*") if file.is_file())
    return _Ran(read_workspace_map(target), cost, disk)


def _common(less: _Ran, more: _Ran) -> tuple[int, int]:
    """How many cells two maps have in common, and how many of them have not the same answer to the last bit."""
    axes = {f"{name}_mm": np.intersect1d(less.found[f"{name}_mm"], more.found[f"{name}_mm"]) for name in "xyz"}
    here, there = (
        each.found.isel({name[0]: np.isin(each.found[name], axis) for name, axis in axes.items()})
        for each in (less, more)
    )
    same = np.ones(here["status"].shape, dtype=bool)
    for name in here.data_vars:
        one, other = here[name].values, there[name].values
        same &= (one == other) | ((one != one) & (other != other))  # NaN, where there is no answer
    return same.size, int((~same).sum())


def _row(ran: _Ran, before: _Ran | None) -> tuple[str, ...]:
    more = None if before is None else (ran.cost.seconds - before.cost.seconds) / (ran.cells - before.cells)
    return (
        f"{ran.cells:,}",
        _time(ran.cost.seconds),
        f"{1 / ran.each:.1f}",
        duration(ran.each),
        "" if more is None else duration(max(0.0, more)),
        duration(ran.cost.processor / ran.cells),
        f"{ran.cost.most_of_one / MIB:.0f} MiB",
        f"{ran.cost.most_of_all / MIB:.0f} MiB",
        f"{ran.disk / MIB:.1f} MiB",
        f"{ran.answered:.1%}",
    )


def _notes(ran: Sequence[_Ran], common: int) -> list[str]:
    great, million = ran[-1], read_map_file(GREAT_MAP)
    return [
        f"`zerorev map MAP -o OUT --workers {WORKERS}` on evenly thinned grids of one box in front of the robot"
        f" (`examples/maps/{GREAT_MAP.name}`): {_box(million.axes)}; {len(million.directions)} directions, ahead, ahead"
        " and down, straight down, to either side. From an empty folder to the finished map, with the start of Python"
        " and of the workers, which weighs most in the smallest. Memory is examined every half second; that of all"
        f" {great.cost.processes} processes at once counts in each of them what they share.",
        f"The box itself has {million.cells:,} cells, which were not run. At {1 / great.each:.1f} cells a second, those"
        f" of the largest map here, they take {_time(great.each * million.cells)}, and"
        f" {great.disk / great.cells * million.cells / MIB:.0f} MiB on disk. The grids are the same box evenly thinned,"
        " so that as many of their cells are out of reach, on which the time of a cell depends most.",
        f"{common:,} cells of a smaller map are in the next larger one, too; so they can be compared.",
    ]


def _goals(ran: Sequence[_Ran]) -> list[Goal]:
    great, million = ran[-1], read_map_file(GREAT_MAP)
    shape = " × ".join(map(str, million.shape[:-1]))
    took = f"{great.cells:,} in {_time(great.cost.seconds)}; so all in {_time(great.each * million.cells)}"
    memory = [max(getattr(each.cost, name) for each in ran) / MIB for name in ("most_of_one", "most_of_all")]
    flat = " / ".join(f"{duration(each.cost.processor / each.cells)} ({each.cells:,})" for each in ran)
    return [
        Goal(f"a map of {million.cells:,} cells, {shape} targets × {len(million.directions)} directions, two cores",
             "", "100,000 of them run", took),
        Goal("its peak memory", "", "1 GiB", f"{memory[0]:.0f} MiB a process, {memory[1]:.0f} MiB all together"),
        Goal("its time of the processor a cell as the map grows, start included", "", "flat", flat),
    ]  # fmt: skip


def _box(axes: Sequence[Array]) -> str:
    return ", ".join(f"{name} {axis[0]:g} to {axis[-1]:g}" for name, axis in zip("XYZ", axes, strict=True)) + " mm"


def _time(seconds: float) -> str:
    """A long time in words."""
    if seconds < 120:
        return duration(seconds)
    return f"{seconds / 60:.1f} min" if seconds < 7200 else f"{seconds / 3600:.1f} h"
