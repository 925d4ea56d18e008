"""What the terminal shows of few holes, and of many."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from rich.console import Console

from zerorev.model.job import Settings
from zerorev.model.plan import LostMotion
from zerorev.report.words.answer import ROWS, Shown, how_deep


def text(shown):
    with open("/dev/null", "w") as nowhere:
        console = Console(width=160, record=True, file=nowhere)
        for thing in (shown.table(), *shown.lines()):
            console.print(thing)
    return console.export_text()


def copies(published, count):
    """So many times the first hole, each 1 mm less beyond its depth than the one before."""
    first = published.holes[0]
    for n in range(count):
        yield replace(first, hole=replace(first.hole, id=f"H{n}"), deepest=first.hole.depth + (10 - n) * 1e-3)


def test_few_holes_have_a_row_each(published):
    shown = text(Shown(published, copies(published, ROWS)))
    assert sum("6 → 0" in line for line in shown.splitlines()) == ROWS
    assert " 60.0 " in shown


def test_guesses_are_called_guesses(published):
    assert "guesses" not in text(Shown(published, published.holes))
    first = replace(published.holes[0], lost_motion=LostMotion(0.0000674, 0.0001523))
    assert text(Shown(published, [first])).count("gap of the gears are guesses") == 1
    many = [replace(each, lost_motion=LostMotion(n * 1e-6, None)) for n, each in enumerate(copies(published, ROWS + 1))]
    row = next(line.split() for line in text(Shown(published, many)).splitlines() if "lost motion [mm]" in line)
    assert row[-5:] == ["0", "(H0)", "0.03", "0.06", f"(H{ROWS})"]


def test_many_holes_are_summarised(published):
    *most, last = copies(published, ROWS + 1)
    last = replace(last, motion=None, score=None, status="infeasible")
    shown = text(Shown(published, [*most, last]))
    assert "6 → 0" not in shown
    assert f"{ROWS + 1} holes: " in shown
    assert "1 infeasible" in shown
    assert f"{ROWS} with 0 reversals" in shown
    row = next(line.split() for line in shown.splitlines() if "deepest beyond depth" in line)
    assert row[-5:] == ["-50", f"(H{ROWS})", "-20", "10", "(H0)"]


def test_no_more_is_kept_than_shown(published):
    shown = Shown(published, copies(published, 5 * ROWS))
    assert len(shown._rows) == ROWS + 1


@pytest.mark.parametrize(
    ("settings", "says"),
    [
        (Settings(), "straight legs; every joint moves 0.01 deg/mm or more at every point; spin periodic"),
        (Settings(min_rate=0.0, psi_bound=np.pi), "straight legs; no motion threshold; spin within +-180 deg"),
        (Settings(min_rate=0.0, legs="free"), "free legs, twist at most 5 deg/mm; no motion threshold; spin periodic"),
    ],
)
def test_a_depth_is_shown_with_its_settings(settings, says):
    assert how_deep(settings) == says


def test_sound_and_certified(published):
    assert not Shown(published, published.holes).sound
    assert not Shown(published, published.holes[:1]).certified
