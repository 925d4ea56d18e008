"""A fingerprint of nouns: equal for equal content, and for nothing else."""

from __future__ import annotations

import hashlib
import struct
from collections.abc import Iterator, Mapping
from dataclasses import fields, is_dataclass

import numpy as np

__all__ = ["fingerprint"]


def fingerprint(*things: object) -> str:
    """64 hexadecimal digits (SHA-256) of all that is in some nouns, in order; floats count to the last bit.

    Args:
        things: dataclasses, tuples, mappings and arrays of numbers, texts and None.

    Raises:
        TypeError: something else in them.
    """
    found = hashlib.sha256()
    for piece in _pieces(things):
        found.update(piece)
    return found.hexdigest()


def _pieces(thing: object) -> Iterator[bytes]:
    """Bytes that tell a thing from every other: its kind and its size go before its content."""
    if thing is None or isinstance(thing, bool | int):
        yield f"{thing!r};".encode()
    elif isinstance(thing, float):
        yield b"f" + struct.pack("<d", thing)
    elif isinstance(thing, str):
        text = thing.encode("utf-8", "surrogatepass")
        yield b"s%d:" % len(text) + text
    elif isinstance(thing, np.ndarray):
        yield f"a{thing.dtype.str}{thing.shape}:".encode() + thing.tobytes()
    elif isinstance(thing, np.generic):
        yield from _pieces(thing.item())
    elif isinstance(thing, tuple | list):
        yield b"t%d:" % len(thing)
        for each in thing:
            yield from _pieces(each)
    elif isinstance(thing, Mapping):
        yield from _pieces(tuple(sorted(thing.items())))
    elif is_dataclass(thing):
        yield from _pieces(type(thing).__qualname__)
        for field in fields(thing):
            yield from _pieces(getattr(thing, field.name))
    else:
        raise TypeError(f"no fingerprint of a {type(thing).__name__}")
