"""Programs of jobs as users have them: long names and ids, words of KRL, and what a controller adds to a file."""

import json
import re
import shutil

import pytest
import yaml

from oracles.places import ROOT
from zerorev.cli import main

PRACTICE = ROOT / "tests/data/practice"


@pytest.fixture(scope="module")
def block(tmp_path_factory):
    """A job of three holes and its plan."""
    folder = tmp_path_factory.mktemp("block")
    shutil.copy(PRACTICE / "c13_block/block.yaml", folder)
    assert main(["plan", str(folder / "block.yaml"), "-o", str(folder / "block.json"), "--proof-boxes", "0"]) == 0
    return folder / "block.json"


def with_settings(plan, folder, **settings):
    """The same plan with other settings for its program."""
    data = json.loads(plan.read_text())
    data["settings"] |= settings
    path = folder / plan.name
    path.write_text(json.dumps(data))
    return path


def exported(plan, name, *options):
    program = plan.with_name(name)
    assert main(["export", str(plan), "-o", str(program), *options]) == 0
    return program


def certified(plan, program, capsys):
    """The exit code, and the verdicts of the holes."""
    capsys.readouterr()
    code = main(["check", str(plan), "--certify", "--program", str(program), "--json"])
    return code, [
        hole["certificate"] and hole["certificate"]["verdict"] for hole in json.loads(capsys.readouterr().out)["holes"]
    ]


def test_c02_two_stations_two_programs(tmp_path):
    for station in (100, 200):
        name = f"panel_upper_skin_station_{station}"
        shutil.copy(PRACTICE / "c02_name_overwrite" / f"{name}.yaml", tmp_path)
        plan = tmp_path / f"{name}.json"
        assert main(["plan", str(tmp_path / f"{name}.yaml"), "-o", str(plan), "--proof-boxes", "0"]) == 0
        assert main(["export", str(plan)]) == 0
    programs = [path.read_text() for path in tmp_path.glob("*.src")]
    stations = [re.search(r"^; Plan      panel_upper_skin_station_(\d+)$", text, re.MULTILINE)[1] for text in programs]
    assert sorted(stations) == ["100", "200"]


def test_c03_ids_that_differ_at_their_ends(tmp_path, capsys):
    shutil.copy(PRACTICE / "c03_ids/long.yaml", tmp_path)
    plan = tmp_path / "long.json"
    main(["plan", str(tmp_path / "long.yaml"), "-o", str(plan), "--proof-boxes", "0"])
    program = exported(plan, "long.src", "--skip-failed")
    assert re.search(r";FOLD Hole 2 of 2: WING-LH/.*POSITION-0002 ~", program.read_text())
    _, verdicts = certified(plan, program, capsys)
    assert verdicts == [None, "certified"]


@pytest.mark.parametrize("name", ["spl", "stop", "sin", "slin_rel"])
def test_c04_words_of_krl(name, tmp_path, block):
    data = json.loads(block.read_text()) | {"name": name}
    (tmp_path / "plan.json").write_text(json.dumps(data))
    assert main(["export", str(tmp_path / "plan.json")]) == 0
    (program,) = tmp_path.glob("*.src")
    assert re.fullmatch(rf"drill_{name}_[a-z2-7]{{6}}", program.stem)
    assert f"DEF {program.stem} ( )" in program.read_text()


def test_c13_the_controllers_own_numbers(block, tmp_path, capsys):
    plan = with_settings(block, tmp_path, tool_number=3, base_number=2)
    text = exported(plan, "block.src").read_text()
    assert "\n$ACT_TOOL=3\n$LOAD={LOAD: M 0.3000,CM {X 50.0000,Y 0.0000,Z 32.5000," in text
    assert "\n$ACT_BASE=2\n" in text
    assert certified(plan, plan.with_name("block.src"), capsys) == (0, 3 * ["certified"])


def test_c14_a_robot_on_a_booster(block, tmp_path, capsys):
    """By the variable, and by numbers; what the user corrects by hand is the program of the job that says so."""
    plain = exported(block, "block.src").read_text()
    by_hand = re.sub(r"(?m)^\$BASE=(\{FRAME: .*\})$", r"$BASE=$ROBROOT:\1", plain)
    plan = with_settings(block, tmp_path, robroot="$ROBROOT")
    (tmp_path / "block.src").write_text(by_hand)
    assert certified(plan, tmp_path / "block.src", capsys) == (0, 3 * ["certified"])
    plan = with_settings(block, tmp_path, robroot={"xyz_mm": [0, 0, 400], "rpy_deg": [0, 0, 0]})
    program = exported(plan, "block.src")
    assert "$BASE={FRAME: X 0.0000,Y 0.0000,Z 400.0000," in program.read_text()
    assert certified(plan, program, capsys) == (0, 3 * ["certified"])
    assert certified(block, program, capsys) == (1, 3 * ["refuted"])


def test_c14_a_rail(block, tmp_path, capsys):
    plan = with_settings(block, tmp_path, external_axes=[{"name": "E1", "at": 1500}], robroot="$ROBROOT_C")
    program = exported(plan, "block.src")
    assert len(re.findall(r"(?m)^PTP \{E6AXIS: A1 .*,A6 [-\d.]+,E1 1500\.0000\}$", program.read_text())) == 3
    assert certified(plan, program, capsys) == (0, 3 * ["certified"])
    program.write_text(program.read_text().replace(",E1 1500.0000}", ",E1 1600.0000}", 1))
    assert certified(plan, program, capsys)[1] == ["refuted", "certified", "certified"]


def test_c17_a_program_that_comes_back_from_the_controller(block, tmp_path, capsys):
    text = exported(block, "block.src").read_text()
    back = re.sub("(?m)^&REL 1$", "&REL 14", text)
    back = re.sub("(?m)^(&COMMENT.*)$", r"\1\n&PARAM EDITMASK = *\n&PARAM DISKPATH = KRC:\\\\R1\\\\Program\n&FOO", back)
    back = back.replace("DEF block ( )", "DEF block( )")
    path = tmp_path / "block.src"
    path.write_text(back, newline="\r\n")
    assert certified(block, path, capsys) == (0, 3 * ["certified"])


def test_the_options_of_plan_reach_the_program(tmp_path):
    job = yaml.safe_load((PRACTICE / "c13_block/block.yaml").read_text())
    job |= {"holes": job["holes"][:1], "calls": {"before_hole": ["SPINDLE_ON(6000)"]}, "proof_boxes": 0}
    (tmp_path / "job.yaml").write_text(yaml.safe_dump(job))
    plan = tmp_path / "plan.json"
    assert main(["plan", str(tmp_path / "job.yaml"), "-o", str(plan), "--tool-number", "5"]) == 0
    text = exported(plan, "job.src").read_text()
    assert "\n$ACT_TOOL=5\n" in text
    assert "\nWAIT SEC 0.0\nSPINDLE_ON(6000)\n$VEL.CP=" in text
