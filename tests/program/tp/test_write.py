"""TP programs: points, postures, speeds and comments, held to the plan by a reader and an arm of the tests' own."""

import re
from dataclasses import replace

import numpy as np
import pytest

from oracles import arm
from oracles.makers import free_leg_plan, panel_plan, position_plan, stand_in
from oracles.tp_reader import motions, remarks, statements
from zerorev.errors import NotExportableError
from zerorev.files.io import plan_from_text, plan_to_json, read_robot
from zerorev.files.text import json_text
from zerorev.model.controller import Call, Calls, ExternalAxis
from zerorev.model.job import Job
from zerorev.model.profile import Profile
from zerorev.planning.job import plan_job
from zerorev.program.as_exported import as_exported
from zerorev.program.export import export, retract_program
from zerorev.program.names import digest
from zerorev.program.neutral import build_program
from zerorev.program.tp.dialect import TP
from zerorev.program.tp.text import configuration, joint_time, tip_speed

DOWN = np.diag([1.0, -1.0, -1.0, 1.0])  # from the tcp frame to the tool frame, Z along the plunge


def written(plan, **wanted):
    return export(plan, version="test", **wanted).text


def hold(plan, text, *, user=0, coupled=1, height=0.33, near=30e-6):
    """Every point to the plan: by pose as it is seen from the controller's base, by joints through the arm."""
    T_root_base = np.eye(4)
    T_root_base[2, 3] = height
    T_flange_tcp, moved = plan.tool.T_flange_tcp, iter(motions(text))
    for hole in build_program(plan).holes:
        points = [hole.start, *(move.end for move in hole.moves)]
        for _ in hole.way:
            assert next(moved).kind == "J"
        of = next(each.hole for each in plan.holes if each.hole.id == hole.id)
        for k, point in enumerate(points):
            motion = next(moved)
            meant = arm.drill_pose(of, point.standoff, point.psi)
            assert motion.frames == (user, 3)
            if motion.kind == "J":
                found, off = arm.forward(plan.robot, motion.turning_joints(coupled)) @ T_flange_tcp, near
            else:
                frame = plan.T_base_part if user else T_root_base
                pose = motion.pose.copy()
                pose[:3, 3] *= 1e-3
                found, off = frame @ pose @ DOWN, 1.0e-6
            assert np.linalg.norm(found[:3, 3] - meant[:3, 3]) < off
            turned = np.linalg.norm(arm.error_twist(found, meant)[3:])
            assert turned < np.deg2rad(0.003 if motion.kind == "J" else 0.0015), k
    return motions(text)


@pytest.mark.parametrize("number", [1, 2, 3])
def test_positions(number, fanuc, for_tp, certificates):
    plan = position_plan(fanuc, number, **for_tp)
    exported = export(plan, version="test")
    moved = hold(plan, exported.text)
    assert [move.kind for move in moved] == ["J", *["L"] * (len(moved) - 4), "J", "J", "L"]
    assert [move.end for move in moved] == ["FINE", *["CNT100"] * (len(moved) - 2), "FINE"]
    assert [(each.verdict, each.reasons) for each in certificates(plan, exported)] == [("certified", ())]
    assert statements(exported.text) == ["UFRAME_NUM=0", "UTOOL_NUM=3"]


@pytest.mark.parametrize("name", ["fanuc_m710ic_50", "fanuc_r2000ic_165f"])
def test_larger_arms(name, for_tp, certificates):
    plan = position_plan(read_robot(name), 2, **for_tp)
    exported = export(plan, version="test")
    hold(plan, exported.text, height=plan.robot.arm.c1, near=60e-6)
    assert [(each.verdict, each.reasons) for each in certificates(plan, exported)] == [("certified", ())]


def test_free_legs_in_a_user_frame(fanuc, for_tp, certificates):
    T = np.eye(4)
    T[:3, :3], T[:3, 3] = [[0, -1, 0], [1, 0, 0], [0, 0, 1]], (0.4, -0.1, 0.3)
    plan = replace(free_leg_plan(fanuc, base_number=2, **for_tp), T_base_part=T)
    exported = export(plan, version="test")
    hold(plan, exported.text, user=2)
    assert [each.verdict for each in certificates(plan, exported)] == ["certified"]
    said = " ".join(" ".join(remarks(exported.text)).split())
    # 0.3 m above the arm's base is 30 mm below axis 2, from which the controller counts
    assert (
        "UFRAME 2 is selected, not set. It must hold X 400.000, Y -100.000, Z -30.000, W 0.000, P 0.000, R 90.000"
        in said
    )


def test_a_part_frame_of_the_world_frame(fanuc, for_tp, certificates):
    T = np.eye(4)
    T[:3, 3] = 0.1, 0.2, 0.3
    plan = replace(position_plan(fanuc, 1, **for_tp), T_base_part=T)
    exported = export(plan, version="test")
    hold(plan, exported.text)
    assert [each.verdict for each in certificates(plan, exported)] == ["certified"]


def test_an_arm_that_shows_what_turns(for_tp, certificates):
    """A robot file without display and base is written as it stands, with two warnings."""
    plan = position_plan(stand_in("FANUC"), 1, **for_tp)
    exported = export(plan, version="test")
    hold(plan, exported.text, coupled=0, height=0.0)
    assert [each.verdict for each in certificates(plan, exported)] == ["certified"]
    said = [finding.message for finding in exported.findings if finding.kind == "controller"]
    assert [("j3_less_j2" in text, "base_in_root" in text) for text in said] == [(True, False), (False, True)]


@pytest.mark.parametrize("count", [12, pytest.param(60, marks=pytest.mark.long)])
def test_panel(count, fanuc, for_tp, certificates):
    plan = panel_plan(fanuc, count, **for_tp)
    assert {hole.status for hole in plan.holes} == {"planned"}
    exported = export(plan, version="test")
    assert len(exported.files) == 1
    hold(plan, exported.text)
    assert {each.verdict for each in certificates(plan, exported)} == {"certified"}


@pytest.mark.parametrize("most", [5, 6])
def test_a_panel_in_parts(most, fanuc, for_tp, certificates):
    calls = Calls((Call("CLAMP", ("1",)),), (Call("RUN", ("6000", '"cw"')),), (Call("REST"),), (Call("CLAMP", ("0",)),))
    plan = panel_plan(fanuc, 12, **for_tp)
    plan = replace(plan, settings=replace(plan.settings, calls=calls, holes_per_program=most))
    exported = export(plan, version="test", name="PANEL")
    parts = [f"PANEL_{n}" for n in range(1, -(-12 // most) + 1)]
    assert [file.name for file in exported.files] == ["PANEL.ls", *(f"{part}.ls" for part in parts)]
    assert statements(exported.text) == ["CALL CLAMP(1)", *(f"CALL {part}" for part in parts), "CALL CLAMP(0)"]
    assert statements(exported.files[1].text)[:4] == [
        "UFRAME_NUM=0",
        "UTOOL_NUM=3",
        "CALL RUN(6000, 'cw')",
        "CALL REST",
    ]
    assert {each.verdict for each in certificates(plan, exported, "PANEL")} == {"certified"}
    whole = replace(plan, settings=replace(plan.settings, holes_per_program=None))
    in_parts = [move for file in exported.files[1:] for move in motions(file.text)]
    for one, other in zip(in_parts, motions(written(whole)), strict=True):
        assert one._replace(values=()) == other._replace(values=())
        assert np.array_equal(one.values, other.values)


def test_calls_in_one_file(fanuc, for_tp, certificates):
    calls = Calls((Call("CLAMP"),), (Call("RUN"),), (Call("REST"),), (Call("COUNT", ("1",)), Call("OPEN")))
    plan = panel_plan(fanuc, 12, **for_tp)
    plan = replace(plan, holes=plan.holes[:3], settings=replace(plan.settings, calls=calls))
    exported = export(plan, version="test")
    assert statements(exported.text)[2:] == ["CALL CLAMP", *["CALL RUN", "CALL REST"] * 3, "CALL COUNT(1)", "CALL OPEN"]
    assert {each.verdict for each in certificates(plan, exported)} == {"certified"}


def test_large_programs_are_split(fanuc, for_tp, spoil):
    """Not more than 1,000 positions and 9,999 lines a file."""
    program = build_program(panel_plan(fanuc, 12, **for_tp))
    most = TP.most_holes(program)
    many = spoil(program, holes=tuple(program.holes[k % 12] for k in range(most)))
    (file,) = TP.write(many, "LARGE", (), "test")
    positions, lines = file.text.count("GP1:"), len(re.findall(r"^ *\d+:", file.text, re.MULTILINE))
    assert 700 < positions <= 1000
    assert lines <= 9_999


def test_parts_that_a_controller_may_not_load(fanuc, for_tp, spoil):
    program = build_program(panel_plan(fanuc, 12, **for_tp))
    most = TP.most_holes(program)
    many = spoil(program, holes=tuple(program.holes[k % 12] for k in range(most + 1)))
    (said,) = [each.message for each in TP.examine(many) if "may not load" in each.message]
    assert said.endswith(f"holes_per_program of {most} or less")
    assert not [each for each in TP.examine(spoil(many, parts=(most, 1))) if "may not load" in each.message]


def test_comments_fit(fanuc, for_tp):
    text = written(position_plan(fanuc, 1, **for_tp))
    lines = remarks(text)
    assert max(map(len, lines)) == 32
    assert len(lines) > 50
    assert text.isascii()


@pytest.mark.parametrize("spins", [(20.0, 0.0, -25.0), (0.0, -20.0, -45.0), (90.0, 70.0, 45.0)])
def test_of_a_plan_in_memory_and_in_its_file(spins, fanuc, for_tp, spoil):
    """At a spin of 0 X of the tool points straight up, where W and R turn about one line; last bits must not decide."""
    first = position_plan(fanuc, 1, **for_tp)
    hole = spoil(first.holes[0].hole, profile=Profile.straight(first.holes[0].hole.depth, *np.deg2rad(spins)))
    plan = plan_job(Job(fanuc, first.tool, (hole,), first.settings, name="given"))
    assert plan.holes[0].motion is not None
    text = TP.write(build_program(spoil(plan, holes=(spoil(plan.holes[0], findings=()),))), "GIVEN", (), "test")
    in_file = plan_from_text(json_text(plan_to_json(plan)), "plan.json")
    assert [own.wrong for own in as_exported(in_file, TP.read(text), TP, "GIVEN")] == [()]


# --- numbers ----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("feed_mm_s", "said"),
    [
        (5, "5mm/sec"),
        (2000, "2000mm/sec"),
        (0.5, "3cm/min"),
        (2.17, "13cm/min"),
        (2.5, "15cm/min"),
        (0.0834, "1cm/min"),
    ],
)
def test_speeds_of_the_tip(feed_mm_s, said):
    assert str(tip_speed(feed_mm_s * 1e-3)) == said


@pytest.mark.parametrize(("time", "said"), [(0.2, "200msec"), (0.0125, "12msec"), (0.0004, "0msec")])
def test_times_of_joint_moves(time, said):
    assert str(joint_time(time)) == said


@pytest.mark.parametrize(("plunge", "retract"), [(2.17e-3, 20e-3), (0.3e-3, 7.7e-3), (5e-3, 33.3e-3)])
def test_feeds_that_are_rounded(plunge, retract, fanuc, for_tp, certificates):
    plan = position_plan(fanuc, 1, feed_plunge=plunge, feed_retract=retract, **for_tp)
    exported = export(plan, version="test")
    assert [(each.verdict, each.reasons) for each in certificates(plan, exported)] == [("certified", ())]
    said = {finding.message: finding.level for finding in exported.findings if finding.kind == "controller"}
    for move in motions(exported.text):
        value, unit = move.speed
        found = {"mm/sec": value * 1e-3, "cm/min": value * 1e-2 / 60}.get(unit)
        share = 0 if found is None else min(abs(found / plunge - 1), abs(found / retract - 1))
        if share > 1e-6:
            assert any(
                f"written as {value}{unit}" in text and level == ("warning" if share > 0.01 else "info")
                for text, level in said.items()
            )


@pytest.mark.parametrize(
    ("turned", "letters"),
    [
        ([0, 0, 0, 0, -90, 0], "N U T, 0, 0, 0"),  # the posture in which a FANUC is shipped
        ([0, 0, 0, 0, 90, 0], "F U T, 0, 0, 0"),
        ([10, 20, 30, 185, -60, -190], "N U T, 1, 0, -1"),
        ([10, 20, 30, 180, -60, -180], "N U T, 1, 0, -1"),
        ([10, 20, 30, 179.9, -60, 540], "N U T, 0, 0, 2"),
    ],
)
def test_letters_of_the_posture(turned, letters, fanuc):
    assert configuration(fanuc, np.deg2rad(np.array(turned, dtype=float))) == letters


def test_letters_of_elbow_and_shoulder(fanuc):
    """By the places of shoulder, elbow and wrist, as the arm of the tests has them."""
    rng, seen = np.random.default_rng(0), set()
    for joints in rng.uniform(fanuc.limits.lower, fanuc.limits.upper, (400, 6)):
        shoulder, elbow, wrist = map(np.asarray, arm.points_of_arm(fanuc, joints))
        behind = wrist[0] < 0
        line, upper = wrist - shoulder, elbow - shoulder
        leans = line[1] * upper[0] - line[0] * upper[1]  # above 0: the upper arm leans further ahead than the line
        below = leans > 0 if not behind else leans < 0
        letters = configuration(fanuc, joints)
        assert letters[2:5] == f"{'UD'[int(below)]} {'TB'[int(behind)]}"
        seen.add(letters[:5])
    assert len(seen) == 8


# --- what is refused --------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("change", "why"),
    [
        ({"tool_number": None}, "set tool_number in the job"),
        ({"header": ("&PARAM EDITMASK = *",)}, "header is set in the job, but a header of KRL"),
        ({"robroot": "$ROBROOT"}, "robroot is set"),
        ({"robroot": (0.0, 0.0, 1.0, 0.0, 0.0, 0.0)}, "robroot is set"),
        ({"external_axes": (ExternalAxis("E1", 100.0),)}, "external_axes is set"),
        ({"calls": Calls(before_hole=(Call("RUN", ("TRUE",)),))}, "arguments in TP are numbers from 0 on"),
        ({"calls": Calls(before_hole=(Call("RUN", ("-1",)),))}, "arguments in TP are numbers from 0 on"),
        ({"calls": Calls(after_hole=(Call("SELF"),))}, "SELF, called after each hole, is this program itself"),
        ({"feed_plunge": 0.05e-3}, "the feed of 0.05 mm/s rounds to zero"),
        ({"feed_retract": 3.0}, "is above 2000 mm/s"),
    ],
    ids=str,
)
def test_what_tp_cannot_say(change, why, fanuc, for_tp):
    plan = position_plan(fanuc, 1, **for_tp)
    plan = replace(plan, settings=replace(plan.settings, **change))
    with pytest.raises(NotExportableError, match=re.escape(why)):
        TP.write(build_program(plan), "SELF", (), "test")


def test_another_makers_robot(kuka, for_tp):
    with pytest.raises(NotExportableError, match="TP runs on FANUC controllers alone"):
        export(position_plan(kuka, 1, min_rate=0.0), "tp")


def test_names_are_cut_and_do_not_clash(fanuc, for_tp):
    plan = position_plan(fanuc, 1, **for_tp)
    assert export(plan, name="panel").name == "PANEL"
    names = [export(plan, name=name).name for name in ("panel_upper_skin", "panel_upper_skin_2", "panel_lower_skin")]
    assert len(set(names)) == 3
    assert names[0] == f"P_{digest('panel_upper_skin').upper()}"
    assert all(re.fullmatch("[A-Z][A-Z0-9_]{0,7}", name) for name in names)


def test_joints_that_decimals_bring_to_rest(fanuc, for_tp):
    plan = position_plan(fanuc, 1, **(for_tp | {"min_rate": 0.0}))
    found = [
        each.message for each in export(plan, version="test").findings if "decimals of joint values" in each.message
    ]
    moved = motions(written(plan))
    corner = [move.values for move in moved if move.kind == "J"][1:]
    still = [f"J{k + 1}" for k in range(6) if abs(corner[1][k] - corner[0][k]) < 5e-4]
    assert bool(found) >= bool(still)
    for name in still:
        assert name in found[0]


def test_no_way_out_of_a_hole_is_written_and_it_says_why(fanuc, for_tp):
    with pytest.raises(
        NotExportableError, match=r"not offered in TP.*registers.*belong to somebody; jog the drill out"
    ):
        retract_program(position_plan(fanuc, 1, **for_tp), "position 1", "tp")
