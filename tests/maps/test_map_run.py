"""Runs of maps: with any interruptions and any runner, the same bytes in the end."""

from __future__ import annotations

import errno
import json
import os
import random
import shutil
import signal
import subprocess
import sys
import time
from collections import namedtuple
from contextlib import suppress
from dataclasses import replace

import numpy as np
import pytest
import yaml

from zerorev.cli import common as cli
from zerorev.cli import main
from zerorev.errors import InputError, OutputError, ZerorevError
from zerorev.maps import run
from zerorev.maps.cells import answer
from zerorev.maps.run import run_map
from zerorev.maps.workspace import MapStore, read_workspace_map
from zerorev.model.map_task import MapTask, Question
from zerorev.workers import HERE, Machines

CLI = [sys.executable, "-c", "import sys; from zerorev.cli import main; sys.exit(main())"]
MAP = {
    "robot": "kuka_kr6_r700_2",
    "tool": "thesis_drill",
    "targets": {"x_mm": [450, 500], "y_mm": [0, 100, 200], "z_mm": {"start": 700, "stop": 900, "step": 100}},
    "directions": {"cone": {"axis": [1, 0, 0], "half_angle_deg": 20, "count": 3}},
    "min_rate_deg_per_mm": 0,
}


@pytest.fixture(scope="module")
def task(robot, tool):
    axes = (np.array([450.0, 500.0]), np.array([0.0, 100.0, 200.0]), np.array([700.0, 800.0, 5000.0]))
    return MapTask(Question(robot, tool, "twist_spread"), axes, np.array([[1.0, 0.0, 0.0], [1.0, 0.0, -0.5]]))


@pytest.fixture(scope="module")
def straight(task, tmp_path_factory):
    """The bytes of a map that was run in one go."""
    folder = tmp_path_factory.mktemp("straight")
    run_map(task, folder / "map.zarr", HERE)
    return content(folder / "map.zarr")


def content(folder):
    return {str(path.relative_to(folder)): path.read_bytes() for path in sorted(folder.rglob("*")) if path.is_file()}


def stopped_after(count, reported, task, path, *progress):
    """Run a map that is interrupted after so many chunks; notes those it answers."""
    mine = []

    def answering(question, block):
        if len(mine) == count:
            raise KeyboardInterrupt
        mine.append(block.number)
        reported.append(block.number)
        return answer(question, block)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(run, "answer", answering)
        return run_map(task, path, HERE, *progress)


class TestResume:
    def test_from_any_chunk_to_the_same_bytes(self, task, straight, tmp_path):
        path, reported, progress = tmp_path / "map.zarr", [], []
        for _ in range(100):
            try:
                ran = stopped_after(5, reported, task, path, lambda *done: progress.append(done))
            except KeyboardInterrupt:
                continue
            break
        assert content(path) == straight
        assert sorted(reported) == list(range(ran.chunks)), "each chunk once"
        assert [done for done, _ in progress] == sorted(done for done, _ in progress)
        assert progress[-1] == (task.cells, task.cells)

    def test_a_finished_map_is_left_as_it_is(self, task, straight, tmp_path):
        path, reported = tmp_path / "map.zarr", []
        run_map(task, path, HERE)
        times = {file: file.stat().st_mtime_ns for file in path.rglob("*")}
        ran = stopped_after(0, reported, task, path)
        assert ran.before == ran.chunks
        assert {file: file.stat().st_mtime_ns for file in path.rglob("*")} == times

    @pytest.mark.parametrize("how", ["flipped", "cut", "emptied", "deleted", "zeroed"])
    def test_a_damaged_chunk_is_found_and_only_it_is_answered_again(self, how, task, straight, tmp_path):
        path, reported = tmp_path / "map.zarr", []
        run_map(task, path, HERE)
        chunk = random.Random(how).choice([f for f in sorted(path.rglob("*")) if f.is_file() and "/c/" in str(f)
                                           and f.parent.parent.name != "map.zarr" and "_mm/" not in str(f)
                                           and "direction_" not in str(f)])  # fmt: skip
        data = bytearray(chunk.read_bytes())
        if how == "deleted":
            chunk.unlink()
        else:
            data[len(data) // 2] ^= 4
            chunk.write_bytes({"flipped": data, "cut": data[:-3], "emptied": b"", "zeroed": bytes(len(data))}[how])
        stopped_after(99, reported, task, path)
        assert len(reported) == 1
        assert content(path) == straight

    def test_what_a_kill_left_half_written_goes(self, task, straight, tmp_path):
        path = tmp_path / "map.zarr"
        with pytest.raises(KeyboardInterrupt):
            stopped_after(3, [], task, path)
        torn = next(path.glob("branch/c/**/0")).parent / "1.0123456789abcdef.partial"
        torn.write_bytes(b"half")
        run_map(task, path, HERE)
        assert content(path) == straight

    def test_an_unfinished_map_can_be_read(self, task, tmp_path):
        path = tmp_path / "map.zarr"
        with pytest.raises(KeyboardInterrupt):
            stopped_after(3, [], task, path)
        found = read_workspace_map(path)
        assert 0 < (found["status"].values == -1).sum() < task.cells


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (
            lambda t: replace(t, question=replace(t.question, quantity="deepest")),
            "quantity is twist_spread, not deepest",
        ),
        (
            lambda t: replace(t, question=replace(t.question, settings=replace(t.question.settings, min_rate=0.0))),
            "settings.min_rate_deg_per_mm is 0.01, not 0.0",
        ),
        (
            lambda t: replace(t, question=replace(t.question, robot=replace(t.question.robot, name="other"))),
            "robot.name is kuka_kr6_r700_2, not other",
        ),
        (lambda t: replace(t, question=replace(t.question, psi_reference="nearest_base")), "psi_reference is base_y"),
        (lambda t: replace(t, axes=(t.axes[0], t.axes[1] + 1, t.axes[2])), "y_mm differ"),
        (lambda t: replace(t, axes=(t.axes[0][:1], t.axes[1], t.axes[2])), "x_mm differ"),
        (lambda t: replace(t, directions=t.directions[::-1]), "direction_z differ"),
    ],
    ids=["quantity", "threshold", "robot", "reference", "target", "targets", "directions"],
)
def test_another_map_is_refused_with_the_difference_named(change, said, task, tmp_path):
    path = tmp_path / "map.zarr"
    with pytest.raises(KeyboardInterrupt):
        stopped_after(2, [], task, path)
    before = content(path)
    with pytest.raises(InputError, match="is another map") as refused:
        run_map(change(task), path, HERE)
    assert said in str(refused.value)
    assert content(path) == before


def test_a_map_of_before_a_setting_existed_was_made_with_its_default(task, straight, tmp_path):
    path = tmp_path / "map.zarr"
    with pytest.raises(KeyboardInterrupt):
        stopped_after(2, [], task, path)
    head = path / "zarr.json"
    data = json.loads(head.read_text())
    assert data["attributes"]["settings"].pop("limit_margin_deg") == 0
    head.write_text(json.dumps(data))
    other = replace(task.question, settings=replace(task.question.settings, limit_margin=0.1))
    with pytest.raises(InputError, match=r"settings.limit_margin_deg is 0.0, not 5.7"):
        run_map(replace(task, question=other), path, HERE)
    run_map(task, path, HERE)
    assert content(path).keys() == straight.keys()


def test_what_is_not_a_map_is_left_alone(task, tmp_path):
    (tmp_path / "notes").mkdir()
    (tmp_path / "notes" / "notes.txt").write_text("mine")
    with pytest.raises(InputError, match="no folder of zarr"):
        run_map(task, tmp_path / "notes", HERE)
    (tmp_path / "file").write_text("mine")
    with pytest.raises(OutputError, match="it is a file"):
        run_map(task, tmp_path / "file", HERE)
    with pytest.raises(OutputError, match="does not exist"):
        run_map(task, tmp_path / "none" / "map.zarr", HERE)
    import xarray

    xarray.Dataset({"a": ("x", [1.0])}).to_zarr(tmp_path / "other.zarr", consolidated=False)
    with pytest.raises(InputError, match="not a workspace map"):
        run_map(task, tmp_path / "other.zarr", HERE)


def test_two_runs_do_not_write_the_same(task, tmp_path):
    with MapStore(tmp_path / "map.zarr", task), pytest.raises(OutputError, match="another run is writing it"):
        run_map(task, tmp_path / "map.zarr", HERE)


class TestDisk:
    def test_without_room_is_reported_before(self, task, tmp_path, monkeypatch):
        usage = namedtuple("usage", "total used free")
        monkeypatch.setattr(shutil, "disk_usage", lambda path: usage(2**40, 2**40, 100_000))
        with pytest.raises(OutputError, match=r"needs up to .* MiB, and the disk has 0\.1 MiB left"):
            run_map(task, tmp_path / "map.zarr", HERE)
        assert list(tmp_path.iterdir()) == []

    def test_that_fills_up_on_the_way_is_survived(self, task, straight, tmp_path, monkeypatch):
        from zarr.storage import _local

        path, really, left = tmp_path / "map.zarr", _local._put, [25]

        def put(file, value, **options):
            left[0] -= "/c/" in str(file)
            if left[0] == 0:
                raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
            return really(file, value, **options)

        with monkeypatch.context() as patch:
            patch.setattr(_local, "_put", put)
            with pytest.raises(ZerorevError, match=r"No space left on device; what is finished is kept, and the same"):
                run_map(task, path, HERE)
        reported = []
        stopped_after(99, reported, task, path)
        assert 0 < len(reported) < len(straight)
        assert content(path) == straight


@pytest.mark.parametrize("workers", [2, 3])
def test_on_several_processes_it_is_the_same(workers, task, straight, tmp_path):
    run_map(task, tmp_path / "map.zarr", Machines(workers))
    assert content(tmp_path / "map.zarr") == straight


def test_a_billion_cells_cost_nothing_before_they_are_read(robot, tool):
    from zerorev.maps.chunks import Chunks

    axis = np.arange(1000.0) + 1000
    chunks = Chunks.of(MapTask(Question(robot, tool), (axis, axis, axis), np.array([[1.0, 0.0, 0.0]])))
    assert len(chunks.block(chunks.count - 1).cells) <= 256


@pytest.fixture
def map_file(tmp_path):
    path = tmp_path / "map.yaml"
    path.write_text(yaml.safe_dump(MAP))
    return path


class TestCommand:
    def test_maps_and_says_what_it_found(self, map_file, tmp_path, capsys):
        target = tmp_path / "map.zarr"
        assert main(["map", str(map_file), "-o", str(target)]) == cli.FINE
        out, err = capsys.readouterr()
        assert out == f"54 cells: 54 with an answer\nmap written to {target}\n"
        assert err == ""
        assert main(["map", str(map_file), "-o", str(target), "--workers", "1"]) == cli.FINE
        assert f"the map in {target} was finished, and is whole" in capsys.readouterr().err

    def test_says_which_cells_lie_in_the_base(self, map_file, tmp_path, capsys):
        targets = {"x_mm": [0, 500], "y_mm": [0], "z_mm": [300]}
        map_file.write_text(yaml.safe_dump(MAP | {"targets": targets, "directions": [[1, 0, 0]]}))
        assert main(["map", str(map_file), "-o", str(tmp_path / "map.zarr")]) == cli.FINE
        out, err = capsys.readouterr()
        assert "1 of 2 cells lie inside the robot's base and get no answer" in err
        assert "1 inside the robot's base" in out

    @pytest.mark.parametrize(
        ("arguments", "said"),
        [
            (["--workers", "0"], "0 workers"),
            (["--workers", "2", "--scheduler", "tcp://127.0.0.1:1"], "accepted: one of them"),
            (["-o", "{folder}"], "no folder of zarr"),
            (["-o", "{folder}/map.yaml"], "it is a file"),
            (["-o", "{folder}/no/map.zarr"], "does not exist"),
        ],
        ids=str,
    )
    def test_bad_input_is_one_message(self, map_file, tmp_path, capsys, arguments, said):
        filled = [argument.format(folder=tmp_path) for argument in arguments]
        output = [] if "-o" in arguments else ["-o", str(tmp_path / "map.zarr")]
        assert main(["map", str(map_file), *output, *filled]) == cli.BAD_INPUT
        out, err = capsys.readouterr()
        assert out == ""
        assert err.count("error:") == 1
        assert said in err
        assert [path.name for path in tmp_path.iterdir()] == ["map.yaml"]

    def test_ctrl_c_keeps_what_is_finished(self, map_file, tmp_path, capsys, monkeypatch):
        target, really, reported = tmp_path / "map.zarr", run.answer, []

        def interrupted(question, block):
            reported.append(block.number)
            if len(reported) == 4:
                raise KeyboardInterrupt
            return really(question, block)

        with monkeypatch.context() as patch:
            patch.setattr(run, "answer", interrupted)
            assert main(["map", str(map_file), "-o", str(target), "--workers", "1"]) == cli.INTERRUPTED
        assert f"what is finished is kept in {target}; the same command resumes" in capsys.readouterr().err
        assert main(["map", str(map_file), "-o", str(target)]) == cli.FINE
        assert "resuming after 9 of 54 cells" in capsys.readouterr().err


@pytest.mark.long
@pytest.mark.skipif(sys.platform == "win32", reason="signals")
def test_twenty_kills_at_random_moments(map_file, tmp_path):
    targets = {"x_mm": [450, 500], "y_mm": [-50, 0, 50, 100, 150, 200], "z_mm": [700, 750, 800, 850, 900]}
    map_file.write_text(yaml.safe_dump(MAP | {"targets": targets}))
    whole = tmp_path / "whole.zarr"
    assert main(["map", str(map_file), "-o", str(whole), "--workers", "1"]) == cli.FINE
    target, chance, killed, runs = tmp_path / "map.zarr", random.Random(1), 0, 0
    while killed < 20:
        runs += 1
        assert runs <= 100, f"only {killed} of {runs - 1} runs were killed before they ended"
        begun = sum(1 for _ in target.rglob("*"))
        running = subprocess.Popen(
            [*CLI, "map", str(map_file), "-o", str(target)], start_new_session=True, stderr=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
        )  # fmt: skip
        if chance.random() < 0.3:  # anywhere, imports and all
            time.sleep(chance.uniform(0, 3))
        else:  # from the first file that it writes
            late = time.monotonic() + 60
            while running.poll() is None and time.monotonic() < late and sum(1 for _ in target.rglob("*")) == begun:
                time.sleep(0.002)
            time.sleep(chance.uniform(0, 0.1))
        ended = running.poll() is not None
        with suppress(ProcessLookupError):
            os.killpg(running.pid, signal.SIGKILL)
        running.wait()
        killed += not ended
        if ended:  # a quick machine: what the kills left is finished, and the next begin afresh
            assert content(target) == content(whole)
            shutil.rmtree(target)
    assert main(["map", str(map_file), "-o", str(target)]) == cli.FINE
    assert content(target) == content(whole)
