"""The sequence of a job: members chosen exactly, orders improved, and what the plan says of the moves between."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise, permutations, product

import numpy as np
import pytest

import zerorev as zr
from oracles.holes import random_hole
from zerorev.kernels import tour
from zerorev.model._arrays import rotation_rpy, transform
from zerorev.planning.job import plan_job
from zerorev.planning.restated import check_plan
from zerorev.planning.sequence import moves_of
from zerorev.search.members import members
from zerorev.search.optimum import best_motion

PANEL = "examples/jobs/panel.yaml"


def trapezoid(angle, speed, acceleration):
    """Time from rest to rest, by the speed that is really reached."""
    top = min(speed, np.sqrt(angle * acceleration))
    return 2 * top / acceleration + (angle - top**2 / acceleration) / top if angle > 0 else 0.0


def cost_of(asked, order, choice, weight=None):
    """What a choice of members costs, move by move."""
    own = asked.own if weight is None else weight
    total = sum(own[m] for m in choice)
    for one, other in pairwise(choice):
        turns = np.abs(asked.start[other] - asked.end[one])
        total += max(map(trapezoid, turns, asked.speed, asked.acceleration))
        total += asked.change if asked.branch[one] != asked.branch[other] else 0.0
    if len(asked.home):
        for joints in (asked.start[choice[0]], asked.end[choice[-1]]):
            total += max(map(trapezoid, np.abs(joints - asked.home[0]), asked.speed, asked.acceleration))
    return total


def made_up(rng, holes, most, *, home=False):
    counts = rng.integers(1, most + 1, holes)
    total = counts.sum()
    middle = np.repeat(rng.uniform(-2, 2, (holes, 6)), counts, axis=0)
    start = middle + rng.normal(0, 0.3, (total, 6))
    return tour.Members(
        np.concatenate([[0], np.cumsum(counts)]), start, start + rng.normal(0, 0.1, (total, 6)),
        rng.integers(0, 3, total), rng.uniform(0, 0.5, total), rng.uniform(1, 6, 6), rng.uniform(3, 30, 6), 0.7,
        rng.uniform(-1, 1, (1, 6)) if home else np.empty((0, 6)),
    )  # fmt: skip


@pytest.mark.parametrize("seed", range(12))
def test_the_members_of_an_order_are_the_best_of_all(seed):
    """Against every choice there is."""
    rng = np.random.default_rng(seed)
    asked = made_up(rng, 5, 4, home=seed % 2 == 0)
    order, choice = rng.permutation(5), np.empty(5, dtype=np.int64)
    total = tour.chain(asked, order, choice)
    ways = product(*(range(asked.first[n], asked.first[n + 1]) for n in order))
    assert total == pytest.approx(min(cost_of(asked, order, way) for way in ways), abs=1e-12)
    assert total == pytest.approx(cost_of(asked, order, choice), abs=1e-12)


@pytest.mark.parametrize("seed", range(4))
def test_annealing_finds_the_best_order_of_a_few(seed):
    rng = np.random.default_rng(seed)
    asked = made_up(rng, 6, 2, home=True)
    choice = np.empty(6, dtype=np.int64)
    best = min(tour.chain(asked, np.array(order), choice) for order in permutations(range(6)))
    order = np.arange(6)
    tour.chain(asked, order, choice)
    near = np.array([[m for m in range(6) if m != n] for n in range(6)])
    tour.anneal(asked, near, np.tile([0, 5], (6, 1)), order, choice, 100_000, 1.0, 1e-3, 1)
    assert sorted(order) == list(range(6))
    assert (asked.first[order] <= choice).all()
    assert (choice < asked.first[order + 1]).all()
    assert cost_of(asked, order, choice) == pytest.approx(best, rel=1e-9)


def test_annealing_keeps_the_groups_together():
    asked = made_up(np.random.default_rng(5), 12, 2)
    order, choice = np.arange(12), np.empty(12, dtype=np.int64)
    tour.chain(asked, order, choice)
    near = np.array([[m for m in range(12) if m != n] for n in range(12)])
    block = np.repeat([[0, 4], [5, 11]], [5, 7], axis=0)
    tour.anneal(asked, near, block, order, choice, 50_000, 1.0, 1e-3, 1)
    assert sorted(order[:5]) == list(range(5))
    assert sorted(order[5:]) == list(range(5, 12))


@pytest.mark.parametrize("seed", [1, 3, 7, 12, 20])
def test_members_are_as_good_as_the_best_motion(seed):
    drilled = random_hole(seed)
    drilling, settings = drilled.both
    best = best_motion(drilling, settings)
    found = members(drilling, settings, best)
    assert found[0] is best
    assert len({(one.branch, one.profile.psi.tobytes()) for one in found}) == len(found)
    for one in found:
        assert one.reversals == best.reversals
        assert one.keeps_threshold or not best.keeps_threshold


@pytest.fixture(scope="module")
def panel():
    job = zr.read_job(PANEL)
    holes = tuple(hole for hole in job.holes if hole.id[1] in "019")[:26]  # R9C0 is out of reach
    return replace(job, holes=holes, settings=replace(job.settings, proof_boxes=0))


@pytest.fixture(scope="module")
def alone(panel):
    return plan_job(replace(panel, settings=replace(panel.settings, posture_freedom=0.0)))


@pytest.fixture(scope="module")
def planned(panel):
    return plan_job(panel)


def test_one_posture_for_a_share_of_the_travel(planned, alone):
    assert sum(move.changes_posture for move in alone.transitions) > 2
    assert not any(move.changes_posture for move in planned.transitions)
    travel, least = (sum(hole.score.travel for hole in each.holes if hole.score) for each in (planned, alone))
    assert least < travel <= 1.1 * least
    for one, other in zip(planned.holes, alone.holes, strict=True):
        if one.motion is not None:
            assert one.score.reversals <= other.score.reversals
            assert one.verified.passed
    turned = [sum(np.abs(np.diff(move.joints, axis=0)).sum() for move in each.transitions) for each in (planned, alone)]
    assert turned[0] < turned[1] / 4


def test_the_moves_lead_from_hole_to_hole(planned):
    drilled = [hole for hole in planned.holes if hole.motion is not None]
    assert planned.order == tuple(hole.hole.id for hole in drilled)
    assert len(planned.transitions) == len(drilled) - 1
    speed = planned.robot.limits.speed
    for move, one, other in zip(planned.transitions, drilled[:-1], drilled[1:], strict=True):
        assert (move.start, move.to) == (one.hole.id, other.hole.id)
        np.testing.assert_allclose(move.joints[0], one.motion.joints[-1], rtol=0, atol=1e-10)
        assert np.abs(move.joints[-1] - other.motion.joints[0]).max() < np.deg2rad(30)  # the lead-in lies between
        turns = np.abs(np.diff(move.joints, axis=0))
        assert move.time == pytest.approx(sum(max(map(trapezoid, turn, speed, speed / 0.3)) for turn in turns))
        assert move.largest_axis_move == pytest.approx(turns.sum(axis=0).max())
    times = sum(hole.cycle_time for hole in drilled) + sum(move.time for move in planned.transitions)
    assert planned.cycle_time == pytest.approx(times)


def test_a_plan_is_checked_with_its_sequence(planned):
    assert not check_plan(planned).wrong
    swapped = (*planned.order[1::-1], *planned.order[2:])
    assert check_plan(replace(planned, order=swapped)).wrong
    short = check_plan(replace(planned, order=planned.order[1:])).wrong
    assert any(finding.message.startswith("order") for finding in short)
    quick = replace(planned.transitions[0], time=planned.transitions[0].time / 2)
    (wrong,) = check_plan(replace(planned, transitions=(quick, *planned.transitions[1:]))).wrong
    assert wrong.message.startswith("transitions[0].time_s")
    strict = replace(planned, settings=replace(planned.settings, posture_freedom=0.01))
    assert any("travel_deg of all holes" in finding.message for finding in check_plan(strict).wrong)


def test_home_is_where_the_job_begins_and_ends(panel):
    home = tuple(np.deg2rad([0, -90, 90, 0, 0, 0]))
    few = replace(panel, holes=panel.holes[:3], settings=replace(panel.settings, home_joints=home))
    found = plan_job(few)
    assert (found.transitions[0].start, found.transitions[-1].to) == (None, None)
    np.testing.assert_array_equal(found.transitions[0].joints[0], home)
    np.testing.assert_array_equal(found.transitions[-1].joints[-1], home)


def test_the_best_order_takes_less_time_than_the_listed_one(panel):
    mixed = replace(panel, holes=panel.holes[::3] + panel.holes[1::3] + panel.holes[2::3])
    listed, best = (
        plan_job(replace(mixed, settings=replace(mixed.settings, order=order))) for order in ("listed", "best")
    )
    times = [sum(move.time for move in each.transitions) for each in (listed, best)]
    assert times[1] < 0.9 * times[0]
    assert sorted(best.order) == sorted(listed.order)
    assert [hole.hole.id for hole in best.holes] == [hole.hole.id for hole in listed.holes]
    for one, other in zip(moves_of(best), best.transitions, strict=True):
        np.testing.assert_allclose(one.joints, other.joints, rtol=0, atol=1e-7)


def test_groups_are_drilled_as_they_are_first_named(panel):
    grouped = tuple(replace(hole, group="AB"[n % 2]) for n, hole in enumerate(panel.holes[:8]))
    found = plan_job(replace(panel, holes=grouped, settings=replace(panel.settings, order="groups")))
    names = {hole.id: hole.group for hole in grouped}
    drilled = [names[hole_id] for hole_id in found.order]
    assert drilled == sorted(drilled)


def grid(name, rows):
    """A square of holes on a tilted plane, in proportion to the reach of a robot, with the thesis' tool as large."""
    base, robot = zr.read_robot("kuka_kr6_r700_2"), zr.read_robot(name)
    scale = robot.reach / base.reach
    tool = zr.Tool.from_mm_deg((100 * scale, 0, 65 * scale), (0, -90, 0))
    T = transform(rotation_rpy(0, np.deg2rad(-60), 0), scale * np.array([0.48, 0.15, 0.72]))
    places = scale * np.linspace(-0.09, 0.09, rows)
    holes = tuple(
        zr.Hole(f"R{r}C{c}", T[:3, :3] @ [x, y, 0] + T[:3, 3], -T[:3, 2], 0.012 * scale, psi_zero=T[:3, 1])
        for r, y in enumerate(places) for c, x in enumerate(places)
    )  # fmt: skip
    settings = replace(zr.Settings(), proof_boxes=0, min_rate=zr.Settings().min_rate / scale)
    return zr.Job(robot, tool, holes, settings, T)


@pytest.mark.parametrize("name", ["kuka_kr120_r2700_2", "abb_irb4600_60_205"])
@pytest.mark.parametrize("rows", [pytest.param(5, marks=pytest.mark.long), pytest.param(10, marks=pytest.mark.soak)])
def test_other_robots_keep_their_posture_as_well(name, rows, record_property):
    job = grid(name, rows)
    planned = plan_job(job)
    alone = plan_job(replace(job, settings=replace(job.settings, posture_freedom=0.0)))
    assert {hole.score.reversals for hole in planned.holes} == {0}
    assert not any(finding.kind == "through_part" for finding in planned.all_findings)
    changes, turned = (
        [count(plan) for plan in (planned, alone)]
        for count in (
            lambda plan: sum(move.changes_posture for move in plan.transitions),
            lambda plan: float(np.rad2deg(sum(np.abs(np.diff(m.joints, axis=0)).sum() for m in plan.transitions))),
        )
    )
    record_property("measured", f"{name}, {rows * rows} holes: changes of posture {changes}, axes between {turned} deg")
    assert changes[0] <= 2 < changes[1]
    assert turned[0] < turned[1] / (4 if rows == 10 else 2)
