"""What is found before a program is written."""

from dataclasses import replace

import numpy as np
import pytest

from zerorev.errors import NotExportableError
from zerorev.model.corner import CONTROLLERS
from zerorev.model.hole import Hole
from zerorev.model.profile import Profile
from zerorev.motion.drilling import Drilling
from zerorev.motion.joint_path import joints_along
from zerorev.program.export import export
from zerorev.program.krl.read import read_krl
from zerorev.program.neutral import build_program
from zerorev.program.notes import corner_depth
from zerorev.program.preflight import preflight


def findings(plan, kind, controller="krl"):
    return [
        finding for finding in preflight(build_program(plan), plan, CONTROLLERS[controller]) if finding.kind == kind
    ]


def fastest(plan, leg):
    """Greatest joint rate of a leg relative to what the joint can [rad/m per rad/s], by finite differences."""
    hole = plan.holes[0]
    profile = hole.motion.profile
    (s0, s1), (p0, p1) = profile.standoff[leg : leg + 2], profile.psi[leg : leg + 2]
    x = np.linspace(0, 1, 5001)
    joints = joints_along(
        Drilling(plan.robot, plan.tool, hole.hole), hole.motion.branch, s0 + x * (s1 - s0), p0 + x * (p1 - p0)
    )
    rates = np.abs(np.diff(joints, axis=0)).max(axis=0) / (abs(s1 - s0) / 5000)
    share = rates / plan.robot.limits.speed
    return share.max(), int(share.argmax())


def test_joint_speeds_at_the_feeds(published, plan_of):
    share, joint = fastest(plan_of(published(2)), 1)
    fits = 1 / share  # [m/s]
    assert not findings(plan_of(published(2), lead_in=0.0, feed_retract=fits * 0.995), "joint_speed")
    plan = plan_of(published(2), lead_in=0.0, feed_retract=fits * 1.01)
    (finding,) = findings(plan, "joint_speed")
    assert (finding.level, finding.hole) == ("error", "position 2")
    name, speed = plan.robot.joint_names[joint], np.rad2deg(plan.robot.limits.speed[joint])
    assert finding.message.startswith(f"{name} would have to turn at {speed * 1.01:.1f} deg/s on the retract")
    assert f"can turn at {speed:.1f} deg/s" in finding.message
    stated = float(finding.message.split("feed that fits is ")[1].split()[0]) * 1e-3
    assert fits * 0.98 < stated <= fits * 1.0001
    # and the feed that is said to fit does fit
    assert not findings(plan_of(published(2), lead_in=0.0, feed_retract=stated), "joint_speed")
    with pytest.raises(NotExportableError, match=f"position 2: {name} would have to turn"):
        export(plan)


def test_both_legs_are_examined(published, plan_of):
    plan = plan_of(published(1), feed_plunge=2.0, feed_retract=2.0)
    assert [f.message.split(" on the ")[1].split()[0] for f in findings(plan, "joint_speed")] == [
        "lead-in",
        "plunge",
        "retract",
    ]


def test_the_depth_lost_to_the_blend(published, plan_of):
    (finding,) = findings(plan_of(published(1), blend=4e-3), "blend")
    assert (finding.level, finding.hole) == ("info", "position 1")
    assert "turns back 2 mm short" in finding.message
    assert "comes out 2 mm less deep" in finding.message
    assert "deepen_corner" in finding.message
    (finding,) = findings(plan_of(published(1), blend=4e-3, blend_shortfall=1.25e-3), "blend")
    assert "turns back 1.25 mm short (as measured)" in finding.message
    assert not findings(plan_of(published(1), blend=0.0), "blend")


def test_a_deeper_corner_asks_for_clearance(published, plan_of):
    plan = plan_of(published(1, corner=-2e-3), blend=4e-3, deepen_corner=True)
    (finding,) = findings(plan, "clearance")
    assert finding.level == "warning"
    assert "2 mm below the target" in finding.message
    assert "clearance behind the material" in finding.message
    assert "the depth is met" in findings(plan, "blend")[0].message
    assert "warning:  hole position 1: the programmed corner lies 2 mm below the target" in export(plan).text
    assert not findings(plan_of(published(1)), "clearance")


def test_a_plan_that_did_not_deepen_its_corner_is_reported(published, plan_of):
    plan = plan_of(published(1), blend=4e-3, deepen_corner=True)
    assert findings(plan, "corner_not_deepened")
    assert "comes out 2 mm less deep" in findings(plan, "blend")[0].message


def test_a_clipped_blend_changes_the_depth(published, plan_of):
    # the stroke is 20 mm, so half of it, 10 mm, is the greatest radius
    plan = plan_of(published(2), blend=16e-3)
    (finding,) = findings(plan, "blend_clipped")
    assert finding.level == "warning"
    assert "10.00 mm instead of 16 mm" in finding.message
    program = build_program(plan)
    depth = corner_depth(program, program.holes[0])
    assert (depth.blend, depth.lost) == (pytest.approx(10e-3), pytest.approx(5e-3))
    # placed deeper by half of 16 mm, the tip would come out deeper than asked for: the file must not be silent on it
    plan = plan_of(published(2, corner=-1e-3), blend=30e-3, blend_shortfall=1e-3, deepen_corner=True)
    assert "deeper than asked for" in findings(plan, "blend")[0].message


def test_what_holds_for_every_hole_is_said_once(published, plan_of):
    plan = plan_of(published(1), published(2), published(3))
    (finding,) = findings(plan, "blend")
    assert finding.hole is None
    assert finding.message.endswith("(at every hole)")
    assert len(findings(plan, "unchecked_moves")) == 1


def test_the_twist_changes_the_spindle_speed(published, plan_of):
    assert not findings(plan_of(published(1)), "spindle_speed")
    (finding,) = findings(plan_of(published(1), spindle_rpm=6000.0, feed_retract=20e-3), "spindle_speed")
    # thesis eq. 5.4: 24.5211 deg over 50 mm at 20 mm/s, over 6, with the sense of a right-hand drill
    assert f"{24.5211 / 50 * 20 / 6:+.3g} rev/min" in finding.message
    assert finding.level == "info"
    (finding,) = findings(plan_of(published(1), spindle_rpm=100.0, feed_retract=20e-3), "spindle_speed")
    assert finding.level == "warning"


def turning_plan(plan_of, planned, turn_deg, tool):
    """A hole straight down with a leg of much twist, on a branch that can run it."""
    hole = Hole("turner", np.array([0.35, 0.0, 0.45]), np.array([0, 0, -1.0]), 0.02, np.array([0, 1.0, 0]))
    for start in np.deg2rad(np.arange(0, 360, 20)):
        try:
            profile = Profile.straight(0.02, *(start + np.deg2rad([turn_deg, 0, 10])))
            return plan_of(
                planned(hole, profile, tool=tool), tool=tool, lead_in=0.0, feed_plunge=5e-4, feed_retract=1e-3
            )
        except pytest.fail.Exception:
            continue
    pytest.fail("no motion")


def test_a_leg_of_300_deg_is_split(krl, planned, plan_of, straight_down_tool):
    plan = turning_plan(plan_of, planned, 300.0, straight_down_tool)
    moves = krl.read(export(plan).text).moves
    assert [move.kind for move in moves] == ["PTP"] + ["LIN"] * 4
    assert [move.blended for move in moves] == [False, True, True, True, False]
    C = np.array([move.values["C"] for move in moves[1:]])
    steps = (np.diff(C) + 180) % 360 - 180
    np.testing.assert_allclose(steps[:2], 100, atol=1e-3)
    # the blend of a split is clipped like any other, here to less than half of a third of the stroke
    assert all(move.state["$APO.CDIS"] == 1.0 for move in moves[1:4])


def test_a_move_of_too_great_a_turn_is_an_error(published, plan_of, spoil):
    plan = plan_of(published(1))
    program = build_program(plan)
    (hole,) = program.holes
    far = spoil(hole.moves[1], end=spoil(hole.moves[1].end, psi=hole.moves[1].psi - np.deg2rad(170)))
    broken = spoil(program, holes=(spoil(hole, moves=(hole.moves[0], far, hole.moves[2])),))
    messages = [f.message for f in preflight(broken, plan, CONTROLLERS["krl"]) if f.kind == "move_turn"]
    assert len(messages) == 2
    assert "linear move 2 turns the tool by 190.10 deg" in messages[0]
    assert all(f.level == "error" for f in preflight(broken, plan, CONTROLLERS["krl"]) if f.kind == "move_turn")


def test_joints_that_are_not_at_the_poses_are_an_error(published, plan_of, spoil):
    hole = published(1)
    joints = hole.motion.joints.copy()
    joints[1, 2] += np.deg2rad(0.1)
    plan = plan_of(spoil(hole, motion=spoil(hole.motion, joints=joints)))
    (finding,) = findings(plan, "joints")
    assert finding.level == "error"
    assert "miss its poses" in finding.message
    with pytest.raises(NotExportableError, match="A3 at breakpoint 2 is given as"):
        export(plan)


def test_joints_beyond_their_limits_are_an_error(published, plan_of, spoil):
    hole = published(1)
    joints = hole.motion.joints + np.array([0, 0, 0, 0, 0, 2 * np.pi])
    plan = plan_of(spoil(hole, motion=spoil(hole.motion, joints=joints)))
    assert any(
        "A6 beyond the joint limits" in finding.message
        for finding in preflight(build_program(plan), plan, CONTROLLERS["krl"])
    )
    with pytest.raises(NotExportableError, match=r"A6 at .* deg beyond its limits"):
        export(plan)


def test_a_fast_turn_of_the_tool_raises_the_orientation_speeds(krl, planned, plan_of, straight_down_tool, spoil):
    plan = turning_plan(plan_of, planned, 100.0, straight_down_tool)
    fast = spoil(plan, settings=spoil(plan.settings, feed_plunge=60e-3))
    turn = 100 / 20 * 60  # deg/s
    (warning,) = findings(fast, "turn_speed")
    assert f"{turn:.0f} deg/s" in warning.message
    state = krl.read(export(fast).text).moves[1].state
    assert state["$VEL.ORI1"] == state["$VEL.ORI2"] >= 1.2 * turn


@pytest.mark.parametrize(
    ("turn", "warned"),
    [(95, set()), (105, {"tp", "urscript"}), (195, {"tp", "urscript"}), (205, set(CONTROLLERS))],
)
def test_a_turn_faster_than_is_usual_for_the_controller_is_a_warning(
    turn, warned, planned, plan_of, straight_down_tool, spoil
):
    plan = turning_plan(plan_of, planned, 100.0, straight_down_tool)
    fast = spoil(plan, settings=spoil(plan.settings, feed_plunge=turn / 100 * 20e-3))  # 100 deg over 20 mm
    assert {name for name in CONTROLLERS if findings(fast, "turn_speed", name)} == warned


@pytest.mark.parametrize(
    ("settings", "what"),
    [
        ({"feed_plunge": 0.9e-6}, "a feed of 0.0009 mm/s"),
        ({"blend": 0.9e-7}, "a blend of 9e-05 mm"),
        ({"feed_plunge": 1.1e-6, "blend": 1.1e-7}, None),
    ],
)
def test_what_the_decimals_of_a_program_cannot_hold(settings, what, published, plan_of):
    plan = plan_of(published(1), **settings)
    if what is None:
        assert len(read_krl(export(plan).text).holes) == 1
        return
    (finding,) = findings(plan, "printable")
    assert finding.message == f"{what} is too small for a program"
    with pytest.raises(NotExportableError, match="too small for a program"):
        export(plan)


def test_a_stroke_shorter_than_the_decimals(published, planned, plan_of):
    first = published(1)
    near = np.rad2deg(first.motion.joints[0])
    for depth, fine in ((0.9e-6, False), (1.1e-6, True)):
        psi = first.motion.profile.psi
        hole = planned(replace(first.hole, depth=depth), Profile.straight(depth, *psi[[1, 1, 1]]), near=near)
        found = findings(plan_of(hole, lead_in=0.0), "printable")
        assert bool(found) != fine


@pytest.mark.parametrize(("feed_mm_s", "short"), [(20, 0), (49, 0), (51, 1), (400, 2)])
def test_moves_shorter_than_two_cycles_of_a_controller(feed_mm_s, short, published, planned, plan_of):
    """A lead-in of 1.2 mm and a stroke of 5 mm: 24 ms at 50 and at 208 mm/s."""
    first = published(1)
    near, psi = [143, -108, -79, 11, 88, 217], np.deg2rad([5.0, 4.0, 3.0])
    hole = planned(replace(first.hole, depth=5e-3), Profile(np.array([5e-3, 0.0, 5e-3]), psi), near=near)
    plan = plan_of(hole, feed_plunge=feed_mm_s * 1e-3, feed_retract=1e-3, lead_in=1.2e-3, blend=0.0)
    found = findings(plan, "short_move")
    assert len(found) == (short > 0)
    if found:
        assert ("2 linear moves last" if short == 2 else "a linear move lasts") in found[0].message
        assert found[0].level == "warning"
        assert f"at {feed_mm_s} mm/s in the lead-in" in found[0].message


@pytest.mark.parametrize("controller", CONTROLLERS)
@pytest.mark.parametrize(("bends", "says"), [((-4.0,), "within 4 deg"), ((6.0,), ""), ((3.0, -20.0), "within 0 deg")])
def test_a_wrist_that_is_nearly_straight_is_said_for_every_controller(bends, says, controller, published, plan_of):
    """Of program points with these angles of joint 5; between two of them it passes 0."""
    plan = plan_of(published(1))
    program = build_program(plan)
    (hole,) = program.holes
    points = [np.array([0, -1.5, 1.5, 0, np.deg2rad(bend), 0]) for bend in bends]
    moves = [replace(move, end=replace(move.end, joints=points[-1])) for move in hole.moves]
    changed = replace(hole, start=replace(hole.start, joints=points[0]), moves=tuple(moves))
    found = [
        finding
        for finding in preflight(replace(program, holes=(changed,)), plan, CONTROLLERS[controller])
        if "straight wrist" in finding.message
    ]
    assert [(finding.level, finding.kind, finding.hole) for finding in found] == (
        [("warning", "controller", hole.id)] if says else []
    )
    assert all(says in finding.message for finding in found)
