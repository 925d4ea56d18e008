"""What the forms of the page share: fields of text, numbers out of them, and messages beside them."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from contextlib import AbstractContextManager
from typing import Any, ParamSpec

from nicegui import ui

from zerorev.errors import InputError
from zerorev.files.text import FieldPath
from zerorev.web.session import Session

__all__ = ["Fields", "built_when_opened", "ends", "form", "group", "number", "said"]

P = ParamSpec("P")


class Fields(dict[FieldPath, Any]):
    """Fields of a form by their paths in its data, and the line for what belongs to none of them."""

    def __init__(self) -> None:
        """Begin without a field."""
        super().__init__()
        self.problem: ui.label | None = None
        self.notes: dict[str | int, ui.label] = {}

    def text(self, path: FieldPath, label: str, name: str, **options: Any) -> ui.input:
        """A field of text.

        Args:
            path: of its value.
            label: that stands in it.
            name: for tests.
            options: of `ui.input`.
        """
        field = ui.input(label, **options).props(f'outlined dense hide-bottom-space data-testid="{name}"')
        self[path] = field
        return field

    def choice(self, path: FieldPath, label: str, name: str, options: Mapping[Any, str]) -> ui.select:
        """A field to choose in."""
        field = ui.select(dict(options), label=label, value=next(iter(options)))
        self[path] = field.props(f'outlined dense options-dense hide-bottom-space data-testid="{name}"')
        return field

    def note(self, name: str) -> None:
        """The line for what is accepted in the fields of one name that stand above it, here."""
        self.notes[name] = ui.label().classes("zr-problem")

    def line(self) -> None:
        """The line for what belongs to no field, here."""
        self.problem = ui.label().classes("zr-problem").props('role="alert" data-testid="form-problem"')

    def show(self, wrong: Iterable[tuple[FieldPath, InputError]]) -> bool:
        """Put each message beside its field, and take the others away; return whether there is any."""
        messages: dict[FieldPath, str] = {}
        notes: dict[str | int, str] = {}
        rest = []
        for path, error in wrong:
            at = next((path[:n] for n in range(len(path), 0, -1) if path[:n] in self), None)
            at = at or next((each for each in self if each[: len(path)] == path and path), None)
            if at is None:
                rest.append(str(error))
            elif at[0] in self.notes:  # short, beside the one of several fields; what is accepted stands below them
                messages.setdefault(at, error.what)
                notes.setdefault(at[0], f"accepted: {error.accepted}")
            else:
                messages.setdefault(at, said(error))
        for path, field in self.items():
            field.error = messages.get(path)
        for name, note in self.notes.items():
            note.set_text(notes.get(name, ""))
        if self.problem is not None:
            self.problem.set_text("\n".join(rest))
        return bool(messages or rest)


def said(error: InputError) -> str:
    """A message that stands beside its field."""
    return f"{error.what}; accepted: {error.accepted}" if error.accepted else error.what


def number(text: Any) -> Any:
    """The number that a text is, with a decimal point or comma; else the text itself, for the form to refuse."""
    words = str(text or "").strip()
    try:
        return float(words.replace(",", ".")) if "_" not in words else words
    except ValueError:
        return words


def built_when_opened(dialog: Callable[[Session], Callable[P, None]], session: Session) -> Callable[P, None]:
    """What opens a dialog; the page stands sooner without all of those that nobody asks for.

    Args:
        dialog: draws it in the current slot, and returns what opens it.
        session: that it is of.
    """
    slot, built = ui.context.slot, list[Callable[P, None]]()

    def opened(*args: P.args, **options: P.kwargs) -> None:
        if not built:
            with slot:
                built.append(dialog(session))
        built[0](*args, **options)

    return opened


def form(title: str, name: str, wide: bool = False) -> tuple[ui.dialog, AbstractContextManager[Any], ui.label]:
    """A dialog with a title: the dialog, where its content goes, and the title.

    Args:
        title: of the form.
        name: for tests.
        wide: whether it holds a table.
    """
    dialog = ui.dialog().props("transition-duration=100")
    with dialog, ui.card().classes("zr-form zr-wide" if wide else "zr-form") as card:
        card.props(f'data-testid="{name}"')
        heading = ui.label(title).classes("zr-form-title").props('role="heading" aria-level="2"')
    return dialog, card, heading


def group(legend: str, look: str = "") -> AbstractContextManager[Any]:
    """Fields that belong together, side by side."""
    with ui.element("fieldset") as fieldset:
        ui.html(legend, tag="legend", sanitize=False)
        return ui.element("div").classes(f"zr-group {look}") if look else fieldset


def ends(dialog: ui.dialog, done: str, do: Callable[[], Any]) -> ui.button:
    """The two ways out of a form: back, and on."""
    with ui.element("div").classes("zr-ends"):
        ui.button("Cancel", on_click=dialog.close, color=None).classes("zr-quiet").props(
            'flat no-caps data-testid="form-cancel"'
        )
        return ui.button(done, on_click=do).props('unelevated no-caps data-testid="form-done"')
