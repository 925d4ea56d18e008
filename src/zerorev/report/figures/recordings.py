"""Two recordings of one hole, with constant spin and without reversals: the kinds of the thesis' Figures 32 to 44."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from zerorev.cell.recordings.metrics import Metrics
from zerorev.cell.recordings.run import DrillingRun
from zerorev.cell.recordings.tip import PlannedHole
from zerorev.model._arrays import Array
from zerorev.motion.joint_path import joints_along, sample_distances
from zerorev.report.figures import style
from zerorev.report.scene.skeleton import skeleton

__all__ = ["Compared", "deviations", "joints", "paths", "postures", "profiles", "torques"]

SAMPLES = 600
MOST_POINTS = 4_000  # of a line: a picture is 1200 px wide
OPTIMISED = style.JOINT_COLOURS[0]
SPARSE = (0, (4, 2))

_Curve = Callable[[DrillingRun], Array | None]


@dataclass(frozen=True)
class Compared:
    """Two runs of one hole.

    Attributes:
        baseline: with constant spin, and what is measured of it.
        optimised: without reversals, and what is measured of it.
        planned: what was planned, or None.
    """

    baseline: tuple[DrillingRun, Metrics]
    optimised: tuple[DrillingRun, Metrics]
    planned: PlannedHole | None = None

    @property
    def names(self) -> tuple[str, ...]:
        """Of the joints."""
        return self.planned.drilling.robot.joint_names if self.planned else tuple(f"A{n}" for n in range(1, 7))

    @property
    def heading(self) -> str:
        """What was drilled, at which feeds, in a line."""
        feeds = (self.baseline[0].feed * 1e3, self.optimised[0].feed * 1e3)
        hole = f"hole {self.planned.drilling.hole.id}   |   " if self.planned else ""
        return f"{hole}baseline at {feeds[0]:.3g} mm/s, optimised at {feeds[1]:.3g} mm/s"


def joints(compared: Compared) -> Figure | None:
    """Joint angles against path distance, with those of the plan (figs. 32, 38, 42); None where none are recorded."""
    return _six(compared, "Joint angles", "joint angle [deg]", _angles, planned=True)


def torques(compared: Compared) -> Figure | None:
    """Joint torques as logged against path distance (figs. 28, 34, 39, 43); None where none are recorded."""
    return _six(compared, "Joint torques as logged", "torque [Nm]", lambda run: run.recording.torque, planned=False)


def postures(compared: Compared) -> Figure | None:
    """The arm at the start, the turn and the end of the optimised run, from the side and from above (figs. 30, 31).

    None without a plan, whose robot and tool are drawn, or without recorded joints.
    """
    run, planned = compared.optimised[0], compared.planned
    recorded = _angles(run)
    if planned is None or recorded is None:
        return None
    drilling = planned.drilling
    rows = np.deg2rad(recorded[run.rows])
    turn = int(np.argmin(np.abs(run.path)))
    figure = style.headed_figure("Postures of the optimised run", compared.heading, 4.4)
    places: list[tuple[str, int, Any, float]] = [
        ("start", 0, SPARSE, 1.6), ("turn", turn, "-", 2.4), ("end", len(rows) - 1, (0, (1.2, 1.2)), 1.6),
    ]  # fmt: skip
    x = 0
    for axes, y, name in zip(figure.subplots(1, 2), (2, 1), ("from the side", "from above"), strict=True):
        style.bare_axes(axes)
        axes.set_aspect("equal", adjustable="datalim")
        for _, n, dashes, width in places:
            arm = skeleton(drilling.robot, drilling.tool, rows[n]) * 1e3
            axes.plot(arm[:, x], arm[:, y], color=OPTIMISED, linewidth=width, linestyle=dashes)
        ends = (drilling.hole.entry, drilling.hole.target)
        axes.plot([end[x] * 1e3 for end in ends], [end[y] * 1e3 for end in ends], color=style.INK, linewidth=3.0)
        axes.set_title(name, loc="left", size=9.5, color=style.MUTED)
        style.label(axes, x="X [mm]", y="YZ"[y - 1] + " [mm]")
    legend = [
        Line2D([], [], color=OPTIMISED, linewidth=width, linestyle=dashes, label=label)
        for label, _, dashes, width in places
    ]
    style.legend_below(figure, [*legend, Line2D([], [], color=style.INK, linewidth=3.0, label="stroke")], 4)
    return figure


def paths(compared: Compared) -> Figure:
    """Path distance against time since the program began (fig. 33)."""
    figure = style.headed_figure("Path distance", compared.heading, 3.8)
    axes = figure.add_subplot()
    style.bare_axes(axes)
    axes.axhline(0, color=style.MUTED, linewidth=0.9, linestyle=":")
    for run, colour, dashes in _runs(compared):
        time = run.recording.time[run.rows] - run.alignment.time
        _line(axes, time, run.path * 1e3, colour, dashes)
    style.label(axes, x="time since the program began [s]", y="path distance [mm]")
    style.legend_below(figure, _legend(), 2)
    return figure


def profiles(compared: Compared) -> Figure:
    """Horizontal and vertical place of the tip against the distance from the turn (figs. 35, 40, 44)."""
    figure = style.headed_figure("The tip across the drill axis", compared.heading, 6.0)
    upper, lower = figure.subplots(2, 1, sharex=True)
    for n, (axes, name) in enumerate(((upper, "horizontal"), (lower, "vertical"))):
        style.bare_axes(axes)
        for (_, found), colour in ((compared.baseline, style.BASELINE_COLOUR), (compared.optimised, OPTIMISED)):
            place, plunge = found.lateral[:, n] * 1e3, found.path <= 0
            axes.plot(found.path[plunge] * 1e3, place[plunge], color=colour, linewidth=2.0)
            axes.plot(-found.path[~plunge] * 1e3, place[~plunge], color=colour, linewidth=1.2, linestyle=SPARSE)
            axes.axhline(found.mean[n] * 1e3, color=colour, linewidth=0.8, linestyle=":")
        style.label(axes, y=f"{name} [mm]")
    style.label(lower, x="distance before the turn [mm]")
    legs = [
        Line2D([], [], color=style.INK, linewidth=2.0, label="plunge"),
        Line2D([], [], color=style.INK, linewidth=1.2, linestyle=SPARSE, label="retract"),
        Line2D([], [], color=style.INK, linewidth=0.8, linestyle=":", label="mean of the motion"),
    ]
    style.legend_below(figure, [*_legend(solid=True), *legs], 5)
    return figure


def deviations(compared: Compared) -> Figure:
    """Distance of the tip from the mean of its motion against path distance (fig. 36)."""
    figure = style.headed_figure("Distance from the mean path", compared.heading, 3.8)
    axes = figure.add_subplot()
    style.bare_axes(axes)
    window = compared.optimised[1].window * 1e3
    axes.axvspan(-window, window, color="#f1f1f1", zorder=0)
    for (_, found), colour, dashes in (
        (compared.baseline, style.BASELINE_COLOUR, SPARSE),
        (compared.optimised, OPTIMISED, "-"),
    ):
        _line(axes, found.path * 1e3, found.deviation * 1e3, colour, dashes)
        axes.plot([-window, window], [found.deviation_max * 1e3] * 2, color=colour, linewidth=0.9, linestyle=":")
    axes.set_ylim(bottom=0)
    style.label(axes, x="path distance from the turn [mm]", y="distance from the mean [mm]")
    shade = Line2D([], [], color="#dddddd", linewidth=7, label="window, and the greatest in it (dotted)")
    style.legend_below(figure, [*_legend(), shade], 3)
    return figure


def _six(compared: Compared, title: str, unit: str, curve: _Curve, *, planned: bool) -> Figure | None:
    found = [(run, curve(run), colour, dashes) for run, colour, dashes in _runs(compared)]
    if all(values is None for _, values, _, _ in found):
        return None
    figure = style.headed_figure(title, compared.heading, 5.6)
    expected = _planned(compared) if planned else None
    for i, axes in enumerate(figure.subplots(2, 3, sharex=True).flat):
        style.bare_axes(axes)
        axes.axvline(0, color=style.MUTED, linewidth=0.9, linestyle=":")
        for run, values, colour, dashes in found:
            if values is not None:
                _line(axes, run.path * 1e3, values[run.rows, i], colour, dashes)
        if expected is not None:
            axes.plot(expected[0] * 1e3, expected[1][:, i], color=style.INK, linewidth=0.9, linestyle=(0, (1.2, 1.2)))
        axes.set_title(compared.names[i], loc="left", size=11, weight="bold", color=style.JOINT_INKS[i], pad=4,
                       parse_math=False)  # fmt: skip
        style.label(axes, x="path distance [mm]" if i >= 3 else "", y=unit if i % 3 == 0 else "")
    plan = [Line2D([], [], color=style.INK, linewidth=0.9, linestyle=(0, (1.2, 1.2)), label="as planned, no blend")]
    style.legend_below(figure, [*_legend(), *(plan if expected is not None else [])], 3)
    return figure


def _angles(run: DrillingRun) -> Array | None:
    measured = run.recording.joints if run.recording.joints is not None else run.recording.joints_commanded
    return None if measured is None else np.rad2deg(measured)


def _planned(compared: Compared) -> tuple[Array, Array] | None:
    """Path distance [m] and angles [deg] of the plan, with the turns that the optimised run has."""
    planned = compared.planned
    if planned is None:
        return None
    profile = planned.motion.profile
    distance = sample_distances(profile, SAMPLES)
    found = joints_along(planned.drilling, planned.motion.branch, *profile.at(distance))
    path = distance - profile.distance[profile.corner]
    run = compared.optimised[0]
    recorded = _angles(run)
    if recorded is not None:
        at_turn = np.deg2rad(recorded[run.rows][int(np.argmin(np.abs(run.path)))])
        found = found + np.round((at_turn - found[int(np.argmin(np.abs(path)))]) / (2 * np.pi)) * 2 * np.pi
    return path, np.rad2deg(found)


def _runs(compared: Compared) -> list[tuple[DrillingRun, str, Any]]:
    return [(compared.baseline[0], style.BASELINE_COLOUR, SPARSE), (compared.optimised[0], OPTIMISED, "-")]


def _line(axes: Axes, x: Array, y: Array, colour: str, dashes: Any) -> None:
    every = -(-len(x) // MOST_POINTS)
    axes.plot(x[::every], y[::every], color=colour, linewidth=1.6, linestyle=dashes)


def _legend(*, solid: bool = False) -> list[Line2D]:
    return [
        Line2D(
            [], [], color=style.BASELINE_COLOUR, linewidth=1.6, linestyle="-" if solid else SPARSE, label="baseline"
        ),
        Line2D([], [], color=OPTIMISED, linewidth=1.6, label="optimised"),
    ]  # fmt: skip
