"""The programs that the app hands out are those that `export` writes: of all holes, of a part, and the way out."""

from dataclasses import replace
from types import SimpleNamespace

import pytest

import zerorev as zr
from oracles.places import JOBS
from zerorev.errors import ZerorevError
from zerorev.model.controller import Call, Calls
from zerorev.program.export import export, retract_program
from zerorev.web.state import opened_plan, plan_of, selected
from zerorev.web.views.program_download import part_download, program_download, way_out_download


@pytest.fixture(scope="module")
def state():
    return selected(opened_plan(zr.plan_job(zr.read_job(JOBS / "thesis_positions.yaml"))), "position_2")


def made(download, state, **how):
    """What a wish of the menu makes, without a page."""
    found = []
    work = SimpleNamespace(start=lambda title, total, run, take, each: found.extend(run()) or True)
    download(SimpleNamespace(state=state, page=None), work, **how)
    return found[-1]


def test_all_holes_the_rest_and_one(state):
    plan = plan_of(state)
    assert made(program_download, state).text == export(plan).text
    rest = made(part_download, state, rest=True)
    assert rest.text == export(plan, start="position_2").text
    assert (rest.holes, rest.name) == (2, "thesis_positions_from_2")
    one = made(part_download, state, rest=False)
    assert one.text == export(plan, only=["position_2"]).text
    assert one.holes == 1


def test_the_way_out(state):
    assert made(way_out_download, state).text == retract_program(plan_of(state), "position_2").text


def test_settings_of_the_program_are_the_jobs(state):
    settings = replace(state.job.settings, tool_number=4, calls=Calls(before_hole=(Call("RUN"),)), holes_per_program=2)
    asked = replace(state, job=replace(state.job, settings=settings))
    program = made(program_download, asked)
    assert [file.name[-6:] for file in program.files] == ["ns.src", "_1.src", "_2.src"]
    assert "\n$ACT_TOOL=4\n" in program.files[1].text
    assert program.files[1].text.count("\nRUN( )\n") == 2


def test_a_hole_without_an_answer(state):
    with pytest.raises(ZerorevError, match="no hole is called 'x'"):
        made(way_out_download, replace(state, selected="x"))
    with pytest.raises(ZerorevError, match="no hole is selected"):
        made(part_download, replace(state, selected=None), rest=True)
