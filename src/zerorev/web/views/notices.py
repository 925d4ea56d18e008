"""Messages that lie over the page: each kind has one look, which is readable in both themes."""

from __future__ import annotations

from nicegui import ui

__all__ = ["failed", "note"]


def note(message: str) -> None:
    """Say something that is gone again after some seconds."""
    ui.notify(message, position="top", classes="zr-notify")


def failed(message: str) -> None:
    """Say why something could not be done, until the user has read it."""
    ui.notify(
        message, position="top", timeout=0, close_button="close", classes="zr-notify zr-notify-bad", multi_line=True
    )
