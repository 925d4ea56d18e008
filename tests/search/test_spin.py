"""A tool that dwells at the target and spins on meanwhile, so that no joint rests."""

import json
import re
from dataclasses import replace

import numpy as np
import pytest

from oracles.makers import position_plan, stand_in
from zerorev.errors import InputError
from zerorev.files.io import plan_from_text, plan_to_json
from zerorev.model.cycle import Cycle
from zerorev.model.job import Settings
from zerorev.model.profile import Profile
from zerorev.motion.drilling import Drilling
from zerorev.motion.joint_path import joints_along
from zerorev.motion.kinematics import forward
from zerorev.planning.restated import check_plan
from zerorev.verify.certificate.certify import certify_hole, certify_plan
from zerorev.verify.check import verify_hole

TIME = 0.2
SPIN = Cycle(dwell=TIME, moving=True)
BROKEN = Cycle("chip_break", 5e-3, 0.3e-3, dwell=TIME, moving=True)


def plan_of(number=1, cycle=SPIN, **settings):
    return position_plan(stand_in("FANUC"), number, **({"min_rate": np.deg2rad(10), "cycle": cycle} | settings))


def begin_of(hole):
    """Index of the breakpoint at which the tool begins to spin on."""
    return hole.motion.profile.corner - hole.corner.spin_moves


@pytest.mark.parametrize(
    ("number", "cycle"),
    [
        (1, SPIN),
        (2, BROKEN),
        (3, replace(SPIN, dwell=0.6)),
        *(
            pytest.param(number, cycle, marks=pytest.mark.long)
            for number, cycle in [(2, SPIN), (3, SPIN), (1, BROKEN), (3, BROKEN), (1, replace(SPIN, dwell=2.0))]
        ),
    ],
)
def test_planned_and_proven_at_the_thesis_positions(number, cycle):
    plan = plan_of(number, cycle)
    (hole,) = plan.holes
    assert (hole.verified.passed, hole.score.reversals) == (True, 0)
    assert (hole.corner.kind, hole.corner.dwell) == ("spin", cycle.dwell)
    assert hole.corner.off_axis <= plan.settings.corner_tolerance
    (certificate,) = (each.certificate for each in certify_plan(plan).holes)
    assert (certificate.verdict, certificate.reasons) == ("certified", ())
    assert [finding.level for finding in hole.findings if "spins on at the target" in finding.message] == ["warning"]


@pytest.mark.parametrize("number", [1, 2, 3])
def test_every_joint_runs_one_way_and_the_tip_stays(number):
    """On the joint moves as a controller runs them, and on the legs by inverse kinematics."""
    plan = plan_of(number, replace(SPIN, dwell=0.6))
    (hole,) = plan.holes
    drilling, motion = Drilling.of(plan, hole.hole), hole.motion
    profile, first = motion.profile, begin_of(hole)
    assert hole.corner.spin_moves > 2
    knots = profile.distance
    legs = [np.linspace(0, knots[first], 4_001), np.linspace(knots[profile.corner], knots[-1], 4_001)]
    inwards, outwards = (joints_along(drilling, motion.branch, *profile.at(leg)) for leg in legs)
    share = np.linspace(0, 1, 101)[:-1, None]
    spin = np.vstack(
        [
            a + share * (b - a)
            for a, b in zip(motion.joints[first:], motion.joints[first + 1 : profile.corner + 1], strict=False)
        ]
    )
    steps = [np.diff(each, axis=0) for each in (inwards, spin, outwards)]
    for joint in range(6):
        signs = {np.sign(step[:, joint]).min() for step in steps} | {np.sign(step[:, joint]).max() for step in steps}
        assert len(signs) == 1
    T = forward(plan.robot, spin) @ plan.tool.T_flange_tcp
    off = np.linalg.norm(T[:, :3, 3] - hole.hole.target, axis=1)
    assert off.max() < 2 * plan.settings.corner_tolerance


@pytest.mark.parametrize("number", [1, 2, 3])
def test_no_joint_is_slower_than_on_its_slower_leg(number):
    """Nor faster than on its faster one: where the spin begins it is a mix of the two velocities, by differences."""
    plan = plan_of(number, replace(SPIN, dwell=0.05))
    (hole,) = plan.holes
    drilling, profile, k = Drilling.of(plan, hole.hole), hole.motion.profile, begin_of(hole)
    settings, c = plan.settings, profile.corner
    length = 1e-6

    def speed(s, psi, ds, dpsi, time):
        joints = joints_along(drilling, hole.motion.branch, np.array([s, s + ds]), np.array([psi, psi + dpsi]))
        return np.abs(np.diff(joints, axis=0)[0]) / time

    place = profile.standoff[k], profile.psi[k]
    plunge = speed(*place, length, profile.twist_rate[k - 1] * length, length / settings.feed_plunge)
    retract = speed(*place, length, profile.twist_rate[c] * length, length / settings.feed_retract)
    part = 1e-3
    rise, turned = (part * (values[c] - values[k]) for values in (profile.standoff, profile.psi))
    spin = speed(*place, rise, turned, part * hole.corner.dwell)
    assert (spin >= np.minimum(plunge, retract) * 0.999).all()
    assert (spin <= np.maximum(plunge, retract) * 1.001).all()


def test_what_cannot_be_held_is_capped_and_said():
    plan = plan_of(3, replace(SPIN, dwell=5.0))
    (hole,) = plan.holes
    assert hole.verified.passed
    assert 0.3 < hole.corner.dwell < 5.0
    (message,) = (finding.message for finding in hole.findings if finding.kind == "corner")
    assert re.search(r"for [\d.]+ s instead of 5 s \(for longer no motion was found", message)


def test_the_time_of_the_hole_has_the_dwell():
    standing, spinning = (plan_of(1, Cycle(dwell=TIME, moving=moving)).holes[0] for moving in (False, True))
    crept = 20e-6 / 5e-3
    assert standing.corner.kind == "stop"
    assert spinning.cycle_time == pytest.approx(standing.cycle_time - crept, abs=1e-9)


def test_a_plan_file_of_it_is_checked_again():
    plan = plan_of(1)
    again = plan_from_text(json.dumps(plan_to_json(plan), default=float), "plan.json")
    assert check_plan(again).wrong == ()
    found, stated = again.holes[0].corner, plan.holes[0].corner
    assert (found.dwell, found.spin_moves) == (stated.dwell, stated.spin_moves) == (TIME, 1)
    assert found.spin == pytest.approx(stated.spin, abs=1e-12)


def spoiled(plan, **changes):
    """What the check and the certificate say of a hole of which something is stated otherwise."""
    (hole,) = plan.holes
    hole = replace(hole, corner=replace(hole.corner, **changes))
    settings = plan.settings
    failures = verify_hole(plan.robot, plan.tool, settings, hole).failures
    return failures, certify_hole(plan.robot, plan.tool, settings, hole)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"dwell": 0.1}, "the tool spins on by .* right for 0.1 s on these legs is"),
        ({"dwell": 0.3}, "the tool spins on for 0.3 s, asked are 0.2 s"),
        ({"spin": 0.01}, "the tool spins on by .*, the plan says"),
        ({"spin_moves": None}, "the tool is to spin on at the corner, and the plan does not say"),
        ({"spin_moves": 2}, "2 joint moves, and 2 breakpoints lie before the corner"),
        ({"spin_moves": 9}, "9 joint moves, and 2 breakpoints lie before the corner"),
        ({"kind": "joint"}, "the tool is to spin on at the corner"),
        ({"kind": "stop", "reach": 0.0}, "the tool is to spin on at the corner"),
    ],
)
def test_what_is_stated_wrongly_is_refuted(changes, message):
    failures, certificate = spoiled(plan_of(1), **changes)
    assert any(re.search(message, failure) for failure in failures), failures
    assert certificate.verdict == "refuted"


def test_fewer_joint_moves_than_there_are_are_refuted():
    plan = plan_of(1, replace(SPIN, dwell=0.6))
    count = plan.holes[0].corner.spin_moves
    failures, _ = spoiled(plan, spin_moves=count - 1)
    assert any("the tool does not creep in by 20 um" in failure for failure in failures)


def test_a_spin_the_wrong_way_turns_joints_round():
    """The same motion with the retract as if the tool had spun back."""
    plan = plan_of(1)
    (hole,) = plan.holes
    profile, corner = hole.motion.profile, hole.motion.profile.corner
    psi = profile.psi.copy()
    psi[corner:] -= 2 * hole.corner.spin
    joints = joints_along(Drilling.of(plan, hole.hole), hole.motion.branch, profile.standoff, psi)
    back = replace(hole, motion=replace(hole.motion, profile=Profile(profile.standoff, psi), joints=joints))
    failures = verify_hole(plan.robot, plan.tool, plan.settings, back).failures
    assert sum("reverses 2 times" in failure for failure in failures) >= 5
    assert certify_hole(plan.robot, plan.tool, plan.settings, back).verdict == "refuted"


@pytest.mark.parametrize(
    ("settings", "what"),
    [
        ({"corner": "spin"}, "spins on at the target, but not for how long"),
        ({"cycle": SPIN, "corner": "joint"}, "kind joint beside moving: true"),
        ({"cycle": SPIN, "corner": "stop"}, "kind stop beside moving: true"),
        ({"cycle": SPIN, "controller": "krl"}, "spin is not offered for KRL: .* C_DIS no distance to go by"),
        ({"cycle": SPIN, "blend": 0.0}, "kind spin has no room in a blend of 0"),
        ({"cycle": SPIN, "legs": "free"}, "free legs do not spin on at the target"),
        ({"cycle": Cycle("peck", 5e-3, dwell=0.1), "corner": "spin"}, "drilled in several strokes"),
    ],
)
def test_contradictions(settings, what):
    with pytest.raises(InputError, match=what):
        Settings(**({"controller": "tp"} | settings))


def test_a_spin_needs_a_time():
    with pytest.raises(InputError, match="spins on, but not for how long"):
        Cycle(moving=True)
    assert Settings(controller="tp", corner="spin", cycle=Cycle(dwell=0.1)).turning.kind == "spin"
