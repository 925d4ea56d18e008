"""The server: reached from this machine alone, with the token alone; it ends without a trace, also during work."""

from __future__ import annotations

import asyncio
import json
import re
import signal
import socket
import subprocess
import sys
import time
from pathlib import Path

import httpx
import pytest
import socketio
import wsproto
import wsproto.events

from oracles.places import JOBS
from zerorev.cli.common import BAD_INPUT, FINE, INTERRUPTED
from zerorev.web.server import RECONNECT

PATIENCE = 90.0  # [s] a machine may be busy
PANEL = JOBS / "panel.yaml"


def asks(server, **more) -> httpx.Client:
    """A client that knows no token."""
    return httpx.Client(base_url=server.origin, timeout=PATIENCE, trust_env=False, **more)


def page_of(client: httpx.Client, server) -> str:
    """The page behind the door, by the token."""
    first = client.get("/", params={"token": server.address.partition("token=")[2]})
    assert first.status_code == 303
    return client.get(first.headers["location"]).text


def prefix_of(page: str) -> str:
    """What the paths of a page begin with."""
    return re.search(r'prefix: "(/[\w-]{32})"', page)[1]


def test_the_token_and_then_the_key_of_the_page(demo):
    token = demo.address.partition("token=")[2]
    assert len(token) >= 32
    with asks(demo) as client:
        page = page_of(client, demo)
        assert token not in page
        assert not client.cookies
        prefix = prefix_of(page)
        files = set(re.findall(r'(?:src|href)="(/[^"]+)"', page))
        assert len(files) > 3
        assert not set(re.findall(r'"(/_nicegui[^"]*)"', page)), "asked for without the key"
        for file in files:  # NiceGUI's own files are behind the gate, too
            assert client.get(file).status_code == 200, file
            assert client.get(file.removeprefix(prefix)).status_code == 403, file


def handshake(server, prefix: str, origin: str) -> int:
    """What a server answers to a socket that is to be opened: 101, or a refusal."""
    host, port = server.origin.removeprefix("http://").split(":")
    target = f"{prefix}/_nicegui_ws/socket.io/?EIO=4&transport=websocket"
    headers = [(b"origin", origin.encode())]
    connection = wsproto.WSConnection(wsproto.ConnectionType.CLIENT)
    asked = connection.send(wsproto.events.Request(host=f"{host}:{port}", target=target, extra_headers=headers))
    with socket.create_connection((host, int(port)), timeout=PATIENCE) as stream:
        stream.sendall(asked)
        connection.receive_data(stream.recv(65536))
        event = next(iter(connection.events()))
        if isinstance(event, wsproto.events.AcceptConnection):
            return 101
        while stream.recv(65536):  # who is refused is let go
            pass
    return event.status_code


def test_sockets_ask_for_key_and_origin(demo):
    with asks(demo) as client:
        prefix = prefix_of(page_of(client, demo))
    assert handshake(demo, prefix, demo.origin) == 101
    assert handshake(demo, "", demo.origin) == 403
    assert handshake(demo, "/" + demo.address.partition("token=")[2], demo.origin) == 403
    assert handshake(demo, prefix, "http://evil.example") == 403
    assert handshake(demo, prefix, "http://127.0.0.1:1") == 403


def test_a_name_that_was_made_to_mean_this_machine_is_refused(demo):
    token = demo.address.partition("token=")[2]
    for host in ("evil.example", demo.origin.removeprefix("http://").replace("127.0.0.1", "localhost")):
        with asks(demo, headers={"host": host}) as client:
            answer = client.get("/", params={"token": token})
        assert (answer.status_code, answer.text) == (403, "The app answers to 127.0.0.1 alone.\n")


def test_paths_of_this_machine_are_not_served(demo):
    with asks(demo) as client:
        prefix = prefix_of(page_of(client, demo))
        for path in (
            "/etc/passwd",
            "/%2e%2e/%2e%2e/etc/passwd",
            "/_nicegui/3.18.0/static/%2e%2e/%2e%2e/ui.py",
            "/docs",
        ):
            answer = client.get(prefix + path)
            assert answer.status_code in (403, 404), path
            assert "root:" not in answer.text
            assert client.get(path).status_code == 403


@pytest.mark.skipif(not Path("/proc/net/tcp").is_file(), reason="reads what Linux says of its sockets")
def test_it_listens_on_the_loopback_alone(demo):
    port = f"{int(demo.origin.rpartition(':')[2]):04X}"
    places = [
        line.split()[1] for file in ("tcp", "tcp6") for line in Path(f"/proc/net/{file}").read_text().splitlines()[1:]
    ]
    assert {place for place in places if place.endswith(f":{port}")} == {f"0100007F:{port}"}


def started(*arguments: str, folder: Path) -> subprocess.Popen:
    """`zerorev view`, in a group of its own."""
    command = [sys.executable, "-u", "-m", "zerorev.cli", "view", "--no-browser", *arguments]
    return subprocess.Popen(
        command, cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, start_new_session=True
    )


def left(group: int) -> list[str]:
    """What is left of a group of processes a moment after its first has ended; what only waits to be counted is not."""
    deadline = time.monotonic() + 5.0
    while True:
        listed = subprocess.run(["ps", "-eo", "pgid=,stat=,args="], capture_output=True, text=True, check=True).stdout
        entries = [line.split(maxsplit=2) for line in listed.splitlines()]
        found = [entry[-1] for entry in entries if entry[0] == str(group) and not entry[1].startswith("Z")]
        if not found or time.monotonic() > deadline:
            return found
        time.sleep(0.1)


def address_of(process: subprocess.Popen) -> str:
    """As printed."""
    line = process.stdout.readline().strip()
    assert line.startswith("http://127.0.0.1:"), line + process.stderr.read()
    return line


@pytest.mark.parametrize(
    ("number", "code", "said"),
    [
        (signal.SIGINT, INTERRUPTED, "error: interrupted; no file was left half-written\n"),
        (signal.SIGTERM, FINE, ""),
    ],
)
def test_it_ends_cleanly_and_leaves_no_process(tmp_path, number, code, said):
    process = started("--port", "0", folder=tmp_path)
    address_of(process)
    process.send_signal(number)
    _, errors = process.communicate(timeout=PATIENCE)
    assert process.returncode == code
    assert errors.replace("note: the app is served to this machine alone; Ctrl-C ends it\n", "") == said
    assert not left(process.pid)
    assert not list(tmp_path.iterdir())


def test_a_port_that_is_taken(tmp_path):
    with socket.create_server(("127.0.0.1", 0)) as taken:
        number = taken.getsockname()[1]
        process = started("--port", str(number), folder=tmp_path)
        output, errors = process.communicate(timeout=PATIENCE)
    assert (process.returncode, output) == (BAD_INPUT, "")
    assert errors.startswith(f"error: --port: {number} cannot be used: ")
    assert errors.count("\n") == 1


@pytest.mark.parametrize("port", ["-1", "65536", "1.5", "http"])
def test_a_port_that_is_none(tmp_path, port):
    process = started(f"--port={port}", folder=tmp_path)
    output, errors = process.communicate(timeout=PATIENCE)
    assert (process.returncode, output) == (BAD_INPUT, "")
    assert "Traceback" not in errors


def test_a_file_that_cannot_be_opened(tmp_path):
    (tmp_path / "cut.json").write_text('{"format": "zerorev.plan/1", ')
    process = started("cut.json", folder=tmp_path)
    output, errors = process.communicate(timeout=PATIENCE)
    assert (process.returncode, output) == (BAD_INPUT, "")
    assert errors.startswith("error: cut.json, line 1")


class Page:
    """A page without a browser: NiceGUI's own protocol, as far as is needed to press a button and see what changes."""

    def __init__(self, address: str, web: httpx.AsyncClient, tab: str) -> None:
        self.address, self.web, self.tab = address, web, tab
        self.elements: dict[str, dict] = {}
        self.socket = socketio.AsyncClient(reconnection=False)
        self.socket.on("update", self._update)

    async def __aenter__(self) -> Page:
        origin = self.address.partition("/?")[0]
        text = (await self.web.get("/", params={"token": self.address.partition("token=")[2]})).text
        prefix = prefix_of(text)
        self.client = re.search(r"'client_id': '([0-9a-f-]+)'", text)[1]
        parts = {"client_id": self.client, "next_message_id": 0, "implicit_handshake": "true", "tab_id": self.tab}
        query = "&".join(f"{key}={value}" for key, value in (parts | {"document_id": "1", "old_tab_id": ""}).items())
        await self.socket.connect(
            f"{origin}?{query}",
            headers={"Origin": origin},
            transports=["websocket"],
            socketio_path=f"{prefix}/_nicegui_ws/socket.io",
            wait_timeout=PATIENCE,
        )
        return self

    async def __aexit__(self, *_) -> None:
        await self.socket.disconnect()

    def _update(self, message: dict) -> None:
        message.pop("_id", None)
        self.elements.update(message)

    async def find(self, name: str, shown: bool = True) -> tuple[str, dict]:
        """An element by its test id, once it is there and is shown, or hidden."""
        deadline = time.monotonic() + PATIENCE
        while time.monotonic() < deadline:
            for number, element in list(self.elements.items()):
                hidden = "hidden" in (element or {}).get("class", ())
                if element and element.get("props", {}).get("data-testid") == name and hidden is not shown:
                    return number, element
            await asyncio.sleep(0.05)
        raise AssertionError(f"no {name}")

    async def text(self, text: str) -> None:
        """Wait until something says so."""
        deadline = time.monotonic() + PATIENCE
        while not any(element and element.get("text") == text for element in self.elements.values()):
            assert time.monotonic() < deadline, f"nothing says '{text}'"
            await asyncio.sleep(0.05)

    async def tell(self, name: str, kind: str, value: object) -> None:
        """Have an event of an element happen."""
        number, element = await self.find(name)
        listener = next(event["listener_id"] for event in element["events"] if event["type"] == kind)
        message = {"id": int(number), "client_id": self.client, "listener_id": listener, "args": [json.dumps(value)]}
        await self.socket.emit("event", message)


def test_work_outlives_its_page_and_ends_with_the_app(tmp_path):
    """A hundred holes on all cores: left, found again by the same tab and by no other, and stopped by Ctrl-C."""
    process = started("--port", "0", str(PANEL), folder=tmp_path)
    address = address_of(process)

    async def run() -> None:
        web = httpx.AsyncClient(
            base_url=address.partition("/?")[0], timeout=PATIENCE, trust_env=False, follow_redirects=True
        )
        async with web:
            async with Page(address, web, "one") as page:
                await page.text("planning hole R0C0")  # which is selected first, and so planned unasked
                await page.find("progress", shown=False)
                await page.tell("scope", "update:modelValue", 1)
                await page.tell("plan", "click", {})
                await page.text("planning 99 holes")
            async with Page(address, web, "two") as page:
                await page.text("planning hole R0C0")
            async with Page(address, web, "one") as page:
                await page.text("planning 99 holes")
                process.send_signal(signal.SIGINT)
                await asyncio.to_thread(process.wait, PATIENCE)

    asyncio.run(run())
    _, errors = process.communicate(timeout=PATIENCE)
    assert process.returncode == INTERRUPTED, errors
    assert "Traceback" not in errors
    assert not left(process.pid)


# --- memory -----------------------------------------------------------------------------------------------------------

KEPT_FREE = 40.0  # [MB] that an allocator may keep for later


def memory(server) -> float:
    """What a server has of the machine's memory [MB]."""
    status = Path(f"/proc/{server.pid}/status").read_text()
    return int(re.search(r"VmRSS:\s+(\d+) kB", status)[1]) / 1024


@pytest.mark.long
@pytest.mark.skipif(not Path("/proc/self/status").is_file(), reason="reads what Linux says of a process")
def test_sockets_give_their_memory_back(demo, say):
    with asks(demo) as client:
        prefix = prefix_of(page_of(client, demo))
    for _ in range(50):
        handshake(demo, prefix, demo.origin)
    before = memory(demo)
    for _ in range(1000):
        handshake(demo, prefix, demo.origin)
    after = memory(demo)
    say(f"memory of the app: {before:.0f} MB, after 1,000 sockets more {after:.0f} MB")
    assert after < before + KEPT_FREE


@pytest.mark.soak
@pytest.mark.skipif(not Path("/proc/self/status").is_file(), reason="reads what Linux says of a process")
def test_pages_give_their_memory_back(demo, say):
    async def visit(numbers: range) -> None:
        web = httpx.AsyncClient(base_url=demo.origin, timeout=PATIENCE, trust_env=False, follow_redirects=True)
        async with web:
            for number in numbers:
                async with Page(demo.address, web, f"tab {number}") as page:
                    await page.find("plan")

    def left() -> float:
        time.sleep(RECONNECT + 5)  # a page is kept for as long as its browser may come back
        return memory(demo)

    asyncio.run(visit(range(60)))  # as many as are kept, and the libraries that are loaded when they are needed
    before = left()
    asyncio.run(visit(range(60, 260)))
    after = left()
    say(f"memory of the app: {before:.0f} MB, after 200 pages more {after:.0f} MB")
    assert after < before + KEPT_FREE
