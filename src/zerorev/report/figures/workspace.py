"""All pictures of a workspace map, written into a folder."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.figure import Figure

from zerorev.errors import InputError
from zerorev.files.output import make_folder, write_bytes
from zerorev.maps.answers import Cells, best_cells, cells_of
from zerorev.maps.planes import Across, is_grid, planes_of
from zerorev.maps.replan import question_of
from zerorev.model._arrays import Array
from zerorev.motion.drilling import Drilling
from zerorev.report.figures.cell import direction_rose, named_direction, robot_in_cell
from zerorev.report.figures.style import png
from zerorev.report.figures.workspace_map import best_plane, map_planes, map_surface, map_views
from zerorev.report.scene.skeleton import home, joints_at, skeleton
from zerorev.report.words.workspace_map import heading

if TYPE_CHECKING:
    from xarray import Dataset

__all__ = ["map_figures", "robot_at_home", "write_map_figures"]


def write_map_figures(
    found: Dataset, folder: Path, *, direction: int = 0, across: Across | None = None,
    at: Sequence[float] | None = None,
) -> list[Path]:  # fmt: skip
    """Write the pictures of a map as PNG files.

    Args:
        found: a workspace map.
        folder: where to; made if its parent exists.
        direction: as `map_figures` has it.
        across: likewise.
        at: likewise.

    Returns:
        the files.
    """
    figures = map_figures(found, direction=direction, across=across, at=at)
    make_folder(folder)
    files = []
    for name, figure in figures.items():
        files.append(folder / f"{name}.png")
        write_bytes(files[-1], png(figure))
    return files


def map_figures(
    found: Dataset, *, direction: int = 0, across: Across | None = None, at: Sequence[float] | None = None
) -> dict[str, Figure]:
    """The pictures of a map by name: what there is to be seen in it, and no more.

    Args:
        found: a workspace map.
        direction: for which its planes are drawn.
        across: the axis that the planes stand across; None: the one that the drill is nearest to.
        at: target of the rose [mm]; None: that of the best cell.

    Raises:
        InputError: `at` is no target of the map.
    """
    cells, subtitle, robot = cells_of(found), heading(found), robot_at_home(found)
    figures: dict[str, Figure] = {}
    row = _row_of(cells, at)
    if is_grid(cells):
        planes = planes_of(cells, direction, across)
        drilled = subtitle
        if len(cells.direction) > 1:
            drilled += f"   |   drilled along {named_direction(cells.direction[direction])}"
        figures["planes"] = map_planes(planes, drilled)
        if min(planes[0].value.shape) > 1:
            figures["surface"] = map_surface(best_plane(planes), drilled, robot)
            figures["views"] = map_views(planes, drilled, robot)
    robots = [("robot at home", robot)]
    reached = _robot_at_best(found, cells)
    if reached is not None:
        robots.append(("at the best cell", reached))
    figures["cell"] = robot_in_cell(cells, subtitle, robots, [str(name) for name in found.attrs.get("ids", ())])
    if len(cells.direction) > 1:
        figures["rose"] = direction_rose(cells, row, subtitle)
    return figures


def robot_at_home(found: Dataset) -> Array:
    """Places along the arm of a map's robot at home, with its tool [mm], shape (8, 3)."""
    question = question_of(found)
    return skeleton(question.robot, question.tool, home(question.robot)) * 1e3


def _robot_at_best(found: Dataset, cells: Cells) -> Array | None:
    """Places along the arm [mm] at the bottom of the best hole, or None where no cell has a motion."""
    best = best_cells(cells, 1)
    if not best or cells.branch[best[0]] < 0:
        return None
    (row, column), question = best[0], question_of(found)
    hole = question.hole(cells.target[row] / 1e3, cells.direction[column])
    psi = float(np.deg2rad(cells.psi_deg[row, column, 1]))
    joints = joints_at(Drilling(question.robot, question.tool, hole), psi, int(cells.branch[row, column]))
    return None if joints is None else skeleton(question.robot, question.tool, joints) * 1e3


def _row_of(cells: Cells, at: Sequence[float] | None) -> int:
    """The row of a target, or of the best cell."""
    if at is None:
        best = best_cells(cells, 1)
        return best[0][0] if best else 0
    apart = np.linalg.norm(cells.target - np.array(at), axis=1)
    row = int(apart.argmin())
    if apart[row] > 1e-3:
        nearest = ",".join(f"{value:g}" for value in cells.target[row])
        raise InputError(
            "no target of the map", where=f"at {','.join(f'{v:g}' for v in at)}", accepted=f"e.g. {nearest}"
        )
    return row
