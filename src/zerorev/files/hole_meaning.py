"""What the points and directions of a list mean: from a list as CAD has it to holes as a job file has them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from zerorev.errors import InputError
from zerorev.files.schema import HoleForm, JobFile
from zerorev.files.units import plain
from zerorev.model._arrays import unit

__all__ = ["AS_IN_A_JOB", "Meaning", "Normals", "Point", "as_in_a_job", "meaning_of"]

Normals = Literal["in", "out"]
Point = Literal["bottom", "entry"]


@dataclass(frozen=True)
class Meaning:
    """How a list means its holes.

    Attributes:
        normals: whether directions point into the material or out of it.
        point: whether targets are bottoms of strokes, or the points where the drill enters.
        depth_mm: of the holes that have none of their own, or None.
        breakthrough_mm: how far the tip runs beyond the bottom.
        branch: of the holes that name none, or None.
    """

    normals: Normals = "in"
    point: Point = "bottom"
    depth_mm: float | None = None
    breakthrough_mm: float = 0.0
    branch: int | None = None


AS_IN_A_JOB = Meaning()


def as_in_a_job(hole: HoleForm, meaning: Meaning) -> HoleForm:
    """The same hole with the bottom of its stroke as target and a direction into the material.

    Args:
        hole: as the list has it.
        meaning: of the list.

    Raises:
        InputError: it has no depth, and its bottom cannot be known without; no direction.
    """
    depth = meaning.depth_mm if hole.depth_mm is None else hole.depth_mm
    direction = [-value + 0.0 for value in hole.direction] if meaning.normals == "out" else hole.direction
    further = meaning.breakthrough_mm
    if meaning.point == "entry":
        if depth is None:
            accepted = "a depth for each hole: with point: entry it says where the bottom is"
            raise InputError("is missing", where=f"depth_mm (hole {hole.id})", accepted=accepted)
        further += depth
    target = hole.target_mm
    if further:
        ahead = unit(direction, f"hole {hole.id}, direction")
        target = list(plain(np.array(target) + further * ahead))
    stroke = None if depth is None else depth + meaning.breakthrough_mm
    branch = meaning.branch if hole.branch is None else hole.branch
    return hole.model_copy(update={"target_mm": target, "direction": direction, "depth_mm": stroke, "branch": branch})


def meaning_of(form: JobFile) -> Meaning:
    """What a job file says of all of its holes.

    Args:
        form: the job.
    """
    return Meaning(form.normals, form.point, form.depth_mm, form.breakthrough_mm, form.branch)
