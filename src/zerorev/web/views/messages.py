"""What the long work came to: a line that stays until it is closed or other work begins."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from nicegui import ui

from zerorev.web.session import Session
from zerorev.web.state import State

__all__ = ["messages"]


def messages(session: Session) -> None:
    """Draw why the last work came to nothing, and what the last work on many holes came to; each until it is closed.

    Args:
        session: whose work it was.
    """
    trouble = _message(session, "trouble", "alert", "error_outline")
    outcome = _message(session, "outcome", "status", "task_alt")

    def draw(state: State) -> None:
        trouble(state.trouble)
        outcome(state.outcome)

    draw(session.state)
    session.watch(lambda before, after: draw(after))


def _message(session: Session, name: str, role: str, icon: str) -> Callable[[str | None], None]:
    """A message that can be closed; what sets its text, or takes it away."""

    def close() -> None:
        state = session.state
        session.change(replace(state, trouble=None) if name == "trouble" else replace(state, outcome=None))

    with ui.element("div").classes(f"zr-message zr-{name}").props(f'role="{role}" data-testid="{name}"') as row:
        ui.icon(icon).props('aria-hidden="true"')
        text = ui.label()
        ui.button(icon="close", on_click=close).props('flat round dense aria-label="close the message"')

    def show(words: str | None) -> None:
        row.set_visibility(words is not None)
        text.set_text(words or "")

    return show
