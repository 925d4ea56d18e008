"""Jobs whose holes are drilled by several tools, one after the other."""

import json
from pathlib import Path

import numpy as np
import pytest

from zerorev.cli import main
from zerorev.errors import InputError
from zerorev.files.io import job_from_dict, plan_from_text, plan_to_json, read_plan
from zerorev.model.cycle import Cycle
from zerorev.planning.job import plan_job
from zerorev.planning.restated import check_plan
from zerorev.verify.certificate.certify import certify_plan

DRILL = {"tcp_mm": [100, 0, 65], "rpy_deg": [0, -90, 0]}
REAMER = {"tcp_mm": [120, 0, 80], "rpy_deg": [0, -90, 0]}
JOB = {
    "name": "two",
    "robot": "kuka_kr6_r700_2",
    "proof_boxes": 0,
    "tools": [
        {"tool": DRILL, "tool_number": 2, "cycle": {"kind": "peck", "depth_mm": 10}},
        {"tool": REAMER, "tool_number": 3, "depth_mm": 22, "feed_mm_s": {"plunge": 2}},
    ],
    "holes": [
        {"id": "a", "target_mm": [500, 300, 800], "direction": [1, 0, 0], "depth_mm": 20},
        {"id": "b", "target_mm": [500, 340, 800], "direction": [1, 0, 0], "depth_mm": 8},
    ],
}


@pytest.fixture(scope="module")
def plan():
    return plan_job(job_from_dict(JOB))


@pytest.fixture
def files(tmp_path):
    """The job as a file, and its plan beside it."""
    (tmp_path / "two.yaml").write_text(json.dumps(JOB))
    assert main(["plan", str(tmp_path / "two.yaml"), "-o", str(tmp_path / "two.plan.json")]) == 0
    return tmp_path


def test_each_tool_has_what_is_its_own_and_else_what_is_the_jobs():
    job = job_from_dict(JOB)
    (reamer,) = job.further
    assert (job.settings.tool_number, reamer.settings.tool_number) == (2, 3)
    assert (job.settings.cycle.kind, reamer.settings.cycle) == ("peck", Cycle())
    assert reamer.settings.feed_plunge == 2e-3
    assert reamer.settings.feed_retract == job.settings.feed_retract
    assert [hole.depth for hole in job.holes] == [20e-3, 8e-3]
    assert [hole.depth for hole in reamer.holes] == [22e-3, 22e-3]
    for one, other in zip(job.holes, reamer.holes, strict=True):
        np.testing.assert_allclose(one.entry, other.entry, atol=1e-12)
    assert reamer.name == "two_tool_2"


def test_one_tool_in_the_list_is_that_tool():
    alone = job_from_dict({**JOB, "tools": JOB["tools"][1:]})
    assert alone.further == ()
    assert alone.settings.tool_number == 3


def test_the_plan_has_no_reversal_of_either_tool(plan):
    assert [hole.score.reversals for each in plan.of_all_tools for hole in each.holes] == [0] * 4
    assert plan.further[0].order == ("a", "b")
    assert plan.further[0].tool.T_flange_tcp[0, 3] == 0.12


def test_strokes_of_all_tools_stand_in_each_hole(plan):
    data = plan_to_json(plan)
    strokes = [[(each["tool"], each["depth_mm"]) for each in hole["strokes"]] for hole in data["holes"]]
    assert strokes == [[(0, 10.0), (0, 20.0), (1, 22.0)], [(0, 8.0), (1, 22.0)]]
    last = data["holes"][1]["strokes"][-1]
    assert last["standoff_mm"] == [8.0, -14.0, 8.0]
    assert last["feeds_mm_s"] == {"plunge": 2.0, "retract": 20.0}
    assert plan_to_json(plan_from_text(json.dumps(data), "plan")) == data


def test_the_check_and_the_certificate_take_every_tool(plan):
    again = plan_from_text(json.dumps(plan_to_json(plan)), "plan")
    assert check_plan(again).as_stated
    proven = certify_plan(again)
    assert [hole.certificate.verdict for each in proven.of_all_tools for hole in each.holes] == ["certified"] * 4


@pytest.mark.parametrize(
    ("edit", "said"),
    [
        (lambda data: data["holes"][0]["strokes"][-1].update(tool=2), "tool"),
        (lambda data: data["holes"][0]["strokes"].pop(), "those of further tools"),
        (lambda data: data["holes"][0]["strokes"][-1]["psi_deg"].__setitem__(1, 1.0), "psi_deg"),
        (lambda data: data["tools"][0]["holes"][0].update(travel_deg=1.0), "travel_deg"),
        (lambda data: data["tools"][0]["holes"][0].update(id="c"), "ids"),
        (lambda data: data["tools"][0]["tool"]["tcp_mm"].__setitem__(0, 121.0), "sha256"),
        (lambda data: data["tools"][0]["settings"]["feed_mm_s"].update(plunge=3.0), "feed"),
        (lambda data: data["tools"][0].update(cycle_time_s=1.0), "cycle_time_s"),
    ],
)
def test_what_was_altered_of_a_further_tool_is_refused_by_name(edit, said, plan):
    data = json.loads(json.dumps(plan_to_json(plan)))
    edit(data)
    try:
        checked = check_plan(plan_from_text(json.dumps(data), "plan"))
    except InputError as error:
        found = [str(error)]
    else:
        assert not checked.as_stated
        found = [finding.message for each in (checked, *checked.further) for finding in each.wrong]
        marked = checked.marked()
        assert not all(hole.verified.passed for each in marked.of_all_tools for hole in each.holes) or any(
            finding.level == "error" for each in marked.of_all_tools for finding in each.findings
        )
    assert any(said in message for message in found), found


def test_each_tool_has_a_program_of_its_own_that_is_certified(files, capsys):
    plan = files / "two.plan.json"
    assert main(["export", str(plan)]) == 0
    first, second = files / "two.src", files / "two_tool_2.src"
    assert "X 100.0000" in first.read_text()
    assert "X 120.0000" in second.read_text()
    assert "$ACT_TOOL=3" in second.read_text()
    for program in (first, second):
        assert main(["check", "--certify", str(plan), "--program", str(program)]) == 0
    wrong = files / "wrong.src"
    wrong.write_text(second.read_text().replace("$ACT_TOOL=3", "$ACT_TOOL=2"))
    capsys.readouterr()
    assert main(["check", "--certify", str(plan), "--program", str(wrong)]) == 1


def test_the_programs_of_two_plain_tools_are_certified_at_once(tmp_path, capsys):
    job, plan = tmp_path / "two.yaml", tmp_path / "two.json"
    plain = [{key: value for key, value in use.items() if key != "cycle"} for use in JOB["tools"]]
    job.write_text(json.dumps(JOB | {"tools": plain}))
    assert main(["plan", str(job), "-o", str(plan)]) == 0
    assert main(["export", str(plan)]) == 0
    programs = ["--program", str(tmp_path / "two.src"), "--program", str(tmp_path / "two_tool_2.src")]
    capsys.readouterr()
    assert main(["check", "--certify", str(plan), *programs]) == 0
    said = capsys.readouterr().out
    assert said.count("yes, certified") == 4
    assert said.count("as it was read back") == 2
    assert main(["check", "--certify", str(plan), *programs, "--json"]) == 0
    assert [each["program"] for each in json.loads(capsys.readouterr().out)] == ["two", "two_tool_2"]
    (tmp_path / "two.src").write_text((tmp_path / "two.src").read_text().replace("$ACT_TOOL=2", "$ACT_TOOL=3"))
    assert main(["check", "--certify", str(plan), *programs]) == 1
    assert main(["check", "--certify", str(plan), *programs, "--report", str(tmp_path / "r.html")]) == 2


def test_one_tools_program_alone_and_under_another_name(files, capsys):
    plan = files / "two.plan.json"
    assert main(["export", str(plan), "--tool", "2", "-o", str(files / "ream.src")]) == 0
    assert "X 120.0000" in (files / "ream.src").read_text()
    assert main(["export", str(plan), "-o", str(files / "all.src")]) == 0
    assert (files / "all_tool_2.src").is_file()
    assert main(["export", str(plan), "--tool", "3"]) == 2
    assert "there is no tool 3 (accepted: 1 to 2)" in capsys.readouterr().err
    assert main(["export", str(plan), "--retract", "a"]) == 2
    assert main(["export", str(plan), "--retract", "a", "--tool", "2"]) == 0


def test_the_plan_of_the_command_is_that_of_the_library(files, plan):
    assert plan_to_json(read_plan(files / "two.plan.json")) == plan_to_json(plan)


def test_commands_with_no_choice_say_that_only_the_first_tool_counts(files, capsys):
    assert main(["offset", str(files / "two.yaml"), "--offsets-mm", "100"]) in (0, 1)
    assert "two: of its 2 tools only the first counts here, tool" in capsys.readouterr().err


def test_recorded_and_measured_holes_are_those_of_the_first_tool(files, capsys):
    """And of the strokes of a hole nothing is predicted as if one of them drilled all of it."""
    measured = files / "measured.csv"
    measured.write_text("hole,depth_mm,x_mm,y_mm,diameter_mm\na,1,0,0,6\na,19,0,0.1,6\nb,1,0,0,6\nb,7,0,0,6\n")
    assert main(["recordings", "holes", str(measured), "--plan", str(files / "two.plan.json"), "--sets", "1"]) == 1
    said = capsys.readouterr()
    assert "of its 2 tools only the first counts here" in said.err
    assert "is drilled in 2 strokes, each of which is simulated for itself" in said.out


@pytest.mark.parametrize("command", [["rates", "two.yaml"], ["compare", "two.plan.json", "two.yaml"]])
def test_a_table_is_of_the_chosen_tool_and_says_that_there_are_others(command, files, capsys, monkeypatch):
    monkeypatch.chdir(files)
    assert main(command) == 0
    first = capsys.readouterr()
    assert "this is tool 1 of 2, tool; --tool 2 shows the other" in first.err
    assert main([*command, "--tool", "2"]) == 0
    second = capsys.readouterr()
    assert "tool 1 of 2" not in second.err
    assert second.out != first.out
    assert main([*command, "--tool", "0"]) == 2
    assert "there is no tool 0 (accepted: 1 to 2)" in capsys.readouterr().err


def test_the_virtual_cell_runs_the_strokes_of_the_chosen_tool(files, capsys):
    simulate = ["simulate", str(files / "two.plan.json"), "--sets", "1", "--json", "--workers", "1"]
    assert main(simulate) == 0
    first = capsys.readouterr()
    assert [hole["id"] for hole in json.loads(first.out)["holes"]] == ["a, stroke 1", "a, stroke 2", "b"]
    assert "this is tool 1 of 2" in first.err
    assert main([*simulate, "--tool", "2"]) == 0
    assert [hole["id"] for hole in json.loads(capsys.readouterr().out)["holes"]] == ["a", "b"]


def test_the_replay_is_of_the_chosen_tool(files, capsys):
    pytest.importorskip("nicegui", reason="the replay takes three.js from NiceGUI (pip install 'zerorev[view]')")
    first, second = files / "first.html", files / "second.html"
    assert main(["replay", str(files / "two.plan.json"), "-o", str(first)]) == 0
    assert "this is tool 1 of 2" in capsys.readouterr().err
    assert main(["replay", str(files / "two.plan.json"), "-o", str(second), "--tool", "2"]) == 0
    assert "(the first of 2)" in first.read_text()
    assert "Replay of two_tool_2" in second.read_text()


@pytest.mark.parametrize(
    ("job", "said"),
    [
        ({**JOB, "tool": DRILL}, "tool: stands beside tools"),
        ({key: value for key, value in JOB.items() if key != "tools"}, "tool: is missing"),
        ({**JOB, "tools": []}, "tools"),
        ({**JOB, "tools": [{"tool": DRILL, "depth_mm": 0}]}, "depth_mm"),
        ({**JOB, "tools": [{"tool": "no_such_tool"}]}, "tools[0].tool"),
        ({**JOB, "tools": [{"tool": DRILL}, {"tool": REAMER, "cycle": {"kind": "peck"}}]}, "tools[1]"),
        ({**JOB, "tools": [{"tool": DRILL, "feed_mm_s": {"plunge": -1}}]}, "plunge"),
        (  # known before the first tool is planned
            {**JOB, "tools": [{"tool": DRILL}, {"tool": REAMER, "cycle": {"kind": "peck", "depth_mm": 0.01}}]},
            "tools[1], hole a, cycle, depth_mm: 2000 pecks in 20 mm",
        ),
    ],
)
def test_bad_input_is_one_error_that_says_where(job, said):
    with pytest.raises(InputError) as error:
        job_from_dict(job)
    assert said in str(error.value), str(error.value)


def test_a_given_motion_is_for_the_depth_of_its_hole():
    holes = [{**JOB["holes"][0], "psi_deg": [0, 5, 10]}]
    with pytest.raises(InputError, match="hole a has a given motion"):
        job_from_dict({**JOB, "holes": holes})


def test_a_moved_job_finds_its_tools(tmp_path):
    """Tool files lie beside the job; written elsewhere, it leads there all the same."""
    from zerorev.files.io import read_job
    from zerorev.files.moved_job import write_job

    (tmp_path / "here").mkdir()
    (tmp_path / "there").mkdir()
    (tmp_path / "here" / "ream.yaml").write_text(json.dumps({"format": "zerorev.tool/1", "name": "ream", **REAMER}))
    tools = [{"tool": DRILL}, {"tool": "./ream.yaml"}]
    source: Path = tmp_path / "here" / "job.yaml"
    source.write_text(json.dumps({**JOB, "tools": tools}))
    write_job(tmp_path / "there" / "job.yaml", source, ids=["b"])
    moved = read_job(tmp_path / "there" / "job.yaml")
    assert moved.further[0].tool.name == "ream"
    assert [hole.id for hole in moved.further[0].holes] == ["b"]
