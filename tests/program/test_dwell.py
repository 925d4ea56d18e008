"""A tool that stands at the target for a while: in every language written, read back strictly, and proven."""

import re
from collections.abc import Mapping
from dataclasses import replace
from types import MappingProxyType
from typing import NamedTuple

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
SECONDS = 0.12


class Language(NamedTuple):
    """How a language lets the robot stand.

    Attributes:
        robot: gives one of its maker.
        waits: the statement, its time in the place of {}.
        number: of that time.
        settings: which it needs besides.
    """

    robot: object
    waits: str
    number: str = "0.12"
    settings: Mapping = MappingProxyType({})


LANGUAGES = {
    "krl": Language(lambda: stand_in("KUKA"), "WAIT SEC {}"),
    "rapid": Language(lambda: stand_in("ABB"), "WaitTime {};"),
    "tp": Language(lambda: read_robot("fanuc_lrmate200id"), "WAIT    {}(sec)", ".12", {"tool_number": 3}),
    "urscript": Language(lambda: stand_in("Universal Robots"), "sleep({})"),
    "inform": Language(lambda: read_robot("yaskawa_ma2010"), "TIMER T={}", "0.12", {"tool_number": 3, "nearer": 0.85}),
}
KINDS = {"single": Cycle(dwell=SECONDS), "chip_break": Cycle("chip_break", 10e-3, 0.3e-3, dwell=SECONDS)}


def plan_of(name, cycle, **settings):
    language = LANGUAGES[name]
    chosen = {"min_rate": THRESHOLD, "limit_margin": float(np.deg2rad(0.1))} | language.settings
    return position_plan(language.robot(), 1, cycle=cycle, **(chosen | settings))


def read(name, text):
    return DIALECTS[name].read((ProgramFile(f"here{DIALECTS[name].suffix}", text),))


def alone(name, plan, text):
    """The certificate without the comparison, statement by statement, with what `export` writes."""
    program = read(name, text)
    return certify_program_hole(plan, plan.holes[0], program, program.holes[0])


def statement(name, number=None):
    return LANGUAGES[name].waits.format(number or LANGUAGES[name].number)


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("name", LANGUAGES)
def test_written_read_back_and_certified(name, kind):
    plan = plan_of(name, KINDS[kind])
    (hole,) = plan.holes
    exported = export(plan)
    assert exported.text.count(statement(name)) == 1
    program = DIALECTS[name].read(exported.files)
    (moves,) = (written.moves for written in program.holes)
    waiting = [move for move in moves if move.wait]
    # at the full depth alone, not where chips are broken
    assert [float(move.wait) for move in waiting] == [SECONDS]
    assert waiting[0].stops
    drilled = as_exported(plan, program, DIALECTS[name])
    (proven,) = certify_program(plan, program, drilled).holes
    assert (proven.certificate.verdict, proven.certificate.reasons) == ("certified", ())
    assert (hole.corner.kind, hole.corner.shortfall) == ("stop", 0.0)
    assert [each.level for each in hole.findings if "stands at the target for 0.12 s" in each.message] == ["warning"]


def as_lines(text):
    lines = text.split("\n")
    return lines, lambda part: next(k for k, line in enumerate(lines) if part in line)


def numbered(lines):
    """Lines of a TP program numbered again; others have no numbers."""
    count = iter(range(1, len(lines) + 1))
    return "\n".join(re.sub(r"^ *\d+:", lambda _: f"{next(count):4d}:", line) for line in lines)


def put(name, text, after):
    """The wait behind the line with a comment or number, in place of where it stands."""
    lines, at = as_lines(text)
    own = lines.pop(at(statement(name)))
    lines.insert(after(lines), own)
    return numbered(lines)


def first_move(lines):
    """The number of the line behind the first straight move."""
    return 1 + next(k for k, line in enumerate(lines) if re.search(r"^LIN |MoveL |:L |movel\(|^MOVL ", line))


def last_move(lines):
    return 1 + max(k for k, line in enumerate(lines) if re.search(r"^LIN |MoveL |:L |movel\(|^MOVL ", line))


def before_all(lines):
    return first_move(lines) - 1


@pytest.mark.parametrize("name", LANGUAGES)
def test_another_time_is_refuted_by_the_moves_alone(name):
    plan = plan_of(name, KINDS["single"])
    text = export(plan).text
    changed = text.replace(statement(name), statement(name, LANGUAGES[name].number.replace("2", "3")))
    certificate = alone(name, plan, changed)
    assert certificate.verdict == "refuted"
    assert "stands at its end for 0.13 s, the plan says 0.12 s" in certificate.reasons[0]
    lines, at = as_lines(text)
    lines.pop(at(statement(name)))
    (reason,) = alone(name, plan, numbered(lines)).reasons
    assert "stands at its end for 0 s, the plan says 0.12 s" in reason
    wrong = as_exported(plan, read(name, changed), DIALECTS[name])[0].wrong
    assert len(wrong) == 1
    assert "stands where the plan has" in wrong[0]


@pytest.mark.parametrize("name", LANGUAGES)
def test_a_wait_elsewhere_is_refused_or_refuted(name):
    plan = plan_of(name, KINDS["single"])
    text = export(plan).text
    certificate = alone(name, plan, put(name, text, last_move))
    assert certificate.verdict == "refuted"
    assert sum("stands at its end" in reason for reason in certificate.reasons) == 2
    with pytest.raises(InputError, match="between blended moves"):
        read(name, put(name, text, first_move))
    with pytest.raises(InputError, match="before the first move of a hole"):
        read(name, put(name, text, before_all))
    lines, at = as_lines(text)
    lines.insert(at(statement(name)), lines[at(statement(name))])
    with pytest.raises(InputError, match=r"a second .* at the same place"):
        read(name, numbered(lines))
    zero = text.replace(statement(name), statement(name, LANGUAGES[name].number.replace("12", "00")))
    if name != "krl":  # there it stands before what is called
        with pytest.raises(InputError, match="a time above 0"):
            read(name, zero)
    else:
        assert alone(name, plan, zero).verdict == "refuted"


def test_a_hole_of_its_own():
    """The others keep their corner."""
    plan = position_plan(stand_in("ABB"), 1, min_rate=THRESHOLD)
    (hole,) = plan.holes
    held = replace(hole, hole=replace(hole.hole, cycle=Cycle(dwell=SECONDS)))
    both = replace(plan, holes=(hole, replace(held, hole=replace(held.hole, id="b"))), order=(), transitions=())
    program = read("rapid", export_again(both).text)
    assert [[float(move.wait) for move in each.moves if move.stops] for each in program.holes] == [[0.0], [0.12, 0.0]]


def export_again(plan):
    """The plan's holes planned for what they now ask for, and exported."""
    from zerorev.model.job import Job
    from zerorev.planning.job import plan_job

    job = Job(plan.robot, plan.tool, tuple(hole.hole for hole in plan.holes), plan.settings, name=plan.name)
    return export(plan_job(job))
