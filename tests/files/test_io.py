"""Files: what is read is what was meant, what is written reads back, and every wrong input has one clear message."""

from __future__ import annotations

import json
import os
from collections.abc import Callable
from dataclasses import fields, is_dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from oracles.places import ROOT
from zerorev.errors import InputError, OutputError
from zerorev.files import io as files
from zerorev.files import output
from zerorev.model._arrays import rotation_rpy, transform
from zerorev.model.finding import Finding
from zerorev.model.hole import Hole
from zerorev.model.job import Settings
from zerorev.model.plan import Baseline, Event, HolePlan, Motion, Plan, Score, Verification
from zerorev.model.profile import Profile

JOB = """\
robot: kuka_kr6_r700_2
tool: thesis_drill
part_frame: {xyz_mm: [500, 0, 300], rpy_deg: [0, 0, 90]}
blend_mm: 2
feed_mm_s: {plunge: 4, retract: 30}
holes:
  - {id: 1, target_mm: [10, 20, 30], direction: [0, -2, 0], depth_mm: 50}
  - id: second
    target_mm: [10.5, 1e1, -3]
    direction: [0, -1, 0]
    depth_mm: 50
    psi_deg: [10, 20, 30]
    branch: 2
"""

CSV = """\
id,x_mm,y_mm,z_mm,i,j,k,depth_mm
a,500,0,300,1,0,0,50
b,500,10,300,1,0,0,40.5
"""

CSV_JOB = "robot: kuka_kr6_r700_2\ntool: thesis_drill\nholes: holes.csv\n"


def job_of(folder: Path, text: str, **others: str) -> Any:
    for name, content in {"job.yaml": text, **{f"{name}.csv": csv for name, csv in others.items()}}.items():
        (folder / name).write_text(content, encoding="utf-8")
    return files.read_job(folder / "job.yaml")


def refusal(call: Callable[[], object]) -> str:
    with pytest.raises(InputError) as caught:
        call()
    return str(caught.value)


# --- robots and tools -------------------------------------------------------------------------------------------------


def test_shipped_robots_come_from_three_makers_and_name_their_sources() -> None:
    robots = [files.read_robot(name) for name in files.robot_names()]
    assert [robot.name for robot in robots] == files.robot_names()
    assert len({robot.manufacturer for robot in robots}) >= 3
    assert all({"geometry", "sign", "offset", "limits", "speed"} <= robot.sources.keys() for robot in robots)


def test_robot_numbers_become_si() -> None:
    robot = files.read_robot("kuka_kr6_r700_2")
    assert robot.arm[:7] == pytest.approx((0.025, -0.025, 0, 0.4, 0.335, 0.365, 0.09), abs=1e-15)
    assert robot.arm.offset[1] == pytest.approx(-np.pi / 2)
    np.testing.assert_allclose(robot.limits.lower, np.deg2rad([-170, -190, -120, -185, -120, -350]))
    np.testing.assert_allclose(robot.limits.speed, np.deg2rad([360, 300, 360, 450, 450, 540]))


def test_shipped_tool_points_along_the_flange_x() -> None:
    T = files.read_tool("thesis_drill").T_flange_tcp
    np.testing.assert_allclose(T[:3, 3], [0.1, 0, 0.065])
    np.testing.assert_allclose(-T[:3, 2], [1, 0, 0], atol=1e-15)


def test_a_robot_file_by_path_relative_to_the_job(tmp_path: Path) -> None:
    shipped = ROOT / "src/zerorev/files/robots/yaskawa_gp8.yaml"
    (tmp_path / "mine.yaml").write_text(shipped.read_text(encoding="utf-8").replace("yaskawa_gp8", "mine"))
    assert job_of(tmp_path, JOB.replace("kuka_kr6_r700_2", "mine.yaml")).robot.name == "mine"


def test_unknown_names_list_what_ships() -> None:
    message = refusal(lambda: files.read_robot("kuka"))
    assert "did you mean 'kuka_kr" in message
    assert f"one of the {len(files.robot_names())} that `zerorev robots` lists" in message
    assert "thesis_drill" in refusal(lambda: files.read_tool("drill"))


def test_a_robot_file_with_swapped_limits_names_file_and_reason(tmp_path: Path) -> None:
    text = (ROOT / "src/zerorev/files/robots/yaskawa_gp8.yaml").read_text(encoding="utf-8")
    path = tmp_path / "swapped.yaml"
    path.write_text(text.replace("lower_deg", "x").replace("upper_deg", "lower_deg").replace("x:", "upper_deg:"))
    message = refusal(lambda: files.read_robot(path))
    assert "swapped.yaml" in message
    assert "lower < upper" in message


# --- jobs -------------------------------------------------------------------------------------------------------------


def test_a_job_in_si_and_in_the_base_frame(tmp_path: Path) -> None:
    job = job_of(tmp_path, JOB)
    first, second = job.holes
    assert (job.name, first.id, second.id) == ("job", "1", "second")
    np.testing.assert_allclose(first.target, [0.5 - 0.02, 0.01, 0.33], atol=1e-15)
    np.testing.assert_allclose(first.direction, [1, 0, 0], atol=1e-15)
    np.testing.assert_allclose(first.psi_zero, [0, 1, 0], atol=1e-15)
    np.testing.assert_allclose(second.target, [0.5 - 0.01, 0.0105, 0.297], atol=1e-15)
    assert (first.depth, first.profile, first.branch, second.branch) == (0.05, None, None, 2)
    np.testing.assert_array_equal(second.profile.standoff, [0.05, 0, 0.05])
    np.testing.assert_array_equal(second.profile.psi, np.deg2rad([10, 20, 30]))
    assert job.settings == Settings(controller="krl", blend=2e-3, feed_plunge=4e-3, feed_retract=30e-3)


def test_the_defaults_of_the_file_are_those_of_the_settings(tmp_path: Path) -> None:
    assert job_of(tmp_path, CSV_JOB, holes=CSV).settings == Settings(controller="krl")


def test_every_setting_arrives(tmp_path: Path) -> None:
    text = CSV_JOB + (
        "limit_margin_deg: 1.5\n"
        "name: panel\nmin_rate_deg_per_mm: 0\nmin_rate_rule: mean\npsi_bound_deg: 180\nobjective: margin\n"
        "legs: free\nmax_twist_deg_per_mm: 12\n"
        "reversal_weights: [1, 2, 3, 4, 5, 6]\nnear_joints_deg: [0, -90, 90, 0, 0, 180]\nblend_mm: 1\n"
        "blend_shortfall_mm: 0.4\ndeepen_corner: true\nlead_in_mm: 0\nspindle_rpm: 3000\n"
        "tool: {tcp_mm: [0, 0, 100], rpy_deg: [0, 0, 0]}\npsi_reference: [0, 0, 1]\n"
    ).replace("tool:", "tool:", 1)
    job = job_of(tmp_path, text.replace("tool: thesis_drill\n", ""), holes=CSV)
    assert job.name == "panel"
    assert job.settings == Settings(
        limit_margin=np.deg2rad(1.5),
        min_rate=0.0, min_rate_rule="mean", psi_bound=np.pi, legs="free", max_twist=np.deg2rad(12e3),
        objective="margin", reversal_weights=(1, 2, 3, 4, 5, 6),
        near_joints=tuple(np.deg2rad([0, -90, 90, 0, 0, 180])), blend=1e-3, blend_shortfall=4e-4, deepen_corner=True,
        lead_in=0.0, spindle_rpm=3000, controller="krl",
    )  # fmt: skip
    np.testing.assert_array_equal(job.tool.T_flange_tcp[:3, 3], [0, 0, 0.1])
    np.testing.assert_array_equal(job.holes[0].psi_zero, [0, 0, 1])


def test_csv_columns_in_any_order_with_a_mark_and_blank_lines(tmp_path: Path) -> None:
    plain = job_of(tmp_path, CSV_JOB, holes=CSV)
    mixed = "\ufeffdepth_mm, k,j,i,z_mm,y_mm,x_mm,id\r\n50,0,0,1,300,0,500,a\r\n\r\n40.5,0,0,1,300,10,500,b\r\n"
    other = job_of(tmp_path, CSV_JOB, holes=mixed)
    for a, b in zip(plain.holes, other.holes, strict=True):
        assert (a.id, a.depth) == (b.id, b.depth)
        np.testing.assert_array_equal(a.target, b.target)


def test_a_job_from_a_mapping_is_the_job_of_the_file(tmp_path: Path) -> None:
    (tmp_path / "holes.csv").write_text(CSV)
    mapping = {"robot": "kuka_kr6_r700_2", "tool": "thesis_drill", "holes": "holes.csv"}
    assert [hole.id for hole in files.job_from_dict(mapping, tmp_path).holes] == ["a", "b"]


# what is changed in JOB, and what the message must say
BAD_JOBS: dict[str, tuple[str, str, list[str]]] = {
    "unknown robot": (
        "kuka_kr6_r700_2", "kuka_kr9",
        ["line 1", "unknown robot 'kuka_kr9'", "did you mean 'kuka_", "zerorev robots", "path"],
    ),
    "robot file missing": ("kuka_kr6_r700_2", "my/kr.yaml", ["line 1", "my/kr.yaml", "no such file", "robot file"]),
    "robot file is a tool": ("kuka_kr6_r700_2", "tool.yaml", ["tool.yaml", "zerorev.tool/1", "zerorev.robot/1"]),
    "tool of another type": ("thesis_drill", "5", ["line 2, tool", "5", "tcp_mm and rpy_deg"]),
    "inline tool incomplete": ("thesis_drill", "{tcp_mm: [0, 0, 1]}", ["tool.rpy_deg", "missing", "[deg]"]),
    "text for a number": ("depth_mm: 50}", "depth_mm: deep}", ["line 7, holes[0].depth_mm (hole 1)", "'deep' is not a",
                          "above 0 [mm]"]),
    "number as text": ("depth_mm: 50}", "depth_mm: '50'}", ["holes[0].depth_mm", "'50' is not a number"]),
    "truth for a number": ("depth_mm: 50}", "depth_mm: true}", ["holes[0].depth_mm", "True is not a number"]),
    "NaN": ("depth_mm: 50}", "depth_mm: .nan}", ["holes[0].depth_mm", "not a finite number"]),
    "infinite": ("[10, 20, 30]", "[10, .inf, 30]", ["holes[0].target_mm[1]", "not a finite number", "[mm]"]),
    "overflow": ("[10, 20, 30]", "[10, 1e999, 30]", ["holes[0].target_mm[1]", "not a finite number"]),
    "two coordinates": ("[10, 20, 30]", "[10, 20]", ["holes[0].target_mm", "2 entries", "three numbers"]),
    "zero direction": ("[0, -2, 0]", "[0, 0, 0]", ["line 7, holes[0]", "hole 1, direction", "zero vector", "above 0"]),
    "negative depth": ("depth_mm: 50}", "depth_mm: -50}", ["line 7, holes[0].depth_mm", "-50 is too small", "above 0"]),
    "zero depth": ("depth_mm: 50}", "depth_mm: 0}", ["holes[0].depth_mm (hole 1)", "0 is too small"]),
    "no depth": (", depth_mm: 50}", "}", ["holes[0].depth_mm (hole 1)", "missing", "above 0 [mm]"]),
    "reference along the axis": ("blend_mm: 2", "psi_reference: part_y", ["line 7", "hole 1", "part_y is parallel",
                                 "nearest_base"]),
    "unknown reference": ("blend_mm: 2", "psi_reference: up", ["line 4, psi_reference", "'up'", "base_y", "vector"]),
    "unknown key": ("depth_mm: 50}", "dept_mm: 50}", ["holes[0].dept_mm", "unknown key", "did you mean 'depth_mm'"]),
    "unknown key on top": ("blend_mm: 2", "blend: 2", ["line 4, blend", "did you mean 'blend_mm'"]),
    "duplicate key": ("blend_mm: 2", "robot: x", ["line 4", "the key 'robot' is used twice"]),
    "duplicate id": ("id: second", "id: 1", ["line 8, holes[1]", "the id '1' is used twice", "ids that differ"]),
    "fractional id": ("id: second", "id: 1.5", ["holes[1].id", "1.5 is not text"]),
    "branch out of range": ("branch: 2", "branch: 8", ["holes[1].branch (hole 'second')", "8 is too large", "0 to 7"]),
    "spins without stand-offs": ("[10, 20, 30]\n", "[1, 2, 3, 4]\n", ["hole second, psi_deg", "4 spins", "standoff"]),
    "stand-offs that never turn": ("branch: 2", "standoff_mm: [50, 40, 30]", ["hole second", "does not fall"]),
    "stand-offs alone": ("psi_deg: [10, 20, 30]", "standoff_mm: [50, 0, 50]", ["hole second, psi_deg", "missing"]),
    "shortfall beyond the blend": ("blend_mm: 2", "blend_shortfall_mm: 3", ["job.yaml", "blend_shortfall"]),
    "syntax": ("[0, -2, 0]", "[0, -2, 0", ["line 7", "job.yaml", "YAML"]),
    "tab": ("blend_mm: 2", "\tblend_mm: 2", ["line 4", "job.yaml"]),
    "alias": ("blend_mm: 2", "blend_mm: *two", ["line 4", "aliases"]),
    "tag": ("blend_mm: 2", "blend_mm: !!python/name:os.system", ["line 4", "tag"]),
    "tag of a key": ("blend_mm: 2", "!!python/name:os.system blend_mm: 2", ["line 4", "tag"]),
    "control character": ("blend_mm: 2", "blend_mm: \x01", ["line 4", "control character"]),
    "a line break in an id": ("id: second", 'id: "a\\nb"', ["holes[1].id", "one line"]),
}  # fmt: skip


@pytest.mark.parametrize("case", BAD_JOBS)
def test_bad_jobs(case: str, tmp_path: Path) -> None:
    old, new, expected = BAD_JOBS[case]
    tool = ROOT / "src/zerorev/files/tools/thesis_drill.yaml"
    (tmp_path / "tool.yaml").write_text(tool.read_text(encoding="utf-8"), encoding="utf-8")
    assert old in JOB
    message = refusal(lambda: job_of(tmp_path, JOB.replace(old, new, 1)))
    assert message.startswith(str(tmp_path / "job.yaml"))
    for part in expected:
        assert part in message, message


def test_what_a_script_repeats_by_aliases_is_read(tmp_path: Path) -> None:
    text = JOB.replace("[0, -2, 0]", "&down [0, -2, 0]").replace("[0, -1, 0]", "*down")
    text = text.replace("depth_mm: 50}", "depth_mm: &deep 50}").replace("depth_mm: 50\n", "depth_mm: *deep\n")
    first, second = job_of(tmp_path, text).holes
    np.testing.assert_array_equal(first.direction, second.direction)
    assert first.depth == second.depth == 0.05
    for wrong in ("holes: *all", "part_frame: *deep_one", "near_joints_deg: *many"):
        head = f"a: &many {[[0] * 3]}\nb: &deep_one {{x: 1}}\n"
        assert "aliases (*name)" in refusal(lambda head=head, wrong=wrong: job_of(tmp_path, head + wrong))


def test_an_empty_list_of_holes(tmp_path: Path) -> None:
    message = refusal(lambda: job_of(tmp_path, JOB[: JOB.index("holes:")] + "holes: []\n"))
    assert "line 6, holes" in message
    assert "a list of one hole or more, or the path of a CSV" in message


def test_of_many_problems_the_first_few_are_listed(tmp_path: Path) -> None:
    message = refusal(
        lambda: job_of(tmp_path, JOB.replace("50", "deep").replace("robot:", "robots:").replace("2\n", "x\n"))
    )
    assert message.count("\n  - ") == 4
    assert "unknown key 'robots' (accepted: did you mean 'robot'?)" in message.splitlines()[1]
    assert message.splitlines()[-1] == "  - ... and more"


@pytest.mark.parametrize(
    ("csv", "expected"),
    [
        (CSV.replace(",depth_mm", ""), ["line 1", "no column depth_mm", "id,x_mm,y_mm,z_mm,i,j,k,depth_mm"]),
        (CSV.replace(",", "|"), ["line 1", "no column id", "separated by commas, semicolons or tabs"]),
        (CSV.replace("depth_mm", "depth_mm,note,colour"), ["line 2: 8 cells", "line 3: 8 cells (accepted: 10 cells)"]),
        (CSV.replace("depth_mm", "depth_mm,id"), ["line 1", "a column appears twice"]),
        (CSV.replace("40.5", "deep"), ["line 3, column depth_mm", "'deep' is not a finite number", "12.5"]),
        (CSV.replace("40.5", "nan"), ["line 3, column depth_mm", "'nan' is not a finite number"]),
        (CSV.replace("40.5", "inf"), ["line 3, column depth_mm", "'inf' is not a finite number"]),
        (CSV.replace("40.5", ""), ["line 3, column depth_mm", "'' is not a finite number"]),
        (CSV.replace("40.5", "1_0"), ["line 3, column depth_mm", "'1_0' is not a finite number"]),
        (CSV.replace("40.5", "-1"), ["line 3, depth_mm", "-1.0 is too small", "above 0"]),
        (CSV.replace("b,500,10,300,1,", "b,500,10,300,0,"), ["line 3, hole b, direction", "zero vector"]),
        (CSV.replace("40.5", "40.5,1"), ["line 3", "9 cells", "8 cells"]),
        (CSV.replace("b,", "a,"), ["line 3", "the id 'a' is used twice"]),
        (CSV.replace("b,", ","), ["line 3, id", "one line"]),
        (CSV.splitlines()[0], ["no holes", "one row or more"]),
        ("", ["line 1", "no column id"]),
        (CSV.replace("b,", '"b,'), ["line 3", "CSV"]),
    ],
)
def test_bad_csv(csv: str, expected: list[str], tmp_path: Path) -> None:
    message = refusal(lambda: job_of(tmp_path, CSV_JOB, holes=csv))
    assert message.startswith(str(tmp_path / "holes.csv"))
    for part in expected:
        assert part in message, message


def test_a_missing_csv_names_the_job_and_the_csv(tmp_path: Path) -> None:
    message = refusal(lambda: job_of(tmp_path, CSV_JOB))
    assert all(part in message for part in ("job.yaml, line 3, holes", "holes.csv", "no such file", "a CSV file"))


@pytest.mark.parametrize("read", [files.read_job, files.read_plan, files.read_robot, files.read_tool])
def test_files_that_are_none(read: Callable[[Path], object], tmp_path: Path) -> None:
    path = tmp_path / "file.yaml"
    assert "no such file" in refusal(lambda: read(path))
    assert (
        "is a folder" in refusal(lambda: read(path.parent / ".")) if read in (files.read_job, files.read_plan) else True
    )
    path.write_bytes(b"\xff\xfe\x00binary")
    assert "is not text" in refusal(lambda: read(path))
    for text, expected in (("", ("empty", "JSON")), ("[1, 2]", ("not a mapping",)), ("7", ("not a mapping",))):
        path.write_text(text)
        message = refusal(lambda: read(path))
        assert any(part in message for part in expected), message
        assert str(path) in message
    path.write_text("[" * 100_000)
    assert "nested too deep" in refusal(lambda: read(path))
    path.write_text("format: zerorev.other/1\n" if read != files.read_plan else '{"format": "zerorev.other/1"}')
    message = refusal(lambda: read(path))
    assert "zerorev.other/1" in message
    assert "(accepted: format: zerorev." in message
    with path.open("wb") as stream:
        stream.truncate(65 * 2**20)
    assert "larger than 64 MiB" in refusal(lambda: read(path))


def test_yaml_reads_as_its_version_1_2_does(tmp_path: Path) -> None:
    for text, value in (("1e-3", 1e-6), ("+.5", 5e-4), ("2.", 2e-3), ("010", 1e-2), ("1E1", 1e-2)):
        assert job_of(tmp_path, JOB.replace("blend_mm: 2", f"blend_mm: {text}")).settings.blend == pytest.approx(value)
    for text in ("no", "2020-01-01", "1:30", "0x10", "~x"):
        assert job_of(tmp_path, JOB.replace("id: second", f"id: {text}")).holes[1].id == text


# --- plans ------------------------------------------------------------------------------------------------------------


def numbers(shape: tuple[int, ...] | int, low: float, high: float) -> st.SearchStrategy[Any]:
    return arrays(np.float64, shape, elements=st.floats(low, high, allow_subnormal=False))


@st.composite
def plans(draw: st.DrawFn) -> Plan:
    holes, strokes = [], draw(st.sampled_from(["asked", "deepest"]))
    for name in draw(st.lists(st.text("abc1 ü", min_size=1, max_size=4), min_size=1, max_size=3, unique=True)):
        z = draw(numbers(3, -1, 1).filter(lambda v: np.linalg.norm(v) > 0.1))
        across = np.cross(z, np.eye(3)[np.argmin(np.abs(z))])
        depth = draw(st.floats(1e-3, 0.5))
        profile = Profile(np.array([1, 0.4, 0, 0.7, 1]) * depth, draw(numbers(5, -7, 7)))
        asked = draw(st.sampled_from([{}, {"branch": 3}, {"profile": profile}, {"profile": profile, "branch": 5}]))
        answer = HolePlan(Hole(name, draw(numbers(3, -3, 3)), z, depth, across, **asked), "infeasible", 0.1234567)
        if strokes == "deepest" or draw(st.booleans()):
            answer = replace(answer, deepest=draw(st.floats(0, 0.5)))
        counts, rates = tuple(draw(st.lists(st.integers(0, 3), min_size=6, max_size=6))), numbers(6, 1e-3, 50)
        if draw(st.booleans()):
            answer = replace(
                answer,
                status="planned",
                motion=Motion(profile, draw(st.integers(0, 7)), draw(numbers((5, 6), -6.5, 6.5))),
                score=Score(counts, (Event(2, "plunge", depth / 3),), draw(st.floats(0, 30)),
                            draw(rates), np.array([np.nan] * 6), draw(numbers(6, -1, 3))),
                baseline=Baseline(counts, 1 / 3),
                verified=Verification(True, 40_000, 100, counts, 1e-15, np.nan, 1e-4, 0.3, ("a", "b")),
                findings=(Finding("warning", "threshold", "joint 2 is “slow”", name),),
            )  # fmt: skip
        holes.append(answer)
    frame = transform(rotation_rpy(*draw(numbers(3, -1.5, 1.5))), draw(numbers(3, -3, 3)))
    how = Settings(psi_bound=np.pi, near_joints=(0.1,) * 6, blend_shortfall=1e-4, spindle_rpm=3000.0, legs="free")
    robot = files.read_robot(draw(st.sampled_from(files.robot_names())))
    said = (Finding("info", "deepest", "y"),)
    return Plan(robot, files.read_tool("thesis_drill"), how, tuple(holes), frame, "ü", said, strokes)


def differences(a: Any, b: Any, path: str = "plan") -> list[str]:
    """Where two nouns differ, numbers by more than 1e-12."""
    if isinstance(a, (float, np.ndarray)):
        same = np.allclose(a, b, rtol=1e-12, atol=1e-12, equal_nan=True)
        return [] if same else [f"{path}: {a!r} {b!r}"]
    if isinstance(a, tuple) and len(a) == len(b):
        return [found for i in range(len(a)) for found in differences(a[i], b[i], f"{path}[{i}]")]
    if is_dataclass(a):
        names = [field.name for field in fields(a) if field.compare]
        return [found for name in names for found in differences(getattr(a, name), getattr(b, name), f"{path}.{name}")]
    return [] if a == b else [f"{path}: {a!r} {b!r}"]


@settings(max_examples=30, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(plan=plans())
def test_a_plan_comes_back_and_is_written_the_same_again(plan: Plan, tmp_path: Path) -> None:
    first, second = tmp_path / "first.json", tmp_path / "second.json"
    files.write_plan(plan, first)
    back = files.read_plan(first)
    assert not differences(back, plan)
    files.write_plan(back, second)
    assert first.read_bytes() == second.read_bytes()
    assert json.loads(first.read_text(encoding="utf-8")) == files.plan_to_json(plan)


def test_a_plan_of_before_there_were_depths_and_free_legs_still_reads(tmp_path: Path) -> None:
    path = tmp_path / "plan.json"
    data = files.plan_to_json(small_plan())
    for key in ("legs", "max_twist_deg_per_mm"):
        del data["settings"][key]
    del data["holes"][0]["deepest_mm"]
    path.write_text(json.dumps(data), encoding="utf-8")
    assert not differences(files.read_plan(path), small_plan())


def small_plan() -> Plan:
    hole = Hole("7", np.array([0.5, 0, 0.3]), np.array([1.0, 1.0, 0]), 0.05, np.array([0, 0, 1.0]))
    motion = Motion(Profile.straight(0.05, -0.0, 0.1, 0.2), 0, np.arange(18.0).reshape(3, 6) / 10)
    score = Score((0,) * 6, (), 1.0, np.ones(6), np.ones(6), np.ones(6))
    answer = HolePlan(hole, "planned", 0.1, motion, score, Baseline((1, 0, 0, 0, 0, 0), 2.0))
    return Plan(files.read_robot("kuka_kr6_r700_2"), files.read_tool("thesis_drill"), Settings(), (answer,))


def test_a_plan_file_reads_well(tmp_path: Path) -> None:
    files.write_plan(small_plan(), tmp_path / "plan.json")
    lines = (tmp_path / "plan.json").read_text().splitlines()
    assert lines[1] == '  "format": "zerorev.plan/1",'
    assert '      "standoff_mm": [50.0, 0.0, 50.0],' in lines
    assert '      "direction": [0.7071067811865, 0.7071067811865, 0.0],' in lines
    assert max(map(len, lines)) <= 160
    assert all(line.endswith("],") for line in lines if '_rate_deg_per_mm": [' in line)
    assert not any("-0.0," in line for line in lines)


@pytest.mark.parametrize(
    ("old", "new", "expected"),
    [
        ("zerorev.plan/1", "zerorev.plan/2", ["zerorev.plan/2", "accepted: format: zerorev.plan/1"]),
        ('"format": "zerorev.plan/1",', "", ["no key 'format'", "zerorev.plan/1"]),
        ("365.0", "366.0", ["robot, sha256", "altered", "plan again"]),
        ("100.0, 0.0, 65.0", "100.0, 0.0, NaN", ["NaN is not a number", "finite"]),
        ("100.0, 0.0, 65.0", "100.0, 0.0, 1e999", ["not a finite number"]),
        ("50.0, 0.0, 50.0", "50.0, 0.0", ["holes[0].standoff_mm (hole '7')", "2 entries"]),
        ("50.0, 0.0, 50.0", "50.0, 0.0, 20.0, 50.0", ["holes[0] (hole 7)", "psi_deg", "contradicts"]),
        ('"branch": 0', '"branch": null', ["holes[0] (hole 7)", "some are null", "all or none"]),
        ('"travel_deg": 57.2', '"travel": 57.2', ["unknown key 'travel'", "did you mean 'travel_deg'"]),
        ('"reversals": 0', '"reversals": 2', ["holes[0] (hole 7), reversals", "contradicts"]),
        ('"reversals": 1', '"reversals": 2', ["baseline.reversals", "contradicts"]),
        ('"depth_mm": 50.0', '"depth_mm": -50.0', ["holes[0].depth_mm", "too small", "above 0"]),
        ('"id": "7"', '"id": 7', ["holes[0].id (hole 7)", "7 is not text"]),
        ('"id": "7"', '"id": "7", "id": "8"', ["the key 'id' is used twice"]),
        ('"id": "7"', '"id": "\\ud800"', ["holes[0].id", "cannot be used"]),
    ],
)
def test_bad_plans(old: str, new: str, expected: list[str], tmp_path: Path) -> None:
    path = tmp_path / "plan.json"
    files.write_plan(small_plan(), path)
    text = path.read_text(encoding="utf-8")
    assert old in text
    path.write_text(text.replace(old, new, 1), encoding="utf-8")
    message = refusal(lambda: files.read_plan(path))
    assert message.startswith(str(path))
    for part in expected:
        assert part in message, message


def test_a_plan_cut_short_says_so(tmp_path: Path) -> None:
    path = tmp_path / "plan.json"
    files.write_plan(small_plan(), path)
    path.write_text(path.read_text()[:-40].rstrip().rsplit("\n", 3)[0])
    assert "cut short" in refusal(lambda: files.read_plan(path))


def test_a_job_and_a_plan_are_distinguished(tmp_path: Path) -> None:
    path = tmp_path / "plan.json"
    files.write_plan(small_plan(), path)
    assert "zerorev.plan/1" in refusal(lambda: files.read_job(path))
    path.write_text(JOB)
    assert "JSON" in refusal(lambda: files.read_plan(path))


def test_a_number_that_no_file_may_hold_is_refused_before_writing(tmp_path: Path) -> None:
    plan = small_plan()
    broken = replace(plan, holes=(replace(plan.holes[0], wrist_offset=float("nan")),))
    assert "holes[0].wrist_offset_mm" in refusal(lambda: files.write_plan(broken, tmp_path / "plan.json"))
    assert not list(tmp_path.iterdir())


# --- any bytes --------------------------------------------------------------------------------------------------------

MUTATIONS = st.lists(
    st.tuples(
        st.floats(0, 1, exclude_max=True),
        st.integers(0, 6),
        st.one_of(
            st.sampled_from(["*a", "&a ", "!!int ", "!!set ", "null", "[", "{", "}", ": ", "- ", "'", '"', "\t"]),
            st.sampled_from(["nan", ".nan", "1e999", "9" * 5000, "0", "true", "\\ud800", "\\u0000", "%TAG", "---"]),
            st.text(max_size=3).map(lambda text: text.encode("utf-8", "replace").decode()),
        ),
    ),
    min_size=1,
    max_size=3,
)  # fmt: skip


def mutated(text: str, changes: list[tuple[float, int, str]]) -> str:
    for place, length, new in changes:
        at = int(place * len(text))
        text = text[:at] + new + text[at + length :]
    return text


@settings(max_examples=60, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(changes=MUTATIONS)
def test_a_mutated_job_is_read_or_refused(changes: list[tuple[float, int, str]], tmp_path: Path) -> None:
    (tmp_path / "job.yaml").write_text(mutated(JOB, changes), encoding="utf-8")
    try:
        files.read_job(tmp_path / "job.yaml")
    except InputError as error:
        str(error).encode()  # fit for any terminal


@settings(max_examples=50, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(changes=MUTATIONS)
def test_a_mutated_csv_is_read_or_refused(changes: list[tuple[float, int, str]], tmp_path: Path) -> None:
    try:
        job_of(tmp_path, CSV_JOB, holes=mutated(CSV, changes))
    except InputError as error:
        str(error).encode()  # fit for any terminal


@settings(max_examples=50, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(changes=MUTATIONS)
def test_a_mutated_plan_is_read_or_refused(changes: list[tuple[float, int, str]], tmp_path: Path) -> None:
    text = json.dumps(files.plan_to_json(small_plan()))
    (tmp_path / "plan.json").write_text(mutated(text, changes), encoding="utf-8")
    try:
        files.read_plan(tmp_path / "plan.json")
    except InputError as error:
        str(error).encode()  # fit for any terminal


@settings(max_examples=40, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(content=st.binary(max_size=40))
def test_any_bytes_are_refused(content: bytes, tmp_path: Path) -> None:
    path = tmp_path / "file.yaml"
    path.write_bytes(content)
    for read in (files.read_job, files.read_plan, files.read_robot, files.read_tool):
        assert refusal(lambda read=read: read(path))


def test_paths_that_no_system_takes() -> None:
    for path in ("a\0b.yaml", "x" * 5000 + ".yaml"):
        for read in (files.read_job, files.read_plan, files.read_robot, files.read_tool):
            assert "cannot be read" in refusal(lambda read=read, path=path: read(path))
        with pytest.raises(OutputError):
            output.write_text(path, "text")


# --- writing ----------------------------------------------------------------------------------------------------------


def test_writing_replaces_the_whole_file_and_follows_links(tmp_path: Path) -> None:
    path, link = tmp_path / "out.txt", tmp_path / "link.txt"
    link.symlink_to(path)
    output.write_text(path, "old")
    output.write_text(str(link), "new ü\n")
    assert path.read_bytes() == "new ü\n".encode()
    assert link.is_symlink()
    assert sorted(tmp_path.iterdir()) == [link, path]


def test_output_that_cannot_be_written_leaves_nothing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def no_space(*_: object) -> None:
        raise OSError(28, "No space left on device")

    path = tmp_path / "out.txt"
    with pytest.raises(OutputError, match=r"folder .*none does not exist; what was there is unchanged"):
        output.write_text(tmp_path / "none" / "out.txt", "x")
    with pytest.raises(OutputError, match="it is a folder"):
        output.write_text(tmp_path, "x")
    with pytest.raises(OutputError, match="not a regular file"):
        output.write_text(os.devnull, "x")
    with pytest.raises(OutputError, match="surrogates not allowed"):
        output.write_text(path, "\ud800")
    path.write_text("old")
    monkeypatch.setattr(os, "access", lambda *_: False)  # root may do anything, so the system cannot be asked here
    with pytest.raises(OutputError, match="no write permission"):
        output.write_text(path, "x")
    monkeypatch.undo()
    for name in ("fsync", "replace"):
        with monkeypatch.context() as patch:
            patch.setattr(os, name, no_space)
            with pytest.raises(OutputError, match="No space left"):
                output.write_text(path, "x")
    assert [(entry.name, entry.read_text()) for entry in tmp_path.iterdir()] == [("out.txt", "old")]


SCHEMAS = ROOT / "docs/schemas"


def test_the_published_schemas_are_current(tmp_path: Path) -> None:
    files.write_schemas(tmp_path)
    for name in ("job.schema.json", "plan.schema.json", "depth.schema.json", "map.schema.json", "cell.schema.json"):
        committed, made = (json.loads((folder / name).read_text(encoding="utf-8")) for folder in (SCHEMAS, tmp_path))
        assert committed == made, "run `make schemas`"  # as data: some versions of pydantic write 0.0, some 0


def test_every_published_field_says_what_is_accepted() -> None:
    for name in ("job.schema.json", "plan.schema.json", "depth.schema.json", "map.schema.json", "cell.schema.json"):
        schema = json.loads((ROOT / "docs/schemas" / name).read_text(encoding="utf-8"))
        for form in (schema, *schema["$defs"].values()):
            assert all(field.get("description") for field in form["properties"].values())
