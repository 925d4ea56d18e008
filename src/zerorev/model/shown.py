"""Nouns that a notebook shows as HTML.

How they look is the matter of the report, which lies above the model: the package registers it when it is imported.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

__all__ = ["Shown", "register"]

_look: Callable[[Any], str] | None = None


def register(look: Callable[[Any], str]) -> None:
    """Say how the nouns look.

    Args:
        look: the HTML of a noun.
    """
    global _look
    _look = look


class Shown:
    """A noun that notebooks show by itself."""

    def _repr_html_(self) -> str | None:
        """HTML, or None where nothing says how: then a notebook shows the `repr`."""
        return None if _look is None else _look(self)
