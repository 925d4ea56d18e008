"""One page's state over time: holds what is shown, and tells the views when it changes."""

from __future__ import annotations

from collections.abc import Callable

from zerorev.web.state import State

__all__ = ["Session", "View"]

View = Callable[[State, State], None]  # is told what was shown before, and what is now


class Session:
    """The state of one page; no two pages share one.

    Attributes:
        state: what is shown.
    """

    def __init__(self, state: State) -> None:
        """Begin with a state."""
        self.state = state
        self._views: list[View] = []

    def watch(self, view: View) -> None:
        """Have a view told of every change from now on."""
        self._views.append(view)

    def unwatch(self) -> None:
        """Let all views go, as when a page is built anew over the same state."""
        self._views.clear()

    def change(self, state: State) -> None:
        """Show another state. Each view looks itself at what of it is not the same object any more."""
        before, self.state = self.state, state
        if state is not before:
            for view in tuple(self._views):
                view(before, state)
