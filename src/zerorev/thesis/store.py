"""Maps on disk: zarr with coordinates and attributes, written whole or not at all."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from zerorev.errors import InputError
from zerorev.files.output import write_whole_folder
from zerorev.maps.sound import MARK, check_store
from zerorev.thesis.parameter_map import AXES, FORMAT

if TYPE_CHECKING:
    from xarray import Dataset

__all__ = ["MARK", "read_map", "write_map"]

VARIABLES = {"score", "reversals", "branch", "travel_deg"}
CHUNK_TARGETS = 8


def write_map(found: Dataset, path: str | Path) -> None:
    """Write a map as a folder of zarr; a map of the same name is replaced once the new one is whole.

    Args:
        found: of `parameter_map`.
        path: the folder.

    Raises:
        OutputError: the folder cannot be written, or there is something else of that name.
    """
    sizes = [found.sizes[name] for name in AXES]
    chunks = (min(CHUNK_TARGETS, sizes[0]), *sizes[1:])
    encoding = {name: {"chunks": chunks} for name in VARIABLES}

    def fill(folder: Path) -> None:
        found.to_zarr(folder, mode="w", consolidated=False, encoding=encoding)

    write_whole_folder(path, MARK, fill)


def read_map(path: str | Path) -> Dataset:
    """Read a map that `write_map` wrote.

    Raises:
        InputError: there is no such folder, or it holds no parameter map.
    """
    import xarray

    accepted = "a folder written by zerorev parameter-map"
    check_store(Path(path), accepted)
    try:
        with xarray.open_zarr(path, chunks=None, consolidated=False, zarr_format=3, decode_times=False) as stored:
            found: Dataset = stored.load()
    except Exception as error:  # what the libraries raise on a damaged store is of many kinds
        raise InputError(f"cannot be read: {error}", where=str(path), accepted=accepted) from None
    if found.attrs.get("format") != FORMAT or not set(found.data_vars) >= VARIABLES or set(found.dims) != set(AXES):
        raise InputError("not a parameter map", where=str(path), accepted=accepted)
    return found
