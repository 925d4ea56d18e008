"""The page docs/reference/commands.md, made from the help texts of the command line: `make reference`.

`python tools/commands_page.py` rewrites it; a test fails where it is out of date.
"""

from __future__ import annotations

from pathlib import Path

PAGE = Path(__file__).parents[1] / "docs/reference/commands.md"
HEAD = """\
# Commands

Written from the help texts of the commands by `make reference`; `zerorev COMMAND --help` prints the same.

| exit code | meaning |
|---|---|
| 0 | all is well; warnings do not change that |
| 1 | there is an answer, but something in it is wrong |
| 2 | an argument, an input or an output that cannot be used |
| 70 | a fault in zerorev itself |
| 130 | interrupted |
| 141 | the reader of a pipe went away |

No file is ever left half-written. [Conventions](conventions.md#exit-codes) say more about the codes.

"""


def text() -> str:
    """The whole page."""
    from zerorev.cli import app

    written = app.generate_docs(output_format="markdown")
    commands = written[written.index("\n## zerorev") + 1 :]
    lines = (line.rstrip() for line in commands.splitlines())
    return HEAD + "\n".join(lines).rstrip() + "\n"


if __name__ == "__main__":
    PAGE.write_text(text(), encoding="utf-8")
