"""Every compiler option, in one place, the cache of what is compiled, and the one notice that it takes a while."""

from __future__ import annotations

import logging
import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import cache
from pathlib import Path
from typing import Any

import numba
from numba.core import event
from numba.core.caching import FunctionCache, IndexDataCacheFile
from numba.core.codegen import CPUCodeLibrary
from numba.core.compiler_lock import global_compiler_lock
from numba.core.dispatcher import Dispatcher
from numba.core.runtime.nrt import rtsys

__all__ = ["kernel", "lean"]

# No fastmath: it would make isnan(nan) false, and NaN is how a kernel says "no such pose".
# Contracting a * b + c into one operation is another matter: it is faster, more precise, and keeps NaN.
_njit: Any = numba.njit  # whose stubs do not know of `_nrt`: whether holders of arrays are counted
_options = {"nogil": True, "error_model": "numpy", "fastmath": {"contract"}}
_compiled, _uncounted = _njit(**_options, _nrt=True), _njit(**_options, _nrt=False)


class _Cache(FunctionCache):
    """The cache of `numba.njit(cache=True)`, but a kernel that is in it is loaded without the compiler.

    Numba would import all that a compiler needs first, SciPy's linear algebra included: 0.4 s, where the kernels of a
    plan load in 0.2 s. It still does so before it compiles anything. Loading itself imports only the modules of Numba
    that a kernel's functions are from; so as to keep SciPy out, kernels that a plan needs call nothing of
    `numba.np.arraymath` (`np.round`, `np.min`, ...; `np.rint` and `np.minimum` are not among them).

    Numba takes a cached kernel for fresh as long as its own file is. But a kernel holds what it calls from other files,
    so here a change to any file of kernels makes all of them stale.
    """

    def __init__(self, function: Callable[..., Any]) -> None:
        super().__init__(function)  # type: ignore[no-untyped-call]
        stamp = self._impl.locator.get_source_stamp(), _stamp()
        self._cache_file = IndexDataCacheFile(self._cache_path, self._impl.filename_base, stamp)  # type: ignore[no-untyped-call]

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        rtsys.initialize(target_context)  # what allocates arrays
        found = self._loaded(sig, target_context)
        if found is None and _turn.taken(self._cache_path):
            found = self._loaded(sig, target_context)
        return found

    def _loaded(self, sig: Any, target_context: Any) -> Any:
        try:
            with self._guard_against_spurious_io_errors():
                return self._load_overload(sig, target_context)  # type: ignore[no-untyped-call]
        except (AttributeError, ImportError):
            # of another version of zerorev, in which a class that a kernel is given was called otherwise
            self.flush()  # type: ignore[no-untyped-call]
            return None


@contextmanager
def _own_copies() -> Iterator[None]:
    """Whatever is compiled meanwhile calls its own copies of the kernels that it calls, and no others.

    Numba compiles what a kernel calls into the kernel once more, under the same name, and optimises each copy in its
    place, so that they round differently. All copies of a name in a process give way to the first: in the process that
    compiles that is the one by itself, in those that load it is that of the kernel which is loaded first. With a name
    of its own each is used where it was made, and no result depends on what was compiled or loaded before.
    """
    finalize = CPUCodeLibrary._finalize_final_module

    def finalize_with_own_copies(library: Any) -> None:
        if library._shared_module is None:  # not loaded, but compiled
            library._shared_module = library._final_module.clone()  # for others to link, as Numba makes it
            for function in library._shared_module.functions:
                if not function.is_declaration and function.linkage.name == "external":
                    function.linkage = "linkonce_odr"
            for function in library._final_module.functions:
                if not function.is_declaration and function.linkage.name == "linkonce_odr":
                    function.linkage = "internal"
        finalize(library)  # type: ignore[no-untyped-call]

    CPUCodeLibrary._finalize_final_module = finalize_with_own_copies  # type: ignore[method-assign]
    try:
        yield
    finally:
        CPUCodeLibrary._finalize_final_module = finalize  # type: ignore[method-assign]


class _Turn:
    """The turn to compile: one process at a time, so that what several processes need at once is compiled once.

    The same kernel compiled twice need not round alike: how what it calls is inlined depends on whether that was
    compiled in the same process or loaded.
    """

    def __init__(self) -> None:
        self._depth = 0
        self._file: int | None = None

    @contextmanager
    def needed(self) -> Iterator[None]:
        """Around the compilation of a kernel and of all that it calls; a turn that was taken ends with it."""
        with global_compiler_lock, _own_copies():  # one thread at a time
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


_turn = _Turn()


@cache
def _stamp() -> tuple[tuple[str, float, int], ...]:
    """Name, time of change and size of all files of kernels."""
    files = sorted(Path(__file__).parent.glob("*.py"))
    return tuple((file.name, file.stat().st_mtime, file.stat().st_size) for file in files)


def kernel(function: Callable[..., Any]) -> Any:
    """Compile a function at its first call with arguments of new types, or load it if it was compiled before."""
    return _made(_compiled(function), function)


def lean(function: Callable[..., Any]) -> Any:
    """The same of a function that makes no array: it takes numbers out of arrays, and puts numbers into them.

    Numba counts who holds an array, at the beginning and the end of each call for each that is given. Where many short
    kernels call each other that is a tenth of all time. Here the caller holds what it gives; a function that makes an
    array, or gives one back, is not compiled.
    """
    return _made(_uncounted(function), function)


def _made(compiled: Any, function: Callable[..., Any]) -> Any:
    """A compiled function with the cache and the turn of this file."""
    if isinstance(compiled, Dispatcher):  # not so with NUMBA_DISABLE_JIT
        compiled._cache = _Cache(function)  # type: ignore[attr-defined]
        compile_or_load = compiled.compile

        def compile_in_turn(sig: Any) -> Any:
            with _turn.needed():
                return compile_or_load(sig)

        compiled.compile = compile_in_turn  # type: ignore[method-assign]
    return compiled


class _SayOnce(event.Listener):
    """Logs the first compilation of a process; loading from the cache is no compilation."""

    said = False

    def on_start(self, event: event.Event) -> None:
        if not self.said:
            self.said = True
            logging.getLogger("zerorev").warning("compiling kernels: takes a minute or two, once; then they are cached")

    def on_end(self, event: event.Event) -> None:
        pass


event.register("numba:compile", _SayOnce())  # type: ignore[no-untyped-call]
