"""Maps on a cluster: the same bytes as on one process, also when a worker is lost half-way."""

from __future__ import annotations

import os
import re
import signal
import subprocess
import sys
import warnings

import numpy as np
import pytest

from zerorev.errors import InputError, ZerorevError
from zerorev.maps.run import local, run_map
from zerorev.model.map_task import MapTask, Question

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
    from zerorev.maps.cluster import cluster

    run_map(task, tmp_path / "here.zarr", local(1))
    address, (_, worker, *_) = scheduler
    killed = []

    def lose_one(done, of):
        if 2 * done > of and not killed:
            os.kill(worker.pid, signal.SIGKILL)
            killed.append(done)

    with cluster(address) as runner:
        run_map(task, tmp_path / "there.zarr", runner, lose_one)
    assert killed
    assert killed[0] < task.cells
    assert content(tmp_path / "there.zarr") == content(tmp_path / "here.zarr")


@pytest.mark.long
def test_a_lost_scheduler_is_told_and_the_map_goes_on_elsewhere(task, scheduler, tmp_path):
    from zerorev.maps.cluster import cluster

    address, (process, *_) = scheduler

    def lose_it(done, of):
        if done:
            process.kill()

    with pytest.raises(ZerorevError, match=r"lost|failed"), cluster(address) as runner:
        run_map(task, tmp_path / "map.zarr", runner, lose_it)
    run_map(task, tmp_path / "here.zarr", local(1))
    run_map(task, tmp_path / "map.zarr", local(1))
    assert content(tmp_path / "map.zarr") == content(tmp_path / "here.zarr")


@pytest.mark.parametrize(
    ("address", "said"),
    [("nonsense", "missing port"), ("foo://x:1", "unknown address scheme"), ("tcp://127.0.0.1:1", "127.0.0.1:1")],
)
def test_a_scheduler_that_does_not_answer(address, said, monkeypatch):
    from zerorev.maps import cluster

    monkeypatch.setattr(cluster, "PATIENCE", 0.5)
    with pytest.raises(InputError, match="no scheduler answers at") as refused, cluster.cluster(address):
        pass
    assert said in str(refused.value)


def test_a_worker_of_another_version_is_refused(task):
    from zerorev.maps import cluster
    from zerorev.maps.chunks import Chunks

    with pytest.raises(ZerorevError, match="install the same on all"):
        cluster._answer("0.0.0", task.question, Chunks.of(task).block(0))
