"""All pictures of a workspace map, written into a folder."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from zerorev.errors import InputError
from zerorev.files.output import make_folder, write_bytes
from zerorev.maps.answers import Cells, best_cells, cells_of
from zerorev.maps.frames import frame_of, in_frame
from zerorev.maps.planes import Across, Plane, is_grid, planes_of
from zerorev.maps.replan import question_of
from zerorev.model._arrays import Array
from zerorev.motion.drilling import Drilling
from zerorev.report.figures.cell import direction_rose, named_direction, robot_in_cell
from zerorev.report.figures.style import png
from zerorev.report.figures.workspace_map import best_plane, planes_figure, surface_figure, views_figure
from zerorev.report.scene.skeleton import home, joints_at, skeleton
from zerorev.report.words.workspace_map import heading

if TYPE_CHECKING:
    from xarray import Dataset

__all__ = [
    "map_cell",
    "map_figures",
    "map_planes",
    "map_rose",
    "map_surface",
    "map_views",
    "robot_at_home",
    "write_map_figures",
]


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
    """The figures of a map by name: those that there is something to see in.

    Args:
        found: a workspace map.
        direction: for which its planes are drawn.
        across: the axis that the planes stand across; None: the one that the drill is nearest to.
        at: target of the rose [mm]; None: that of the best cell.

    Raises:
        InputError: `at` is not a target of the map.
    """
    cells = cells_of(found)
    _row_of(cells, at)
    figures: dict[str, Figure] = {}
    if is_grid(cells):
        figures["planes"] = map_planes(found, direction=direction, across=across)
        if min(planes_of(cells, direction, across)[0].value.shape) > 1:
            figures["surface"] = map_surface(found, direction=direction, across=across)
            figures["views"] = map_views(found, direction=direction, across=across)
    figures["cell"] = map_cell(found)
    if len(cells.direction) > 1:
        figures["rose"] = map_rose(found, at)
    return figures


def map_planes(found: Dataset, *, direction: int = 0, across: Across | None = None) -> Figure:
    """The planes of a workspace map side by side, each as it is seen along the drill (thesis Fig. 21).

    Args:
        found: a workspace map on a grid.
        direction: number of the direction of the drill, of those that the map has.
        across: the axis that the planes stand across; None: the one that the drill is nearest to.

    Raises:
        InputError: the map is not on a grid.
    """
    return planes_figure(*_planes(found, direction, across))


def map_surface(found: Dataset, *, direction: int = 0, across: Across | None = None, ax: Axes | None = None) -> Figure:
    """The plane with the best cell as a surface, offset along the drill by the value (thesis Fig. 20).

    The robot stands beside it at home.

    Args:
        found: a workspace map on a grid, with two cells or more each way in a plane.
        direction: number of the direction of the drill, of those that the map has.
        across: the axis that the planes stand across; None: the one that the drill is nearest to.
        ax: to draw into, in 3D; None: a figure with a heading.

    Raises:
        InputError: the map is not on such a grid, or the axes are not in 3D.
    """
    planes, subtitle = _wide_planes(found, direction, across)
    return surface_figure(best_plane(planes), subtitle, robot_at_home(found), ax)


def map_views(found: Dataset, *, direction: int = 0, across: Across | None = None) -> Figure:
    """All planes of a workspace map at once, seen from below and from the side (thesis Figures 22 to 24).

    Each is a surface, offset along the drill by the value; the best cell has a ring.

    Args:
        found: a workspace map on a grid, with two cells or more each way in a plane.
        direction: number of the direction of the drill, of those that the map has.
        across: the axis that the planes stand across; None: the one that the drill is nearest to.

    Raises:
        InputError: the map is not on such a grid.
    """
    return views_figure(*_wide_planes(found, direction, across), robot_at_home(found))


def map_cell(found: Dataset, *, ax: Axes | None = None) -> Figure:
    """The targets of a workspace map around the robot, coloured by their best direction (thesis Fig. 25).

    The robot is drawn at home and, where the map has a motion, at the bottom of the best hole.

    Args:
        found: a workspace map, on a grid or of given targets.
        ax: to draw into, in 3D; None: a figure with a heading.

    Raises:
        InputError: the axes are not in 3D.
    """
    cells = cells_of(found)
    robots = [("robot at home", robot_at_home(found))]
    reached = _robot_at_best(found, cells)
    if reached is not None:
        robots.append(("at the best cell", reached))
    return robot_in_cell(cells, heading(found), robots, [str(name) for name in found.attrs.get("ids", ())], ax)


def map_rose(found: Dataset, at: Sequence[float] | None = None, *, ax: Axes | None = None) -> Figure:
    """What one target of a workspace map allows by direction of the drill, on a disc that keeps areas.

    Each direction is a dot, and colours its surroundings; in the middle is their mean.

    Args:
        found: a workspace map with several directions.
        at: the target [mm]; None: that of the best cell.
        ax: to draw into; None: a figure with a heading.

    Raises:
        InputError: `at` is not a target of the map, or the map has one direction.
    """
    cells = cells_of(found)
    if len(cells.direction) < 2:
        raise InputError("has one direction", where="map", accepted="a map with several directions")
    return direction_rose(cells, _row_of(cells, at), heading(found), ax)


def _planes(found: Dataset, direction: int, across: Across | None) -> tuple[list[Plane], str]:
    """The planes of a map, and its heading with their direction where it has several."""
    cells, subtitle = cells_of(found), heading(found)
    planes = planes_of(cells, direction, across)
    if len(cells.direction) > 1:
        subtitle += f"   |   drilled along {named_direction(cells.direction[direction])}"
    return planes, subtitle


def _wide_planes(found: Dataset, direction: int, across: Across | None) -> tuple[list[Plane], str]:
    """Likewise; refused where they are only a row of cells."""
    planes, subtitle = _planes(found, direction, across)
    if min(planes[0].value.shape) < 2:
        raise InputError("is a row of cells", where=planes[0].name, accepted="two cells or more each way in a plane")
    return planes, subtitle


def robot_at_home(found: Dataset) -> Array:
    """Places along the arm of a map's robot at home, with its tool [mm], in the frame of the map, shape (8, 3)."""
    question = question_of(found)
    return in_frame(frame_of(found), skeleton(question.robot, question.tool, home(question.robot))) * 1e3


def _robot_at_best(found: Dataset, cells: Cells) -> Array | None:
    """Places along the arm [mm] at the bottom of the best hole, or None where no cell has a motion."""
    best = best_cells(cells, 1)
    if not best or cells.branch[best[0]] < 0:
        return None
    (row, column), question = best[0], question_of(found)
    T = cells.T_base_part
    target, direction = cells.target[row] / 1e3 @ T[:3, :3].T + T[:3, 3], cells.direction[column] @ T[:3, :3].T
    hole = question.hole(target, direction)
    psi = float(np.deg2rad(cells.psi_deg[row, column, 1]))
    joints = joints_at(Drilling.of(question, hole), psi, int(cells.branch[row, column]))
    return None if joints is None else in_frame(T, skeleton(question.robot, question.tool, joints)) * 1e3


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
