"""From a job to the text of its file; millimetres and degrees begin here. `zerorev.files.io` goes the other way."""

from __future__ import annotations

import re
from typing import Any

import numpy as np

from zerorev.errors import InputError
from zerorev.files.conversion import frame_data, robot_data, settings_data, tool_data
from zerorev.files.io import read_robot, robot_names
from zerorev.files.solids import around_data
from zerorev.files.stated_forms import data_of
from zerorev.files.units import deg, mm, plain
from zerorev.files.yaml_text import yaml_text
from zerorev.model._arrays import Array
from zerorev.model.hole import REFERENCES, Hole, psi_zero_vector
from zerorev.model.job import Job, Settings
from zerorev.model.robot import Robot

__all__ = ["job_files"]

ROBOT_FILE = "robot.yaml"


def job_files(job: Job) -> dict[str, str]:
    """A job's files, text by name: the job's own first, and its robot's where that does not ship with zerorev.

    Args:
        job: any, also one that was edited or that comes from a plan.

    Raises:
        InputError: its holes count their spins from different references, and a job file has one.
    """
    ships = job.robot.name in robot_names() and _numbers(read_robot(job.robot.name)) == _numbers(job.robot)
    tool = {key: value for key, value in tool_data(job.tool).items() if key != "sha256"}
    defaults = settings_data(Settings())
    settings = {key: value for key, value in settings_data(job.settings).items() if value != defaults[key]}
    data = {
        "format": "zerorev.job/1",
        "name": job.name,
        "robot": job.robot.name if ships else f"./{ROBOT_FILE}",
        "tool": tool,
        "part_frame": frame_data(job.T_base_part),
        "psi_reference": _reference(job),
        **settings,
        **around_data(job.settings.surroundings),
        "holes": [plain(_hole_data(hole, job.T_base_part)) for hole in job.holes],
    }
    stem = re.sub(r"[^A-Za-z0-9.-]+", "_", job.name).strip("._") or "job"
    files = {f"{stem}.yaml": yaml_text(data)}
    return files if ships else files | {ROBOT_FILE: yaml_text({"format": "zerorev.robot/1"} | _numbers(job.robot))}


def _numbers(robot: Robot) -> dict[str, Any]:
    return {key: value for key, value in robot_data(robot).items() if key != "sha256"}


def _hole_data(hole: Hole, T_base_part: Array) -> dict[str, Any]:
    """A hole in the part frame."""
    R, origin = T_base_part[:3, :3], T_base_part[:3, 3]
    data: dict[str, Any] = {
        "id": hole.id,
        "target_mm": mm(R.T @ (hole.target - origin)).round(9) + 0.0,
        "direction": R.T @ hole.direction,
        "depth_mm": mm(hole.depth),
    }
    if hole.profile is not None:
        data |= {"psi_deg": deg(hole.profile.psi), "standoff_mm": mm(hole.profile.standoff)}
    if hole.branch is not None:
        data["branch"] = hole.branch
    if hole.group:
        data["group"] = hole.group
    if hole.cycle is not None:
        data["cycle"] = data_of(hole.cycle)
    return data


def _reference(job: Job) -> str | list[float]:
    """What the spins of all holes are counted from, as a job file has it."""
    given = () if job.psi_reference is None else (job.psi_reference,)
    in_part = [job.T_base_part[:3, :3].T @ hole.psi_zero for hole in job.holes]
    for reference in (*given, *REFERENCES, *in_part):
        if all(_counts_from(reference, hole, job) for hole in job.holes):
            return reference if isinstance(reference, str) else list(plain(np.asarray(reference)))
    raise InputError(
        "its holes count their spins from different directions",
        where=f"job {job.name}",
        accepted="holes of one psi_reference; the plan file keeps them as they are",
    )


def _counts_from(reference: str | Any, hole: Hole, job: Job) -> bool:
    vector = reference if isinstance(reference, str) else np.asarray(reference, dtype=np.float64)
    try:
        zero = psi_zero_vector(vector, hole.target, hole.direction, job.tool, job.T_base_part, hole.id)
    except InputError:
        return False
    return bool(np.abs(zero - hole.psi_zero).max() < 1e-9)
