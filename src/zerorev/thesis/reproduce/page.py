"""The page: one HTML file with everything in it, which opens from disk with no network."""

from __future__ import annotations

import base64
from collections.abc import Sequence
from importlib.metadata import version

from jinja2 import Environment, PackageLoader, StrictUndefined

from zerorev.report.figures.style import CANNOT_RUN, REVERSAL_COLOURS
from zerorev.thesis.reproduce.chapters import Part
from zerorev.thesis.reproduce.context import Context
from zerorev.thesis.reproduce.section import Section

__all__ = ["page"]


def page(context: Context, made: Sequence[tuple[Part, Section]]) -> str:
    """The whole page as HTML; the same sections make the same bytes.

    Args:
        context: they were made with.
        made: each part with its section, in order.
    """
    environment = Environment(
        loader=PackageLoader("zerorev.thesis.reproduce", "."),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters["base64"] = lambda data: base64.b64encode(data).decode("ascii")
    robot = f"{context.robot.manufacturer} {context.robot.model}".strip() or context.robot.name
    keys = [*((str(n), colour) for n, colour in enumerate(REVERSAL_COLOURS[:-1])), ("6+", REVERSAL_COLOURS[-1])]
    return environment.get_template("page.html.j2").render(
        version=version("zerorev"),
        robot=robot,
        seeds=context.seeds,
        few=context.few,
        map_size=context.map_size,
        made=made,
        colours=[*keys, ("cannot be run", CANNOT_RUN)],
    )
