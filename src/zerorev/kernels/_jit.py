"""Every compiler option, in one place, and the one notice that compiling takes a while."""

from __future__ import annotations

import logging

import numba
from numba.core import event

__all__ = ["kernel"]

# No fastmath: it would make isnan(nan) false, and NaN is how a kernel says "no such pose".
# Contracting a * b + c into one operation is another matter: it is faster, more precise, and keeps NaN.
kernel = numba.njit(cache=True, nogil=True, error_model="numpy", fastmath={"contract"})


class _SayOnce(event.Listener):
    """Logs the first compilation of a process; loading from the cache is no compilation."""

    said = False

    def on_start(self, event: event.Event) -> None:
        if not self.said:
            self.said = True
            logging.getLogger("zerorev").warning("compiling kernels: takes about a minute, once; then they are cached")

    def on_end(self, event: event.Event) -> None:
        pass


event.register("numba:compile", _SayOnce())  # type: ignore[no-untyped-call]
