"""Holes that are drilled in several strokes, the drill pulled out between them."""

import json
from dataclasses import replace

import numpy as np
import pytest

from oracles.makers import POSITIONS
from zerorev.errors import InputError
from zerorev.files.io import plan_from_text, plan_to_json, read_robot, read_tool
from zerorev.model.corner import CONTROLLERS
from zerorev.model.cycle import Cycle
from zerorev.model.dynamics import Load
from zerorev.model.hole import Hole
from zerorev.model.job import Job, Settings
from zerorev.model.strokes import by_stroke, ids_of_strokes, together
from zerorev.motion.drilling import Drilling
from zerorev.motion.joint_path import joints_along
from zerorev.planning.job import plan_job
from zerorev.planning.restated import check_plan
from zerorev.program.as_exported import as_exported
from zerorev.program.dialects import DIALECTS
from zerorev.program.export import export, retract_program
from zerorev.search.pecks import pecking
from zerorev.verify.certificate.certify import certify_plan
from zerorev.verify.certificate.program import certify_program
from zerorev.verify.check import verify_plan


def job(number, strokes=5, **settings):
    target, depth = POSITIONS[number]
    hole = Hole("a", np.array(target) * 1e-3, np.array([1.0, 0, 0]), depth * 1e-3)
    cycle = Cycle("peck", depth * 1e-3 / strokes)
    chosen = Settings(**({"proof_boxes": 0, "cycle": cycle} | settings))
    return Job(read_robot("kuka_kr6_r700_2"), read_tool("thesis_drill"), (hole,), chosen, name="pecks")


@pytest.fixture(scope="module")
def plans():
    return {number: plan_job(job(number)) for number in POSITIONS}


def sampled(plan, answer, count=4_001):
    """Joints along a stroke, by inverse kinematics alone [rad], (n, 6)."""
    profile = answer.motion.profile
    standoff, psi = profile.at(np.linspace(0, profile.distance[-1], count))
    found = joints_along(Drilling(plan.robot, plan.tool, answer.hole), answer.motion.branch, standoff, psi)
    return found + 2 * np.pi * np.round((answer.motion.joints[0] - found[0]) / (2 * np.pi))


@pytest.mark.parametrize("number", POSITIONS)
def test_each_stroke_goes_deeper_and_no_joint_turns_round_in_it(number, plans):
    plan, (hole,) = plans[number], plans[number].holes
    depth = POSITIONS[number][1] * 1e-3
    assert [stroke.answer.hole.depth for stroke in hole.strokes] == pytest.approx(depth * np.arange(1, 6) / 5)
    for stroke in hole.strokes:
        np.testing.assert_allclose(stroke.answer.hole.entry, hole.hole.entry, atol=1e-12)
        steps = np.diff(sampled(plan, stroke.answer), axis=0)
        assert ((steps > 0).all(axis=0) | (steps < 0).all(axis=0)).all()
        assert stroke.answer.verified.passed
    assert hole.score.reversals == 0


@pytest.mark.parametrize("number", POSITIONS)
def test_reversals_in_the_air_are_those_of_close_samples(number, plans):
    """Strokes, lead-ins and the moves between them, laid out once more: each joint's turns, counted one by one."""
    plan, (hole,) = plans[number], plans[number].holes
    for one, other in zip(hole.strokes, hole.strokes[1:], strict=False):
        first, second = sampled(plan, one.answer), sampled(plan, other.answer)
        profile = other.answer.motion.profile
        standoff = profile.standoff[0] + np.linspace(plan.settings.lead_in, 0, 501)
        psi = profile.psi[0] + profile.twist_rate[0] * (standoff - profile.standoff[0])
        lead = joints_along(Drilling(plan.robot, plan.tool, other.answer.hole), hole.motion.branch, standoff, psi)
        lead += 2 * np.pi * np.round((second[0] - lead[-1]) / (2 * np.pi))
        between = first[-1] + np.linspace(0, 1, 11)[:, None] * (lead[0] - first[-1])
        path = np.concatenate([first[2_500:], between[1:], lead[1:], second[1:1_500]])
        signs = np.sign(np.diff(path, axis=0))
        assert other.reversals_in_air == int((signs[1:] != signs[:-1]).sum())
    assert hole.strokes[0].reversals_in_air == 0


def test_strokes_follow_one_another_and_what_ends_that_is_said(plans):
    """At position 1 five strokes of 10 mm do not fit: 2 do, and the finding names the joint."""
    (hole,) = plans[1].holes
    (said,) = [finding for finding in hole.findings if finding.kind == "peck"]
    assert said.message.startswith("2 of 5 strokes follow one another without a reversal in the air")
    assert any(f"{name} " in said.message for name in plans[1].robot.joint_names)
    assert [stroke.reversals_in_air for stroke in hole.strokes[:2]] == [0, 0]
    assert all(stroke.reversals_in_air > 0 for stroke in hole.strokes[2:])
    psi = np.concatenate([stroke.answer.motion.profile.psi for stroke in hole.strokes[:2]])
    assert (np.diff(psi) > 0).all() or (np.diff(psi) < 0).all()


def test_a_run_of_strokes_that_all_fit_has_no_reversal_anywhere():
    short = job(1)
    hole = replace(short.holes[0], depth=15e-3, cycle=Cycle("peck", 5e-3))
    plan = plan_job(replace(short, holes=(hole,)))
    (answer,) = plan.holes
    assert len(answer.strokes) == 3
    assert [stroke.reversals_in_air for stroke in answer.strokes] == [0, 0, 0]
    assert not [finding for finding in answer.findings if finding.kind == "peck"]


def test_a_single_stroke_is_planned_as_any_hole_is(plans):
    """As deep as the cycle, or shallower."""
    asked = job(1)
    hole = replace(asked.holes[0], depth=8e-3)
    once = plan_job(replace(asked, holes=(hole,)))
    plain = plan_job(replace(asked, holes=(hole,), settings=replace(asked.settings, cycle=Cycle())))
    assert once.holes[0].strokes == ()
    assert once.holes[0].score.travel == plain.holes[0].score.travel


def test_the_last_stroke_may_be_a_short_one():
    assert Cycle("peck", 10e-3).strokes(25e-3) == pytest.approx((10e-3, 20e-3, 25e-3))
    assert Cycle("peck", 10e-3).strokes(30e-3) == pytest.approx((10e-3, 20e-3, 30e-3))
    assert Cycle("peck", 0.1e-3).strokes(0.3e-3) == pytest.approx((0.1e-3, 0.2e-3, 0.3e-3))


def test_the_file_has_the_strokes_and_gives_them_back(plans):
    data = plan_to_json(plans[1])
    hole = data["holes"][0]
    first, last = hole["strokes"][0], hole["strokes"][-1]
    assert first["standoff_mm"] == hole["standoff_mm"] == [50.0, 40.0, 50.0]
    assert first["psi_deg"] == hole["psi_deg"]
    assert first["joints_deg"] == hole["joints_deg"]
    assert last["standoff_mm"] == [50.0, 0.0, 50.0]
    assert [stroke["reversals_in_material"] for stroke in hole["strokes"]] == [0] * 5
    assert first["feeds_mm_s"] == {"plunge": 5.0, "retract": 20.0}
    again = plan_from_text(json.dumps(data), "plan")
    assert plan_to_json(again) == data


def test_a_hole_of_one_stroke_says_so_in_its_file():
    data = plan_to_json(plan_job(job(1, cycle=Cycle())))
    (stroke,) = data["holes"][0]["strokes"]
    assert stroke["answer"] is None
    assert stroke["standoff_mm"] == data["holes"][0]["standoff_mm"]
    data["holes"][0]["strokes"][0]["psi_deg"][1] += 1.0
    again = plan_from_text(json.dumps(data), "plan")
    assert plan_to_json(again) == data  # given back as it was read
    (wrong,) = check_plan(again).wrong
    assert wrong.message.startswith("strokes[0].psi_deg[1]: stated ")


@pytest.mark.parametrize("number", POSITIONS)
def test_the_check_finds_the_same_and_the_certificate_proves_every_stroke(number, plans):
    plan = plan_from_text(json.dumps(plan_to_json(plans[number])), "plan")
    assert check_plan(plan).wrong == ()
    (hole,) = certify_plan(plan).holes
    assert (hole.certificate.verdict, hole.certificate.reasons) == ("certified", ())
    assert len({stroke.answer.certificate.pieces for stroke in hole.strokes}) >= 1
    assert hole.certificate.pieces == sum(stroke.answer.certificate.pieces for stroke in hole.strokes)


def spoiled(data, edit):
    data = json.loads(json.dumps(data))
    edit(data["holes"][0])
    return data


@pytest.mark.parametrize(
    ("edit", "said"),
    [
        (lambda hole: hole["strokes"].pop(2), "answer.id"),
        (lambda hole: hole["strokes"].pop(), "strokes, depth_mm"),
        (lambda hole: hole["strokes"][1].update(reversals_in_air=4), "reversals_in_air"),
        (lambda hole: hole["strokes"][1].update(tool=1), "answer.id"),
        (lambda hole: hole["strokes"][1]["feeds_mm_s"].update(plunge=7.0), "feeds_mm_s"),
        (lambda hole: hole["strokes"][2]["answer"].update(travel_deg=1.0), "travel_deg"),
        (lambda hole: hole["strokes"][2]["answer"]["target_mm"].__setitem__(0, 480.5), "target_mm"),
        (lambda hole: hole["strokes"][2]["answer"]["psi_deg"].__setitem__(1, 1.0), "psi_deg"),
        (lambda hole: hole.update(travel_deg=400.0), "travel_deg"),
        (lambda hole: hole.update(reversals=1, reversals_per_joint=[1, 0, 0, 0, 0, 0]), "reversals"),
        (lambda hole: hole.update(cycle_time_s=1.0), "cycle_time_s"),
        (lambda hole: hole.update(strokes=None), "travel_deg"),
    ],
)
def test_what_was_altered_is_refused_by_name(edit, said, plans):
    data = spoiled(plan_to_json(plans[1]), edit)
    try:
        wrong = [finding.message for finding in check_plan(plan_from_text(json.dumps(data), "plan")).wrong]
    except InputError as error:
        wrong = [str(error)]
    assert any(said in message for message in wrong), wrong


def test_the_plain_check_holds_each_stroke_to_what_it_is(plans):
    """A stroke whose spin is another one does not pass, and the hole does not, either."""
    (hole,) = plans[1].holes
    third = hole.strokes[2]
    motion = third.answer.motion
    turned = replace(motion.profile, psi=motion.profile.psi + np.array([0, 0.3, 0]))
    wrong = replace(third, answer=replace(third.answer, motion=replace(motion, profile=turned)))
    strokes = (*hole.strokes[:2], wrong, *hole.strokes[2:])
    (checked,) = verify_plan(replace(plans[1], holes=(replace(hole, strokes=strokes),))).holes
    assert not checked.verified.passed
    assert all(failure.startswith("stroke 3: ") for failure in checked.verified.failures)


def test_strokes_are_put_together_as_they_were(plans):
    plan = plans[2]
    assert together(plan, by_stroke(plan)) == plan
    assert [hole.hole.id for hole in by_stroke(plan).holes] == [f"a, stroke {n}" for n in range(1, 6)]
    assert ids_of_strokes(plan, ["a"])[-1] == "a, stroke 5"


@pytest.mark.parametrize("name", DIALECTS)
def test_the_program_of_every_language_is_read_back_and_certified(name):
    """On a robot of the thesis' dimensions as if its maker were another one."""
    plan = pecks_for(name)
    files = export(plan, name, version="x").files
    dialect = DIALECTS[name]
    program = dialect.read(files)
    assert len(program.holes) == 3
    strokes = by_stroke(plan)
    (hole,) = together(plan, certify_program(strokes, program, as_exported(strokes, program, dialect))).holes
    assert (hole.certificate.verdict, hole.certificate.reasons) == ("certified", ())


def pecks_for(name):
    robot = replace(read_robot("kuka_kr6_r700_2"), name="stand_in", manufacturer=CONTROLLERS[name].maker)
    if name == "inform":
        robot = replace(robot, pulses_per_deg=(1000.0, -1200.0, 900.0, 1100.0, -1000.0, 800.0))
    numbers = {"tool_number": 3} if name in ("tp", "inform") else {}
    asked = job(1, 3, controller=name, **numbers)
    hole = replace(asked.holes[0], depth=15e-3, cycle=Cycle("peck", 5e-3))
    tool = replace(asked.tool, load=Load(1.5, np.array([0.02, 0, 0.05]), np.zeros((3, 3))))
    return plan_job(replace(asked, robot=robot, tool=tool, holes=(hole,)))


def test_the_drill_is_pulled_out_of_the_last_stroke(plans):
    assert "stroke 5" in retract_program(plans[1], "a", version="x").text
    assert "stroke 2" in retract_program(plans[1], "a, stroke 2", version="x").text


def test_a_hole_out_of_reach_is_infeasible_with_the_reason():
    asked = job(1)
    far = replace(asked.holes[0], target=np.array([2.0, 0, 0.5]))
    (hole,) = plan_job(replace(asked, holes=(far,))).holes
    assert hole.status == "infeasible"
    assert hole.strokes == ()
    assert [finding.kind for finding in hole.findings] == ["unreachable"]


def test_a_single_branch_is_kept_to():
    asked = job(1, 3)
    on_branch = replace(asked.holes[0], branch=0)
    (hole,) = plan_job(replace(asked, holes=(on_branch,))).holes
    assert {stroke.answer.motion.branch for stroke in hole.strokes} == {0}


def test_no_stroke_is_left_that_reverses_where_one_without_is_known():
    """Each stroke alone has a motion without a reversal at these holes; none of a run is worse."""
    for number in POSITIONS:
        asked = job(number)
        found = pecking(Drilling.of(asked, asked.holes[0]), asked.settings, asked.settings.cycle.strokes(
            asked.holes[0].depth
        ))  # fmt: skip
        assert [one.reversals for one in found.strokes] == [0] * 5


@pytest.mark.parametrize(
    ("cycle", "said"),
    [
        ({"kind": "peck"}, "pecks, but not how deep"),
        ({"kind": "peck", "depth": 0.01e-3}, "pecks in 50 mm"),
    ],
)
def test_a_cycle_that_is_none_is_one_clear_error(cycle, said):
    with pytest.raises(InputError, match=said):
        Cycle(**cycle).strokes(50e-3)


def test_the_deepest_stroke_is_that_of_the_stroke_that_goes_all_the_way():
    asked = job(1)
    pecking_, plain = (plan_job(each, strokes="deepest").holes[0] for each in (asked, replace(
        asked, settings=replace(asked.settings, cycle=Cycle())
    )))  # fmt: skip
    assert pecking_.deepest == plain.deepest > 80e-3
    assert pecking_.verified.passed
    assert pecking_.strokes == ()
