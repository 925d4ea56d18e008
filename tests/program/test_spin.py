"""A tool that spins on at the target: in every language with timed joint moves written, read back, and proven."""

import re

import numpy as np
import pytest

from oracles.makers import position_plan, stand_in
from zerorev.errors import InputError
from zerorev.files.io import read_robot
from zerorev.model.cycle import Cycle
from zerorev.program.as_exported import as_exported
from zerorev.program.dialect import ProgramFile
from zerorev.program.dialects import DIALECTS
from zerorev.program.export import export
from zerorev.verify.certificate.program import certify_program, certify_program_hole

THRESHOLD = float(np.deg2rad(10))  # [rad/m]
MARGIN = float(np.deg2rad(0.1))  # [rad]
ROBOTS = {
    "rapid": lambda: stand_in("ABB"),
    "tp": lambda: read_robot("fanuc_lrmate200id"),
    "urscript": lambda: stand_in("Universal Robots"),
    "inform": lambda: read_robot("yaskawa_ma2010"),
}
NEEDED = {"tp": {"tool_number": 3}, "inform": {"tool_number": 3, "nearer": 0.85}}
KINDS = {
    "one move": Cycle(dwell=0.2, moving=True),
    "several moves": Cycle(dwell=0.8, moving=True),
    "chips broken": Cycle("chip_break", 10e-3, 0.3e-3, dwell=0.2, moving=True),
}


def plan_of(name, cycle, **settings):
    chosen = {"min_rate": THRESHOLD, "limit_margin": MARGIN, "cycle": cycle} | NEEDED.get(name, {}) | settings
    return position_plan(ROBOTS[name](), 1, **chosen)


def read(name, text):
    return DIALECTS[name].read((ProgramFile(f"here{DIALECTS[name].suffix}", text),))


def alone(name, plan, text):
    """The certificate without the comparison, statement by statement, with what `export` writes."""
    program = read(name, text)
    return certify_program_hole(plan, plan.holes[0], program, program.holes[0])


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("name", ROBOTS)
def test_written_read_back_and_certified(name, kind):
    plan = plan_of(name, KINDS[kind])
    (hole,) = plan.holes
    exported = export(plan)
    program = DIALECTS[name].read(exported.files)
    (written,) = program.holes
    jointly = [k for k, move in enumerate(written.moves) if not move.linear]
    # one in, those on which it spins on, one out; blended all of them, and nothing waits
    assert jointly[-hole.corner.spin_moves - 2 :] == list(
        range(jointly[-1] - hole.corner.spin_moves - 1, jointly[-1] + 1)
    )
    assert not any(move.stops or move.wait for move in written.moves[:-1])
    (proven,) = certify_program(plan, program, as_exported(plan, program, DIALECTS[name])).holes
    assert (proven.certificate.verdict, proven.certificate.reasons) == ("certified", ())


SPUN = {  # the time of a joint move on which the tool spins on, and another
    "rapid": (r"(feed_0_100\\T:=)0\.200000", r"\g<1>0.190000"),
    "tp": (r"(J P\[5\] )200msec", r"\g<1>190msec"),
    "urscript": (r"(t=)0\.2000000(, r=[\d.]+\) # target)", r"\g<1>0.1900000\g<2>"),
    "inform": (r"(MOVJ C00004 VJ=)(\d\.\d\d)", r"\g<1>0.80"),
}


@pytest.mark.parametrize("name", ROBOTS)
def test_another_time_and_another_place_are_refuted_by_the_moves_alone(name):
    plan = plan_of(name, KINDS["one move"])
    text = export(plan).text
    assert alone(name, plan, text).verdict == "certified"
    changed, count = re.subn(*SPUN[name], text, count=1)
    assert count == 1
    certificate = alone(name, plan, changed)
    assert certificate.verdict == "refuted"
    assert any("on which the tool is to spin on for 0.2 s" in reason for reason in certificate.reasons)


def test_a_stop_before_the_spin_is_refuted():
    plan = plan_of("tp", KINDS["one move"])
    text = export(plan).text
    stopped = re.sub(r"(J P\[4\] 200msec) CNT100", r"\1 FINE  ", text)
    assert stopped != text
    (reason,) = alone("tp", plan, stopped).reasons
    assert "stops, the plan asks for" in reason


def test_without_the_spin_it_is_another_program():
    plan = plan_of("urscript", KINDS["one move"])
    lines = export(plan).text.split("\n")
    kept = [line for line in lines if not line.endswith("# spins on from here")]
    assert len(kept) == len(lines) - 1
    assert alone("urscript", plan, "\n".join(kept)).verdict == "refuted"


def test_of_a_kuka_it_is_refused_with_the_reason():
    with pytest.raises(InputError, match="a LIN that hardly moves the tip gives C_DIS no distance to go by"):
        position_plan(stand_in("KUKA"), 1, cycle=KINDS["one move"])
