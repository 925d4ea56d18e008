"""Where in the cell: Table 5 and Figure 20 side by side with ours, and the planes of Figures 21 to 25."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from zerorev.maps.answers import Difference, Field, difference, mirror_in_y
from zerorev.maps.planes import planes_of
from zerorev.model._arrays import Array
from zerorev.model.quantity import quantity
from zerorev.motion.drilling import Drilling, joint_rates
from zerorev.report.figures.cell import robot_in_cell
from zerorev.report.figures.map_difference import difference_figure
from zerorev.report.figures.style import png
from zerorev.report.figures.workspace_map import planes_figure, surface_figure, views_figure
from zerorev.report.scene.skeleton import home, skeleton
from zerorev.search.deepest import deepest_stroke
from zerorev.thesis.reproduce.context import Context
from zerorev.thesis.reproduce.published import (
    DECREMENT_MM,
    DEEPEST,
    POSITIONS,
    SYMMETRY_MM,
    TABLE_5,
    TABLE_5_X_MM,
    TABLE_5_Y_MM,
    TABLE_5_Z_MM,
    hole_along_x,
)
from zerorev.thesis.reproduce.section import Cell, Column, Picture, Result, Section, Table
from zerorev.thesis.sampled import SampledObjective
from zerorev.thesis.swarm import TABLE_4, run_swarm

__all__ = ["make", "printed"]

DEEPEST_MM = quantity("deepest")
ALONG_X = np.array([[1.0, 0.0, 0.0]])
PLANES_MM = (-100.0, 0.0, 100.0, 200.0, 300.0, 400.0, 500.0, 600.0)  # Figures 21 to 24
ODD_MM = 100.0  # sec. 4.6: the plane that is "exceedingly discontinuous and sparse"
SPACING_MM = 50.0
SPINS = 360  # over one turn, at which the lever of joint 1 is examined


@dataclass(frozen=True)
class _Plane:
    """The plane X = 500 mm, cell by cell.

    Attributes:
        thesis: Table 5.
        found: whether a swarm finds zero at the thesis' depth, shape (81,); False where that is 0.
        bounded: ours with the spin within ±180°.
        periodic: ours with the spin periodic.
    """

    thesis: Field
    found: Array
    bounded: Field
    periodic: Field

    @property
    def gain(self) -> Array:
        """Periodic less thesis [mm], no stroke counting as 0, shape (81,)."""
        return _gain(self.thesis, self.periodic)


def printed() -> Field:
    """Table 5 as a field; no stroke where it prints 0."""
    target = np.array([(TABLE_5_X_MM, y, z) for z in TABLE_5_Z_MM for y in TABLE_5_Y_MM], dtype=float)
    return _field(target, np.array(TABLE_5, dtype=float).ravel())


def make(context: Context) -> Section:
    """Table 5 cell by cell, the planes at 50 mm, and why one of them is odd."""
    plane = _table_5(context)
    y, z = (np.arange(first, last + 1, SPACING_MM) for first, last in ((0, 400), (400, 1200)))
    volume = _deepest(context, np.stack(np.meshgrid(PLANES_MM, y, z, indexing="ij"), axis=-1).reshape(-1, 3))
    apart = difference(plane.thesis, plane.periodic)
    results = (*_results(plane, apart), *_volume_results(context, plane, volume))
    text = (
        "The thesis took two days for these 81 cells, of one direction. Here each cell is a search of some"
        " milliseconds; the planes at 50 mm are computed on one side of the robot, as the thesis did.",
        "By its method: one swarm (Table 4, seed 0) in each cell at the depth that Table 5 prints, the spin within"
        " ±180°, reversals counted at 200 samples.",
    )
    return Section(text, results, (_cells(plane),), _pictures(context, plane, apart, volume))


def _table_5(context: Context) -> _Plane:
    thesis = printed()
    found = context.each(partial(_swarm_finds, context), list(zip(thesis.target, thesis.value[:, 0], strict=True)))
    bounded = _deepest(context, thesis.target, psi_bound=np.pi)
    return _Plane(thesis, np.array(found), bounded, _deepest(context, thesis.target))


def _swarm_finds(context: Context, cell: tuple[Array, float]) -> bool:
    """Whether one swarm finds zero reversals at a target [mm] and depth [mm]."""
    target, depth_mm = cell
    if np.isnan(depth_mm):
        return False
    objective = SampledObjective(
        Drilling(context.robot, context.tool, hole_along_x("cell", tuple(target), depth_mm)), threads=1
    )
    return run_swarm(objective, replace(TABLE_4, stop_at_zero=True, seed=0)).reversals == 0


def _deepest(context: Context, target: Array, psi_bound: float | None = None) -> Field:
    """The deepest strokes at targets [mm], shape (T, 3), drilled along +X."""
    settings = replace(context.thesis, psi_bound=psi_bound)

    def depth_mm(place: Array) -> float:
        return (
            deepest_stroke(context.robot, context.tool, hole_along_x("cell", tuple(place), 1.0), settings).depth * 1e3
        )

    return _field(target, np.array(context.each(depth_mm, list(target))))


def _field(target: Array, depth_mm: Array) -> Field:
    return Field(DEEPEST_MM, target, ALONG_X, np.where(depth_mm > 0, depth_mm, np.nan)[:, None])


def _results(plane: _Plane, apart: Difference) -> list[Result]:
    gain, asked = plane.gain, ~np.isnan(plane.thesis.value[:, 0])
    short = gain < -DECREMENT_MM
    less = np.flatnonzero(short)
    below = "; ".join(f"{_where(plane.thesis.target[n])}: {-gain[n]:.1f} mm less" for n in less)
    words = f"Less than the thesis by more than its step in {less.size} cells ({below})." if less.size else (
        "No cell has less than the thesis by more than its step."
    )  # fmt: skip
    symmetry = [_greatest(mirror_in_y(field)) for field in (plane.thesis, plane.bounded, plane.periodic)]
    bounded = float(np.median(_gain(plane.thesis, plane.bounded)[asked]))
    new = np.isnan(plane.thesis.value[:, 0]) & (gain > 0)
    return [
        Result(
            "deepest stroke on the plane X = 500 mm, 81 cells [mm]",
            f"0 to {np.nanmax(plane.thesis.value):.0f}, steps of {DECREMENT_MM:g} mm",
            "Table 5",
            f"a swarm finds zero at the printed depth in {int(plane.found[asked].sum())} of {int(asked.sum())} cells",
            f"at least the printed depth less {DECREMENT_MM:g} mm in {int((~short).sum())} of 81 cells,"
            f" {np.median(gain[asked]):+.1f} mm in the median, {gain.max():+.1f} mm at most; {int(new.sum())} cells"
            " more have a stroke",
            f"{words} With |ψ| ≤ 180° the median gain is {bounded:+.1f} mm: so much a swarm that steps down overlooks;"
            " the rest is the wall at ±180°, which a periodic spin does not have.",
        ),
        Result(
            "mirror cells at Y and −Y differ by at most [mm]",
            f"±{SYMMETRY_MM:g} in the text; {symmetry[0]:g} in the table",
            "sec. 4.6, Table 5",
            "–",
            f"{symmetry[1]:.1e} with |ψ| ≤ 180°, {symmetry[2]:.1e} with periodic spin",
            "The arm is its own mirror image, and so are the limits of A1, A4 and A6: what differs in the table is"
            " chance.",
        ),
    ]


def _volume_results(context: Context, plane: _Plane, volume: Field) -> list[Result]:
    best = int(np.nanargmax(volume.value))
    target, thesis, source = DEEPEST[3]
    there = plane.periodic.value[np.flatnonzero((plane.periodic.target == target).all(axis=1))[0], 0]
    lever, other = (_lever_of_axis_1(context, x) for x in (ODD_MM, ODD_MM - SPACING_MM))
    above = [n for n, t in enumerate(plane.thesis.target) if t[1] == 300 and t[2] in (1100, 900)]
    down = [[float(np.nan_to_num(field.value[n, 0])) for n in above] for field in (plane.thesis, plane.periodic)]
    return [
        Result(
            "deepest stroke of all planes [mm]", f"{thesis:g} at {_where(target)}", source, "–",
            f"{there:.1f} there; {volume.value[best, 0]:.1f} at {_where(volume.target[best])}",
            "The best height falls as the target moves away, as the thesis has it: "
            + ", ".join(f"Z = {z:g} at X = {x:g}" for x, z in _best_heights(volume)) + " mm.",
        ),
        Result(
            "moving a part down by 200 mm [mm]", "from nothing to 120", "sec. 4.6", "–",
            f"at (500, 300) mm from Z = 1100 to 900 mm: from {down[1][0]:.1f} to {down[1][1]:.1f}"
            f" (Table 5: {down[0][0]:.0f} to {down[0][1]:.0f})",
            "The same case.",
        ),
        Result(
            "cells with a stroke on the plane X = 100 mm", "exceedingly discontinuous and sparse; no reason found",
            "sec. 4.6, Figures 22 to 24", "–",
            f"{_answers(volume, ODD_MM)} (X = 0 mm: {_answers(volume, 0.0)}); over all spins |∂θ1/∂ψ| ≤ {lever:.0e}"
            f" at the target, {other:.2f} at X = {ODD_MM - SPACING_MM:g} mm",
            "The wrist centre is 100 mm behind the tip, so here it lies straight beside axis 1 with the drill at the"
            " bottom. Spinning then moves it towards axis 1 or up, never around it: the spin does not move A1, the"
            " stroke does, and A1 reverses however short the stroke is. No quirk, but geometry, of this one plane.",
        ),
    ]  # fmt: skip


def _answers(volume: Field, x_mm: float) -> str:
    """How many cells of a plane have a stroke."""
    value = volume.value[volume.target[:, 0] == x_mm]
    return f"{int((~np.isnan(value)).sum())} of {value.size}"


def _best_heights(volume: Field) -> list[tuple[float, float]]:
    """X and Z [mm] of the deepest cell of each plane in front of the robot."""
    planes = [volume.target[:, 0] == x for x in PLANES_MM if x > 2 * ODD_MM]
    best = [np.flatnonzero(plane)[np.nanargmax(volume.value[plane, 0])] for plane in planes]
    return [(float(volume.target[n, 0]), float(volume.target[n, 2])) for n in best]


def _lever_of_axis_1(context: Context, x_mm: float) -> float:
    """The greatest |d theta_1 / d psi| over all spins and branches at the bottom of some holes at this X."""
    psi = np.linspace(-np.pi, np.pi, SPINS, endpoint=False)
    greatest = 0.0
    for y, z in ((300, 800), (400, 600), (200, 1000)):
        hole = hole_along_x("cell", (x_mm, y, z), 1.0)
        _, theta_psi = joint_rates(Drilling(context.robot, context.tool, hole), 0.0, psi)
        greatest = max(greatest, float(np.nanmax(np.abs(theta_psi[..., 0]))))
    return greatest


def _cells(plane: _Plane) -> Table:
    columns = (
        Column("Y", "mm", 0),
        Column("Z", "mm", 0),
        Column("thesis", "mm", 0),
        Column("a swarm finds zero there"),
        Column("exact, |ψ| ≤ 180°", "mm"),
        Column("exact, periodic", "mm"),
        Column("periodic less thesis", "mm"),
    )
    rows: list[tuple[Cell, ...]] = []
    for n, (_, y, z) in enumerate(plane.thesis.target.tolist()):
        thesis, bounded, periodic = (
            float(np.nan_to_num(field.value[n, 0])) for field in (plane.thesis, plane.bounded, plane.periodic)
        )
        said = "–" if thesis == 0 else ("yes" if plane.found[n] else "no")
        rows.append((y, z, thesis, said, bounded, periodic, float(plane.gain[n])))
    caption = "Table 5, X = 500 mm, cell by cell; no motion threshold."
    return Table("table_5", caption, columns, tuple(rows))


def _pictures(context: Context, plane: _Plane, apart: Difference, volume: Field) -> tuple[Picture, ...]:
    robot = skeleton(context.robot, context.tool, home(context.robot)) * 1e3
    planes = planes_of(volume, across="x")
    subtitle = "KR 6 R700-2, thesis drill, along +X, no motion threshold, spin periodic"
    front = [each for each in planes if each.at >= ODD_MM]
    back = [each for each in planes if each.at <= ODD_MM]
    drilled = [position.hole.target * 1e3 for position in POSITIONS]
    three = _deepest(context, np.array(drilled))
    (ours,) = planes_of(plane.periodic)
    return (
        Picture("table_5", "Table 5: the thesis, ours with periodic spin, and the difference.",
                png(difference_figure(apart, ("thesis", "exact")))),
        Picture("fig_20", "Figure 20: the plane as a surface, offset along the drill by the deepest stroke.",
                png(surface_figure(ours, subtitle, robot))),
        Picture("fig_21", "Figure 21: plane by plane at 50 mm, in one colour scale (the thesis' has one a plane).",
                png(planes_figure(front, subtitle))),
        Picture("fig_22_23", "Figures 22 and 23: the planes from below and from the side; the ring is the best cell.",
                png(views_figure(front, subtitle, robot))),
        Picture("fig_24", "Figure 24: the planes X = −100, 0 and 100 mm. The last is flat: it has no stroke at all.",
                png(views_figure(back, subtitle, robot))),
        Picture("fig_25", "Figure 25: the three positions in the cell, and the robot at home.",
                png(robot_in_cell(three, subtitle, [("robot at home", robot)], [each.name for each in POSITIONS]))),
    )  # fmt: skip


def _gain(first: Field, second: Field) -> Array:
    return (np.nan_to_num(second.value) - np.nan_to_num(first.value))[:, 0]


def _greatest(mirror: Difference | None) -> float:
    """The greatest difference between mirror cells [mm]."""
    assert mirror is not None
    return float(np.nanmax(np.abs(mirror.change)))


def _where(target: Array | tuple[float, ...]) -> str:
    return "(" + ", ".join(f"{value:g}" for value in target).replace("-", "−") + ") mm"
