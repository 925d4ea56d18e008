"""Runs that are killed, asked to end, or interrupted, at random moments: the same command resumes, to the same bytes.

And nothing that they started is left a second later.
"""

from __future__ import annotations

import json
import os
import random
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import pytest

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="/proc")

CLI = [sys.executable, "-m", "zerorev.cli"]
# `reproduce` without the four sections that take longest: each section is kept in the same way. Ctrl-C waits until the
# command has begun, as what is imported here would be interrupted before it
FEWER = """
import signal, sys
signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
from zerorev.cli import main, reproduce
from zerorev.thesis.reproduce.chapters import CHAPTERS
long = {"tuning", "strokes", "workspace", "map"}
assert long <= {part.key for part in CHAPTERS["chapter4"]}
CHAPTERS["chapter4"] = tuple(part for part in CHAPTERS["chapter4"] if part.key not in long)
need = reproduce.need
def begun(*asked):
    signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGINT})
    need(*asked)
reproduce.need = begun
sys.exit(main())
"""
PATIENCE = 1800.0  # [s] for a whole run; the machine may be busy
LEFT = 1.0  # [s] after the end of a run until nothing of it is left


def hole(n: int, **more: float) -> dict[str, object]:
    return {"id": f"h{n}", "target_mm": [480 + 3 * n, 280, 800 - 4 * n], "direction": [1, 0.02 * n, 0.1]} | more


ROBOT = {"robot": "kuka_kr6_r700_2", "tool": "thesis_drill", "min_rate_deg_per_mm": 0}
JOB = ROBOT | {"proof_boxes": 2_000, "holes": [hole(n, depth_mm=8) for n in range(16)]}
OTHER = JOB | {"part_frame": {"xyz_mm": [20, -30, 10]}}
FEW = ROBOT | {"proof_boxes": 0, "holes": [hole(n, depth_mm=8) for n in range(3)]}
MAP = ROBOT | {
    "targets": {"x_mm": [450, 500, 550], "y_mm": {"start": -200, "stop": 200, "step": 20}, "z_mm": [700, 800]},
    "directions": [[1, 0, 0]],
    "quantity": "least_travel",
    "depth_mm": 10,
}
COMMANDS = {
    "plan": ["plan", "job.yaml", "-o", "out.json", "--workers", "2"],
    "depth": ["depth", "job.yaml", "-o", "out.json", "--workers", "2"],
    "map": ["map", "map.yaml", "-o", "out.zarr", "--workers", "2"],
    "place": ["place", "few.yaml", "--x-mm=-40:40", "--grid", "5", "-o", "out.json", "--workers", "2"],
    "share": ["share", "job.yaml", "other.yaml", "-o", "out.json", "--write-jobs", "out", "--workers", "2"],
    "reproduce": ["reproduce", "chapter4", "-o", "out", "--seeds", "2", "--map-size", "10"],
}
SIGNALS = (signal.SIGKILL, signal.SIGTERM, signal.SIGINT)


def folder_of_jobs(folder: Path) -> Path:
    folder.mkdir()
    for name, data in (("job", JOB), ("other", OTHER), ("few", FEW), ("map", MAP)):
        (folder / f"{name}.yaml").write_text(json.dumps(data))
    return folder


def started(command: str, folder: Path) -> subprocess.Popen[bytes]:
    begin = [sys.executable, "-c", FEWER] if command == "reproduce" else CLI
    return subprocess.Popen(
        [*begin, *COMMANDS[command]],
        cwd=folder,
        start_new_session=True,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
    )


def of_session(session: int) -> list[str]:
    """Processes of a session that still run."""
    found = []
    for path in Path("/proc").glob("[0-9]*/stat"):
        try:
            _, _, rest = path.read_text().rpartition(")")
        except OSError:
            continue
        state, _, _, its_session, *_ = rest.split()
        if int(its_session) == session and state != "Z":
            found.append(path.parent.name)
    return found


def written(folder: Path) -> dict[str, bytes]:
    """Every file that a run has left beside the jobs."""
    files = (path for path in folder.rglob("*") if path.is_file() and path.parent.name != "__pycache__")
    return {str(path.relative_to(folder)): path.read_bytes() for path in files}


def whole_run(command: str, folder: Path) -> float:
    began = time.monotonic()
    running = started(command, folder)
    _, said = running.communicate(timeout=PATIENCE)
    assert running.returncode in (0, 1), said.decode()
    assert b"Traceback" not in said
    return time.monotonic() - began


def check_kills(command: str, signals: list[signal.Signals], folder: Path, say: Callable[[str], None]) -> None:
    """One run in one go; then as many runs as signals, each ended by one at a random moment and resumed."""
    straight = folder_of_jobs(folder / "straight")
    whole_run(command, straight)  # compiles what is not compiled yet
    shutil.rmtree(straight)
    took = whole_run(command, folder_of_jobs(straight))
    wanted, chance, cut = written(straight), random.Random(command), 0
    for n, number in enumerate(signals):
        there = folder_of_jobs(folder / f"{number.name}-{n}")
        running = started(command, there)
        time.sleep(chance.uniform(0.05, 0.95) * took)
        cut += running.poll() is None
        # a terminal sends Ctrl-C to all of them, everybody else to the one that they know
        (os.killpg if number == signal.SIGINT else os.kill)(running.pid, number) if running.poll() is None else None
        _, said = running.communicate(timeout=PATIENCE)
        # a worker whose parent is gone while Python still starts it says so, before any line of ours runs
        assert number == signal.SIGKILL or b"Traceback" not in said, said.decode()
        time.sleep(LEFT)
        assert not of_session(running.pid), f"left after {number.name}"
        whole_run(command, there)
        found = written(there)
        assert sorted(found) == sorted(wanted), number.name
        assert found == wanted, number.name
        shutil.rmtree(there)
    say(f"{command}: {cut} of {len(signals)} runs were ended on the way, a whole one took {took:.1f} s")


@pytest.fixture
def say(request: pytest.FixtureRequest) -> Callable[[str], None]:
    return lambda text: request.node.user_properties.append(("measured", text))


@pytest.mark.long
@pytest.mark.parametrize(("command", "number"), [("plan", signal.SIGKILL), ("map", signal.SIGTERM)])
def test_a_run_that_is_ended_resumes_to_the_same_bytes(command, number, tmp_path, say):
    check_kills(command, [number], tmp_path, say)


@pytest.mark.soak
@pytest.mark.parametrize("command", COMMANDS)
def test_thirty_runs_that_are_ended_resume_to_the_same_bytes(command, tmp_path, say):
    check_kills(command, list(SIGNALS) * 10, tmp_path, say)
