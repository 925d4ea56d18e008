"""Work on a cluster: the same bytes as on one process, also when a worker is lost half-way."""

from __future__ import annotations

import json
import os
import re
import signal
import subprocess
import sys
import warnings

import numpy as np
import pytest

from zerorev import cli, workers
from zerorev.errors import InputError, ZerorevError
from zerorev.maps.run import run_map
from zerorev.model.map_task import MapTask, Question
from zerorev.workers import HERE, Machines

pytest.importorskip("distributed")
pytestmark = pytest.mark.filterwarnings("ignore")  # those of dask are not ours


@pytest.fixture(scope="module")
def task(robot, tool):
    axes = (np.array([450.0, 500.0]), np.linspace(0, 200, 5), np.linspace(700, 900, 5))
    return MapTask(Question(robot, tool), axes, np.array([[1.0, 0.0, 0.0]]))


def content(folder):
    return {str(path.relative_to(folder)): path.read_bytes() for path in sorted(folder.rglob("*")) if path.is_file()}


@pytest.fixture
def scheduler():
    """A scheduler and three workers, each its own process, without nannies that would start a lost one again."""
    processes = []
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            command = [sys.executable, "-m", "distributed.cli.dask_scheduler", "--host", "127.0.0.1", "--port", "0",
                       "--no-dashboard"]  # fmt: skip
            processes.append(subprocess.Popen(command, stderr=subprocess.PIPE, text=True))
            lines = iter(processes[0].stderr.readline, "")
            address = next(found[0] for line in lines if (found := re.search(r"tcp://[\d.]+:\d+", line)))
            for _ in range(3):
                command = [sys.executable, "-m", "distributed.cli.dask_worker", address, "--no-nanny", "--nthreads",
                           "1", "--no-dashboard"]  # fmt: skip
                processes.append(subprocess.Popen(command, stderr=subprocess.DEVNULL))
        yield address, processes
    finally:
        for process in reversed(processes):
            process.kill()
            process.wait()
        processes[0].stderr.close()


@pytest.mark.long
def test_a_lost_worker_is_survived(task, scheduler, tmp_path):
    run_map(task, tmp_path / "here.zarr", HERE)
    address, (_, worker, *_) = scheduler
    killed = []

    def lose_one(done, of):
        if 2 * done > of and not killed:
            os.kill(worker.pid, signal.SIGKILL)
            killed.append(done)

    run_map(task, tmp_path / "there.zarr", Machines(scheduler=address), lose_one)
    assert killed
    assert killed[0] < task.cells
    assert content(tmp_path / "there.zarr") == content(tmp_path / "here.zarr")


@pytest.mark.long
def test_a_lost_scheduler_is_reported_and_the_map_continues_elsewhere(task, scheduler, tmp_path):
    address, (process, *_) = scheduler

    def lose_it(done, of):
        if done:
            process.kill()

    with pytest.raises(ZerorevError, match=r"lost|failed"):
        run_map(task, tmp_path / "map.zarr", Machines(scheduler=address), lose_it)
    run_map(task, tmp_path / "here.zarr", HERE)
    run_map(task, tmp_path / "map.zarr", HERE)
    assert content(tmp_path / "map.zarr") == content(tmp_path / "here.zarr")


@pytest.mark.parametrize(
    ("address", "said"),
    [("nonsense", "missing port"), ("foo://x:1", "unknown address scheme"), ("tcp://127.0.0.1:1", "127.0.0.1:1")],
)
def test_a_scheduler_that_does_not_answer(task, address, said, monkeypatch, tmp_path):
    monkeypatch.setattr(workers, "PATIENCE", 0.5)
    with pytest.raises(InputError, match="no scheduler answers at") as refused:
        run_map(task, tmp_path / "map.zarr", Machines(scheduler=address))
    assert said in str(refused.value)
    assert not (tmp_path / "map.zarr").exists()


def test_a_worker_of_another_version_is_refused():
    with pytest.raises(ZerorevError, match="install the same on all"):
        workers._do_there("0.0.0", abs, -1)


@pytest.mark.long
def test_a_job_and_a_place_are_the_same_on_a_cluster(scheduler, tmp_path):
    """By way of the command line, where --scheduler stands beside every command that does much work."""
    address, _ = scheduler
    hole = {"direction": [1, 0.1, 0], "depth_mm": 8}
    holes = [{"id": f"h{n}", "target_mm": [470 + 5 * n, 250, 790 - 3 * n]} | hole for n in range(6)]
    job = {"robot": "kuka_kr6_r700_2", "tool": "thesis_drill", "proof_boxes": 500, "holes": holes}
    (tmp_path / "job.yaml").write_text(json.dumps(job))
    for command in (["plan"], ["depth"], ["place", "--z-mm=-40:40", "--grid", "3"]):
        written = []
        for where in ([], ["--scheduler", address]):
            out = tmp_path / f"{command[0]}{len(where)}.json"
            cli.main([command[0], str(tmp_path / "job.yaml"), *command[1:], *where, "-o", str(out)])
            written.append(out.read_bytes())
        assert written[0] == written[1], command
