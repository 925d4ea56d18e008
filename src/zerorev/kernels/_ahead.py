"""Compiling ahead: where several kernels are missing from the cache, other processor cores make those needed next.

Which kernels a question needs, with the types of what they are given, stands in `ahead.json`, that which takes longest
first, and then those that are called last; `tools/kernels_ahead.py` writes it from a run of each question. A process
that finds one of them missing compiles it as it asks its question; its helpers follow the list, and what they make is
found in the cache. A helper that fails, or that cannot be started, costs time and nothing else.
"""

from __future__ import annotations

import atexit
import json
import logging
import os
import subprocess
import sys
import threading
import time
from functools import cache
from importlib import import_module
from importlib.util import find_spec
from multiprocessing import parent_process, spawn
from pathlib import Path
from typing import Any

__all__ = ["LIST", "begin", "expect", "kernel_of", "read_type", "report", "written_type"]

LIST = Path(__file__).with_name("ahead.json")
MOST_HELPERS = 3  # the lists are short, and half of each hangs together
SECONDS_BETWEEN_LINES = 5.0

_lock = threading.Lock()
_question: str | None = None
_helpers: list[Any] = []
_begun: str | None = None  # the question for which helpers were called, once a process
_made: set[str] = set()  # of its kernels
_helping = False
_shown = 0.0


def expect(question: str) -> None:
    """Say what will be asked: one of the keys of the list, or anything that has no list."""
    global _question
    _question = question


@cache
def _listed(question: str | None) -> list[Any]:
    """Name, and types of the arguments, of each kernel that Python calls for a question; none where it has no list."""
    try:
        return list(json.loads(LIST.read_bytes()).get(question, ()))
    except (OSError, ValueError):
        return []


def begin(kernel: str) -> None:
    """Call helpers, the first time that a kernel is missing that the expected question needs.

    Args:
        kernel: module and name of the kernel that is missing.
    """
    global _begun, _shown
    calls = [name for name, _ in _listed(_question)]
    if _begun or kernel not in calls or parent_process() is not None:
        return  # of the processes of one question, the first finds out what is missing
    if find_spec("fcntl") is None:
        return  # no turns (`zerorev.kernels._cache`), so that each would compile all
    _begun, _shown = _question, time.monotonic()
    for turn in range(min(_cores() - 1, MOST_HELPERS, len(calls) - 1)):
        code = f"import sys; sys.path[:] = {sys.path!r}; import {__name__} as a; a._help({_question!r}, {turn})"
        try:
            helper = subprocess.Popen(
                [spawn.get_executable(), "-c", code],
                stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL,
            )  # fmt: skip
        except OSError:
            return
        _helpers.append(helper)
        threading.Thread(target=_listen, args=(helper.stdout,), daemon=True).start()


@atexit.register
def _end() -> None:
    """What the helpers still make, nobody waits for."""
    while _helpers:
        helper = _helpers.pop()
        helper.stdin.close()
        helper.kill()
        helper.wait()


def _cores() -> int:
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def _listen(reports: Any) -> None:
    for line in reports:
        done, _, kernel = line.decode(errors="replace").strip().partition(" ")
        report(kernel, called=done == "+")


def report(kernel: str, *, called: bool) -> None:
    """Count what was compiled, here or by a helper, and say now and then how far it is.

    Args:
        kernel: its name.
        called: whether Python calls it, which is what counts, or a kernel.
    """
    global _shown
    if _helping:
        sys.stdout.write(f"{'+' if called else '-'} {kernel}\n")
        sys.stdout.flush()
        return
    with _lock:
        if _begun is None or _begun != _question:
            return
        listed = {name for name, _ in _listed(_begun)}
        _made.update({kernel} & listed if called else ())
        now = time.monotonic()
        if now - _shown < SECONDS_BETWEEN_LINES:
            return
        _shown = now
        done, cores = f"{len(_made)} of {len(listed)}", 1 + len(_helpers)
    name = kernel.removeprefix("zerorev.")
    logging.getLogger("zerorev").info("compiling kernels: %s, on %s cores, now %s", done, cores, name)


def _help(question: str, turn: int) -> None:
    """The work of a helper: it ends with the list, or with the process that called it."""
    global _helping
    _helping = True
    threading.Thread(target=_end_with_caller, daemon=True).start()
    calls = _listed(question)
    for name, arguments in calls[turn:] + calls[:turn]:
        kernel_of(name).compile(tuple(read_type(each) for each in arguments))


def _end_with_caller() -> None:
    sys.stdin.read()
    os._exit(0)


def kernel_of(name: str) -> Any:
    """A kernel by its module and name."""
    module, _, function = name.rpartition(".")
    return getattr(import_module(module), function)


def written_type(given: Any) -> Any:
    """A type of Numba as the list has it: float64, float64[2C] for an array, the parts of a tuple behind its class."""
    from numba.core import types

    if isinstance(given, types.Array):
        return f"{given.dtype}[{given.ndim}{given.layout}{'' if given.mutable else ' readonly'}]"
    if isinstance(given, types.BaseTuple):
        made = getattr(given, "instance_class", tuple)
        return [f"{made.__module__}.{made.__qualname__}", *(written_type(each) for each in given.types)]  # type: ignore[attr-defined]
    return str(given)


def read_type(written: Any) -> Any:
    """The type that is written so."""
    from numba.core import types

    if isinstance(written, list):
        made, *parts = written
        module, _, name = made.rpartition(".")
        held = tuple(read_type(each) for each in parts)
        return types.BaseTuple.from_types(held, getattr(import_module(module), name))  # type: ignore[no-untyped-call]
    scalar, _, array = written.partition("[")
    dtype = getattr(types, {"bool": "boolean"}.get(scalar, scalar))
    return types.Array(dtype, int(array[0]), array[1], readonly="readonly" in array) if array else dtype
