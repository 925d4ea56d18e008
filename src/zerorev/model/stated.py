"""A field that is stated once: what is accepted, in which unit, and what it means.

The annotation of a noun's attribute carries the statement, as in `blend: Annotated[float, Number(...)] = 1e-3`. The
keys of the files with their units and ranges (`zerorev.files.stated_forms`), the noun's own check, the options of the
command line, the form of the app and the tables of the documentation all come out of it.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import KW_ONLY, MISSING, dataclass, fields, is_dataclass, replace
from inspect import cleandoc
from typing import Any, ClassVar, TypeVar, get_type_hints

from zerorev.errors import InputError
from zerorev.model.units import ONE, Unit

__all__ = [
    "UNSET", "Choice", "Nest", "Number", "Six", "Stated", "Switch", "Weighed", "Whole", "check", "scaled", "stated",
    "with_attributes",
]  # fmt: skip

N = TypeVar("N")

UNSET = object()
"""What stands where nothing is stated; a default may be None."""


@dataclass(frozen=True)
class Nest:
    """A key of a file below which several attributes stand.

    Attributes:
        key: in the file.
        means: what stands there, one sentence.
    """

    key: str
    means: str


@dataclass(frozen=True)
class Stated:
    """What is said of one attribute; each kind of value has its own class below.

    Attributes:
        means: what it is, for the schema, the command line and the table.
        unit: outside and inside.
        key: in a file, where it is not the attribute's name with the unit's suffix.
        nest: below which key of the file it stands.
        none: what null means; empty where null is not accepted.
        added: whether files of answers of before it existed do not have it; they claim nothing then.
        before: what a file of answers without the key means, where that is not the default; it was made before the
            key existed.
        note: what the table says besides.
        group: legend of its part of the app's form; empty: that of the attribute before it.
        label: in the form; else what it means, or its name.
        empty: what an empty field of the form means; else what null means.
        name: of the attribute, filled in by `stated`.
        default: of the attribute, filled in by `stated`.
    """

    means: str = ""
    unit: Unit = ONE
    _: KW_ONLY
    key: str = ""
    nest: Nest | None = None
    none: str = ""
    added: bool = False
    before: object = UNSET
    note: str = ""
    group: str = ""
    label: str = ""
    empty: str = ""
    name: str = ""
    default: object = UNSET

    what: ClassVar[str]  # a file may have
    joined: ClassVar[str] = ": "  # to what it means

    @property
    def path(self) -> tuple[str, ...]:
        """The keys that lead to it in a file."""
        key = self.key or (f"{self.name}_{self.unit.suffix}" if self.unit.suffix else self.name)
        return (key,) if self.nest is None else (self.nest.key, key)

    @property
    def nullable(self) -> bool:
        """Whether a file may have null."""
        return bool(self.none) or self.added or self.before is not UNSET

    @property
    def span(self) -> str:
        """The range that a file's number has to be in, in words."""
        return ""

    @property
    def or_null(self) -> str:
        """What goes before the meaning of null."""
        return "; or null: "

    @property
    def accepted(self) -> str:
        """What a file may have, in words."""
        return f"{self.what}{self.span}{f' [{self.unit.name}]' if self.unit.name else ''}"

    @property
    def described(self) -> str:
        """What is accepted and what it means, in one line."""
        none = self.none
        if self.before is not UNSET:
            none = f"{self.default} in a job, and {self.before} in a file of answers from before this key existed"
        means = f"{self.joined}{self.means}" if self.means else ""
        return f"{self.accepted}{means}{f'{self.or_null}{none}' if none else ''}"

    def refused(self, value: Any, noun: object) -> str:
        """What would be accepted in place of the value of a noun [SI]; empty where it is in range."""
        return ""


@dataclass(frozen=True, kw_only=True)
class Number(Stated):
    """One number.

    Attributes:
        least: what it has to be at least, in the unit outside.
        above: what it has to be above.
        most: the largest that files accept; else the unit's.
        to: the largest, where it is worth a word.
        up_to: the attribute that it may not exceed.
    """

    least: float | None = None
    above: float | None = None
    most: float | None = None
    to: float | None = None
    up_to: str = ""

    what = "a number"

    @property
    def span(self) -> str:
        """The range that a file's number has to be in, in words."""
        if self.up_to:
            return f" from {self.least:g} to {self.up_to}_{self.unit.suffix}"
        if self.to is not None:
            return f" from {self.least:g} to {self.to:g}"
        if self.above is not None:
            return f" above {self.above:g}"
        return "" if self.least is None else f", {self.least:g} or more"

    def refused(self, value: Any, noun: object) -> str:
        """What would be accepted in place of the value of a noun [SI]; empty where it is in range."""
        if (value is None and self.none) or (value is not None and self._in_range(value, noun)):
            return ""
        span = f"{self.least:g} to {self.up_to}" if self.up_to else self.span.lstrip(", ")
        return f"{span}, or none: {self.none}" if self.none else span

    def _in_range(self, value: float, noun: object) -> bool:
        # for NaN, of which no comparison is true, none of these is
        fits = self.above is None or value > self.unit.inside(self.above)
        fits = fits and (self.least is None or value >= self.unit.inside(self.least))
        fits = fits and (self.to is None or value <= self.unit.inside(self.to))
        return fits and (not self.up_to or value <= getattr(noun, self.up_to))


class Whole(Number):
    """One whole number."""

    what = "a whole number"


class Six(Number):
    """A number for each joint, in a tuple."""

    what = "six numbers"

    def refused(self, value: Any, noun: object) -> str:
        """What would be accepted in place of the value of a noun [SI]; empty where it is in range."""
        if value is None and self.none:
            return ""
        good = len(value) == 6 and all(abs(each) < math.inf and self._in_range(each, noun) for each in value)
        return "" if good else f"{self.what}{self.span}"


@dataclass(frozen=True, kw_only=True)
class Choice(Stated):
    """One of several words.

    Attributes:
        words: what each means.
    """

    words: Mapping[str, str]

    joined = "; "

    @property
    def accepted(self) -> str:
        """What a file may have, in words."""
        *others, last = (f"{word} ({means})" if means else word for word, means in self.words.items())
        return f"{', '.join(others)} or {last}"


@dataclass(frozen=True, kw_only=True)
class Switch(Stated):
    """Yes or no.

    Attributes:
        off: what no means, in the app's form.
        on: what yes means there.
    """

    off: str = "no"
    on: str = "yes"

    what = "true or false"


@dataclass(frozen=True, kw_only=True)
class Weighed(Stated):
    """Names and their weights, as pairs, which a file has as a mapping in the place of a word.

    Attributes:
        instead_of: the attribute of the word; where something weighs, the word does not count.
        of: the noun whose stated attributes can be weighed (`zerorev.model.measures`).
    """

    instead_of: str
    of: type

    what = "a mapping of criteria to weights"


_KNOWN: dict[type[Any], tuple[Stated, ...]] = {}


def stated(noun: type[Any]) -> tuple[Stated, ...]:
    """The statements of a noun's attributes in order, each with its name and default.

    Args:
        noun: a dataclass or a NamedTuple; attributes without a statement are left out.
    """
    if noun not in _KNOWN:
        _KNOWN[noun] = tuple(_stated(noun))
    return _KNOWN[noun]


def _stated(noun: type[Any]) -> Iterator[Stated]:
    hints, group = get_type_hints(noun, include_extras=True), ""
    for name, given in _attributes(noun):
        for said in getattr(hints[name], "__metadata__", ()):
            if isinstance(said, Stated):
                group, default = said.group or group, UNSET if given is MISSING else given
                yield replace(said, name=name, default=default, group=group)


def _attributes(noun: type[Any]) -> list[tuple[str, Any]]:
    """Names and defaults of the attributes of a dataclass or a NamedTuple."""
    if is_dataclass(noun):
        return [(field.name, field.default) for field in fields(noun)]
    return [(name, noun._field_defaults.get(name, MISSING)) for name in noun._fields]


def check(noun: object) -> None:
    """Refuse a noun with an attribute that is out of range.

    Raises:
        InputError: with the attribute's name, and what would be accepted.
    """
    for each in stated(type(noun)):
        accepted = each.refused(getattr(noun, each.name), noun)
        if accepted:
            raise InputError("out of range", where=each.name, accepted=accepted)


def scaled(noun: N, factor: float) -> N:
    """The noun at another size: lengths times the factor, rates per length divided by it (theory §6).

    Args:
        noun: a dataclass with stated numbers.
        factor: above 0; with a power of two no digit changes.
    """
    changed: dict[str, Any] = {}
    for each in stated(type(noun)):
        value, power = getattr(noun, each.name), factor ** abs(each.unit.length)
        if each.unit.length != 0 and value is not None:
            changed[each.name] = value * power if each.unit.length > 0 else value / power
    return replace(noun, **changed)  # type: ignore[type-var]


def with_attributes(noun: type) -> str:
    """A noun's docstring with what each stated attribute is, in the units inside."""
    text = cleandoc(noun.__doc__ or "")
    lines = [text] if "\nAttributes:" in text else [text, "", "Attributes:"]
    for each in stated(noun):
        unit = f" [{each.unit.si}]" if each.unit.si else ""
        nothing = "None" if getattr(each, "null", None) is None else "NaN"
        none = f"; {nothing}: {each.none}" if each.none else ""
        choices = isinstance(each, Choice) or not each.means
        means = each.described.partition("; or null: ")[0] if choices else f"{each.means}{unit}{none}"
        lines.append(f"    {each.name}: {means}.")
    return "\n".join(lines)
