"""What a job may ask that a controller cannot do: one clear error, or a finding, in every language."""

from dataclasses import replace

import numpy as np
import pytest

from oracles.makers import position_plan, stand_in
from zerorev.errors import NotExportableError
from zerorev.files.io import read_robot
from zerorev.program.dialects import DIALECTS
from zerorev.program.export import export
from zerorev.program.neutral import build_program

ROBOTS = {
    "krl": (lambda: read_robot("kuka_kr6_r700_2"), {}),
    "rapid": (lambda: stand_in("ABB"), {}),
    "tp": (lambda: stand_in("FANUC"), {"tool_number": 3}),
    "urscript": (lambda: stand_in("Universal Robots"), {}),
    "inform": (lambda: read_robot("yaskawa_ma2010"), {"tool_number": 3, "nearer": 0.85}),
}


def planned(controller, **settings):
    make, more = ROBOTS[controller]
    usual = {"controller": controller, "min_rate": float(np.deg2rad(10)), **more}
    return position_plan(make(), 2, **(usual | settings))


def test_a_tool_without_a_payload_is_refused_by_rapid():
    plan = planned("rapid")
    with pytest.raises(NotExportableError, match="mass_kg and com_mm in the tool file"):
        export(replace(plan, tool=replace(plan.tool, load=None)), version="x")


def test_a_robot_without_pulses_is_refused_by_inform():
    plan = planned("inform")
    with pytest.raises(NotExportableError, match="pulses_per_deg"):
        export(replace(plan, robot=replace(plan.robot, pulses_per_deg=None)), version="x")


@pytest.mark.parametrize("controller", ROBOTS)
def test_long_names_that_begin_alike_do_not_clash(controller):
    long = "the_upper_left_skin_of_the_panel_of_the_wing_"
    names = [DIALECTS[controller].program_name(long + end) for end in ("port", "starboard")]
    assert names[0] != names[1]
    plan = planned(controller)
    files = [export(plan, name=long + end, version="x").files[0].name for end in ("port", "starboard")]
    assert files[0].lower() != files[1].lower()


@pytest.mark.parametrize("controller", ROBOTS)
def test_a_feed_that_would_be_printed_as_zero_is_refused(controller):
    with pytest.raises(NotExportableError, match=r"rounds to zero|is too small for a program"):
        export(planned(controller, feed_plunge=1e-8), version="x")


@pytest.mark.parametrize("controller", ROBOTS)
def test_no_zone_takes_more_than_half_of_a_move(controller):
    """Of 60 mm, asked for a stroke of 20 mm: what is longer than a controller takes is cut here, where it is known."""
    plan = planned(controller, blend=60e-3)
    (hole,) = build_program(plan).holes
    lengths = [move.length for move in hole.moves]
    for n, move in enumerate(hole.moves[:-1]):
        assert move.blend <= 0.5 * min(lengths[n], lengths[n + 1]) * (1 + 1e-9)
    if plan.settings.turning.kind == "blend":
        assert any(finding.kind == "blend_clipped" for finding in export(plan, version="x").findings)
