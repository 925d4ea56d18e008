"""`zerorev check --certify --tolerance`: what it writes into the plan file, and what it refuses."""

import json
import re

import pytest

from oracles.places import JOBS
from zerorev import cli
from zerorev.cli import main


@pytest.fixture(scope="module")
def text(tmp_path_factory):
    plan = tmp_path_factory.mktemp("plan") / "plan.json"
    assert main(["plan", str(JOBS / "thesis_positions.yaml"), "-o", str(plan), "--json"]) == cli.FINE
    return plan.read_text()


@pytest.fixture
def plan_file(text, tmp_path):
    path = tmp_path / "plan.json"
    path.write_text(text)
    return path


def within(plan_file):
    return [hole["certified_within"] for hole in json.loads(plan_file.read_text())["holes"]]


def test_the_largest_is_written_into_the_plan(plan_file, capsys):
    assert within(plan_file) == [None] * 3
    assert main(["check", "--certify", "--tolerance", str(plan_file)]) == cli.FINE
    out, _ = capsys.readouterr()
    found = within(plan_file)
    assert [box["mm"] for box in found] == pytest.approx([5.07, 1.93, 0.65], rel=0.02)
    assert [box["deg"] * 10 for box in found] == pytest.approx([box["mm"] for box in found])
    assert f"yes, certified within {found[0]['mm']:g} mm, {found[0]['deg']:g} deg" in " ".join(out.split())
    assert re.search(
        r"A\d turns round on the (plunge|retract), stand-off \d+ mm with the part shifted by", " ".join(out.split())
    )
    # it is proven again, and the file stays as it is
    before = plan_file.read_text()
    assert main(["check", "--certify", "--json", str(plan_file)]) == cli.FINE
    assert plan_file.read_text() == before


def test_a_given_one(plan_file, capsys):
    options = ["--certify", "--tolerance-mm", "1", "--tolerance-deg", "0.1"]
    assert main(["check", *options, str(plan_file)]) == cli.FOUND
    out, _ = capsys.readouterr()
    assert within(plan_file) == [{"mm": 1.0, "deg": 0.1}] * 2 + [None]
    assert "position_3: not certified within 1 mm and 0.1 deg: A1 turns round" in " ".join(out.split())
    options[-1] = "0.05"
    options[-3] = "0.5"
    assert main(["check", *options, str(plan_file)]) == cli.FINE
    assert within(plan_file) == [{"mm": 0.5, "deg": 0.05}] * 3


def test_another_ratio(plan_file):
    assert main(["check", "--certify", "--tolerance", "--tolerance-ratio", "100", "--json", str(plan_file)]) == cli.FINE
    assert all(box["mm"] == pytest.approx(100 * box["deg"]) for box in within(plan_file))


def test_a_figure_that_was_altered_is_taken_out(plan_file, capsys):
    data = json.loads(plan_file.read_text())
    data["holes"][1]["certified_within"] = {"mm": 3.0, "deg": 0.3}
    plan_file.write_text(json.dumps(data))
    assert main(["check", "--certify", str(plan_file)]) == cli.FINE
    assert "not certified within 3 mm and 0.3 deg" in " ".join(capsys.readouterr().out.split())
    assert within(plan_file) == [None] * 3


def test_a_file_without_the_key_is_read(plan_file):
    data = json.loads(plan_file.read_text())
    for hole in data["holes"]:
        del hole["certified_within"]
    plan_file.write_text(json.dumps(data))
    assert main(["check", "--json", str(plan_file)]) == cli.FINE


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (["--tolerance"], "--tolerance: a tolerance is only certified (accepted: --certify beside it)"),
        (["--certify", "--tolerance-mm", "1"], "--tolerance-deg: is missing"),
        (["--certify", "--tolerance-deg", "1"], "--tolerance-mm: is missing"),
        (["--certify", "--tolerance-mm=-1", "--tolerance-deg", "1"], "--tolerance-mm: -1 is not a tolerance"),
        (["--certify", "--tolerance-mm", "nan", "--tolerance-deg", "1"], "--tolerance-mm: nan is not a tolerance"),
        (["--certify", "--tolerance-mm", "1", "--tolerance-deg", "inf"], "--tolerance-deg: inf is not a tolerance"),
        (["--certify", "--tolerance", "--tolerance-mm", "1", "--tolerance-deg", "1"], "one is given"),
        (["--certify", "--tolerance", "--tolerance-ratio", "0"], "--tolerance-ratio: 0 is not a ratio"),
        (["--certify", "--tolerance-ratio", "5"], "--tolerance-ratio: has no use"),
        (["--certify", "--tolerance", "--program", "nowhere.src"], "do not move with the part"),
    ],
)
def test_one_clear_message(plan_file, capsys, options, said):
    before = plan_file.read_text()
    assert main(["check", *options, str(plan_file)]) == cli.BAD_INPUT
    _, err = capsys.readouterr()
    assert said in " ".join(err.split())
    assert len([line for line in err.splitlines() if line.startswith("error")]) == 1
    assert plan_file.read_text() == before
