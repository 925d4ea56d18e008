"""Connections that ask for nothing, or for a part of something, are dropped, and the app answers meanwhile."""

from __future__ import annotations

import re
import socket
import time
from pathlib import Path

import httpx
import pytest

pytest.importorskip("nicegui")

from zerorev.web import connections

PATIENCE = 60.0
WITHIN = 5.0  # [s] that half a request may be held
HALF = b"GET / HTTP/1.1\r\nHost: 127.0.0.1\r\nX-Begun: "


def connected(server) -> socket.socket:
    host, port = server.origin.removeprefix("http://").split(":")
    return socket.create_connection((host, int(port)), timeout=PATIENCE)


def closed(stream: socket.socket) -> bool:
    """Whether the other side has let a connection go."""
    stream.setblocking(False)
    try:
        return stream.recv(1) == b""
    except BlockingIOError:
        return False
    except OSError:
        return True


def asks(server) -> httpx.Client:
    return httpx.Client(base_url=server.origin, timeout=PATIENCE, trust_env=False)


def test_half_requests_are_dropped_and_the_page_answers_meanwhile(demo, say):
    began = time.monotonic()
    held, waits = [], []
    with asks(demo) as client:
        for number in range(400):
            held.append(connected(demo))
            held[-1].sendall(HALF if number % 2 else b"")
        last = time.monotonic()
        while not all(closed(stream) for stream in held):
            assert time.monotonic() - last < WITHIN, "held"
            asked = time.monotonic()
            assert client.get("/").status_code == 200
            waits.append(time.monotonic() - asked)
            time.sleep(0.1)
    for stream in held:
        stream.close()
    took = time.monotonic() - began
    say(f"400 half requests: all dropped {took:.1f} s after the first; the door answers within {max(waits):.2f} s")


def test_a_head_that_drips_is_dropped(demo):
    with connected(demo) as stream:
        began = time.monotonic()
        stream.sendall(HALF)
        while not closed(stream):
            assert time.monotonic() - began < WITHIN
            stream.setblocking(True)
            try:
                stream.sendall(b"x")
            except OSError:
                break
            time.sleep(0.2)


def test_a_head_without_end_is_dropped(demo):
    with connected(demo) as stream:
        stream.sendall(HALF)
        sent = 0
        try:
            while sent < 100 * connections.LARGEST_HEAD:
                sent += stream.send(b"x" * 2**16)
        except OSError:
            return
    raise AssertionError(f"{sent} bytes of a head were taken")


def test_what_has_been_answered_is_let_go(demo):
    """Without the key; also where more is sent after it."""
    host = demo.origin.removeprefix("http://").encode()
    for more in (b"", b"GET / HTTP/1.1\r\n", b"x"):
        with connected(demo) as stream:
            stream.sendall(b"GET / HTTP/1.1\r\nHost: " + host + b"\r\nContent-Length: 1000\r\n\r\n" + more)
            began = time.monotonic()
            while stream.recv(2**16):
                assert time.monotonic() - began < WITHIN
    with connected(demo) as stream:
        stream.sendall(b"POST / HTTP/1.1\r\nHost: " + host + b"\r\nContent-Length: 1000000\r\n\r\n")
        assert stream.recv(2**16).startswith(b"HTTP/1.1 403")
        while stream.recv(2**16):
            pass


@pytest.mark.long
def test_the_body_of_our_own_page_may_take_long_but_must_come(demo):
    token = demo.address.partition("token=")[2]
    with asks(demo) as client:
        page = client.get("/", params={"token": token}, follow_redirects=True).text
    prefix = re.search(r'prefix: "(/[\w-]{32})"', page)[1]
    upload = re.search(r"/_nicegui/client/[\w-]+/upload/\d+", page)
    head = f"POST {prefix}{upload[0] if upload else '/_nicegui_ws/socket.io/?EIO=4&transport=polling'} HTTP/1.1\r\n"
    head += f"Host: {demo.origin.removeprefix('http://')}\r\nOrigin: {demo.origin}\r\nContent-Length: 100\r\n\r\n"
    with connected(demo) as stream:
        stream.sendall(head.encode())
        began = time.monotonic()
        while not closed(stream):
            assert time.monotonic() - began < connections.NEXT_PIECE + WITHIN
            time.sleep(0.2)


@pytest.mark.skipif(
    not Path("/proc/self/fd").is_dir(), reason="counts the open files of a process, as Linux lists them"
)
def test_thousands_of_connections_leave_room_for_the_page(demo, say):
    files = Path(f"/proc/{demo.pid}/fd")
    before, most, waits = len(list(files.iterdir())), 0, []
    held = []
    try:
        with asks(demo) as client:
            for turn in range(20):
                held += [connected(demo) for _ in range(100)]
                for stream in held[:-400]:
                    stream.close()
                most = max(most, len(list(files.iterdir())))
                if turn % 4 == 3:
                    asked = time.monotonic()
                    assert client.get("/").status_code == 200
                    waits.append(time.monotonic() - asked)
    finally:
        for stream in held:
            stream.close()
    assert most < before + 2 * connections.MOST_WAITING
    say(f"2,000 connections: {most - before} files open at most, the door answers within {max(waits):.2f} s")
