"""What URScript asks of a program: settings of other makers, blends that meet, payload, blends of straight moves."""

from dataclasses import replace

import pytest

from zerorev.errors import InputError, NotExportableError
from zerorev.model.controller import Call, Calls, ExternalAxis
from zerorev.model.dynamics import Load
from zerorev.program.export import export
from zerorev.program.neutral import build_program
from zerorev.program.urscript.examine import examine, most_holes


@pytest.fixture(scope="module")
def plan(plan_called):
    return plan_called("position 1")


def with_settings(plan, **settings):
    return replace(plan, settings=replace(plan.settings, **settings))


def refused(plan):
    with pytest.raises(NotExportableError) as refusal:
        export(plan)
    (reason,) = refusal.value.reasons
    return reason


@pytest.mark.parametrize(
    ("settings", "word"),
    [
        ({"header": ("&PARAM EDITMASK = *",)}, "header"),
        ({"robroot": "$ROBROOT"}, "robroot"),
        ({"robroot": (0.0,) * 6}, "robroot"),
        ({"external_axes": (ExternalAxis("E1", 100.0),)}, "external_axes"),
        ({"tool_number": 3}, "tool_number"),
        ({"base_number": 3}, "base_number"),
    ],
)
def test_settings_that_have_no_form(settings, word, plan):
    reason = refused(with_settings(plan, **settings))
    assert reason.startswith(f"{word} cannot be written in URScript: ")
    assert "take it out of the job" in reason


@pytest.mark.parametrize(
    ("call", "why"),
    [
        (Call("movej", ("1",)), "moves the robot"),
        (Call("set_tcp"), "changes how it moves"),
        (Call("freedrive_mode"), "moves the robot"),
        (Call("end"), "a word of URScript"),
        (Call("position_1"), "is this program itself"),
        (Call("spin", ("#FAST",)), "begins a comment"),
        (Call("say", ('"hole #1"',)), "begins a comment"),
    ],
)
def test_calls_that_are_refused(call, why, plan):
    assert why in refused(with_settings(plan, calls=Calls(before_hole=(call,))))


def test_outputs_may_be_called(plan):
    calls = Calls(after_hole=(Call("set_standard_digital_out", ("0", "TRUE")),))
    assert "\n  set_standard_digital_out(0, True)\n" in export(with_settings(plan, calls=calls)).text


def test_blends_that_meet_would_leave_a_move_out(plan):
    """Half of the shorter move at both of its ends, as a plan for no controller would have it."""
    program = build_program(plan)
    (hole,) = program.holes
    assert not [finding for finding in examine(program) if finding.level == "error"]
    moves = tuple(replace(move, blend=0.5e-3 if move.blend == 0.45e-3 else move.blend) for move in hole.moves)
    moves = tuple(replace(move, blend=0.5e-3) if 0 < move.blend < 0.6e-3 else move for move in moves)
    (error,) = [
        each for each in examine(replace(program, holes=(replace(hole, moves=moves),))) if each.level == "error"
    ]
    assert "take 1 mm of it: the controller skips such a move, and the hole would not be drilled" in error.message
    assert error.hole == "position 1"


def test_a_plan_for_no_controller_is_not_written_as_it_is(plan):
    """Its blends take half of a move, which is more than blends that must not meet may take."""
    old = with_settings(plan, controller=None, corner="joint", blend=1e-3)
    assert "the controller skips such a move" in refused(old)


def test_what_is_not_known_is_a_warning(plan, plan_called):
    def warnings(plan):
        return [each.message for each in export(plan).findings if each.kind == "controller"]

    assert not warnings(plan)
    (blend,) = warnings(plan_called("position 1", corner="blend"))
    assert "not to be trusted" in blend
    (legs,) = warnings(plan_called("free leg"))
    assert "legs: straight" in legs


def test_a_payload_that_is_not_known(plan):
    export_of = export(replace(plan, tool=replace(plan.tool, load=None)))
    assert "set_payload(" not in export_of.text
    assert [each.level for each in export_of.findings if "mass_kg" in each.message] == ["warning"]
    assert "Spindle, coolant and payload are not set here" in " ".join(export_of.text.replace("#", "").split())
    with pytest.raises(InputError, match="a mass that is not above 0"):
        Load(0.0, plan.tool.load.com, plan.tool.load.inertia)


def test_holes_of_a_file(plan):
    program = build_program(plan)
    assert most_holes(program) == 250 // 6
    (hole,) = program.holes
    assert most_holes(replace(program, holes=(replace(hole, moves=60 * hole.moves),))) == 1


def test_other_makers_robots_are_refused(plan):
    assert "URScript runs on Universal Robots controllers alone" in refused(
        replace(
            plan, robot=replace(plan.robot, manufacturer="KUKA"), settings=replace(plan.settings, controller="urscript")
        )
    )
