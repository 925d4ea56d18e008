"""From a cell of a workspace map back to a hole that can be planned, checked, exported or viewed."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from zerorev.errors import InputError
from zerorev.files.conversion import cycle_from, robot_from, tool_from
from zerorev.files.map_schema import MapSettingsForm
from zerorev.files.robot_schema import RobotForm, ToolForm
from zerorev.files.stated_forms import noun_from
from zerorev.files.units import m, rad, rad_per_m
from zerorev.maps.frames import frame_of
from zerorev.model.hole import Hole
from zerorev.model.job import Job, Settings
from zerorev.model.map_task import SETTINGS, Question
from zerorev.model.profile import Profile
from zerorev.motion.drilling import Drilling
from zerorev.search.broken_legs import BrokenLegs, Numbers

if TYPE_CHECKING:
    from xarray import Dataset

__all__ = ["hole_of", "job_of", "question_of"]


def question_of(found: Dataset) -> Question:
    """What a map asked, from its attributes.

    Args:
        found: a workspace map.

    Raises:
        InputError: the attributes are not those of a workspace map.
    """
    attributes = found.attrs
    try:
        robot, tool, settings = (dict(attributes[name]) for name in ("robot", "tool", "settings"))
        reference, depth_mm = attributes["psi_reference"], attributes.get("depth_mm")
        for data in (robot, tool):
            data.pop("sha256")
        chosen = MapSettingsForm.model_validate(settings)
        return Question(
            robot_from(RobotForm.model_validate(robot)),
            tool_from(ToolForm.model_validate(tool)),
            attributes["quantity"],
            noun_from(Settings, chosen, SETTINGS, cycle=cycle_from(chosen.cycle)),
            reference if isinstance(reference, str) else tuple(reference),
            None if depth_mm is None else float(m(depth_mm)),
            attributes.get("seed", 0),
        )
    except (KeyError, TypeError, ValueError) as error:
        what = f"has attributes that cannot be used ({type(error).__name__}: {str(error).splitlines()[0]})"
        raise InputError(what, accepted="a map of zerorev map") from None


def hole_of(found: Dataset, **index: int) -> Hole:
    """The hole of a cell, with the depth, the branch and the motion that the map states.

    Args:
        found: a workspace map.
        index: the cell's place along each dimension that is longer than one, e.g. x=0, y=3, z=2, direction=0.

    Returns:
        a hole that `plan` evaluates as it stands. Where there is no motion (a twist spread, or a cell without an
        answer), it has none, and a nominal depth where the map has none.

    Raises:
        InputError: no such cell.
    """
    return _hole(question_of(found), found, index)


def job_of(found: Dataset, cells: list[dict[str, int]]) -> Job:
    """A job of the holes of some cells, ready for `plan_job`.

    Args:
        found: a workspace map.
        cells: their places, as `hole_of` has them.

    Raises:
        InputError: no such cell, or none at all.
    """
    question = question_of(found)
    holes = tuple(_hole(question, found, index) for index in cells)
    # the motion ends at the stroke that the map states, so the corner is where it was looked for
    return Job(question.robot, question.tool, holes, question.settings, frame_of(found), name="map")


def _hole(question: Question, found: Dataset, index: dict[str, int]) -> Hole:
    full = {str(name): index.get(str(name), 0) for name in found.sizes if name != "breakpoint"}
    lacking = [name for name in full if name not in index and found.sizes[name] > 1]
    unknown = [name for name in index if name not in full]
    beyond = [name for name, at in full.items() if not -found.sizes[name] <= at < found.sizes[name]]
    if lacking or unknown or beyond:
        accepted = ", ".join(f"{name} below {found.sizes[name]}" for name in full)
        raise InputError(f"no cell {index}", where="cell", accepted=accepted)
    cell = found.isel(full)
    target, direction = (
        np.array([float(cell[name]) for name in names])
        for names in (("x_mm", "y_mm", "z_mm"), ("direction_x", "direction_y", "direction_z"))
    )
    T = frame_of(found)
    target, direction = m(target) @ T[:3, :3].T + T[:3, 3], direction @ T[:3, :3].T
    name = "cell " + " ".join(f"{key}{at}" for key, at in full.items())
    branch = int(cell["branch"])
    depth = _depth(cell, question)
    hole = question.hole(target, direction, name, depth)
    return replace(hole, profile=_profile(cell, question, hole), branch=branch if branch >= 0 else None)


def _depth(cell: Any, question: Question) -> float | None:
    """Of the motion of a cell [m]; None where it has none."""
    if np.isnan([float(cell[f"psi_{place}_deg"]) for place in ("start", "target", "end")]).any():
        return None
    if "psi_deg" in cell:
        return float(m(cell["standoff_mm"].values[0]))
    return float(m(cell["deepest_mm"])) if "deepest_mm" in cell else question.depth


def _profile(cell: Any, question: Question, hole: Hole) -> Profile | None:
    depth = _depth(cell, question)
    if depth is None:
        return None
    spins = rad(np.array([float(cell[f"psi_{place}_deg"]) for place in ("start", "target", "end")]))
    if "psi_deg" in cell:
        known = ~np.isnan(cell["psi_deg"].values)
        return Profile(m(cell["standoff_mm"].values[known]), rad(cell["psi_deg"].values[known]))
    if "plunge_deg_per_mm" in cell:
        plunge = float(rad_per_m(cell["plunge_deg_per_mm"]))
        numbers = Numbers(float(spins[1]), plunge, float(spins[2] - spins[1]) / depth, depth)
        settings, branch = question.settings, int(cell["branch"])
        return BrokenLegs.at(Drilling.of(question, hole), settings, branch, settings.cycle, depth).motion(numbers)
    return Profile.straight(depth, *spins.tolist())
