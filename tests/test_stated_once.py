"""A made-up setting, figure of an answer and criterion, added to a copy of the package by a declaration (and formulas).

The copy has to know them wherever they are known: in the schemas, when files are read and written, on
the command line, in the app and in the tables of the documentation.
"""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import zerorev

ROOT = Path(__file__).parents[1]
PACKAGE = Path(zerorev.__file__).parent
OLD_PLAN = ROOT / "tests" / "data" / "program" / "fuzz.json"

SETTING = """
    grit: Annotated[
        float | None,
        Number(
            means="size of the grit", none="no grit", unit=MM, least=0, most=9, note="Made up", group=RUN,
            label="grit",
        ),
    ] = 0.25e-3
"""
FIGURE = """
    wobble: Annotated[float, Figure("made up", DEG, null=math.nan, added=True)] = 0.5
"""
OF_A_HOLE = """
    room: Annotated[float | None, Figure("made up, too", MM, null=None, none="unknown", added=True)] = None
"""
CRITERION = """
    reach: Annotated[
        V,
        Criterion(
            "greatest angle of joint 2", DEG, weighs="the reach", label="reach", scale=3.0, cost="made up", added=True
        ),
    ]
"""


@pytest.fixture
def edited(tmp_path):
    """Runs a script with a copy of the package in which pieces of text stand before others; returns what it prints."""
    copy = tmp_path / "zerorev"
    shutil.copytree(PACKAGE, copy, ignore=shutil.ignore_patterns("__pycache__", "kernels"))
    (copy / "kernels").symlink_to(PACKAGE / "kernels")

    def run(edits: list[tuple[str, str, str]], script: str) -> dict:
        for file, before, piece in edits:
            text = (copy / file).read_text()
            assert text.count(before) == 1
            (copy / file).write_text(text.replace(before, piece.rstrip(" ") + before))
        done = subprocess.run(
            [sys.executable, "-c", script, str(OLD_PLAN)], capture_output=True, text=True, cwd=tmp_path, check=False,
            env={**os.environ, "PYTHONPATH": os.pathsep.join([str(tmp_path), str(ROOT)]), "COLUMNS": "200"},
        )  # fmt: skip
        assert done.returncode == 0, done.stderr
        return json.loads(done.stdout.splitlines()[-1])

    return run


COMMON = """
import io, json, sys
from contextlib import redirect_stdout
import numpy as np
import zerorev as zr
from zerorev.files import io as files
from tools import tables
from zerorev.files.schema import JobFile
from zerorev.files.plan_schema import PlanFile
from nicegui import ui
from zerorev.model.stated import scaled, stated
from zerorev.web.views import settings_form
from zerorev.web.views.fields import Fields

JOB = {"robot": "kuka_kr6_r700_2", "tool": "thesis_drill", "min_rate_deg_per_mm": 0, "proof_boxes": 0, "holes": [
    {"id": 1, "target_mm": [500, 300, 800], "direction": [1, 0, 0], "depth_mm": 50,
     "psi_deg": [14.16, -5.94, -30.46], "branch": 4}]}
old = zr.read_plan(sys.argv[1])
fields = Fields()
for legend in dict.fromkeys(each.group for each in stated(zr.Settings)):
    settings_form._part(fields, legend, [each for each in stated(zr.Settings) if each.group == legend])
labels = {path: field.props.get("label") for path, field in fields.items()}
"""

ASK_SETTING = (
    COMMON
    + """
from zerorev.cli import main
asked = files.job_from_dict(JOB | {"grit_mm": 0.5})
said = io.StringIO()
with redirect_stdout(said):
    main(["plan", "--help"])
json.dump(JOB, open("job.yaml", "w"))
replaced = io.StringIO()
with redirect_stdout(replaced):
    main(["plan", "job.yaml", "--json", "--grit-mm", "0.75"])
refused = []
for bad in (lambda: zr.Settings(grit=-1.0), lambda: files.job_from_dict(JOB | {"grit_mm": 10})):
    try:
        bad()
    except zr.InputError as error:
        refused.append(str(error))
form, _ = settings_form.settings_of({("grit_mm",): ""}, asked)
print(json.dumps({
    "schema": JobFile.model_json_schema()["properties"]["grit_mm"],
    "plan schema": "grit_mm" in PlanFile.model_json_schema()["$defs"]["SettingsForm"]["properties"],
    "read": asked.settings.grit, "older plan": old.settings.grit,
    "written": files.plan_to_json(old)["settings"]["grit_mm"],
    "job": files.job_from_dict(JOB).settings.grit,
    "help": "".join(line for line in said.getvalue().splitlines() if "--grit-mm" in line),
    "replaced": json.loads(replaced.getvalue())["settings"]["grit_mm"],
    "form": labels[("grit_mm",)], "emptied": form.grit,
    "table": tables.settings_table(), "doc": zr.Settings.__doc__,
    "doubled": scaled(asked.settings, 2.0).grit, "refused": refused,
}))
"""
)


def test_a_setting_is_one_declaration(edited):
    found = edited([("model/settings.py", "\n    def __post_init__(self)", SETTING)], ASK_SETTING)
    assert found["schema"]["description"] == "a number, 0 or more [mm]: size of the grit; or null: no grit"
    assert found["schema"]["default"] == 0.25
    assert found["plan schema"]
    assert found["read"] == pytest.approx(0.5e-3)
    assert found["job"] == found["older plan"] == pytest.approx(0.25e-3)
    assert found["written"] == 0.25
    assert "A number, 0 or more [mm]: size of the grit" in found["help"]
    assert found["replaced"] == 0.75
    assert found["form"] == "grit [mm]"
    assert found["emptied"] is None
    assert (
        "| `grit_mm` | 0.25 | a number, 0 or more [mm]: size of the grit; or null: no grit. Made up |" in found["table"]
    )
    assert "grit: size of the grit [m]; None: no grit." in found["doc"]
    assert found["doubled"] == pytest.approx(1e-3)
    python, file = found["refused"]
    assert python == "grit: out of range (accepted: 0 or more, or none: no grit)"
    assert "grit_mm: 10 is too large: 9 is the most (accepted: a number, 0 or more [mm]: size of the grit" in file


ASK_FIGURE = """
import json, sys
from dataclasses import replace
import zerorev as zr
from zerorev.files import io as files
from zerorev.files.plan_schema import PlanFile

old = zr.read_plan(sys.argv[1])
first = old.holes[0]
new = replace(first, verified=replace(first.verified, wobble=0.25), room=3e-3)
new = replace(old, holes=(new, *old.holes[1:]))
zr.write_plan(new, "new.json")
print(json.dumps({
    "schema": PlanFile.model_json_schema()["$defs"]["VerifiedForm"]["properties"]["wobble_deg"],
    "needed": PlanFile.model_json_schema()["$defs"]["VerifiedForm"]["required"],
    "older plan": str(first.verified.wobble), "doc": zr.model.plan.Verification.__doc__,
    "written": files.plan_to_json(new)["holes"][0]["verified"]["wobble_deg"],
    "again": zr.read_plan("new.json").holes[0].verified.wobble,
    "hole": PlanFile.model_json_schema()["$defs"]["PlanHole"]["properties"]["room_mm"]["description"],
    "older hole": first.room, "hole again": zr.read_plan("new.json").holes[0].room,
    "hole written": files.plan_to_json(new)["holes"][0]["room_mm"],
}))
"""


def test_a_figure_of_an_answer_is_one_declaration(edited):
    edits = [("model/plan.py", "    subject: str | None", FIGURE), ("model/plan.py", "    optimality: Opt", OF_A_HOLE)]
    found = edited(edits, ASK_FIGURE)
    assert found["schema"]["description"] == "a number [deg]: made up"
    assert "wobble_deg" not in found["needed"]
    assert found["older plan"] == "nan"
    assert "wobble: made up [rad]." in found["doc"]
    assert found["written"] == pytest.approx(np.rad2deg(0.25))
    assert found["again"] == pytest.approx(0.25)
    assert found["hole"] == "a number [mm]: made up, too; or null: unknown"
    assert found["older hole"] is None
    assert found["hole written"] == 3.0
    assert found["hole again"] == pytest.approx(3e-3)


ASK_CRITERION = (
    COMMON
    + """
from zerorev.files.plan_fields import HOLE_FIELDS
from zerorev.verify.figures import figures
from zerorev.motion.drilling import Drilling
from zerorev.search.weighted import search_weighted

asked = files.job_from_dict(JOB | {"objective": {"reach": 1, "travel": 0.25}})
plan = zr.plan_job(asked)
answer = plan.holes[0]
joints = zr.evaluate(asked.robot, asked.tool, asked.holes[0], answer.motion.profile, 4).motion.joints
stated_figure = files.plan_to_json(plan)["holes"][0]["criteria"]["reach_deg"]
hole = zr.Hole("free", answer.hole.target, answer.hole.direction, 0.02, answer.hole.psi_zero)
best = search_weighted(Drilling(asked.robot, asked.tool, hole), asked.settings)
print(json.dumps({
    "schema": JobFile.model_json_schema()["$defs"]["WeightsForm"]["properties"]["reach"]["description"],
    "plan schema": PlanFile.model_json_schema()["$defs"]["CriteriaForm"]["properties"]["reach_deg"],
    "read": dict(asked.settings.weights), "older plan": old.holes[0].measures and old.holes[0].measures.reach,
    "stated": stated_figure, "found": float(np.rad2deg(np.abs(joints[:, 1]).max())),
    "checked": zr.check_plan(plan).wrong, "optional": HOLE_FIELDS["criteria.reach_deg"].optional,
    "best": best is not None, "form": labels[("objective", "reach")], "table": tables.criteria_table(),
}))
"""
)


@pytest.mark.long
def test_a_criterion_is_one_declaration_and_its_two_formulas(edited):
    edits = [
        ("model/measures.py", "\n\nMeasures.__doc__", CRITERION),
        (
            "motion/criteria.py",
            '    "manipulability": lambda',
            '    "reach": lambda poses: np.abs(poses.joints[..., 1]),\n',
        ),
        (
            "verify/figures.py",
            "        manipulability=float(manip",
            "        reach=float(np.abs(joints[:, 1]).max()),\n",
        ),
    ]
    found = edited(edits, ASK_CRITERION)
    assert found["schema"] == "a number, 0 or more: weight of the reach"
    assert found["plan schema"]["description"] == "a number [deg]: greatest angle of joint 2"
    assert found["plan schema"]["default"] is None
    assert found["read"] == {"travel": 0.25, "reach": 1.0}
    assert np.isnan(found["older plan"])
    assert found["stated"] >= found["found"] - 1e-9
    assert found["stated"] == pytest.approx(found["found"], abs=0.1)
    assert list(found["checked"]) == []
    assert found["optional"]
    assert found["best"]
    assert found["form"] == "reach"
    assert "| `reach` | made up | `reach_deg` |" in found["table"]
