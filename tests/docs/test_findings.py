"""Every kind of finding that the code can make has its line on the page, and no line is of one that it cannot make."""

from __future__ import annotations

import ast
import re
from pathlib import Path

from zerorev.model import plan

ROOT = Path(__file__).parents[2]
SOURCES = sorted((ROOT / "src/zerorev").rglob("*.py"))
READ_FROM_A_FILE = "form.kind"  # of a plan file: made before


def _constants(node: ast.AST) -> set[str]:
    return {each.value for each in ast.walk(node) if isinstance(each, ast.Constant) and isinstance(each.value, str)}


def _of_parameter(tree: ast.Module, function: ast.FunctionDef, name: str) -> set[str]:
    """What the calls of a function in its own module give for a parameter."""
    place = [argument.arg for argument in function.args.args].index(name)
    calls = (each for each in ast.walk(tree) if isinstance(each, ast.Call) and ast.unparse(each.func) == function.name)
    return set().union(*(_constants(call.args[place]) for call in calls))


def _kinds(source: Path) -> set[str]:
    """The kinds of all findings that a module makes."""
    tree = ast.parse(source.read_text(encoding="utf-8"))
    found: set[str] = set()
    for function in (each for each in ast.walk(tree) if isinstance(each, ast.FunctionDef)):
        for call in (each for each in ast.walk(function) if isinstance(each, ast.Call)):
            if ast.unparse(call.func) != "Finding":
                continue
            kind = call.args[1]
            if isinstance(kind, ast.Name) and hasattr(plan, kind.id):
                found.add(getattr(plan, kind.id))
            elif isinstance(kind, ast.Name) and kind.id in (argument.arg for argument in function.args.args):
                found |= _of_parameter(tree, function, kind.id)
            elif isinstance(kind, ast.Name):  # out of pairs (kind, message) in the same function
                pairs = (each for each in ast.walk(function) if isinstance(each, ast.Tuple) and len(each.elts) == 2)
                found |= {
                    pair.elts[0].value
                    for pair in pairs
                    if isinstance(pair.elts[0], ast.Constant) and isinstance(pair.elts[0].value, str)
                }
            elif ast.unparse(kind) != READ_FROM_A_FILE:
                assert _constants(kind), f"{source.name}, line {call.lineno}: which kind is {ast.unparse(kind)}?"
                found |= _constants(kind)
    return found


def test_the_page_lists_the_kinds_that_the_code_makes():
    page = (ROOT / "docs/howto/findings.md").read_text(encoding="utf-8")
    listed = set(re.findall(r"(?m)^\| `([a-z_]+)` \| (?:error|warning|info)", page))
    made = set().union(*(_kinds(source) for source in SOURCES))
    assert made == listed
    assert len(made) > 25


def test_the_page_lists_the_errors():
    from zerorev import errors

    page = (ROOT / "docs/howto/findings.md").read_text(encoding="utf-8")
    assert set(re.findall(r"(?m)^\| `(\w*Error)` ", page)) == set(errors.__all__)
