"""How kernels are compiled: each once, and to the same digits in every process; what they may not do."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import numba
import numpy as np
import pytest

from zerorev.kernels import _jit

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
    with _jit._turn.needed():
        assert not _jit._turn.taken(str(folder))
    with _jit._turn.needed():
        assert _jit._turn.taken(str(tmp_path))
        assert not _jit._turn.taken(str(tmp_path))


LEGS = """
import numpy as np
import zerorev as zr
from zerorev.kernels import legs
from zerorev.kernels.field import ROOM

robot = zr.read_robot("kuka_kr6_r700_2")
plane = twist_plane(robot, zr.read_tool("thesis_drill"), zr.Hole("one", [0.5, 0.3, 0.8], [1, 0, 0], 0.01))
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
