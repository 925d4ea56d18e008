"""Records what a controller sends over RSI: each document is kept, and answered within its cycle without a correction.

It never moves a robot: the answer holds the controller's own counter and nothing else.
"""

from __future__ import annotations

import gzip
import io
import ipaddress
import re
import socket
import time
from collections.abc import Callable
from dataclasses import dataclass

from zerorev.cell.recordings.rsi import END, MAX_DOCUMENT, MAX_DOCUMENTS, lost_cycles
from zerorev.errors import InputError

__all__ = ["Recorded", "is_loopback", "record"]

WAIT = 60.0  # [s] for the first document
LONGEST = 1800.0  # [s]
PATIENCE = 0.25  # [s] between examinations of the clock while nothing arrives
_COUNTER = re.compile(rb"<IPOC>\s*(\d{1,15})\s*</IPOC>")
_TYPE = re.compile(r"\w{1,40}", re.ASCII)


@dataclass(frozen=True)
class Recorded:
    """What was recorded.

    Attributes:
        capture: the documents, one per line, in gzip.
        documents: how many.
        cycle: of the controller [ms]; 0 of fewer than two documents.
        lost: cycles that are missing by the controller's counter.
        ignored: datagrams of other senders, or that are not documents.
        interrupted: whether it was ended before its time.
    """

    capture: bytes
    documents: int
    cycle: float
    lost: int
    ignored: int
    interrupted: bool


def is_loopback(host: str) -> bool:
    """Whether only this machine can reach an address."""
    try:
        return ipaddress.ip_address(host).is_loopback
    except ValueError:
        return host == "localhost"


def record(
    host: str = "127.0.0.1",
    port: int = 49152,
    seconds: float = 60.0,
    *,
    answer_type: str = "ImFree",
    wait: float = WAIT,
    listening: Callable[[str, int], None] = lambda host, port: None,
) -> Recorded:
    """Record for a while, counted from the first document; an interrupt ends it, and what came is kept.

    Args:
        host: address to listen at.
        port: UDP port, 0 for any that is free.
        seconds: how long.
        answer_type: what the controller's configuration has as SENTYPE.
        wait: for the first document [s].
        listening: called with the address and the port once it listens.

    Raises:
        InputError: the address cannot be listened at, an argument out of range, or no document came.
    """
    if not 0 < seconds <= LONGEST:
        raise InputError(f"{seconds:g} s", where="--seconds", accepted=f"above 0, {LONGEST:g} at most")
    if not _TYPE.fullmatch(answer_type):
        raise InputError(f"'{answer_type}'", where="--answer-type", accepted="letters and digits, as SENTYPE has them")
    with _socket(host, port) as channel:
        listening(*channel.getsockname()[:2])
        taken = _Taken(f'<Sen Type="{answer_type}"><IPOC>%b</IPOC></Sen>'.encode())
        interrupted = False
        try:
            _listen(channel, taken, seconds, wait)
        except KeyboardInterrupt:
            if not taken.counters:
                raise
            interrupted = True
    if not taken.counters:
        beside = f"; {taken.ignored} datagrams were not documents" if taken.ignored else ""
        raise InputError(
            f"no document came in {wait:g} s{beside}", where=f"{host}:{port}", accepted="a controller that sends RSI"
        )
    cycle, lost = lost_cycles(taken.counters)
    return Recorded(taken.finished(), len(taken.counters), cycle, lost, taken.ignored, interrupted)


class _Taken:
    """What came so far."""

    def __init__(self, answer: bytes) -> None:
        self.counters: list[int] = []
        self.ignored = 0
        self._answer = answer
        self._sender: object = None
        self._bytes = io.BytesIO()
        # little work in each cycle, and the same bytes for the same documents
        self._packed = gzip.GzipFile(fileobj=self._bytes, mode="wb", compresslevel=1, mtime=0)

    def take(self, data: bytes, sender: object, channel: socket.socket) -> None:
        """Answer a document, then keep it."""
        document = data.strip()
        counter = _COUNTER.search(document)
        known = self._sender is None or sender == self._sender
        whole = document.startswith(b"<Rob") and document.endswith(END) and document.count(END) == 1
        if counter is None or not known or not whole:
            self.ignored += 1
            return
        channel.sendto(self._answer % counter[1], sender)  # type: ignore[call-overload]
        self._sender = sender
        self.counters.append(int(counter[1]))
        self._packed.write(b" ".join(document.split(b"\n")).replace(b"\r", b" ") + b"\n")

    def finished(self) -> bytes:
        """The capture."""
        self._packed.close()
        return self._bytes.getvalue()


def _listen(channel: socket.socket, taken: _Taken, seconds: float, wait: float) -> None:
    end = time.monotonic() + wait
    while len(taken.counters) < MAX_DOCUMENTS:
        left = end - time.monotonic()
        if left <= 0:
            return
        channel.settimeout(min(left, PATIENCE))
        try:
            data, sender = channel.recvfrom(MAX_DOCUMENT)
        except TimeoutError:
            continue
        except ConnectionResetError:  # an earlier answer found nobody
            continue
        first = not taken.counters
        taken.take(data, sender, channel)
        if first and taken.counters:
            end = time.monotonic() + seconds


def _socket(host: str, port: int) -> socket.socket:
    if not 0 <= port <= 65_535:
        raise InputError(f"{port}", where="--port", accepted="0 to 65535")
    try:
        (family, kind, protocol, _, address), *_ = socket.getaddrinfo(host, port, type=socket.SOCK_DGRAM)
        channel = socket.socket(family, kind, protocol)
    except (OSError, UnicodeError) as error:
        raise InputError(f"is not an address: {error}", where=f"--host {host}", accepted="e.g. 127.0.0.1") from None
    try:
        channel.bind(address)
    except OSError as error:
        channel.close()
        why = error.strerror or str(error)
        raise InputError(
            f"cannot be listened at: {why}", where=f"{host}:{port}", accepted="an address of this machine, a free port"
        ) from None
    return channel
