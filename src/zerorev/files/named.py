"""Robots and tools by their names, which ship with zerorev, or by the paths of their files."""

from __future__ import annotations

from importlib import resources
from pathlib import Path

from zerorev.errors import InputError
from zerorev.files.other_kinds import meant_name, refuse_robot_description
from zerorev.files.text import Document, read_text
from zerorev.files.yaml_text import yaml_document

__all__ = ["named_document", "shipped"]

MOST_LISTED = 20  # names in a message


def shipped(kind: str) -> list[str]:
    """The names of the robots or tools that ship with zerorev.

    Args:
        kind: `robots` or `tools`.
    """
    folder = resources.files("zerorev.files") / kind
    return sorted(entry.name.removesuffix(".yaml") for entry in folder.iterdir() if entry.name.endswith(".yaml"))


def named_document(name_or_path: str | Path, folder: str | Path | None, kind: str) -> Document:
    """A shipped file by its name, or a file by its path.

    Args:
        name_or_path: a shipped name, or a path: it has a separator or an ending of such files.
        folder: where a relative path starts; None: no file is opened.
        kind: `robots` or `tools`.

    Raises:
        InputError: an unknown name, no such file, or a file of another kind.
    """
    name, there, what = str(name_or_path), shipped(kind), kind.removesuffix("s")
    if name in there:
        resource = resources.files("zerorev.files") / kind / f"{name}.yaml"
        return yaml_document(resource.read_text(encoding="utf-8"), f"{name}.yaml")
    meant = meant_name(name, there)
    listed = ", ".join(there) if len(there) <= MOST_LISTED else f"one of the {len(there)} that `zerorev {kind}` lists"
    names = f"did you mean '{meant}'? else {listed}" if meant else listed
    if folder is None:
        raise InputError(f"'{name}' does not ship with zerorev", accepted=names)
    if "/" in name or "\\" in name or name.endswith((".yaml", ".yml", ".json", ".urdf", ".xacro")):
        path = Path(folder) / name
        text = read_text(path, f"a {what} file (YAML)")
        refuse_robot_description(text, str(path))
        return yaml_document(text, str(path))
    raise InputError(f"unknown {what} '{name}'", accepted=f"{names}, or the path of a {what} file ending in .yaml")
