"""How the job is planned and run: each setting with its unit, and what is wrong with it beside it."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Any

from nicegui import ui

from zerorev.errors import InputError
from zerorev.files.conversion import settings_data, settings_from
from zerorev.files.schema import SettingsForm
from zerorev.files.text import Document, FieldPath
from zerorev.files.validation import problems
from zerorev.model.job import Job, Settings
from zerorev.model.stated import Choice, Number, Six, Stated, Switch, Weighed, Whole, stated
from zerorev.web.job_edits import with_settings
from zerorev.web.session import Session
from zerorev.web.views.fields import Fields, ends, form, group, number

__all__ = ["settings_dialog", "settings_of"]

WEIGHTED = "weights"  # the choice of a weighted sum, beside the words of the objective


def settings_dialog(session: Session) -> Callable[[], None]:
    """A form of the settings.

    Args:
        session: whose job they are of.
    """
    dialog, card, _ = form("Settings", "settings-form", wide=True)
    fields = Fields()
    with card:
        with ui.element("div").classes("zr-scroll"):
            for legend in dict.fromkeys(each.group for each in stated(Settings)):
                _part(fields, legend, [each for each in stated(Settings) if each.group == legend])
        dropped = ui.label().classes("zr-muted")
        fields.line()

    def take() -> None:
        job = session.state.job
        if job is None:
            return
        settings, wrong = settings_of(_values(fields), job)
        if not fields.show(wrong) and settings is not None:
            session.change(with_settings(session.state, settings))
            dialog.close()

    with card:
        ends(dialog, "Take", take)

    def opened() -> None:
        job = session.state.job
        if job is None:
            return
        data = settings_data(job.settings)
        for path, field in fields.items():
            field.set_value(_shown(path, data))
        planned = len(session.state.answers)
        dropped.set_text(
            f"Other settings drop the answers found so far ({planned}); Ctrl-Z brings them back." if planned else ""
        )
        fields.show([])
        dialog.open()

    return opened


def _part(fields: Fields, legend: str, settings: Sequence[Stated]) -> None:
    """The fields of one part of the form: single ones side by side, then the mappings and those of the joints."""
    weighed = [each for each in settings if isinstance(each, Weighed)]
    with group(legend, "zr-two"):
        for each in settings:
            if not isinstance(each, Weighed | Six):
                _single(fields, each, {one.instead_of: one.label for one in weighed})
    for each in weighed:
        with ui.element("div") as weights, group("What weighs how much; 0 or empty: nothing", "zr-four"):
            for one in stated(each.of):
                fields.text((each.instead_of, one.name), one.label, f"weigh-{one.name}")
        weights.bind_visibility_from(fields[each.instead_of,], "value", value=WEIGHTED)
    for each in settings:
        if isinstance(each, Six):
            _six(fields, each)


def _single(fields: Fields, each: Stated, or_weights: Mapping[str, str]) -> None:
    """A field of text, or one to choose in."""
    path, name = tuple(each.path), f"setting-{each.name}"
    label = each.label or each.means or each.name
    match each:
        case Choice():
            words = {word: f"{word}: {means}" for word, means in each.words.items()}
            more = {WEIGHTED: or_weights[each.name]} if each.name in or_weights else {}
            fields.choice(path, label, name, words | more)
        case Switch():
            fields.choice(path, label, name, {False: each.off, True: each.on})
        case Number():
            fields.text(path, f"{label} [{each.unit.name}]" if each.unit.name else label, name,
                        placeholder=each.empty or each.none)  # fmt: skip


def _six(fields: Fields, each: Six) -> None:
    """A field for each joint, and below them what is accepted."""
    unit, none = f" [{each.unit.name}]" if each.unit.name else "", f"; empty: {each.none}" if each.none else ""
    with group(f"{each.means[0].upper()}{each.means[1:]}{unit}{none}", "zr-six"):
        for n in range(6):
            fields.text((*each.path, n), f"joint {n + 1}", f"setting-{each.name}-{n + 1}")
    fields.note(each.path[0])


def _shown(path: FieldPath, data: dict[str, Any]) -> Any:
    """What stands in the field of a setting."""
    value: Any = data
    for part in path:
        if isinstance(value, dict):
            value = value.get(str(part), "")
        else:  # six numbers, or none; of one criterion that decides alone, no weights
            value = value[part] if isinstance(value, list) and isinstance(part, int) else None
    if isinstance(value, dict):
        return WEIGHTED
    if isinstance(value, float):  # to the last bit, so that what is not touched stays the same
        return short if float(short := f"{value:.10g}") == value else repr(value)
    return "" if value is None else value if isinstance(value, bool) else str(value)


def _values(fields: Fields) -> dict[FieldPath, Any]:
    """What stands in the fields; numbers as numbers, where they are any."""
    whole = [each.path for each in stated(Settings) if isinstance(each, Whole)]
    values = {}
    for path, field in fields.items():
        value = number(field.value) if isinstance(field, ui.input) else field.value
        values[path] = int(value) if path in whole and isinstance(value, float) and value.is_integer() else value
    return values


def settings_of(values: dict[FieldPath, Any], job: Job) -> tuple[Settings | None, list[tuple[FieldPath, InputError]]]:
    """The settings that a user asks for, or what is wrong with them, field by field; those not asked for stay.

    Args:
        values: by their paths in a job file.
        job: whose settings they take the place of.
    """
    data = settings_data(job.settings)
    whole = {str(path[0]): value for path, value in values.items() if len(path) == 1}
    parts: dict[str, dict[Any, Any]] = {}
    for path, value in values.items():
        if len(path) == 2:
            parts.setdefault(str(path[0]), {})[path[1]] = value
    weights = parts.pop("objective", None)
    if whole.get("objective") == WEIGHTED:
        del whole["objective"]
        if weights is not None:
            data["objective"] = {name: value for name, value in weights.items() if value != ""}
    nullable = {each.path[0] for each in stated(Settings) if each.nullable}
    data |= {key: None if key in nullable and value == "" else value for key, value in whole.items()}
    for key, given in parts.items():
        if key in nullable:
            data[key] = None if all(value == "" for value in given.values()) else [""] * 6
        for part, value in given.items() if data[key] is not None else ():
            data[key][part] = value
    if wrong := problems(SettingsForm, Document("", data)):
        return None, wrong
    try:
        settings = settings_from(SettingsForm.model_validate(data))
        settings = replace(settings, surroundings=job.settings.surroundings)
    except InputError as error:
        at = next((path for path in values if str(path[0]).startswith(error.where)), ())
        return None, [(at, error)]
    return (job.settings if data == settings_data(job.settings) else settings), []
