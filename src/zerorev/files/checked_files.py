"""Which plan files hold the outcome of a check that was made here: by this version, for this user, on these bytes.

`export` takes nothing on trust that a file says of itself: a file can be altered by hand, and with it any sum that it
holds. So what was checked is kept apart from the files, in the user's cache, under the digest of the file's text. Who
can write there can alter the compiled kernels, too, which lie in the same place and are run. A folder that belongs to
somebody else, or that others may write to, is not used; where there is none, everything is checked again.
"""

from __future__ import annotations

import hashlib
import os
import sys
from contextlib import suppress
from functools import cache
from importlib.metadata import version
from pathlib import Path

__all__ = ["is_checked", "remember"]

MOST = 1000  # files that are remembered; the oldest are forgotten


def is_checked(text: str) -> bool:
    """Whether what a plan file of this text says of its checks is what they found here.

    Args:
        text: of the file.
    """
    folder = _folder()
    with suppress(OSError):
        return folder is not None and _is_own(folder) and (folder / _name(text)).is_file()
    return False


def remember(text: str) -> None:
    """Keep that what a plan file says of its checks is what they have just found; where that cannot be kept, nothing.

    Args:
        text: of the file.
    """
    folder = _folder()
    with suppress(OSError):
        if folder is None:
            return
        folder.mkdir(mode=0o700, parents=True, exist_ok=True)
        if not _is_own(folder):
            return
        (folder / _name(text)).touch()
        kept = sorted(folder.iterdir(), key=lambda path: path.stat().st_mtime)
        for path in kept[:-MOST]:
            path.unlink(missing_ok=True)


def _folder() -> Path | None:
    """Where a user's programs keep what they can find again."""
    with suppress(RuntimeError):  # no home
        if sys.platform == "win32":
            return Path(os.environ.get("LOCALAPPDATA") or Path.home() / "AppData" / "Local") / "zerorev" / "checked"
        if sys.platform == "darwin":
            return Path.home() / "Library" / "Caches" / "zerorev" / "checked"
        return Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "zerorev" / "checked"
    return None


def _is_own(folder: Path) -> bool:
    if sys.platform == "win32":
        return folder.is_dir()
    there = folder.stat()
    return there.st_uid == os.geteuid() and not there.st_mode & 0o022


def _name(text: str) -> str:
    return hashlib.sha256(_checker() + text.encode("utf-8", "surrogatepass")).hexdigest()


@cache
def _checker() -> bytes:
    """A digest of the check itself: what another one has found is not taken over."""
    found = hashlib.sha256(version("zerorev").encode())
    package = Path(__file__).parents[1]
    for files in ("model/*.py", "verify/*.py", "kernels/_jit.py", "kernels/_compiling.py", "kernels/_code.py"):
        for path in sorted(package.glob(files)):
            found.update(path.read_bytes())
    return found.digest()
