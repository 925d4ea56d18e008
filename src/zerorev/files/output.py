"""Where results go: examined before long work begins, and written whole or not at all."""

from __future__ import annotations

import os
import platform
import re
import shutil
import stat
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from zerorev.errors import OutputError

__all__ = [
    "as_output_error", "check_file", "check_folder", "check_whole_folder", "make_folder", "place_of",
    "write_bytes", "write_pieces", "write_text", "write_whole_folder",
]  # fmt: skip


MOST_LINKS = 40


def place_of(path: str | Path) -> Path:
    """Where a path leads to, through links to what they stand for: what is checked there is what is written there.

    Raises:
        OutputError: a folder on the way does not exist, so that `nodir/../plan.json` is no other name of plan.json.
    """
    with as_output_error(path):
        target = Path(path)
        for _ in range(MOST_LINKS):
            try:
                folder = Path(os.path.realpath(target.parent, strict=True))
            except FileNotFoundError:
                raise OutputError(str(path), f"the folder {target.parent} does not exist") from None
            if not folder.is_dir():
                raise OutputError(str(path), f"{target.parent} is not a folder")
            target = folder / target.name
            if not stat.S_ISLNK(_mode(target)):
                return target
            target = target.parent / target.readlink()
        raise OutputError(str(path), "its links form a loop")


def _mode(path: Path) -> int:
    """What is there, without following it; 0: nothing."""
    try:
        return os.lstat(path).st_mode
    except FileNotFoundError:
        return 0


def check_file(path: str | Path, *sources: str | Path) -> None:
    """Make sure, before long work, that a file can be written there, and that it is none of those that are read.

    Raises:
        OutputError: no such folder, a folder of that name, no permission, one of the sources.
    """
    with as_output_error(path):
        target = place_of(path)
        for source in sources:
            if target.exists() and Path(source).exists() and target.samefile(source):
                raise OutputError(str(path), f"it is {source}, which is read")
        if target.exists() and not target.is_file():
            raise OutputError(str(path), "it is a folder" if target.is_dir() else "it is not a regular file")
        _check_access(path, target if target.exists() else target.parent)
        _check_access(path, target.parent)


def check_folder(path: str | Path) -> None:
    """Make sure, before long work, that files can be written into a folder, or that it can be made.

    Raises:
        OutputError: no such parent folder, a file of that name, no permission.
    """
    with as_output_error(path):
        target = place_of(path)
        if target.exists() and not target.is_dir():
            raise OutputError(str(path), "it is a file, not a folder")
        _check_access(path, target if target.exists() else target.parent)


def make_folder(path: str | Path) -> None:
    """Make a folder whose parent exists; a folder that is there stays as it is.

    Raises:
        OutputError: as `check_folder`.
    """
    check_folder(path)
    with as_output_error(path):
        place_of(path).mkdir(exist_ok=True)


def check_whole_folder(path: str | Path, mark: str) -> None:
    """Make sure, before long work, that `write_whole_folder` can do its own.

    Raises:
        OutputError: as `check_folder`, or there is a folder of that name that holds something else.
    """
    check_folder(path)
    with as_output_error(path):
        target = place_of(path)
        if target.exists() and any(target.iterdir()) and not (target / mark).is_file():
            raise OutputError(str(path), f"it is a folder without {mark}, which holds something else")
        _check_access(path, target.parent)


def write_whole_folder(path: str | Path, mark: str, fill: Callable[[Path], None]) -> None:
    """Write a folder whole or not at all: filled beside, then renamed; an older one is replaced once it is whole.

    Args:
        path: the folder.
        mark: a file of such a folder, by which an older one is known.
        fill: writes the files into a new, empty folder.

    Raises:
        OutputError: as `check_whole_folder`, or a full disk.
    """
    check_whole_folder(path, mark)
    with as_output_error(path):
        target = place_of(path)
        beside, before = _beside(target, "tmp"), _beside(target, "old")
        beside.mkdir()
        try:
            fill(beside)
            if target.exists():
                os.rename(target, before)
            try:
                os.rename(beside, target)
            except BaseException:
                if before.exists():
                    os.rename(before, target)
                raise
        finally:
            shutil.rmtree(beside, ignore_errors=True)
            if target.exists():
                shutil.rmtree(before, ignore_errors=True)
                _clear_abandoned(target)


def write_text(path: str | Path, text: str) -> None:
    """Write a text file, UTF-8 with plain line feeds, whole or not at all.

    Raises:
        OutputError: as `write_bytes`, or text that no file can hold.
    """
    with as_output_error(path):
        data = text.encode()
    write_bytes(path, data)


def write_bytes(path: str | Path, data: bytes) -> None:
    """Write a file whole or not at all: written beside, then renamed.

    Raises:
        OutputError: as `check_file`, or a full disk.
    """
    _write(path, (data,))


def write_pieces(path: str | Path, pieces: Iterable[str]) -> None:
    """Write a text file as `write_text` does, from pieces that need not all be in memory at once.

    Raises:
        OutputError: as `write_text`.
    """
    _write(path, (piece.encode() for piece in pieces))


def _write(path: str | Path, pieces: Iterable[bytes]) -> None:
    check_file(path)
    with as_output_error(path):
        target = place_of(path)
        beside = _beside(target, "tmp")
        try:
            with beside.open("xb") as stream:
                stream.writelines(pieces)
                stream.flush()
                os.fsync(stream.fileno())
            os.replace(beside, target)
            _clear_abandoned(target)
        except BaseException:
            beside.unlink(missing_ok=True)
            raise


def _beside(target: Path, end: str) -> Path:
    """Where a file or folder is before it gets its name: no other process, on no other machine, writes there."""
    return target.with_name(f".{target.name}.{platform.node()}-{os.getpid()}.{end}")


def _clear_abandoned(target: Path) -> None:
    """Remove what processes of this machine that were killed have left beside a file or folder."""
    left = re.compile(re.escape(f".{target.name}.{platform.node()}-") + r"(\d+)\.(tmp|old)")
    with suppress(OSError):  # a folder that cannot be listed
        for path in target.parent.iterdir():
            found = left.fullmatch(path.name)
            if found and not _runs(int(found[1])):
                shutil.rmtree(path, ignore_errors=True) if path.is_dir() else path.unlink(missing_ok=True)


def _runs(process: int) -> bool:
    if os.name != "posix":  # elsewhere asking ends it
        return True
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return False
    except (OSError, OverflowError):
        return True
    return True


def _check_access(path: str | Path, place: Path) -> None:
    if not os.access(place, os.W_OK | (os.X_OK if place.is_dir() else 0)):
        raise OutputError(str(path), f"no write permission for {place}")


@contextmanager
def as_output_error(path: str | Path) -> Iterator[None]:
    """What the system says about a path, as an `OutputError`."""
    try:
        yield
    except (OSError, ValueError) as error:  # ValueError: a null byte in the path, a lone surrogate
        raise OutputError(str(path), (isinstance(error, OSError) and error.strerror) or str(error)) from None
