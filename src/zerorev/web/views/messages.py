"""What the long work came to, and what is probably wrong with the job: lines that stay until they are closed."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

from nicegui import ui

from zerorev.web.session import Session
from zerorev.web.state import State

__all__ = ["messages"]


def messages(session: Session) -> None:
    """Draw why the last work came to nothing, what the last work on many holes came to, and what may be wrong.

    Each stays until it is closed.

    Args:
        session: whose work it was.
    """
    trouble = _message(session, "trouble", "alert", "error_outline")
    outcome = _message(session, "outcome", "status", "task_alt")
    caution = _message(session, "caution", "status", "warning_amber")

    def draw(state: State) -> None:
        trouble(state.trouble)
        outcome(state.outcome)
        caution(state.caution)

    draw(session.state)
    session.watch(lambda before, after: draw(after))


def _message(session: Session, name: str, role: str, icon: str) -> Callable[[str | None], None]:
    """A message that can be closed; what sets its text, or takes it away."""

    def close() -> None:
        closed: dict[str, Any] = {name: None}
        session.change(replace(session.state, **closed))

    with ui.element("div").classes(f"zr-message zr-{name}").props(f'role="{role}" data-testid="{name}"') as row:
        ui.icon(icon).props('aria-hidden="true"')
        text = ui.label()
        ui.button(icon="close", on_click=close).props('flat round dense aria-label="close the message"')

    def show(words: str | None) -> None:
        row.set_visibility(words is not None)
        text.set_text(words or "")

    return show
