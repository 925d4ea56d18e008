"""What `map show` and `map compare` say: a workspace map in a few lines, and two of them side by side."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from zerorev.files.text import csv_text
from zerorev.maps.answers import Cells, Difference, best_cells, cells_of, mirror_in_y
from zerorev.maps.cells import STATUS
from zerorev.model._arrays import Array
from zerorev.report.words.map_run import WORDS

if TYPE_CHECKING:
    from xarray import Dataset

__all__ = ["difference_csv", "difference_lines", "heading", "names_of", "place", "show_lines"]

SHOWN_BEST = 5


def heading(found: Dataset) -> str:
    """Robot, tool, legs and size of a map, in a line."""
    cells = cells_of(found)
    names = (_name(found.attrs.get(key, "?")) for key in ("robot", "tool"))
    legs = f"{found.attrs['legs']} legs"
    if "depth_mm" in found.attrs:
        legs += f", {found.attrs['depth_mm']:g} mm deep"
    size = f"{_count(len(cells.target), 'target')}, {_count(len(cells.direction), 'direction')}"
    frame = ("part frame",) if "part_frame" in found.attrs else ()
    return "   |   ".join((", ".join(names), legs, size, *frame))


def show_lines(found: Dataset) -> list[str]:
    """A map in a few lines: how many cells have an answer, its range, best cells, symmetry in Y."""
    cells = cells_of(found)
    quantity, given = cells.quantity, ~np.isnan(cells.value)
    count, of = int(given.sum()), given.size
    what = "have a stroke without reversals" if quantity.variable == "deepest_mm" else "have an answer"
    lines = [
        f"{quantity.title}: {heading(found)}",
        f"{count:,} of {of:,} cells ({count / of * 100:.3g} %) {what}" + _range(cells),
    ]
    if frame := found.attrs.get("part_frame"):
        lines.append(f"part frame: {{xyz_mm: {frame['xyz_mm']}, rpy_deg: {frame['rpy_deg']}}}")
    if why := _why_none(found):
        lines.append(f"the others: {why}")
    lines += [f"best: {_cell(cells, *place)}" for place in best_cells(cells, SHOWN_BEST)]
    mirror = mirror_in_y(cells)
    if mirror is not None:
        lines.append(f"symmetry in Y: {_apart(mirror)}")
    return lines


def difference_lines(apart: Difference, names: tuple[str, str]) -> list[str]:
    """Two maps in a few lines: which is the better where, by how much, and what only one can do.

    Args:
        apart: of two maps.
        names: what they are called.
    """
    quantity, change = apart.quantity, apart.change
    known = change[~np.isnan(change)]
    gain = known if quantity.more_is_better else -known
    lines = [f"{quantity.title}, {names[1]} beside {names[0]}: {change.size:,} common cells, {known.size:,} comparable"]
    only = [int((~np.isnan(a) & np.isnan(b)).sum()) for a, b in _both_ways(apart)]
    lines.append(f"an answer in {names[0]} alone: {only[0]:,} cells, in {names[1]} alone: {only[1]:,}")
    if known.size:
        alike = 0.5 * 10.0**-quantity.digits
        better, worse = int((gain > alike).sum()), int((gain < -alike).sum())
        lines.append(
            f"{names[1]} is better in {better:,} cells, worse in {worse:,}, alike in {known.size - better - worse:,};"
            f" median change {quantity.shown(float(np.median(known)))}"
        )
        for word, n in (("greatest rise", np.nanargmax(change)), ("greatest fall", np.nanargmin(change))):
            row, column = divmod(int(n), change.shape[1])
            lines.append(
                f"{word}: {quantity.shown(float(change[row, column]))} at {place(apart.target[row])},"
                f" direction {_vector(apart.direction[column])}"
            )
    return lines


def difference_csv(apart: Difference, names: tuple[str, str]) -> str:
    """Two maps cell by cell, every digit; an empty field where there is no answer."""
    variable = apart.quantity.variable
    places = [*(f"{axis}_mm" for axis in "xyz"), *(f"direction_{axis}" for axis in "xyz")]
    rows: list[list[object]] = [[*places, *(f"{variable} of {name}" for name in names), f"change of {variable}"]]
    change = apart.change
    for row, column in np.ndindex(*change.shape):
        numbers = (apart.first[row, column], apart.second[row, column], change[row, column])
        shown = [None if np.isnan(number) else float(number) for number in numbers]
        rows.append([*apart.target[row].tolist(), *apart.direction[column].tolist(), *shown])
    return csv_text(rows)


def names_of(first: Path, second: Path) -> tuple[str, str]:
    """What two maps are called: the names of their folders, or their whole paths where those are alike."""
    names = first.stem, second.stem
    return names if names[0] != names[1] else (str(first), str(second))


def place(target: Array) -> str:
    """A target [mm], shape (3,), in words."""
    return "(" + ", ".join(f"{value + 0.0:g}" for value in np.round(target, 3)) + ") mm"


def _name(attribute: object) -> str:
    return str(attribute.get("name", "?")) if isinstance(attribute, dict) else str(attribute)


def _count(number: int, what: str) -> str:
    return f"{number:,} {what}" + ("" if number == 1 else "s")


def _why_none(found: Dataset) -> str:
    """What became of the cells without an answer, the most frequent first."""
    if "status" not in found:
        return ""
    words = {-1: "not yet examined", **{n: WORDS[name] for n, name in enumerate(STATUS) if name != "answered"}}
    states, counts = np.unique(found["status"].values, return_counts=True)
    ordered = sorted(zip(counts.tolist(), states.tolist(), strict=True), reverse=True)
    return ", ".join(f"{count:,} {words[state]}" for count, state in ordered if state in words)


def _range(cells: Cells) -> str:
    values = cells.value[~np.isnan(cells.value)]
    if not values.size:
        return ""
    low, middle, high = (cells.quantity.shown(float(value)) for value in np.quantile(values, (0, 0.5, 1)))
    return f": {low} to {high}, median {middle}"


def _cell(cells: Cells, row: int, column: int) -> str:
    text = f"{cells.quantity.shown(float(cells.value[row, column]))} at {place(cells.target[row])}"
    if len(cells.direction) > 1:
        text += f", direction {_vector(cells.direction[column])}"
    if cells.branch[row, column] >= 0:
        spins = ", ".join(f"{psi + 0.0:.2f}" for psi in cells.psi_deg[row, column])
        text += f", branch {cells.branch[row, column]}, psi {spins} deg"
    return text


def _vector(direction: Array) -> str:
    return "(" + ", ".join(f"{value + 0.0:.4g}" for value in np.round(direction, 4)) + ")"


def _apart(mirror: Difference) -> str:
    """How far a map is from its mirror."""
    change = np.abs(mirror.change)
    pairs = int((~np.isnan(change)).sum())
    lost = sum(int((~np.isnan(a) & np.isnan(b)).sum()) for a, b in _both_ways(mirror))
    if not pairs:
        return "no pair of mirror cells has an answer"
    row, column = divmod(int(np.nanargmax(change)), change.shape[1])
    greatest = float(change[row, column])
    unit = "" if mirror.quantity.unit == "1" else f" {mirror.quantity.unit}"
    where = f", at {place(mirror.target[row])}" if greatest > 0.5 * 10.0**-mirror.quantity.digits else ""
    return (
        f"{pairs:,} pairs of mirror cells differ by {greatest:.2g}{unit} at most{where};"
        f" {lost:,} have an answer on one side alone"
    )


def _both_ways(apart: Difference) -> tuple[tuple[Array, Array], tuple[Array, Array]]:
    return (apart.first, apart.second), (apart.second, apart.first)
