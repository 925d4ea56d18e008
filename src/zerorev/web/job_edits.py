"""How the job of a page changes: holes are answered, added, changed, taken out; each makes another state."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from types import MappingProxyType

from zerorev.errors import InputError
from zerorev.model.hole import Hole
from zerorev.model.job import Settings
from zerorev.model.plan import HolePlan, Strokes
from zerorev.web.of_tools import check_own_holes
from zerorev.web.state import NONE, State, caution_of, selected

__all__ = ["answered", "with_cell", "with_hole", "with_holes", "with_settings", "without_hole"]


def answered(state: State, *answers: HolePlan, strokes: Strokes = "asked") -> State:
    """Holes have been answered; an edited motion of them is let go.

    Answers of another kind of strokes are dropped; where the deepest strokes were asked for, the holes become as deep.
    Answers of holes that are gone, or have changed since, are not taken.
    """
    if state.job is None:
        return state
    asked = {hole.id: hole for hole in state.job.holes}
    fresh = {
        each.hole.id: each for each in answers if each.hole.id in asked and _same(each, asked[each.hole.id], strokes)
    }
    kept = state.answers if strokes == state.strokes else NONE
    job = state.job
    if strokes == "deepest" and fresh:
        deep = {key: each.hole for key, each in fresh.items() if each.hole.profile is None}  # not those kept by hand
        job = replace(job, holes=tuple(deep.get(hole.id, hole) for hole in job.holes))
    edited = None if state.selected in fresh else state.steered
    return replace(state, job=job, answers=MappingProxyType({**kept, **fresh}), strokes=strokes, steered=edited)


def with_hole(state: State, hole: Hole, instead_of: str | None = None) -> State:
    """A hole is added, or takes the place of one, whose answer goes with it; it is selected.

    Raises:
        InputError: nothing is opened yet, another hole has this id, or several tools drill the holes, of which then the
            branch alone can be changed.
    """
    if state.job is None:
        raise InputError("nothing is opened", where="hole", accepted="a job, opened before")
    old = state.job.holes
    before = next((each for each in old if each.id == instead_of), None)
    if before is None or before.id != hole.id or not _same_place(before, hole) or before.depth != hole.depth:
        check_own_holes(state)
    holes = (*old, hole) if instead_of is None else tuple(hole if each.id == instead_of else each for each in old)
    answers = {key: value for key, value in state.answers.items() if key not in (instead_of, hole.id)}
    return replace(
        state, job=replace(state.job, holes=holes), answers=MappingProxyType(answers), selected=hole.id, steered=None
    )


def with_cell(state: State, cell: int) -> State:
    """The hole of a cell of the map is added to the job, or is there already; it is selected.

    Args:
        state: with a map.
        cell: its number in the slice that is shown.

    Raises:
        InputError: no such cell, or one that cannot be drilled, and why.
    """
    if state.cells is None or state.job is None:
        raise InputError("no map is shown", where="cell", accepted="a cell of a map")
    hole = state.cells.hole(cell, state.job.holes[0].depth if state.hole is None else state.hole.depth)
    there = next((each for each in state.job.holes if each.id == hole.id), None)
    if there is not None and there.depth == hole.depth:
        return selected(state, hole.id)
    return with_hole(state, hole, None if there is None else hole.id)


def with_holes(state: State, holes: Sequence[Hole]) -> State:
    """Holes are added, as out of a table; the first of them is selected.

    Raises:
        InputError: nothing is opened yet, no hole is given, two holes have the same id, or several tools drill them.
    """
    if state.job is None or not holes:
        raise InputError("there is nothing to add", where="holes", accepted="one hole or more, to a job opened before")
    check_own_holes(state)
    job = replace(state.job, holes=(*state.job.holes, *holes))
    return replace(state, job=job, selected=holes[0].id, steered=None, caution=caution_of(job))


def without_hole(state: State, hole: str) -> State:
    """A hole is taken out, its neighbour selected.

    Raises:
        InputError: it is the last one, or several tools drill it.
    """
    if state.job is None:
        return state
    check_own_holes(state)
    at = next((n for n, each in enumerate(state.job.holes) if each.id == hole), None)
    if at is None:
        return state
    holes = state.job.holes[:at] + state.job.holes[at + 1 :]
    if not holes:
        raise InputError("the last hole cannot be taken out", where="hole", accepted="a job of one hole or more")
    answers = {key: value for key, value in state.answers.items() if key != hole}
    beside = holes[min(at, len(holes) - 1)].id if state.selected == hole else state.selected
    return replace(
        state, job=replace(state.job, holes=holes), answers=MappingProxyType(answers), selected=beside, steered=None
    )


def with_settings(state: State, settings: Settings) -> State:
    """The job is planned by other settings, so that no answer holds any more."""
    if state.job is None or settings == state.job.settings:
        return state
    return replace(state, job=replace(state.job, settings=settings), answers=NONE, steered=None)


def _same(answer: HolePlan, asked: Hole, strokes: Strokes) -> bool:
    """Whether an answer is of this very hole, but for the depth where the deepest was asked for."""
    hole = answer.hole
    by_hand = hole.profile is not None and asked.profile is None
    return (
        _same_place(hole, asked)
        and (strokes == "deepest" or hole.depth == asked.depth)
        and (by_hand or hole.branch == asked.branch)
    )


def _same_place(one: Hole, other: Hole) -> bool:
    """Whether two holes have the same target and direction, and count their spins alike."""
    return (
        bool((one.target == other.target).all())
        and bool((one.direction == other.direction).all())
        and bool((one.psi_zero == other.psi_zero).all())
    )
