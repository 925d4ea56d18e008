"""What fits a program to its controller: numbers, load, the place of the base, outer axes, calls, header."""

import json
import re
from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from zerorev.cli import main
from zerorev.errors import InputError, NotExportableError
from zerorev.files.io import job_from_dict, plan_from_text, plan_to_json, read_plan, write_plan
from zerorev.files.job_data import job_files
from zerorev.files.text import json_text
from zerorev.model.controller import Call, Calls, ExternalAxis
from zerorev.model.dynamics import Load
from zerorev.model.job import Job, Settings
from zerorev.program.as_exported import as_exported
from zerorev.program.export import export
from zerorev.program.krl.dialect import KRL
from zerorev.program.krl.read import read_krl
from zerorev.verify.certificate.program import certify_program

CALLS = Calls(
    before_job=(Call.parse("CLAMP(TRUE)"),),
    before_hole=(Call.parse('SPINDLE_ON(6000, #FAST, "a  b", -2.5)'), Call.parse("COUNT")),
    after_hole=(Call.parse("SPINDLE_OFF"),),
    after_job=(Call.parse("CLAMP(FALSE)"),),
)
ROOT = (0.1, -0.2, 0.4, float(np.pi), 0.3, -1.1)
ALL = {
    "tool_number": 3, "base_number": 7, "robroot": "$ROBROOT_C", "external_axes": (ExternalAxis("E2", -90.0),
    ExternalAxis("E1", 1500.0)), "calls": CALLS, "header": ("&PARAM EDITMASK = *", "&REL 12"),
}  # fmt: skip


def proven(plan, text):
    """The certificates of a program's holes, after it and the plan were read from files."""
    in_file, program = plan_from_text(json_text(plan_to_json(plan)), "plan.json"), read_krl(text)
    drilled = as_exported(in_file, program, KRL)
    return [hole.certificate for hole in certify_program(in_file, program, drilled).holes]


def test_everything_at_once_is_written_read_back_and_certified(published, plan_of, krl):
    plan = plan_of(published(1), published(3), **ALL)
    text = export(plan).text
    program = krl.read(text)
    assert program.header == [
        "&ACCESS RVP",
        "&REL 12",
        "&COMMENT drilling without joint reversals",
        "&PARAM EDITMASK = *",
    ]
    one, three = program.holes()
    before, after = [(1, 'SPINDLE_ON(6000,#FAST,"a  b",-2.5)'), (1, "COUNT( )")], "SPINDLE_OFF( )"
    assert program.calls == [
        (0, "CLAMP(TRUE)"), *before, (len(one), after),
        *((len(one) + at, call) for at, call in before), (len(one) + len(three), after),
        (len(one) + len(three), "CLAMP(FALSE)"),
    ]  # fmt: skip
    for hole in (one, three):
        assert (hole[0].values["E1"], hole[0].values["E2"]) == (1500.0, -90.0)
        assert hole[0].state["$ACT_TOOL"] == 3
        assert hole[0].state["$ACT_BASE"] == 7
    assert "$BASE=$ROBROOT_C:{FRAME: X 0.0000" in text
    assert [(certificate.verdict, certificate.reasons) for certificate in proven(plan, text)] == 2 * [("certified", ())]


@pytest.mark.parametrize("home", [None, (0.0, -1.5, 1.5, 0.0, 0.5, 0.0)])
@pytest.mark.parametrize("part", ["before_job", "before_hole", "after_hole", "after_job"])
def test_a_call_that_the_plan_does_not_have_is_refuted(part, home, published, plan_of):
    planned = plan_of(published(1), published(3), calls=CALLS, home_joints=home)
    text = export(planned).text
    for changed in (replace(CALLS, **{part: ()}), replace(CALLS, **{part: (Call("OTHER"), *getattr(CALLS, part))})):
        verdicts = [
            each.verdict for each in proven(replace(planned, settings=replace(planned.settings, calls=changed)), text)
        ]
        assert "refuted" in verdicts
    for line in ("SPINDLE_OFF( )\n", "WAIT SEC 0.0\n", "CLAMP(TRUE)\n", "CLAMP(FALSE)\n"):
        assert "refuted" in [each.verdict for each in proven(planned, text.replace(line, "", 1))]
    assert "refuted" in [each.verdict for each in proven(planned, text.replace('"a  b"', '"a b"', 1))]
    assert "refuted" in [each.verdict for each in proven(planned, text.replace("(6000,#", "(6001,#", 1))]
    assert {each.verdict for each in proven(planned, text)} == {"certified"}


BAD_CALLS = [
    "A(B)", "A(1+1)", "A($OV_PRO)", "A(B(1))", "A()B()", "A(1);B", "$OUT[1]=TRUE", "A(1", "A 1", "PTP {A1 0}", "A(1,)",
    "", "1A", "A(,1)", 'A("a;b")', 'A("ä")', 'A("a"b")', "A\nB", "A(1)\nHALT", "A(1e5)", "A('H1')", "A(1.)",
    "A(- 1)",
    "B" * 25, "A[1]", "A.B", "A:B", "#A", "A(#A.B)",
]  # fmt: skip


@pytest.mark.parametrize("text", BAD_CALLS)
def test_no_expression_gets_into_a_call(text):
    with pytest.raises(InputError, match="call"):
        Call.parse(text)


@pytest.mark.parametrize(
    "text", ["A", "A()", "A( )", "A (1,-2.50 , TRUE,false)", 'A("")', 'A("x, y) {%")', "A(#ON)", "a_1"]
)
def test_calls_that_are_read(text):
    call = Call.parse(text)
    assert Call.parse(str(call)) == call


@pytest.mark.parametrize("name", ["HALT", "ptp", "Exit", "SIN", "RETURN", "test", "TEST"])
def test_a_call_that_would_be_something_else(name, published, plan_of):
    with pytest.raises(NotExportableError, match=name):
        export(plan_of(published(1), calls=Calls(after_hole=(Call(name),))))


def test_what_is_called_is_said_not_to_be_examined(published, plan_of):
    exported = export(plan_of(published(1), calls=CALLS))
    (said,) = [finding.message for finding in exported.findings if finding.kind == "calls"]
    assert said.startswith('calls CLAMP(TRUE) before the job; SPINDLE_ON(6000, #FAST, "a  b", -2.5), COUNT before each')
    assert said.endswith("; CLAMP(FALSE) after the job: what these programs do is not examined")
    assert not [finding for finding in export(plan_of(published(1))).findings if finding.kind == "calls"]


# --- the place of the robot -------------------------------------------------------------------------------------------


def test_a_robot_that_stands_elsewhere_in_the_world(published, plan_of, krl):
    """A LIN of the file leads through $BASE to where the robot, in the world, has its tool."""
    T = np.eye(4)
    T[:3, :3], T[:3, 3] = Rotation.from_euler("ZYX", (25, -40, 15), degrees=True).as_matrix(), (0.3, 0.2, 0.1)
    root = np.eye(4)
    root[:3, :3], root[:3, 3] = Rotation.from_euler("xyz", ROOT[3:]).as_matrix(), np.array(ROOT[:3]) * 1e3
    plan = plan_of(published(1), T_base_part=T, robroot=ROOT)
    text = export(plan).text
    for move, own in zip(
        krl.read(text).moves[1:], krl.read(export(plan_of(published(1), T_base_part=T)).text).moves[1:], strict=True
    ):
        np.testing.assert_allclose(move.T_base_tool, root @ own.T_base_tool, rtol=0, atol=2e-4)
    assert [certificate.reasons for certificate in proven(plan, text)] == [()]
    moved = replace(plan, settings=replace(plan.settings, robroot=(*ROOT[:2], ROOT[2] + 2e-6, *ROOT[3:])))
    (certificate,) = proven(moved, text)
    assert certificate.verdict == "refuted"
    wrong = replace(plan, settings=replace(plan.settings, robroot=None))
    assert proven(wrong, text)[0].verdict == "refuted"


@pytest.mark.parametrize("variable", ["$ROBROOT", "$ROBROOT_C", "MY_ROOT"])
def test_a_variable_that_says_where_the_robot_stands(variable, published, plan_of, krl):
    plan = plan_of(published(1), robroot=variable)
    text = export(plan).text
    assert f"\n$BASE={variable}:{{FRAME: " in text
    assert f"is what {variable} holds" in " ".join(" ".join(krl.read(text).comments).split())
    assert [each.verdict for each in proven(plan, text)] == ["certified"]
    assert proven(plan, text.replace(f"{variable}:", "$WORLD:"))[0].verdict == "refuted"
    assert proven(plan, text.replace(f"{variable}:", ""))[0].verdict == "refuted"


@pytest.mark.parametrize("name", ["$A B", "$", "A.B", "$ROBROOT:X", "A+B", "1A", ""])
def test_no_expression_gets_into_the_base(name):
    with pytest.raises(InputError, match="robroot"):
        Settings(robroot=name)


# --- tool and load ----------------------------------------------------------------------------------------------------


def load_of(text):
    """Mass, centre [mm], axes and moments of a program's $LOAD."""
    numbers = re.search(r"^\$LOAD=\{LOAD: M (.*),CM \{(.*)\},J \{(.*)\}\}$", text, re.MULTILINE)
    centre, inertia = (dict(part.split() for part in numbers[n].split(",")) for n in (2, 3))
    values = [float(centre[name]) for name in "XYZABC"]
    return (
        float(numbers[1]),
        values[:3],
        Rotation.from_euler("ZYX", values[3:], degrees=True),
        [float(inertia[n]) for n in "XYZ"],
    )


@pytest.mark.parametrize("turn", [(0, 0, 0), (20, -30, 70), (90, 0, 0)])
def test_the_load_is_that_of_the_tool(turn, published, plan_of, drill):
    """Mass, centre and inertia of the file, put together again, are those of the tool."""
    R = Rotation.from_euler("xyz", turn, degrees=True).as_matrix()
    inertia = R @ np.diag([0.02, 0.03, 0.045]) @ R.T
    tool = replace(drill, load=Load(7.25, np.array([0.01, -0.02, 0.13]), inertia))
    text = export(plan_of(published(1), tool=tool, tool_number=3)).text
    mass, centre, axes, moments = load_of(text)
    assert mass == 7.25
    np.testing.assert_allclose(centre, [10, -20, 130], rtol=0, atol=1e-4)
    np.testing.assert_allclose(axes.as_matrix() @ np.diag(moments) @ axes.as_matrix().T, inertia, rtol=0, atol=2e-6)
    assert "payload ($LOAD)" not in text


def test_without_a_mass_the_load_is_the_controllers_own(published, plan_of, drill):
    text = export(plan_of(published(1), tool=replace(drill, load=None), tool_number=16)).text
    assert "\n$ACT_TOOL=16\n$LOAD=LOAD_DATA[16]\n" in text
    assert read_krl(text)


def test_without_a_number_nothing_is_set(published, plan_of):
    text = export(plan_of(published(1))).text
    assert "\n$ACT_" not in text
    assert "\n$LOAD" not in text


# --- files ------------------------------------------------------------------------------------------------------------

JOB = {
    "robot": "kuka_kr6_r700_2", "tool": "thesis_drill", "name": "block", "tool_number": 3, "base_number": 7,
    "robroot": {"x": 100, "y": -200, "z": 400, "a": 10, "b": 20, "c": 180},
    "external_axes": [{"name": "E1", "at": 1500}], "header": ["&PARAM TEMPLATE = x"],
    "calls": {"before_hole": ["SPINDLE_ON(6000)"], "after_job": ["COUNT"]},
    "holes": [{"id": "a", "target_mm": [500, 300, 800], "direction": [1, 0, 0], "depth_mm": 12}],
}  # fmt: skip


def test_a_job_says_it_and_a_plan_file_keeps_it(published, plan_of, tmp_path):
    job = job_from_dict(JOB)
    assert job.settings.calls.before_hole == (Call("SPINDLE_ON", ("6000",)),)
    np.testing.assert_allclose(job.settings.robroot, [0.1, -0.2, 0.4, np.pi, *np.deg2rad([20, 10])])
    plan = replace(plan_of(published(1)), settings=job.settings)
    write_plan(plan, tmp_path / "plan.json")
    again = read_plan(tmp_path / "plan.json")
    assert again.settings == job.settings
    assert export(again, version="1").text == export(plan, version="1").text
    (tmp_path / "again.yaml").write_text(*job_files(job).values())
    import zerorev as zr

    assert zr.read_job(tmp_path / "again.yaml").settings == job.settings


def test_a_plan_file_of_before_sets_none_of_it(published, plan_of, tmp_path):
    data = plan_to_json(plan_of(published(1)))
    for key in ("tool_number", "base_number", "robroot", "external_axes", "calls", "header"):
        del data["settings"][key]
    assert plan_from_text(json_text(data), "old.json").settings == Settings()


BAD_JOBS = {
    "tool_number": [0, 17, 1.5, "3"], "base_number": [0, 33], "robroot": ["$A B", 3, {"x": 1, "q": 2}],
    "external_axes": [[{"name": "E7", "at": 1}], [{"name": "E1", "at": 1}, {"name": "E1", "at": 2}], [{"name": "E1"}]],
    "calls": [{"before": []}, {"before_hole": "A"}, {"before_hole": ["A(B)"]}],
    "header": ["&REL 1", ["REL 1"], ["& x"], ["&A\nB"]],
}  # fmt: skip


@pytest.mark.parametrize(("key", "value"), [(key, value) for key, values in BAD_JOBS.items() for value in values])
def test_what_no_program_can_have_is_refused_where_the_job_is_read(key, value):
    with pytest.raises(InputError, match=key):
        job_from_dict(JOB | {key: value})


def test_the_certificate_reports_the_calls(published, plan_of, tmp_path, capsys):
    plan, program = tmp_path / "plan.json", tmp_path / "test.src"
    write_plan(plan_of(published(1), calls=CALLS), plan)
    assert main(["export", str(plan), "-o", str(program)]) == 0
    capsys.readouterr()
    main(["check", str(plan), "--certify", "--program", str(program)])  # the plan's own figures are made up
    said = " ".join(capsys.readouterr().out.split())
    assert "calls CLAMP(TRUE) before the job; SPINDLE_ON(6000, " in said
    assert "these programs do is not examined" in said
    main(["check", str(plan), "--certify", "--program", str(program), "--json"])
    assert len(json.loads(capsys.readouterr().out)["not_examined"]) == 1


def test_the_app_keeps_what_it_has_no_field_for():
    from zerorev.web.views.settings_form import settings_of

    job = job_from_dict(JOB)
    settings, wrong = settings_of({("blend_mm",): 2.0}, job)
    assert not wrong
    assert settings == replace(job.settings, blend=2e-3)
    assert isinstance(job, Job)


def test_a_program_may_ask_the_controller_where_the_robot_stands(published, plan_of):
    """Where the job does not say it: the frame is one of the robot's own base, so this is right for every mounting."""
    plan = plan_of(published(1), published(2))
    text = export(plan).text
    asking = text.replace("$BASE={FRAME", "$BASE=$ROBROOT:{FRAME")
    assert asking != text
    for other, verdict in (
        (asking, "certified"),
        (asking.replace("$ROBROOT", "$WORLD"), "refuted"),
        (asking.replace("$ADVANCE=3", "$ADVANCE=2"), "refuted"),
    ):
        program = read_krl(other)
        found = certify_program(plan, program, as_exported(plan, program, KRL))
        assert {hole.certificate.verdict for hole in found.holes} == {verdict}
    here = plan_of(published(1), robroot=ROOT)
    program = read_krl(export(here).text.replace("$BASE={FRAME", "$BASE=$ROBROOT:{FRAME"))
    (hole,) = certify_program(here, program, as_exported(here, program, KRL)).holes
    assert hole.certificate.verdict == "refuted"
