"""From the statements of a noun's attributes (`zerorev.model.stated`) to its form in files, and between the two.

Millimetres and degrees end and begin here: `noun_from` reads, `data_of` writes.
"""

from __future__ import annotations

import math
from typing import Annotated, Any, Literal, TypeVar

from pydantic import BaseModel, ConfigDict, Discriminator, Field, Tag, create_model

from zerorev.errors import InputError
from zerorev.files.units import plain
from zerorev.model.measures import criteria
from zerorev.model.stated import UNSET, Choice, Measured, Number, Six, Stated, Switch, Weighed, Whole, stated

__all__ = ["Form", "data_of", "default_of", "form_of", "kind", "noun_from"]

N = TypeVar("N")

MOST_WEIGHT = 1e15


class Form(BaseModel):
    """Strict: text is no number, true is no 1, NaN is nothing at all, and an unknown key is an error."""

    # built at the first use, so that `import zerorev` need not wait for it
    model_config = ConfigDict(strict=True, extra="forbid", allow_inf_nan=False, frozen=True, defer_build=True)


def kind(value: object) -> str | None:
    """The tag of a union's member; `validation.TAGS` has all of them, so that messages can leave them out of a path."""
    tags: dict[type, str] = {str: "<text>", list: "<list>", dict: "<mapping>"}
    return tags.get(type(value))


def form_of(noun: type, name: str, means: str) -> type[Form]:
    """The form of a noun's stated attributes in a file.

    Args:
        noun: a dataclass.
        name: of the form, in the published schema.
        means: what is in it, one sentence.
    """
    fields: dict[str, Any] = {}
    nests: dict[str, list[Stated]] = {}
    for each in stated(noun):
        if isinstance(each, Weighed):
            word = next(one for one in stated(noun) if one.name == each.instead_of)
            fields[word.path[0]] = _word_or_weights(word, each)
        elif each.nest is not None:
            nests.setdefault(each.nest.key, []).append(each)
            fields[each.nest.key] = _nested(nests[each.nest.key])
        else:
            fields[each.path[0]] = _field(each)
    return _made(name, means, fields)


def _made(name: str, means: str, fields: dict[str, Any]) -> type[Form]:
    return create_model(name, __base__=Form, __doc__=means, __module__=__name__, **fields)


def _field(each: Stated) -> tuple[Any, Any]:
    """The type of a field and the rest that pydantic is told of it."""
    accepted = _accepted(each)
    default: dict[str, Any] = {}
    if each.before is not UNSET or (isinstance(each, Measured) and each.added):
        default = {"default": None}
    elif each.default is not UNSET:
        default = {"default": default_of(each)}
    return (accepted | None if each.nullable else accepted), Field(description=each.described, **default)


def _accepted(each: Stated) -> Any:
    """The type of what a file may have but for null."""
    match each:
        case Six():
            return Annotated[list[Annotated[float, _span(each)]], Field(min_length=6, max_length=6)]
        case Whole():
            return Annotated[int, _span(each)]
        case Number():
            return Annotated[float, _span(each)]
        case Choice():
            return Literal[tuple(each.words)]
        case Switch():
            return bool
    raise TypeError(f"{each.name}: no form of a {type(each).__name__}")


def _span(number: Number) -> Any:
    most = number.unit.most if number.most is None else number.most
    if number.above is not None:
        return Field(gt=number.above, le=most)
    return Field(ge=-most if number.least is None else number.least, le=most)


def _nested(inner: list[Stated]) -> tuple[Any, Any]:
    """A key below which attributes stand, all of one kind."""
    first = inner[0]
    assert first.nest is not None
    name = first.nest.key.split("_")[0].capitalize()
    form = _made(f"{name}Form", first.nest.means, {each.path[-1]: _field(each) for each in inner})
    words = (
        f"a mapping of {' and '.join(each.path[-1] for each in inner)}, each{first.accepted.removeprefix('a number')}"
    )
    return form, Field(default=form(), description=words)


def _word_or_weights(word: Stated, weighed: Weighed) -> tuple[Any, Any]:
    """One word, or a mapping of what weighs instead."""
    weights: dict[str, Any] = {}
    for each in criteria(weighed.of).values():
        needs = "; needs joint_stiffness_nm_per_rad" if each.needs_stiffness else ""
        text = f"a number, 0 or more: weight of {each.weighs}{needs}"
        weights[each.name] = (Annotated[float, Field(ge=0, le=MOST_WEIGHT)], Field(default=0.0, description=text))
    means = "What a motion is judged by beside its reversals: the weighted sum of these is to be least."
    form = _made("WeightsForm", means, weights)
    either: Any = Annotated[_accepted(word), Tag("<text>")] | Annotated[form, Tag("<mapping>")]
    words = f"{word.accepted}, or {weighed.accepted}{word.joined}{word.means}"
    return Annotated[either, Discriminator(kind)], Field(default=word.default, description=words)


def noun_from(noun: type[N], form: Form, *, before: bool = False) -> N:
    """The noun of a form that `form_of` made of it, or of one that has its keys.

    Args:
        noun: a dataclass; attributes without a statement have to have a default.
        form: as it was read.
        before: whether a key that is missing means what it meant before it existed, as in a file of answers.

    Raises:
        InputError: numbers that the noun does not accept.
    """
    values: dict[str, Any] = {}
    for each in stated(noun):
        value: Any = form
        if isinstance(each, Weighed):
            value = getattr(form, next(one for one in stated(noun) if one.name == each.instead_of).path[0])
            if isinstance(value, Form):
                values |= {each.name: _weights(value, each), each.instead_of: getattr(noun, each.instead_of)}
            continue
        for key in each.path:
            value = getattr(value, key)
        if value is None and each.before is not UNSET:
            values[each.name] = each.before if before else each.default
        else:
            values[each.name] = _inside(each, value)
    return noun(**values)


def _weights(form: Form, weighed: Weighed) -> tuple[tuple[str, float], ...]:
    """The criteria that weigh anything."""
    weights = tuple((name, weight) for name, weight in form.model_dump().items() if weight > 0)
    if not weights:
        where = weighed.instead_of
        raise InputError("no criterion weighs anything", where=where, accepted="one weight or more above 0")
    return weights


def data_of(noun: Any) -> dict[str, Any]:
    """The stated attributes of a noun as a file holds them."""
    data: dict[str, Any] = {}
    for each in stated(type(noun)):
        value = getattr(noun, each.name)
        if isinstance(each, Weighed):
            word = next(one for one in stated(type(noun)) if one.name == each.instead_of)
            data[word.path[0]] = dict(value) or data[word.path[0]]
            continue
        place = data
        for key in each.path[:-1]:
            place = place.setdefault(key, {})
        place[each.path[-1]] = _outside(each, value)
    return dict(plain(data))


def default_of(each: Stated) -> Any:
    """What a file means that does not have it, as the file would have it."""
    return plain(_outside(each, each.default))


def _inside(each: Stated, value: Any) -> Any:
    """SI and radians of what a file holds."""
    if value is None:
        return math.nan if isinstance(each, Measured) else None
    if isinstance(each, Six):
        return tuple(float(each.unit.inside(one)) for one in value)
    return float(each.unit.inside(value)) if isinstance(each, Number) and not isinstance(each, Whole) else value


def _outside(each: Stated, value: Any) -> Any:
    """What a file holds of a value in SI and radians."""
    if isinstance(each, Six) and value is not None:
        return [each.unit.outside(float(one)) for one in value]
    if isinstance(each, Number) and not isinstance(each, Whole) and value is not None:
        return each.unit.outside(float(value))
    return value
