"""The figures of the command line, one public function per figure; each takes the answer that it draws.

Every function returns a matplotlib `Figure`: a notebook shows it, `figure.savefig(path)` keeps it. A figure with one
axes takes `ax`, so that it can stand among a user's own; those in 3D need axes with `projection="3d"`.
"""

from __future__ import annotations

from importlib.util import find_spec

if find_spec("matplotlib") is None:
    raise ImportError("zerorev.figures needs matplotlib, which is not installed: pip install 'zerorev[figures]'")

from zerorev.report.figures.catalogue import robot_catalogue
from zerorev.report.figures.joints import joint_angles
from zerorev.report.figures.map_difference import map_difference
from zerorev.report.figures.offset import tool_offset
from zerorev.report.figures.placement import placement_map
from zerorev.report.figures.plane import twist_plane
from zerorev.report.figures.rates import critical_rates
from zerorev.report.figures.study import drilled_holes, drive_torques, study_gains, tip_deviation
from zerorev.report.figures.workspace import map_cell, map_planes, map_rose, map_surface, map_views
from zerorev.thesis.figures.comparison import comparison_boxes
from zerorev.thesis.figures.parameter_map import parameter_slices, zero_volume

__all__ = [
    "comparison_boxes",
    "critical_rates",
    "drilled_holes",
    "drive_torques",
    "joint_angles",
    "map_cell",
    "map_difference",
    "map_planes",
    "map_rose",
    "map_surface",
    "map_views",
    "parameter_slices",
    "placement_map",
    "robot_catalogue",
    "study_gains",
    "tip_deviation",
    "tool_offset",
    "twist_plane",
    "zero_volume",
]
