"""The table of what is known of the arm: measured ranges first, what is held last, each with what it rests on."""

from __future__ import annotations

import re
from dataclasses import replace

import pytest

pytest.importorskip("nicegui")

from zerorev.model.ranges import HELD, RANGES, Cell
from zerorev.web.views.arm_ranges import ranges_table


def rows(html):
    return [re.findall(r"<td>(.*?)</td>", row) for row in re.findall(r"<tr>(.*?)</tr>", html)][1:]


def test_every_parameter_is_there_with_what_it_rests_on(tool):
    fitted = replace(RANGES["friction"], low=0.9, high=1.1, basis="fitted", source="<sweeps>")
    found = rows(ranges_table(Cell({"friction": fitted}), tool))
    named = [row[0].split(" to ") for row in found]
    six = {stem: [f"{stem}_{joint}" for joint in range(1, 7)] for stem in ("friction", "gap")}
    listed = [name for ends in named for name in (ends if len(ends) == 1 else six[ends[0][:-2]])]
    assert sorted(listed) == sorted(RANGES)
    assert ["gap_1", "gap_6"] in named
    assert found[0][0] == "friction"
    assert found[0][2:] == ["0.9", "1.1", "fitted to recordings", "&lt;sweeps&gt;"]
    by_name = {row[0]: row for row in found}
    assert by_name["stiffness"][2:] == ["0.4", "2.5", "a guess", ""]
    assert by_name["gap"][5] == RANGES["gap"].source
    assert by_name["tool_mass"][4] == "the tool&#x27;s file states it"
    assert {row[0] for row in found[-len(HELD) - 2 :]} == {*HELD, "tool_mass", "tool_lever"}
    assert by_name["acceleration"][2:5] == ["2", "2", "held here"]
    without = {row[0]: row for row in rows(ranges_table(Cell(), replace(tool, load=None)))}
    assert without["tool_mass"][2:5] == ["0.3", "3", "a guess"]


def test_joints_that_differ_have_rows_of_their_own(tool):
    third = replace(RANGES["friction_3"], low=0.9, high=1.1, basis="fitted")
    names = [row[0] for row in rows(ranges_table(Cell({"friction_3": third}), tool))]
    assert names[0] == "friction_3"
    assert {f"friction_{joint}" for joint in range(1, 7)} <= set(names)
    assert "gap_1 to gap_6" in names
