"""The hole that a simulated motion leaves: known paths, a naive twin, and limits in which it can be said what it is."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from oracles.drilled_hole import drilled_hole, longer_than_wide
from zerorev.cell.hole_estimate import THROUGH, calibrated_axis, hole_estimate
from zerorev.cell.motions import compared
from zerorev.cell.parameters import ParameterSet, drawn
from zerorev.cell.plant import Run, run
from zerorev.cell.reference import Manner
from zerorev.model.dynamics import Load

NOMINAL = {"tool_mass": 0.3, "tool_lever": 0.5}
FREE = {"friction": 1e-6, "viscous": 1e-6, "gap": 1e-6, **NOMINAL}  # no friction, no lost motion
NOWHERE = np.zeros(3)


@pytest.fixture(scope="module")
def references(published_plan):
    asked = Manner(feed=0.05, corner=2e-3)
    return compared(published_plan, published_plan.holes[0], asked, ("baseline", "plan", "biased")).followed


def sections_of(reference):
    down, up = reference.standoff[: reference.turn], reference.standoff[reference.turn :]
    return np.linspace(min(reference.drilling.hole.depth, down.max(), up.max()), up.min() + THROUGH, 51)


def across(reference):
    """Two unit vectors across the axis."""
    d = reference.drilling.hole.direction
    x = np.cross(d, [0.3, 0.5, 0.8])
    x /= np.linalg.norm(x)
    return x, np.cross(d, x)


def run_along(reference, moved):
    """A run of which the tip is moved by known vectors [m], shape (N, 3)."""
    link = np.einsum("nkj,nj->nk", np.linalg.pinv(np.swapaxes(reference.levers, 1, 2)), moved)
    nothing = np.zeros_like(link)
    return Run(reference, nothing, link, nothing, np.zeros(2))


@pytest.mark.parametrize("name", ["baseline", "plan", "biased"])
def test_a_path_of_which_all_is_known(references, name):
    """A tilted plunge and a retract beside it; what is along the axis moves no wall."""
    reference = references[name]
    x, y = across(reference)
    s = reference.standoff[:, None]
    back = np.arange(len(s))[:, None] > reference.turn
    offset, slope, gap = 0.05e-3 * x - 0.02e-3 * y, 3e-4 * x + 4e-4 * y, 0.1e-3 * x
    moved = offset + s * slope + back * (gap + 2e-3 * s * y) + 0.3e-3 * reference.drilling.hole.direction
    found = hole_estimate(run_along(reference, moved), 0.01e-3 * y)
    sections = sections_of(reference)
    assert found.tilt == pytest.approx(np.arctan(5e-4), rel=1e-9)
    middle = offset - 0.01e-3 * y + sections.mean() * slope
    assert found.position == pytest.approx(np.linalg.norm(middle), rel=1e-6)
    ends = [np.linalg.norm(gap + 2e-3 * z * y) for z in sections[[0, -1]]]
    np.testing.assert_allclose(found.ovality, ends, rtol=1e-6)


def test_a_union_of_two_circles_is_longer_by_the_distance_of_their_centres():
    chance = np.random.default_rng(1)
    for _ in range(5):
        one, other = chance.normal(0, 0.1e-3, (2, 2))
        assert longer_than_wide(one, other, 3e-3) == pytest.approx(np.linalg.norm(one - other), rel=5e-3)


@pytest.mark.parametrize("name", ["baseline", "plan", "biased"])
def test_a_naive_twin(references, name):
    """Of simulated runs: interval by interval, and a fit by numpy."""
    reference = references[name]
    d = reference.drilling.hole.direction
    for parameters in drawn(3, 11):
        done = run(reference, parameters)
        axis = calibrated_axis(references["baseline"], parameters)
        tip = done.tool - np.outer(done.tool @ d, d) - axis
        position, tilt, apart = drilled_hole(reference.standoff, tip, sections_of(reference))
        found = hole_estimate(done, axis)
        assert found.position == pytest.approx(position, abs=1e-9)
        assert found.tilt == pytest.approx(tilt, rel=1e-4)
        np.testing.assert_allclose(found.ovality, apart[[0, -1]], rtol=1e-6, atol=2e-9)


def test_a_rigid_arm_drills_a_perfect_hole(references):
    rigid = ParameterSet({**FREE, "stiffness": 100.0})
    axis = calibrated_axis(references["baseline"], rigid)
    found = hole_estimate(run(references["baseline"], rigid, time_step=1e-5), axis)
    assert found.position < 2e-6
    assert found.ovality.max() < 2e-6
    assert found.tilt < 1e-4


@pytest.mark.parametrize("kind", [0.0, 1.0])
def test_sag_at_rest_is_calibrated_away(published_plan, kind):
    """Without friction a slow arm is always at rest: its plunge lies about the calibrated axis, in a gap or without."""
    (reference,) = compared(
        published_plan, published_plan.holes[2], Manner(feed=0.005), ("baseline",)
    ).followed.values()
    for values in (FREE, {**FREE, "tool_mass": 2.0, "kind": kind}):
        parameters = ParameterSet(values)
        axis = calibrated_axis(reference, parameters)
        found = hole_estimate(run(reference, parameters), axis)
        assert np.linalg.norm(axis) > 0.1e-3
        assert found.position < 1e-6


def test_a_gear_that_friction_holds_is_calibrated_in_the_middle_of_its_gap(published_plan):
    """A joint that gravity does not load, or less than friction holds, may rest on either flank."""
    (reference,) = compared(published_plan, published_plan.holes[2], Manner(feed=0.02), ("baseline",)).followed.values()
    stiff = {"stiffness": 1e6, "gap": 1.0, **NOMINAL}
    held = ParameterSet({**stiff, "friction": 1e3, "behind": 0.9})
    assert np.linalg.norm(calibrated_axis(reference, held)) < 1e-8
    hanging = calibrated_axis(reference, ParameterSet({**stiff, "friction": 1e-3}))
    assert np.linalg.norm(hanging) > 0.02e-3
    double = calibrated_axis(reference, ParameterSet({**stiff, "friction": 1e-3, "gap": 2.0}))
    np.testing.assert_allclose(double, 2 * hanging, rtol=1e-3)


def test_the_load_of_the_tool_file_is_the_one_that_sags(published_plan):
    (reference,) = compared(published_plan, published_plan.holes[0], Manner(feed=0.02), ("baseline",)).followed.values()
    tool = reference.drilling.tool
    load = Load(2.0, 0.6 * tool.T_flange_tcp[:3, 3], np.zeros((3, 3)))
    weighed = replace(reference, drilling=replace(reference.drilling, tool=replace(tool, load=load)))
    stated = calibrated_axis(weighed, ParameterSet({}))
    drawn_axis = calibrated_axis(reference, ParameterSet({"tool_mass": 2.0, "tool_lever": 0.6}))
    np.testing.assert_allclose(stated, drawn_axis, rtol=0, atol=1e-12)
    assert np.linalg.norm(stated - calibrated_axis(reference, ParameterSet(NOMINAL))) > 1e-6


def test_a_released_thrust_leaves_the_ovality_that_the_compliance_says(published_plan):
    """The give across the axis, |(1 - d d^T) J diag(1/k) J^T d| per newton: the plunge has it, the retract has not."""
    (reference,) = compared(
        published_plan, published_plan.holes[0], Manner(feed=0.005), ("baseline",)
    ).followed.values()
    parameters = ParameterSet(FREE)
    before = np.arange(reference.standoff.size) < reference.turn
    thrust = np.where(before & (reference.standoff > THROUGH), 100.0, 0.0)
    axis = calibrated_axis(reference, parameters)
    found = hole_estimate(run(reference, parameters, thrust=thrust), axis)
    d = reference.drilling.hole.direction
    k = parameters.arm(published_plan.robot.dynamics).stiffness
    J = reference.levers[np.argmin(np.abs(reference.standoff[: reference.turn] - sections_of(reference)[-1]))].T
    give = J @ np.diag(1 / k) @ J.T @ (100.0 * d)
    expected = np.linalg.norm(give - (give @ d) * d)
    assert found.ovality[1] == pytest.approx(expected, rel=0.05)
    assert found.position == pytest.approx(expected, rel=0.3)
