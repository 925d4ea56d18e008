"""Pages of HTML that are whole in themselves, from templates beside the code that fills them."""

from __future__ import annotations

import base64
from collections.abc import Callable
from typing import Any

from jinja2 import Environment, PackageLoader, StrictUndefined

__all__ = ["environment"]


def environment(package: str, finalize: Callable[[Any], Any] | None = None) -> Environment:
    """Where the templates of a package are filled: every value is escaped, and a name that is not given is an error.

    Args:
        package: in whose folder the templates lie.
        finalize: applied to each value before it is shown.
    """
    made = Environment(
        loader=PackageLoader(package, "."),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        finalize=finalize,
    )
    made.filters["base64"] = lambda data: base64.b64encode(data).decode("ascii")
    return made
