"""Workspace maps on disk: an xarray dataset in zarr that is filled chunk by chunk and may be left and resumed.

Each variable of a chunk is a file of its own that ends in a checksum (CRC-32C, zarr's own codec), written beside and
renamed. A chunk is finished where all of its files are there and whole; nothing else keeps the books.
"""

from __future__ import annotations

import os
import shutil
from collections.abc import Iterator
from importlib.metadata import version
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from zerorev.errors import InputError, OutputError, ZerorevError
from zerorev.files.conversion import robot_data, tool_data
from zerorev.files.moved_job import frame_text
from zerorev.files.output import as_output_error, check_folder, write_whole_folder
from zerorev.files.stated_forms import data_of, default_of
from zerorev.files.units import mm, plain
from zerorev.files.validation import inside
from zerorev.maps.cells import KNOTS, STATUS, Values, columns_of
from zerorev.maps.chunks import Chunks
from zerorev.maps.replan import question_of
from zerorev.maps.sound import MARK, check_grid, check_store
from zerorev.model.cycle import Cycle
from zerorev.model.map_task import SETTINGS, MapTask
from zerorev.model.quantity import quantity
from zerorev.model.settings import Settings
from zerorev.model.stated import stated

if TYPE_CHECKING:
    from xarray import Dataset
    from zarr import Array as ZarrArray

__all__ = ["FORMAT", "MARK", "MapStore", "read_workspace_map"]

FORMAT = "zerorev.map/1"
CHECKSUM_BYTES = 4
FILE_BLOCK = 4096  # bytes by which a disk gives room
SPARE_ROOM = 1.05
ACCEPTED = "a folder written by zerorev map"


class MapStore:
    """The folder of a map; used in a `with` statement, during which no other run may write it."""

    def __init__(self, path: str | Path, task: MapTask) -> None:
        """Begin the folder of a map, or look at one that was begun.

        Args:
            path: the folder.
            task: the map.

        Raises:
            InputError: the folder holds another map (says what differs), or something else.
            OutputError: it cannot be written, or another run is writing it, or there is no room for it.
        """
        self.path, self.task, self.chunks = Path(path), task, Chunks.of(task)
        self.columns = columns_of(task.question)
        check_folder(path)
        begun = self.path.exists() and any(self.path.iterdir())
        if begun:
            _check_same(read_head(path), _skeleton(task), str(path))
        with as_output_error(path):
            self._check_room(range(self.chunks.count) if not begun else None)
            if not begun:
                write_whole_folder(path, MARK, self._fill)
        self._arrays: dict[str, ZarrArray[Any]] = {}

    def __enter__(self) -> MapStore:
        import zarr

        self._lock = _locked(self.path)
        for torn in self.path.glob("*/c/**/*.partial"):  # of a run that was killed
            torn.unlink()
        try:
            for name in self.columns:
                with zarr.config.set({"array.write_empty_chunks": True}):  # else chunks of nothing but NaN never are
                    array = zarr.open_array(self.path / name, mode="r+")
                if array.shape[: len(self.task.shape)] != self.task.shape or array.chunks[: len(self.chunks.shape)] != (
                    self.chunks.shape
                ):
                    raise ValueError(f"{name} has another shape")
                self._arrays[name] = array
        except Exception as error:  # what zarr raises on a damaged store is of many kinds
            os.close(self._lock)
            raise InputError(
                f"is damaged: {error}", where=str(self.path), accepted=f"{ACCEPTED}; delete it to begin again"
            ) from None
        return self

    def __exit__(self, *_: object) -> None:
        os.close(self._lock)

    def missing(self) -> list[int]:
        """Chunks that are not there, or not whole.

        Raises:
            OutputError: there is no room for them.
        """
        found = [n for n in range(self.chunks.count) if not all(_whole(file) for file in self._files(n))]
        self._check_room(found)
        return found

    def write(self, number: int, values: Values) -> None:
        """Write the variables of a chunk.

        Raises:
            ZerorevError: the disk is full, or will not be written for some other reason.
        """
        box, extent = self.chunks.box(number), self.chunks.extent(number)
        try:
            for name, array in self._arrays.items():
                array[box] = values[name].reshape(*extent, *values[name].shape[1:])
        except OSError as error:
            raise ZerorevError(
                f"cannot write {self.path}: {error.strerror or error}; what is finished is kept, and the same command"
                " resumes"
            ) from None

    def _files(self, number: int) -> Iterator[Path]:
        place = self.chunks.place(number)
        for name in self.columns:
            knots = (0,) if name in ("standoff_mm", "psi_deg") else ()
            yield self.path.joinpath(name, "c", *map(str, (*place, *knots)))

    def _check_room(self, missing: Any) -> None:
        """Make sure that so many chunks have room, uncompressed, as small as files get."""
        if missing is None:
            return
        cells = int(np.prod(self.chunks.shape))
        each = sum(
            -(-cells * np.dtype(kind).itemsize * (KNOTS if name in ("standoff_mm", "psi_deg") else 1) // FILE_BLOCK)
            for name, (kind, _, _) in self.columns.items()
        )
        needed = SPARE_ROOM * len(missing) * each * FILE_BLOCK
        there = shutil.disk_usage(self.path if self.path.exists() else self.path.resolve().parent).free
        if needed > there:
            raise OutputError(str(self.path), f"it needs up to {_size(needed)}, and the disk has {_size(there)} left")

    def _fill(self, folder: Path) -> None:
        import zarr
        from zarr.codecs import Crc32cCodec, ZstdCodec

        _skeleton(self.task).to_zarr(folder, mode="w", consolidated=False)
        group = zarr.open_group(folder, mode="r+")
        flags: dict[str, Any] = {"flag_values": list(range(len(STATUS))), "flag_meanings": " ".join(STATUS)}
        for name, (kind, unit, title) in self.columns.items():
            knots = (KNOTS,) if name in ("standoff_mm", "psi_deg") else ()
            group.create_array(
                name,
                shape=(*self.task.shape, *knots),
                chunks=(*self.chunks.shape, *knots),
                dtype=kind,
                fill_value=-1 if kind == "i1" else np.nan,
                dimension_names=(*self.task.dims, *("breakpoint" for _ in knots)),
                attributes={"units": unit, "long_name": title} | (flags if name == "status" else {}),
                compressors=[ZstdCodec(level=3), Crc32cCodec()],
            )


def read_workspace_map(path: str | Path, *, load: bool = True) -> Dataset:
    """Read a map that `zerorev map` wrote, also one that is not finished.

    Args:
        path: the folder.
        load: whether to have it all in memory; else its variables are read when they are examined.

    Raises:
        InputError: there is no such folder, it holds no workspace map, or it is damaged.
    """
    found = read_head(path)
    with inside(str(path)):
        question_of(found)
    if load:
        try:
            found = found.load()
        except Exception as error:  # what the libraries raise on a damaged store is of many kinds
            what = f"is damaged ({error}); the command that made it mends it"
            raise InputError(what, where=str(path), accepted=ACCEPTED) from None
    return found


def read_head(path: str | Path) -> Dataset:
    """A map whose variables are not yet read.

    Raises:
        InputError: there is no such folder, or it holds no workspace map.
    """
    import xarray

    check_store(Path(path), ACCEPTED)
    try:
        found: Dataset = xarray.open_zarr(path, chunks=None, consolidated=False, zarr_format=3, decode_times=False)
    except Exception as error:  # what the libraries raise on a damaged store is of many kinds
        raise InputError(f"cannot be read: {error}", where=str(path), accepted=ACCEPTED) from None
    if found.attrs.get("format") != FORMAT:
        raise InputError("not a workspace map", where=str(path), accepted=ACCEPTED)
    check_grid(found, Path(path), ACCEPTED)
    return found


def _skeleton(task: MapTask) -> Dataset:
    """The coordinates and the attributes of a map."""
    import xarray

    question = task.question
    names = ("x", "y", "z")
    frame = "base frame" if task.of_base else "part frame"
    coordinates: dict[str, Any] = {
        f"{name}_mm": (
            (name,) if task.ids is None else ("point",),
            axis,
            {"units": "mm", "long_name": f"{name.upper()} of the target, {frame}"},
        )
        for name, axis in zip(names, task.axes, strict=True)
    }
    for n, name in enumerate(names):
        attributes = {"units": "1", "long_name": f"{name.upper()} of the direction into the material, {frame}"}
        coordinates[f"direction_{name}"] = (("direction",), task.directions[:, n], attributes)
    reference = question.psi_reference
    head: dict[str, Any] = {
        "format": FORMAT,
        "version": version("zerorev"),
        "quantity": question.quantity,
        "legs": question.settings.legs,
        "robot": robot_data(question.robot),
        "tool": tool_data(question.tool),
        "psi_reference": reference if isinstance(reference, str) else list(reference),
        "settings": data_of(question.settings, SETTINGS) | {"cycle": data_of(question.settings.cycle)},
    }
    if quantity(question.quantity).needs_depth:
        assert question.depth is not None
        head["depth_mm"] = plain(float(mm(question.depth)))
    if quantity(question.quantity).seeded:
        head["seed"] = question.seed
    if not task.of_base:
        head["part_frame"] = frame_text(task.T_base_part)
    if task.ids is not None:
        head["ids"] = list(task.ids)
    return xarray.Dataset(coords=coordinates, attrs=head)


def _check_same(found: Dataset, wanted: Dataset, path: str) -> None:
    """Refuse a map of other settings, and name the first that differs."""
    accepted = "the map of the same command, to continue with; or another folder"
    # a map of before a setting existed was made with its default
    usual = {f"settings.{each.path[0]}": default_of(each) for each in stated(Settings) if each.name in SETTINGS}
    usual |= {f"settings.cycle.{each.path[0]}": default_of(each) for each in stated(Cycle)}
    there, here = usual | _flat(found.attrs), _flat(wanted.attrs)
    for key in sorted({*there, *here}):
        if there.get(key) != here.get(key):
            what = f"is another map: its {key} is {_shown(there.get(key))}, not {_shown(here.get(key))}"
            raise InputError(what, where=path, accepted=accepted)
    for name in sorted(map(str, wanted.coords)):
        if name not in found.coords or not np.array_equal(found[name].values, wanted[name].values):
            raise InputError(f"is another map: its {name} differ", where=path, accepted=accepted)


def _flat(data: Any, name: str = "") -> dict[str, Any]:
    if not isinstance(data, dict):
        return {name: data}
    return {key: value for inner in data for key, value in _flat(data[inner], f"{name}.{inner}".lstrip(".")).items()}


def _shown(value: Any) -> str:
    text = str(value)
    return text if len(text) <= 60 else f"{text[:57]}..."


def _whole(file: Path) -> bool:
    """Whether a file of a chunk is there and ends in the checksum of the rest."""
    from google_crc32c import value as crc32c

    try:
        data = file.read_bytes()
    except OSError:
        return False
    body, checksum = data[:-CHECKSUM_BYTES], data[-CHECKSUM_BYTES:]
    return len(body) > 0 and crc32c(body) == int.from_bytes(checksum, "little")


def _locked(path: Path) -> int:
    """A hold on the folder that ends with this process, however it ends."""
    place = os.open(path, os.O_RDONLY)
    try:
        import fcntl

        fcntl.flock(place, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except ImportError:
        pass  # a system without such locks
    except OSError:
        os.close(place)
        raise OutputError(str(path), "another run is writing it") from None
    return place


def _size(count: float) -> str:
    return f"{count / 2**30:.1f} GiB" if count >= 2**30 else f"{count / 2**20:.1f} MiB"
