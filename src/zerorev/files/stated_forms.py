"""From the statements of a noun's attributes (`zerorev.model.stated`) to its form in files, and between the two.

Millimetres and degrees end and begin here: `noun_from` reads, `data_of` writes.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Collection
from typing import Annotated, Any, Literal, TypeVar

import numpy as np
from pydantic import AfterValidator, BaseModel, ConfigDict, Discriminator, Field, Tag, create_model

from zerorev.errors import InputError
from zerorev.files.units import plain
from zerorev.model.measures import criteria
from zerorev.model.stated import UNSET, Choice, Number, Six, Stated, Switch, Weighed, Whole, stated
from zerorev.model.stated_arrays import Tensor, Three
from zerorev.model.stated_figures import Count, Figure, SixCounts, SixFigures, Text, Texts
from zerorev.visible import one_line

__all__ = [
    "Counted", "Form", "Many", "Measured", "SixCounted", "SixMeasured", "Words", "agree", "data_of", "default_of",
    "keys_of", "kind", "noun_from",
]  # fmt: skip

N = TypeVar("N")
F = TypeVar("F", bound="Form")
Entry = TypeVar("Entry")

# no more is said of a long list than what is wrong with the first bad entry
Many = Annotated[list[Entry], Field(fail_fast=True)]
Words = Annotated[str, Field(max_length=10_000), AfterValidator(one_line)]
Measured = Annotated[float, Field(ge=-1e15, le=1e15)]
SixMeasured = Annotated[list[Measured | None], Field(min_length=6, max_length=6)]
Counted = Annotated[int, Field(ge=0, le=10**9)]
SixCounted = Annotated[list[Counted], Field(min_length=6, max_length=6)]
Weight = Annotated[float, Field(ge=0, le=1e15)]


class Form(BaseModel):
    """Strict: text is not a number, true is not 1, NaN is not accepted, and an unknown key is an error."""

    # built at the first use, so that `import zerorev` need not wait for it
    model_config = ConfigDict(strict=True, extra="forbid", allow_inf_nan=False, frozen=True, defer_build=True)


def kind(value: object) -> str | None:
    """The tag of a union's member; `validation.TAGS` has all of them, so that messages can leave them out of a path."""
    tags: dict[type, str] = {str: "<text>", list: "<list>", dict: "<mapping>"}
    return tags.get(type(value))


def keys_of(
    noun: type,
    only: Collection[str] | None = None,
    *,
    needed: bool = False,
    or_null: bool = False,
    optional: bool = False,
) -> Callable[[type[F]], type[F]]:
    """Gives a form a key for each stated attribute of a noun; one that the form names keeps its place.

    Args:
        noun: a dataclass.
        only: names of the attributes that get one; None: all.
        needed: whether a file has to have all of them, regardless of the defaults of the noun, but those added later.
        or_null: whether all may be null, because there is no such noun.
        optional: whether all may be null or left out, because there need not be such a noun.
    """

    def with_keys(form: type[F]) -> type[F]:
        keys: dict[str, Any] = {}
        nests: dict[str, list[Stated]] = {}
        for each in _chosen(noun, only):
            if isinstance(each, Weighed):
                word = _word_of(noun, each)
                keys[word.path[0]] = _word_or_weights(word, each)
            elif each.nest is not None:
                nests.setdefault(each.nest.key, []).append(each)
                keys[each.nest.key] = _nested(nests[each.nest.key])
            else:
                if isinstance(each, SixCounts) and each.total:
                    keys[each.total] = (Counted, Field(description="a whole number: reversals of all joints"))
                keys[each.path[0]] = _key(each, needed)
        if optional:
            left_out = {key: Field(default=None, description=rest.description) for key, (_, rest) in keys.items()}
            keys = {key: (accepted | None, left_out[key]) for key, (accepted, _) in keys.items()}
        if or_null:
            keys = {key: (accepted | None, rest) for key, (accepted, rest) in keys.items()}
        return _form(form.__name__, form.__doc__, keys, form, form.__module__)

    return with_keys


def _form(name: str, means: str | None, keys: dict[str, Any], base: type[F], module: str = __name__) -> type[F]:
    return create_model(name, __base__=base, __doc__=means, __module__=module, **keys)


def _chosen(noun: type, only: Collection[str] | None) -> list[Stated]:
    return [each for each in stated(noun) if only is None or each.name in only]


def _word_of(noun: type, weighed: Weighed) -> Stated:
    """The word in the place of which a mapping of weights may stand."""
    return next(each for each in stated(noun) if each.name == weighed.instead_of)


def _key(each: Stated, needed: bool) -> tuple[Any, Any]:
    """The type of a key, and its default and description."""
    accepted = _accepted(each)
    default: dict[str, Any] = {}
    if each.added or each.before is not UNSET:
        default = {"default": None}
    elif each.default is not UNSET and not needed:
        default = {"default": default_of(each)}
    return (accepted | None if each.nullable else accepted), Field(description=each.described, **default)


def _accepted(each: Stated) -> Any:
    """The type of what a file may have but for null."""
    match each:
        case SixFigures():
            return SixMeasured
        case Six() | Tensor():
            return Annotated[list[Annotated[float, _span(each)]], Field(min_length=6, max_length=6)]
        case Three():
            return Annotated[list[Annotated[float, _span(each)]], Field(min_length=3, max_length=3)]
        case Whole():
            return Annotated[int, _span(each)]
        case Number():
            return Annotated[float, _span(each)]
        case Count():
            return Counted
        case SixCounts():
            return SixCounted
        case Choice():
            return Literal[tuple(each.words)]
        case Switch():
            return bool
        case Text():
            return Words
        case Texts():
            return Many[Words]
    raise TypeError(f"{each.name}: no key of a {type(each).__name__}")


def _span(number: Number) -> Any:
    most = next(each for each in (number.to, number.most, number.unit.most) if each is not None)
    if number.above is not None:
        return Field(gt=number.above, le=most)
    return Field(ge=-most if number.least is None else number.least, le=most)


def _nested(inner: list[Stated]) -> tuple[Any, Any]:
    """A key below which attributes stand, all of one kind."""
    first = inner[0]
    assert first.nest is not None
    name = first.nest.key.split("_")[0].capitalize()
    form = _form(f"{name}Form", first.nest.means, {each.path[-1]: _key(each, needed=False) for each in inner}, Form)
    keys = " and ".join(each.path[-1] for each in inner)
    return form, Field(
        default=form(), description=f"a mapping of {keys}, each{first.accepted.removeprefix('a number')}"
    )


def _word_or_weights(word: Stated, weighed: Weighed) -> tuple[Any, Any]:
    """One word, or a mapping of what weighs instead."""
    weights: dict[str, Any] = {}
    for each in criteria(weighed.of).values():
        needs = "; needs joint_stiffness_nm_per_rad" if each.needs_stiffness else ""
        needs += "; needs dynamics in the robot file" if each.needs_dynamics else ""
        weights[each.name] = (
            Weight,
            Field(default=0.0, description=f"a number, 0 or more: weight of {each.weighs}{needs}"),
        )
    means = "What a motion is judged by beside its reversals: the weighted sum of these is to be least."
    form = _form("WeightsForm", means, weights, Form)
    either: Any = Annotated[_accepted(word), Tag("<text>")] | Annotated[form, Tag("<mapping>")]
    words = f"{word.accepted}, or {weighed.accepted}{word.joined}{word.means}"
    return Annotated[either, Discriminator(kind)], Field(default=word.default, description=words)


def noun_from(
    noun: type[N],
    form: Form,
    only: Collection[str] | None = None,
    *,
    before: bool = False,
    where: str = "",
    **others: Any,
) -> N:
    """The noun of a form that has the keys of its stated attributes.

    Args:
        noun: a dataclass.
        form: as it was read.
        only: names of the attributes that the form has keys of; None: all.
        before: whether a key that is missing means what it meant before it existed, as in a file of answers.
        where: of the form, for messages; with a point at its end.
        others: the attributes without a statement, but those that have a default.

    Raises:
        InputError: numbers that the noun does not accept, or that contradict each other.
    """
    values: dict[str, Any] = {}
    for each in _chosen(noun, only):
        if isinstance(each, Weighed):
            value = getattr(form, _word_of(noun, each).path[0])
            if isinstance(value, Form):
                values |= {each.name: _weights(value, each), each.instead_of: getattr(noun, each.instead_of)}
            continue
        value = form
        for key in each.path:
            value = getattr(value, key)
        if value is None and each.before is not UNSET:
            values[each.name] = each.before if before else each.default
            continue
        if isinstance(each, SixCounts) and each.total:
            agree(f"{where}{each.total}", getattr(form, each.total), sum(value))
        values[each.name] = _inside(each, value)
    return noun(**values, **others)


def agree(name: str, stated: Any, found: Any, tolerance: float = 0.0) -> None:
    """Refuse a field that is not what it has to be beside the others.

    Raises:
        InputError: it is not.
    """
    if stated == found or (isinstance(found, float) and isinstance(stated, float) and abs(stated - found) <= tolerance):
        return
    what = f"contradicts the fields beside it: stated {json.dumps(stated)}, found {json.dumps(found)}"
    raise InputError(what, where=name, accepted="a plan file as zerorev wrote it")


def _weights(form: Form, weighed: Weighed) -> tuple[tuple[str, float], ...]:
    """The criteria that weigh anything."""
    weights = tuple((name, weight) for name, weight in form.model_dump().items() if weight > 0)
    if not weights:
        where = weighed.instead_of
        raise InputError("no criterion weighs anything", where=where, accepted="one weight or more above 0")
    return weights


def data_of(noun: Any, only: Collection[str] | None = None) -> dict[str, Any]:
    """The stated attributes of a noun as a file holds them; all, or those named."""
    data: dict[str, Any] = {}
    for each in _chosen(type(noun), only):
        value = getattr(noun, each.name)
        if isinstance(each, Weighed):
            word = _word_of(type(noun), each)
            data[word.path[0]] = dict(value) or data[word.path[0]]
            continue
        if isinstance(each, SixCounts) and each.total:
            data[each.total] = sum(value)
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
    match each:
        case SixFigures() if value is not None:
            return each.unit.inside(np.array(value, dtype=np.float64))
        case Figure() if value is None:
            return each.null
        case _ if value is None:
            return None
        case Three():
            return each.unit.inside(np.array(value, dtype=np.float64))
        case Tensor():
            xx, xy, xz, yy, yz, zz = (float(each.unit.inside(one)) for one in value)
            return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
        case Six():
            return tuple(float(each.unit.inside(one)) for one in value)
        case Whole():
            return value
        case Number():
            return float(each.unit.inside(value))
    return tuple(value) if isinstance(value, list) else value


def _outside(each: Stated, value: Any) -> Any:
    """What a file holds of a value in SI and radians."""
    if value is None or isinstance(each, Whole) or not isinstance(each, Number):
        return value
    if isinstance(each, Tensor):
        value = value[[0, 0, 0, 1, 1, 2], [0, 1, 2, 1, 2, 2]]
    return each.unit.outside(np.asarray(value, dtype=np.float64))
