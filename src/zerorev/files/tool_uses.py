"""The tools that drill the holes of a job one after the other: what each has of its own, and what is the job's."""

from __future__ import annotations

from dataclasses import replace

from zerorev.errors import InputError
from zerorev.files.conversion import cycle_from
from zerorev.files.schema import JobFile, ToolUseForm
from zerorev.files.text import Document
from zerorev.files.units import m, mm, plain
from zerorev.model.hole import Hole
from zerorev.model.job import Job

__all__ = ["used", "uses_of"]


def uses_of(form: JobFile, document: Document) -> list[tuple[tuple[str | int, ...], ToolUseForm]]:
    """Where each tool of a job stands in it, and how it is used.

    Raises:
        InputError: there is no tool, or `tool` stands beside `tools`.
    """
    if (form.tool is None) == (form.tools is None):
        what = "is missing" if form.tool is None else "stands beside tools"
        raise InputError(what, where=document.where(("tool",)), accepted="a tool, or tools: a list of them")
    if form.tools is not None:
        return [(("tools", n), use) for n, use in enumerate(form.tools)]
    return [((), ToolUseForm.model_construct(tool=form.tool))]


def used(job: Job, use: ToolUseForm) -> Job:
    """A job as one of several tools drills it: with its own number, feeds, cycle and depth where it states any.

    Raises:
        InputError: they do not fit to the job.
    """
    usual, feeds = job.settings, use.feed_mm_s
    settings = replace(
        usual,
        tool_number=usual.tool_number if use.tool_number is None else use.tool_number,
        feed_plunge=usual.feed_plunge if feeds.plunge is None else float(m(feeds.plunge)),
        feed_retract=usual.feed_retract if feeds.retract is None else float(m(feeds.retract)),
        cycle=usual.cycle if use.cycle is None else cycle_from(use.cycle),
    )
    holes = job.holes
    if use.cycle is not None:
        holes = tuple(replace(hole, cycle=None) for hole in holes)
    if use.depth_mm is not None:
        holes = tuple(_as_deep(hole, float(m(use.depth_mm))) for hole in holes)
    return replace(job, settings=settings, holes=holes)


def _as_deep(hole: Hole, depth: float) -> Hole:
    """The hole with another depth, from where it begins; a motion that is given with it is for its own depth.

    Raises:
        InputError: a motion is given.
    """
    if hole.profile is not None:
        raise InputError(f"hole {hole.id} has a given motion", where="depth_mm", accepted="null")
    target = m(plain(mm(hole.target + (depth - hole.depth) * hole.direction)))
    return replace(hole, target=target, depth=depth)
