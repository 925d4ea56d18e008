"""From plain data to a checked form, or one `InputError` in plain words that says where and what would be accepted."""

from __future__ import annotations

import reprlib
from collections.abc import Iterator
from contextlib import contextmanager
from difflib import get_close_matches
from typing import Any, TypeVar, get_args

from pydantic import ValidationError
from pydantic.fields import FieldInfo

from zerorev.errors import InputError
from zerorev.files.stated_forms import Form
from zerorev.files.text import Document, FieldPath

__all__ = ["checked", "inside", "problems"]

F = TypeVar("F", bound=Form)

SHOWN = 3  # problems listed in one message
TAGS = ("<text>", "<list>", "<mapping>", "<cone>", "<sphere>")  # of the members of unions, as pydantic names them

WORDS = {
    "missing": "is missing",
    "finite_number": "{value} is not a finite number",
    "float_type": "{value} is not a number",
    "int_type": "{value} is not a whole number",
    "string_type": "{value} is not text",
    "bool_type": "{value} is neither true nor false",
    "list_type": "{value} is not a list",
    "dict_type": "{value} is not a mapping of keys to values",
    "model_type": "{value} is not a mapping of keys to values",
    "literal_error": "{value} is not among the choices",
    "greater_than": "{value} is too small",
    "greater_than_equal": "{value} is too small: {ge:g} is the least",
    "less_than_equal": "{value} is too large: {le:g} is the most",
    "too_short": "has {actual_length} entries",
    "too_long": "has too many entries: {max_length} is the most",
    "string_too_long": "{value} is too long: {max_length} characters is the most",
}


def checked(form: type[F], document: Document) -> F:
    """The document as an instance of the form.

    Raises:
        InputError: it is another kind of file, or its fields are not what the form accepts.
    """
    data, marker = document.data, form.model_fields.get("format")
    if data is None or data == "":
        raise InputError("is empty", where=document.file, accepted=_keys(form))
    if not isinstance(data, dict):
        raise InputError(f"holds {_short(data)}, not a mapping of keys to values", where=document.file,
                         accepted=_keys(form))  # fmt: skip
    if marker is not None and data.get("format", marker.default) != marker.description:
        what = f"is a file of format {_short(data['format'])}" if "format" in data else "has no key 'format'"
        raise InputError(what, where=document.file, accepted=f"format: {marker.description}")
    try:
        return form.model_validate(data)
    except ValidationError:
        wrong = [problem for _, problem in problems(form, document)]
    with inside(document.file):
        if len(wrong) == 1:
            raise wrong[0]
        more = ["... and more"] if len(wrong) > SHOWN else []
        listed = "".join(f"\n  - {problem}" for problem in [*wrong[:SHOWN], *more])
        raise InputError(f"several problems{listed}")


def problems(form: type[Form], document: Document) -> list[tuple[FieldPath, InputError]]:
    """What the form does not accept of a mapping, field by field, each with the path of its field.

    Of a list of many entries no more is examined than up to the first that is not accepted.

    Args:
        form: what the mapping is to be.
        document: with a mapping in it.
    """
    try:
        form.model_validate(document.data)
    except ValidationError as error:
        # a misspelt key first: it explains the missing one
        details = sorted(error.errors(include_url=False), key=lambda detail: detail["type"] != "extra_forbidden")
        return [(_path(detail), _problem(form, document, detail)) for detail in details]
    return []


@contextmanager
def inside(where: str) -> Iterator[None]:
    """Put the file in front of what an `InputError` from within says about where it arose."""
    try:
        yield
    except InputError as error:
        within = f"{where}, {error.where}" if error.where else where
        raise InputError(error.what, where=within, accepted=error.accepted) from error


def _path(detail: Any) -> FieldPath:
    """Where a problem is, without the tags of unions; an unknown key stays, though it looks like one."""
    loc: FieldPath = detail["loc"]
    unknown = loc[-1:] if detail["type"] == "extra_forbidden" else ()
    return (*(part for part in loc[: len(loc) - len(unknown)] if part not in TAGS), *unknown)


def _problem(form: type[Form], document: Document, detail: Any) -> InputError:
    path = _path(detail)
    owner, field = _field(form, path)
    where = document.place(path) + _hole(document.data, path)
    if detail["type"] == "extra_forbidden":
        key = str(path[-1])
        near = get_close_matches(key, owner.model_fields, n=1)
        accepted = f"did you mean '{near[0]}'?" if near else _keys(owner)
        return InputError(f"unknown key {_short(key)}", where=where, accepted=accepted)
    words = WORDS.get(detail["type"], "{value} cannot be used")
    what = words.format(value=_short(detail["input"]), **detail.get("ctx", {}))
    return InputError(what, where=where, accepted=(field.description or "") if field else "")


def _field(form: type[Form], path: FieldPath) -> tuple[type[Form], FieldInfo | None]:
    """The form that owns the last key of the path, and that key's field."""
    owner, field, inner = form, None, form
    for part in path:
        if isinstance(part, str):
            owner = inner
            field = owner.model_fields.get(part, field)  # a key of a plain mapping is of the mapping's own field
            inner = (field and _form_in(field.annotation)) or owner
    return owner, field


def _form_in(annotation: Any) -> type[Form] | None:
    if isinstance(annotation, type) and issubclass(annotation, Form):
        return annotation
    return next((form for arg in get_args(annotation) if (form := _form_in(arg))), None)


def _hole(data: Any, path: FieldPath) -> str:
    """The id of the hole that the path leads into, as a message shows it."""
    match path:
        case ("holes", int(i), *_) if isinstance(data["holes"][i], dict) and "id" in data["holes"][i]:
            return f" (hole {_short(data['holes'][i]['id'])})"
    return ""


def _keys(form: type[Form]) -> str:
    return f"the keys {', '.join(form.model_fields)}"


def _short(value: object) -> str:
    return reprlib.repr(value)
