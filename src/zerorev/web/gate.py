"""Who may ask the app for anything: the page that was opened with the token, nobody else.

Any program of this machine reaches a port of it, and so does any web page that the user opens. A cookie would not keep
them out: browsers send it to every port of an address, so that whoever serves another port of this machine is given it.
The app has none. What stands for the token once a page is opened is a key:

- The key is the first part of every path behind the gate, of scripts, sockets and uploads alike. It stands in the page,
  and in no address that the browser shows or keeps in its history.
- The browser keeps the key in the local storage of the page's origin, which, unlike a cookie, is of one port alone. The
  address without a token is answered by a door: a page without any secret, whose script shows the key that it finds
  there and is given a ticket, an address at which the page is served one time.

So nothing that another port hears or sees opens the page or anything behind it.
"""

from __future__ import annotations

import hmac
import json
import secrets
import time
from collections.abc import Awaitable, Callable, MutableMapping
from pathlib import Path
from typing import Any
from urllib.parse import parse_qs

from zerorev.files.text import MAX_BYTES

__all__ = ["LARGEST", "Gate", "keeping"]

Scope = MutableMapping[str, Any]
Message = MutableMapping[str, Any]
Receive = Callable[[], Awaitable[Message]]
Send = Callable[[Message], Awaitable[None]]
App = Callable[[Scope, Receive, Send], Awaitable[None]]

LARGEST = MAX_BYTES + 2**20  # [bytes] of the body of a request: a file, and what is sent around it
READS_ONLY = ("GET", "HEAD")
TICKET_LASTS = 60.0  # [s]
MOST_TICKETS = 100
SHOWN_IN = "x-zerorev-key"  # header in which the door shows the key
STORED_AS = "zerorev-key"  # name in the local storage

NO_TOKEN = "This page is opened with the address that `zerorev view` printed, which holds a token."
NOT_THIS_HOST = "The app answers to 127.0.0.1 alone."
NOT_OUR_PAGE = "The app answers to its own page alone."
TOO_LARGE = f"More than {MAX_BYTES // 2**20} MiB is not taken."

DOOR = (Path(__file__).parent / "static" / "door.html").read_text(encoding="utf-8")


class Gate:
    """An ASGI app around another, through which every request and socket goes.

    Attributes:
        key: of the page.
    """

    def __init__(self, app: App, port: int, token: str, once: str | None = None) -> None:
        """Stand before an app.

        Args:
            app: behind the gate; is given the prefix of its paths as a proxy would give it (`X-Forwarded-Prefix`).
            port: that it is served on.
            token: opens the gate, as often as wanted.
            once: opens it, too, but one time only: an address that is handed to a browser can be seen by other users
                of this machine in the list of processes.
        """
        self.app = app
        self.key = secrets.token_urlsafe(24)
        self._token, self._once = token, once
        # not `localhost`: that may be ::1 as well, whose ports another user can serve
        self._host = f"127.0.0.1:{port}"
        self._tickets: dict[str, float] = {}  # until when [s] each holds
        self._added = _security_headers(self._host)
        words = {"KEY": STORED_AS, "HEADER": SHOWN_IN, "NO_TOKEN": NO_TOKEN}
        self._door = DOOR.replace("WORDS", json.dumps(words)).encode()

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Let a request or a socket in, or refuse it."""
        if scope["type"] not in ("http", "websocket"):
            return await self.app(scope, receive, send)
        headers = _Headers(scope["headers"])
        refusal = self._stranger(scope, headers)
        if refusal is not None:
            return await self._refuse(scope, receive, send, refusal)
        if scope["path"] == "/" and scope["type"] == "http":
            return await self._at_the_door(scope, headers, receive, send)
        _, key, path = scope["path"].split("/", 2) if scope["path"].count("/") > 1 else ("", "", "")
        if not _same(key, self.key):
            return await self._refuse(scope, receive, send, NO_TOKEN)
        inner = self._behind(scope, f"/{path}")
        if scope["type"] == "websocket":
            return await self.app(inner, receive, send)
        return await self._ask(inner, headers, receive, send)

    def _stranger(self, scope: Scope, headers: _Headers) -> str | None:
        """Why a request cannot come from a page of ours, regardless of its token; None: it may."""
        if headers.only("host") != self._host:
            return NOT_THIS_HOST
        origin = headers.only("origin")
        asks_only = scope["type"] == "http" and scope["method"] in READS_ONLY and origin is None
        return None if origin == f"http://{self._host}" or asks_only else NOT_OUR_PAGE

    async def _at_the_door(self, scope: Scope, headers: _Headers, receive: Receive, send: Send) -> None:
        """The one path that is open to everybody."""
        query = parse_qs(scope["query_string"].decode("latin-1"))
        token, ticket = query.get("token", [""])[-1], query.get("page", [""])[-1]
        if scope["method"] == "POST":
            if not _same(headers.only(SHOWN_IN) or "", self.key):
                return await self._refuse(scope, receive, send, NO_TOKEN)
            return await self._say(send, 200, self._ticket().encode(), "text/plain")
        if scope["method"] not in READS_ONLY:
            return await self._refuse(scope, receive, send, NO_TOKEN)
        if token and self._opens(token):  # to an address that is used up before the browser notes it in its history
            return await self._say(send, 303, b"", "text/plain", location=f"/?page={self._ticket()}")
        if ticket and self._tickets.pop(ticket, 0.0) > time.monotonic():
            return await self._ask(self._behind(scope, "/"), headers, receive, send)
        return await self._say(send, 403 if token else 200, self._door, "text/html")

    def _opens(self, token: str) -> bool:
        if self._once is not None and _same(token, self._once):
            self._once = None
            return True
        return _same(token, self._token)

    def _ticket(self) -> str:
        now = time.monotonic()
        held = [(each, until) for each, until in self._tickets.items() if until > now]
        ticket = secrets.token_urlsafe(24)
        self._tickets = {**dict(held[1 - MOST_TICKETS :]), ticket: now + TICKET_LASTS}
        return ticket

    def _behind(self, scope: Scope, path: str) -> Scope:
        """What the app behind is asked: of the gate it knows the prefix alone."""
        headers = [(name, value) for name, value in scope["headers"] if not name.lower().startswith(b"x-forwarded-")]
        headers.append((b"x-forwarded-prefix", f"/{self.key}".encode()))
        query = b"" if path == "/" else scope["query_string"]
        return {**scope, "path": path, "raw_path": path.encode(), "query_string": query, "headers": headers}

    async def _say(self, send: Send, status: int, body: bytes, kind: str, *, location: str | None = None) -> None:
        """Answer in the app's stead; the connection ends with it, so that no stranger keeps one."""
        headers = [(b"content-type", f"{kind}; charset=utf-8".encode()), (b"content-length", str(len(body)).encode())]
        headers += [(b"connection", b"close"), (b"cache-control", b"no-store"), *self._added]
        headers += [] if location is None else [(b"location", location.encode())]
        await send({"type": "http.response.start", "status": status, "headers": headers})
        await send({"type": "http.response.body", "body": body})

    async def _refuse(self, scope: Scope, receive: Receive, send: Send, why: str, status: int = 403) -> None:
        if scope["type"] == "websocket":
            await receive()
            return await send({"type": "websocket.close", "code": 1008, "reason": why})
        await self._say(send, status, f"{why}\n".encode(), "text/plain")

    async def _ask(self, scope: Scope, headers: _Headers, receive: Receive, send: Send) -> None:
        """Hand a request on; whoever sends too much, announced or not, is refused, and the app gets no more."""
        length = headers.only("content-length") or "0"
        if not length.isdecimal() or int(length) > LARGEST:
            return await self._refuse(scope, receive, send, TOO_LARGE, 413)
        taken, begun, cut = 0, False, False

        async def counted() -> Message:
            nonlocal taken, cut
            message = await receive()
            if message["type"] == "http.disconnect":  # what the app says to that is of no interest to anybody
                cut = True
                return message
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


def keeping(prefix: str) -> str:
    """JavaScript for the head of the page: the browser keeps the key, and forgets the ticket.

    Args:
        prefix: of the paths, as the app behind the gate is given it.
    """
    key = json.dumps(prefix.strip("/"))
    return f'history.replaceState(null, "", "/"); try {{ localStorage["{STORED_AS}"] = {key}; }} catch {{}}'


def _same(given: str, secret: str) -> bool:
    return hmac.compare_digest(given.encode(), secret.encode())


def _security_headers(host: str) -> list[tuple[bytes, bytes]]:
    """Nothing is fetched from any other host, and no other page can hold this one in a frame."""
    policy = (
        "default-src 'self'",
        "script-src 'self' 'unsafe-inline' 'unsafe-eval' blob:",  # NiceGUI builds its page in the browser
        "style-src 'self' 'unsafe-inline'",
        "img-src 'self' data: blob:",
        "font-src 'self' data:",
        f"connect-src 'self' data: blob: ws://{host}",
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
