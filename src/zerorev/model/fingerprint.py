"""A fingerprint of nouns: equal for equal content, and for nothing else."""

from __future__ import annotations

import hashlib
import struct
from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from functools import cached_property

import numpy as np

__all__ = ["Digested", "fingerprint"]

_FLOAT = struct.Struct("<d")


class Digested:
    """A dataclass with arrays: it is compared by its fingerprint, which is computed once."""

    @cached_property
    def digest(self) -> str:
        """64 hexadecimal digits."""
        pieces: list[bytes] = []
        _add_fields(self, pieces)
        return hashlib.sha256(b"".join(pieces)).hexdigest()

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Digested) and self.digest == other.digest

    def __hash__(self) -> int:
        return hash(self.digest)


def fingerprint(*things: object) -> str:
    """64 hexadecimal digits (SHA-256) of all that is in some nouns, in order; floats count to the last bit.

    Args:
        things: dataclasses, tuples, mappings and arrays of numbers, texts and None.

    Raises:
        TypeError: something else in them.
    """
    pieces: list[bytes] = []
    _add(things, pieces)
    return hashlib.sha256(b"".join(pieces)).hexdigest()


def _add(thing: object, pieces: list[bytes]) -> None:
    """Bytes that tell a thing from every other: its kind and its size go before its content."""
    if thing is None or isinstance(thing, bool | int):
        pieces.append(f"{thing!r};".encode())
    elif isinstance(thing, float):
        pieces.append(b"f" + _FLOAT.pack(thing))
    elif isinstance(thing, str):
        text = thing.encode("utf-8", "surrogatepass")
        pieces.append(b"s%d:" % len(text) + text)
    elif isinstance(thing, np.ndarray):
        pieces.append(f"a{thing.dtype.str}{thing.shape}:".encode() + thing.tobytes())
    elif isinstance(thing, np.generic):
        _add(thing.item(), pieces)
    elif isinstance(thing, tuple | list):
        pieces.append(b"t%d:" % len(thing))
        for each in thing:
            _add(each, pieces)
    elif isinstance(thing, Mapping):
        _add(tuple(sorted(thing.items())), pieces)
    elif isinstance(thing, Digested):
        _add((type(thing).__qualname__, thing.digest), pieces)
    elif is_dataclass(thing):
        _add_fields(thing, pieces)
    else:
        raise TypeError(f"no fingerprint of a {type(thing).__name__}")


def _add_fields(thing: object, pieces: list[bytes]) -> None:
    _add(type(thing).__qualname__, pieces)
    assert is_dataclass(thing)
    for field in fields(thing):
        _add(getattr(thing, field.name), pieces)
