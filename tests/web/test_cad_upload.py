"""The holes of a CAD file in the app: read in another process, shown as rows with what was assumed, and then taken."""

from __future__ import annotations

import pytest

pytest.importorskip("nicegui")
pytest.importorskip("OCP")

from oracles.places import ROOT
from zerorev.apart import Apart
from zerorev.errors import InputError
from zerorev.files.cad.as_listed import robot_in
from zerorev.files.hole_meaning import AS_IN_A_JOB
from zerorev.files.io import read_job
from zerorev.files.table_layout import Given
from zerorev.web import files
from zerorev.web.opening import demo
from zerorev.web.views import paste_form

pytestmark = pytest.mark.xdist_group("browser")
expect = pytest.importorskip("playwright.sync_api", reason="the tests in a browser need playwright").expect

PANEL = ROOT / "examples/jobs/cad_panel.step"


def read(name, content, unit=None, robot=None):
    return list(Apart(files.read_cad_file).results([name, unit, robot, *files.cut(content)]))


def test_the_rows_are_the_holes_of_the_job():
    job = read_job(PANEL.with_suffix(".yaml"))
    table, said = read("PANEL.STEP", PANEL.read_bytes(), robot=robot_in(job.T_base_part, job.robot))
    assert any("from the side of the robot" in each for each in said)
    listed = paste_form._understood(table, demo().job, Given(header=False), AS_IN_A_JOB)
    assert [row.problem for row in listed.rows] == [None] * 8
    mine = {row.form.id: row.form for row in listed.rows}
    assert {hole.id for hole in job.holes} <= mine.keys()
    for hole in job.holes:
        assert mine[hole.id].depth_mm == pytest.approx(hole.depth * 1e3 - 2)  # without the breakthrough of the job
        direction = job.T_base_part[:3, :3] @ mine[hole.id].direction
        assert direction == pytest.approx(hole.direction)


@pytest.mark.parametrize(
    ("name", "content", "says"),
    [
        ("a.step", PANEL.read_bytes()[:20_000], "a.step: is cut short"),
        ("a.stp", b"solid", "a.stp: is not a STEP file"),
        ("a.dxf", b"solid", "a.dxf: is not a DXF file"),
    ],
)
def test_what_cannot_be_read_is_refused_with_its_name(name, content, says):
    with pytest.raises(InputError, match=says):
        read(name, content)


def test_a_model_is_opened_on_the_page(demo_page):
    ready = demo_page
    expect(ready.get_by_test_id("reversals")).to_have_text("0", timeout=120_000)
    ready.get_by_test_id("paste").click()
    with ready.expect_file_chooser() as waiting:
        ready.get_by_test_id("paste-cad").click()
    waiting.value.set_files(PANEL)
    expect(ready.get_by_test_id("paste-verdict")).to_contain_text("8 rows, all good", timeout=120_000)
    expect(ready.get_by_test_id("paste-assumed")).to_contain_text("drilled from the side of the robot")
    ready.get_by_test_id("form-done").click()
    expect(ready.get_by_test_id("holes-shown")).to_have_text("11 holes")
    ready.get_by_test_id("paste").click()
    expect(ready.get_by_test_id("paste-assumed")).to_have_text("")
    with ready.expect_file_chooser() as waiting:
        ready.get_by_test_id("paste-cad").click()
    waiting.value.set_files({"name": "bad.step", "mimeType": "model/step", "buffer": b"ISO-10303-21;"})
    expect(ready.get_by_role("alert").filter(has_text="bad.step: is cut short")).to_be_visible(timeout=120_000)
