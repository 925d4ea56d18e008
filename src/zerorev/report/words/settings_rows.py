"""The settings of a job as rows of a table: key and value as a job file has them."""

from __future__ import annotations

from typing import Any

from zerorev.files.conversion import settings_data
from zerorev.model.settings import Settings

__all__ = ["settings_rows"]


def settings_rows(settings: Settings) -> list[tuple[str, str, bool]]:
    """Key, value, and whether it is other than by default."""
    usual = settings_data(Settings())
    return [(key, _value(value), value != usual.get(key)) for key, value in settings_data(settings).items()]


def _value(value: Any) -> str:
    if value is None or value in ("", [], {}):
        return "–"
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, float | int):
        return f"{value:g}"
    if isinstance(value, dict):
        given = {key: _value(inner) for key, inner in value.items()}
        return ", ".join(f"{key} {inner}" for key, inner in given.items() if inner != "–") or "–"
    return value if isinstance(value, str) else ", ".join(map(_value, value))
