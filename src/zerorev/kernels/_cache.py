"""The cache of compiled kernels: where it lies, what of it is taken, and whose turn it is to fill it.

It is Numba's, with four differences. What is found in it is loaded without the compiler; a change to any file of
kernels makes all of them stale; an entry that is damaged, or cannot be read, is made again; and where there is no place
for it, kernels are compiled without.
"""

from __future__ import annotations

import hashlib
import os
import pickle
import zlib
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from functools import cache
from pathlib import Path
from typing import Any

from numba.core import caching
from numba.core.compiler_lock import global_compiler_lock
from numba.core.runtime.nrt import rtsys

__all__ = ["Cache", "Turn", "cache_of", "is_kept", "stamp"]

SUM = 4  # [bytes] of the sum in front of what a file holds

# what is overridden of Numba; where one is missing, the override would not be called, so importing fails instead
_NEEDED = (
    caching.FunctionCache.load_overload,
    caching.FunctionCache.save_overload,
    caching.FunctionCache._load_overload,
    caching.IndexDataCacheFile._load_index,
    caching.IndexDataCacheFile._save_index,
    caching.IndexDataCacheFile._load_data,
    caching.IndexDataCacheFile._save_data,
    caching.IndexDataCacheFile._data_path,
    caching.IndexDataCacheFile._dump,
    caching.IndexDataCacheFile._open_for_write,
    caching.UserWideCacheLocator.from_function,
)


class Cache(caching.FunctionCache):
    """The cache of `numba.njit(cache=True)`, but a kernel that is in it is loaded without the compiler.

    Numba would import all that a compiler needs first, SciPy's linear algebra included: 0.4 s, where the kernels of a
    plan load in 0.2 s. It still does so before it compiles anything. Loading itself imports only the modules of Numba
    that a kernel's functions are from; so as to keep SciPy out, kernels that a plan needs call nothing of
    `numba.np.arraymath` (`np.round`, `np.min`, ...; `np.rint` and `np.minimum` are not among them).

    Numba takes a cached kernel for fresh as long as its own file is. But a kernel holds what it calls from other files,
    so here a change to any file of kernels makes all of them stale.
    """

    def __init__(self, function: Callable[..., Any], turn: Turn) -> None:
        """Look for the place of a kernel's cache.

        Raises:
            RuntimeError: there is none: no folder that can be written to.
        """
        super().__init__(function)  # type: ignore[no-untyped-call]
        fresh = self._impl.locator.get_source_stamp(), stamp()
        self._cache_file = _Files(self._cache_path, self._impl.filename_base, fresh)  # type: ignore[no-untyped-call]
        self._turn = turn

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        """A compiled kernel, or None: it is this process's turn to compile it."""
        rtsys.initialize(target_context)  # what allocates arrays
        found = self._loaded(sig, target_context)
        if found is None and self._turn.taken(self._cache_path):
            found = self._loaded(sig, target_context)
        return found

    def save_overload(self, sig: Any, data: Any) -> None:
        """Keep a compiled kernel, if that can be."""
        try:
            super().save_overload(sig, data)  # type: ignore[no-untyped-call]
        except OSError:  # a full disk, or the folder is not ours any more
            _not_kept()

    def _loaded(self, sig: Any, target_context: Any) -> Any:
        try:
            return self._load_overload(sig, target_context)  # type: ignore[no-untyped-call]
        except Exception:
            # sound, but of another version: for one, a class that a kernel is given was called otherwise
            with suppress(OSError):
                self.flush()  # type: ignore[no-untyped-call]
            return None


class _Files(caching.IndexDataCacheFile):
    """Index and data of one kernel, each behind a sum of its bytes: unpickled, and run, is only what is whole."""

    def _load_index(self) -> dict[Any, str]:
        found = _read(self._index_path)
        if found is None:
            return {}
        version, data = pickle.loads(found)
        if version != self._version:
            return {}
        fresh, overloads = pickle.loads(data)
        return overloads if fresh == self._source_stamp else {}

    def _save_index(self, overloads: dict[Any, str]) -> None:
        data = pickle.dumps((self._version, self._dump((self._source_stamp, overloads))))  # type: ignore[no-untyped-call]
        self._write(self._index_path, data)

    def _load_data(self, name: str) -> Any:
        found = _read(self._data_path(name))  # type: ignore[no-untyped-call]
        return None if found is None else pickle.loads(found)

    def _save_data(self, name: str, data: Any) -> None:
        self._write(self._data_path(name), self._dump(data))  # type: ignore[no-untyped-call]

    def _write(self, path: str, data: bytes) -> None:
        with self._open_for_write(path) as stream:
            stream.write(zlib.crc32(data).to_bytes(SUM) + data)


def _read(path: str) -> bytes | None:
    """What a file of the cache holds, or None where it is missing, cut, altered, or not ours to read."""
    try:
        held = Path(path).read_bytes()
    except OSError:
        return None
    return held[SUM:] if len(held) > SUM and zlib.crc32(held[SUM:]).to_bytes(SUM) == held[:SUM] else None


class _UserWide(caching.UserWideCacheLocator):
    """The user's own folder for caches, where the user has one: without a home Numba would make a folder called `~`."""

    @classmethod
    def from_function(cls, py_func: Any, py_file: str) -> Any:
        if not os.path.isabs(cls(py_func, py_file).get_cache_path()):  # type: ignore[no-untyped-call]
            return None
        return super().from_function(py_func, py_file)  # type: ignore[no-untyped-call]


class _Place(caching.CompileResultCacheImpl):
    """Where a kernel's cache lies."""

    _locator_classes = [  # noqa: RUF012  Numba's own way
        _UserWide if each is caching.UserWideCacheLocator else each
        for each in caching.CompileResultCacheImpl._locator_classes
    ]


Cache._impl_class = _Place

_kept = True


def is_kept() -> bool:
    """Whether all that was compiled so far could be kept."""
    return _kept


def _not_kept() -> None:
    global _kept
    _kept = False


def cache_of(function: Callable[..., Any], turn: Turn) -> Cache | caching.NullCache:
    """The cache of a kernel, or one that keeps nothing where there is no place for it."""
    try:
        return Cache(function, turn)
    except (RuntimeError, OSError):
        _not_kept()
        return caching.NullCache()


class Turn:
    """The turn to compile: one process at a time, so that what several processes need at once is compiled once.

    The same kernel compiled twice need not round alike: how what it calls is inlined depends on whether that was
    compiled in the same process or loaded.
    """

    def __init__(self) -> None:
        """Begin without it."""
        self._depth = 0
        self._file: int | None = None

    @contextmanager
    def needed(self) -> Iterator[None]:
        """Around the compilation of a kernel and of all that it calls; a turn that was taken ends with it."""
        with global_compiler_lock:  # one thread at a time
            self._depth += 1
            try:
                yield
            finally:
                self._depth -= 1
                if not self._depth and self._file is not None:
                    os.close(self._file)
                    self._file = None

    def taken(self, folder: str) -> bool:
        """Wait for the turn; whether others may have compiled meanwhile."""
        if self._file is not None:
            return False
        try:
            import fcntl

            os.makedirs(folder, exist_ok=True)
            self._file = os.open(Path(folder, "kernels.lock"), os.O_RDWR | os.O_CREAT, 0o666)
            fcntl.flock(self._file, fcntl.LOCK_EX)
        except (ImportError, OSError):
            return False  # no such locks here, or no cache to share
        return True


@cache
def stamp() -> str:
    """A digest of all files of kernels."""
    found = hashlib.sha256()
    for file in sorted(Path(__file__).parent.glob("*.py")):
        found.update(file.name.encode() + b"\0" + file.read_bytes())
    return found.hexdigest()
