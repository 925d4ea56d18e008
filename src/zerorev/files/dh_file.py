"""A table of link parameters (Denavit, Hartenberg), of either kind, as YAML: six axes in space come out of it."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal

import numpy as np
from pydantic import Field

from zerorev.files.robot_schema import FrameForm
from zerorev.files.stated_forms import Form
from zerorev.files.text import read_text
from zerorev.files.units import m, rad
from zerorev.files.validation import checked
from zerorev.files.values import Angle, Length, Name, Positive
from zerorev.files.yaml_text import yaml_document
from zerorev.model._arrays import Array, rotation_rpy, transform
from zerorev.model.axes import Axes

__all__ = ["DhFile", "axes_of_dh"]


class DhJointForm(Form):
    """A row of the table, and what the joint may do."""

    name: Name = Field(description="text: the joint's name")
    a_mm: Length = Field(default=0.0, description="a number [mm]: length of the link, a (modified: of the link before)")
    alpha_deg: Angle = Field(default=0.0, description="a number [deg]: twist of the link, alpha (modified: before)")
    d_mm: Length = Field(default=0.0, description="a number [mm]: offset along the axis, d")
    theta_deg: Angle = Field(default=0.0, description="a number [deg]: theta where the controller shows 0")
    sign: Literal[-1, 1] = Field(default=1, description="1 or -1: whether theta grows with what the controller shows")
    lower_deg: Angle | None = Field(default=None, description="a number [deg]: the least angle that is shown")
    upper_deg: Angle | None = Field(default=None, description="a number [deg]: the greatest one")
    speed_deg_s: Positive | None = Field(default=None, description="a number [deg/s]: the greatest speed")


class DhFile(Form):
    """A file of link parameters, YAML."""

    format: Literal["zerorev.dh/1"] = Field(description="zerorev.dh/1")
    name: Name = Field(description="text: how jobs call the robot")
    convention: Literal["standard", "modified"] = Field(
        description="standard: Rz(theta) Tz(d) Tx(a) Rx(alpha); modified (Craig): Rx(alpha) Tx(a) Rz(theta) Tz(d)"
    )
    joints: Annotated[list[DhJointForm], Field(min_length=6, max_length=6)] = Field(
        description="a list of six mappings of name, a_mm, alpha_deg, d_mm, theta_deg, sign, lower_deg, upper_deg, "
        "speed_deg_s"
    )
    base: FrameForm = Field(
        default=FrameForm(), description="a mapping of xyz_mm and rpy_deg: frame 0 in the base frame"
    )
    flange: FrameForm = Field(default=FrameForm(), description="a mapping of xyz_mm and rpy_deg: the flange in frame 6")


def axes_of_dh(path: str | Path) -> Axes:
    """The six axes of a table of link parameters.

    Args:
        path: a YAML file, zerorev.dh/1.

    Raises:
        InputError: no such file, or not such a table.
    """
    document = yaml_document(read_text(Path(path), "a table of link parameters (YAML)"), str(path))
    form = checked(DhFile, document)
    modified = form.convention == "modified"
    T, direction, point = _frame(form.base), [], []
    for row in form.joints:
        a, alpha, d, theta = (
            float(m(row.a_mm)),
            float(rad(row.alpha_deg)),
            float(m(row.d_mm)),
            float(rad(row.theta_deg)),
        )
        across = transform(rotation_rpy(alpha, 0.0, 0.0), np.array([a, 0.0, 0.0]))
        along = transform(rotation_rpy(0.0, 0.0, theta), np.array([0.0, 0.0, d]))
        if modified:
            T = T @ across
        direction.append(row.sign * T[:3, 2])
        point.append(T[:3, 3].copy())
        T = T @ along
        if not modified:
            T = T @ across
    a1, a2, a3, a4, a5, a6 = (row.name for row in form.joints)
    limits = [
        [
            np.nan if value is None else float(np.deg2rad(value))
            for value in (row.lower_deg, row.upper_deg, row.speed_deg_s)
        ]
        for row in form.joints
    ]
    lower, upper, speed = np.array(limits).T
    names = (a1, a2, a3, a4, a5, a6)
    T_root_tip = T @ _frame(form.flange)
    return Axes(
        form.name, names, np.array(direction), np.array(point), T_root_tip, "flange", np.eye(4), lower, upper, speed
    )


def _frame(form: FrameForm) -> Array:
    return transform(rotation_rpy(*rad(form.rpy_deg)), np.array(m(form.xyz_mm)))
