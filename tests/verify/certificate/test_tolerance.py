"""Certified within a tolerance: no frame inside fails, no box with a frame in it that fails is certified."""

from dataclasses import replace

import numpy as np
import pytest
from benchmarks.cases import certified_holes
from flint import arb, ctx

import zerorev as zr
from oracles.placements import faults, moved_hole, random_error, rotation
from oracles.places import JOBS
from zerorev.errors import InputError
from zerorev.model.plan import Within
from zerorev.verify.certificate.arm import Setting, angles, body_at, posture_of, rates
from zerorev.verify.certificate.certify import certify_hole, certify_motion
from zerorev.verify.certificate.legs import planned_motion
from zerorev.verify.certificate.misplaced import moved
from zerorev.verify.certificate.piece import ball_arithmetic
from zerorev.verify.certificate.placed import Pieces, placed
from zerorev.verify.certificate.tolerance import Tolerated
from zerorev.verify.certificate.within import (
    RATIO,
    certify_plan_again,
    certify_plan_within,
    certify_within,
    largest_within,
)

PART = np.array(
    [[0.8, -0.6, 0.0, 0.45], [0.6, 0.8, 0.0, 0.2], [0.0, 0.0, 1.0, 0.7], [0.0, 0.0, 0.0, 1.0]]
)  # a frame near the holes, turned about Z
FRAMES = 20


@pytest.fixture(scope="module", params=[np.eye(4), PART], ids=["in the base", "at the holes"])
def frame(request):
    return request.param


def certified(robot, tool, settings, hole_plan):
    answer = replace(hole_plan, certificate=certify_hole(robot, tool, settings, hole_plan))
    assert answer.certificate.verdict == "certified", answer.certificate.reasons
    return answer


@pytest.fixture(scope="module")
def planned():
    """The positions of the thesis, planned with the motion threshold."""
    job = zr.read_job(JOBS / "thesis_positions.yaml")
    plan = zr.plan_job(job)
    return replace(
        plan, holes=tuple(certified(plan.robot, plan.tool, plan.settings, hole_plan) for hole_plan in plan.holes)
    )


def box_of(error):
    """The smallest tolerance that contains an error, a hair wider."""
    return Within(np.abs(error[:3]).max() * (1 + 1e-9), float(np.linalg.norm(error[3:])) * (1 + 1e-9))


def hold_to_frames(plan, hole_plan, frame, tolerance, rng, count=FRAMES):
    """No frame inside fails; the one planted outside does, and no box that holds it is certified."""
    robot, tool, settings = plan.robot, plan.tool, plan.settings
    for k in range(count):
        error = random_error(rng, tolerance.within, outermost=k % 2 == 0)
        assert not faults(robot, tool, settings, frame, hole_plan, error), error
    if tolerance.error is not None:
        assert faults(robot, tool, settings, frame, hole_plan, tolerance.error)
        assert certify_within(robot, tool, settings, frame, hole_plan, box_of(tolerance.error)).within is None


# --- what is certified ------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("position", [0, 1, 2])
def test_frames_inside_and_just_outside(planned, frame, position):
    hole_plan = planned.holes[position]
    tolerance = largest_within(planned.robot, planned.tool, planned.settings, frame, hole_plan)
    assert tolerance.within.position / tolerance.within.rotation == pytest.approx(RATIO)
    hold_to_frames(planned, hole_plan, frame, tolerance, np.random.default_rng(position))
    # a frame that is proven to fail lies within a tenth of the tolerance that is proven
    outside = box_of(tolerance.error)
    assert outside.position <= 1.1 * tolerance.within.position or outside.rotation <= 1.1 * tolerance.within.rotation
    assert max(outside.position / tolerance.within.position, outside.rotation / tolerance.within.rotation) > 1


@pytest.mark.parametrize("position", [0, 1, 2])
def test_a_larger_tolerance_is_never_certified_where_a_smaller_is_not(planned, position):
    hole_plan, part = planned.holes[position], planned.T_base_part
    answers = [
        certify_within(
            planned.robot, planned.tool, planned.settings, part, hole_plan, Within(size, size / RATIO)
        ).within
        is not None
        for size in np.geomspace(1e-4, 2e-2, 12)
    ]
    assert answers == sorted(answers, reverse=True)
    assert answers[0]
    assert not answers[-1]


def test_shift_and_turn_by_themselves(planned):
    """Without a turn a greater shift is certified, and the other way round."""
    hole_plan, rest = planned.holes[0], (planned.robot, planned.tool, planned.settings, planned.T_base_part)
    both = largest_within(*rest, hole_plan).within
    for alone in (Within(1.3 * both.position, 0.0), Within(0.0, 1.3 * both.rotation)):
        assert certify_within(*rest, hole_plan, alone).within == alone
        for seed in range(FRAMES):
            error = random_error(np.random.default_rng(seed), alone, outermost=True)
            assert not faults(*rest, hole_plan, error)
    assert certify_within(*rest, hole_plan, Within(0.0, 0.0)).within == Within(0.0, 0.0)


def test_a_turn_of_the_part_about_axis_1_moves_axis_1_alone(planned):
    """The rates do not change: their models have no linear term in it."""
    hole_plan, robot = planned.holes[0], planned.robot
    with ball_arithmetic():
        setting = Setting(robot.arm, posture_of(robot.arm, hole_plan.motion.joints[0]))
        path = planned_motion(robot.arm, planned.tool, hole_plan.hole, hole_plan.motion.profile, 1e-3)
        at = placed(path.legs, Pieces(np.array([0]), np.zeros(1), np.ones(1)), np.eye(4), Within(0.0, 0.02))
        found = rates(setting, body_at(setting, at.pose), at.twist)
        # the last variable is the turn about Z of the base
        assert max(np.abs(rate.terms[0, -1]).max() for rate in found) < 1e-15
        assert min(np.abs(rate.terms[0, 0]).max() for rate in found) > 1e-5


@pytest.mark.parametrize("seed", range(3))
def test_the_model_of_a_placed_motion_is_that_of_the_moved_hole(robot, drill, random_hole, frame, seed):
    """Rates of the moved hole, by balls, lie within the models; also of the hole moved as an arc."""
    hole, profile, start = random_hole(robot, drill, seed)
    rng, within = np.random.default_rng(seed), Within(2e-3, 5e-3)
    with ball_arithmetic(), np.errstate(all="ignore"):
        setting = Setting(robot.arm, posture_of(robot.arm, start))
        motion = planned_motion(robot.arm, drill, hole, profile, 1e-3)
        arcs = [*motion.legs, motion.blends[0].arc]
        begin, end = np.full(len(arcs), 0.25), np.full(len(arcs), 0.375)
        at = placed(arcs, Pieces(np.arange(len(arcs)), begin, end), frame, within)
        models = rates(setting, body_at(setting, at.pose), at.twist)
        start_of = Pieces(np.zeros(1, dtype=int), np.zeros(1), np.zeros(1))
        first = placed(arcs, start_of, frame, within)
        at_start = angles(setting, body_at(setting, first.pose), first.flange)
        for k in range(20):
            error = random_error(rng, within, outermost=k % 2 == 0)
            there = planned_motion(robot.arm, drill, moved_hole(hole, frame, error), profile, 1e-3)
            x = np.concatenate([rng.uniform(-1, 1, 1), error[:3] / within.position, error[3:] / within.rotation])
            t = 0.3125 + 0.0625 * x[0]
            for n, arc in enumerate([*there.legs, there.blends[0].arc]):
                truth, again = (rates_at(setting, each, t) for each in (arc, moved(arcs[n], frame, error)))
                for model, rate, other in zip(models, truth, again, strict=True):
                    linear, quadratic = model.terms[0, :, n], model.terms[1:, :, n]
                    guess = model.c[n] + linear @ x + x @ quadratic @ x
                    # the moved hole and the frame are rounded to floats
                    rounding = 1e-11 * (1 + abs(float(rate)))
                    assert not abs(float(rate) - guess) > model.rest[n] + rounding
                    assert abs(float(rate - other)) < rounding
            pose, flange = there.legs[0].at(0.0)
            for model, angle in zip(at_start, angles(setting, body_at(setting, pose), flange), strict=True):
                linear, quadratic = model.terms[0, :, 0], model.terms[1:, :, 0]
                off = float(angle) - (model.c[0] + linear @ x + x @ quadratic @ x)
                assert not abs(off - 2 * np.pi * np.rint(off / (2 * np.pi))) > model.rest[0] + 1e-11


def rates_at(setting, arc, t):
    """Rates of the six joints per unit of an arc's parameter."""
    ctx.cap = 1
    pose, twist = arc.around(arb(t), arb(1))
    return [rate[0] for rate in rates(setting, body_at(setting, pose), twist)]


def test_the_blends_are_in_it(planned):
    """A blend that runs the wrong way decides; with the right one there is something left."""
    hole_plan, robot, within = planned.holes[0], planned.robot, Within(1e-5, 1e-5)
    with ball_arithmetic():
        setting = Setting(robot.arm, posture_of(robot.arm, hole_plan.motion.joints[0]))
        motion = planned_motion(robot.arm, planned.tool, hole_plan.hole, hole_plan.motion.profile, 1e-3)
        arc = motion.blends[0].arc
        turns = tuple(turn._replace(angle=(turn.angle[0], -turn.angle[1], -turn.angle[2])) for turn in arc.turns)
        wrong = motion._replace(blends=[motion.blends[0]._replace(arc=arc._replace(turns=turns))])
        ends = hole_plan.motion.joints[[0, -1]]
        kept, lost = (Tolerated(robot, setting, each, ends, np.eye(4)).margin(within) for each in (motion, wrong))
    assert kept.share > 0.9
    assert lost.share < 0
    assert lost.cause.arc == len(motion.legs)


# --- what is not ------------------------------------------------------------------------------------------------------


def with_room(plan, hole_plan, joint, room):
    """The plan with a limit so much beyond the angles of one joint [rad]; of one hole."""
    limits = plan.robot.limits
    upper = limits.upper.copy()
    upper[joint] = hole_plan.motion.joints[[0, -1], joint].max() + room
    robot = replace(plan.robot, limits=replace(limits, upper=upper))
    score = replace(hole_plan.score, limit_distance=np.minimum(hole_plan.score.limit_distance, room))
    return replace(
        plan, robot=robot, holes=(certified(robot, plan.tool, plan.settings, replace(hole_plan, score=score)),)
    )


def test_a_limit_decides(planned, modest):
    """The tolerance ends where a limit is passed; also on another turn, as A6 at 217 deg in the published plan."""
    for hole_plan, joint, room in ((planned.holes[0], 3, 0.1), (modest(1), 5, 0.02)):
        narrow = with_room(planned, hole_plan, joint, np.deg2rad(room))
        rest = narrow.robot, narrow.tool, narrow.settings, narrow.T_base_part
        tolerance = largest_within(*rest, narrow.holes[0])
        assert f"A{joint + 1} is" in tolerance.decides
        assert "beyond its limits" in tolerance.decides
        hold_to_frames(narrow, narrow.holes[0], narrow.T_base_part, tolerance, np.random.default_rng(0))


def test_a_joint_that_stands_still_where_it_is_modelled(kuka, drill, modest, settings):
    """At position 2 as published joint 1 is all but at rest at the end of the retract: some micrometres decide."""
    hole_plan = certified(kuka, drill, settings, modest(2))
    tolerance = largest_within(kuka, drill, settings, np.eye(4), hole_plan)
    assert tolerance.within.position < 1e-5
    assert "A1 turns round on the retract, stand-off 20 mm" in tolerance.decides
    answer = certify_within(kuka, drill, settings, np.eye(4), hole_plan, Within(1e-3, np.deg2rad(0.1)))
    assert answer.within is None
    assert answer.decides.startswith("not certified within 1 mm and 0.1 deg: A1 turns round on the retract")
    assert faults(kuka, drill, settings, np.eye(4), hole_plan, answer.error)


def test_a_part_so_far_off_that_it_is_out_of_reach(planned):
    rest = planned.robot, planned.tool, planned.settings, planned.T_base_part
    for within in (Within(2.0, 0.0), Within(0.0, 3.0), Within(1e6, 1e3), Within(1e300, 1e300)):
        assert certify_within(*rest, planned.holes[0], within).within is None


@pytest.mark.parametrize("seed", range(6))
def test_planted_frames_under_which_a_joint_reverses(planned, seed):
    """Frames found by evaluation alone, at random, a few times farther off than what is proven."""
    rng, hole_plan = np.random.default_rng(seed), planned.holes[seed % 3]
    rest = planned.robot, planned.tool, planned.settings, planned.T_base_part
    within = largest_within(*rest, hole_plan).within
    wide = Within(3 * within.position, 3 * within.rotation)
    for _ in range(200):
        error = random_error(rng, wide, outermost=True)
        if faults(*rest, hole_plan, error):
            # as near as it still fails along this way
            least, most = 0.0, 1.0
            while most - least > 1e-3:
                middle = (least + most) / 2
                least, most = (least, middle) if faults(*rest, hole_plan, middle * error) else (middle, most)
            assert certify_within(*rest, hole_plan, box_of(most * error)).within is None
            return
    pytest.fail("no frame that fails was found")


# --- plans ------------------------------------------------------------------------------------------------------------


def test_a_whole_plan(planned):
    largest = certify_plan_within(planned)
    assert all(hole.certified_within is not None for hole in largest.holes)
    assert [hole.findings[-1].kind for hole in largest.holes] == ["tolerance"] * 3
    assert [hole.findings[-1].level for hole in largest.holes] == ["info"] * 3
    given = certify_plan_within(largest, Within(1e-3, np.deg2rad(0.1)))
    assert [hole.certified_within is not None for hole in given.holes] == [True, True, False]
    assert [[found.level for found in hole.findings if found.kind == "tolerance"] for hole in given.holes] == [
        [],
        [],
        ["warning"],
    ]
    again = certify_plan_again(largest)
    assert [hole.certified_within for hole in again.holes] == [hole.certified_within for hole in largest.holes]
    assert [hole.findings for hole in again.holes] == [hole.findings for hole in largest.holes]


def test_a_tolerance_that_was_put_into_the_file_is_taken_out(planned):
    holes = tuple(replace(hole, certified_within=Within(0.05, 0.05)) for hole in planned.holes)
    again = certify_plan_again(replace(planned, holes=holes))
    assert [hole.certified_within for hole in again.holes] == [None] * 3
    assert all(hole.findings[-1].level == "warning" for hole in again.holes)


def test_a_hole_that_is_not_certified_has_no_tolerance(planned, published):
    wrong = published(1, (10.0, 10.0, 10.0))
    plan = replace(planned, holes=(replace(wrong, certified_within=Within(1e-3, 1e-3)),))
    for answer in (certify_plan_within(plan), certify_plan_within(plan, Within(0.0, 0.0)), certify_plan_again(plan)):
        (hole,) = answer.holes
        assert hole.certificate.verdict != "certified"
        assert hole.certified_within is None
    with pytest.raises(InputError, match="is not certified"):
        largest_within(plan.robot, plan.tool, plan.settings, plan.T_base_part, wrong)


@pytest.mark.parametrize("within", [Within(-1e-3, 0.0), Within(0.0, np.nan), Within(np.inf, 0.0)])
def test_what_is_not_a_tolerance_is_refused(planned, within):
    with pytest.raises(InputError, match="tolerance"):
        certify_plan_within(planned, within)
    for ratio in (0.0, -1.0, np.nan, np.inf):
        with pytest.raises(InputError, match="ratio"):
            certify_plan_within(planned, ratio=ratio)


def test_the_moved_hole_of_a_plan_is_certified_too(planned):
    """The certificate proper, of the very hole moved to corners of the box."""
    hole_plan, part = planned.holes[2], planned.T_base_part
    within = largest_within(planned.robot, planned.tool, planned.settings, part, hole_plan).within
    for seed in range(6):
        error = random_error(np.random.default_rng(seed), within, outermost=True)
        hole, motion = moved_hole(hole_plan.hole, part, error), hole_plan.motion
        near = replace(planned.settings, near_joints=tuple(motion.joints[0]))
        joints = zr.evaluate(planned.robot, planned.tool, hole, motion.profile, motion.branch, near).motion.joints
        answer = certify_motion(
            planned.robot, planned.tool, hole, motion.profile, joints[:1], blend=planned.settings.blend
        )
        assert answer.verdict == "certified"


def test_the_oracle_turns_as_it_should():
    np.testing.assert_allclose(rotation([0, 0, np.pi / 2]) @ [1, 0, 0], [0, 1, 0], atol=1e-15)


@pytest.mark.long
def test_fifty_random_holes(record_property):
    """20 frames inside, and one planted outside, at each random hole with zero reversals."""
    near = []
    for seed, plan in enumerate(certified_holes(0, 50, zr.Settings())):
        (hole_plan,) = plan.holes
        tolerance = largest_within(plan.robot, plan.tool, plan.settings, plan.T_base_part, hole_plan)
        if tolerance.within is not None:
            hold_to_frames(plan, hole_plan, plan.T_base_part, tolerance, np.random.default_rng(seed))
            if tolerance.error is not None:
                outside = box_of(tolerance.error)
                near.append(outside.rotation / tolerance.within.rotation)
    assert len(near) >= 45
    record_property("measured", f"a frame that fails within x {np.median(near):.3f} of what is proven, in the median")
