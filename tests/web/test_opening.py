"""What is opened: by the user of this machine from a path, from the browser as text, for which no file is opened."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import zerorev
from oracles.places import JOBS
from zerorev.errors import InputError
from zerorev.files.io import job_from_text, plan_to_json, read_job, write_plan
from zerorev.files.text import json_text
from zerorev.files.yaml_text import yaml_text
from zerorev.planning.job import plan_job
from zerorev.planning.sequence import with_moves
from zerorev.web.opening import demo, opened, opened_text
from zerorev.web.state import plan_of

TOOL = {"tcp_mm": [100, 0, 65], "rpy_deg": [0, -90, 0]}
HOLES = [{"id": "first", "target_mm": [500, 300, 800], "direction": [1, 0, 0], "depth_mm": 50}]
JOB = {"robot": "kuka_kr6_r700_2", "tool": TOOL, "holes": HOLES}


@pytest.fixture(scope="module")
def plan():
    """Of one hole."""
    return plan_job(job_from_text(yaml_text(JOB), "job.yaml"))


def test_the_demo_is_the_three_positions_of_the_thesis(positions):
    state = demo()
    assert [hole.id for hole in state.job.holes] == ["position_1", "position_2", "position_3"]
    assert state.selected == "position_1"
    assert not state.answers
    for hole, position in zip(state.job.holes, positions, strict=True):
        np.testing.assert_allclose(hole.target, position.hole.target)
        assert hole.depth == pytest.approx(position.hole.depth)


def test_a_job_with_its_csv_is_opened_from_the_disk():
    state = opened(JOBS / "panel.yaml")
    assert len(state.job.holes) == 100
    assert state.hole is state.job.holes[0]


@pytest.mark.parametrize("name", ["plan.json", "depths.json", "plan.txt"])
def test_a_plan_is_known_by_what_is_in_it(tmp_path, plan, name):
    write_plan(plan, tmp_path / name)
    state = opened(tmp_path / name)
    assert state.answer.status == "planned"
    assert plan_to_json(with_moves(plan_of(state))) == plan_to_json(plan)
    assert plan_to_json(with_moves(plan_of(opened_text(json_text(plan_to_json(plan)), "a.json")))) == plan_to_json(plan)


@pytest.mark.parametrize("name", ["job.yaml", "job.yml", "job.txt"])
def test_a_job_is_known_by_what_is_in_it(tmp_path, name):
    (tmp_path / name).write_text(yaml_text(JOB))
    assert opened(tmp_path / name).hole.id == "first"


@pytest.mark.parametrize(
    "content", ["", "{", "[1, 2]", "robot: x", '{"format": "zerorev.map/1"}', "\x00", "a: &a [*a]"]
)
def test_what_is_neither_is_refused_in_one_message(tmp_path, content):
    (tmp_path / "file.json").write_text(content)
    with pytest.raises(InputError):
        opened(tmp_path / "file.json")
    with pytest.raises(InputError, match=r"file\.json"):
        opened_text(content, "file.json")


@pytest.mark.parametrize("path", ["nothing", "folder"])
def test_no_such_file_or_another_folder(tmp_path, path):
    (tmp_path / "folder").mkdir()
    with pytest.raises(InputError, match=path):
        opened(tmp_path / path)


@pytest.fixture
def shipped_alone(monkeypatch):
    """Any file that is opened must be one that ships with zerorev."""
    opened_before = Path.open

    def open_shipped(self, *arguments, **options):
        assert self.resolve().is_relative_to(Path(zerorev.__file__).parent), f"opened {self}"
        return opened_before(self, *arguments, **options)

    monkeypatch.setattr(Path, "open", open_shipped)


PATHS = ["../../etc/passwd", "/etc/passwd", "robot.yaml", "./robot.yaml", "C:\\robot.yaml", "../robots/kuka.json", "~"]


@pytest.mark.parametrize("path", PATHS)
@pytest.mark.parametrize("key", ["robot", "tool", "holes"])
def test_a_job_from_the_browser_names_no_files(shipped_alone, tmp_path, monkeypatch, key, path):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(InputError) as error:
        opened_text(yaml_text(JOB | {key: path}), "up.yaml")
    assert "up.yaml" in str(error.value)
    assert key in error.value.where
    assert "root:" not in str(error.value)


def test_the_same_job_on_the_disk_may_name_files_beside_it(tmp_path):
    (tmp_path / "tool.yaml").write_text(yaml_text({"format": "zerorev.tool/1", "name": "mine"} | TOOL))
    (tmp_path / "job.yaml").write_text(yaml_text(JOB | {"tool": "./tool.yaml"}))
    assert opened(tmp_path / "job.yaml").job.tool.name == "mine"


def test_what_ships_may_be_named(shipped_alone):
    state = opened_text(yaml_text(JOB | {"tool": "thesis_drill"}), "up.yaml")
    assert state.job.tool.name == "thesis_drill"
    assert state.job.name == "up"


def test_text_and_file_are_the_same_job():
    path = JOBS / "thesis_positions.yaml"
    one, other = read_job(path), opened_text(path.read_text(), path.name).job
    assert plan_to_json(plan_job(one)) == plan_to_json(plan_job(other))
