"""A file of another kind where a job, a robot or a tool belongs: what it is, and what it is for."""

from __future__ import annotations

from contextlib import suppress
from difflib import get_close_matches
from pathlib import Path
from typing import Any

from zerorev.errors import InputError

__all__ = ["is_plan", "meant_name", "refuse_another_kind", "refuse_map_folder", "refuse_robot_description"]

FOR = {
    "plan": ("a plan", "zerorev check, export, replay and view"),
    "depth": ("a file of depths", "zerorev check, export and view"),
    "part": ("an unfinished plan", "zerorev check and view"),
    "map": ("a map file", "zerorev map"),
    "robot": ("a robot file", "the key robot of a job"),
    "tool": ("a tool file", "the key tool of a job"),
    "dh": ("a table of link parameters", "zerorev robots import"),
    "cell": ("a cell file", "zerorev simulate --cell"),
}
OF_A_MAP = ("targets", "points", "directions")


def is_plan(text: str, name: str) -> bool:
    """Whether a text is JSON, as plans are and jobs are not.

    Args:
        text: of a file.
        name: that it has.
    """
    return text.lstrip().startswith("{") and not name.lower().endswith((".yaml", ".yml"))


def refuse_another_kind(data: Any, file: str) -> None:
    """Refuse the data of another kind of file where a job is read.

    Args:
        data: of the file.
        file: how messages name it.

    Raises:
        InputError: it says that it is a plan, a map, a robot and so on, or has the keys of a map file.
    """
    if isinstance(data, str) and _is_description(data):
        accepted = "a job file (YAML); zerorev robots import makes a robot file of it, which a job names"
        raise InputError("is a robot description (URDF, xacro), not a job", where=file, accepted=accepted)
    if not isinstance(data, dict):
        return
    name = str(data.get("format", "")).removeprefix("zerorev.").partition("/")[0]
    if "format" not in data and "holes" not in data and any(key in data for key in OF_A_MAP):
        name = "map"
    if name in FOR:
        what, use = FOR[name]
        accepted = f"format: zerorev.job/1: a job file with robot, tool and holes; {what} is for {use}"
        form = f" (zerorev.{name}/1)" if "format" in data else ""
        raise InputError(f"is {what}, not a job{form}", where=file, accepted=accepted)


def refuse_map_folder(path: Path) -> None:
    """Refuse the folder of a workspace map where a job is read.

    Args:
        path: of a job.

    Raises:
        InputError: it is such a folder.
    """
    is_map = False
    with suppress(OSError, ValueError):  # a path that no system takes is refused where it is opened
        is_map = (path / "zarr.json").is_file()
    if is_map:
        accepted = "a job file (YAML); a map is for zerorev map show, map compare and view"
        raise InputError("is a workspace map, not a job", where=str(path), accepted=accepted)


def refuse_robot_description(text: str, file: str) -> None:
    """Refuse a robot description of ROS where a robot file is read.

    Args:
        text: of the file.
        file: how messages name it.

    Raises:
        InputError: it is one.
    """
    if _is_description(text):
        accepted = "a robot file (YAML); zerorev robots import makes one of it, zerorev view --urdf shows its meshes"
        raise InputError("is a robot description (URDF), not a robot file", where=file, accepted=accepted)


def _is_description(text: str) -> bool:
    return text.lstrip("\ufeff \t\r\n").startswith(("<?xml", "<robot"))


def meant_name(name: str, shipped: list[str]) -> str | None:
    """The shipped name that somebody meant who wrote it as makers and data sheets do, or None.

    Args:
        name: as written, e.g. `KR 120 R2700-2`.
        shipped: names.
    """
    plain = {_letters(each): each for each in shipped}
    written = _letters(name)
    if within := [each for each in plain if len(written) > 2 and (written in each or each in written)]:
        return plain[min(within, key=lambda each: abs(len(each) - len(written)))]
    near = get_close_matches(written, plain, n=1, cutoff=0.7)
    return plain[near[0]] if near else None


def _letters(name: str) -> str:
    return "".join(letter for letter in name.lower() if letter.isalnum())
