"""RAPID programs: written, read back, equal to the plan within the digits, certified; followed by another reader."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from oracles import rapid_reader
from oracles.makers import free_leg_plan, panel_plan, position_plan, stand_in
from zerorev.files.io import plan_from_text, plan_to_json, read_robot
from zerorev.files.text import json_text
from zerorev.model.cycle import Cycle
from zerorev.model.job import Settings
from zerorev.program.as_exported import as_exported
from zerorev.program.export import export
from zerorev.program.rapid.dialect import RAPID
from zerorev.verify.certificate.program import certify_program

IRB = "abb_irb1200_5_90"
SLOWEST = Settings().min_rate  # with no threshold a joint may all but rest where the stroke ends


def robot_of(name):
    return stand_in("ABB") if name == "stand-in" else read_robot(name)


PLANS = {
    **{f"{name} {n}": (lambda name=name, n=n: position_plan(robot_of(name), n, min_rate=SLOWEST))
       for name in ("stand-in", IRB) for n in (1, 2, 3)},
    "IRB 4600": lambda: position_plan(read_robot("abb_irb4600_60_205"), 2, min_rate=SLOWEST),
    **{f"IRB 6640 {n}": (lambda n=n: position_plan(read_robot("abb_irb6640_185_280"), n, min_rate=SLOWEST))
       for n in (1, 2)},
    "free legs": lambda: free_leg_plan(read_robot(IRB), min_rate=SLOWEST),
    "free legs, stand-in": lambda: free_leg_plan(stand_in("ABB")),
    "blend": lambda: position_plan(read_robot(IRB), 1, corner="blend", controller="rapid"),
    "chips broken": lambda: position_plan(read_robot(IRB), 1, cycle=Cycle("chip_break", 10e-3, 0.3e-3)),
    "chips broken, stand-in": lambda: position_plan(stand_in("ABB"), 1, cycle=Cycle("chip_break", 5e-3, 1e-3)),
    "the last of the way in": lambda: position_plan(
        read_robot(IRB), 1, breakthrough_length=2e-3, breakthrough_feed=1e-3, feed_plunge=3e-3
    ),
    "stop": lambda: position_plan(read_robot(IRB), 1, blend=0.0),
    "long joint moves": lambda: position_plan(read_robot(IRB), 1, blend=2e-3, deepen_corner=True),
    "no lead-in": lambda: position_plan(read_robot(IRB), 1, lead_in=0.0),
    "one feed": lambda: position_plan(read_robot(IRB), 1, feed_plunge=7e-3, feed_retract=7e-3),
    "in the air": lambda: position_plan(read_robot(IRB), 1, approach=10e-3, retract=15e-3),
}  # fmt: skip


def proofs(plan, exported):
    """After plan and program were read from files."""
    in_file = plan_from_text(json_text(plan_to_json(plan)), "plan.json")
    program = RAPID.read(exported.files)
    drilled = as_exported(in_file, program, RAPID)
    return [hole.certificate for hole in certify_program(in_file, program, drilled).holes]


@pytest.mark.parametrize("name", PLANS)
def test_written_read_back_and_certified(name):
    plan = PLANS[name]()
    exported = export(plan, "rapid")
    assert [(proof.verdict, proof.reasons) for proof in proofs(plan, exported)] == [("certified", ())]
    follow(plan, exported)


def test_a_panel_of_sixty_holes():
    plan = panel_plan(read_robot(IRB), 60)
    exported = export(plan, "rapid")
    found = proofs(plan, exported)
    assert len(found) == 60
    assert {proof.verdict for proof in found} == {"certified"}
    follow(plan, exported, samples=8)


def test_on_a_tilted_part():
    T = np.eye(4)
    T[:3, :3], T[:3, 3] = Rotation.from_euler("ZYX", (25, -40, 15), degrees=True).as_matrix(), (0.3, 0.2, 0.1)
    plan = replace(position_plan(read_robot(IRB), 1), T_base_part=T)
    exported = export(plan, "rapid")
    assert [proof.reasons for proof in proofs(plan, exported)] == [()]
    follow(plan, exported)


def follow(plan, exported, samples=50):
    """Another reader's moves: on the drill axis, at the feeds, monotone in every joint, and in the stated posture."""
    module, arm = rapid_reader.read(exported.text), rapid_reader.Arm(plan.robot)
    holes = module.holes()
    assert len(holes) == len(plan.holes)
    np.testing.assert_allclose(module.tool[:3, 3], plan.tool.T_flange_tcp[:3, 3] * 1e3, atol=1e-4)
    np.testing.assert_allclose(module.tool[:3, 2], -plan.tool.T_flange_tcp[:3, 2], atol=1e-7)
    np.testing.assert_allclose(module.part[:3, 3], plan.T_base_part[:3, 3] * 1e3, atol=1e-4)
    settings = plan.settings
    for own, hole in zip(plan.in_order, holes, strict=True):
        joints = rapid_reader.joints_of_hole(module, hole, arm, samples)
        target, direction = own.hole.target * 1e3, own.hole.direction
        depths = []
        for move, way in zip(hole[1:], joints, strict=True):
            T = np.array([arm.forward(each) @ module.tool for each in way])
            off = np.linalg.norm(np.cross(T[:, :3, 3] - target, direction), axis=1)
            # what is said of the joint moves, and round-off
            assert off.max() < (own.corner.off_axis * 1e3 if move.kind == "MoveAbsJ" else 0) + 3e-4
            depths.append((target - T[[0, -1], :3, 3]) @ direction)
            length = abs(depths[-1][0] - depths[-1][1])
            if move.conf:
                check_posture(move, way[-1], own.motion.branch)
            zone_is_whole(move, length, way, T)
        stroke = np.array(depths)
        check_feeds(settings, own.hole.depth, hole[1:], stroke)
        assert stroke.min() == pytest.approx(own.motion.profile.standoff.min() * 1e3, abs=2e-4)
        inside = [way for way, (a, b) in zip(joints, depths, strict=True) if min(a, b) < own.hole.depth * 1e3 - 1e-3]
        steps = np.diff(np.concatenate([inside[0], *(way[1:] for way in inside[1:])]), axis=0)
        assert not ((steps > 1e-6).any(axis=0) & (steps < -1e-6).any(axis=0)).any()


def check_feeds(settings, depth, moves, depths):
    """Up to the deepest point the plunge's, back and forth; at last that of the breakthrough; then the retract's."""
    for k, (move, (begin, end)) in enumerate(zip(moves, depths, strict=True)):
        if max(begin, end) > (depth + settings.lead_in) * 1e3 + 1e-3:
            continue  # in the air
        feed = settings.feed_plunge if k <= np.argmin(depths[:, 1]) else settings.feed_retract
        if feed == settings.feed_plunge and settings.breakthrough_feed and end < begin:
            feed = settings.breakthrough_feed if begin <= settings.breakthrough_length * 1e3 + 1e-3 else feed
        assert (abs(begin - end) / move.time if move.time else move.speed[0]) == pytest.approx(feed * 1e3, abs=2e-2)


def check_posture(move, joints, branch):
    quadrants = np.floor(joints[[0, 3, 5]] / 90)
    near = np.abs(joints[[0, 3, 5]] / 90 - np.round(joints[[0, 3, 5]] / 90)) < 1e-4
    assert ((quadrants == move.conf[:3]) | near).all()
    assert move.conf[3] == branch


def zone_is_whole(move, length, way, T):
    """No zone is cut: equal radii, at most half the move, and a smaller share of it than its angle is of the turn."""
    if move.zone is None:
        return
    radius, *others = move.zone
    assert others[:2] + others[3:] == [radius] * 4
    assert radius <= length / 2 + 1e-3
    turn = np.rad2deg(np.linalg.norm(Rotation.from_matrix(T[-1, :3, :3] @ T[0, :3, :3].T).as_rotvec()))
    assert others[2] / max(turn, 1e-9) > radius / length
    assert move.speed[1] > 1.2 * turn / length * move.speed[0] - 1e-3


def test_the_corner_is_two_joint_moves_that_keep_their_direction():
    plan = position_plan(read_robot(IRB), 1)
    module = rapid_reader.read(export(plan, "rapid").text)
    (hole,) = module.holes()
    kinds = [move.kind for move in hole]
    assert kinds == ["MoveAbsJ", "MoveL", "MoveL", "MoveAbsJ", "MoveAbsJ", "MoveL"]
    assert [move.time for move in hole[3:5]] == [0.2, 0.05]
    assert [move.zone is None for move in hole] == [True, False, False, False, False, True]
    assert [move.zone[0] for move in hole[1:5]] == [1.0, 0.5, 0.5, 0.5]


def test_the_corner_is_said_to_be_open_where_it_is():
    robot = read_robot(IRB)
    for corner, words in (("blend", "is not known"), ("stop", "all joints rest")):
        blend = 0.0 if corner == "stop" else 1e-3
        exported = export(position_plan(robot, 1, corner=corner, blend=blend, controller="rapid"))
        assert any(f.kind == "controller" and f.level == "warning" and words in f.message for f in exported.findings)
    assert "Open: that none stops" in " ".join(export(position_plan(robot, 1)).text.replace("!", "").split())


def test_the_last_bits_of_a_plan_make_no_difference():
    """Position 1 of the stand-in has axis 4 at 0 where it turns round, and quaternions with equal numbers."""
    plan = position_plan(stand_in("ABB"), 1)
    in_file = plan_from_text(json_text(plan_to_json(plan)), "plan.json")
    text = export(plan, version="same").text
    assert rapid_reader.commands(export(in_file, version="same").text) == rapid_reader.commands(text)
