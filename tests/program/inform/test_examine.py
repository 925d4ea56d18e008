"""What INFORM refuses, and what is said of the digits that a job has."""

from dataclasses import replace

import pytest

from oracles.makers import position_plan
from zerorev.errors import InputError, NotExportableError
from zerorev.files.io import read_robot
from zerorev.model.controller import Call, Calls, ExternalAxis
from zerorev.program.as_exported import as_exported
from zerorev.program.export import export
from zerorev.program.inform.dialect import INFORM
from zerorev.verify.certificate.program import certify_program


def changed(plan, **settings):
    return replace(plan, settings=replace(plan.settings, **settings))


def refused(plan, **how):
    with pytest.raises(NotExportableError) as error:
        export(plan, **how)
    return "; ".join(error.value.reasons)


def found(plan, words):
    return [finding for finding in export(plan).findings if words in finding.message]


def test_no_pulses(plan_for):
    plan = plan_for("ma2010", 1)
    why = refused(replace(plan, robot=replace(plan.robot, pulses_per_deg=None)))
    assert "pulses_per_deg" in why
    assert "ALL.PRM" in why
    assert "tool_number" not in why


def test_no_tool_number(plan_for):
    assert "put tool_number into the job" in refused(changed(plan_for("ma2010", 1), tool_number=None))


@pytest.mark.parametrize(
    ("settings", "what"),
    [
        ({"header": ("&REL 2",)}, "header"),
        ({"external_axes": (ExternalAxis("E1", 0.0),)}, "external_axes"),
        ({"robroot": (0.0,) * 6}, "robroot"),
        ({"base_number": 2}, "base_number"),
        ({"calls": Calls(before_hole=(Call("CLAMP", ("TRUE",)),))}, "CLAMP(TRUE), called before each hole"),
        ({"feed_plunge": 4e-5}, "feed of the plunge, 0.04 mm/s, rounds to zero"),
        ({"feed_retract": 1e-5}, "feed of the retract, 0.01 mm/s, rounds to zero"),
    ],
)
def test_what_a_job_cannot_say(settings, what, plan_for):
    assert what in refused(changed(plan_for("ma2010", 1), **settings))


def test_a_joint_move_too_slow_for_the_digits(plan_for):
    """0.1 mm/s is a speed that V= has; the joints need less than half of the last digit of VJ= for it."""
    plan = plan_for("ma2010", 1)
    fast = replace(plan.robot, limits=replace(plan.robot.limits, speed=plan.robot.limits.speed * 10))
    why = refused(changed(replace(plan, robot=fast), feed_plunge=1e-4, feed_retract=1e-4))
    assert "the joint moves at the corner of hole position 1" in why
    assert "rounds to zero" in why


def test_a_blended_corner_of_straight_moves(plan_for, ma2010):
    with pytest.raises(InputError, match="PL"):
        plan_for("ma2010", 1, corner="blend")
    # planned for a robot whose maker its file did not name
    nameless = position_plan(replace(ma2010, manufacturer=""), 1, nearer=0.85, tool_number=3)
    assert nameless.settings.controller is None
    why = refused(replace(nameless, robot=ma2010), controller="inform")
    assert "has a corner of kind blend" in why
    assert "controller: inform" in why


def test_another_makers_robot(plan_for):
    plan = plan_for("ma2010", 1)
    assert "INFORM runs on Yaskawa" in refused(replace(plan, robot=replace(plan.robot, manufacturer="ABB")))
    kuka = replace(plan, robot=read_robot("kuka_kr6_r700_2"), settings=replace(plan.settings, controller=None))
    assert "INFORM runs on Yaskawa" in refused(kuka, controller="inform")


def test_a_call_of_itself(plan_for):
    plan = plan_for("ma2010", 1)
    assert "is this job itself" in refused(changed(plan, calls=Calls(after_job=(Call("drill"),))), name="DRILL")


@pytest.mark.parametrize(
    ("feed", "level", "written"),
    [(5e-3, None, "5.0"), (2.17e-3, "info", "2.2"), (0.14e-3, "warning", "0.1"), (5.05e-3, "info", "5.0")],
)
def test_feeds_that_are_off(feed, level, written, plan_for):
    plan = changed(plan_for("ma2010", 1), feed_plunge=feed)
    exported = export(plan)
    assert f" V={written} " in exported.text
    said = [each.level for each in exported.findings if "the feed of the plunge is" in each.message]
    assert said == ([] if level is None else [level])


def test_a_corner_feed_that_is_far_off(plan_for):
    plan = changed(plan_for("ma2010", 1), feed_plunge=0.3e-3)
    (finding,) = found(plan, "joint moves at the corner have a feed")
    assert finding.level == "warning"
    assert not found(plan_for("ma2010", 1), "joint moves at the corner have a feed")


def test_what_rounding_does_is_said(plan_for):
    (finding,) = found(plan_for("ma2010", "panel", count=5), "whole pulses")
    assert finding.level == "info"
    assert finding.kind == "controller"


def certified(plan):
    program = INFORM.read(export(plan).files)
    return [
        h.certificate.verdict == "certified"
        for h in certify_program(plan, program, as_exported(plan, program, INFORM)).holes
    ]


@pytest.mark.parametrize("robot", ["ma2010", "stand_in"])
def test_slow_joints_are_named_before_the_certificate_fails(robot, plan_for):
    """Without a motion threshold joints stand or turn back in whole pulses: each hole that fails is named, no other."""
    plan = plan_for(robot, "panel", count=20, min_rate=0.0)
    said = found(plan, "cannot be certified")
    assert said
    assert all(finding.level == "warning" for finding in said)
    good = certified(plan)
    assert not all(good)
    one = [replace(plan, holes=(hole,)) for hole in plan.holes]
    assert [not found(each, "cannot be certified") for each in one] == good


def test_pulses_of_the_file(plan_for):
    """A hundred times fewer pulses: what rounding does grows with them."""
    plan = plan_for("ma2010", 1)
    coarse = replace(plan.robot, pulses_per_deg=tuple(count / 100 for count in plan.robot.pulses_per_deg))
    (fine,) = found(plan, "whole pulses: points")
    (rough,) = found(replace(plan, robot=coarse), "whole pulses: points")

    def figure(finding):
        return float(finding.message.split("up to ")[1].split()[0])

    assert figure(rough) > 20 * figure(fine)


def test_the_feed_of_the_last_of_the_way_in(plan_for):
    """It is as rough as the others."""
    plan = plan_for("ma2010", 1, breakthrough_length=5e-3, breakthrough_feed=1.26e-3)
    exported = export(plan)
    assert " V=1.3 " in exported.text
    assert "the feed of the plunge is 1.3 mm/s instead of 1.26" in " ".join(each.message for each in exported.findings)
    assert certified(plan) == [True]
