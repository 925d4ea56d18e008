"""The holes of a CAD file as a table that a job reads, for a person to look through and to edit."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from zerorev.files.cad.as_listed import CadHoles
from zerorev.files.table_layout import DIRECTION, ENTRY
from zerorev.files.text import csv_text

__all__ = ["COLUMNS", "csv_of", "rows_of"]

COLUMNS = ("id", *ENTRY, *DIRECTION, "depth_mm", "group", "diameter_mm", "kind", "mouth", "of", "assumed")
DIGITS = 9  # of millimetres
DIRECTION_DIGITS = 12


def rows_of(listed: CadHoles) -> Iterator[dict[str, Any]]:
    """The holes as plain data, by `COLUMNS`; what the file does not say is None.

    Args:
        listed: as a job has them: the depth is that of the stroke.
    """
    for hole, form in zip(listed.holes, listed.forms, strict=True):
        entry = (float(value) for value in np.round(hole.entry, DIGITS) + 0.0)
        direction = (float(value) for value in np.round(hole.direction, DIRECTION_DIGITS) + 0.0)
        yield {
            "id": hole.id,
            **dict(zip(ENTRY, entry, strict=True)),
            **dict(zip(DIRECTION, direction, strict=True)),
            "depth_mm": None if form.depth_mm is None else round(form.depth_mm, DIGITS),
            "group": form.group,
            "diameter_mm": None if hole.diameter is None else round(hole.diameter, DIGITS),
            "kind": " ".join(hole.kinds),
            "mouth": hole.mouth or None,
            "of": hole.of or None,
            "assumed": "; ".join(hole.notes) or None,
        }


def csv_of(listed: CadHoles) -> str:
    """The table: its points are entries, by the names of its columns.

    Args:
        listed: the holes.
    """
    return csv_text([COLUMNS, *([row[name] for name in COLUMNS] for row in rows_of(listed))])
