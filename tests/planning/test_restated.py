"""What a plan file states is computed again: every number and word in it is edited, and every edit is refused.

An input may be edited where no answer depends on it; then planning again from the edited file gives the answers that
stand in it, and the field is named in `MAY_CHANGE`.
"""

from __future__ import annotations

import json
import pickle
from collections.abc import Iterator
from copy import deepcopy
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from zerorev.cli import common as cli
from zerorev.cli import main
from zerorev.errors import InputError
from zerorev.files.io import job_from_dict, plan_from_text, plan_to_json
from zerorev.files.plan_differences import leaves
from zerorev.files.plan_fields import HEAD_FIELDS, HOLE_FIELDS, field_of
from zerorev.model.job import Job
from zerorev.planning import restated
from zerorev.planning.job import plan_job
from zerorev.planning.restated import check_plan


def hole(name, target_mm, depth_mm, **others):
    return {"id": name, "target_mm": target_mm, "direction": [1, 0, 0], "depth_mm": depth_mm} | others


FIRST, SECOND = hole("first", [500, 300, 800], 50), hole("second", [200, 400, 600], 20)
STIFF = {"joint_stiffness_nm_per_rad": [1e5, 2e5, 1e5, 5e4, 3e4, 2e4]}
JOBS: dict[str, dict[str, Any]] = {
    "straight": {"holes": [FIRST], **STIFF},
    "threshold": {"holes": [SECOND], "min_rate_deg_per_mm": 0.2, "near_joints_deg": [0, -90, 90, 0, 0, 180]},
    "reversing": {"holes": [FIRST], "psi_bound_deg": 12, "min_rate_rule": "mean"},
    # joints turn round within the legs, at an inner breakpoint and at the target
    "given": {
        "holes": [FIRST | {"standoff_mm": [50, 20, 0, 30, 50], "psi_deg": [10, 14, 5, 9, 2], "branch": 4}],
        "min_rate_deg_per_mm": 0,
    },
    "weights": {"holes": [FIRST], "objective": {"travel": 1, "limit_distance": 0.5}},
    "infeasible": {"holes": [hole("far", [5000, 300, 800], 50)]},
    "unbased": {
        "holes": [hole("edge", [650, 130, 850], 60, psi_deg=[-70, -34, -44], branch=0)],
        "min_rate_deg_per_mm": 0,
    },
    "deepened": {"holes": [SECOND | {"branch": 0}], "deepen_corner": True, "blend_mm": 2},
    "depth": {"holes": [SECOND]},
    "free": {"holes": [SECOND], "legs": "free"},
}

MAY_CHANGE = {
    # names, and the frame in which a program is written: holes stand in the base frame
    "name", "robot.name", "robot.manufacturer", "robot.model", "tool.name", "id",
    "part_frame.xyz_mm", "part_frame.rpy_deg",
    # what only a program depends on
    "settings.lead_in_mm", "settings.feed_mm_s.retract", "settings.spindle_rpm", "settings.blend_shortfall_mm",
    # a blend that makes no joint reverse, bounds and margins that do not bind, a wish that changes no turn and no
    # choice, a lead-in that is kept as it is
    "settings.keep_lead_in",
    "settings.blend_mm", "settings.psi_bound_deg", "settings.near_joints_deg", "settings.max_twist_deg_per_mm",
    "settings.limit_margin_deg",
    "settings.reversal_weights", "settings.min_rate_rule", "settings.min_rate_deg_per_mm", "settings.deepen_corner",
    "settings.feed_mm_s.plunge", "settings.objective", "settings.objective.travel", "settings.objective.limit_distance",
    "settings.joint_stiffness_nm_per_rad", "settings.legs",
    # of a plan of one hole, which has no moves between holes
    "settings.clearance_mm", "settings.safe_height_mm", "settings.part_thickness_mm", "settings.posture_freedom",
    # of a hole in one go, without a countersink, a feed of the last of the way in, or joint moves at the corner
    "settings.cycle.depth_mm", "settings.cycle.back_mm", "settings.countersink.diameter_mm",
    "settings.countersink.angle_deg", "settings.breakthrough.last_mm", "settings.corner_tolerance_mm",
    # a budget that the proof ends within
    "settings.proof_boxes",
    # of a hole that is out of reach
    "direction", "depth_mm", "psi_zero",
}  # fmt: skip

NOT_SHOWN = {"verified.max_position_error_mm", "verified.max_rotation_error_deg"}
"""Below what the check allows they are rounding, and no figure: of 1e-12 mm 1 % is not compared."""


def file_of(name: str) -> dict[str, Any]:
    job = job_from_dict({"robot": "kuka_kr6_r700_2", "tool": "thesis_drill", "name": name} | JOBS[name])
    return plan_to_json(plan_job(job, strokes="deepest" if name == "depth" else "asked"))


@pytest.fixture(scope="module")
def files():
    made: dict[str, dict[str, Any]] = {}

    def make(name: str) -> dict[str, Any]:
        made.setdefault(name, file_of(name))
        return deepcopy(made[name])

    return make


@pytest.fixture
def remembered(monkeypatch):
    """What an edit of a figure does not change is computed once."""

    def once(name, bare=lambda args: args):
        function, known = getattr(restated, name), {}

        def call(*args):
            args = bare(args)
            key = pickle.dumps(args)
            if key not in known:
                found = function(*args)
                known[key] = list(found) if isinstance(found, Iterator) else found
            return known[key]

        monkeypatch.setattr(restated, name, call)

    def without_figures(args):
        *others, stated = args
        bare = replace(stated, score=None, baseline=None, verified=None, measures=None, critical_rates=None)
        return (*others, replace(bare, deepest=None, wrist_offset=0.0, findings=(), certificate=None))

    for name in ("plan", "plan_deepest", "verify_hole"):
        once(name)
    for name in ("figures", "moved_figures"):
        once(name, without_figures)


def refusals(data: dict[str, Any]) -> list[str]:
    """Why a file is refused; nothing where it is not."""
    try:
        plan = plan_from_text(json.dumps(data), "plan")
    except InputError as error:
        return [str(error)]
    checked = check_plan(plan)
    marked = checked.marked()
    errors = any(finding.level == "error" for finding in marked.all_findings)
    failed = any(not hole.verified.passed for hole in marked.holes if hole.verified)
    assert errors or failed or not checked.wrong
    failures = [failure for hole in checked.plan.holes if hole.verified for failure in hole.verified.failures]
    return [finding.message for finding in checked.wrong] + failures


def edits(value: Any) -> list[Any]:
    if isinstance(value, bool):
        return [not value]
    if isinstance(value, int):
        return [value + 1, value - 1]
    if isinstance(value, float):
        return [value + 1.0] + ([value * 1.01, -value] if value else [])
    others = {"planned": "evaluated", "evaluated": "planned", "infeasible": "planned", "warning": "info",
              "error": "warning", "plunge": "retract", "retract": "target", "target": "plunge", "pointwise": "mean",
              "mean": "pointwise", "straight": "free", "free": "straight", "travel": "margin"}  # fmt: skip
    return [] if value is None else [others.get(value, value + "x")]


def edited(data: dict[str, Any], path: str, value: Any) -> dict[str, Any]:
    data = deepcopy(data)
    *steps, last = path.replace("[", ".[").split(".")
    where: Any = data
    for step in steps:
        where = where[int(step[1:-1])] if step.startswith("[") else where[step]
    where[int(last[1:-1]) if last.startswith("[") else last] = value
    return data


def within(path: str) -> tuple[str, dict[str, Any]]:
    """The path within a hole or the head, and the fields that it is one of."""
    for start in ("holes[0].plan.", "holes[0]."):
        if path.startswith(start):
            return path.removeprefix(start), HOLE_FIELDS
    return path, HEAD_FIELDS


def same_when_planned_again(data: dict[str, Any]) -> bool:
    """Whether planning from the inputs of a file gives the answers that stand in it; of deepest motions, the depth."""
    plan = plan_from_text(json.dumps(data), "plan")
    job = Job(
        plan.robot, plan.tool, tuple(each.hole for each in plan.holes), plan.settings, plan.T_base_part, plan.name
    )
    again = dict(leaves(plan_to_json(plan_job(job, strokes=plan.strokes))))
    stated = dict(leaves(plan_to_json(plan)))
    if again.keys() != stated.keys() and plan.strokes == "asked":
        return False
    for path, value in stated.items():
        if plan.strokes == "deepest" and not path.endswith(("deepest_mm", "status")):
            continue
        if isinstance(value, float) and isinstance(again[path], float):
            if not np.isclose(value, again[path], rtol=1e-5, atol=1e-7):
                return False
        elif value != again[path]:
            return False
    return True


def assert_refused(data: dict[str, Any], path: str, value: Any) -> str:
    """One edit is refused, naming the field; or it is of an input on which no answer depends. Says which."""
    changed = edited(data, path, value)
    said, (inner, fields) = refusals(changed), within(path)
    field = field_of(inner, fields)
    if said:
        plain = inner.split("[")[0]
        named = field.how in ("input", "motion") or any(plain in line or "contradicts" in line for line in said)
        assert named, f"{path} = {value}: {said}"
        return "refused"
    name = ".".join(part.split("[")[0] for part in inner.split("."))
    # a joint that moves by less than `nil` does not move
    small = (name in NOT_SHOWN and abs(value) < field.absolute) or (isinstance(value, float) and abs(value) < field.nil)
    assert small or (field.how == "input" and name in MAY_CHANGE), f"{path} = {value} passes as {field.how}"
    assert small or same_when_planned_again(changed), f"{path} = {value} passes, and answers depend on it"
    return "harmless"


def all_edits(data: dict[str, Any]) -> list[tuple[str, Any]]:
    return [(path, value) for path, old in leaves(data) for value in edits(old) if value != old]


@pytest.mark.parametrize("name", ["straight", "given", "depth"])
def test_a_sample_of_edits_is_refused(files, remembered, name):
    data = files(name)
    assert refusals(data) == []
    changes = all_edits(data)
    assert len(changes) > 250
    # of figures and inputs alike; the whole is done in the test marked long
    some = np.random.default_rng(7).choice(len(changes), 36, replace=False)
    outcomes = [assert_refused(data, *changes[i]) for i in sorted(some)]
    assert outcomes.count("refused") > 28


@pytest.mark.long
@pytest.mark.parametrize("name", JOBS)
def test_every_edit_is_refused(files, remembered, record_property, name):
    data = files(name)
    assert refusals(data) == []
    changes = all_edits(data)
    dear = [n for n, (path, _) in enumerate(changes) if field_of(*within(path)).how in ("input", "motion")]
    rng = np.random.default_rng(15)
    spare = max(0, len(dear) - {"weights": 4, "free": 12, "reversing": 12}.get(name, 30))
    left_out = set(rng.choice(dear, spare, replace=False).tolist())
    outcomes = [assert_refused(data, *change) for n, change in enumerate(changes) if n not in left_out]
    text = (
        f"{name}: of {len(outcomes)} edits {outcomes.count('refused')} refused, {outcomes.count('harmless')} harmless"
    )
    record_property("measured", text)


# --- what is taken out, or put in -------------------------------------------------------------------------------------


def one_line(data: dict[str, Any], *words: str) -> None:
    said = refusals(data)
    assert len(said) == 1, said
    assert all(word in said[0] for word in words), said


def test_a_warning_that_is_removed_is_missed(files):
    data = files("threshold")
    findings = data["holes"][0]["findings"]
    assert findings[0]["kind"] == "threshold"
    del findings[0]
    one_line(data, "findings: stated none, found warning threshold")


def test_a_finding_that_nothing_gives_rise_to(files):
    data = files("straight")
    strange = {"level": "info", "kind": "blend", "message": "all is well", "hole": "first"}
    data["holes"][0]["findings"].insert(0, strange)
    one_line(data, "findings[0]: stated info blend", "found none")


def test_a_finding_of_the_whole_plan(files):
    data = files("straight")
    assert [finding["kind"] for finding in data["findings"]] == ["tool_turn"]
    data["findings"].append({"level": "warning", "kind": "wrist_offset", "message": "e = 0", "hole": None})
    one_line(data, "findings[1]: stated warning wrist_offset", "found none")


def test_a_baseline_that_cannot_be_run(files):
    data = files("unbased")
    assert data["holes"][0]["baseline"] is None
    data["holes"][0]["baseline"] = {"reversals": 6, "reversals_per_joint": [1] * 6, "travel_deg": 50.0}
    one_line(data, "baseline: stated", "found null")


def test_a_baseline_that_is_left_out(files):
    data = files("straight")
    data["holes"][0]["baseline"] = None
    one_line(data, "baseline: stated null, found", "reversals")


def test_a_hole_that_is_drilled_is_not_infeasible(files):
    data = files("straight")
    data["holes"][0] |= dict.fromkeys(
        ("branch", "standoff_mm", "psi_deg", "joints_deg", "reversals", "reversals_per_joint", "events", "travel_deg",
         "min_rate_deg_per_mm", "mean_rate_deg_per_mm", "limit_distance_deg", "critical_rates_deg_per_mm",
         "twist_spread_deg_per_mm", "baseline", "verified", "criteria")
    )  # fmt: skip
    data["holes"][0] |= {"status": "infeasible", "strokes": None}
    said = refusals(data)
    assert 'status: stated "infeasible", found "planned"' in said
    assert any("reversals: stated null, found 0" in line for line in said)


def test_a_better_motion_is_not_passed_over(files):
    """A given motion that is painted as one that was searched for: it passes every check but that."""
    data = files("given")
    data["holes"][0] |= {"given": None, "status": "planned"}
    count = data["holes"][0]["reversals"]
    assert f"reversals, weighted: stated {count}, found 0 by searching again" in refusals(data)


def test_what_is_left_null_claims_nothing(files):
    data = files("straight")
    for name in ("deepest_mm", "critical_rates_deg_per_mm", "twist_spread_deg_per_mm", "criteria", "verified"):
        data["holes"][0][name] = None
    assert refusals(data) == []


def test_turns_other_than_those_asked_for(files):
    data = files("straight")
    (hole,) = data["holes"]
    for joints in (*hole["joints_deg"]["breakpoints"], *(hole["joints_deg"][k] for k in ("start", "target", "end"))):
        joints[5] += -360 if joints[5] > 0 else 360
    hole["strokes"] = None
    assert any(line.startswith("joints_deg.start[5]: stated") for line in refusals(data))


def test_every_wrong_field_has_one_message(files):
    data = files("straight")
    data["holes"][0]["travel_deg"] += 1
    data["holes"][0]["deepest_mm"] = 99.0
    said = refusals(data)
    assert sorted(line.split(":")[0] for line in said) == ["deepest_mm", "travel_deg"]
    assert next(line for line in said if "deepest" in line).startswith("deepest_mm: stated 99, found 90.8")


# --- the command ------------------------------------------------------------------------------------------------------


@pytest.fixture
def edited_file(files, tmp_path):
    data = files("straight")
    data["holes"][0]["baseline"]["travel_deg"] += 0.5
    path = tmp_path / "plan.json"
    path.write_text(json.dumps(data))
    return path


def another_baseline(data):
    stated = data["holes"][0]["baseline"]["travel_deg"]
    return f"baseline.travel_deg: stated {stated:.6g}, found {stated - 0.5:.6g}"


def test_the_command_says_it_and_ends_with_1(edited_file, capsys):
    assert main(["check", str(edited_file)]) == cli.FOUND
    out = capsys.readouterr().out
    line = next(line for line in out.splitlines() if line.startswith("error"))
    assert f"verification hole first: {another_baseline(json.loads(edited_file.read_text()))}" in " ".join(line.split())
    assert "FAILED" in out


def test_what_was_certified_is_not_shown_until_it_is_proven_again(edited_file, files, capsys):
    pytest.importorskip("flint")
    data = files("straight")
    edited_file.write_text(json.dumps(data))
    assert main(["check", "--certify", str(edited_file)]) == cli.FINE
    assert "yes, certified" in capsys.readouterr().out
    assert main(["check", str(edited_file)]) == cli.FINE
    assert "yes, certified" not in capsys.readouterr().out


def test_what_is_said_of_placements_is_not_shown_either(edited_file, files, capsys):
    pytest.importorskip("flint")
    edited_file.write_text(json.dumps(files("straight")))
    within = ["--tolerance-mm", "0.01", "--tolerance-deg", "0.001"]
    assert main(["check", "--certify", *within, str(edited_file)]) == cli.FINE
    assert json.loads(edited_file.read_text())["holes"][0]["certified_within"]["mm"] == 0.01
    capsys.readouterr()
    assert main(["check", str(edited_file), "--json"]) == cli.FINE
    (hole,) = json.loads(capsys.readouterr().out)["holes"]
    assert hole["certified_within"] is None
    assert "tolerance" not in {finding["kind"] for finding in hole["findings"]}


def test_a_file_that_is_marked_and_mended(edited_file, files, capsys):
    """The certificate is written into a wrong file, too, with what is wrong; none of that stays once it is mended."""
    pytest.importorskip("flint")
    expected = another_baseline(json.loads(edited_file.read_text()))
    assert main(["check", "--certify", str(edited_file)]) == cli.FOUND
    data = json.loads(edited_file.read_text())
    assert data["holes"][0]["verified"]["passed"] is False
    assert data["holes"][0]["verified"]["failures"] == [expected]
    assert main(["check", str(edited_file)]) == cli.FOUND
    data["holes"][0]["baseline"] = files("straight")["holes"][0]["baseline"]
    edited_file.write_text(json.dumps(data))
    assert main(["check", "--certify", str(edited_file)]) == cli.FOUND
    assert "verified.passed: stated false, found true" in capsys.readouterr().out
    assert main(["check", str(edited_file)]) == cli.FINE


def test_a_warning_that_an_older_version_did_not_know_is_not_missed(files):
    """A file with none of that kind may be older; one that states it has to state it rightly."""
    data = files("straight")
    plan = plan_from_text(json.dumps(data), "plan")
    near = [finding for finding in plan.all_findings if finding.kind in ("near_limit", "tool_turn")]
    assert near, "a plan that shows nothing"
    without = json.loads(json.dumps(data))
    for place in (without, *without["holes"]):
        place["findings"] = [each for each in place["findings"] if each["kind"] not in ("near_limit", "tool_turn")]
    assert refusals(without) == []
    for place in (data, *data["holes"]):
        for each in place["findings"]:
            if each["kind"] in ("near_limit", "tool_turn"):
                each["message"] += " or so"
    assert refusals(data)
