"""Cell files: what is written is read as the same; what cannot be used is refused by one message."""

from __future__ import annotations

from dataclasses import replace

import pytest

from zerorev.cell.parameters import drawn
from zerorev.errors import InputError
from zerorev.files.cell_file import read_cell, write_cell
from zerorev.model.ranges import RANGES, Cell, Conditioning, Range

HEAD = "format: zerorev.cell/1\n"


def test_what_is_written_is_read_as_the_same(tmp_path):
    fitted = replace(RANGES["friction_3"], nominal=1.1, low=1.05, high=1.15, basis="fitted", source="sweeps: of May")
    cell = Cell({"friction_3": fitted}, Conditioning({"P1": 2e-4, "1": 1.4e-4}, 0.2, 0.01, 1.5), "kuka_kr6_r700_2")
    write_cell(cell, tmp_path / "cell.yaml")
    again = read_cell(tmp_path / "cell.yaml")
    assert again == cell
    assert again.ranges["friction_3"].basis == "fitted"
    assert list(again.ranges) == list(RANGES)


def test_what_a_file_does_not_have_keeps_its_prior(tmp_path):
    (tmp_path / "cell.yaml").write_text(HEAD + "parameters:\n  gap: {nominal: 2, low: 1, high: 3}\n")
    cell = read_cell(tmp_path / "cell.yaml")
    assert {name for name, each in cell.ranges.items() if each != RANGES[name]} == {"gap"}
    assert cell.ranges["gap"] == Range(2, 1, 3, "log", RANGES["gap"].means, "")
    assert cell.conditioning is None
    assert cell.robot == ""


def test_sets_are_drawn_from_the_ranges_of_a_file(tmp_path):
    text = "parameters:\n  gap: {nominal: 2, low: 2, high: 2}\n  corner: {nominal: 5e-3, low: 1e-3, high: 5e-3}\n"
    (tmp_path / "cell.yaml").write_text(HEAD + text)
    sets = drawn(4, 1, read_cell(tmp_path / "cell.yaml").ranges)
    assert [each["gap"] for each in sets] == pytest.approx([2.0] * 4)
    assert [each["corner"] for each in sets] == [5e-3] * 4  # held, at the nominal value of the file


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("parameters: {frictoin: {}}", "line 2, parameters.frictoin: unknown key 'frictoin' (accepted: did you mean"),
        ("parameters: {friction: {nominal: 1, low: 1.5, high: 2}}", "parameters.friction: low 1.5, nominal 1, high 2"),
        ("parameters: {gap: {nominal: 0, low: 0, high: 3}}", "parameters.gap.nominal: 0 is too small"),
        ("parameters: {gap: {nominal: 1, low: .nan, high: 3}}", "gap.low: nan is not a finite number (accepted: a num"),
        ("parameters: {gap: {nominal: 1, low: 1, high: 3, basis: seen}}", "accepted: prior, fitted or conditioned"),
        ("parameters: {behind: {nominal: 1, low: 1, high: 2}}", "behind.high: 2 is too large: 1 is the most"),
        ("conditioning: {baseline_mm: {}}", "conditioning.baseline_mm: has 0 entries (accepted: a mapping of ids"),
        ("conditioning: {baseline_mm: {a: -1}}", "baseline_mm.a: -1 is too small (accepted: a mapping of ids of hol"),
        ("conditioning: {baseline_mm: {a: 1}, factor: 1}", "conditioning.factor: 1 is too small (accepted: a number"),
    ],
)
def test_one_clear_message(tmp_path, text, said):
    file = tmp_path / "cell.yaml"
    file.write_text(HEAD + text)
    with pytest.raises(InputError) as error:
        read_cell(file)
    assert str(file) in str(error.value)
    assert said in str(error.value)


def test_another_file_is_refused(tmp_path):
    (tmp_path / "job.yaml").write_text("format: zerorev.tool/1\n")
    with pytest.raises(InputError, match=r"is a file of format 'zerorev.tool/1' \(accepted: format: zerorev.cell/1"):
        read_cell(tmp_path / "job.yaml")


def test_a_cell_of_unknown_parameters_is_refused():
    with pytest.raises(InputError, match="unknown parameter 'wobble'"):
        Cell({"wobble": RANGES["gap"]})
