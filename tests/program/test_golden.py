"""Programs of all five languages, byte for byte: a panel of 60 holes, a free leg, and a hole in which chips are broken.

Of each the digests of its files are kept, and the beginning of the first. A difference is read as a safety review; to
write them again after such a review: `ZEROREV_WRITE_GOLDEN=1 pytest tests/program/test_golden.py`.
"""

import hashlib
import os
from dataclasses import replace

import numpy as np
import pytest

from oracles.makers import free_leg_plan, panel_plan, position_plan, stand_in
from oracles.places import GOLDEN
from zerorev.files.io import read_robot
from zerorev.model.cycle import Cycle
from zerorev.model.profile import Profile
from zerorev.planning.hole import plan as plan_hole
from zerorev.program.export import export

SHOWN = 130  # lines
ROBOTS = {
    "krl": (lambda: read_robot("kuka_kr6_r700_2"), 1.0, {}),
    "rapid": (lambda: stand_in("ABB"), 1.0, {}),
    "tp": (lambda: stand_in("FANUC"), 1.0, {"tool_number": 3}),
    "urscript": (lambda: stand_in("Universal Robots"), 1.0, {}),
    "inform": (lambda: read_robot("yaskawa_ma2010"), 0.85, {"tool_number": 3}),
}
THRESHOLD = float(np.deg2rad(10))  # [rad/m] 0.01 deg/mm
WHATS = [
    pytest.param("panel", marks=pytest.mark.long),
    "free leg",
    "chip break",
]


def planned(controller, what):
    make, nearer, more = ROBOTS[controller]
    settings = {"controller": controller, "min_rate": THRESHOLD, "limit_margin": np.deg2rad(0.1), **more}
    if what == "free leg":
        return free_leg_plan(make(), **settings)
    if what == "panel":
        return panel_plan(make(), 60, nearer=nearer, **settings)
    return position_plan(make(), 2, nearer=nearer, cycle=Cycle("chip_break", 5e-3, 0.3e-3), **settings)


def to_few_digits(plan):
    """The plan with motions of few digits, so that the last bits of a search, which machines vary, do not count."""
    holes = []
    for answer in plan.holes:
        profile = answer.motion.profile
        given = Profile(np.round(profile.standoff, 9), np.deg2rad(np.round(np.rad2deg(profile.psi), 4)))
        hole = replace(answer.hole, profile=given, branch=answer.motion.branch)
        holes.append(plan_hole(plan.robot, plan.tool, hole, plan.settings))
        assert holes[-1].score.reversals == 0
    return replace(plan, holes=tuple(holes))


@pytest.mark.parametrize("what", WHATS)
@pytest.mark.parametrize("controller", ROBOTS)
def test_the_program_is_the_same_to_the_last_byte(controller, what):
    exported = export(to_few_digits(planned(controller, what)), controller, version="golden")
    digests = [f"{hashlib.sha256(file.text.encode('ascii')).hexdigest()} {file.name}" for file in exported.files]
    begin = exported.files[0].text.split("\n")[:SHOWN]
    found = "\n".join([*digests, "", *begin, ""])
    path = GOLDEN / f"{controller}_{what.replace(' ', '_')}.txt"
    if os.environ.get("ZEROREV_WRITE_GOLDEN"):
        path.write_text(found, encoding="ascii", newline="\n")
    assert path.read_text(encoding="ascii") == found
