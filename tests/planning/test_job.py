"""Whole jobs: the same plan on any number of workers, in one run or several, and nothing finished is ever lost."""

from __future__ import annotations

import json
import multiprocessing
import os
import signal
import subprocess
import sys
import time
from dataclasses import replace
from pathlib import Path

import pytest
import yaml

from zerorev import cli
from zerorev.cli import main
from zerorev.errors import InputError, OutputError, ZerorevError
from zerorev.files.io import job_from_dict, plan_to_json, read_plan, write_plan
from zerorev.files.part import Part
from zerorev.planning import job as jobs
from zerorev.planning.sequence import sequenced
from zerorev.planning.tool_turn import ToolTurn
from zerorev.workers import Machines

CLI = [sys.executable, "-c", "import sys; from zerorev.cli import main; sys.exit(main())"]


def hole(n):
    """A given motion, quick to answer, 1 mm beside the last."""
    target = [500, 300 + n, 800]
    spins = [14.1646, -5.9388, -30.4599]
    return {"id": f"P{n}", "target_mm": target, "direction": [1, 0, 0], "depth_mm": 50, "psi_deg": spins, "branch": 4}


FAR = hole(7) | {"target_mm": [5000, 300, 800]}
JOB = {"robot": "kuka_kr6_r700_2", "tool": "thesis_drill", "min_rate_deg_per_mm": 0, "posture_freedom": 0}
HOLES = [hole(0), FAR, hole(1), hole(2), hole(3)]


@pytest.fixture(scope="module")
def job():
    return job_from_dict(JOB | {"holes": HOLES})


@pytest.fixture(scope="module")
def plan(job):
    """Planned in this process, in one go."""
    return jobs.plan_job(job)


@pytest.fixture
def job_file(tmp_path):
    path = tmp_path / "job.yaml"
    path.write_text(yaml.safe_dump(JOB | {"holes": HOLES}))
    return path


@pytest.fixture
def counted(monkeypatch, plan):
    """The ids of the holes that are planned; the answers are those of the plan, to save the time."""
    ids, found = [], {answer.hole.id: answer for answer in plan.holes}

    def planned(robot, tool, hole, settings):
        ids.append(hole.id)
        return found[hole.id]

    monkeypatch.setattr(jobs, "plan", planned)
    return ids


def whole(part_path, job):
    """The bytes of the plan file that a part becomes."""
    target = Path(str(part_path).removesuffix(".part"))
    head = jobs.unanswered(job, "asked")
    with Part(target, head, job.holes) as part:
        for answer in jobs.answers(job, part=part):
            del answer
        found = sequenced(job, part.answers)
        made = jobs.in_sequence(head, found)
        turns = ToolTurn(made)
        for n, answer in enumerate(part.answers()):
            turns.add(found.changed.get(n, answer))
        part.finish(made, found.changed, turns.findings())
    return target.read_bytes()


class TestWorkers:
    def test_the_plan_is_the_same_to_the_last_bit(self, job, plan):
        reported = []
        other = jobs.plan_job(job, lambda *done: reported.append(done), workers=2)
        assert plan_to_json(other) == plan_to_json(plan)
        for a, b in zip(other.holes, plan.holes, strict=True):
            # processes that compile the same kernels at the same time need not round alike
            assert a.deepest == pytest.approx(b.deepest, rel=1e-12)
            assert (a.motion is None) == (b.motion is None)
            assert a.motion is None or a.motion.joints.tobytes() == b.motion.joints.tobytes()
        assert reported == [(done, 5) for done in range(6)]

    def test_a_worker_that_dies_is_reported_in_one_message(self, job):
        found = jobs.answers(job, machines=Machines(2))
        next(found)
        next(found)
        for worker in multiprocessing.active_children():
            worker.kill()
        with pytest.raises(ZerorevError, match="a worker process ended"):
            list(found)


@pytest.mark.usefixtures("counted")
class TestPart:
    def test_resumes_from_any_hole_to_the_same_file(self, job, plan, tmp_path, counted):
        straight = whole(tmp_path / "straight.json.part", job)
        write_plan(plan, tmp_path / "straight.json")
        assert (tmp_path / "straight.json").read_bytes() == straight
        for stop in range(1, 6):
            target = tmp_path / "plan.json"
            with Part(target, jobs.unanswered(job, "asked"), job.holes) as part:
                found = jobs.answers(job, part=part)
                for _ in range(stop):
                    next(found)
            assert not target.exists()
            counted.clear()
            assert whole(part.path, job) == straight
            assert counted == [hole.id for hole in job.holes[stop:]]
            target.unlink()
        assert [path.name for path in tmp_path.iterdir()] == ["straight.json"]

    @pytest.mark.parametrize("cut", [1, 30, 2000], ids="{} bytes".format)
    def test_a_line_that_was_torn_is_planned_again(self, cut, job, plan, tmp_path, counted):
        path = left(tmp_path, job, plan, 3)
        path.write_bytes(path.read_bytes()[:-cut])
        assert json.loads(whole(path, job)) == plan_to_json(plan)
        assert counted[0] == job.holes[2].id

    def test_a_line_that_was_damaged_and_all_behind_it_are_planned_again(self, job, plan, tmp_path, counted):
        path = left(tmp_path, job, plan, 3)
        lines = path.read_bytes().splitlines(keepends=True)
        path.write_bytes(b"".join([*lines[:2], b"\0" * 50 + b"\n", lines[3]]))
        assert json.loads(whole(path, job)) == plan_to_json(plan)
        assert counted == [hole.id for hole in job.holes[1:]]

    def test_a_torn_first_line_is_begun_again(self, job, plan, tmp_path):
        path = left(tmp_path, job, plan, 2)
        path.write_bytes(path.read_bytes()[:100])
        assert json.loads(whole(path, job)) == plan_to_json(plan)

    @pytest.mark.parametrize(
        "other",
        [
            lambda job: replace(job, settings=replace(job.settings, min_rate=1.0)),
            lambda job: replace(job, holes=job.holes[:-1]),
            lambda job: replace(job, holes=(*job.holes[:-1], replace(job.holes[-1], branch=5))),
            lambda job: replace(job, tool=replace(job.tool, name="other")),
        ],
        ids=["settings", "holes", "one hole", "tool"],
    )
    def test_of_another_job_is_refused_and_left_alone(self, other, job, plan, tmp_path):
        path = left(tmp_path, job, plan, 2)
        before = path.read_bytes()
        changed = other(job)
        with pytest.raises(InputError, match=r"another job, .*\(accepted: .*delete it to begin again\)"):
            Part(tmp_path / "plan.json", jobs.unanswered(changed, "asked"), changed.holes)
        assert path.read_bytes() == before

    def test_of_depths_is_not_a_part_of_a_plan(self, job, plan, tmp_path):
        left(tmp_path, job, plan, 2)
        with pytest.raises(InputError, match="another job"):
            Part(tmp_path / "plan.json", jobs.unanswered(job, "deepest"), job.holes)

    def test_a_file_of_somebody_else_is_left_alone(self, job, tmp_path):
        path = tmp_path / "plan.json.part"
        for text in ("notes\n", "notes"):
            path.write_text(text)
            with pytest.raises(InputError, match="another job"):
                Part(tmp_path / "plan.json", jobs.unanswered(job, "asked"), job.holes)
            assert path.read_text() == text

    def test_two_runs_do_not_write_the_same(self, job, plan, tmp_path):
        target, head = tmp_path / "plan.json", jobs.unanswered(job, "asked")
        with Part(target, head, job.holes) as part:
            part.append(plan.holes[0])
            with pytest.raises(OutputError, match="another run is writing it"):
                Part(target, head, job.holes)
        assert part.done == 1

    def test_reads_as_a_plan_that_is_not_finished(self, job, plan, tmp_path, capsys):
        path = left(tmp_path, job, plan, 2)
        with path.open("ab") as stream:
            stream.write(b'{"id": "P1", "targ')
        read = read_plan(path)
        assert [answer.hole.id for answer in read.holes] == ["P0", "P7"]
        assert [(found.level, found.kind) for found in read.findings] == [("error", "unfinished")]
        assert "only 2 of 5 holes" in read.findings[0].message
        assert main(["check", str(path)]) == cli.FOUND
        assert "unfinished" in capsys.readouterr().out
        assert main(["export", str(path), "--skip-failed"]) == cli.FOUND
        assert "only 2 of 5 holes" in capsys.readouterr().err

    def test_without_a_hole_is_not_a_plan(self, job, plan, tmp_path):
        path = left(tmp_path, job, plan, 1)
        path.write_bytes(path.read_bytes().splitlines(keepends=True)[0])
        with pytest.raises(InputError, match="no finished hole"):
            read_plan(path)


def left(folder, job, plan, count):
    """The part that a run leaves which ends after so many holes."""
    with Part(folder / "plan.json", jobs.unanswered(job, "asked"), job.holes) as part:
        for answer in plan.holes[:count]:
            part.append(answer)
    return part.path


class TestInterrupted:
    def test_the_same_command_resumes(self, job_file, tmp_path, plan, capsys, monkeypatch, counted):
        target, really = tmp_path / "plan.json", jobs.plan

        def interrupted(robot, tool, hole, settings):
            if hole.id == "P2":
                raise KeyboardInterrupt
            return really(robot, tool, hole, settings)

        with monkeypatch.context() as patch:
            patch.setattr(jobs, "plan", interrupted)
            assert main(["plan", str(job_file), "-o", str(target)]) == cli.INTERRUPTED
        out, err = capsys.readouterr()
        assert out == ""
        assert err == f"error: interrupted; 3 of 5 holes are kept in {target}.part; the same command resumes\n"
        assert not target.exists()
        counted.clear()
        assert main(["plan", str(job_file), "-o", str(target)]) == cli.FOUND
        out, err = capsys.readouterr()
        note, elapsed = err.splitlines()
        assert note == f"note: resuming after 3 of 5 holes in {target}.part"
        assert elapsed.startswith("note: elapsed time ")
        assert sum("6 → 0" in line for line in out.splitlines()) == 4
        assert counted == ["P2", "P3"]
        assert json.loads(target.read_text())["holes"] == plan_to_json(plan)["holes"]
        assert sorted(path.name for path in tmp_path.iterdir()) == ["job.yaml", "plan.json"]

    @pytest.mark.skipif(sys.platform == "win32", reason="signals")
    @pytest.mark.parametrize("workers", [1, 2])
    def test_ctrl_c_leaves_the_finished_holes(self, workers, tmp_path):
        running, part = begun(tmp_path, workers)
        os.killpg(running.pid, signal.SIGINT)  # what a terminal sends on Ctrl-C: to parent and workers alike
        out, err = running.communicate(timeout=60)
        kept = read_plan(part)
        assert running.returncode == cli.INTERRUPTED
        assert out == ""
        *notes, error = err.splitlines()
        assert error == (
            f"error: interrupted; {len(kept.holes)} of 400 holes are kept in {part}; the same command resumes"
        )
        assert all(note.startswith("note: planning: ") for note in notes)
        assert [answer.hole.id for answer in kept.holes] == [f"P{n}" for n in range(len(kept.holes))]
        assert 3 <= len(kept.holes) < 400
        assert not (tmp_path / "plan.json").exists()

    @pytest.mark.skipif(sys.platform != "linux", reason="/proc")
    def test_killed_it_leaves_them_too_and_no_worker(self, tmp_path):
        running, part = begun(tmp_path, 2)
        workers = children(running.pid)
        assert len(workers) >= 2
        running.kill()
        running.communicate(timeout=60)
        assert len(read_plan(part).holes) >= 3
        deadline = time.monotonic() + 30
        while any(alive(pid) for pid in workers):
            assert time.monotonic() < deadline
            time.sleep(0.05)


def begun(folder, workers):
    """A large job that is running and has finished three holes, and its part."""
    (folder / "job.yaml").write_text(json.dumps(JOB | {"proof_boxes": 0, "holes": [hole(n) for n in range(400)]}))
    command = [*CLI, "plan", "job.yaml", "-o", str(folder / "plan.json"), "--workers", str(workers)]
    running = subprocess.Popen(
        command, cwd=folder, start_new_session=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )
    part = folder / "plan.json.part"
    deadline = time.monotonic() + 120
    while not part.exists() or part.read_bytes().count(b"\n") < 4:
        assert running.poll() is None, running.communicate()
        assert time.monotonic() < deadline
        time.sleep(0.02)
    return running, part


def children(pid):
    """Processes that a process started."""
    return [int(child) for child in Path(f"/proc/{pid}/task/{pid}/children").read_text().split()]


def alive(pid):
    try:
        return Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()[0] != "Z"
    except FileNotFoundError:
        return False
