"""Work of a moment beside the event loop, for which the end of the app does not wait."""

from __future__ import annotations

import asyncio
import threading
from collections.abc import Callable
from contextlib import suppress
from typing import Any, TypeVar

__all__ = ["aside"]

T = TypeVar("T")


async def aside(call: Callable[[], T]) -> T:
    """What a call returns, made in a thread of its own.

    `asyncio.to_thread` would do, but that its threads are joined at the end of the process: where a call has kernels to
    compile, Ctrl-C would take half a minute.

    Args:
        call: what is done; not stopped where nobody waits for it any more.
    """
    loop = asyncio.get_running_loop()
    future: asyncio.Future[T] = loop.create_future()

    def tell(put: Callable[[Any], None], what: Any) -> None:
        if not future.done():  # cancelled
            put(what)

    def run() -> None:
        try:
            outcome: tuple[Callable[[Any], None], Any] = future.set_result, call()
        except Exception as error:
            outcome = future.set_exception, error
        with suppress(RuntimeError):  # the loop is closed: the app has ended
            loop.call_soon_threadsafe(tell, *outcome)

    threading.Thread(target=run, name="zerorev-aside", daemon=True).start()
    return await future
