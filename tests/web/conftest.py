"""The app in a real browser: `zerorev view` as a process of its own, its page in Debian's chromium.

At the end of every test its page must have written no error to the console, thrown none, and asked no other
host for anything. What a test brings about on purpose it names beforehand: `page.expected.append("...")`.
"""

from __future__ import annotations

import os
import re
import signal
import subprocess
import sys
import threading
from collections import deque
from collections.abc import Mapping
from pathlib import Path
from urllib.parse import urlsplit

import pytest

from zerorev.cli.common import INTERRUPTED
from zerorev.model.job import Job
from zerorev.planning.job import plan_job
from zerorev.web.state import opened_plan

PATIENCE = 60.0  # [s] for a server to start or end; a machine may be busy
OWN = ("data:", "blob:", "about:")  # addresses that never leave the browser


class Server:
    """`zerorev view` as a user runs it.

    Attributes:
        address: as printed, with its token.
        origin: `http://127.0.0.1:port`.
        lines: the last that it wrote, for messages.
    """

    def __init__(self, *arguments: str | Path, folder: Path, variables: Mapping[str, str] | None = None) -> None:
        command = [sys.executable, "-u", "-m", "zerorev.cli", "view", *map(str, arguments), "--no-browser", "--port=0"]
        self.lines: deque[str] = deque(maxlen=200)
        self._process = subprocess.Popen(
            command, cwd=folder, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
            env={**os.environ, "COLUMNS": "200", **(variables or {})}, start_new_session=True,
        )  # fmt: skip
        self._there = threading.Event()
        self.address = ""
        self._reader = threading.Thread(target=self._read, daemon=True)
        self._reader.start()
        if not self._there.wait(PATIENCE) or not self.address:
            self._over()
            raise AssertionError("zerorev view printed no address:\n" + "".join(self.lines))

    @property
    def origin(self) -> str:
        """Scheme, host and port."""
        parts = urlsplit(self.address)
        return f"{parts.scheme}://{parts.netloc}"

    @property
    def pid(self) -> int:
        """Of the process."""
        return self._process.pid

    def _read(self) -> None:
        assert self._process.stdout is not None
        for line in self._process.stdout:
            self.lines.append(line)
            if not self.address and (found := re.search(r"http://127\.0\.0\.1:\d+/\S*", line)):
                self.address = found.group().rstrip(".,)")
                self._there.set()
        self._there.set()

    def tell(self, number: int) -> None:
        """Send a signal to the process, as Ctrl-C or a shut-down does."""
        self._process.send_signal(number)

    def end(self, number: int = signal.SIGINT) -> tuple[int, str]:
        """Ask it to end.

        Returns:
            its exit code, and the last lines that it wrote.
        """
        if self._process.poll() is None:
            self.tell(number)
        try:
            code = self._process.wait(PATIENCE)
        except subprocess.TimeoutExpired:
            raise AssertionError("zerorev view did not end:\n" + "".join(self.lines)) from None
        finally:
            self._over()
        return code, "".join(self.lines)

    def _over(self) -> None:
        """Leave nothing of it behind."""
        if self._process.poll() is None:
            os.killpg(self._process.pid, signal.SIGKILL)
        self._process.wait()
        self._reader.join(PATIENCE)
        assert self._process.stdout is not None
        self._process.stdout.close()


@pytest.fixture(scope="module")
def serve(tmp_path_factory):
    """Starts `zerorev view` with the arguments given; all end with the test file, and each must end well."""
    servers: list[Server] = []

    def start(*arguments: str | Path, **options: Mapping[str, str]) -> Server:
        servers.append(Server(*arguments, folder=tmp_path_factory.mktemp("view"), **options))
        return servers[-1]

    yield start
    for server in servers:
        code, said = server.end()
        assert code == INTERRUPTED, said
        assert "Traceback" not in said, said


@pytest.fixture(scope="module")
def demo(serve) -> Server:
    """The app with nothing opened but its demo."""
    return serve()


@pytest.fixture
def open_page(browser):
    """Opens the page of a server in a browser profile of its own; looks at its end at what it did unseen."""
    contexts, faults = [], []

    def opened(server: Server, *, address: str = "", **options):
        context = browser.new_context(
            **{"viewport": {"width": 1280, "height": 900}, "reduced_motion": "reduce"} | options
        )
        contexts.append(context)
        page = context.new_page()
        page.expected = []

        def fault(what: str) -> None:
            if not any(part in what for part in page.expected):
                faults.append(what)

        def asked(url: str) -> None:
            if not url.startswith((server.origin + "/", server.origin.replace("http", "ws", 1) + "/", *OWN)):
                fault(f"asked for {url}")

        page.on("console", lambda message: message.type == "error" and fault(f"console: {message.text}"))
        page.on("pageerror", lambda error: fault(f"error in the page: {error}"))
        context.on("request", lambda request: asked(request.url))
        page.on("websocket", lambda socket: asked(socket.url))
        page.goto(address or server.address)
        return page

    yield opened
    for context in contexts:
        context.close()
    assert not faults, "\n".join(faults)


@pytest.fixture
def on_screen():
    """Finds where [px] a point of a `Cell` is drawn: the page, the cell, and its point, both in JavaScript."""

    def found(page, cell: str, point: str) -> tuple[float, float]:
        x, y = page.evaluate(
            f"""() => {{ const cell = {cell}, at = {point};
            cell.camera.updateMatrixWorld(); at.project(cell.camera);
            const box = cell.canvas.getBoundingClientRect();
            return [box.left + (at.x + 1) / 2 * box.width, box.top + (1 - at.y) / 2 * box.height]; }}"""
        )
        return x, y

    return found


@pytest.fixture
def say(request):
    """Reports a measured figure at the end of the run, also of a test that passes (`tests/conftest.py`)."""
    return lambda text: request.node.user_properties.append(("measured", text))


@pytest.fixture
def demo_page(open_page, demo):
    """The page of the demo."""
    return open_page(demo)


@pytest.fixture(scope="module")
def job(robot, tool, positions):
    """The three published positions."""
    return Job(robot, tool, tuple(each.hole for each in positions))


@pytest.fixture(scope="module")
def planned(job):
    """Their plan."""
    return plan_job(job)


@pytest.fixture
def state(planned):
    """A page that shows it."""
    return opened_plan(planned)
