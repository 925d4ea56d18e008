"""Plans that are refused, plans of which a part is exported, and the names and comments of what is written."""

import json
import os
import re
from dataclasses import replace

import numpy as np
import pytest

from zerorev.cli import main
from zerorev.errors import InputError, NotExportableError
from zerorev.files.io import read_robot, write_plan
from zerorev.model.corner import CONTROLLERS
from zerorev.model.finding import Finding
from zerorev.program.dialects import DIALECTS, read_program
from zerorev.program.export import export
from zerorev.program.krl.names import KRL_NAMES, krl_label
from zerorev.program.krl.write import to_krl
from zerorev.program.names import digest
from zerorev.program.neutral import build_program

PARTS = {
    "not verified": ({"verified": None}, "it was not verified"),
    "infeasible": ({"status": "infeasible", "motion": None, "score": None}, "it has no motion"),
    "an error finding": (
        {"findings": (Finding("error", "limit", "A4 runs too far", "position 2"),)},
        "A4 runs too far",
    ),
}


@pytest.fixture
def failed(published, spoil):
    """Position 2, failed at the check."""
    hole = published(2)
    return spoil(hole, verified=spoil(hole.verified, passed=False, failures=("joint 3 reverses",)))


@pytest.mark.parametrize(("changes", "why"), PARTS.values(), ids=PARTS)
def test_refused_with_the_hole_and_the_reason(changes, why, published, plan_of, spoil):
    plan = plan_of(published(1), spoil(published(2), **changes))
    with pytest.raises(NotExportableError) as refused:
        export(plan)
    assert refused.value.reasons == (f"hole position 2: {why}",)


def test_refused_where_the_check_failed(failed, published, plan_of):
    with pytest.raises(NotExportableError, match="position 2: it did not pass the check: joint 3 reverses"):
        export(plan_of(published(1), failed))


def test_every_refused_hole_is_named(failed, published, plan_of, spoil):
    with pytest.raises(NotExportableError) as refused:
        export(plan_of(published(1), failed, spoil(published(3), verified=None)))
    assert [reason.split(":")[0] for reason in refused.value.reasons] == ["hole position 2", "hole position 3"]


def test_failed_holes_can_be_left_out(failed, published, plan_of, krl):
    exported = export(plan_of(published(1), failed, published(3)), skip_failed=True)
    assert len(krl.read(exported.text).holes()) == 2
    (finding,) = [finding for finding in exported.findings if finding.kind == "skipped"]
    assert (finding.level, finding.hole) == ("warning", "position 2")
    assert "joint 3 reverses" in finding.message
    assert "warning:  hole position 2: left out of the program" in exported.text
    assert exported.holes == 2
    (finding,) = [finding for finding in exported.findings if finding.kind == "incomplete"]
    assert finding.message == "only 2 of 3 holes are in the program; left out: hole position 2"
    assert "warning:  only 2 of 3 holes are in the program" in exported.text


def test_holes_that_the_plan_lacks_are_named_in_the_program(published, plan_of, spoil):
    missing = Finding("warning", "unfinished", "only 1 of 3 holes planned; missing: holes a, b")
    exported = export(spoil(plan_of(published(1)), findings=(missing,)))
    assert missing in exported.findings
    assert "warning:  only 1 of 3 holes planned; missing: holes a, b" in exported.text


def test_nothing_left_is_refused(failed, plan_of):
    with pytest.raises(NotExportableError, match="position 2"):
        export(plan_of(failed), skip_failed=True)


def test_an_error_of_the_whole_plan_is_refused_even_if_failed_holes_are_skipped(published, plan_of, spoil):
    plan = spoil(plan_of(published(1)), findings=(Finding("error", "robot", "the robot file has changed"),))
    with pytest.raises(NotExportableError, match="the plan: the robot file has changed"):
        export(plan, skip_failed=True)


def test_an_error_finding_of_the_plan_about_one_hole_refuses_that_hole(published, plan_of, spoil):
    plan = plan_of(published(1), published(3))
    plan = spoil(plan, findings=(Finding("error", "x", "something about it", "position 3"),))
    with pytest.raises(NotExportableError, match="hole position 3: something about it"):
        export(plan)
    assert ";FOLD Hole 1 of 2: position 1" in export(plan, skip_failed=True).text


def test_what_a_plan_says_of_its_check_is_not_taken_on_trust(published, plan_of, spoil):
    hole = published(1)
    altered = spoil(hole, score=spoil(hole.score, travel=hole.score.travel / 2))
    assert altered.verified.passed
    with pytest.raises(NotExportableError, match=r"did not pass the check: .*travel"):
        export(plan_of(altered))


def test_warnings_do_not_stop_the_export(published, plan_of, spoil):
    hole = spoil(published(1), findings=(Finding("warning", "threshold", "slow", "position 1"),))
    assert export(plan_of(hole)).text


def test_unknown_controller(published, plan_of):
    with pytest.raises(InputError, match=rf"unknown controller 'cobol' \(accepted: {', '.join(DIALECTS)}\)"):
        export(plan_of(published(1)), "cobol")
    assert set(DIALECTS) <= set(CONTROLLERS)


@pytest.mark.parametrize("name", ["abb_irb4600_60_205", "yaskawa_gp8"])
def test_krl_for_another_makers_robot(name, published, plan_of, spoil):
    robot = read_robot(name)
    with pytest.raises(NotExportableError, match=f"{name} is by {robot.manufacturer}.*KUKA"):
        export(plan_of(published(1), robot=robot), "krl")
    program = build_program(plan_of(published(1)))
    with pytest.raises(NotExportableError, match="KUKA"):
        to_krl(spoil(program, robot=spoil(program.robot, manufacturer="")))


def test_the_same_plan_gives_the_same_text(published, plan_of):
    first, second = (export(plan_of(published(1))).text for _ in range(2))
    assert first == second


NAMES = {
    "panel": "panel",
    "Panel 7, left side": "Panel_7_left_side_",
    "7th": "drill_7th_",
    "_x": "x_",
    "": "drill_",
    "穴": "drill_",
    "Türblech": "Turblech_",
    "LIN": "drill_LIN_",
    "drill_LIN": "drill_LIN",
    "cell": "drill_cell_",
    "spl": "drill_spl_",
    "Nul": "drill_Nul_",
    "a" * 24: "a" * 24,
    "a" * 40: "a" * 17 + "_",
    "a_name_with__16___letters": "a_name_with__16_",
}
"""A name that stays is whole here; of one that does not, what is before the digest."""


@pytest.mark.parametrize(("name", "called"), NAMES.items())
def test_program_names(name, called, published, plan_of, krl):
    exported = export(plan_of(published(1), name=name))
    if name == called:
        assert exported.name == called
    else:
        assert re.fullmatch(re.escape(called) + "[a-z2-7]{6}", exported.name)
    assert [file.name for file in exported.files] == [f"{exported.name}.src"]
    assert krl.read(exported.text).name == exported.name


ALIKE = [
    "panel_upper_skin_station_100", "panel_upper_skin_station_200", "a b", "a-b", "a_b", "a__b", "a b ", "7", "drill_7",
    "drill 7", "", "drill", "drill_", "_", "穴", "孔", "?", "ä", "a", "ö", "o", "LIN", "drill_LIN", "con", "drill_con",
    "lpt1", "x" * 24, "x" * 25, "x" * 26, "x" * 17 + "_", "a_name_with_23_letters__", "a_name_with_23_letters__and_so",
]  # fmt: skip


def test_no_two_names_become_one():
    """Not to a controller either, nor to Windows: they do not tell capitals from small letters."""
    made = [KRL_NAMES.of(name) for name in ALIKE]
    assert len({name.lower() for name in made}) == len(ALIKE)
    assert [KRL_NAMES.of(name) for name in made] == made
    for name in made:
        assert re.fullmatch("[A-Za-z][A-Za-z0-9_]{0,23}", name)


@pytest.mark.parametrize(
    "words",
    [
        "SPL SLIN_REL SPTP_REL SCIRC_REL BRAKE_F ASYPTP STOP STEP SEC MOD DIV WITH DELAY PATH ONSTART C_DIS C_SPL SIN",
        "COS ATAN2 ABS SQRT FORWARD INVERSE VARSTATE STRTOINT ERR_RAISE LOAD FDAT LDAT PDAT MSGLIB USER_GRP NEW_SERV",
        "BAS SPS IR_STOPM CELL P00 CON PRN AUX NUL COM1 LPT9 PTP LIN",
    ],
)
def test_words_that_a_controller_or_windows_keeps_for_itself(words):
    for name in (*words.split(), *words.lower().split(), *words.title().split()):
        assert KRL_NAMES.of(name).startswith(f"drill_{name}_")


@pytest.mark.parametrize("number", [1, 9, 10, 999])
def test_the_parts_of_a_program_are_called_as_the_program(number):
    for name in ("panel", "x" * 22, "x" * 24):
        called = KRL_NAMES.part(name, number)
        assert len(called) <= 24
        assert called.endswith(f"_{number}")
    assert KRL_NAMES.part("panel", 12) == "panel_12"
    assert KRL_NAMES.part("x" * 23 + "y", number) != KRL_NAMES.part("x" * 24, number)


def test_a_given_name(published, plan_of, krl):
    assert krl.read(export(plan_of(published(1)), name="left_wing").text).name == "left_wing"
    assert krl.read(export(plan_of(published(1)), name="left wing").text).name.startswith("left_wing_")


IDS = ["A1\nPTP {A1 0}", "Bohrung Ø4 °", "x;%{PE}%R ;ENDFOLD", "tab\there\r\n\x00", "é" * 200, "ENDFOLD\u2028END"]


@pytest.mark.parametrize("hole_id", IDS)
def test_no_id_gets_out_of_its_comment(hole_id, published, plan_of, krl, spoil):
    """The reader knows every statement that may stand in a program, and takes nothing but ASCII."""
    plain = export(plan_of(published(3)), version="1")
    hole = published(3)
    odd = export(plan_of(spoil(hole, hole=spoil(hole.hole, id=hole_id)), name="test"), version="1")
    assert krl.read(odd.text).statements == krl.read(plain.text).statements
    for line in odd.text.splitlines():
        assert len(line) <= 120
        assert "%{" not in line


FAR = "WING-LH/UPPER-SKIN/RIB-07/STRINGER-12/ROW-03/FASTENER-POSITION-0001"
ALIKE_IDS = [
    "穴",
    "孔",
    "?",
    "é",
    "e",
    "a  b",
    "a b",
    "a%b",
    "a percentb",
    "{1}",
    "(1)",
    "x" * 80,
    "x" * 81,
    FAR,
    FAR[:-1] + "2",
]


def test_no_two_ids_become_one_in_a_comment():
    made = [krl_label(hole_id) for hole_id in ALIKE_IDS]
    assert len(set(made)) == len(ALIKE_IDS)
    for called in made:
        assert re.fullmatch("[ -~]{1,60}", called)
    assert krl_label(FAR) == "WING-LH/UPPER-SKIN/RIB-...-03/FASTENER-POSITION-0001 ~" + digest(FAR)
    assert krl_label("R0C3") == "R0C3"


def test_holes_are_called_the_same_wherever_the_program_names_them(published, plan_of, krl, spoil):
    """By their number in the plan and one name for each, though comments are ASCII and of 100 characters."""
    ids = ("穴", "孔", FAR, FAR[:-1] + "2")
    holes = [spoil(published(3), hole=spoil(published(3).hole, id=hole_id)) for hole_id in ids]
    holes[0], holes[2] = spoil(holes[0], verified=None), spoil(holes[2], verified=None)
    exported = export(plan_of(*holes), skip_failed=True)
    program = krl.read(exported.text)
    assert [fold for fold in program.folds if fold.startswith("Hole")] == [
        f"Hole 2 of 4: {krl_label(ids[1])}", f"Hole 4 of 4: {krl_label(ids[3])}"
    ]  # fmt: skip
    head = " ".join(" ".join(program.comments).split())
    assert f"left out: holes {krl_label(ids[0])}, {krl_label(ids[2])}" in head
    for left_out in (ids[0], ids[2]):
        assert f"hole {krl_label(left_out)}: left out of the program: it was not verified" in head


def long_ids(tmp_path, plan_of, published, spoil):
    """A plan of two holes whose ids differ behind the 60th character, the first without a motion; and its program."""
    last = spoil(published(3), hole=spoil(published(3).hole, id=FAR[:-1] + "2"))
    first = spoil(last, hole=spoil(last.hole, id=FAR), status="infeasible", motion=None, score=None, verified=None)
    plan = tmp_path / "long.json"
    write_plan(plan_of(first, last), plan)
    return plan


def test_the_hole_that_is_left_out_is_known_from_the_one_that_is_drilled(tmp_path, plan_of, published, spoil, capsys):
    plan, program = long_ids(tmp_path, plan_of, published, spoil), tmp_path / "long.src"
    assert main(["export", str(plan), "--skip-failed", "-o", str(program)]) == 0
    text = program.read_text()
    assert f";FOLD Hole 2 of 2: {krl_label(FAR[:-1] + '2')}" in text
    capsys.readouterr()
    main(["check", str(plan), "--certify", "--program", str(program), "--json"])
    proofs = json.loads(capsys.readouterr().out)["holes"]
    assert proofs[0]["certificate"] is None
    assert proofs[1]["certificate"]["verdict"] == "certified"


def exported_beside(plan, name=None):
    return main(["export", str(plan), *(("-o", str(name)) if name else ())])


def test_no_export_replaces_the_program_of_another_plan(tmp_path, plan_of, published, capsys):
    """Nor where the two names differ in capitals alone, which neither a controller nor Windows would notice."""
    first, second = tmp_path / "first.json", tmp_path / "second.json"
    write_plan(plan_of(published(1), name="panel"), first)
    write_plan(plan_of(published(3), name="Panel"), second)
    assert exported_beside(first) == 0
    program = tmp_path / "panel.src"
    kept = program.read_bytes()
    assert b"; Plan file " in kept
    capsys.readouterr()
    assert exported_beside(second) == 2
    said = capsys.readouterr().err
    assert "panel.src" in said
    assert "not known to be a program of this plan; -o FILE names another" in " ".join(said.split())
    assert program.read_bytes() == kept
    assert not (tmp_path / "Panel.src").exists() or os.path.samefile(tmp_path / "Panel.src", program)

    write_plan(plan_of(published(1), published(3), name="panel"), first)  # planned again, in the same file
    assert exported_beside(first) == 0
    assert program.read_bytes() != kept
    assert exported_beside(second, program) == 0
    assert exported_beside(first) == 2


def test_a_file_of_somebody_else_is_not_replaced(tmp_path, plan_of, published):
    plan = tmp_path / "plan.json"
    write_plan(plan_of(published(1), name="panel"), plan)
    (tmp_path / "PANEL.SRC").write_bytes(b"DEF PANEL ( )\r\nEND\r\n\xff")
    assert exported_beside(plan) == 2
    assert [path.name for path in sorted(tmp_path.iterdir())] == ["PANEL.SRC", "plan.json"]


def test_what_is_not_a_file_is_not_opened(tmp_path, plan_of, published):
    plan = tmp_path / "plan.json"
    write_plan(plan_of(published(1), name="panel"), plan)
    os.mkfifo(tmp_path / "panel.src")
    assert exported_beside(plan) == 2
    os.remove(tmp_path / "panel.src")
    (tmp_path / "panel.src").mkdir()
    assert exported_beside(plan) == 2


def test_long_names_that_end_otherwise_are_two_programs(tmp_path, plan_of, published):
    for station in (100, 200):
        plan = tmp_path / f"{station}.json"
        write_plan(plan_of(published(1), name=f"panel_upper_skin_station_{station}"), plan)
        assert exported_beside(plan) == 0
    assert len(list(tmp_path.glob("panel_upper_skin_*.src"))) == 2


def test_the_head_says_what_an_operator_needs(published, plan_of, krl):
    plan = plan_of(published(1), published(3), name="wing", spindle_rpm=3000.0, feed_plunge=4e-3)
    head = " ".join(krl.read(export(plan, version="1.2.3").text).comments)
    for fact in (
        "zerorev 1.2.3",
        "wing",
        "KUKA KR 6 R700-2 (kuka_kr6_r700_2)",
        "thesis_drill",
        "plunge 4 mm/s, retract 20 mm/s",
        "3000 rev/min",
        "0 joint reversals in all",
        "turns back 0.5 mm short",
        "T1 first",
        "checked against the surface of the part alone",
        "$LOAD",
        "$ROBROOT",
        "pull the drill out",
    ):
        assert fact in head


def test_by_default_the_version_is_the_installed_one(published, plan_of):
    from importlib.metadata import version

    assert f"zerorev {version('zerorev')}" in export(plan_of(published(1))).text


def test_never_a_relative_move(published, plan_of, krl):
    text = export(plan_of(published(1), published(2), published(3))).text
    assert "_REL" not in text.upper()
    assert np.all([move.kind in ("PTP", "LIN") for move in krl.read(text).moves])


def test_on_two_processes_the_program_is_the_same_and_progress_is_reported_hole_by_hole(failed, published, plan_of):
    reported = []
    plan = plan_of(published(1), failed, published(3))
    alone = export(plan, skip_failed=True, progress=lambda *so_far: reported.append(so_far))
    assert reported == [(0, 3), (1, 3), (2, 3), (3, 3)]
    assert export(plan, skip_failed=True, workers=2) == alone


def test_a_program_of_several_files(published, plan_of, monkeypatch, tmp_path):
    """In a language that wants a file for the data beside the one that is started."""

    def texts(program, name, findings, version):
        return {name: "begin\n", f"{name}_data": "points\n"}

    monkeypatch.setitem(DIALECTS, "krl", replace(DIALECTS["krl"], suffix=".main", texts=texts, weighs_digits=True))
    plan = tmp_path / "plan.json"
    write_plan(plan_of(published(1)), plan)
    assert main(["export", str(plan), "-o", str(tmp_path / "out.main")]) == 0
    written = {path.name: path.read_text() for path in tmp_path.iterdir() if path != plan}
    assert written == {"out.main": "begin\n", "out_data.main": "points\n"}


@pytest.mark.parametrize("name", ["program.txt", "program"])
def test_a_file_that_ends_like_no_program(name, tmp_path):
    (tmp_path / name).write_text("DEF a ( )")
    with pytest.raises(InputError, match=r"ending of no program.*\.src \(krl, KUKA\)"):
        read_program(tmp_path / name)
