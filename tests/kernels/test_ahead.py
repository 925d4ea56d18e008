"""Compiling ahead: the list is what questions call; helpers save time, and their failure costs nothing else."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import numba
import pytest
from tools.kernels_ahead import ASKED, called_for

import zerorev
from zerorev.kernels import _ahead

pytestmark = pytest.mark.skipif(bool(numba.config.DISABLE_JIT), reason="nothing is compiled")

LISTED = json.loads(_ahead.LIST.read_bytes())

MODULE = """
from zerorev.kernels._jit import kernel

@kernel
def first(x):
    return 2.0 * x

@kernel
def second(x):
    return first(x) + 1.0

@kernel
def third(xs):
    return xs[0] + second(xs[1])
"""
ASKING = """
import sys
from pathlib import Path
import numpy as np
from zerorev.kernels import _ahead

_ahead.LIST = Path("list.json")
_ahead._cores = lambda: 2
{broken}
import asking

_ahead.expect("all of it")
answers = [asking.first(1.5)]
started = list(_ahead._helpers)
for helper in started:
    helper.wait()
answers += [asking.second(1.5), asking.third(np.ones(2))]
print(answers, len(started), [sum(each.stats.cache_misses.values()) for each in (asking.second, asking.third)])
"""
ALL = [["asking.first", ["float64"]], ["asking.second", ["float64"]], ["asking.third", ["float64[1C]"]]]
CALLS = {"all of it": ALL}


@pytest.mark.parametrize("question", [pytest.param(asked, marks=pytest.mark.long) for asked in ASKED])
def test_the_list_is_what_each_question_calls(question: str):
    assert sorted(called_for(question)) == sorted(LISTED[question])  # the order is a matter of time alone


def test_every_question_has_its_list():
    assert set(LISTED) == set(ASKED)


@pytest.mark.parametrize("question", ASKED)
def test_what_is_listed_are_kernels_and_types(question: str):
    for name, arguments in LISTED[question]:
        function = _ahead.kernel_of(name).py_func
        assert function.__code__.co_argcount == len(arguments)
        assert [_ahead.written_type(_ahead.read_type(each)) for each in arguments] == arguments


def asked(folder: Path, *, broken: str = "") -> str:
    """What a process prints that asks for three kernels, of which the first calls helpers; its cache is its own."""
    (folder / "asking.py").write_text(MODULE)
    (folder / "list.json").write_text(json.dumps(CALLS))
    code = ASKING.format(broken=broken)
    paths = os.pathsep.join([str(folder), str(Path(zerorev.__file__).parents[1])])
    done = subprocess.run(
        [sys.executable, "-c", code],
        env={**os.environ, "PYTHONPATH": paths, "NUMBA_CACHE_DIR": str(folder / "cache")},
        capture_output=True, text=True, check=True, cwd=folder, timeout=300,
    )  # fmt: skip
    return done.stdout


def test_a_helper_leaves_what_it_made_in_the_cache(tmp_path: Path):
    code = f"import {_ahead.__name__} as a; from pathlib import Path; a.LIST = Path('list.json'); "
    with_list = (
        "import subprocess; start = subprocess.Popen; "
        f"subprocess.Popen = lambda line, **k: start([*line[:2], {code!r} + line[2]], **k)"
    )
    assert asked(tmp_path, broken=with_list) == "[3.0, 4.0, 4.0] 1 [0, 0]\n"


@pytest.mark.parametrize(
    ("broken", "started"),
    [
        ("_ahead.spawn.get_executable = lambda: '/bin/false'", 1),
        ("_ahead.spawn.get_executable = lambda: '/no/such/file'", 0),
        ("_ahead._cores = lambda: 1", 0),
        ("_ahead.LIST = Path('no.json')", 0),
        ("Path('list.json').write_text('{')", 0),
    ],
    ids=["ends at once", "cannot be started", "one core", "no list", "a damaged list"],
)
def test_without_a_helper_the_answers_are_the_same(tmp_path: Path, broken: str, started: int):
    assert asked(tmp_path, broken=broken) == f"[3.0, 4.0, 4.0] {started} [1, 1]\n"


def test_it_says_how_far_it_is_and_which_kernel_it_is_at(tmp_path: Path):
    spoken = (
        "import logging; logging.basicConfig(level=logging.INFO, stream=sys.stdout, format='%(message)s'); "
        "_ahead.SECONDS_BETWEEN_LINES = 0.0; _ahead.spawn.get_executable = lambda: '/bin/false'"
    )
    _, *lines, answers = asked(tmp_path, broken=spoken).splitlines()
    said = [line.removeprefix("compiling kernels: ") for line in lines]
    assert said == [
        f"{done} of 3, on 2 cores, now asking.{kernel}"
        for done, kernel in ((0, "first"), (1, "first"), (1, "second"), (2, "second"), (2, "third"), (3, "third"))
    ]
    assert answers == "[3.0, 4.0, 4.0] 1 [1, 1]"


@pytest.mark.parametrize("command", [["--help"], ["robots"], ["plan", "--help"]], ids=" ".join)
def test_a_command_that_needs_no_kernel_compiles_none(tmp_path: Path, command: list[str]):
    done = subprocess.run(
        [sys.executable, "-m", "zerorev.cli", *command],
        env={**os.environ, "NUMBA_CACHE_DIR": str(tmp_path)}, capture_output=True, text=True, check=True,
    )  # fmt: skip
    assert not done.stderr
    assert not list(tmp_path.rglob("*.nb?"))
