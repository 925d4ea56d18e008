"""The robots that ship, by how far their wrists reach and what they carry."""

from __future__ import annotations

from collections.abc import Sequence

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from zerorev.model.robot import Robot
from zerorev.report.figures import style

__all__ = ["robot_catalogue"]

MARKERS = "os^DvPX*<>"


def robot_catalogue(robots: Sequence[Robot], *, ax: Axes | None = None) -> Figure:
    """Rated load [kg], on a logarithmic axis, against the reach of the wrist [m]; a marker and colour a maker.

    Args:
        robots: what is drawn; those whose load is not known are counted in the heading alone.
        ax: to draw into; None: a figure with a heading.

    Raises:
        InputError: the axes are not plane ones.
    """
    known = [robot for robot in robots if robot.rated_load is not None]
    unknown = f"; of {len(robots) - len(known)} more the load is not known" if len(known) < len(robots) else ""
    figure, axes = style.one_axes(ax, f"{len(known)} robots by reach and load{unknown}", "", 4.8)
    for k, maker in enumerate(sorted({robot.manufacturer for robot in known})):
        own = [robot for robot in known if robot.manufacturer == maker]
        reach, load = [robot.wrist_reach for robot in own], [robot.rated_load or 0.0 for robot in own]
        axes.plot(reach, load, MARKERS[k % len(MARKERS)], ms=6, alpha=0.85, label=f"{maker} ({len(own)})")
    axes.set_yscale("log")
    axes.yaxis.set_major_formatter("{x:g}")
    axes.set_xlabel("reach of the wrist from axis 1 [m]")
    axes.set_ylabel("rated load [kg]")
    axes.grid(which="both", alpha=0.25)
    axes.legend(loc="upper left", frameon=False)
    return figure
