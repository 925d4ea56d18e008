"""Files, places and texts that broke an early version, each as a sample of its kind, by way of the command line."""

from __future__ import annotations

import csv
import json
import os
import resource
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
import yaml

import zerorev as zr
from oracles.made_map import made_map
from zerorev.cli import common as cli
from zerorev.cli import main
from zerorev.files.io import read_plan

HOLE = {"id": "h1", "target_mm": [500, 300, 800], "direction": [1, 0, 0], "depth_mm": 20}
JOB = {"robot": "kuka_kr6_r700_2", "tool": "thesis_drill", "min_rate_deg_per_mm": 0, "proof_boxes": 0, "holes": [HOLE]}
ESCAPE, OVERRIDE = "\x1b]0;renamed\x07\x1b[2J\x1b[1;1H all is well", "\u202eadelpp\u2066"
PIPED = "is not a regular file"


@pytest.fixture(scope="module")
def sound(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a job and its plan."""
    folder = tmp_path_factory.mktemp("sound")
    (folder / "job.yaml").write_text(yaml.safe_dump(JOB))
    assert main(["plan", str(folder / "job.yaml"), "-o", str(folder / "plan.json"), "--json"]) == cli.FINE
    return folder


@pytest.fixture
def folder(sound: Path, tmp_path: Path) -> Path:
    """A copy of it, to be spoilt."""
    for name in ("job.yaml", "plan.json"):
        shutil.copy(sound / name, tmp_path / name)
    return tmp_path


def refused(capsys: pytest.CaptureFixture[str], arguments: list[object], *parts: str) -> str:
    """Run a command: one message on standard error with all of these parts, and exit code 2."""
    assert main([str(argument) for argument in arguments]) == cli.BAD_INPUT
    out, err = capsys.readouterr()
    assert (out, err.count("error: ")) == ("", 1), err
    for part in parts:
        assert part in err
    return err


# --- files ------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("merge.yaml", "<<: {robot: kuka_kr6_r700_2}\ntool: thesis_drill\nholes: []\n"),
        ("key.yaml", '"<x>": 1\nrobot: kuka_kr6_r700_2\n'),
        ("tag.yaml", '"<text>": 1\nrobot: kuka_kr6_r700_2\n'),
    ],
)
def test_a_key_that_nobody_knows(name, text, tmp_path, capsys):
    (tmp_path / name).write_text(text)
    refused(capsys, ["plan", tmp_path / name], "unknown key '<")


def test_a_key_that_nobody_knows_in_a_plan(tmp_path, capsys):
    (tmp_path / "key.json").write_text('{"format":"zerorev.plan/1","<x>":1}')
    refused(capsys, ["check", tmp_path / "key.json"], "unknown key '<x>'")


@pytest.mark.parametrize(
    ("key", "value", "said"),
    [
        ("psi_bound_deg", 1e300, "3600 is the most"),
        ("psi_bound_deg", 1e5, "3600 is the most"),
        ("max_twist_deg_per_mm", 1e9, "10000 is the most"),
        ("min_rate_deg_per_mm", 1e9, "10000 is the most"),
        ("lead_in_mm", 1e300, "1e+06 is the most"),
        ("blend_mm", 1e300, "1e+06 is the most"),
        ("near_joints_deg", [0, 0, 0, 0, 0, 1e300], "36000 is the most"),
        ("part_frame", {"xyz_mm": [0, 0, -1e300]}, "-1e+06 is the least"),
        ("part_frame", {"rpy_deg": [1e300, 0, 0]}, "36000 is the most"),
        ("holes", [HOLE | {"depth_mm": 1e300}], "1e+06 is the most"),
        ("holes", [HOLE | {"target_mm": [1e300, 0, 0]}], "1e+06 is the most"),
        ("holes", [HOLE | {"psi_deg": [0, 1e300, 0]}], "36000 is the most"),
        ("holes", [HOLE | {"psi_deg": [0.0] * 20_000}], "10000 is the most"),
        ("holes", [{}] * 50_000, "holes[0]"),
        ("tool", {"tcp_mm": [1e300, 0, 0], "rpy_deg": [0, 0, 0]}, "1e+06 is the most"),
    ],
)
@pytest.mark.parametrize("command", ["plan", "depth"])
def test_a_number_beyond_all_arms(command, key, value, said, tmp_path, capsys):
    (tmp_path / "job.yaml").write_text(json.dumps(JOB | {key: value}))
    refused(capsys, [command, tmp_path / "job.yaml"], said)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("[" * 100_000, "nested too deep"),
        ("a: " + "{a: " * 100_000, "nested too deep"),
        ("holes: [" + "1, " * 600_000 + "]", "more than 500,000 values"),
        ("{" + ", ".join(f"k{n}: 1" for n in range(5_000)) + "}", "more than 1,000 keys"),
        ("a: &x [[1]]\nb: *x\n", "aliases"),
        ("--- {}\n--- {}\n", "a second document"),
    ],
)
def test_yaml_that_is_too_much(text, said, tmp_path, capsys):
    (tmp_path / "job.yaml").write_text(text)
    refused(capsys, ["plan", tmp_path / "job.yaml"], said)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("[" * 100_000, "nested too deep"),
        ('{"a": [' + "1," * 4_000_000 + "1]}", "more than 4,000,000 values"),
        ("{" + ",".join(f'"k{n}":1' for n in range(5_000)) + "}", "a mapping of 5,000 keys"),
        ('{"a":1,' * 2 + '"b":1}}', "JSON"),
        ('{"format":"zerorev.plan/1","format":"zerorev.plan/1"}', "used twice"),
    ],
)
def test_json_that_is_too_much(text, said, tmp_path, capsys):
    (tmp_path / "plan.json").write_text(text)
    refused(capsys, ["check", tmp_path / "plan.json"], said)


@pytest.mark.skipif(sys.platform != "linux", reason="/proc")
def test_a_plan_of_a_hundred_thousand_empty_holes(folder):
    """Refused soon, in less than 300 MB: of a long list no more is examined than up to the first bad entry."""
    plan = json.loads((folder / "plan.json").read_text())
    (folder / "plan.json").write_text(json.dumps(plan | {"holes": [{}] * 100_000}))
    code = (
        "import re, sys\nfrom pathlib import Path\nfrom zerorev.cli import main\ncode = main(['check', 'plan.json'])\n"
        "print(re.search(r'VmHWM:\\s*(\\d+)', Path('/proc/self/status').read_text())[1])\nsys.exit(code)"
    )
    done = subprocess.run([sys.executable, "-c", code], cwd=folder, capture_output=True, text=True, check=False)
    assert done.returncode == cli.BAD_INPUT
    assert "holes[0]" in done.stderr
    assert len(done.stderr) < 2_000
    assert int(done.stdout) < 300 * 1024


# --- places that are not files ----------------------------------------------------------------------------------------

READERS = [
    ["plan", "{}"],
    ["depth", "{}"],
    ["rates", "{}"],
    ["offset", "{}"],
    ["methods", "{}"],
    ["place", "{}", "--x-mm=-1:1"],
    ["share", "job.yaml", "{}"],
    ["compare", "{}", "plan.json"],
    ["compare", "job.yaml", "{}"],
    ["check", "{}"],
    ["check", "{}", "--report", "r.html"],
    ["check", "plan.json", "--certify", "--program", "{}"],
    ["export", "{}"],
    ["replay", "{}", "-o", "r.html"],
    ["replay", "plan.json", "-o", "r.html", "--urdf", "{}"],
    ["view", "{}", "--no-browser"],
    ["view", "plan.json", "--no-browser", "--urdf", "{}"],
    ["map", "{}", "-o", "m.zarr"],
    ["map", "--around", "{}", "-o", "m.zarr"],
    ["parameter-map", "{}", "-o", "m.zarr"],
]


@pytest.mark.skipif(sys.platform == "win32", reason="pipes and devices")
@pytest.mark.parametrize("arguments", READERS, ids=" ".join)
@pytest.mark.parametrize("what", ["pipe", "/dev/zero", "folder"])
def test_what_is_not_a_file_is_not_read(arguments, what, folder, capsys, monkeypatch):
    monkeypatch.chdir(folder)
    place = what
    if what == "pipe":
        os.mkfifo("pipe")
    elif what == "folder":
        os.mkdir("folder")
    said = refused(capsys, [part.format(place) for part in arguments])
    assert PIPED in said or "is a folder" in said or "no folder of zarr" in said


@pytest.mark.skipif(sys.platform == "win32", reason="pipes and devices")
@pytest.mark.parametrize(
    "arguments",
    [
        ["plan", "job.yaml", "-o", "{}"],
        ["export", "plan.json", "-o", "{}"],
        ["replay", "plan.json", "-o", "{}"],
        ["map", "map.yaml", "-o", "{}"],
    ],
    ids=" ".join,
)
@pytest.mark.parametrize("what", ["pipe", "/dev/zero"])
def test_what_is_not_a_file_is_not_written(arguments, what, folder, capsys, monkeypatch):
    monkeypatch.chdir(folder)
    os.mkfifo("pipe")
    targets = {"x_mm": [500], "y_mm": [300], "z_mm": [800]}
    settings = {"robot": JOB["robot"], "tool": JOB["tool"], "targets": targets, "directions": [[1, 0, 0]]}
    Path("map.yaml").write_text(json.dumps(settings))
    refused(capsys, [part.format(what) for part in arguments], "cannot write")


@pytest.mark.skipif(sys.platform == "win32", reason="pipes and devices")
def test_a_part_that_is_a_device_is_not_read(folder, capsys):
    (folder / "new.json.part").symlink_to("/dev/zero")
    refused(capsys, ["plan", folder / "job.yaml", "-o", folder / "new.json"], "it is not a regular file")


# --- text -------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("unseen", [ESCAPE, OVERRIDE, "one\nyes, certified", "\x85\x9b2J", "\u2028x"])
def test_what_a_terminal_would_obey_is_shown(unseen, folder, capsys):
    plan = json.loads((folder / "plan.json").read_text())
    finding = {"level": "info", "kind": "deepest", "message": unseen, "hole": None}
    plan["findings"] = [finding]
    plan["holes"][0]["findings"] = [finding | {"hole": "h1"}]
    (folder / "plan.json").write_text(json.dumps(plan))
    assert main(["check", str(folder / "plan.json")]) in (cli.FINE, cli.FOUND)
    out, err = capsys.readouterr()
    for text in (out, err):
        assert not set(text) & set(unseen) - set("one yes,crtifdalpr2Jx0;m[]1Hw\n"), ascii(text)
    assert not any(line.startswith("yes, certified") for line in out.splitlines())
    main(["check", str(folder / "plan.json"), "--json"])
    out, _ = capsys.readouterr()
    assert out.isascii() or all(character.isprintable() or character == "\n" for character in out)


def test_a_kind_that_there_is_none_of_is_refused_and_shown_as_text(folder, capsys):
    plan = json.loads((folder / "plan.json").read_text())
    plan["findings"] = [{"level": "info", "kind": "\x1b[2Jx\u202e", "message": "m", "hole": None}]
    (folder / "plan.json").write_text(json.dumps(plan))
    said = refused(capsys, ["check", str(folder / "plan.json")])
    assert "\x1b" not in said
    assert "\u202e" not in said
    assert "findings[0].kind" in said


def test_a_name_of_a_file_is_text(tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    said = refused(capsys, ["plan", "\x1b[2Jno\u202e.yaml"])
    assert r"\x1b[2Jno\u202e.yaml" in said


def test_names_in_brackets_are_not_markup(folder, capsys):
    (folder / "job.yaml").write_text(yaml.safe_dump(JOB | {"holes": [HOLE | {"id": "[red]a[/red] :smile:"}]}))
    assert main(["plan", str(folder / "job.yaml")]) == cli.FINE
    assert "[red]a[/red] :smile:" in capsys.readouterr().out


@pytest.mark.long
def test_a_cell_is_not_a_formula(tmp_path, capsys):
    names = ["=cmd|' /C calc'!A0", "+1+1", "@SUM(1)", "-x", "\u202e=1"]
    holes = [HOLE | {"id": name} for name in names]
    (tmp_path / "job.yaml").write_text(json.dumps(JOB | {"holes": holes}))
    command = ["methods", str(tmp_path / "job.yaml"), "--methods", "exact", "--seeds", "1"]
    assert main([*command, "-o", str(tmp_path / "c.csv")]) == cli.FINE
    rows = list(csv.DictReader((tmp_path / "c.csv").read_text(encoding="utf-8").splitlines()))
    assert [row["hole"] for row in rows] == [*(f"'{name}" for name in names[:4]), r"\u202e=1"]


# --- maps -------------------------------------------------------------------------------------------------------------


@pytest.fixture
def map_folder(tmp_path: Path) -> Path:
    robot, tool = zr.read_robot("kuka_kr6_r700_2"), zr.read_tool("thesis_drill")
    axes = ([450.0, 500.0], [300.0], [700.0, 800.0])
    found = made_map(robot, tool, axes, [[1, 0, 0]], lambda x, y, z, d: 20.0, branch=4, psi_deg=(0, 1, 2))
    found.to_zarr(tmp_path / "m.zarr", consolidated=False)
    return tmp_path / "m.zarr"


def described(array: str):
    def change(folder: Path, **changes: object) -> None:
        file = folder / array / "zarr.json"
        file.write_text(json.dumps(json.loads(file.read_text()) | changes))

    return change


DAMAGE = {
    "no direction": lambda folder: shutil.rmtree(folder / "direction_x"),
    "no description": lambda folder: (folder / "direction_x" / "zarr.json").unlink(),
    "no place": lambda folder: shutil.rmtree(folder / "x_mm"),
    "a vast shape": lambda folder: described("deepest_mm")(folder, shape=[10**9, 10**6, 10**3, 1]),
    "a shape of another length": lambda folder: described("deepest_mm")(folder, shape=[3, 1, 2, 1]),
    "a strange codec": lambda folder: described("deepest_mm")(folder, codecs=[{"name": "numcodecs.pickle"}]),
    "objects": lambda folder: described("deepest_mm")(folder, data_type="object"),
    "zarr 2": lambda folder: described("deepest_mm")(folder, zarr_format=2),
    "text": lambda folder: (folder / "deepest_mm" / "zarr.json").write_text("[1]"),
    "a pipe": lambda folder: os.mkfifo(folder / "deepest_mm" / "c" / "9"),
    "no attributes": lambda folder: described(".")(folder, attributes={"format": "zerorev.map/1"}),
    "a robot that is none": lambda folder: described(".")(
        folder, attributes=json.loads((folder / "zarr.json").read_text())["attributes"] | {"robot": {"name": 7}}
    ),
}


@pytest.mark.parametrize("damage", DAMAGE)
@pytest.mark.parametrize("command", [["map", "show"], ["view", "--no-browser"]], ids=" ".join)
def test_a_damaged_map_is_refused(damage, command, map_folder, capsys):
    assert main(["map", "show", str(map_folder)]) == cli.FINE
    capsys.readouterr()
    DAMAGE[damage](map_folder)
    refused(capsys, [*command, map_folder])


# --- outputs ----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("path", ["nodir/../plan.json", "plan.json", "./plan.json", "link.json", "to/plan.json"])
def test_an_output_never_takes_the_place_of_the_input(path, folder, capsys, monkeypatch):
    monkeypatch.chdir(folder)
    os.symlink("plan.json", "link.json")
    os.symlink(".", "to")
    before = Path("plan.json").read_bytes()
    refused(capsys, ["export", "plan.json", "-o", path], "cannot write", "what was there is unchanged")
    assert Path("plan.json").read_bytes() == before


@pytest.mark.parametrize(
    ("there", "said"),
    [
        ("robot: kuka_kr6_r700_2\n", "it holds no answers of zerorev"),
        ("DEF p ( )\nEND\n", "it holds no answers of zerorev"),
        ('{"format": "zerorev.plan/1", "name": "wing", "robot": {}}', "it holds those of the job 'wing'"),
        ('{"format": "zerorev.depth/1",\n  "name": "a \\u202e\\"b"}', r"""the job 'a \u202e"b'"""),
    ],
)
def test_an_output_never_takes_the_place_of_another_jobs(there, said, folder, capsys):
    (folder / "new.json").write_text(there)
    refused(capsys, ["plan", folder / "job.yaml", "-o", folder / "new.json"], said)
    assert (folder / "new.json").read_text() == there
    (folder / "new.json").write_text("")
    assert main(["plan", str(folder / "job.yaml"), "-o", str(folder / "new.json")]) == cli.FINE
    assert main(["plan", str(folder / "job.yaml"), "-o", str(folder / "new.json")]) == cli.FINE


def test_two_outputs_are_two_files(folder, capsys, monkeypatch):
    monkeypatch.chdir(folder)
    refused(capsys, ["offset", "job.yaml", "-o", "a", "--figure", "./a"], "two outputs would be one file")


@pytest.mark.skipif(sys.platform == "win32", reason="limits of processes")
def test_a_full_disk_keeps_what_is_finished(folder):
    """A limit to the size of files, as a full disk is."""
    holes = [HOLE | {"id": f"h{n}", "depth_mm": 5 + n / 10} for n in range(20)]
    (folder / "many.yaml").write_text(json.dumps(JOB | {"holes": holes}))

    def small() -> None:
        resource.setrlimit(resource.RLIMIT_FSIZE, (25_000, 25_000))

    command = [sys.executable, "-m", "zerorev.cli", "plan", "many.yaml", "-o", "many.json"]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False, preexec_fn=small)
    assert done.returncode == cli.BAD_INPUT, done.stderr
    assert "cannot write" in done.stderr
    assert "Traceback" not in done.stderr
    assert not (folder / "many.json").exists()
    kept = len(read_plan(folder / "many.json.part").holes)
    assert 1 <= kept < 20
    again = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    assert again.returncode == cli.FINE
    assert f"resuming after {kept} of 20" in again.stderr
    assert len(read_plan(folder / "many.json").holes) == 20


def test_a_part_that_was_altered_is_planned_again(folder, capsys):
    """A line whose figures were changed, its form not: the checksum at its end tells."""
    holes = [HOLE | {"id": f"h{n}"} for n in range(3)]
    (folder / "few.yaml").write_text(json.dumps(JOB | {"holes": holes}))
    assert main(["plan", str(folder / "few.yaml"), "-o", str(folder / "few.json")]) == cli.FINE
    wanted = (folder / "few.json").read_bytes()

    from zerorev.files.io import read_job
    from zerorev.files.part import Part
    from zerorev.planning import job as jobs

    job = read_job(folder / "few.yaml")
    with Part(folder / "again.json", jobs.unanswered(job, "asked"), job.holes) as part:
        for answer in read_plan(folder / "few.json").holes:
            part.append(answer)
    lines = (folder / "again.json.part").read_bytes().splitlines(keepends=True)
    changed = lines[2].replace(b'"branch": ', b'"branch": 1', 1) if b'"branch": 1' not in lines[2] else lines[2][:-9]
    assert changed != lines[2]
    (folder / "again.json.part").write_bytes(b"".join([*lines[:2], changed, *lines[3:]]))
    capsys.readouterr()
    assert main(["plan", str(folder / "few.yaml"), "-o", str(folder / "again.json")]) == cli.FINE
    assert "resuming after 1 of 3 holes" in capsys.readouterr().err
    assert (folder / "again.json").read_bytes() == wanted
