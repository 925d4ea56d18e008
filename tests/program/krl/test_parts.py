"""A program of several files: one that is started, and the parts that it calls."""

import json
import re
from dataclasses import replace

import numpy as np
import pytest

import zerorev.program.export as exporting
from zerorev.cli import main
from zerorev.errors import InputError
from zerorev.files.io import write_plan
from zerorev.model.controller import Call, Calls
from zerorev.program.as_exported import as_exported
from zerorev.program.dialects import read_program
from zerorev.program.export import export
from zerorev.program.krl.dialect import KRL
from zerorev.verify.certificate.program import certify_program

CALLS = Calls((Call("CLAMP", ("TRUE",)),), (Call("RUN"),), (Call("REST"),), (Call("CLAMP", ("FALSE",)),))


@pytest.fixture(scope="module")
def five(published, plan_of):
    """Five holes, by twos."""
    holes = [published(number) for number in (1, 3, 1, 2, 3)]
    named = [replace(hole, hole=replace(hole.hole, id=f"h{n}")) for n, hole in enumerate(holes)]
    return plan_of(*named, name="five", calls=CALLS, holes_per_program=2)


def written(exported, folder):
    for file in exported.files:
        (folder / file.name).write_text(file.text)
    return folder / exported.files[0].name


def proven(plan, path):
    program = read_program(path)
    return [
        hole.certificate for hole in certify_program(plan, program, as_exported(plan, program, KRL, path.stem)).holes
    ]


def test_the_parts_together_are_the_whole(five, krl, tmp_path):
    exported = export(five, plan_file="five.json")
    assert [file.name for file in exported.files] == ["five.src", "five_1.src", "five_2.src", "five_3.src"]
    assert exported.holes == 5
    whole = krl.read(export(replace(five, settings=replace(five.settings, holes_per_program=None))).text)
    starts, *parts = (krl.read(file.text) for file in exported.files)
    assert not starts.moves
    assert [call for _, call in starts.calls] == ["CLAMP(TRUE)", "five_1( )", "five_2( )", "five_3( )", "CLAMP(FALSE)"]
    assert [len(part.holes()) for part in parts] == [2, 2, 1]
    moves = [move for part in parts for move in part.moves]
    assert [(move.kind, move.values, move.blended) for move in moves] == [
        (move.kind, move.values, move.blended) for move in whole.moves
    ]
    for move, own in zip(moves, whole.moves, strict=True):
        assert own.state.keys() - move.state.keys() <= ({"$VEL.CP", "$APO.CDIS"} if move.kind == "PTP" else set())
        for name, value in move.state.items():
            assert np.array_equal(value, own.state[name]), name
    assert [fold for part in parts for fold in part.folds if fold.startswith("Hole")] == [
        fold for fold in whole.folds if fold.startswith("Hole")
    ]
    for file in exported.files:
        assert re.search(r"^; Plan file [0-9a-f]{16} five\.json$", file.text, re.MULTILINE)
    certificates = proven(five, written(exported, tmp_path))
    assert [(each.verdict, each.reasons) for each in certificates] == 5 * [("certified", ())]


@pytest.mark.parametrize("most", [1, 2, 4, 5, 6])
def test_any_split_of_a_plan_is_its_program(most, five, tmp_path):
    exported = export(five, holes_per_program=most, name="called_otherwise")
    assert len(exported.files) == (1 if most >= 5 else 1 + -(-5 // most))
    assert {each.verdict for each in proven(five, written(exported, tmp_path))} == {"certified"}


def test_the_way_home_is_in_the_last_part(five, krl, tmp_path):
    home = (0.0, -1.5, 1.5, 0.0, 0.5, 0.0)
    plan = replace(five, settings=replace(five.settings, home_joints=home))
    exported = export(plan)
    ends = [krl.read(file.text).moves[-1].kind for file in exported.files[1:]]
    assert ends == ["LIN", "LIN", "PTP"]
    assert {each.verdict for each in proven(plan, written(exported, tmp_path))} == {"certified"}


def test_holes_that_are_left_out(five, tmp_path):
    spoiled = replace(five, holes=(replace(five.holes[0], verified=None), *five.holes[1:]))
    exported = export(spoiled, skip_failed=True)
    assert len(exported.files) == 3
    first, *others = proven(five, written(exported, tmp_path))
    assert first.verdict == "refuted"
    assert {each.verdict for each in others} == {"certified"}


FAULTS = [
    ("five.src", "five_2( )\n", ""),
    ("five.src", "five_2( )\nfive_3( )\n", "five_3( )\nfive_2( )\n"),
    ("five.src", "five_3( )\n", "five_3( )\nfive_3( )\n"),
    ("five.src", "CLAMP(FALSE)\n", ""),
    ("five.src", "CLAMP(TRUE)\n", "CLAMP(TRUE)\nOTHER( )\n"),
    ("five_2.src", "$ADVANCE=3", "$ADVANCE=1"),
    ("five_2.src", "$VEL.CP=0.020000", "$VEL.CP=0.030000"),
    ("five_3.src", "REST( )\n", ""),
    ("five_3.src", "DEF five_3 ( )", "DEF five_4 ( )"),
    ("five_1.src", "\nEND\n", "\nOTHER( )\nEND\n"),
]


@pytest.mark.parametrize(("name", "old", "new"), FAULTS)
def test_a_fault_in_any_file_is_found_and_named(name, old, new, five, tmp_path):
    path = written(export(five), tmp_path)
    text = (tmp_path / name).read_text()
    assert old in text
    (tmp_path / name).write_text(text.replace(old, new, 1))
    reasons = [reason for each in proven(five, path) for reason in each.reasons]
    assert reasons
    named = name if "CLAMP(FALSE)" not in old else "five_1.src"  # what stands there instead is the next file
    assert any(re.match(rf"{re.escape(named)}(, line \d+)?: ", reason) or "missing" in reason for reason in reasons)


def test_a_part_that_is_not_there(five, tmp_path):
    path = written(export(five), tmp_path)
    (tmp_path / "five_2.src").rename(tmp_path / "FIVE_2.SRC")
    assert {each.verdict for each in proven(five, path)} == {"certified"}
    (tmp_path / "FIVE_2.SRC").unlink()
    with pytest.raises(InputError, match=r"five_2\.src.*no such file"):
        read_program(path)


def test_parts_of_other_frames(five, tmp_path):
    path = written(export(five), tmp_path)
    text = (tmp_path / "five_2.src").read_text()
    (tmp_path / "five_2.src").write_text(text.replace("$BASE={FRAME: X 0.0000", "$BASE={FRAME: X 0.0001", 1))
    with pytest.raises(InputError, match=r"five_2\.src: \$TOOL or \$BASE differs"):
        read_program(path)


def test_the_command_writes_reads_and_does_not_replace_what_is_there(five, tmp_path, capsys):
    plan = tmp_path / "five.json"
    write_plan(replace(five, settings=replace(five.settings, holes_per_program=None)), plan)
    assert main(["export", str(plan), "--holes-per-program", "3"]) == 0
    assert "and its 2 parts beside it" in " ".join(capsys.readouterr().out.split())
    assert sorted(path.name for path in tmp_path.glob("*.src")) == ["five.src", "five_1.src", "five_2.src"]
    main(["check", str(plan), "--certify", "--program", str(tmp_path / "five.src"), "--json"])
    proofs = json.loads(capsys.readouterr().out)
    assert [hole["certificate"]["verdict"] for hole in proofs["holes"]] == 5 * ["certified"]
    (tmp_path / "five_2.src").write_text("DEF five_2 ( )\nEND\n")
    assert main(["export", str(plan), "--holes-per-program", "3"]) == 2
    assert "five_2.src" in capsys.readouterr().err
    assert main(["export", str(plan), "--holes-per-program", "0"]) == 2


def test_large_programs_say_so(five, monkeypatch):
    kinds = lambda exported: [(each.level, each.message) for each in exported.findings if each.kind == "program_size"]  # noqa: E731
    whole = replace(five, settings=replace(five.settings, holes_per_program=None))
    assert not kinds(export(whole))
    monkeypatch.setattr(exporting, "LONG", 60)
    ((level, message),) = kinds(export(whole))
    assert level == "info"
    assert re.match(r"five\.src has \d+ lines; holes_per_program", message)
    monkeypatch.setattr(exporting, "LARGE", 3_000)
    assert kinds(export(whole))[0][0] == "warning"
