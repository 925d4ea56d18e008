"""Drawing no more often than the eye follows."""

from __future__ import annotations

import asyncio
from collections.abc import Callable

from nicegui import Client, ui

__all__ = ["throttled"]


def throttled(draw: Callable[[], None], pause: float = 0.1) -> Callable[[], None]:
    """A function that has something of this page drawn soon; calls that come while it is awaited become one.

    Args:
        draw: is called in the event loop, after the handler that asked for it is through, while the page is there.
        pause: between two calls of it [s].
    """
    page: Client = ui.context.client
    waiting, last = False, -pause

    def now() -> None:
        nonlocal waiting, last
        waiting, last = False, asyncio.get_running_loop().time()
        if not page.is_deleted:
            with page:
                draw()

    def ask() -> None:
        nonlocal waiting
        if not waiting:
            waiting = True
            loop = asyncio.get_running_loop()
            loop.call_at(max(loop.time(), last + pause), now)

    return ask
