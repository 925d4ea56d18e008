"""A part of a job that is drilled again: from a hole on, or some holes alone."""

from __future__ import annotations

from collections.abc import Sequence

from zerorev.errors import InputError
from zerorev.model.finding import Finding
from zerorev.model.plan import HolePlan, Plan, named_holes

__all__ = ["Selection", "number_of", "selection"]

MOST_IDS = 6  # named in a message


class Selection:
    """Which holes of a plan are wanted.

    Attributes:
        ids: of the holes, as they are drilled; None: all.
        name: of the plan, and which part of it.
        findings: says that it is a part.
    """

    def __init__(self, plan: Plan, ids: Sequence[str] | None, end: str = "", words: str = "") -> None:
        """Make it.

        Args:
            plan: of which.
            ids: see above.
            end: of the name.
            words: which part.
        """
        self.ids, self.name = ids, plan.name + end
        message = "" if ids is None else f"only {len(ids):,} of {len(plan.holes):,} holes are wanted: {words}"
        self.findings = (Finding("info", "incomplete", message),) if message else ()


def selection(plan: Plan, start: str | None = None, only: Sequence[str] | None = None) -> Selection:
    """The holes of a plan from one on, or some alone.

    Args:
        plan: whose.
        start: id of the first one, in the order in which they are drilled; None: the first of all.
        only: ids of all; None: all.

    Raises:
        InputError: an id that the plan does not have; both.
    """
    if start is not None and only is not None:
        raise InputError("stands beside only", where="from", accepted="one of the two")
    if start is not None:
        number = number_of(plan, start, "from")
        in_order = [hole.hole.id for hole in plan.in_order if hole.motion is not None or hole.hole.id == start]
        rest = in_order[in_order.index(start) :]
        return Selection(plan, rest, f"_from_{number}", f"hole {start} and those after it")
    if only is not None:
        numbers = sorted({number_of(plan, hole_id, "only") for hole_id in only})
        if not numbers:
            raise InputError("names no hole", where="only", accepted=_ids(plan))
        ids = [hole.hole.id for hole in plan.in_order if hole.hole.id in set(only)]
        return Selection(plan, ids, "_only_" + "_".join(map(str, numbers)), named_holes(ids))
    return Selection(plan, None)


def number_of(plan: Plan, hole_id: str, where: str) -> int:
    """The number of a hole in a plan's list, from 1.

    Raises:
        InputError: there is none of this id.
    """
    for number, hole in enumerate(plan.holes, start=1):
        if hole.hole.id == hole_id:
            return number
    raise InputError(f"no hole is called '{hole_id}'", where=where, accepted=_ids(plan))


def _ids(plan: Plan) -> str:
    holes: tuple[HolePlan, ...] = plan.in_order
    more = f" and {len(holes) - MOST_IDS:,} more" if len(holes) > MOST_IDS else ""
    return f"ids of the plan: {', '.join(hole.hole.id for hole in holes[:MOST_IDS])}{more}"
