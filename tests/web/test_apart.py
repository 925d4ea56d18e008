"""What is done in another process: the same as here, without holding up anybody, and it ends when nobody waits."""

from __future__ import annotations

import asyncio
import os
import signal
import subprocess
import sys
import threading
import time

import pytest

from oracles import hogs
from zerorev import apart
from zerorev.apart import Apart, Stopped
from zerorev.errors import InputError
from zerorev.files.io import job_from_text, plan_to_json, write_plan
from zerorev.files.job_data import job_files
from zerorev.files.text import json_text
from zerorev.files.yaml_text import yaml_text
from zerorev.planning.job import plan_job
from zerorev.web import files
from zerorev.web.aside import aside

JOB = {
    "robot": "kuka_kr6_r700_2",
    "tool": {"tcp_mm": [100, 0, 65], "rpy_deg": [0, -90, 0]},
    "holes": [
        {"id": f"hole {n}", "target_mm": [500, 300, 800 - n / 10], "direction": [1, 0, 0], "depth_mm": 10}
        for n in range(450)
    ],
}
# small for its size, and long to check
MANY_EMPTY = b'{"format": "zerorev.plan/1", "holes": [' + b"{}," * 100_000 + b"{}]}"


@pytest.fixture(scope="module")
def text():
    return yaml_text(JOB)


@pytest.fixture(scope="module")
def plan(text):
    """Of the first of the holes."""
    return plan_job(job_from_text(yaml_text(JOB | {"holes": JOB["holes"][:1]}), "job.yaml"))


def read(name, content):
    return files.whole(Apart(files.read).results([name, *files.cut(content)]))


def gone(process, within=1.0):
    """Whether a process ends soon."""
    deadline = time.monotonic() + within
    while time.monotonic() < deadline:
        try:
            os.kill(process, 0)
            with open(f"/proc/{process}/stat", encoding="ascii") as stat:
                if stat.read().rpartition(")")[2].split()[0] == "Z":
                    return True
        except (ProcessLookupError, FileNotFoundError):
            return True
        time.sleep(0.02)
    return False


def test_a_job_is_the_same_as_here(text):
    here, there = files.parsed(text, "job.yaml"), read("job.yaml", text.encode())
    assert len(there.holes) == 450
    assert job_files(here) == job_files(there)
    assert dict(Apart(files.job_written).results(files.pieces(here))) == job_files(here)


def test_a_plan_is_the_same_as_here(plan, tmp_path):
    write_plan(plan, tmp_path / "plan.json")
    there = read("plan.json", (tmp_path / "plan.json").read_bytes())
    assert plan_to_json(there) == plan_to_json(plan)
    written = b"".join(Apart(files.plan_written).results(files.pieces(plan)))
    assert written == (tmp_path / "plan.json").read_bytes() == json_text(plan_to_json(plan)).encode()


@pytest.mark.parametrize(
    ("content", "says"),
    [
        (b"\xff\xfe", "is not text"),
        (b"", "up.json"),
        (b'{"format": "x"}', "up.json"),
        (yaml_text(JOB | {"robot": "/etc/passwd"}).encode(), "robot"),
    ],
)
def test_what_cannot_be_used_is_refused_in_the_same_words(content, says):
    with pytest.raises(InputError, match=says) as error:
        read("up.json", content)
    assert "up.json" in str(error.value)
    assert error.value.accepted


def test_what_is_printed_is_not_a_result():
    assert list(Apart(hogs.echo).results([1, "two", b"three"])) == [1, "two", b"three"]


def test_other_pages_are_answered_while_a_file_is_read(say):
    """The file of 300 kB that takes a minute to check, and a task that never lets the lock go."""

    async def run(task, given):
        waits, reading = [], Apart(task)

        async def beat():
            while True:
                asked = time.monotonic()
                await asyncio.sleep(0.01)
                waits.append(time.monotonic() - asked - 0.01)

        beating = asyncio.get_running_loop().create_task(beat())
        doing = asyncio.get_running_loop().create_task(aside(lambda: list(reading.results(given))))
        await asyncio.wait([doing], timeout=2.0)
        reading.stop()
        await asyncio.gather(doing, return_exceptions=True)
        beating.cancel()
        return max(waits)

    for task, given in ((files.read, ["a.json", MANY_EMPTY]), (hogs.spin, [])):
        most = asyncio.run(run(task, given))
        say(f"longest that other pages waited while {task.__name__} was under way: {most * 1e3:.0f} ms")
        assert most < 1.0


def test_a_stopped_task_is_gone():
    doing = Apart(hogs.spin)
    results = doing.results([])
    process = next(results)
    threading.Timer(0.1, doing.stop).start()
    with pytest.raises(Stopped):
        next(results)
    assert gone(process)
    never = Apart(hogs.echo)
    never.stop()
    with pytest.raises(Stopped):
        list(never.results([1]))


def test_a_task_that_nobody_waits_for_is_gone():
    results = Apart(hogs.sleep).results([])
    process = next(results)
    results.close()
    assert gone(process)


@pytest.mark.skipif(sys.platform != "linux", reason="macOS limits no address space")
def test_too_much_memory_is_refused(monkeypatch):
    with pytest.raises(InputError, match="memory or time"):
        list(Apart(hogs.hoard).results([]))


def test_a_process_that_dies_is_refused():
    with pytest.raises(InputError, match="memory or time"):
        list(Apart(hogs.die).results([]))


@pytest.mark.skipif(sys.platform != "linux", reason="asks Linux for the end of the child")
def test_it_ends_with_the_app_also_where_that_is_killed():
    code = "from oracles import hogs; from zerorev.apart import Apart\n"
    code += "for process in Apart(hogs.spin).results([]): print(process, flush=True)"
    parent = subprocess.Popen(
        [sys.executable, "-c", f"import sys; sys.path[:] = {sys.path!r}; {code}"], stdout=subprocess.PIPE, text=True
    )
    process = int(parent.stdout.readline())
    parent.send_signal(signal.SIGKILL)
    parent.wait()
    parent.stdout.close()
    assert gone(process)
    assert apart.MOST_SECONDS < 600
