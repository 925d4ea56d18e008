"""The app as a server on the user's own machine: started, shown in the browser, and ended without a trace."""

from __future__ import annotations

import asyncio
import contextlib
import logging
import multiprocessing
import os
import secrets
import signal
import socket
import sys
import webbrowser
from collections.abc import Callable
from importlib import import_module
from pathlib import Path
from pkgutil import iter_modules
from types import FrameType

import nicegui
import uvicorn
from fastapi import FastAPI
from nicegui import core, ui
from nicegui.dependencies import js_components

from zerorev.errors import InputError
from zerorev.web import views
from zerorev.web.connections import Connection
from zerorev.web.gate import Gate, keeping
from zerorev.web.pages import Pages
from zerorev.web.state import State

__all__ = ["serve"]

LOOPBACK = "127.0.0.1"
USUAL_PORT = 8780
RECONNECT = 20.0  # [s] that a lost connection is waited for before its page is built again, from the same state
FAREWELL = 0.2  # [s] for the last words to reach the browser
LARGEST_MESSAGE = 2 * 2**20  # [bytes] of what a page says over its socket
STATIC = Path(__file__).parent / "static"


def serve(state: State, *, port: int | None = None, browser: bool = True, say: Callable[[str], None] = print) -> None:
    """Serve the app on this machine alone, until it is asked to stop.

    Args:
        state: what each new page begins with.
        port: the one to use; None: the usual one, or a free one where that is taken.
        browser: whether to open the page in the user's browser.
        say: called with the address, once it answers.

    Raises:
        InputError: the port cannot be used.
        KeyboardInterrupt: the user stopped it; everything has ended by then.
    """
    with _listening(port) as listening:
        number = listening.getsockname()[1]
        token, once = secrets.token_urlsafe(24), secrets.token_urlsafe(24)
        at = f"http://{LOOPBACK}:{number}/?token="

        def begun() -> None:
            say(at + token)
            if browser:
                _open_browser(at + once)

        pages = Pages(state)
        server = _Server(Gate(_site(pages), number, token, once), begun)
        try:
            server.run([listening])
        finally:
            pages.end()
            for process in multiprocessing.active_children():
                process.terminate()
                process.join(FAREWELL)
    if server.stopped_by == signal.SIGINT:
        raise KeyboardInterrupt


# --- what is served ---------------------------------------------------------------------------------------------------


def _site(pages: Pages) -> FastAPI:
    """The app behind the gate."""
    logging.getLogger("nicegui").setLevel(logging.ERROR)
    _know_components()

    @ui.page("/", title="zerorev")
    async def root() -> None:
        client = ui.context.client
        for style in ("zerorev.css", "compute.css"):
            ui.add_css(STATIC / style)
        prefix = client.request.headers.get("x-forwarded-prefix", "")
        ended = (STATIC / "ended.js").read_text(encoding="utf-8")
        ui.add_head_html(f"<script>{keeping(prefix)}{ended}</script>{_early(prefix)}")
        with ui.element("div").classes("zr-loading").props('role="status" data-testid="loading"') as loading:
            ui.label("Opening …")
        await client.connected()
        if client.is_deleted:
            return
        try:
            pages.build(client)
        except Exception:
            logging.getLogger("zerorev").exception("a fault in zerorev itself; please report the lines below")
            with ui.element("div").classes("zr-broken").props('role="alert" data-testid="broken"'):
                ui.label("This page could not be drawn: a fault in zerorev itself. The terminal says more.")
        loading.delete()

    site = FastAPI(docs_url=None, redoc_url=None, openapi_url=None)
    ui.run_with(
        site,
        title="zerorev",
        dark=None,
        reconnect_timeout=RECONNECT,
        tailwind=False,
        gzip_middleware_factory=None,  # nothing of it goes over a network
        show_welcome_message=False,
    )
    return site


def _know_components() -> None:
    """Import every module that has scripts of its own: a page can only load those known when it was requested."""
    for module in iter_modules(views.__path__, f"{views.__name__}."):
        import_module(module.name)
    _ = ui.aggrid  # is imported where it is first named


def _early(prefix: str) -> str:
    """Has the browser read its three megabytes of scripts while the server draws the page, and all of them at once.

    They would come one by one as the page needs them, and a connection that is lost meanwhile would lose some.
    """
    scripts = (f'"{prefix}/_nicegui/{nicegui.__version__}/components/{each.key}"' for each in js_components.values())
    return f'<script type="module">for (const script of [{", ".join(scripts)}]) import(script);</script>'


# --- the server -------------------------------------------------------------------------------------------------------


class _Server(uvicorn.Server):
    """Says when it has begun, and lets the pages know before it ends."""

    def __init__(self, gate: Gate, begun: Callable[[], None]) -> None:
        super().__init__(
            uvicorn.Config(
                gate,
                log_level="error",
                access_log=False,
                http=Connection,
                ws="wsproto",
                ws_max_size=LARGEST_MESSAGE,
                ws_per_message_deflate=False,  # it goes over no network, and every page would wait for it
                server_header=False,
                proxy_headers=False,
                timeout_graceful_shutdown=1,
            )
        )
        self.stopped_by: int | None = None
        self._begun = begun

    async def startup(self, sockets: list[socket.socket] | None = None) -> None:
        """Begin to answer, and say so."""
        await super().startup(sockets)
        if self.started:
            self._begun()

    def handle_exit(self, sig: int, frame: FrameType | None) -> None:
        """Hear of Ctrl-C, or of being asked to stop: the first time take leave, the second time go."""
        if self.stopped_by is None and self.started and core.loop is not None:
            self.stopped_by = sig
            core.loop.call_soon_threadsafe(self._take_leave)
        else:
            self.stopped_by = self.stopped_by or sig
            self.should_exit = self.force_exit = True

    def _take_leave(self) -> None:
        async def leave() -> None:
            logging.getLogger("uvicorn.error").setLevel(logging.CRITICAL)  # sockets that are cut off need no message
            with contextlib.suppress(Exception):
                await core.sio.emit("run_javascript", {"code": "zerorevEnded()"})
                await asyncio.sleep(FAREWELL)
            self.should_exit = True

        self._leaving = asyncio.get_running_loop().create_task(leave())


def _listening(port: int | None) -> socket.socket:
    """A socket of this machine alone.

    Raises:
        InputError: the port asked for cannot be used.
    """
    listening = socket.socket(socket.AF_INET, socket.SOCK_STREAM)
    # elsewhere a port just left could not be used again for a minute; there it would let others share it
    if sys.platform != "win32":
        listening.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    try:
        listening.bind((LOOPBACK, USUAL_PORT if port is None else port))
        listening.listen(128)
    except (OSError, OverflowError) as error:
        if port is None:
            listening.bind((LOOPBACK, 0))
            return listening
        listening.close()
        why = (isinstance(error, OSError) and error.strerror) or str(error)
        raise InputError(
            f"{port} cannot be used: {why}", where="--port", accepted="1 to 65535, one that is free; or none: any"
        ) from None
    return listening


def _open_browser(address: str) -> None:
    """Open the page, where there is a screen to open it on."""
    if sys.platform == "linux" and not (os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")):
        return
    with contextlib.suppress(webbrowser.Error):
        webbrowser.open(address)
