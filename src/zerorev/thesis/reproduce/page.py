"""The page: one HTML file with everything in it, which opens from disk with no network."""

from __future__ import annotations

from collections.abc import Sequence
from importlib.metadata import version

from zerorev.report.figures.style import CANNOT_RUN, REVERSAL_COLOURS
from zerorev.report.templates import environment
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
    robot = f"{context.robot.manufacturer} {context.robot.model}".strip() or context.robot.name
    keys = [*((str(n), colour) for n, colour in enumerate(REVERSAL_COLOURS[:-1])), ("6+", REVERSAL_COLOURS[-1])]
    return (
        environment("zerorev.thesis.reproduce")
        .get_template("page.html.j2")
        .render(
            version=version("zerorev"),
            robot=robot,
            seeds=context.seeds,
            few=context.few,
            map_size=context.map_size,
            made=made,
            colours=[*keys, ("cannot be run", CANNOT_RUN)],
        )
    )
