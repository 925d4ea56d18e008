"""What is kept of the browsers' tabs while the app runs."""

from __future__ import annotations

import ctypes
import gc
import sys
from collections import OrderedDict
from contextlib import nullcontext
from dataclasses import dataclass

from nicegui import Client, app

from zerorev.web import page
from zerorev.web.computing import Work
from zerorev.web.session import Session
from zerorev.web.state import State

__all__ = ["Pages"]

MOST_PAGES = 50  # of which the state is kept
MOST_HOLES = 20_000  # of all the jobs of pages that were left, beside the one that was left last


@dataclass
class _Page:
    """What is kept of one tab of a browser, whether it is connected or not."""

    session: Session
    work: Work
    client: Client | None = None


class Pages:
    """The sessions of the browsers' tabs: a tab finds its own again, and no two tabs share one."""

    def __init__(self, first: State) -> None:
        """Begin with what each new tab is shown."""
        self._first = first
        self._pages: OrderedDict[str, _Page] = OrderedDict()

    def build(self, client: Client) -> None:
        """Draw the page of a client's tab, as it was left."""
        assert client.tab_id is not None
        tab, before = client.tab_id, app.storage.tab.get("tab")
        app.storage.tab["tab"] = tab
        kept = self._pages.get(tab)
        if kept is None:
            # a tab that was doubled in the browser continues on its own from where the other is
            beside = self._pages.get(before) if before else None
            session = Session(beside.session.state if beside else self._first)
            kept = self._pages[tab] = _Page(session, Work(session))
        self._pages.move_to_end(tab)
        kept.client = client
        self._forget()
        kept.session.unwatch()
        kept.session.page = lambda: client
        client.on_delete(lambda: self._gone(tab, client))
        page.build(kept.session, kept.work)

    def end(self) -> None:
        """Stop all work."""
        for kept in self._pages.values():
            kept.work.end()

    def _gone(self, tab: str, client: Client) -> None:
        """A page is left; where its tab has another by now, as after a reload, that one stays."""
        kept = self._pages.get(tab)
        if kept is not None and kept.client is client:
            kept.client = None
            kept.session.unwatch()
            kept.session.page = nullcontext
            self._pages.move_to_end(tab)
            self._forget()

    def _forget(self) -> None:
        """Drop the sessions that were left longest ago, where there are many, or those that are left are large."""
        left = [tab for tab, kept in self._pages.items() if kept.client is None and not kept.work.busy]
        shown = {id(kept.session.state.job) for kept in self._pages.values() if kept.client is not None}
        too_many = len(self._pages) - MOST_PAGES
        before, holes = len(self._pages), 0
        for number, tab in enumerate(reversed(left)):
            job = self._pages[tab].session.state.job
            if job is not None and id(job) not in shown:
                shown.add(id(job))
                holes += len(job.holes) * max(len(self._pages[tab].session.state.tools), 1)
            if len(left) - number <= too_many or (number and holes > MOST_HOLES):
                del self._pages[tab]
        if len(self._pages) < before:
            _give_back()


def _give_back() -> None:
    """Give memory that is free back to the system, which the allocator of Linux would keep."""
    gc.collect()
    if sys.platform == "linux":
        trim = getattr(ctypes.CDLL(None), "malloc_trim", None)  # glibc has it
        if trim is not None:
            trim(0)
