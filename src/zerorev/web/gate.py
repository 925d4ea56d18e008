"""Who may ask the app for anything: requests and sockets from the page that was opened with the token, nobody else.

Any program of this machine reaches a port of it, and so does any web page that the user looks at. So every request and
every socket must name this very host (a page elsewhere may give its own name to 127.0.0.1), those that change something
must come from our own page, and each must show the token: in the address once, and from then on as a cookie.
"""

from __future__ import annotations

import hmac
from collections.abc import Awaitable, Callable, MutableMapping
from typing import Any
from urllib.parse import parse_qs

__all__ = ["LARGEST", "Gate"]

Scope = MutableMapping[str, Any]
Message = MutableMapping[str, Any]
Receive = Callable[[], Awaitable[Message]]
Send = Callable[[Message], Awaitable[None]]
App = Callable[[Scope, Receive, Send], Awaitable[None]]

LARGEST = 20 * 2**20  # [bytes] of the body of a request: a plan of 1,000 holes is a fifth of it
READS_ONLY = ("GET", "HEAD")

NO_TOKEN = "This page is opened with the address that `zerorev view` printed, which holds a token."
NOT_THIS_HOST = "The app answers to 127.0.0.1 and localhost alone."
NOT_OUR_PAGE = "The app answers to its own page alone."
TOO_LARGE = f"More than {LARGEST // 2**20} MiB is not taken."


class Gate:
    """An ASGI app around another, through which every request and socket goes."""

    def __init__(self, app: App, port: int, token: str, once: str | None = None) -> None:
        """Stand before an app.

        Args:
            app: behind the gate.
            port: that it is served on.
            token: opens the gate, as often as wanted.
            once: opens it, too, but one time only: an address that is handed to a browser can be seen by other users
                of this machine in the list of processes.
        """
        self.app = app
        self._token, self._once = token, once
        self._hosts = (f"127.0.0.1:{port}", f"localhost:{port}")
        self._cookie = f"zerorev-{port}"  # cookies know no ports
        self._added = _security_headers(self._hosts)

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Let a request or a socket in, or refuse it."""
        if scope["type"] not in ("http", "websocket"):
            return await self.app(scope, receive, send)
        headers = _Headers(scope["headers"])
        refusal = self._stranger(scope, headers)
        key = parse_qs(scope["query_string"].decode("latin-1")).get("token", [""])[-1]
        known = _same(headers.cookie(self._cookie), self._token)
        if refusal is None and scope["type"] == "http" and key and scope["method"] == "GET" and scope["path"] == "/":
            if known or self._opens(key):
                return await self._let_in(send)
            refusal = NO_TOKEN
        if refusal is None and not known:
            refusal = NO_TOKEN
        if refusal is not None:
            return await self._refuse(scope, receive, send, refusal)
        if scope["type"] == "websocket":
            return await self.app(scope, receive, send)
        return await self._ask(scope, headers, receive, send)

    def _stranger(self, scope: Scope, headers: _Headers) -> str | None:
        """Why a request can come from no page of ours, whatever it shows; None: it may."""
        host = headers.only("host")
        if host not in self._hosts:
            return NOT_THIS_HOST
        origin = headers.only("origin")
        from_us = origin == f"http://{host}"
        asks_only = scope["type"] == "http" and scope["method"] in READS_ONLY and origin is None
        return None if from_us or asks_only else NOT_OUR_PAGE

    def _opens(self, key: str) -> bool:
        if self._once is not None and _same(key, self._once):
            self._once = None
            return True
        return _same(key, self._token)

    async def _let_in(self, send: Send) -> None:
        """Give the cookie, and lead to the address without the token, so that it stays in no history."""
        cookie = f"{self._cookie}={self._token}; Path=/; HttpOnly; SameSite=Strict"
        headers = [(b"location", b"/"), (b"set-cookie", cookie.encode()), (b"cache-control", b"no-store")]
        await send({"type": "http.response.start", "status": 303, "headers": headers + self._added})
        await send({"type": "http.response.body", "body": b""})

    async def _refuse(self, scope: Scope, receive: Receive, send: Send, why: str, status: int = 403) -> None:
        if scope["type"] == "websocket":
            await receive()
            return await send({"type": "websocket.close", "code": 1008, "reason": why})
        headers = [(b"content-type", b"text/plain; charset=utf-8"), (b"connection", b"close"), *self._added]
        await send({"type": "http.response.start", "status": status, "headers": headers})
        await send({"type": "http.response.body", "body": f"{why}\n".encode()})

    async def _ask(self, scope: Scope, headers: _Headers, receive: Receive, send: Send) -> None:
        """Hand a request on; whoever sends too much, said or unsaid, is refused, and the app hears no more of it."""
        length = headers.only("content-length") or "0"
        if not length.isdecimal() or int(length) > LARGEST:
            return await self._refuse(scope, receive, send, TOO_LARGE, 413)
        taken, begun, cut = 0, False, False

        async def counted() -> Message:
            nonlocal taken, cut
            message = await receive()
            taken += len(message.get("body", b""))
            if taken <= LARGEST:
                return message
            if not cut and not begun:
                await self._refuse(scope, receive, send, TOO_LARGE, 413)
            cut = True
            return {"type": "http.disconnect"}

        async def answer(message: Message) -> None:
            nonlocal begun
            begun = True
            if message["type"] == "http.response.start":
                message["headers"] = [*message.get("headers", ()), *self._added]
            if not cut:
                await send(message)

        try:
            await self.app(scope, counted, answer)
        except Exception:
            if not cut:
                raise


class _Headers:
    """The headers of a request."""

    def __init__(self, raw: list[tuple[bytes, bytes]]) -> None:
        self._all = [(name.lower().decode("latin-1"), value.decode("latin-1")) for name, value in raw]

    def only(self, name: str) -> str | None:
        """The value of a header that stands once; of one that stands twice, nothing that anybody would accept."""
        found = [value for each, value in self._all if each == name]
        return None if not found else found[0] if len(found) == 1 else ""

    def cookie(self, name: str) -> str:
        """A cookie's value, or an empty text."""
        pairs = (
            pair.strip().partition("=") for key, value in self._all if key == "cookie" for pair in value.split(";")
        )
        return next((value for key, _, value in pairs if key == name), "")


def _same(given: str, secret: str) -> bool:
    return hmac.compare_digest(given.encode(), secret.encode())


def _security_headers(hosts: tuple[str, ...]) -> list[tuple[bytes, bytes]]:
    """Nothing is fetched from any other host, and no other page can hold this one in a frame."""
    sockets = " ".join(f"ws://{host}" for host in hosts)
    policy = (
        "default-src 'self'",
        "script-src 'self' 'unsafe-inline' 'unsafe-eval' blob:",  # NiceGUI builds its page in the browser
        "style-src 'self' 'unsafe-inline'",
        "img-src 'self' data: blob:",
        "font-src 'self' data:",
        f"connect-src 'self' data: blob: {sockets}",
        "worker-src 'self' blob:",
        "object-src 'none'",
        "base-uri 'self'",
        "form-action 'self'",
        "frame-ancestors 'none'",
    )
    headers = {
        "content-security-policy": "; ".join(policy),
        "referrer-policy": "no-referrer",
        "x-content-type-options": "nosniff",
        "cross-origin-resource-policy": "same-origin",
        "cross-origin-opener-policy": "same-origin",
    }
    return [(name.encode(), value.encode()) for name, value in headers.items()]
