"""A robot file out of what others say of an arm: a robot description (URDF, xacro) or a table of link parameters."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from zerorev.errors import InputError
from zerorev.files.conversion import robot_data
from zerorev.files.dh_file import axes_of_dh
from zerorev.files.robot_schema import RobotFile
from zerorev.files.text import read_bytes
from zerorev.files.urdf_axes import DescribedArm, arm_of_urdf
from zerorev.files.validation import checked
from zerorev.files.xacro_text import expanded
from zerorev.files.yaml_text import yaml_document, yaml_text
from zerorev.model._arrays import rpy_of
from zerorev.model.axes import Axes
from zerorev.model.robot import Display, Robot
from zerorev.motion.from_axes import TOLERANCE, Found, conditions, robot_of_axes

__all__ = ["Imported", "Limit", "import_robot", "robot_file"]

Limit = tuple[float | None, float | None, float | None]  # lower, upper [deg], speed [deg/s]
DIGITS = 6  # [deg] of limits, which descriptions state in rad
MOST_BYTES = 20 * 2**20
LEAST_MOVED = 1e-4  # [mm] worth a figure
CATALOGUE = "Limits and speeds are those of the description, not the machine data of your controller."


@dataclass(frozen=True)
class Imported:
    """A robot, and what a person has to know of how it was found.

    Attributes:
        robot: with sources and caveats.
        notes: what was chosen, a sentence each.
        apart: how far it is from its source at 200 random joint angles, at most [m].
    """

    robot: Robot
    notes: tuple[str, ...]
    apart: float


def import_robot(
    path: str | Path,
    *,
    tip: str | None = None,
    name: str | None = None,
    manufacturer: str = "",
    limits: Mapping[str, Limit] | None = None,
    arguments: Mapping[str, str] | None = None,
) -> Imported:
    """A robot from a file, equal to it at 200 random joint angles (design of the importer: the six axes in space).

    Args:
        path: a URDF (.urdf, .xml), a xacro file (.xacro), or a table of link parameters (.yaml, zerorev.dh/1).
        tip: the link in which the controller counts its tools; None: it is chosen.
        name: how jobs call the robot; None: as the file does.
        manufacturer: who makes it, which decides the language of its programs.
        limits: of joints by their names, where the file states none, or others.
        arguments: of a xacro file.

    Raises:
        InputError: no such file, an arm outside the class (and which condition fails by how much), a limit that
            nobody states.
    """
    path = Path(path)
    ending = path.suffix.lower()
    if ending in (".yaml", ".yml"):
        if tip is not None:
            raise InputError(
                "a table of link parameters has one tip", where="--tip", accepted="the key flange of the file"
            )
        arm = DescribedArm(axes_of_dh(path), None, ())
    elif ending == ".xacro":
        arm = arm_of_urdf(path, tip, expanded(path, dict(arguments or {})))
    else:
        arm = arm_of_urdf(path, tip)
    notes = list(arm.notes)
    axes = arm.axes if arm.snapped is None else _better(arm.axes, arm.snapped, notes)
    axes = _with_limits(replace(axes, name=name or axes.name), limits or {})
    display = Display(j3_less_j2=manufacturer.upper() == "FANUC")
    digest = hashlib.sha256(read_bytes(path, "a robot description", MOST_BYTES)).hexdigest()[:12]
    source = f"{path.name} (sha256 {digest})"
    sources = {"geometry": f"{source}: axes and tip {axes.tip}", "sign": source, "offset": source}
    sources |= {"limits": source, "speed": source}
    if limits:
        sources["limits"] += f"; given by hand: {', '.join(limits)}"
    found = robot_of_axes(axes, manufacturer=manufacturer, display=display, sources=sources)
    notes += _notes(axes, found)
    robot = replace(found.robot, caveats=(CATALOGUE, *_caveats(axes, found)))
    checked(RobotFile, yaml_document(robot_file(robot), f"{path}, as a robot file"))  # e.g. names of any length
    return Imported(robot, tuple(notes), found.apart)


def robot_file(robot: Robot) -> str:
    """The text of a robot file (YAML), which `read_robot` reads as the same robot."""
    data: dict[str, Any] = {"format": "zerorev.robot/1"} | robot_data(robot)
    del data["sha256"]
    text = yaml_text({key: value for key, value in data.items() if value != ""})
    if robot.sources:
        text += "sources:\n" + "".join(f"  {_quoted(key)}: {_quoted(words)}\n" for key, words in robot.sources.items())
    for key, lines in (("second_sources", robot.second_sources), ("caveats", robot.caveats)):
        if lines:
            text += f"{key}:\n" + "".join(f"  - {_quoted(line)}\n" for line in lines)
    return text


def _quoted(text: str) -> str:
    return json.dumps(text)  # which is YAML, too


def _better(exact: Axes, snapped: Axes, notes: list[str]) -> Axes:
    """The axes as the file has them, or with the angles that they were rounded from where that makes them an arm."""
    if not conditions(exact):
        across = np.abs(exact.T_root_tip[:3, :3].T @ exact.direction[5])
        if not 0 < abs(across.max() - 1.0) < TOLERANCE and np.sort(across)[1] < TOLERANCE**2:
            return exact  # the tip lies along axis 6, to the last digit
    elif conditions(snapped):
        return exact
    joints = np.random.default_rng(0).uniform(-np.pi, np.pi, (200, 6))
    moved = np.abs((exact.forward(joints) - snapped.forward(joints))[:, :3, 3]).max()
    notes.append(
        f"angles of the file were rounded; taken as the multiples of 15 deg next to them, which moves {exact.tip} by "
        f"{max(moved * 1e3, LEAST_MOVED):.2g} mm at most"
    )
    return snapped


def _with_limits(axes: Axes, limits: Mapping[str, Limit]) -> Axes:
    """The axes with limits given by hand; each joint has all three then."""
    if unknown := set(limits) - set(axes.joint_names):
        raise InputError(f"no joint {sorted(unknown)[0]}", where="--limit", accepted=", ".join(axes.joint_names))
    rows = [axes.lower.copy(), axes.upper.copy(), axes.speed.copy()]
    for k, joint in enumerate(axes.joint_names):
        for row, value in zip(rows, limits.get(joint, (None, None, None)), strict=True):
            if value is not None:
                row[k] = np.deg2rad(value)
    missing = [
        joint for k, joint in enumerate(axes.joint_names) if any(not np.isfinite(row[k]) for row in rows)
    ]  # fmt: skip
    if missing:
        raise InputError(
            f"{axes.name}: no limits or no speed of {', '.join(missing)}",
            accepted=f"--limit {missing[0]}=LOWER:UPPER:SPEED, in deg and deg/s, from the machine data",
        )
    lower, upper, speed = (np.deg2rad(np.round(np.rad2deg(row), DIGITS)) for row in rows)
    return replace(axes, lower=lower, upper=upper, speed=speed)


def _notes(axes: Axes, found: Found) -> list[str]:
    notes = []
    if found.robot.base_in_root is not None:
        x, y, z = (f"{round(each * 1e3, 6) + 0.0:g}" for each in found.robot.base_in_root[:3])
        notes.append(f"the controller counts from ({x}, {y}, {z}) mm in the base frame of the arm (base_in_root)")
    return notes + [each.rstrip(".") for each in _caveats(axes, found)]


def _caveats(axes: Axes, found: Found) -> tuple[str, ...]:
    T = found.T_flange_tip
    if (np.eye(4) == T).all():
        return ()
    xyz, rpy = _three(T[:3, 3] * 1e3), _three(np.rad2deg(rpy_of(T[:3, :3])))
    return (
        f"Tools count from the flange of joint 6, whose z leaves the arm along it. The link {axes.tip} stands in it at "
        f"xyz_mm {xyz}, rpy_deg {rpy}: a tool measured in {axes.tip} has to be turned and moved by that.",
    )


def _three(values: Sequence[float] | np.ndarray[Any, Any]) -> str:
    return "[" + ", ".join(f"{round(float(value), 6) + 0.0:g}" for value in values) + "]"
