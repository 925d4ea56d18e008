"""Opening a file of the user's: the button, and the message where it cannot be used."""

from __future__ import annotations

from collections.abc import Awaitable, Callable

from nicegui import events, ui

from zerorev.errors import ZerorevError
from zerorev.web.gate import LARGEST
from zerorev.web.opening import demo, opened_text
from zerorev.web.session import Session
from zerorev.web.views.notices import failed

__all__ = ["file_picker", "open_button", "open_demo", "pick_file"]

LARGEST = LARGEST - 2**20  # [bytes] what the gate lets in, less what is sent around a file
KINDS = ".yaml,.yml,.json"


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
        try:
            session.change(opened_text((await event.file.read()).decode("utf-8-sig"), event.file.name))
        except UnicodeDecodeError:
            failed(f"{event.file.name}: is not text (accepted: a job file (YAML) or a plan file (JSON), in UTF-8)")
        except ZerorevError as error:
            failed(str(error))

    file_picker(button, opened, KINDS, failed)


def file_picker(
    button: ui.element,
    opened: Callable[[events.UploadEventArguments], Awaitable[None]],
    kinds: str,
    refused: Callable[[str], object],
) -> None:
    """Have a button open the browser's dialog for files.

    Args:
        button: that is pressed.
        opened: is given what was picked.
        kinds: of files, by their endings.
        refused: is told why a file was not taken.
    """
    upload = ui.upload(on_upload=opened, auto_upload=True, max_file_size=LARGEST).classes("zr-hidden")
    upload.props(f'accept="{kinds}" aria-hidden="true"')
    upload.on_upload(upload.reset)
    upload.on_rejected(lambda: refused(f"not taken (accepted: a file {kinds} of at most {LARGEST // 2**20} MiB)"))
    button.on("click", js_handler=f"() => getElement({upload.id}).$refs.qRef.pickFiles()")


def open_demo(session: Session) -> None:
    """Show the demo."""
    session.change(demo())
