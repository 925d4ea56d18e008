"""Opening a file of the user's: the button, and the message where it cannot be used."""

from __future__ import annotations

from collections.abc import Awaitable, Callable

from nicegui import events, ui

from zerorev.files.text import MAX_BYTES
from zerorev.web import files
from zerorev.web.opening import demo, shown
from zerorev.web.session import Session
from zerorev.web.views.notices import failed
from zerorev.web.views.waiting import do_apart

__all__ = ["file_picker", "open_button", "open_demo", "pick_file"]

KINDS = ".yaml,.yml,.json"

Opened = Callable[[events.UploadEventArguments], Awaitable[None]]


def open_button(session: Session, name: str, look: str) -> None:
    """A button that opens a job or a plan file, or the demo.

    Args:
        session: that is to show it.
        name: of the button, for tests.
        look: its classes.
    """
    with (
        ui.button("Open", icon="folder_open", color=None).classes(look).props(f'flat no-caps data-testid="{name}"'),
        ui.menu(),
    ):
        file = ui.menu_item("A job or a plan file …", auto_close=True).props('data-testid="open-file"')
        ui.menu_item("The demo: three holes", on_click=lambda: open_demo(session)).props('data-testid="open-demo"')
    pick_file(session, file)


def pick_file(session: Session, button: ui.element) -> None:
    """Have a button open a job or a plan file of the user's.

    Args:
        session: that is to show it.
        button: that is pressed.
    """

    async def opened(event: events.UploadEventArguments) -> None:
        name, content = event.file.name, await event.file.read()
        do_apart(
            f"Reading {name} …",
            files.read,
            [name, *files.cut(content)],
            lambda pieces: shown(files.whole(pieces)),
            session.change,
        )

    file_picker(button, opened, KINDS, failed)


def file_picker(
    button: ui.element,
    opened: Opened,
    kinds: str,
    refused: Callable[[str], object],
    largest: int = MAX_BYTES,
) -> None:
    """Have a button open the browser's dialog for files.

    Args:
        button: that is pressed.
        opened: is given what was picked.
        kinds: of files, by their endings.
        refused: called with the reason why a file was not taken.
        largest: size of a file [bytes].
    """
    upload = _Upload(opened, largest).classes("zr-hidden")
    upload.props(f'accept="{kinds}" aria-hidden="true"')
    upload.on_rejected(lambda: refused(f"not taken (accepted: a file {kinds} of at most {largest // 2**20} MiB)"))
    button.on("click", js_handler=f"() => getElement({upload.id}).$refs.qRef.pickFiles()")


class _Upload(ui.upload):
    """Takes one file at a time, and forgets who wanted it when its page is left.

    Each upload is a route of its own, and FastAPI keeps the functions of the last 4,096 routes that it has seen, also
    of those that were removed (the caches of `fastapi.dependencies.models`). Without this, each would keep the session
    of its page, with all of its holes and answers.
    """

    def __init__(self, opened: Opened, largest: int) -> None:
        self._opened: Opened | None = opened
        super().__init__(on_upload=self._hand_on, auto_upload=True, max_file_size=largest)

    async def _hand_on(self, event: events.UploadEventArguments) -> None:
        self.reset()
        if self._opened is not None:
            await self._opened(event)

    def _handle_delete(self) -> None:
        self._opened = None
        super()._handle_delete()


def open_demo(session: Session) -> None:
    """Show the demo."""
    session.change(demo())
