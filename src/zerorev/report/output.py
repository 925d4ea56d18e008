"""Where results go: looked at before long work begins, and written whole or not at all."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from zerorev.errors import OutputError

__all__ = ["check_file", "check_folder", "make_folder", "write_bytes"]


def check_file(path: Path) -> None:
    """Make sure, before long work, that a file can be written there.

    Raises:
        OutputError: no such folder, a folder of that name, no permission.
    """
    with _as_output_error(path):
        target = Path(os.path.realpath(path))
        if not target.parent.is_dir():
            raise OutputError(str(path), f"the folder {target.parent} does not exist")
        if target.exists() and not target.is_file():
            raise OutputError(str(path), "it is a folder" if target.is_dir() else "it is not a regular file")
        _check_access(path, target if target.exists() else target.parent)
        _check_access(path, target.parent)


def check_folder(path: Path) -> None:
    """Make sure, before long work, that files can be written into a folder, or that it can be made.

    Raises:
        OutputError: no such parent folder, a file of that name, no permission.
    """
    with _as_output_error(path):
        target = Path(os.path.realpath(path))
        if target.exists() and not target.is_dir():
            raise OutputError(str(path), "it is a file, not a folder")
        if not target.exists() and not target.parent.is_dir():
            raise OutputError(str(path), f"the folder {target.parent} does not exist")
        _check_access(path, target if target.exists() else target.parent)


def make_folder(path: Path) -> None:
    """Make a folder whose parent exists; a folder that is there stays as it is.

    Raises:
        OutputError: as `check_folder`.
    """
    check_folder(path)
    with _as_output_error(path):
        path.mkdir(exist_ok=True)


def write_bytes(path: Path, data: bytes) -> None:
    """Write a file whole or not at all: written beside, then renamed.

    Raises:
        OutputError: as `check_file`, or a full disk.
    """
    check_file(path)
    target = Path(os.path.realpath(path))
    beside = target.with_name(f".{target.name}.{os.getpid()}.tmp")
    try:
        with _as_output_error(path):
            with beside.open("xb") as stream:
                stream.write(data)
            os.replace(beside, target)
    finally:
        with suppress(OSError, ValueError):
            beside.unlink(missing_ok=True)


def _check_access(path: Path, place: Path) -> None:
    if not os.access(place, os.W_OK | (os.X_OK if place.is_dir() else 0)):
        raise OutputError(str(path), f"no write permission for {place}")


@contextmanager
def _as_output_error(path: Path) -> Iterator[None]:
    """What the system says about a path, as an `OutputError`."""
    try:
        yield
    except (OSError, ValueError) as error:  # ValueError: a null byte in the path
        raise OutputError(str(path), (isinstance(error, OSError) and error.strerror) or str(error)) from None
