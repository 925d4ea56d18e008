"""`zerorev recordings record`: a recorder of what a controller sends over RSI."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from zerorev.cli.common import FINE, Whole, check_outputs, recordings_app
from zerorev.report.words import terminal

__all__ = ["record_rsi"]


@recordings_app.command(name="record")
def record_rsi(
    *,
    output: Annotated[Path, Parameter(name=["--output", "-o"])],
    host: str = "127.0.0.1",
    port: Whole = 49152,
    seconds: float = 60.0,
    answer_type: str = "ImFree",
    wait: float = 60.0,
) -> int:
    """Record what a controller sends over RSI; every document is answered with its own counter and no correction.

    Ctrl-C ends it, and what came is written.

    Args:
        output: The capture (.xml.gz), which `recordings show` reads.
        host: Address to listen at; by default only this machine can reach it.
        port: UDP port, as in the controller's configuration.
        seconds: How long, counted from the first document.
        answer_type: SENTYPE of the controller's configuration.
        wait: How long to wait for the first document [s].
    """
    from zerorev.cell.recordings.recorder import is_loopback, record
    from zerorev.files.output import write_bytes

    check_outputs((output,))
    if not is_loopback(host):
        terminal.note(
            f"{host} can be reached from outside: whoever sends to it first is answered, and recorded as the controller"
        )

    def listening(at: str, on: int) -> None:
        terminal.note(f"listening at {at}, port {on}")

    found = record(host, port, seconds, answer_type=answer_type, wait=wait, listening=listening)
    write_bytes(output, found.capture)
    if found.interrupted:
        terminal.note("interrupted; what came until then is kept")
    terminal.say(f"{found.documents} documents, one per {found.cycle:g} ms; {found.lost} cycles lost")
    if found.ignored:
        terminal.say(f"{found.ignored} datagrams of others, or that are not documents, are left out")
    terminal.say(f"capture written to {output}")
    return FINE
