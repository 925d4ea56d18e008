"""Edits of an exported program: each is refuted or refused, naming the line, or proven harmless by name."""

import re
from collections import Counter

import pytest

from oracles.judged import Judge
from oracles.krl_harmless import PROOFS
from oracles.krl_mutations import WAYS, mutations, tokens
from oracles.krl_reader import commands
from oracles.places import DATA
from zerorev import cli
from zerorev.cli import main
from zerorev.model.cycle import Cycle
from zerorev.program.as_exported import expected
from zerorev.program.export import export
from zerorev.program.krl.dialect import KRL
from zerorev.program.krl.read import read_krl

PROGRAMS = DATA / "program"


@pytest.fixture(scope="module")
def plan(published, plan_of):
    return plan_of(published(1), published(2), name="mutated", T_base_part=None)


def hold(plan, count, seed):
    """Every mutation of a plan's program to what it claims; how many there were of each name."""
    judge, found = Judge.of(plan, KRL), Counter()
    text, original, reached = judge.text, judge.read(judge.text), commands(judge.text)
    assert judge.certified(original)
    for kind, mutated, harmless in mutations(text, count, seed):
        found[kind, harmless] += 1
        program, reasons = judge.judged(mutated)
        if harmless is None:
            assert reasons, (kind, mutated)
            assert re.search(r"\bline \d+", reasons[0]), (kind, reasons)
            continue
        assert not reasons, (kind, harmless, reasons)
        if harmless == "last printed digit":
            assert PROOFS[harmless](text, mutated), (kind, mutated)
            # as printed it is either proven, by ball arithmetic, or not: both are right
            judge.certified(program)
        else:
            assert PROOFS[harmless](text, mutated), (kind, harmless)
            assert commands(mutated) == reached, (kind, harmless)
            # the reader sees no difference, so that the certificate of the original is its own
            assert program == original, (kind, harmless)
    return found


def test_a_sample_of_mutations(plan):
    found = hold(plan, 80, seed=1)
    assert len({kind for kind, _ in found}) > 20


def test_a_sample_of_mutations_where_the_tool_stands(published, plan_of):
    plan = plan_of(published(1), name="standing", cycle=Cycle(dwell=0.12))
    assert "WAIT SEC 0.12" in export(plan).text
    hold(plan, 120, seed=24)


@pytest.mark.long
def test_a_thousand_mutations(plan):
    """Every token of the program, and every way that there is to change one."""
    text = export(plan, version="test").text
    assert len(tokens(text)) < 1000
    found = hold(plan, 1000, seed=2)
    assert {harmless for _, harmless in found} == {None, *PROOFS}
    assert len({kind for kind, _ in found}) >= len({way for ways in WAYS.values() for way in ways}) - 3
    assert sum(count for (_, harmless), count in found.items() if harmless is None) > 500


@pytest.mark.soak
@pytest.mark.parametrize("seed", range(3, 23))
def test_twenty_thousand_mutations(seed, plan):
    hold(plan, 1000, seed)


# --- edits that were once certified, by the command line --------------------------------------------------------------


@pytest.fixture(scope="module")
def exported(tmp_path_factory):
    """The plan of two holes on a tilted part, and its program."""
    folder = tmp_path_factory.mktemp("program")
    plan, program = folder / "program.json", folder / "program.src"
    assert main(["plan", str(PROGRAMS / "program.yaml"), "-o", str(plan), "--json"]) == cli.FINE
    assert main(["export", str(plan), "--controller", "krl", "-o", str(program)]) == cli.FINE
    assert main(["check", "--certify", str(plan), "--program", str(program)]) == cli.FINE
    return plan, program


def line_of(text, comment):
    lines = text.split("\n")
    return lines, next(k for k, line in enumerate(lines) if comment in line)


def hidden(comment, odd):
    def edit(text):
        lines, k = line_of(text, comment)
        return "\n".join([*lines[:k], f"; see{odd}{lines[k]}", *lines[k + 1 :]])

    return edit


def swapped(old, new):
    return lambda text: text.replace(old, new)


def move_added(text):
    """Just before the corner, on the line between its neighbours, blended."""
    lines, k = line_of(text, "corner, 1 mm")
    numbers = [re.findall(r"[XYZABC] (-?[\d.]+)", line) for line in lines[k - 1 : k + 1]]
    near = [float(a) + 0.9999 * (float(b) - float(a)) for a, b in zip(*numbers, strict=True)]
    point = ",".join(f"{name} {value:.4f}" for name, value in zip("XYZABC", near, strict=True))
    return "\n".join([*lines[:k], f"LIN {{{point}}} C_DIS", *lines[k:]])


EDITS = {
    "a corner hidden behind a form feed": hidden("corner, 1 mm", "\f"),
    "a feed hidden behind a line separator": hidden("lead-in: 5", "\u2028"),
    "a point hidden behind a carriage return": hidden("end of the stroke", "\r"),
    "PTP at any speed": swapped("BAS (#VEL_PTP,20 )\n", ""),
    "PTP at full speed": swapped("#VEL_PTP,20", "#VEL_PTP,100"),
    "PTP at any acceleration": swapped("#ACC_PTP,50", "#ACC_PTP,999"),
    "no INITMOV": swapped("BAS (#INITMOV,0 )\n", ""),
    "INITMOV after the speed": swapped(
        "BAS (#INITMOV,0 )\nBAS (#VEL_PTP,20 )\n", "BAS (#VEL_PTP,20 )\nBAS (#INITMOV,0 )\n"
    ),
    "the acceleration after the frames": lambda t: t.replace("BAS (#ACC_PTP,50 )\n", "").replace(
        "$IPO_MODE", "BAS (#ACC_PTP,50 )\n$IPO_MODE"
    ),
    "a short advance": swapped("$ADVANCE=3", "$ADVANCE=0.003"),
    "no advance worth it": swapped("$ADVANCE=3", "$ADVANCE=1"),
    "a slow turn": swapped("$VEL.ORI1=200.0", "$VEL.ORI1=0.2"),
    "a smaller blend": swapped("$APO.CDIS=2.0000", "$APO.CDIS=0.5000"),
    "a greater blend": swapped("$APO.CDIS=2.0000", "$APO.CDIS=2.0010"),
    "a blend one digit less": swapped("$APO.CDIS=2.0000", "$APO.CDIS=1.9999"),
    "a stop": swapped("} C_DIS ; corner", "} ; corner"),
    "another name": swapped("DEF program ( )", "DEF other ( )"),
    "no declaration": swapped("EXT BAS (BAS_COMMAND :IN,REAL :IN )\n", ""),
    "another move": move_added,
    "another turn of the tool": swapped("#VAR", "#CONSTANT"),
    "a slower retract": swapped("$VEL.CP=0.020000", "$VEL.CP=0.019999"),
    "the part elsewhere": swapped("$BASE={FRAME: X 10.0000", "$BASE={FRAME: X 10.0002"),
}


@pytest.mark.parametrize("edit", EDITS.values(), ids=EDITS)
def test_planted_edits(edit, exported, tmp_path, capsys):
    plan, program = exported
    text, path = program.read_text(), tmp_path / "edited.src"
    path.write_bytes(edit(text).encode())
    assert edit(text) != text
    assert main(["check", "--certify", str(plan), "--program", str(path)]) in (cli.FOUND, cli.BAD_INPUT)
    out, err = capsys.readouterr()
    assert re.search(r"\bline \d+\b", " ".join((out + err).split()))
    assert err.startswith("error: ") or "yes, refuted" in out


def test_what_a_controller_and_an_operator_may_change(exported, tmp_path):
    plan, program = exported
    text, path = program.read_text(), tmp_path / "program.src"
    path.write_text(
        "&ACCESS RVP1\n&REL 14\n&PARAM EDITMASK = *\n"
        + text[text.index("DEF") :].replace("; corner", "; checked by us:"),
        newline="\r\n",
    )
    assert main(["check", "--certify", str(plan), "--program", str(path)]) == cli.FINE


@pytest.mark.parametrize(
    ("called", "file_name", "fits"),
    [
        ("mutated", "a", True),
        ("A", "a", True),
        ("left_wing", "left_wing", True),
        ("left_wing", "left wing", False),
        ("b", "a", False),
        ("a", "", False),
    ],
)
def test_the_program_is_called_as_its_plan_or_its_file(called, file_name, fits, plan):
    program = read_krl(export(plan).text.replace("DEF mutated", f"DEF {called}"))
    wrong = [own.wrong for own in expected(plan, KRL).beside(program, file_name)]
    assert (
        wrong == 2 * [()] if fits else all(f"line 4: the program is called {called}" in reasons[0] for reasons in wrong)
    )


@pytest.mark.parametrize(
    ("edit", "code"),
    [
        (lambda text: text, cli.FINE),
        (hidden("lead-in: 5 mm/s", "\f"), cli.BAD_INPUT),
        (lambda text: text.replace("#VEL_PTP,20", "#VEL_PTP,100").replace("#ACC_PTP,50", "#ACC_PTP,999"), cli.FOUND),
    ],
    ids=["as exported", "hidden", "fast"],
)
def test_a_program_of_an_earlier_version(edit, code, tmp_path):
    path = tmp_path / "fuzz.src"
    path.write_text(edit((PROGRAMS / "fuzz.src").read_text()))
    assert main(["check", "--certify", str(PROGRAMS / "fuzz.json"), "--program", str(path)]) == code
