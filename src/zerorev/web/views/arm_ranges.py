"""What each parameter of the arm may be, and what that rests on: a table in a dialog."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from html import escape

from nicegui import ui

from zerorev.cell.possible import held_for
from zerorev.model.ranges import HELD, Cell, Range
from zerorev.model.tool import Tool
from zerorev.web.session import Session
from zerorev.web.views.fields import form

__all__ = ["ranges_dialog", "ranges_table"]

BASES = {"prior": "a guess", "fitted": "fitted to recordings", "conditioned": "narrowed by a recording"}
HEADS = ("parameter", "what it is", "from", "to", "rests on", "source")


def ranges_dialog(session: Session) -> Callable[[], None]:
    """A table of the ranges.

    Args:
        session: of what is known of its arm.
    """
    dialog, card, _ = form("What is known of the arm", "arm-ranges-form", wide=True)
    with card:
        table = ui.html(sanitize=False).classes("zr-sheet-box zr-arm-ranges")
        with ui.element("div").classes("zr-ends"):
            ui.button("Close", on_click=dialog.close, color=None).classes("zr-quiet").props(
                'flat no-caps data-testid="arm-ranges-close"'
            )

    def opened() -> None:
        if session.state.job is not None:
            table.set_content(ranges_table(session.state.arm.cell, session.state.job.tool))
            dialog.open()

    return opened


def ranges_table(cell: Cell, tool: Tool) -> str:
    """The table; what is measured comes first, and what is held at one value last.

    Args:
        cell: what is known.
        tool: whose file may state its mass.
    """
    stated = held_for(tool, cell)
    rows = sorted(cell.ranges.items(), key=lambda each: (each[0] in (*HELD, *stated), each[1].basis == "prior"))
    body = "".join(_row(name, each, stated) for name, each in _of_all_joints(dict(rows)))
    heads = "".join(f"<th>{head}</th>" for head in HEADS)
    return f'<table class="zr-sheet"><thead><tr>{heads}</tr></thead><tbody>{body}</tbody></table>'


def _of_all_joints(ranges: Mapping[str, Range]) -> Iterator[tuple[str, Range]]:
    """The ranges by their names; those of the six joints as one, where they are the same."""
    for name, each in ranges.items():
        stem, joint = name[:-1], name[-1]
        six = [f"{stem}{number}" for number in range(1, 7)]
        alike = joint.isdigit() and all(ranges[other] == each for other in six)
        if not alike:
            yield name, each
        elif joint == "1":
            yield f"{six[0]} to {six[-1]}", each


def _row(name: str, each: Range, stated: tuple[str, ...]) -> str:
    if name in stated:
        ends, rests = ("", ""), "the tool's file states it"
    elif name in HELD:
        ends, rests = (f"{each.nominal:g}", f"{each.nominal:g}"), "held here"
    else:
        ends, rests = (f"{each.low:.4g}", f"{each.high:.4g}"), BASES[each.basis]
    source = "" if each.source == BASES["prior"] else each.source  # as it rests on, or not drawn from at all
    cells = (name, each.means, *ends, rests, source)
    return f"<tr>{''.join(f'<td>{escape(cell)}</td>' for cell in cells)}</tr>"
