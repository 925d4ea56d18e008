"""One page's state over time: holds what is shown, tells the views when it changes, and knows the way back."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import AbstractContextManager, nullcontext
from typing import Any

from zerorev.web.state import State, undone

__all__ = ["Listener", "Session", "View"]

View = Callable[[State, State], None]  # is told what was shown before, and what is now
Listener = Callable[[Any], None]

KEPT = 50  # edits that can be taken back


class Session:
    """The state of one page; no two pages share one.

    Attributes:
        state: what is shown.
        theme: whether the page is dark; None: as the user's system is.
        page: makes what the views are told within: the page that shows them, if there is one.
    """

    def __init__(self, state: State) -> None:
        """Begin with a state."""
        self.state = state
        self.theme: bool | None = None
        self.page: Callable[[], AbstractContextManager[object]] = nullcontext
        self._views: list[View] = []
        self._listeners: list[tuple[str, Listener]] = []
        self._past: list[State] = []
        self._edit: object = None  # what the last edit came of

    def watch(self, view: View) -> None:
        """Have a view told of every change from now on."""
        self._views.append(view)

    def unwatch(self) -> None:
        """Let all views go, as when a page is built anew over the same state."""
        self._views.clear()
        self._listeners.clear()

    def hear(self, what: str, listener: Listener) -> None:
        """Have a view told of what others tell: things of the moment, such as where the motion is played.

        Args:
            what: `seek` (path distance from the corner [mm], negative on the plunge), `show_slice` (what
                `zerorev.report.cell_data.slice_data` makes, or None), `pick_cell` (number of a cell of the slice).
            listener: is given what is told.
        """
        self._listeners.append((what, listener))

    def tell(self, what: str, value: Any) -> None:
        """Tell the views that `hear` of it."""
        for each, listener in tuple(self._listeners):
            if each == what:
                listener(value)

    def change(self, state: State, of: object = None) -> None:
        """Show another state. Each view looks itself at what of it is not the same object any more.

        Args:
            state: to be shown.
            of: what it comes of, where that changes the job bit by bit: its changes count as one edit.
        """
        if self.state.job is not None and state.job is not self.state.job:
            if of is None or of is not self._edit:
                self._past = [*self._past[1 - KEPT :], self.state]
            self._edit = of
        self._show(state)

    @property
    def can_undo(self) -> bool:
        """Whether there is an edit to take back."""
        return bool(self._past)

    def undo(self) -> None:
        """Take the last edit of the job back; what has been found since stays where it still holds."""
        if self._past:
            self._edit = None
            self._show(undone(self.state, self._past.pop()))

    def _show(self, state: State) -> None:
        before, self.state = self.state, state
        if state is before:
            return
        with self.page():
            for view in tuple(self._views):
                if view in self._views:  # one that is told first may build the page anew
                    view(before, state)
