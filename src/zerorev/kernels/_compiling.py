"""Compiling with the cache of this package, and the one notice that it takes a while.

This and the cache build on private parts of Numba. Where one of them is missing, importing this module fails, and
`zerorev.kernels._jit` leaves the compiling and the caching to Numba alone.
"""

from __future__ import annotations

import logging
from collections.abc import Callable
from typing import Any

from numba.core import config, event
from numba.core.dispatcher import Dispatcher, _FunctionCompiler  # type: ignore[attr-defined]
from numba.core.options import DefaultOptions
from numba.core.registry import CPUDispatcher
from numba.core.sigutils import normalize_signature
from numba.core.types import unliteral

from zerorev.kernels import _ahead
from zerorev.kernels._cache import Turn, cache_of, is_kept
from zerorev.kernels._code import body_of, called

__all__ = ["EACH_TIME", "ONCE", "called_so_far", "compiled_here", "turn"]

ONCE = "compiling kernels: takes a minute or two, once; then they are cached"
EACH_TIME = (
    "compiling kernels: takes a minute or two, in each run, because there is no folder to keep them in "
    "(the environment variable NUMBA_CACHE_DIR names one)"
)

# what is used of Numba that it need not have; `_cache` and `_code` name the rest
_NEEDED = (
    DefaultOptions._nrt,
    Dispatcher.add_overload,
    Dispatcher.compile,
    Dispatcher.get_call_template,
    _FunctionCompiler._customize_flags,
)

_parts: Any = normalize_signature  # whose stubs have no types
_any: Any = unliteral

turn = Turn()

called_so_far: list[tuple[str, tuple[Any, ...]]] = []
"""The kernels that Python has called in this process, with the types of what they were given, in that order."""


class Kernel(CPUDispatcher):
    """A compiled function with the cache and the turn of this package.

    What other kernels call is in `overloads`, as Numba has it: bodies (`zerorev.kernels._code`). A body is neither
    compiled nor loaded where the machine code that Python calls is in the cache.
    """

    _compiler: Any  # Numba's own, of which its stubs say nothing
    _cache_hits: Any
    _insert: Any

    def __init__(self, py_func: Callable[..., Any], targetoptions: dict[str, Any]) -> None:
        """As Numba's own."""
        super().__init__(py_func=py_func, targetoptions=targetoptions)
        self._cache = cache_of(py_func, turn)
        self._compiler._customize_flags = _body_alone
        self._called: dict[tuple[Any, ...], Any] = {}
        self._name = f"{py_func.__module__}.{py_func.__name__}"

    def get_call_template(self, args: Any, kws: Any) -> Any:
        """How a kernel calls this one: with 0 as with any integer, so as not to compile it once more for each."""
        return super().get_call_template(
            [_any(each) for each in args], {name: _any(each) for name, each in kws.items()}
        )

    def add_overload(self, cres: Any) -> None:
        """Keep a body that was just compiled, or loaded."""
        if cres.entry_point is None:  # compiled
            cres = body_of(cres)
            self.targetctx.insert_user_function(  # type: ignore[no-untyped-call]
                cres.entry_point, cres.fndesc, [cres.library]
            )
        self.overloads[tuple(cres.signature.args)] = cres

    def compile(self, sig: Any) -> Any:
        """Compile or load what is called with arguments of some types: a body for a kernel, machine code for Python."""
        with turn.needed() as by_kernel:
            if by_kernel:
                return super().compile(sig)
            args, _ = _parts(sig)
            made = self._called.get(args) or self._cache.load_called(sig, self.targetctx)
            if made is None:
                if is_kept():
                    _ahead.begin(self._name)
                super().compile(sig)
                made = called(self.overloads[args], self.targetoptions["_nrt"])
                self._cache.save_called(sig, made)
                _ahead.report(self._name, called=True)
            else:
                self._cache_hits[sig] += 1
            self._called[args] = made
            called_so_far.append((self._name, args))
            self._insert([each._code for each in args], made.entry_point, False)
            return made.entry_point


def _body_alone(flags: Any) -> Any:
    flags.no_compile = flags.no_cpython_wrapper = flags.no_cfunc_wrapper = True
    return flags


def compiled_here(function: Callable[..., Any], counted: bool, options: dict[str, Any]) -> Any:
    """A compiled function with the cache and the turn of this package.

    Args:
        function: to be compiled.
        counted: whether holders of arrays are counted.
        options: of the compiler.
    """
    if config.DISABLE_JIT:  # type: ignore[attr-defined]
        return function
    return Kernel(function, {**options, "nopython": True, "_nrt": counted})


class _SayOnce(event.Listener):
    """Logs the first compilation of a process, and how far it is; loading from the cache does not count."""

    said = False

    def on_start(self, event: event.Event) -> None:
        if not self.said:
            self.said = True
            logging.getLogger("zerorev").warning(ONCE if is_kept() else EACH_TIME)

    def on_end(self, event: event.Event) -> None:
        if isinstance(event.data["dispatcher"], Kernel):
            _ahead.report(event.data["dispatcher"]._name, called=False)


event.register("numba:compile", _SayOnce())  # type: ignore[no-untyped-call]
