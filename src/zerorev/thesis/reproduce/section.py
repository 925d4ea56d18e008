"""What a section of the reproduction is: text, results side by side, tables and pictures; as plain data and back."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from zerorev.files.text import csv_text

__all__ = ["Cell", "Column", "Picture", "Result", "Section", "Table"]

Cell = str | int | float | None
NOTHING = "–"


@dataclass(frozen=True)
class Column:
    """A column of a table.

    Attributes:
        name: its heading.
        unit: of its numbers, or an empty string.
        digits: after the point, as shown; the file has them all.
    """

    name: str
    unit: str = ""
    digits: int = 1

    @property
    def heading(self) -> str:
        """Name and unit."""
        return f"{self.name} [{self.unit}]" if self.unit else self.name

    def shown(self, cell: Cell) -> str:
        """A cell as the page has it."""
        if cell is None:
            return NOTHING
        if isinstance(cell, float):
            fits = not cell or 0.5 * 10.0**-self.digits <= abs(cell) < 1e7
            text = f"{cell:.{self.digits}f}" if fits else f"{cell:.1e}"
            return text.replace("-", "−")
        return str(cell)


@dataclass(frozen=True)
class Table:
    """Numbers by row, for the page and as a file.

    Attributes:
        name: of its file, without ending.
        caption: one sentence.
        columns: headings, units, digits.
        rows: of as many cells as there are columns; None where there is nothing.
    """

    name: str
    caption: str
    columns: tuple[Column, ...]
    rows: tuple[tuple[Cell, ...], ...]

    def csv(self) -> str:
        """The table as a CSV file, units in its heading, every digit."""
        return csv_text([[column.heading for column in self.columns], *self.rows])

    @property
    def shown(self) -> list[list[str]]:
        """The rows as the page has them."""
        return [[column.shown(cell) for column, cell in zip(self.columns, row, strict=True)] for row in self.rows]

    @property
    def numeric(self) -> list[bool]:
        """Whether a column is one of numbers."""
        return [not any(isinstance(row[k], str) for row in self.rows) for k in range(len(self.columns))]


@dataclass(frozen=True)
class Picture:
    """A figure.

    Attributes:
        name: of its file, without ending.
        caption: one or two sentences: what to see.
        png: the file's bytes.
    """

    name: str
    caption: str
    png: bytes


@dataclass(frozen=True)
class Result:
    """One result of the thesis, and ours beside it.

    Attributes:
        what: is compared, with its unit.
        thesis: its number, or a description of its figure.
        source: where the thesis has it.
        own: ours by the thesis' own method.
        exact: ours by the exact method, or an empty string where there is none.
        remark: a sentence on the difference.
    """

    what: str
    thesis: str
    source: str
    own: str
    exact: str
    remark: str


@dataclass(frozen=True)
class Section:
    """What one part of the thesis became.

    Attributes:
        text: paragraphs of plain text.
        results: side by side.
        tables: for the page and as files.
        pictures: likewise.
    """

    text: tuple[str, ...]
    results: tuple[Result, ...]
    tables: tuple[Table, ...] = ()
    pictures: tuple[Picture, ...] = ()

    def data(self) -> dict[str, Any]:
        """Plain data, for a file; of pictures all but the bytes."""
        return {
            "text": list(self.text),
            "results": [vars(result) for result in self.results],
            "tables": [
                {
                    "name": table.name,
                    "caption": table.caption,
                    "columns": [vars(column) for column in table.columns],
                    "rows": [list(row) for row in table.rows],
                }
                for table in self.tables
            ],
            "pictures": [{"name": picture.name, "caption": picture.caption} for picture in self.pictures],
        }

    @staticmethod
    def of(data: dict[str, Any], pictures: dict[str, bytes]) -> Section:
        """From plain data and the bytes of the pictures by name."""
        return Section(
            tuple(data["text"]),
            tuple(Result(**result) for result in data["results"]),
            tuple(
                Table(
                    table["name"],
                    table["caption"],
                    tuple(Column(**column) for column in table["columns"]),
                    tuple(tuple(row) for row in table["rows"]),
                )
                for table in data["tables"]
            ),
            tuple(Picture(each["name"], each["caption"], pictures[each["name"]]) for each in data["pictures"]),
        )
