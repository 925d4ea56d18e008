"""The Python reference of nouns whose attributes are stated once: an extension of griffe, which reads no code.

What an attribute is stands in its annotation (`zerorev.model.stated`), and goes into the docstring when the class is
made. So the docstring is taken from the class itself, and the type without the statement.
"""

from __future__ import annotations

from typing import Any

import griffe


class StatedAttributes(griffe.Extension):
    """Takes docstrings of classes with stated attributes from the classes."""

    def on_class(self, *, cls: griffe.Class, **_: Any) -> None:
        """Look at one class."""
        stated = [member for member in cls.members.values() if _is_stated(member)]
        if not stated:
            return
        cls.docstring = griffe.Docstring(griffe.dynamic_import(cls.path).__doc__, parent=cls)
        for member in stated:
            member.annotation = member.annotation.slice.elements[0]


def _is_stated(member: Any) -> bool:
    annotation = getattr(member, "annotation", None)
    return isinstance(annotation, griffe.ExprSubscript) and str(annotation.left) == "Annotated"
