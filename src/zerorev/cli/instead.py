"""The options that take the place of the job's settings: one for each that is a single value, as it is stated."""

from __future__ import annotations

from dataclasses import fields, make_dataclass
from typing import TYPE_CHECKING, Annotated, Any, Literal

from cyclopts import Group, Parameter

from zerorev.cli.common import Whole
from zerorev.model import stated
from zerorev.model.settings import Settings

__all__ = ["Instead", "given", "options_of"]

GROUP = Group("Instead of the job's settings", sort_key=1)


def options_of(noun: type[Settings]) -> type[Any]:
    """A dataclass of options, all None where they are not given, each named like its key in a job file.

    Args:
        noun: whose stated attributes they are.
    """
    options = [_option(each) for each in stated.stated(noun) if _type(each) is not None]
    return make_dataclass(
        "Instead", options, namespace={"__module__": __name__}
    )  # else cyclopts takes it for a builtin


def _type(each: stated.Stated) -> Any:
    """What an option accepts; None where it takes more than one value."""
    match each:
        case stated.Six() | stated.Weighed():
            return None
        case stated.Whole():
            return Whole
        case stated.Number():
            return float
        case stated.Choice():
            return Literal[tuple(each.words)]
    return bool


def _option(each: stated.Stated) -> tuple[str, Any, None]:
    name = "__".join(each.path)
    flag = f"--{'-'.join(each.path).replace('_', '-')}"
    negative = f"--no-{flag[2:]}" if isinstance(each, stated.Switch) else ()
    words = (
        each.means
        if isinstance(each, stated.Switch)
        else f"{each.accepted}{each.joined * bool(each.means)}{each.means}"
    )
    parameter = Parameter(name=flag, negative=negative, group=GROUP, help=f"{words[0].upper()}{words[1:]}.")
    return name, Annotated[_type(each) | None, parameter], None


if TYPE_CHECKING:
    Instead = Any
else:
    Instead = Annotated[options_of(Settings) | None, Parameter(name="*")]


def given(instead: Any) -> dict[str, Any]:
    """The options that were given, as keys of a job.

    Args:
        instead: as the command got it.
    """
    keys: dict[str, Any] = {}
    for each in fields(instead) if instead is not None else ():
        value = getattr(instead, each.name)
        if value is not None:
            nest, _, key = each.name.rpartition("__")
            (keys.setdefault(nest, {}) if nest else keys)[key] = value
    return keys
