"""Drawing no more often than the eye follows."""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from weakref import WeakKeyDictionary

from nicegui import Client, ui

__all__ = ["throttled"]

BETWEEN = 0.04  # [s] between what two views of a page draw, so that a drag is answered in between

_next: WeakKeyDictionary[Client, float] = WeakKeyDictionary()  # when a page has time for the next view


def throttled(draw: Callable[[], None], pause: float = 0.1) -> Callable[[], None]:
    """A function that has something of this page drawn soon; calls that come while it is awaited become one.

    Args:
        draw: is called in the event loop, after the handler that asked for it is through, while the page is there.
        pause: between two calls of it [s]; with 0 it does not wait for other views either.
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
            turn = max(loop.time(), last + pause)
            if pause:
                turn = max(turn, _next.get(page, 0.0))
                _next[page] = turn + BETWEEN
            loop.call_at(turn, now)

    return ask
