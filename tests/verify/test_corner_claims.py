"""What a plan says of the joint moves at its corner: checked, and proven for every blend of them."""

import re
from dataclasses import replace

import numpy as np
import pytest

from oracles.makers import position_plan, stand_in
from zerorev.files.io import read_robot
from zerorev.model.cycle import Cycle
from zerorev.verify.certificate.certify import certify_hole
from zerorev.verify.check import verify_hole

FIVE = Cycle("chip_break", 5e-3, 0.3e-3)


@pytest.fixture(scope="module")
def plans():
    robot, rate = read_robot("abb_irb1200_5_90"), np.deg2rad(10)
    return {
        (number, cycle.kind): position_plan(robot, number, min_rate=rate, cycle=cycle)
        for number in (1, 2)
        for cycle in (Cycle(), FIVE)
    }


def check(plan, **corner):
    (hole,) = plan.holes
    hole = replace(hole, corner=replace(hole.corner, **corner))
    verified = verify_hole(plan.robot, plan.tool, plan.settings, hole)
    return verified.failures, certify_hole(plan.robot, plan.tool, plan.settings, hole)


@pytest.mark.parametrize("number", [1, 2])
@pytest.mark.parametrize("kind", ["single", "chip_break"])
def test_what_is_planned_holds_and_is_proven(number, kind, plans):
    failures, certificate = check(plans[number, kind])
    assert failures == ()
    assert (certificate.verdict, certificate.reasons) == ("certified", ())


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        ({"off_axis": 1e-6}, "the tip leaves the drill axis by .* at the corner, the plan says 0.001 mm"),
        ({"tilt": 1e-7}, "the tool tilts by .* at the corner"),
        ({"reach": 2e-3}, "begin 2 mm from it, asked are 1 mm"),
        ({"kind": "blend"}, "the corner is of kind blend, asked is joint"),
    ],
)
def test_what_is_stated_too_well_fails_the_check(changed, message, plans):
    failures, _ = check(plans[1, "single"], **changed)
    assert any(re.search(message, failure) for failure in failures)


def test_a_tool_that_leaves_the_axis_by_more_than_allowed_is_refuted():
    plan = position_plan(stand_in("ABB"), 2, min_rate=np.deg2rad(10))
    (hole,) = plan.holes
    strict = replace(plan.settings, corner_tolerance=hole.corner.off_axis / 3)
    stated = replace(hole, corner=replace(hole.corner, off_axis=hole.corner.off_axis / 3))
    certificate = certify_hole(plan.robot, plan.tool, strict, stated)
    assert certificate.verdict == "refuted"
    assert "the tool leaves the drill axis by" in certificate.reasons[0]


def test_where_the_tool_is_to_stand_the_corner_is_a_stop(plans):
    plan = plans[1, "single"]
    (hole,) = plan.holes
    standing = replace(hole, hole=replace(hole.hole, cycle=Cycle(dwell=0.1)))
    verified = verify_hole(plan.robot, plan.tool, plan.settings, standing)
    assert "the corner is of kind joint, asked is stop" in verified.failures
    settings = replace(plan.settings, cycle=Cycle(dwell=0.1))
    assert "the corner is of kind joint, asked is stop" in verify_hole(plan.robot, plan.tool, settings, hole).failures
