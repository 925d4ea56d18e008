"""What the terminal shows."""

from __future__ import annotations

import html
from dataclasses import replace

import numpy as np
import pytest
from rich.console import Console

from zerorev.files.io import read_robot
from zerorev.model.finding import Finding
from zerorev.model.plan import LostMotion, Verification
from zerorev.model.profile import Profile
from zerorev.report.notebook import html_of
from zerorev.report.words import tables
from zerorev.report.words.answer import Shown


def shown(*things):
    console = Console(width=160, record=True, quiet=False, file=open("/dev/null", "w"))  # noqa: SIM115
    for thing in things:
        console.print(thing)
    console.file.close()
    return console.export_text()


def test_one_row_per_hole(published):
    text = shown(tables.plan_table(published))
    for part in ("6 → 0", "5 → 0", "107.1", "98.5", "90.5", "180.00  178.10  142.49", "infeasible", "0.0018 A6"):
        assert part in text


def test_units_survive_rich_s_markup(published):
    text = shown(tables.plan_table(published))
    assert "[deg]" in text
    assert "[deg/mm]" in text


def test_verdicts(published):
    checks = [
        Verification(passed, 1, 1, (0,) * 6, 0, 0, 0, 0, failures) for passed, failures in ((True, ()), (False, ("x",)))
    ]
    holes = tuple(replace(hole, verified=check) for hole, check in zip(published.holes[:2], checks, strict=True))
    plan = replace(published, holes=holes)
    text = shown(tables.plan_table(plan))
    assert "yes" in text
    assert "FAILED" in text
    failed = [Finding("error", "verification", "x", "position 2")]
    assert tables.hole_findings(replace(plan.holes[1], findings=())) == failed
    assert tables.hole_findings(replace(plan.holes[1], findings=tuple(failed))) == failed


def test_where_all_joints_reverse_there_is_no_slowest(make_plan):
    plan = make_plan(psi_deg=(30, -40, 35))
    assert plan.holes[0].score.reversals_per_joint == (1,) * 6
    assert shown(tables.plan_table(plan)).rstrip().splitlines()[-1].split()[-2] == "–"


def test_the_lost_motion_has_a_column_where_there_is_one(published):
    assert "lost motion" not in shown(tables.plan_table(published))
    first = replace(published.holes[0], lost_motion=LostMotion(0.0000674, 0.0001523))
    second = replace(published.holes[1], lost_motion=LostMotion(0.00004, None))
    plan = replace(published, holes=(first, second, *published.holes[2:]))
    text = shown(tables.plan_table(plan))
    assert "lost motion" in text
    rows = {line.split()[0] + line.split()[1]: line for line in text.splitlines() if "→ 0" in line}
    assert "0.067 (0.152)" in rows["position1"]
    assert "0.040 (–)" in rows["position2"]
    assert "–" in rows["position3"]


def test_a_long_profile_shows_its_spins_at_start_target_and_end(published):
    hole = published.holes[0]
    standoff, psi = np.array([0.05, 0.03, 0.0, 0.02, 0.04, 0.05]), np.deg2rad([1.0, 2.0, -3.25, 4.0, 5.0, 6.5])
    longer = replace(hole, motion=replace(hole.motion, profile=Profile(standoff, psi)))
    assert tables.spins_cell(longer) == "1.00 … -3.25 … 6.50"
    assert tables.spins_cell(hole) == "14.16  -5.94  -30.46"


def test_a_baseline_that_cannot_be_run_is_explained_where_it_occurs(published):
    lost = replace(published, holes=(replace(published.holes[0], baseline=None), *published.holes[1:]))
    table = shown(tables.plan_table(lost))
    assert "? → 0" in table
    lines = [line.plain for line in Shown(lost, lost.holes).lines()]
    assert lines[0] == tables.NO_BASELINE
    assert tables.NO_BASELINE not in [line.plain for line in Shown(published, published.holes).lines()]
    assert html.escape(tables.NO_BASELINE) in html_of(lost)
    assert "cannot be run at all" not in html_of(published)


class TestFindings:
    def test_the_gravest_first(self):
        findings = [Finding("info", "a", "one"), Finding("error", "b", "two"), Finding("warning", "c", "three")]
        assert [line.plain.split()[0] for line in tables.finding_lines(findings)] == ["error", "warning", "info"]

    def test_the_same_said_of_many_holes_is_one_line(self):
        lines = tables.finding_lines([Finding("info", "blend", "short", f"h{n}") for n in range(100)])
        assert len(lines) == 1
        assert "holes h0, h1, h2, h3, h4, h5 and 94 more: short" in lines[0].plain

    def test_many_of_a_kind_are_counted(self):
        lines = tables.finding_lines([Finding("warning", "margin", f"slow by {n}", f"h{n}") for n in range(100)])
        assert len(lines) == 4
        assert "and likewise holes h3, h4, h5, h6, h7, h8 and 91 more" in lines[-1].plain

    def test_a_hole_that_is_named_above_is_not_named_again(self):
        said = [Finding("info", "lost_motion", f"crosses {n}", "A") for n in range(3)]
        assert [line.plain.strip() for line in tables.finding_lines(said)][1:] == ["and 2 more like this"]
        said.append(Finding("info", "lost_motion", "crosses", "B"))
        last = tables.finding_lines(said)[-1].plain.strip()
        assert last == "and likewise hole B and 2 more like this"

    def test_what_is_said_of_no_hole_is_counted_too(self):
        lines = tables.finding_lines([Finding("info", "long", f"part {n}") for n in range(3)])
        assert lines[-1].plain.strip() == "and 2 more like this"

    def test_brackets_are_not_markup(self):
        (line,) = tables.finding_lines([Finding("error", "k", "[red]m[/red]", "[h]")])
        assert "hole [h]: [red]m[/red]" in shown(line)


class TestRobots:
    def test_reach_of_the_thesis_robot(self, robot):
        assert robot.wrist_reach == pytest.approx(0.7259, abs=1e-4)  # its data sheet: 726 mm

    def test_every_number_with_its_source(self):
        robot = read_robot("kuka_kr6_r700_2")
        text = shown(tables.robot_heading(robot), tables.robot_table(robot), *tables.robot_lines(robot))
        for part in ("c2 335", "-190", "156", "540", "kroshu/kuka_robot_descriptions", "S6RRRRRR10", "beware"):
            assert part in text

    def test_sheet_is_plain_data(self, any_robot):
        sheet = tables.robot_sheet(any_robot)
        assert sheet["geometry_mm"].keys() == {"a1", "a2", "b", "c1", "c2", "c3", "c4"}
        assert sheet["sources"]
