"""Holes that are pasted are shown as understood; what is probably wrong with a job is said when it is opened."""

from __future__ import annotations

import asyncio
from dataclasses import replace

import pytest

pytest.importorskip("nicegui")

from oracles.places import ROOT
from zerorev.errors import InputError
from zerorev.files.hole_meaning import AS_IN_A_JOB, Meaning
from zerorev.files.table_layout import Given
from zerorev.web.computing import Work, plan
from zerorev.web.job_edits import with_holes
from zerorev.web.opening import demo, opened
from zerorev.web.session import Session
from zerorev.web.views import paste_form

PRACTICE = ROOT / "tests/data/practice"
PASTED = Given(header=False)


def understood(text, given=PASTED, meaning=AS_IN_A_JOB):
    return paste_form._understood(text, demo().job, given, meaning)


def test_numbers_stand_as_they_are_understood():
    listed = understood((PRACTICE / "c05_csv_semicolon/semi.csv").read_text(encoding="utf-8"))
    table = paste_form._table(listed.rows)
    assert "<td>0.5</td>" in table
    assert "<td>12.5</td>" in table
    assert "0,5" not in table
    assert paste_form._verdict(listed.rows) == "2 rows, all good"


def test_thousands_are_not_decimals():
    text = (PRACTICE / "c06_thousands/paste.tsv").read_text(encoding="utf-8")
    with pytest.raises(InputError, match=r"'1,200' and '0\.5' \(line 1\) have two decimal signs"):
        understood(text)
    with pytest.raises(InputError, match=r"'1,200' may be 1\.200 or 1200"):
        understood(text.replace("0.5", "5").replace("950.5", "950"))


def test_other_columns_are_left_out_and_capitals_are_read():
    for name in ("extra", "hdrcase"):
        listed = understood((PRACTICE / f"c07_columns/{name}.csv").read_text(encoding="utf-8"))
        assert [row.form.id for row in listed.rows] == ["H1"]
        assert listed.notes == (() if name == "hdrcase" else ("column left out, since it is not needed: dia_mm",))


def test_normals_and_points_of_cad_are_shown_as_a_job_has_them():
    text = (PRACTICE / "c08_normals/out.csv").read_text(encoding="utf-8")
    table = paste_form._table(understood(text, meaning=Meaning("out", "entry")).rows)
    assert "<td>H1</td><td>12</td><td>0</td><td>0</td><td>1</td><td>0</td><td>0</td><td>12</td>" in table


def test_a_bad_row_says_why_beside_its_cells():
    table = paste_form._table(understood("A\t1\t2\t3\t1\t0\t0\t9\nB\tx\t2\t3\t1\t0\t0\t9").rows)
    assert ">B · x · 2 · 3 · 1 · 0 · 0 · 9</td>" in table
    assert "column x_mm: &#x27;x&#x27; is not a finite number; accepted: a finite number, e.g. 12.5" in table


def test_what_is_probably_wrong_with_a_job_is_said_when_it_is_opened():
    for case, words in (
        ("c09_tool_back/tool_back", "the drill points back at the flange"),
        ("c10_units/job_metres", "are they in metres"),
        ("c20_duplicates/dup", "a and b are drilled at the same place"),
        ("c23_feed/ms", "is feed_mm_s.plunge in m/s"),
        ("c08_normals/reversed", "all 3 holes are drilled towards the robot"),
        ("c07_columns/extra", "column left out, since it is not needed: dia_mm"),
        ("c08_normals/okdir", None),
    ):
        caution = opened(PRACTICE / f"{case}.yaml").caution
        assert caution is None if words is None else words in caution


def test_a_plan_or_a_map_as_a_job_is_refused_by_its_kind():
    with pytest.raises(InputError, match=r"is a robot file, not a job \(zerorev\.robot/1\)"):
        opened(PRACTICE / "c10_units/good.yaml")


def test_holes_that_are_pasted_twice_are_warned_of():
    state = demo()
    assert state.caution is None
    rows = understood("A\t600\t0\t600\t1\t0\t0\t20\nB\t600\t0\t600\t1\t0\t0\t20").rows
    pasted = with_holes(state, [row.hole for row in rows])
    assert pasted.caution == "A and B are drilled at the same place: is one of them a duplicate?"


def test_what_helps_where_most_holes_fail_is_said_when_all_are_planned():
    work = Work(Session(opened(PRACTICE / "c08_normals/reversed.yaml")))
    job = work.session.state.job
    job = replace(job, settings=replace(job.settings, proof_boxes=0))
    work.session.change(replace(work.session.state, job=job))

    async def planned():
        plan(work, job.holes)
        while work.busy:
            await asyncio.sleep(0.05)

    asyncio.run(planned())
    assert "with the directions turned round 3 of 3 are drilled" in work.session.state.outcome
    work.end()
