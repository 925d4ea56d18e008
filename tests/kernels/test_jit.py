"""How kernels are compiled: each once, and to the same digits in every process; what they may not do."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import numba
import numpy as np
import pytest

import zerorev
from zerorev.kernels import _compiling, _jit

compiled = pytest.mark.skipif(bool(numba.config.DISABLE_JIT), reason="nothing is compiled, so nothing is cached")


@compiled
def test_a_lean_kernel_makes_no_array():
    @_jit.lean
    def summed(values):
        made = np.empty(3)
        made[0] = values[0]
        return made[0]

    with pytest.raises((NotImplementedError, numba.errors.NumbaError)):
        summed(np.ones(3))


@compiled
def test_a_lean_kernel_may_call_one_that_makes_arrays_whichever_is_compiled_first():
    @_jit.kernel
    def made(values):
        copy = np.empty(values.shape[0])
        copy[:] = 2.0 * values
        return copy[0]

    @_jit.lean
    def called(values):
        return made(values)

    called(np.ones(4))  # the compiler itself holds what it is given
    values = np.ones(4)
    holders = sys.getrefcount(values)
    assert [called(values) for _ in range(1000)] == [2.0] * 1000
    assert sys.getrefcount(values) == holders


SLOW = """
import sys
from zerorev.kernels._jit import kernel

@kernel
def twice(x):
    return 2.0 * x

@kernel
def summed(xs):
    total = 0.0
    for x in sorted(xs):  # takes its time to compile
        total += twice(x)
    return total

print("ready", flush=True)
sys.stdin.readline()
summed([1.0, 2.0])
print(sum(count for made in (twice, summed) for count in made.stats.cache_misses.values()))
"""


@compiled
def test_processes_that_need_the_same_kernels_at_once_compile_each_once(tmp_path: Path):
    (tmp_path / "asking.py").write_text(SLOW)
    started = [
        subprocess.Popen(
            [sys.executable, "-c", "import asking"],
            cwd=tmp_path,
            env={**os.environ, "PYTHONPATH": str(tmp_path), "NUMBA_CACHE_DIR": str(tmp_path / "cache")},
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )
        for _ in range(3)
    ]
    for process in started:
        assert process.stdout
        assert process.stdout.readline() == "ready\n"
    for process in started:
        assert process.stdin
        process.stdin.write("\n")
        process.stdin.flush()
    reported = [process.communicate(timeout=120)[0] for process in started]
    assert sorted(reported) == ["0\n", "0\n", "2\n"]


@compiled
def test_a_cache_that_cannot_be_locked_is_done_without(tmp_path: Path):
    folder = tmp_path / "no folder"
    folder.write_text("")
    with _compiling.turn.needed():
        assert not _compiling.turn.taken(str(folder), "one")
    with _compiling.turn.needed():
        assert _compiling.turn.taken(str(tmp_path), "one")


LEGS = """
import numpy as np
import zerorev as zr
from zerorev.kernels import legs
from zerorev.kernels.field import ROOM
from zerorev.motion.drilling import Drilling

robot = zr.read_robot("kuka_kr6_r700_2")
plane = Drilling(robot, zr.read_tool("thesis_drill"), zr.Hole("one", [0.5, 0.3, 0.8], [1, 0, 0], 0.01)).plane
out = np.full((60, legs.ROWS, 6), np.nan)
for leg, psi in zip(out, np.linspace(-3, 3, 60)):
    legs.trace_leg(robot.arm, plane, 4, psi, 1.7, 0.05, 24, np.empty(ROOM), leg)
assert np.isfinite(out).sum() > 1000
print(sum(legs.trace_leg.stats.cache_misses.values()), out.tobytes().hex())
"""


@compiled
@pytest.mark.long
def test_the_process_that_compiles_finds_the_same_to_the_last_bit_as_one_that_loads(tmp_path: Path):
    """A dozen kernels, of which those that are called differ in the last bits between the copies of them."""

    def run() -> list[str]:
        environment = {**os.environ, "NUMBA_CACHE_DIR": str(tmp_path)}
        done = subprocess.run([sys.executable, "-c", LEGS], env=environment, capture_output=True, text=True, check=True)
        return done.stdout.split()

    (compiled_once, first), (compiled_again, second) = run(), run()
    assert (compiled_once, compiled_again) == ("1", "0")
    assert first == second


HIDING = """
import importlib, sys
from contextlib import contextmanager
import numba
from numba.core import caching, codegen, event, options
from numba.core.runtime import nrt

@contextmanager
def hidden(module, name, instead=None):
    kept = getattr(module, name)
    delattr(module, name) if instead is None else setattr(module, name, instead)
    for each in [each for each in sys.modules if each.startswith("zerorev.kernels")]:
        del sys.modules[each]
    try:
        yield importlib.import_module("zerorev.kernels._jit")
    finally:
        setattr(module, name, kept)

class Bare:
    pass
"""
EACH_PART = """
print(importlib.import_module("zerorev.kernels._jit")._own is None)
sys.modules["numba.core.event"] = None  # so that it is not found where the package no longer has it
for part in (
    (numba.core, "event"), (nrt, "rtsys"), (caching, "UserWideCacheLocator"), (caching, "FunctionCache", Bare),
    (caching, "IndexDataCacheFile", Bare), (codegen, "CPUCodeLibrary", Bare), (options, "DefaultOptions", Bare),
):
    with hidden(*part) as jit:
        print(part[1], jit._own is None)
"""
PLAIN = """
with hidden(caching, "UserWideCacheLocator") as jit:
    import asking
print(asking.summed(21.0), asking.lean_one([1.5]), sum(asking.summed.stats.cache_misses.values()))
print(type(asking.summed._cache).__name__)
"""
ASKING = """
from zerorev.kernels._jit import kernel, lean

@lean
def lean_one(values):
    return 2.0 * values[0]

@kernel
def summed(x):
    return 2.0 * x
"""


def _hiding(code: str, folder: Path, **environment: str) -> str:
    (folder / "asking.py").write_text(ASKING)
    paths = os.pathsep.join([str(folder), str(Path(zerorev.__file__).parents[1])])
    done = subprocess.run(
        [sys.executable, "-W", "ignore::numba.NumbaWarning", "-c", HIDING + code],
        env={**os.environ, "PYTHONPATH": paths, **environment},
        capture_output=True, text=True, check=False, cwd=folder,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    return done.stdout


@compiled
def test_where_a_private_part_of_numba_is_missing_its_own_cache_serves(tmp_path: Path):
    with_all, *without = _hiding(EACH_PART, tmp_path).splitlines()
    assert with_all == "False"
    said = dict(line.split() for line in without)
    assert len(said) == 7
    assert set(said.values()) == {"True"}


@compiled
def test_the_kernels_are_kept_by_numba_alone_too(tmp_path: Path):
    kept = {"NUMBA_CACHE_DIR": str(tmp_path / "cache")}
    assert [_hiding(PLAIN, tmp_path, **kept) for _ in range(2)] == [f"42.0 3.0 {n}\nFunctionCache\n" for n in (1, 0)]


@compiled
def test_numba_alone_compiles_where_nothing_can_be_kept(tmp_path: Path):
    nowhere = {"NUMBA_CACHE_DIR": "/proc/none", "HOME": "/proc/none"}
    (tmp_path / "__pycache__").write_text("")  # no folder can be made there
    assert _hiding(PLAIN, tmp_path, **nowhere) == "42.0 3.0 1\nNullCache\n"
