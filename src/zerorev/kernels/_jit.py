"""Every compiler option, in one place."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numba

_own: Callable[[Callable[..., Any], bool, dict[str, Any]], Any] | None
try:
    from zerorev.kernels._compiling import compiled_here as _own
except (ImportError, AttributeError):  # a Numba without the private parts that the cache here builds on: its own, then
    _own = None

__all__ = ["kernel", "lean"]

# No fastmath: it would make isnan(nan) false, and NaN is how a kernel says "no such pose".
# Contracting a * b + c into one operation is another matter: it is faster, more precise, and keeps NaN.
_options: dict[str, Any] = {"nogil": True, "error_model": "numpy", "fastmath": {"contract"}}


def kernel(function: Callable[..., Any]) -> Any:
    """Compile a function at its first call with arguments of new types, or load it if it was compiled before."""
    return _plain(function) if _own is None else _own(function, True, _options)


def lean(function: Callable[..., Any]) -> Any:
    """The same of a function that makes no array: it takes numbers out of arrays, and puts numbers into them.

    Numba counts who holds an array, at the beginning and the end of each call for each that is given. Where many short
    kernels call each other that is a tenth of all time. Here the caller holds what it gives; a function that makes an
    array, or gives one back, is not compiled.
    """
    return _plain(function) if _own is None else _own(function, False, _options)


def _plain(function: Callable[..., Any]) -> Any:
    """As Numba compiles and caches it: slower to load, and stale kernels are noticed in their own file alone."""
    try:
        return numba.njit(cache=True, **_options)(function)
    except RuntimeError:  # there is no folder to keep it in
        return numba.njit(**_options)(function)
