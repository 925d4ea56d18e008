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

from zerorev.kernels._code import read_body, read_called, written_body, written_called

__all__ = ["Cache", "Turn", "cache_of", "is_kept", "stamp"]

SUM = 4  # [bytes] of the sum in front of what a file holds

# what is overridden of Numba; where one is missing, the override would not be called, so importing fails instead
_NEEDED = (
    caching.FunctionCache.load_overload,
    caching.FunctionCache.save_overload,
    caching.FunctionCache._index_key,
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
        """The body of a kernel, or None: it is this process's turn to compile it."""
        return self._found("body", read_body, sig, target_context)

    def load_called(self, sig: Any, target_context: Any) -> Any:
        """The machine code of a kernel, or None: it is this process's turn to make it."""
        return self._found("machine code", read_called, sig, target_context)

    def save_overload(self, sig: Any, data: Any) -> None:
        """Keep the body of a kernel, if that can be."""
        self._keep("body", written_body, sig, data)

    def save_called(self, sig: Any, data: Any) -> None:
        """Keep the machine code of a kernel, if that can be."""
        self._keep("machine code", written_called, sig, data)

    def _found(self, kind: str, read: Callable[[Any, Any], Any], sig: Any, target_context: Any) -> Any:
        rtsys.initialize(target_context)  # what allocates arrays
        key = self._key(kind, sig, target_context.codegen())
        found = self._loaded(key, read, target_context)
        if found is None and self._turn.taken(self._cache_path, f"{kind} of {self._impl.filename_base}"):
            found = self._loaded(key, read, target_context)
        return found

    def _loaded(self, key: Any, read: Callable[[Any, Any], Any], target_context: Any) -> Any:
        try:
            kept = self._cache_file.load(key)  # type: ignore[no-untyped-call]
            return None if kept is None else read(target_context, kept)
        except Exception:
            # sound, but of another version: for one, a class that a kernel is given was called otherwise
            with suppress(OSError):
                self.flush()  # type: ignore[no-untyped-call]
            return None

    def _keep(self, kind: str, written: Callable[[Any], Any], sig: Any, data: Any) -> None:
        if not self._impl.check_cachable(data):
            return
        try:
            self._impl.locator.ensure_cache_path()
            key = self._key(kind, sig, data.codegen)
            self._cache_file.save(key, written(data))  # type: ignore[no-untyped-call]
        except OSError:  # a full disk, or the folder is not ours any more
            _not_kept()

    def _key(self, kind: str, sig: Any, codegen: Any) -> tuple[Any, ...]:
        return kind, *self._index_key(sig, codegen)  # type: ignore[no-untyped-call]


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


class _None(caching.NullCache):
    """A cache that keeps nothing."""

    def load_called(self, sig: Any, target_context: Any) -> None:
        """Nothing."""

    def save_called(self, sig: Any, data: Any) -> None:
        """Not."""


def cache_of(function: Callable[..., Any], turn: Turn) -> Cache | _None:
    """The cache of a kernel, or one that keeps nothing where there is no place for it."""
    try:
        return Cache(function, turn)
    except (RuntimeError, OSError):
        _not_kept()
        return _None()


class Turn:
    """The turn to compile a kernel: one process at a time, so that what several need at once is compiled once.

    A process that compiles one kernel waits for those that it calls, and no kernel calls itself over others: so no two
    processes wait for each other.
    """

    def __init__(self) -> None:
        """Begin without any."""
        self._held: list[list[tuple[int, int]]] = []  # file and place in it, kernel in kernel
        self._files: dict[str, int] = {}  # one a folder: closing any other would give up all turns of the process

    @contextmanager
    def needed(self) -> Iterator[bool]:
        """Around the compilation of a kernel and of all that it calls; the turns that it took end with it.

        Gives whether another kernel needs it.
        """
        with global_compiler_lock:  # one thread at a time
            self._held.append([])
            try:
                yield len(self._held) > 1
            finally:
                for file, place in self._held.pop():
                    _lock(file, place, free=True)
                if not self._held:
                    while self._files:
                        os.close(self._files.popitem()[1])

    def taken(self, folder: str, what: str) -> bool:
        """Wait for the turn; whether others may have compiled meanwhile."""
        place = int.from_bytes(hashlib.sha256(what.encode()).digest()[:7])
        try:
            if folder not in self._files:
                os.makedirs(folder, exist_ok=True)
                self._files[folder] = os.open(Path(folder, "kernels.lock"), os.O_RDWR | os.O_CREAT, 0o666)
            file = self._files[folder]
            _lock(file, place)
        except (ImportError, OSError):
            return False  # no such locks here, or no cache to share
        self._held[-1].append((file, place))
        return True


def _lock(file: int, place: int, *, free: bool = False) -> None:
    import fcntl

    fcntl.lockf(file, fcntl.LOCK_UN if free else fcntl.LOCK_EX, 1, place)


@cache
def stamp() -> str:
    """A digest of all files that kernels are made of and by."""
    found = hashlib.sha256()
    for file in sorted({*Path(__file__).parent.glob("*.py")} - {Path(__file__).with_name("_ahead.py")}):
        found.update(file.name.encode() + b"\0" + file.read_bytes())
    return found.hexdigest()
