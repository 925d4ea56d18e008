"""A recording out of a file in any of the formats that are read."""

from __future__ import annotations

from pathlib import Path

from zerorev.cell.recordings.channels import NO_MAPPING, Mapping
from zerorev.cell.recordings.krc4 import is_trace, read_krc4
from zerorev.cell.recordings.rsi import read_rsi
from zerorev.cell.recordings.table import read_csv
from zerorev.errors import InputError
from zerorev.files.text import opened
from zerorev.model.recording import Recording

__all__ = ["FORMATS", "read_recording"]

FORMATS = "a KRC4 trace (.dat and .r64), an RSI capture (.xml, .xml.gz), or a table (.csv)"


def read_recording(path: str | Path, mapping: Mapping = NO_MAPPING) -> Recording:
    """A recording out of a KRC4 trace, an RSI capture or a CSV file, whichever it is.

    Args:
        path: the file; of a trace any .dat or .r64, or the common beginning of their names.
        mapping: what the user says of the channels.

    Raises:
        InputError: none of these, or one that is wrong; the message names the line, document or byte.
    """
    path = Path(path)
    if is_trace(path):
        return read_krc4(path, mapping)
    with opened(path, FORMATS) as stream:
        begin = stream.read(512)
    if begin.startswith(b"\x1f\x8b") or begin.lstrip(b"\xef\xbb\xbf \t\r\n").startswith(b"<"):
        return read_rsi(path, mapping)
    if not begin.strip():
        raise InputError("is empty", where=str(path), accepted=FORMATS)
    return read_csv(path, mapping)
