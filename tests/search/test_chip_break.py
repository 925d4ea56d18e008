"""Holes in which chips are broken: the drill is drawn back on the way in, and no joint turns round for it."""

import json
from dataclasses import replace

import numpy as np
import pytest

from oracles.makers import POSITIONS
from zerorev.errors import InputError
from zerorev.files.io import plan_from_text, plan_to_json, read_robot, read_tool
from zerorev.model.cycle import Cycle
from zerorev.model.hole import Hole
from zerorev.model.job import Job, Settings
from zerorev.model.profile import Profile
from zerorev.motion.drilling import Drilling
from zerorev.motion.evaluation import evaluated
from zerorev.motion.joint_path import joints_along
from zerorev.planning.hole import plan
from zerorev.planning.job import plan_job
from zerorev.planning.restated import check_plan
from zerorev.program.as_exported import as_exported
from zerorev.program.export import export
from zerorev.program.krl.dialect import KRL
from zerorev.verify.certificate.certify import certify_plan
from zerorev.verify.certificate.program import certify_program

FIVE = Cycle("chip_break", 5e-3, 0.3e-3)


def job(number, **settings):
    target, depth = POSITIONS[number]
    hole = Hole("a", np.array(target) * 1e-3, np.array([1.0, 0, 0]), depth * 1e-3)
    chosen = Settings(**({"proof_boxes": 0, "cycle": FIVE} | settings))
    return Job(read_robot("kuka_kr6_r700_2"), read_tool("thesis_drill"), (hole,), chosen, name="chips")


@pytest.fixture(scope="module")
def plans():
    return {number: plan_job(job(number)) for number in POSITIONS}


@pytest.mark.parametrize("number", POSITIONS)
def test_no_joint_turns_round_at_any_of_the_thesis_positions(number, plans):
    """Ten pecks of 5 mm with 0.3 mm back at position 1."""
    (hole,) = plans[number].holes
    depth = POSITIONS[number][1]
    assert hole.score.reversals == 0
    assert hole.verified.passed
    inwards = [s for k, s in enumerate(hole.motion.profile.standoff) if k in hole.motion.profile.turns]
    wanted = [at for peck in range(depth - 5, 0, -5) for at in (peck, peck + 0.3)] + [0]
    np.testing.assert_allclose(np.array(inwards) * 1e3, wanted, atol=1e-9)


@pytest.mark.parametrize("number", POSITIONS)
def test_every_joint_runs_one_way_on_close_samples(number, plans):
    """By inverse kinematics along the motion, with nothing of the search."""
    plan_, (hole,) = plans[number], plans[number].holes
    profile = hole.motion.profile
    standoff, psi = profile.at(np.linspace(0, profile.distance[-1], 60_001))
    drilling = Drilling(plan_.robot, plan_.tool, hole.hole)
    steps = np.diff(joints_along(drilling, hole.motion.branch, standoff, psi), axis=0)
    # the sample next to a breakpoint spans it; each joint still moves one way
    assert ((steps > 0).all(axis=0) | (steps < 0).all(axis=0)).all()


@pytest.mark.parametrize("number", POSITIONS)
def test_plan_and_program_are_certified(number, plans):
    assert certify_plan(plans[number]).holes[0].certificate.reasons == ()
    program = KRL.read(export(plans[number], version="x").files)
    drilled = as_exported(plans[number], program, KRL)
    (hole,) = certify_program(plans[number], program, drilled).holes
    assert (hole.certificate.verdict, hole.certificate.reasons) == ("certified", ())


def test_the_plain_motion_with_breaks_put_in_would_reverse(plans):
    """The way back on the retract's own slope turns joints round at position 1: it is not enough."""
    plain = plan_job(job(1, cycle=Cycle()))
    (hole,) = plain.holes
    plunge, retract = hole.motion.profile.twist_rate
    psi_t = hole.motion.profile.psi[1]
    standoff, psi = [0.0], [psi_t]
    for at in np.arange(5e-3, 46e-3, 5e-3):
        psi += [psi[-1] + plunge * (at + 0.3e-3 - standoff[-1])]
        psi += [psi[-1] - retract * 0.3e-3]
        standoff += [at + 0.3e-3, at]
    psi.append(psi[-1] + plunge * (50e-3 - standoff[-1]))
    profile = Profile(np.array([50e-3, *standoff[::-1], 50e-3]), np.array([*psi[::-1], hole.motion.profile.psi[2]]))
    drilling = Drilling(plain.robot, plain.tool, hole.hole)
    assert evaluated(drilling, profile, hole.motion.branch).score.reversals > 0


def test_a_plan_file_holds_the_cycle_and_passes_its_check(plans):
    text = json.dumps(plan_to_json(plans[2]))
    again = plan_from_text(text, "plan.json")
    assert again.settings.cycle == FIVE
    checked = check_plan(again)
    assert checked.wrong == ()


def test_a_hole_may_have_a_cycle_of_its_own(plans):
    own = job(2, cycle=Cycle())
    (hole,) = own.holes
    answer = plan(own.robot, own.tool, replace(hole, cycle=Cycle("chip_break", 8e-3, 0.5e-3)), own.settings)
    assert len(answer.motion.profile.turns) == 5
    assert answer.score.reversals == 0


def test_chips_that_are_broken_elsewhere_than_asked_are_an_error(plans):
    (hole,) = plans[2].holes
    moved = replace(hole, hole=replace(hole.hole, cycle=Cycle("chip_break", 6e-3, 0.3e-3)))
    checked = check_plan(replace(plans[2], holes=(moved,), transitions=(), order=()))
    assert any("the tool turns round" in failure for hole in checked.plan.holes for failure in hole.verified.failures)


@pytest.mark.parametrize(
    ("cycle", "message"),
    [
        ({"kind": "chip_break"}, "how often.*depth_mm"),
        ({"kind": "chip_break", "depth": 1e-3, "back": 1e-3}, "draws back by 1 mm each 1 mm"),
        ({"kind": "chip_break", "depth": -1e-3}, "above 0"),
    ],
)
def test_a_cycle_that_makes_no_sense_is_refused(cycle, message):
    with pytest.raises(InputError, match=message):
        Cycle(**cycle)


def test_too_many_pecks_are_refused():
    with pytest.raises(InputError, match="500 pecks in 50 mm"):
        Cycle("chip_break", 0.1e-3, 0.05e-3).breaks(50e-3)


def test_free_legs_do_not_break_chips():
    with pytest.raises(InputError, match="free legs drill in one go"):
        Settings(legs="free", cycle=FIVE)


def test_a_given_motion_that_draws_back_is_evaluated():
    """As a job's standoff_mm has it."""
    own = job(2, cycle=Cycle())
    (hole,) = own.holes
    profile = Profile(np.array([20, 10, 10.3, 0, 20]) * 1e-3, np.deg2rad([-172.4, -173.4, -174.0, -175.0, -209.0]))
    answer = plan(own.robot, own.tool, replace(hole, profile=profile), own.settings)
    assert answer.status == "evaluated"
    assert answer.verified.passed
    assert answer.score.reversals > 0
