"""One page's state over time: holds what is shown, tells the views of changes, and knows the way back and forth."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import AbstractContextManager, nullcontext
from dataclasses import replace
from typing import Any

from zerorev.model.plan import HolePlan
from zerorev.web.job_edits import answered
from zerorev.web.state import State

__all__ = ["Listener", "Session", "View", "undone"]

View = Callable[[State, State], None]  # is called with the states shown before and now
Listener = Callable[[Any], None]

KEPT = 50  # steps that can be taken back


class Session:
    """The state of one page; no two pages share one.

    Attributes:
        state: what is shown.
        theme: whether the page is dark; None: as the user's system is.
        page: makes the context in which the views are called: the page that shows them, if there is one.
    """

    def __init__(self, state: State) -> None:
        """Begin with a state."""
        self.state = state
        self.theme: bool | None = None
        self.page: Callable[[], AbstractContextManager[object]] = nullcontext
        self._views: list[View] = []
        self._listeners: list[tuple[str, Listener]] = []
        self._past: list[State] = []
        self._future: list[State] = []
        self._step: object = None  # what the last step came of

    def watch(self, view: View) -> None:
        """Call a view on every change from now on."""
        self._views.append(view)

    def unwatch(self) -> None:
        """Let all views go, as when a page is built again over the same state."""
        self._views.clear()
        self._listeners.clear()

    def hear(self, what: str, listener: Listener) -> None:
        """Call a listener with what other views tell: things of the moment, such as where the motion is played.

        Args:
            what: `seek` (path distance from the corner [mm], negative on the plunge), `pick_cell` (number of a cell of
                the map), `steer` (the motion under a drag, or None).
            listener: is given what they tell.
        """
        self._listeners.append((what, listener))

    def tell(self, what: str, value: Any) -> None:
        """Tell the views that `hear` of it."""
        for each, listener in tuple(self._listeners):
            if each == what:
                listener(value)

    def change(self, state: State, of: object = None) -> None:
        """Show another state. Each view looks itself at what of it is not the same object any more.

        Another job, or another motion by hand, is a step that `undo` takes back.

        Args:
            state: to be shown.
            of: what it comes of, where that changes job or motion bit by bit, as a drag does: its changes count as one
                step.
        """
        if self.state.job is not None and _edited(self.state, state):
            if of is None or of is not self._step:
                # of other files, which may be large, the one before is enough
                past = self._past[1 - KEPT :] if _same_file(self.state, state) else []
                self._past = [*past, self.state]
            self._step = of
            self._future = []
        self._show(state)

    def start_over(self, state: State) -> None:
        """Show another state, from which no step is taken back, as of another tool."""
        self._past, self._future, self._step = [], [], None
        self._show(state)

    @property
    def can_undo(self) -> bool:
        """Whether there is a step to take back."""
        return bool(self._past)

    @property
    def can_redo(self) -> bool:
        """Whether there is a step that was taken back, and none since."""
        return bool(self._future)

    def undo(self) -> None:
        """Take the last step back; what has been found since stays where it still holds."""
        if self._past:
            self._step = None
            self._future.append(self.state)
            self._show(undone(self.state, self._past.pop()))

    def redo(self) -> None:
        """Take the last `undo` back; what has been found since stays where it still holds."""
        if self._future:
            self._step = None
            self._past.append(self.state)
            self._show(undone(self.state, self._future.pop()))

    def drop(self, of: object) -> None:
        """Take a step back while it is still being made, as if it had not begun.

        Args:
            of: what it comes of; nothing is taken back where the last step came of something else.
        """
        if self._past and of is not None and of is self._step:
            self._step = None
            self._show(undone(self.state, self._past.pop()))

    def _show(self, state: State) -> None:
        before, self.state = self.state, state
        if state is before:
            return
        with self.page():
            for view in tuple(self._views):
                if view in self._views:  # one that is called first may build the page again
                    view(before, state)


def _same_file(before: State, after: State) -> bool:
    return before.job is not None and after.job is not None and before.job.robot is after.job.robot


def _edited(before: State, after: State) -> bool:
    """Whether the user would miss what was before: another job, or another motion by hand."""
    return before.job is not after.job or before.steered is not after.steered


def undone(state: State, before: State) -> State:
    """The state before or after a step, with those answers found since that hold for it, too.

    A motion that was kept by hand is an edit of its own: it takes no other answer's place, and no other takes its.
    """
    before = replace(before, progress=state.progress, trouble=state.trouble, outcome=state.outcome)
    before = replace(before, caution=state.caution if before.job is state.job else before.caution)
    now, old = state.job, before.job
    if now is None or old is None or now.robot is not old.robot or now.tool is not old.tool:
        return before
    before = replace(before, cells=state.cells, arm=state.arm)
    if state.strokes != before.strokes or now.settings is not old.settings:
        return before
    since = (
        answer
        for key, answer in state.answers.items()
        if (old_answer := before.answers.get(key)) is not answer
        and (old_answer is None or not (_by_hand(answer) or _by_hand(old_answer)))
    )
    return replace(answered(before, *since, strokes=before.strokes), steered=before.steered)


def _by_hand(answer: HolePlan) -> bool:
    return answer.hole.profile is not None
