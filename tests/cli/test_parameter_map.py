"""`zerorev parameter-map` as a user meets it."""

from __future__ import annotations

import pytest
import yaml

from zerorev.cli import common as cli
from zerorev.cli import main
from zerorev.thesis.measures import zero_reversals
from zerorev.thesis.store import read_map

HOLES = [
    {"id": "one", "target_mm": [500, 300, 800], "direction": [1, 0, 0], "depth_mm": 50,
     "psi_deg": [14.1646, -5.9388, -30.4599], "branch": 4},
    {"id": "two", "target_mm": [200, 200, 1000], "direction": [1, 0, 0], "depth_mm": 30},
]  # fmt: skip


@pytest.fixture
def job(tmp_path):
    path = tmp_path / "job.yaml"
    path.write_text(yaml.safe_dump({"robot": "kuka_kr6_r700_2", "tool": "thesis_drill", "holes": HOLES}))
    return path


def test_writes_the_map_and_says_what_it_shows(job, tmp_path, capsys):
    assert main(["parameter-map", str(job), "--size", "24", "-o", str(tmp_path / "m.zarr")]) == cli.FINE
    out, _ = capsys.readouterr()
    found = read_map(tmp_path / "m.zarr")
    assert found.attrs["hole"] == "one"
    assert len(set(found["branch"].values.ravel())) > 3, "a given motion's branch is not the only one"
    assert f"zero reversals: {zero_reversals(found).cells:,} cells" in out
    assert "best cell: psi" in out
    after, first = (line for line in out.splitlines() if line.startswith("symmetry"))
    assert "after the extents: 0 % of the cells differ" in after
    assert "at the first point: 0 %" not in first


def test_of_another_hole_with_the_thesis_turns_and_bound(job, tmp_path, capsys):
    data = yaml.safe_load(job.read_text()) | {"psi_bound_deg": 90}
    job.write_text(yaml.safe_dump(data))
    arguments = ["--hole", "two", "--turns", "first_point", "--size", "8", "-o", str(tmp_path / "m.zarr")]
    assert main(["parameter-map", str(job), *arguments]) == cli.FINE
    found = read_map(tmp_path / "m.zarr")
    assert (found.attrs["hole"], found.attrs["turns"]) == ("two", "first_point")
    assert found["psi_start_deg"].values[[0, -1]].tolist() == pytest.approx([-90, 90])


def test_figures(job, tmp_path, capsys):
    assert main(["parameter-map", str(job), "--size", "24", "--figures", str(tmp_path / "figures")]) == cli.FINE
    names = {path.name for path in (tmp_path / "figures").iterdir()}
    assert names == {"parameter_slices.png", "zero_volume.png", "parameter_map.html"}


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["--hole", "three"], "there is no hole 'three' (accepted: one, two)"),
        (["--size", "1"], "size"),
        (["--size", "2.5"], "size"),
        (["--size", "100000"], "of memory"),
        (["--turns", "later"], "later"),
        (["--psi-target-deg", "nan"], "--psi-target-deg"),
        (["-o", "{folder}/no/m.zarr"], "does not exist"),
        (["-o", "{folder}"], "holds something else"),
        (["--figures", "{folder}/job.yaml"], "it is a file, not a folder"),
    ],
    ids=str,
)
def test_bad_input_is_one_message(job, tmp_path, capsys, arguments, said):
    filled = [argument.format(folder=tmp_path) for argument in arguments]
    assert main(["parameter-map", str(job), *filled]) == cli.BAD_INPUT
    out, err = capsys.readouterr()
    assert out == ""
    assert err.count("error:") == 1
    assert said in err
    assert [path.name for path in tmp_path.iterdir()] == ["job.yaml"]
