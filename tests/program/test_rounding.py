"""What the digits of a program do to a joint that all but rests: as the certificate says, hole by hole."""

import re

import pytest
import yaml

from zerorev.files.io import read_job
from zerorev.planning.job import plan_job
from zerorev.program.as_exported import as_exported
from zerorev.program.dialects import DIALECTS
from zerorev.program.export import export
from zerorev.verify.certificate.program import certify_program

ROBOTS = {
    "tp": ("fanuc_lrmate200id", (425, 285, 431), {"tool_number": 3}),
    "rapid": ("abb_irb1200_5_90", (500, 300, 500), {}),
    "krl": ("kuka_kr6_r700_2", (500, 300, 800), {}),
}


def planned(tmp_path, controller, threshold, count=5):
    robot, (x, y, z), more = ROBOTS[controller]
    holes = [
        {"id": f"h{k}", "target_mm": [x, y - 8 * k, z + 3 * k], "direction": [1, 0, 0], "depth_mm": 25}
        for k in range(count)
    ]
    job = {
        "robot": robot, "tool": "thesis_drill", "controller": controller, "proof_boxes": 0, "limit_margin_deg": 0.1,
        "min_rate_deg_per_mm": threshold, "holes": holes, **more,
    }  # fmt: skip
    path = tmp_path / "job.yaml"
    path.write_text(yaml.safe_dump(job))
    return plan_job(read_job(path))


@pytest.mark.parametrize("controller", ROBOTS)
def test_the_holes_that_it_names_are_those_that_are_not_certified(controller, tmp_path):
    """Without a threshold the least travel is where a joint just stops, and the digits decide what it does."""
    plan = planned(tmp_path, controller, 0)
    exported, dialect = export(plan, version="x"), DIALECTS[controller]
    program = dialect.read(exported.files)
    certified = certify_program(plan, program, as_exported(plan, program, dialect))
    failing = {hole.hole.id for hole in certified.holes if hole.certificate.verdict != "certified"}
    (said,) = [each for each in exported.findings if "in the digits of this program" in each.message]
    assert said.level == "warning"
    assert "min_rate_deg_per_mm: 0.01" in said.message
    assert failing
    assert (set(re.findall(r"\bh\d\b", said.message)) or {said.hole}) == failing
    # it stands in the program, too, whose comments are cut into lines
    assert "digits" in exported.files[0].text


@pytest.mark.parametrize("controller", ROBOTS)
def test_with_the_usual_threshold_nothing_is_said_and_all_is_certified(controller, tmp_path):
    plan = planned(tmp_path, controller, 0.01, count=2)
    exported, dialect = export(plan, version="x"), DIALECTS[controller]
    assert not [each for each in exported.findings if "digits" in each.message]
    program = dialect.read(exported.files)
    certified = certify_program(plan, program, as_exported(plan, program, dialect))
    assert [hole.certificate.verdict for hole in certified.holes] == ["certified"] * 2
