"""xacro, the macro language of robot descriptions, expanded by the package of that name (extra `xacro`).

It evaluates expressions of Python that the file holds: only a file that a person points at is expanded, in a process of
its own with limits of memory and time, and never one that was uploaded. Packages are looked for in the folders above
the file alone, so that no installation of ROS is needed.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

from zerorev.apart import Apart
from zerorev.errors import InputError
from zerorev.files.text import read_bytes

__all__ = ["expanded"]

MOST_BYTES = 20 * 2**20
MOST_LEVELS = 6  # of folders above the file, in which packages are looked for


def expanded(path: str | Path, arguments: dict[str, str] | None = None) -> bytes:
    """The robot description (URDF) that a xacro file stands for.

    Args:
        path: the file.
        arguments: of the file, by their names.

    Raises:
        InputError: no such file, the extra is missing, or the package cannot expand it.
    """
    path = Path(path)
    read_bytes(path, "a xacro file", MOST_BYTES)
    (text,) = Apart(_expand).results([(str(path.resolve()), dict(arguments or {}))])
    return bytes(text)


def _expand(given: Iterator[Any]) -> Iterable[bytes]:
    name, arguments = next(given)
    try:
        import xacro
        from xacro import substitution_args
    except ImportError:
        cure = "pip install 'zerorev[xacro]', or the URDF that `xacro FILE` writes"
        raise InputError(
            "xacro is expanded by the extra xacro, which is not installed", where=name, accepted=cure
        ) from None
    path, missing = Path(name), list[str]()

    def find(package: str) -> str:
        found = _package(package, path)
        if found is None:
            missing.append(package)
            raise FileNotFoundError(package)
        return str(found)

    substitution_args._eval_find = find
    substitution_args._eval_dict["find"] = find
    try:
        document = xacro.process_file(name, mappings=arguments)
        yield document.toxml(encoding="utf-8")
    except Exception as error:  # the package raises what Python raises in the file's own expressions
        if missing:
            accepted = f"its folder beside the file, or beside one of {MOST_LEVELS} folders above it"
            raise InputError(f"no folder of the package {missing[0]}", where=name, accepted=accepted) from None
        said = " ".join(str(error).split())[:300] or type(error).__name__
        accepted = "a xacro file that `xacro` expands; missing arguments: --argument NAME=VALUE"
        raise InputError(f"is not expanded: {said}", where=name, accepted=accepted) from None


def _package(name: str, file: Path) -> Path | None:
    """The folder of a package, by its name or that in its package.xml: above the file, or a folder or two beside it."""
    for above in list(file.parents)[:MOST_LEVELS]:
        if above.name == name:
            return above
        if (above / name).is_dir():
            return above / name
        for pattern in ("package.xml", "*/package.xml", "*/*/package.xml"):
            for manifest in sorted(above.glob(pattern)):
                if manifest.parent.name == name or _named(manifest) == name:
                    return manifest.parent
    return None


def _named(manifest: Path) -> str:
    """The name of a package that its package.xml states."""
    found = re.search(r"<name>\s*([^<\s]+)\s*</name>", manifest.read_text(encoding="utf-8", errors="replace"))
    return found[1] if found else ""
