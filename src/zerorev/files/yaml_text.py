"""YAML in and out, as the core schema of YAML 1.2 has it: 1e-3 is a number, `no` and a date are text.

It is read by libyaml, event by event: a hundred thousand values a second, and none of them kept but the plain data and
the lines that they stand in.
"""

from __future__ import annotations

import re
from typing import Any, NoReturn

import yaml
from yaml.events import (
    AliasEvent,
    DocumentStartEvent,
    Event,
    MappingEndEvent,
    MappingStartEvent,
    ScalarEvent,
    SequenceEndEvent,
    SequenceStartEvent,
    StreamEndEvent,
)  # fmt: skip

from zerorev.errors import InputError
from zerorev.files.text import LINE_WIDTH, MAX_DEPTH, MAX_KEYS, Document, FieldPath
from zerorev.visible import is_visible

__all__ = ["MAX_VALUES", "yaml_document", "yaml_text"]

MAX_VALUES = 500_000  # of one file: those of some 30,000 holes
MAX_REPEATED = 16  # entries of a list that an alias repeats

_LOADER = getattr(yaml, "CSafeLoader", yaml.SafeLoader)  # the latter, ten times as slow, where libyaml is missing
_TAG = "tag:yaml.org,2002:"
_INT = re.compile(r"[-+]?[0-9]+")
_FLOAT = re.compile(r"[-+]?(\.[0-9]+|[0-9]+(\.[0-9]*)?)([eE][-+]?[0-9]+)?|[-+]?\.(inf|Inf|INF)|\.(nan|NaN|NAN)")
_WORDS = dict.fromkeys(("", "~", "null", "Null", "NULL")) | {
    word: word.lower() == "true" for word in ("true", "True", "TRUE", "false", "False", "FALSE")
}
_KINDS: dict[str, tuple[type, ...]] = {
    "null": (type(None),), "bool": (bool,), "int": (int,), "float": (int, float), "str": (str,)
}  # fmt: skip
_NUMERIC = frozenset("-+.0123456789")


def yaml_document(text: str, file: str) -> Document:
    """Plain data of a YAML text.

    Raises:
        InputError: a syntax error, a key used twice, an alias, an unknown tag, too deep a nesting, too many values.
    """
    reading = _Reading(text)
    try:
        return Document(file, reading.document(), reading.lines)
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        line = f", line {mark.line + 1}" if mark else ""
        what = ", ".join(part for part in (error.context, error.problem) if part)
        raise InputError(what, where=file + line, accepted="YAML") from None
    except yaml.reader.ReaderError as error:  # its position is in bytes of UTF-8
        line_number = text.encode().count(b"\n", 0, error.position) + 1
        raise InputError("holds a control character", where=f"{file}, line {line_number}", accepted="YAML") from None
    except UnicodeEncodeError:
        raise InputError("holds half a character", where=file, accepted="YAML") from None


class _Reading:
    """What of a text is read so far."""

    def __init__(self, text: str) -> None:
        self.lines: dict[FieldPath, int] = {}
        self._events = yaml.parse(text, Loader=_LOADER)
        self._values = 0
        self._named: dict[str, Any] = {}  # values and short lists of values, by their anchors

    def document(self) -> Any:
        self._next()  # the stream begins
        event = self._next()
        if isinstance(event, StreamEndEvent):
            return None
        assert isinstance(event, DocumentStartEvent)
        found = self._value(self._next(), ())
        self._next()  # the document ends
        if not isinstance(event := self._next(), StreamEndEvent):
            _refuse("a second document", event)
        return found

    def _next(self) -> Event:
        return next(self._events)

    def _value(self, event: Event, path: FieldPath) -> Any:
        self.lines[path] = event.start_mark.line + 1  # type: ignore[union-attr]
        self._values += 1
        if self._values > MAX_VALUES:
            _refuse(f"more than {MAX_VALUES:,} values (a CSV file takes more holes)", event)
        if isinstance(event, AliasEvent):
            return self._repeated(event)
        if event.anchor is not None:  # type: ignore[attr-defined]
            self._named.pop(event.anchor, None)  # type: ignore[attr-defined]
        if isinstance(event, ScalarEvent):
            found = _scalar(event)
            self._name(event, found)
            return found
        if len(path) == MAX_DEPTH:
            _refuse(f"is nested too deep: more than {MAX_DEPTH} levels", event)
        if isinstance(event, MappingStartEvent):
            _check_tag(event, "map")
            return self._mapping(path)
        assert isinstance(event, SequenceStartEvent)
        _check_tag(event, "seq")
        found, begin = [], event
        while not isinstance(event := self._next(), SequenceEndEvent):
            found.append(self._value(event, (*path, len(found))))
        if len(found) <= MAX_REPEATED and not any(isinstance(value, (list, dict)) for value in found):
            self._name(begin, found)
        return found

    def _name(self, event: ScalarEvent | SequenceStartEvent, value: Any) -> None:
        if event.anchor is not None:
            self._named[event.anchor] = value

    def _repeated(self, event: AliasEvent) -> Any:
        """What an alias stands for, which is short: else a few of them can blow a small file up to any size."""
        if event.anchor not in self._named:
            _refuse("aliases (*name) are read of single values and short lists alone; JSON is read, too", event)
        value = self._named[event.anchor]
        if not isinstance(value, list):
            return value
        self._values += len(value)
        return list(value)

    def _mapping(self, path: FieldPath) -> dict[str, Any]:
        found: dict[str, Any] = {}
        while not isinstance(event := self._next(), MappingEndEvent):
            if not isinstance(event, ScalarEvent):
                _refuse("a key that is not text", event)
            _check_tag(event, "str")
            key = event.value
            if key in found:
                _refuse(f"the key '{key}' is used twice", event)
            if len(found) == MAX_KEYS:
                _refuse(f"a mapping of more than {MAX_KEYS:,} keys", event)
            found[key] = self._value(self._next(), (*path, key))
        return found


def _check_tag(event: SequenceStartEvent | MappingStartEvent | ScalarEvent, kind: str) -> None:
    if event.tag not in (None, "!", _TAG + kind):
        _refuse(f"the tag {event.tag} is not read", event)


def _scalar(event: ScalarEvent) -> Any:
    text, tag = event.value, event.tag
    if tag in (None, "!"):
        return _plain(text, event) if event.implicit[0] else text
    found = text if tag == _TAG + "str" else _plain(text, event)
    kinds = _KINDS.get(tag.removeprefix(_TAG))
    if kinds is None:
        _refuse(f"the tag {tag} is not read", event)
    if type(found) not in kinds:
        _refuse(f"is not what its tag {tag} says", event)
    return float(found) if tag == _TAG + "float" else found


def _plain(text: str, event: Event) -> Any:
    """What a scalar without quotes means."""
    if text[:1] in _NUMERIC and text:
        try:
            if _INT.fullmatch(text):
                return int(text)
            if _FLOAT.fullmatch(text):
                return float(text.lower().replace(".inf", "inf").replace(".nan", "nan"))
        except ValueError:  # thousands of digits
            _refuse("not a number that can be read", event)
    return _WORDS.get(text, text)


def _refuse(problem: str, event: Event) -> NoReturn:
    raise yaml.MarkedYAMLError(problem=problem, problem_mark=event.start_mark)  # type: ignore[arg-type]


class _Dumper(yaml.SafeDumper):
    """Puts into quotes all that would not be read as text again."""

    yaml_implicit_resolvers = {}  # noqa: RUF012  PyYAML's own way

    def ignore_aliases(self, data: Any) -> bool:
        """Write everything out."""
        return True


for _name, _pattern, _first in (
    ("null", re.compile(r"(~|null|Null|NULL|)$"), ["~", "n", "N", ""]),
    ("bool", re.compile(r"(true|True|TRUE|false|False|FALSE)$"), list("tTfF")),
    ("int", re.compile(f"(?:{_INT.pattern})$"), sorted(_NUMERIC)),
    ("float", re.compile(f"(?:{_FLOAT.pattern})$"), sorted(_NUMERIC)),
):
    _Dumper.add_implicit_resolver(_TAG + _name, _pattern, _first)


def yaml_text(data: Any) -> str:
    """Plain data as YAML that `yaml_document` reads as the same; short lists and mappings stand on one line."""
    options: dict[str, Any] = {"default_flow_style": None, "sort_keys": False, "width": LINE_WIDTH}
    text = str(yaml.dump(data, Dumper=_Dumper, allow_unicode=True, **options))
    return text if is_visible(text) else str(yaml.dump(data, Dumper=_Dumper, allow_unicode=False, **options))
