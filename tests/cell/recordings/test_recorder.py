"""The recorder against a controller in a thread: answers, lost cycles, other senders, and what is kept."""

from __future__ import annotations

import gzip
import socket
from dataclasses import replace

import numpy as np
import pytest

from oracles.rsi_peer import FIRST, Peer, document
from zerorev.cell.recordings.read import read_recording
from zerorev.cell.recordings.recorder import is_loopback, record
from zerorev.cli import main
from zerorev.errors import InputError


def recorded(peer, seconds=1.0, **options):
    """What is recorded of a peer that gets the address."""
    begun = []

    def listening(host, port):
        begun.append(replace(peer, address=(host, port)))
        begun.append(begun[0].start())

    found = record("127.0.0.1", 0, seconds, wait=5.0, listening=listening, **options)
    begun[1].join(20)
    assert not begun[1].is_alive()
    return found, begun[0]


def test_each_document_is_kept_and_answered_with_its_counter(tmp_path):
    found, peer = recorded(Peer(("", 0), 120))
    assert peer.echoed == [FIRST + 4 * n for n in range(120)]
    assert peer.answers[0] == f'<Sen Type="ImFree"><IPOC>{FIRST}</IPOC></Sen>'.encode()
    assert (found.documents, found.cycle, found.lost, found.ignored) == (120, 4.0, 0, 0)
    lines = gzip.decompress(found.capture).splitlines()
    assert lines[7].split() == document(FIRST + 28, 7).split()
    (tmp_path / "run.xml.gz").write_bytes(found.capture)
    read = read_recording(tmp_path / "run.xml.gz")
    assert np.allclose(read.time, 0.004 * np.arange(120))
    assert np.allclose(np.rad2deg(read.joints[:, 5]), 6 + np.arange(120) / 1000)


def test_cycles_that_are_lost_are_counted(tmp_path):
    found, _ = recorded(Peer(("", 0), 100, cycle=12, skip=frozenset({3, 50, 51})))
    assert (found.documents, found.cycle, found.lost) == (97, 12.0, 3)
    (tmp_path / "run.xml.gz").write_bytes(found.capture)
    assert read_recording(tmp_path / "run.xml.gz").findings[0].message.startswith("3 cycles of 12 ms are missing")


def test_others_are_left_out():
    noise = (b"", b"hello", document(1, 0)[:-6], document(1, 0) * 2, b"<Rob><IPOC>x</IPOC></Rob>")
    found, peer = recorded(Peer(("", 0), 40, noise=noise), answer_type="Mine")
    assert found.documents == 40
    assert found.ignored == 10
    assert peer.answers[0].startswith(b'<Sen Type="Mine">')
    assert gzip.decompress(found.capture).count(b"\n") == 40


def test_an_interrupt_keeps_what_came(monkeypatch):
    from zerorev.cell.recordings import recorder

    take = recorder._Taken.take

    def interrupted(self, *arguments):
        take(self, *arguments)
        if len(self.counters) == 20:
            raise KeyboardInterrupt

    monkeypatch.setattr(recorder._Taken, "take", interrupted)
    found, _ = recorded(Peer(("", 0), 20), seconds=60)
    assert found.interrupted
    assert gzip.decompress(found.capture).count(b"\n") == 20


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        ({"seconds": 0}, "--seconds"),
        ({"seconds": float("nan")}, "--seconds"),
        ({"seconds": 1e9}, "--seconds"),
        ({"port": 70_000}, "--port"),
        ({"host": "192.0.2.1"}, "cannot be listened at"),
        ({"host": "no such host"}, "is not an address"),
        ({"answer_type": "<x>"}, "--answer-type"),
        ({"wait": 0.05}, "no document came in 0.05 s"),
    ],
)
def test_what_cannot_be_recorded_is_one_message(arguments, says):
    with pytest.raises(InputError) as refused:
        record(**{"port": 0, "seconds": 1.0} | arguments)
    assert says in str(refused.value)


def test_a_port_that_is_taken():
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as other:
        other.bind(("127.0.0.1", 0))
        with pytest.raises(InputError, match="cannot be listened at"):
            record(port=other.getsockname()[1])


@pytest.mark.parametrize(
    ("host", "inside"),
    [("127.0.0.1", True), ("127.9.9.9", True), ("::1", True), ("localhost", True), ("0.0.0.0", False)],
)
def test_loopback(host, inside):
    assert is_loopback(host) == inside


@pytest.mark.parametrize(("host", "warned"), [("127.0.0.1", False), ("0.0.0.0", True)])
def test_the_command(tmp_path, capsys, host, warned):
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    capture = tmp_path / "run.xml.gz"
    # the first documents find nobody yet: the peer goes on at its pace
    thread = Peer(("127.0.0.1", port), 750, paced=True).start()
    code = main(["recordings", "record", "--host", host, "--port", str(port), "--seconds", "0.5", "-o", str(capture)])
    said = capsys.readouterr()
    assert code == 0
    assert ("can be reached from outside" in said.err) == warned
    assert f"capture written to {capture}" in said.out
    assert read_recording(capture).time.size > 20
    thread.join(20)


def test_the_command_writes_nothing_where_nothing_comes(tmp_path, capsys):
    code = main(["recordings", "record", "--port", "0", "--wait", "0.1", "-o", str(tmp_path / "run.xml.gz")])
    assert code == 2
    assert "no document came" in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == []


@pytest.mark.soak
def test_a_minute_at_4_ms_loses_nothing(record_property):
    found, peer = recorded(Peer(("", 0), 15_000, paced=True), seconds=60.5)
    record_property(
        "measured",
        f"RSI recorder, 60 s at 4 ms: {found.lost} cycles lost, {peer.late} of {peer.count} answers late, slowest "
        f"{peer.longest * 1e3:.2f} ms",
    )
    assert found.documents == 15_000
    assert found.lost == 0
