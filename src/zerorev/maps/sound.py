"""Whether a folder of zarr can be opened without harm: before any library of zarr looks into it.

A store names the codecs that it is to be read with, and some of those that exist run what they read; it states its own
shape, and any shape fits into a line. So the description of each array is examined first, and each file be a file.
"""

from __future__ import annotations

import json
import math
import os
import stat
from pathlib import Path
from typing import TYPE_CHECKING, Any

from zerorev.errors import InputError
from zerorev.files.map_schema import MOST_CELLS
from zerorev.files.text import read_bytes

if TYPE_CHECKING:
    from xarray import Dataset

__all__ = ["MARK", "check_grid", "check_store"]

MARK = "zarr.json"  # what a folder of zarr holds, and by which an older map is known that may be replaced
SIZES = {
    "bool": 1, "int8": 1, "uint8": 1, "int16": 2, "uint16": 2, "int32": 4, "uint32": 4, "int64": 8, "uint64": 8,
    "float32": 4, "float64": 8,
}  # fmt: skip
CODECS = frozenset({"bytes", "zstd", "crc32c", "gzip", "blosc", "transpose"})
MOST_ENTRIES = 4_000_000  # files and folders
MOST_HEAD = 2**23  # [bytes] of a description; the ids of points stand in one
MOST_ARRAYS = 100
LEAST_BYTES = 2**27  # that may be declared regardless of what the files hold
SQUEEZED = 5_000  # times smaller than what it declares no map is on the disk, once it has begun
TARGETS = ("x_mm", "y_mm", "z_mm")
DIRECTIONS = ("direction_x", "direction_y", "direction_z")


def check_store(path: Path, accepted: str) -> None:
    """Refuse a folder that is not a store of plain numbers, or one that declares far more of them than it can hold.

    Args:
        path: the folder.
        accepted: what kind of folder belongs here, for the message.

    Raises:
        InputError: there is none, or one that is not opened, and why.
    """
    if not (path / MARK).is_file():
        raise InputError("no folder of zarr", where=str(path), accepted=accepted)
    try:
        held = _held(path)
        _head(path / MARK, "group")
        arrays = [_head(entry / MARK, "array") for entry in sorted(path.iterdir()) if entry.is_dir()]
        declared = [_declared(head) for head in arrays]
        if len(arrays) > MOST_ARRAYS:
            raise _NotReadError(f"{len(arrays)} arrays")
        if sum(declared) > max(LEAST_BYTES, SQUEEZED * held):
            raise _NotReadError(f"declares {sum(declared):,} bytes of numbers, and its files hold {held:,}")
    except InputError:
        raise
    except (OSError, ValueError, KeyError, TypeError, AttributeError, RecursionError) as error:
        raise InputError(f"cannot be read: {_said(error)}", where=str(path), accepted=accepted) from None


def check_grid(found: Dataset, path: Path, accepted: str) -> None:
    """Refuse a map whose coordinates or variables are not those of a grid of targets and directions.

    Args:
        found: as xarray opens it, nothing of it loaded.
        path: of its folder, for the message.
        accepted: what kind of folder belongs here, for the message.

    Raises:
        InputError: what is missing, or lies over other dimensions.
    """
    places = ("point",) if "point" in found.dims else ("x", "y", "z")
    cell = (*places, "direction")
    wanted: dict[str, tuple[str, ...]] = dict.fromkeys(DIRECTIONS, ("direction",))
    wanted |= {name: (place,) for name, place in zip(TARGETS, places * (3 // len(places)), strict=True)}
    for name, dims in wanted.items():
        if name not in found or found[name].dims != dims:
            what = f"has no {name} over {', '.join(dims)}"
            raise InputError(what, where=str(path), accepted=accepted)
    for variable, values in found.data_vars.items():
        if values.dims not in (cell, (*cell, "breakpoint")):
            raise InputError(
                f"has {variable} over {', '.join(map(str, values.dims))}", where=str(path), accepted=accepted
            )
    if not 0 < math.prod(found.sizes[name] for name in cell) <= MOST_CELLS:
        raise InputError("has no cells, or too many", where=str(path), accepted=f"1 to {MOST_CELLS:,} cells")


class _NotReadError(ValueError):
    """What of a store is not read."""


def _said(error: Exception) -> str:
    if isinstance(error, _NotReadError):
        return str(error)
    return (isinstance(error, OSError) and error.strerror) or f"its description cannot be read ({error})"


def _held(path: Path) -> int:
    """Bytes of all files of a folder, each of which is a file or a folder."""
    held, seen, waiting = 0, 0, [path]
    while waiting:
        with os.scandir(waiting.pop()) as entries:
            for entry in entries:
                if (seen := seen + 1) > MOST_ENTRIES:
                    raise _NotReadError(f"more than {MOST_ENTRIES:,} files")
                there = entry.stat(follow_symlinks=False)
                if stat.S_ISDIR(there.st_mode):
                    waiting.append(Path(entry.path))
                elif stat.S_ISREG(there.st_mode):
                    held += there.st_size
                else:
                    raise _NotReadError(f"{entry.name} is not a regular file")
    return held


def _head(file: Path, kind: str) -> dict[str, Any]:
    head = json.loads(read_bytes(file, f"the description of {'an array' if kind == 'array' else 'a group'}", MOST_HEAD))
    if head["zarr_format"] != 3 or head["node_type"] != kind:
        raise _NotReadError(f"{file.parent.name} is not a zarr 3 {kind}")
    return dict(head)


def _declared(head: dict[str, Any]) -> int:
    """Bytes of an array of numbers, by its description.

    Raises:
        _NotReadError: it holds something else, or is read by a codec that maps are not written with.
    """
    if head["data_type"] not in SIZES:
        raise _NotReadError(f"numbers of the type {head['data_type']}")
    if unknown := {str(codec["name"]) for codec in head["codecs"]} - CODECS:
        raise _NotReadError(f"the codec {', '.join(sorted(unknown))}")
    chunk = head["chunk_grid"]["configuration"]["chunk_shape"]
    size: int = SIZES[head["data_type"]]
    for shape in (head["shape"], chunk):
        if not all(isinstance(count, int) and count >= 0 for count in shape):
            raise _NotReadError(f"the shape {shape}")
    return size * max(int(math.prod(head["shape"])), int(math.prod(chunk)))
