"""What a plan file states against what is found, field by field: one sentence for each that differs."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from itertools import zip_longest
from typing import Any

from zerorev.files.plan_fields import HOLE_FIELDS, Field, field_of
from zerorev.model.finding import Finding

__all__ = ["differ", "fields_differ", "findings_differ", "leaves"]

COMPARED = ("motion", "figure", "search", "check")


def fields_differ(
    stated: Any,
    found: Any,
    slack: Mapping[str, float],
    path: str = "",
    *,
    size: float = 1.0,
    fields: dict[str, Field] = HOLE_FIELDS,
) -> Iterator[str]:
    """The fields of a hole of a plan file, or of its head, whose value is another one.

    Args:
        stated: the hole as plain data, or what stands at the path in it.
        found: likewise, as it was computed again.
        slack: by path, what the digits of the file leave open of a number besides its tolerance, in its unit.
        path: of both.
        size: of the robot (`Robot.size`); a large arm is at rest at a lower rate.
        fields: what is done with each.
    """
    if isinstance(stated, dict) and isinstance(found, dict):
        for key, value in stated.items():
            yield from fields_differ(
                value, found[key], slack, f"{path}.{key}" if path else key, size=size, fields=fields
            )
        return
    field = field_of(path, fields)
    if field is None or field.how not in COMPARED or (stated is None and field.optional):
        return
    if isinstance(stated, list) and isinstance(found, list) and len(stated) == len(found):
        for i, value in enumerate(stated):
            yield from fields_differ(value, found[i], slack, f"{path}[{i}]", size=size, fields=fields)
    elif not _same(stated, found, field._replace(nil=field.nil / size), slack.get(path, 0.0)):
        yield differ(path, stated, found)


def leaves(data: Any, path: str = "") -> Iterator[tuple[str, Any]]:
    """The values of plain data that are neither mappings nor lists, each with its path."""
    if isinstance(data, dict):
        for key, value in data.items():
            yield from leaves(value, f"{path}.{key}" if path else key)
    elif isinstance(data, list):
        for i, value in enumerate(data):
            yield from leaves(value, f"{path}[{i}]")
    else:
        yield path, data


def findings_differ(stated: Iterable[Finding], found: Iterable[Finding]) -> Iterator[str]:
    """The findings that are missing among those stated, or that nothing gives rise to."""
    stated, found = list(stated), list(found)
    missing = list((Counter(found) - Counter(stated)).elements())
    foreign = list((Counter(stated) - Counter(found)).elements())
    for there, true in zip_longest(foreign, missing):
        if there is None or true is None:
            entry = "" if there is None else f"[{stated.index(there)}]"
            yield f"findings{entry}: stated {_said(there)}, found {_said(true)}"
            continue
        for name in ("level", "kind", "message", "hole"):
            if getattr(there, name) != getattr(true, name):
                path = f"findings[{stated.index(there)}].{name}"
                yield differ(path, getattr(there, name), getattr(true, name))


def differ(path: str, stated: Any, found: Any) -> str:
    """The sentence for one field: its path, and both values with as many digits as it takes to tell them apart."""
    texts = _text(stated), _text(found)
    if isinstance(stated, float) and isinstance(found, float):
        for digits in range(6, 18):
            texts = f"{stated:.{digits}g}", f"{found:.{digits}g}"
            if texts[0] != texts[1]:
                break
    return f"{path}: stated {texts[0]}, found {texts[1]}"


def _same(stated: Any, found: Any, field: Field, slack: float) -> bool:
    if isinstance(stated, float) and isinstance(found, float):
        if 0 <= stated <= field.nil and 0 <= found <= field.nil:
            return True
        return abs(stated - found) <= field.absolute + slack + field.relative * max(abs(stated), abs(found))
    # one of them undefined, which the digits may decide
    return bool(stated == found) or (None in (stated, found) and slack == float("inf"))


def _text(value: Any) -> str:
    if isinstance(value, list) and value:
        return f"{len(value)} of them"
    return json.dumps(value, ensure_ascii=False)


def _said(finding: Finding | None) -> str:
    return "none" if finding is None else f"{finding.level} {finding.kind} {_text(finding.message)}"
