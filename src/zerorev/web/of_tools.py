"""Jobs of several tools in a page: one of them is shown at a time, with answers of its own; the holes are shared."""

from __future__ import annotations

from dataclasses import replace
from types import MappingProxyType

from zerorev.errors import InputError
from zerorev.model.plan import Plan
from zerorev.web.state import State, plan_of, selected

__all__ = ["check_own_holes", "tool_names", "whole_plan", "with_tool"]


def with_tool(state: State, number: int) -> State:
    """Another tool of the job is shown, from 0, with the same hole; what was found for the others is kept.

    Raises:
        InputError: there is no such tool.
    """
    tools = _each(state)
    if not 0 <= number < len(tools):
        raise InputError(f"no tool {number + 1}", where="tool", accepted=f"1 to {len(tools)}")
    if number == state.tool:
        return state
    arm = replace(tools[number].arm, cell=state.arm.cell, file=state.arm.file)
    found = replace(tools[number], tools=tools, tool=number, meshes=state.meshes, arm=arm)
    return found if state.selected is None else selected(found, state.selected)


def tool_names(state: State) -> list[str]:
    """The tools of a job of several, as the page calls them."""
    return [f"tool {n}: {each.job.tool.name}" for n, each in enumerate(state.tools, 1) if each.job is not None]


def check_own_holes(state: State) -> None:
    """Refuse to change the holes of a job of several tools: all of them drill these.

    Raises:
        InputError: it has several.
    """
    if state.tools:
        what = f"its holes are those of {len(state.tools)} tools, and the page changes one"
        raise InputError(what, where="job", accepted="other holes in the job's file, which is then opened again")


def whole_plan(state: State) -> Plan:
    """The plan of all tools, of the holes that have an answer for each of them; a finding says which have none.

    Raises:
        InputError: for some tool nothing is planned yet; some have their deepest strokes, and some those asked for.
    """
    if not state.tools:
        return plan_of(state)
    tools = _each(state)
    for number, each in enumerate(tools, 1):
        if not each.answers:
            what = f"nothing is planned for tool {number} yet"
            raise InputError(
                what, where="plan", accepted="a planned hole or more for each tool, which is chosen on top"
            )
    if len({each.strokes for each in tools}) > 1:
        what = "some tools have the strokes asked for, and some their deepest"
        raise InputError(what, where="plan", accepted="one of the two for all tools")
    common = set.intersection(*(set(each.answers) for each in tools))
    if not common:
        raise InputError("no hole is planned for all tools", where="plan", accepted="a hole planned for each of them")
    plans = [plan_of(_of_holes(each, common)) for each in tools]
    return replace(plans[0], further=tuple(plans[1:]))


def _each(state: State) -> tuple[State, ...]:
    """What the page shows of each tool, that of the tool that is shown as it is now."""
    now = replace(state, tools=(), tool=0, progress=None, trouble=None, outcome=None)
    return (*state.tools[: state.tool], now, *state.tools[state.tool + 1 :])


def _of_holes(state: State, ids: set[str]) -> State:
    return replace(state, answers=MappingProxyType({key: each for key, each in state.answers.items() if key in ids}))
