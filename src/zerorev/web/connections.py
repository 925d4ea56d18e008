"""Connections to the app's port: whoever opens one must ask for something at once, and strangers can hold none."""

from __future__ import annotations

import asyncio
from collections import OrderedDict
from typing import Any, ClassVar

from uvicorn.protocols.http.httptools_impl import HttpToolsProtocol

__all__ = ["Connection"]

WHOLE_HEAD = 3.0  # [s] from a connection, or the answer before, to a request's head as a whole
NEXT_PIECE = 5.0  # [s] between two pieces of a request's body
LARGEST_HEAD = 64 * 2**10  # [bytes]
MOST_WAITING = 100  # connections that have asked for nothing yet; a browser's asks within milliseconds


class Connection(HttpToolsProtocol):
    """A connection that is dropped where it asks for nothing; once it is a socket, other rules hold.

    uvicorn limits none of this: it waits for ever for the end of a head or of a body, and takes heads of any size.
    What is asked without the key is answered by the gate, which ends the connection; so only the app's own page has
    answers that take long.
    """

    _waiting: ClassVar[OrderedDict[Connection, None]] = OrderedDict()  # those without a whole head, the oldest first

    def __init__(self, *arguments: Any, **options: Any) -> None:
        super().__init__(*arguments, **options)
        self._deadline: asyncio.TimerHandle | None = None
        self._head = 0  # [bytes] of the head so far

    def connection_made(self, transport: asyncio.Transport) -> None:  # type: ignore[override]
        """Begin to wait; where too many do, the one that has waited longest is dropped."""
        super().connection_made(transport)
        self._await_head()
        while len(self._waiting) > MOST_WAITING:
            next(iter(self._waiting))._drop()

    def connection_lost(self, exc: Exception | None) -> None:
        """Forget it."""
        self._stop_waiting()
        super().connection_lost(exc)

    def data_received(self, data: bytes) -> None:
        """Read on, unless a head comes to no end."""
        if self in self._waiting:
            self._head += len(data)
        super().data_received(data)
        if self in self._waiting and self._head > LARGEST_HEAD:
            self._drop()

    def on_headers_complete(self) -> None:
        """The head is whole; a body may follow."""
        self._stop_waiting()
        self._deadline = self.loop.call_later(NEXT_PIECE, self._stalled)
        super().on_headers_complete()

    def on_body(self, body: bytes) -> None:
        """A piece of the body has come."""
        self._stop_waiting()
        self._deadline = self.loop.call_later(NEXT_PIECE, self._stalled)
        super().on_body(body)

    def on_message_complete(self) -> None:
        """The request is whole; the answer may take as long as it takes."""
        self._stop_waiting()
        super().on_message_complete()

    def on_response_complete(self) -> None:
        """The next head is awaited."""
        super().on_response_complete()
        if self.cycle.response_complete and not self.transport.is_closing():  # no other request has come meanwhile
            self._await_head()

    def handle_websocket_upgrade(self) -> None:
        """From now on it is a socket, which the gate has closed by then where it shows no key."""
        self._stop_waiting()
        super().handle_websocket_upgrade()

    def _await_head(self) -> None:
        self._stop_waiting()
        self._head = 0
        self._waiting[self] = None
        self._deadline = self.loop.call_later(WHOLE_HEAD, self._drop)

    def _stop_waiting(self) -> None:
        self._waiting.pop(self, None)
        if self._deadline is not None:
            self._deadline.cancel()
            self._deadline = None

    def _stalled(self) -> None:
        if self.flow.read_paused:  # it is the app that does not read
            self._deadline = self.loop.call_later(NEXT_PIECE, self._stalled)
        else:
            self._drop()

    def _drop(self) -> None:
        self._stop_waiting()
        self.transport.abort()
