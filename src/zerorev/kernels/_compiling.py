"""Compiling with the cache of this package, and the one notice that it takes a while.

This and the cache build on private parts of Numba. Where one of them is missing, importing this module fails, and
`zerorev.kernels._jit` leaves the compiling and the caching to Numba alone.
"""

from __future__ import annotations

import logging
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

import numba
from numba.core import event
from numba.core.codegen import CPUCodeLibrary
from numba.core.dispatcher import Dispatcher
from numba.core.options import DefaultOptions

from zerorev.kernels._cache import Turn, cache_of, is_kept

__all__ = ["EACH_TIME", "ONCE", "compiled_here", "turn"]

ONCE = "compiling kernels: takes a minute or two, once; then they are cached"
EACH_TIME = (
    "compiling kernels: takes a minute or two, in each run, because there is no folder to keep them in "
    "(the environment variable NUMBA_CACHE_DIR names one)"
)

# what is used of Numba that it need not have; `_cache` names the rest
_NEEDED = DefaultOptions._nrt, CPUCodeLibrary._finalize_final_module, Dispatcher.compile

_njit: Any = numba.njit  # whose stubs do not know of `_nrt`


@contextmanager
def _own_copies() -> Iterator[None]:
    """Everything compiled meanwhile calls its own copies of the kernels that it calls, and no others.

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


turn = Turn()


def compiled_here(function: Callable[..., Any], counted: bool, options: dict[str, Any]) -> Any:
    """A compiled function with the cache and the turn of this package.

    Args:
        function: to be compiled.
        counted: whether holders of arrays are counted.
        options: of the compiler.
    """
    compiled = _njit(**options, _nrt=counted)(function)
    if isinstance(compiled, Dispatcher):  # not so with NUMBA_DISABLE_JIT
        compiled._cache = cache_of(function, turn)  # type: ignore[attr-defined]
        compile_or_load = compiled.compile

        def compile_in_turn(sig: Any) -> Any:
            with turn.needed(), _own_copies():
                return compile_or_load(sig)

        compiled.compile = compile_in_turn  # type: ignore[method-assign]
    return compiled


class _SayOnce(event.Listener):
    """Logs the first compilation of a process; loading from the cache does not count."""

    said = False

    def on_start(self, event: event.Event) -> None:
        if not self.said:
            self.said = True
            logging.getLogger("zerorev").warning(ONCE if is_kept() else EACH_TIME)

    def on_end(self, event: event.Event) -> None:
        pass


event.register("numba:compile", _SayOnce())  # type: ignore[no-untyped-call]
