"""The tables of the documentation that are made from the code: settings, criteria, robots, the rooms of the house.

A page has a table between two marks, `<!-- settings: made by make reference -->` and `<!-- end of settings -->`.
`python tools/tables.py` rewrites them; a test fails where one is out of date.
"""

from __future__ import annotations

import ast
import re
import tomllib
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path

from zerorev.files.io import read_robot, robot_names
from zerorev.files.stated_forms import default_of
from zerorev.model.measures import CRITERIA
from zerorev.model.settings import Settings
from zerorev.model.stated import Choice, Stated, Weighed, stated

ROOT = Path(__file__).parents[1]
PAGES, HOUSE = ROOT / "docs", ROOT / "src" / "zerorev"


def settings_table() -> str:
    """Key, default and meaning of each setting."""
    return _table(("key", "default", "meaning"), _settings())


def _settings() -> Iterator[tuple[str, ...]]:
    mappings = {each.instead_of: each.accepted for each in stated(Settings) if isinstance(each, Weighed)}
    for each in stated(Settings):
        if isinstance(each, Weighed):
            continue
        words = each.described
        if each.name in mappings:
            words = words.replace(each.accepted, f"{each.accepted}, or {mappings[each.name]}", 1)
        for word in each.words if isinstance(each, Choice) else ():
            words = words.replace(f"{word} (", f"`{word}` (", 1)
        yield f"`{'.'.join(each.path)}`", _default(each), f"{words}. {each.note}".removesuffix(". ")


def _default(each: Stated) -> str:
    match default_of(each):
        case None:
            return "null"
        case bool(value):
            return str(value).lower()
        case str(value):
            return f"`{value}`"
        case [value, *_]:
            return f"six times {value:g}"
        case value:
            return f"{value:.10g}"


def criteria_table() -> str:
    """Name, cost and key in a plan file of each criterion."""
    rows = ((f"`{each.name}`", each.cost, f"`{each.path[-1]}`") for each in CRITERIA.values())
    return _table(("criterion", "cost", "figure in a plan file"), rows)


def robots_table() -> str:
    """The robots that ship, and how their controllers count."""
    return _table(
        (
            "name",
            "robot",
            "reach of the wrist",
            "load",
            "second source",
            "J3 on the pendant",
            "its base lies higher by",
            "pulses",
        ),
        _robots(),
    )


def _robots() -> Iterator[tuple[str, ...]]:
    for robot in map(read_robot, robot_names()):
        height = robot.T_root_base[2, 3] * 1e3
        yield (
            f"`{robot.name}`",
            f"{robot.manufacturer} {robot.model}",
            f"{robot.wrist_reach * 1e3:.0f} mm",
            f"{robot.rated_load:g} kg" if robot.rated_load is not None else "",
            "✓" if any("agrees" in line for line in robot.second_sources) else "",
            "against the ground" if robot.display.j3_less_j2 else "",
            f"{height:g} mm" if height else "",
            "known" if robot.pulses_per_deg else "",
        )


def rooms_table() -> str:
    """What each room is about and what is in it, in the order of the layers that import-linter checks."""
    return _table(("room", "what it is", "in it"), _rooms())


def _rooms() -> Iterator[tuple[str, ...]]:
    (layers,) = (
        contract["layers"]
        for contract in tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["tool"]["importlinter"][
            "contracts"
        ]
        if contract["type"] == "layers"
    )
    for name in (each.strip() for layer in layers for each in layer.split("|")):
        if not name.startswith("("):  # the place of a room that is to come
            yield f"`{name}`", _sentence(name), _inside(HOUSE / name)


def _sentence(room: str) -> str:
    """The first sentence of a room's docstring."""
    path = HOUSE / room / "__init__.py" if (HOUSE / room).is_dir() else HOUSE / f"{room}.py"
    words = ast.get_docstring(ast.parse(path.read_text(encoding="utf-8"))) or ""
    return words.partition("\n\n")[0].replace("\n", " ")


def _inside(folder: Path) -> str:
    """Names of the modules and folders of a room, those for itself left out."""
    if not folder.is_dir():
        return ""
    paths = (path for path in folder.iterdir() if path.suffix == ".py" or (path / "__init__.py").exists())
    names = sorted(path.stem for path in paths if not path.name.startswith("__"))
    return ", ".join(f"`{name}`" for name in names)


TABLES: dict[str, Callable[[], str]] = {
    "settings": settings_table,
    "criteria": criteria_table,
    "robots": robots_table,
    "rooms": rooms_table,
}


def with_tables(text: str) -> str:
    """A page with its tables as they have to be."""
    for name, table in TABLES.items():
        begin, end = f"<!-- {name}: made by make reference -->\n", f"<!-- end of {name} -->\n"
        before, found, rest = text.partition(begin)
        if found:
            text = f"{before}{begin}\n{table()}\n{end}{rest.partition(end)[2]}"
    return text


def pages() -> Iterator[tuple[Path, str, str]]:
    """The pages that have a table: where, as they are, and as they have to be."""
    for page in sorted(PAGES.rglob("*.md")):
        text = page.read_text(encoding="utf-8")
        if any(re.search(f"<!-- {name}: made by", text) for name in TABLES):
            yield page, text, with_tables(text)


def _table(head: tuple[str, ...], rows: Iterable[tuple[str, ...]]) -> str:
    lines = [f"| {' | '.join(row)} |\n" for row in (head, *rows)]
    return "".join([lines[0], f"|{'---|' * len(head)}\n", *lines[1:]])


if __name__ == "__main__":
    for page, _, made in pages():
        page.write_text(made, encoding="utf-8")
