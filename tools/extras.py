"""The table of docs/reference/extras.md: what each extra of pyproject brings, and what it weighs.

`python tools/extras.py` measures, in an environment with all of them, what lies on the disk, and rewrites the page.
"""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterable
from importlib.metadata import Distribution, distribution
from pathlib import Path

from packaging.requirements import Requirement

ROOT = Path(__file__).parents[1]
PAGE = ROOT / "docs/reference/extras.md"
FOR_USERS = {
    "figures": "pictures: `--figures`, `--figure`, `recordings compare`, `zerorev.figures`",
    "certify": "`check --certify`, `--tolerance` and `--proof`",
    "maps": "`map`, `map show`, `map compare`, `parameter-map`; pages with a slice to move (`--page`, with `figures`)",
    "cluster": "`--scheduler`: work on several machines; includes `maps`",
    "view": "the app (`view`) and `replay`; includes `certify`, `figures` and `maps`",
    "methods": "the methods of pymoo and cma in `methods`",
    "cad": "holes and parts from CAD: STEP, DXF, STL",
    "xacro": "`robots import` of xacro files",
    "report": "`plan` and `check --report`, `reproduce`: plan or thesis as one page; includes `figures` and `maps`",
}
HEAD = """\
# Extras

`pip install zerorev` brings what plans, checks and exports. Everything else is an extra:
`pip install 'zerorev[figures]'`, or several, `'zerorev[figures,certify]'`. A command whose extra is missing names
it and stops before it does any work. The sizes are those on the disk, on Linux, measured by `python tools/extras.py`;
what several extras share counts for each. The compiled kernels take another 60 MB in the cache.

| extra | for | packages | MB |
|---|---|---|---|
"""


def needed(requirements: Iterable[str], known: dict[str, Distribution]) -> dict[str, Distribution]:
    """The distributions that are needed, with all that they depend on.

    Args:
        requirements: as pyproject writes them.
        known: distributions already there; they are not followed again.
    """
    for text in requirements:
        each = Requirement(text)
        if each.name == "zerorev":
            for extra in sorted(each.extras):
                needed(_extras()[extra], known)
            continue
        name = re.sub("[-_.]+", "-", each.name).lower()
        if name in known and not each.extras:
            continue
        known[name] = found = distribution(each.name)
        asked = [{"extra": extra} for extra in ("", *each.extras)]
        inner = [Requirement(line) for line in found.requires or ()]
        wanted = [one for one in inner if one.marker is None or any(one.marker.evaluate(given) for given in asked)]
        needed((f"{one.name}[{','.join(one.extras)}]" if one.extras else one.name for one in wanted), known)
    return known


def table() -> str:
    """One row per extra, after what the base weighs."""
    base = needed(_project()["dependencies"], {})
    rows = [
        _row(
            "", "`plan`, `check`, `export`, `depth`, `place`, `share`, `offset`, `rates`, `recordings`, `robots`", base
        )
    ]
    for extra, words in FOR_USERS.items():
        every = needed(_extras()[extra], dict(base))
        rows.append(_row(f"`{extra}`", words, {name: every[name] for name in every if name not in base}))
    return "".join(rows)


def _row(extra: str, words: str, found: dict[str, Distribution]) -> str:
    size = sum(_size(each) for each in found.values())
    return f"| {extra or '(none)'} | {words} | {len(found)} | {max(1, round(size / 1e6))} |\n"


def _size(found: Distribution) -> int:
    """What its files take on the disk [bytes]."""
    paths = (Path(str(found.locate_file(file))) for file in found.files or ())
    return sum(path.stat().st_blocks * 512 for path in paths if path.exists())


def _project() -> dict[str, list[str]]:
    found: dict[str, list[str]] = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    return found


def _extras() -> dict[str, list[str]]:
    return dict(_project()["optional-dependencies"])


if __name__ == "__main__":
    PAGE.write_text(HEAD + table(), encoding="utf-8")
