"""A controller at the other end of RSI: sends documents in its cycle, and judges the answers."""

from __future__ import annotations

import re
import socket
import threading
import time
from dataclasses import dataclass, field

FIRST = 4208163634


def document(counter: int, n: int) -> bytes:
    axes = " ".join(f'A{k}="{k + n / 1000}"' for k in range(1, 7))
    tip = f'X="{400 + n / 10}" Y="0.0" Z="500.0" A="0.0" B="90.0" C="0.0"'
    return (
        f'<Rob Type="KUKA">\r\n<RIst {tip} /><RSol {tip} />\n<AIPos {axes} /><ASPos {axes} />'
        f'<Delay D="0" /><IPOC>{counter}</IPOC></Rob>'
    ).encode()


@dataclass
class Peer:
    """What a controller sends, and what it got.

    Attributes:
        address: of the recorder.
        count: documents.
        cycle: [ms] between them, by the counter.
        skip: which documents are lost on the way.
        paced: whether they are sent at their time, or each after the answer to the one before.
        noise: datagrams from elsewhere and of other kinds that are sent between.
    """

    address: tuple[str, int]
    count: int
    cycle: int = 4
    skip: frozenset[int] = frozenset()
    paced: bool = False
    noise: tuple[bytes, ...] = ()
    answers: list[bytes] = field(default_factory=list)
    late: int = 0
    longest: float = 0.0

    def start(self) -> threading.Thread:
        thread = threading.Thread(target=self._run, daemon=True)
        thread.start()
        return thread

    def _run(self) -> None:
        with (
            socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as mine,
            socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as other,
        ):
            begin = time.monotonic()
            for n in range(self.count):
                if self.paced:
                    time.sleep(max(0.0, begin + n * self.cycle / 1e3 - time.monotonic()))
                if n in self.skip:
                    continue
                mine.settimeout(self.cycle / 1e3 if self.paced else 10)
                sent = time.monotonic()
                mine.sendto(document(FIRST + self.cycle * n, n), self.address)
                try:
                    self.answers.append(mine.recv(65_535))
                    self.longest = max(self.longest, time.monotonic() - sent)
                except TimeoutError:
                    self.late += 1
                for data in self.noise if n == self.count // 2 else ():
                    mine.sendto(data, self.address)
                    other.sendto(document(7, 0), self.address)

    @property
    def echoed(self) -> list[int]:
        """The counters of the answers."""
        return [int(re.fullmatch(rb'<Sen Type="\w+"><IPOC>(\d+)</IPOC></Sen>', each)[1]) for each in self.answers]
