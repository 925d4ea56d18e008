"""Numbers that stand in an array, as they are stated (`zerorev.model.stated`); the noun checks them itself."""

from __future__ import annotations

from zerorev.model.stated import Number

__all__ = ["Tensor", "Three"]


class Three(Number):
    """Three numbers, in an array, shape (3,)."""

    what = "three numbers"


class Tensor(Number):
    """A symmetric tensor, shape (3, 3), which a file has as six numbers."""

    what = "six numbers"
