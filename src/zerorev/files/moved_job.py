"""A job file made from another: its part somewhere else, or some of its holes alone; all else as it was."""

from __future__ import annotations

import os
from collections.abc import Collection
from pathlib import Path
from typing import Any

from zerorev.files.cad.as_listed import is_cad
from zerorev.files.hole_list import given_of, read_hole_list, text_of_list
from zerorev.files.hole_meaning import meaning_of
from zerorev.files.io import read_cad_holes
from zerorev.files.output import check_file, write_text
from zerorev.files.schema import JobFile
from zerorev.files.text import read_bytes, read_text
from zerorev.files.units import deg, mm, plain
from zerorev.files.yaml_text import yaml_document, yaml_text
from zerorev.model._arrays import Array, rpy_of

__all__ = ["frame_text", "write_job"]

OF_A_FILE = ("select", "columns", "unit", "decimal", "normals", "point", "depth_mm", "breakthrough_mm")


def frame_text(T_base_part: Array) -> dict[str, list[float]]:
    """A part frame, shape (4, 4) [m], as a job file has it: `xyz_mm` and `rpy_deg`."""
    frame = {
        "xyz_mm": mm(T_base_part[:3, 3]).round(6) + 0.0,
        "rpy_deg": deg(rpy_of(T_base_part[:3, :3])).round(9) + 0.0,
    }
    return dict(plain(frame))


def write_job(
    target: Path, source: Path, *, T_base_part: Array | None = None, ids: Collection[str] | None = None, note: str = ""
) -> None:
    """Write a job file with the keys of another, whole or not at all; relative paths in it lead where they led.

    Args:
        target: where to.
        source: a job file that can be read.
        T_base_part: where the part stands, shape (4, 4); None: where it stood.
        ids: of the holes to keep; None: all.
        note: a comment at its head.

    Raises:
        OutputError: it cannot be written, or it is the file that is read.
    """
    check_file(target, source)
    data: dict[str, Any] = dict(yaml_document(read_text(source, "a job file (YAML)"), str(source)).data)
    data.setdefault("name", source.stem)
    if isinstance(data["holes"], str) and is_cad(data["holes"]):  # their sides may depend on where the part stood
        data["holes"] = _of_cad(data, source)
    if ids is not None:
        holes = _listed(data, source.parent) if isinstance(data["holes"], str) else data["holes"]
        data["holes"] = [hole for hole in holes if str(hole["id"]) in ids]
    if T_base_part is not None:
        data["part_frame"] = frame_text(T_base_part)
    start, end = source.resolve().parent, target.resolve().parent
    data["tools"] = [dict(use) for use in data.get("tools") or ()]
    for part, key in ((data, "robot"), (data, "tool"), (data, "holes"), *((use, "tool") for use in data["tools"])):
        value = part.get(key)
        if isinstance(value, str) and (start / value).is_file() and not Path(value).is_absolute():
            there = os.path.relpath(start / value, end)
            part[key] = there if "/" in there or "\\" in there or key == "holes" else f"./{there}"
    _lead_meshes(data, start, end)
    if not data["tools"]:
        del data["tools"]
    head = "".join(f"# {line}\n" for line in note.splitlines())
    write_text(target, head + yaml_text(data))


def _lead_meshes(data: dict[str, Any], start: Path, end: Path) -> None:
    """Let the paths of meshes in a job lead where they led.

    Args:
        data: of the job, changed in place.
        start: its folder so far.
        end: its folder from now on.
    """

    def led(path: str) -> str:
        return path if Path(path).is_absolute() else os.path.relpath(start / path, end)

    if isinstance(data.get("part"), str):
        data["part"] = led(data["part"])
    elif isinstance(data.get("part"), dict) and data["part"].get("file"):
        data["part"] = {**data["part"], "file": led(data["part"]["file"])}
    solids = [("fixtures", data)]
    solids += [("bodies", each["tool"]) for each in (data, *data["tools"]) if isinstance(each.get("tool"), dict)]
    for key, owner in solids:
        if owner.get(key):
            owner[key] = [{**each, "file": led(each["file"])} if each.get("file") else each for each in owner[key]]


def _of_cad(data: dict[str, Any], source: Path) -> list[dict[str, Any]]:
    """The same of a job's CAD file."""
    forms = read_cad_holes(source).forms
    for key in OF_A_FILE:
        data.pop(key, None)
    return [form.model_dump(exclude_none=True) for form in forms]


def _listed(data: dict[str, Any], folder: Path) -> list[dict[str, Any]]:
    """The holes of a job's CSV as a list has them; what the job says of the CSV is done, and taken out of it."""
    form = JobFile.model_validate(data)
    text = text_of_list(read_bytes(folder / data["holes"], "a CSV file of holes"))
    listed = read_hole_list(text, given_of(form), meaning_of(form), depth_needed=False)
    for key in OF_A_FILE:
        data.pop(key, None)
    return [row.form.model_dump(exclude_none=True) for row in listed.rows if row.form is not None]
