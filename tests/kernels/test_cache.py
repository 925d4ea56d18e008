"""The cache of compiled kernels: what is missing, damaged, foreign or forbidden in it costs time, and nothing else."""

from __future__ import annotations

import os
import pickle
import shutil
import stat
import subprocess
import sys
import zlib
from pathlib import Path

import numba
import numpy as np
import pytest

import zerorev
from oracles.unprivileged import obeying_permissions
from zerorev.kernels import _cache, _compiling
from zerorev.kernels.order import order_of

pytestmark = pytest.mark.skipif(bool(numba.config.DISABLE_JIT), reason="nothing is compiled, so nothing is cached")

MODULE = """
from typing import NamedTuple
from zerorev.kernels._jit import kernel

class {name}(NamedTuple):
    depth: float

@kernel
def twice(asked):
    return 2.0 * asked.depth

print(twice({name}(21.0)), sum(twice.stats.cache_misses.values()))
"""
KEPT, NOT_KEPT = _compiling.ONCE + "\n", _compiling.EACH_TIME + "\n"

JOB = """
robot: kuka_kr6_r700_2
tool: thesis_drill
proof_boxes: 0
holes:
  - {id: a, target_mm: [500, 300, 800], direction: [1, 0, 0], depth_mm: 5}
"""


def run(folder: Path, *, name: str = "Asked", environment: dict[str, str] | None = None) -> tuple[str, str]:
    """What a process that needs one kernel prints, to either of its outputs; its cache is in `folder`/cache."""
    (folder / "asking.py").write_text(MODULE.format(name=name))
    given = {"NUMBA_CACHE_DIR": str(folder / "cache")} if environment is None else environment
    source = str(Path(zerorev.__file__).parents[1])
    done = subprocess.run(
        [sys.executable, "-B", "-c", "import asking"],
        cwd=folder,
        env={**environment_without_home(), "PYTHONPATH": f"{folder}:{source}", **given},
        capture_output=True,
        text=True,
        check=False,
        preexec_fn=obeying_permissions(),
    )
    assert done.returncode == 0, done.stderr
    return done.stdout, done.stderr


def environment_without_home() -> dict[str, str]:
    return {key: value for key, value in os.environ.items() if key not in ("HOME", "XDG_CACHE_HOME", "NUMBA_CACHE_DIR")}


@pytest.fixture(scope="module")
def filled(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a cache that a first run has filled, and a second one has used; each test leaves it filled."""
    folder = tmp_path_factory.mktemp("filled")
    assert run(folder) == ("42.0 1\n", KEPT)
    assert run(folder) == ("42.0 0\n", "")
    return folder


def test_a_kernel_is_stale_once_another_file_of_kernels_changes(monkeypatch: pytest.MonkeyPatch):
    """Numba looks at a kernel's own file alone; but what it calls from other files is compiled into it."""

    def cached() -> dict[object, object]:
        return _cache.Cache(order_of.py_func, _cache.Turn())._cache_file._load_index()

    order_of(np.zeros(3))
    assert cached()
    monkeypatch.setattr(_cache, "stamp", lambda: "another digest")
    assert not cached()


def test_a_cache_with_a_class_that_is_called_otherwise_by_now_is_made_again(filled: Path):
    assert run(filled, name="Wanted") == ("42.0 1\n", KEPT)
    index = next((filled / "cache").rglob("*.nbi")).read_bytes()
    assert b"Wanted" in index
    assert b"Asked" not in index
    assert run(filled) == ("42.0 1\n", KEPT)


def altered(data: bytes, how: str) -> bytes:
    match how:
        case "emptied":
            return b""
        case "cut":
            return data[: len(data) // 2]
        case "one byte":
            return data[:-40] + bytes([data[-40] ^ 1]) + data[-39:]
        case "as Numba writes it":
            return data[_cache.SUM :]
        case "something else":
            held = pickle.dumps(["not", "an", "entry"])
            return zlib.crc32(held).to_bytes(_cache.SUM) + held
    raise AssertionError(how)


@pytest.mark.parametrize("how", ["emptied", "cut", "one byte", "as Numba writes it", "something else"])
@pytest.mark.parametrize("ending", ["nbi", "nbc"])
def test_a_damaged_entry_is_made_again(filled: Path, ending: str, how: str):
    files = list((filled / "cache").rglob(f"*.{ending}"))
    assert len(files) == (1 if ending == "nbi" else 2)  # the body and the machine code
    sound = [file.read_bytes() for file in files]
    for file, data in zip(files, sound, strict=True):
        file.write_bytes(altered(data, how))
    assert run(filled) == ("42.0 1\n", KEPT)
    assert [file.read_bytes() != altered(data, how) for file, data in zip(files, sound, strict=True)].count(False) == 0


def test_damaged_machine_code_is_made_again_of_a_sound_body(filled: Path):
    machine_code = max((filled / "cache").rglob("*.nbc"))
    damaged = altered(machine_code.read_bytes(), "one byte")
    machine_code.write_bytes(damaged)
    assert run(filled) == ("42.0 0\n", "")
    assert machine_code.read_bytes() != damaged


BOTH = """
import numpy as np
from zerorev.kernels._jit import kernel

@kernel
def made(size):
    if size < 0:
        raise ValueError("less than nothing")
    return np.ones(size)

@kernel
def user(size):
    return made(size)[0]

print(user(2), made(2), [sum(each.stats.cache_misses.values()) for each in (user, made)])
for each in (user, made):
    try:
        each(-1)
    except ValueError as error:
        print(error)
"""


def test_a_kernel_that_a_kernel_and_python_call_is_loaded_whole(tmp_path: Path):
    """The class of the array that Python is given is a constant of the wrapper, the message one of the body."""
    (tmp_path / "asking.py").write_text(BOTH)
    paths = f"{tmp_path}:{Path(zerorev.__file__).parents[1]}"
    environment = {**os.environ, "PYTHONPATH": paths, "NUMBA_CACHE_DIR": str(tmp_path / "cache")}
    for misses in (1, 0):
        done = subprocess.run(
            [sys.executable, "-c", "import asking"], env=environment, capture_output=True, text=True, check=True
        )
        assert done.stdout == f"1.0 [1. 1.] [{misses}, {misses}]\nless than nothing\nless than nothing\n"


@pytest.mark.parametrize("ending", ["nbi", "nbc", "lock"])
def test_an_entry_that_may_not_be_read_is_made_again(filled: Path, ending: str):
    files = list((filled / "cache").rglob(f"*.{ending}"))
    for file in files:
        file.chmod(0)
    try:
        assert run(filled)[0] == ("42.0 0\n" if ending == "lock" else "42.0 1\n")
    finally:
        for file in files:
            if file.exists():
                file.chmod(0o600)
    assert run(filled) == ("42.0 0\n", "")


def test_without_any_place_for_it_a_kernel_is_compiled_in_each_run(tmp_path: Path):
    """No home, so no cache of the user; a folder that cannot be written to; not so much as a folder called `~`."""
    nobody = {"NUMBA_CACHE_DIR": "/proc/none", "HOME": "~"}
    (tmp_path / "__pycache__").mkdir(mode=0o500)
    (tmp_path / "asking.py").write_text("")
    for _ in range(2):
        assert run(tmp_path, environment=nobody) == ("42.0 1\n", NOT_KEPT)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["__pycache__", "asking.py"]


@pytest.mark.long
def test_a_read_only_installation_without_a_home_plans(tmp_path: Path):
    installed, work = tmp_path / "site", tmp_path / "work"
    shutil.copytree(Path(zerorev.__file__).parent, installed / "zerorev", ignore=shutil.ignore_patterns("__pycache__"))
    for path in [installed, *installed.rglob("*")]:
        path.chmod(path.stat().st_mode & ~(stat.S_IWUSR | stat.S_IWGRP | stat.S_IWOTH))
    work.mkdir()
    (work / "job.yaml").write_text(JOB)
    done = subprocess.run(
        [sys.executable, "-m", "zerorev.cli", "plan", "job.yaml", "-o", "plan.json"],
        cwd=work,
        env={**environment_without_home(), "PYTHONPATH": str(installed), "HOME": "/proc/none", "NUMBA_OPT": "0"},
        capture_output=True,
        text=True,
        check=False,
        preexec_fn=obeying_permissions(),
    )
    assert done.returncode == 0, done.stderr
    assert done.stderr.count(_compiling.EACH_TIME) == 1
    assert (work / "plan.json").stat().st_size > 1000
    assert sorted(path.name for path in work.iterdir()) == ["job.yaml", "plan.json"]
