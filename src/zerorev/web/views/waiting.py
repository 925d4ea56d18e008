"""What is done in another process is waited for with a message that can be cancelled; the page stays free meanwhile."""

from __future__ import annotations

import logging
from collections.abc import Callable, Iterable, Iterator
from typing import Any, TypeVar

from nicegui import background_tasks, ui

from zerorev.apart import Apart, Stopped, Task
from zerorev.errors import ZerorevError
from zerorev.web.aside import aside
from zerorev.web.views.notices import failed

__all__ = ["do_apart"]

T = TypeVar("T")


def do_apart(
    words: str,
    task: Task,
    given: Iterable[Any],
    made: Callable[[Iterator[Any]], T],
    ready: Callable[[T], object],
) -> None:
    """Have something done in another process for the page of the current slot, unless the user cancels it or leaves.

    Args:
        words: what is being done.
        task: that is done.
        given: to the task.
        made: makes one thing of the results, in a thread.
        ready: is given it, on the page; where the task came to nothing, the page says why.
    """
    page, apart = ui.context.client, Apart(task)

    async def follow() -> None:
        with page:
            note = ui.notification(
                words, position="top", spinner=True, timeout=None, close_button="Cancel", on_dismiss=apart.stop,
                classes="zr-notify", attrs={"data-testid": "waiting"},
            )  # fmt: skip
            page.on_delete(apart.stop)
            try:
                ready(await aside(lambda: made(apart.results(given))))
            except Stopped:
                pass
            except ZerorevError as error:
                failed(str(error))
            except Exception as error:
                logging.getLogger("zerorev").exception("a fault in zerorev itself; please report the lines below")
                failed(f"a fault in zerorev itself ({type(error).__name__}); the terminal says more")
            finally:
                if not page.is_deleted:
                    note.dismiss()

    background_tasks.create(follow())
