"""Recordings as CSV: round trips, and tables as other programs write them."""

from __future__ import annotations

import numpy as np
import pytest

from oracles.published import POSITIONS
from oracles.recordings import kick, run_of
from zerorev.cell.recordings.channels import Mapping, meaning_of, read_mapping
from zerorev.cell.recordings.read import read_recording
from zerorev.cell.recordings.table import write_csv
from zerorev.errors import InputError
from zerorev.model.recording import JOINT_ARRAYS, TIP_ARRAYS, Recording


def written(folder, text, encoding="utf-8"):
    path = folder / "run.csv"
    path.write_bytes(text.encode(encoding))
    return path


def rows(columns, count=10):
    """A header and rows: the time 0.01 k, everything else its column's number and k."""
    lines = [",".join(columns)]
    lines += [",".join(f"{0.01 * k:.2f}" if n == 0 else f"{n}.{k}" for n in range(len(columns))) for k in range(count)]
    return "\n".join(lines) + "\n"


JOINTS = [f"A{n}_deg" for n in range(1, 7)]


@pytest.mark.parametrize("torque", [True, False])
@pytest.mark.parametrize("tips", [True, False])
def test_what_is_written_is_read(tmp_path, robot, tool, torque, tips):
    run = run_of(robot, tool, POSITIONS[1], error=kick, tips=tips, torque=torque, noise=1e-5).recording
    write_csv(run, tmp_path / "run.csv")
    found = read_recording(tmp_path / "run.csv")
    for name in ("time", *JOINT_ARRAYS, *TIP_ARRAYS):
        mine, other = getattr(found, name), getattr(run, name)
        assert (mine is None) == (other is None), name
        assert mine is None or np.allclose(mine, other, rtol=1e-15, atol=1e-16), name
    assert found.commanded_from == run.commanded_from
    assert [finding.kind for finding in found.findings] == ([] if torque else ["no_torque"])
    first = (tmp_path / "run.csv").read_text().splitlines()[1]
    assert (",,,,,," in first) == torque  # nothing is commanded yet


def test_semicolons_and_decimal_commas(tmp_path):
    plain = rows(["t_s", *JOINTS])
    comma = plain.replace(",", ";").replace(".", ",")
    first = read_recording(written(tmp_path, plain))
    assert np.array_equal(read_recording(written(tmp_path, comma)).joints, first.joints)
    assert np.array_equal(read_recording(written(tmp_path, comma.replace(";", "\t"))).joints, first.joints)
    assert np.array_equal(
        read_recording(written(tmp_path, "\ufeff" + plain.replace("\n", "\r\n"))).joints, first.joints
    )
    assert first.joints[3, 1] == pytest.approx(np.deg2rad(2.3))


def test_the_unit_is_said_by_the_end_alone(tmp_path):
    found = read_recording(
        written(tmp_path, rows(["t_ms", "X_m", "Y_mm", "Z_mm", *(f"A{n}_rad" for n in range(1, 7))]))
    )
    assert found.time[2] == pytest.approx(0.02e-3)
    assert found.tcp[0].tolist() == pytest.approx([1.0, 2e-3, 3e-3])
    assert found.joints[0, 0] == 4.0


@pytest.mark.parametrize(
    ("name", "member", "index"),
    [
        ("A3_cmd_deg", "joints_commanded", 2), ("A6_torque_nm", "torque", 5),
        ("A1_torque_cmd_nm", "torque_commanded", 0),
        ("Z_cmd_mm", "tcp_commanded", 2), ("t_s", "time", 0),
    ],
)  # fmt: skip
def test_the_vocabulary(name, member, index):
    meaning = meaning_of(name)
    assert (meaning.member, meaning.index) == (member, index)


@pytest.mark.parametrize(
    "name",
    ["A1", "A7_deg", "A1_mm", "A1_nm", "X_deg", "X_torque_nm", "t_deg", "t_cmd_s", "A1_torque_deg", "a1_deg", "x_mm"],
)
def test_any_other_name_has_no_meaning(name):
    assert meaning_of(name) is None


def test_unknown_columns_are_kept_and_named(tmp_path):
    text = rows(["t_s", *JOINTS, "Spannung Brücke", "A1_x"])
    found = read_recording(written(tmp_path, text, "cp1252"))
    assert found.other_channels == ("Spannung Brücke", "A1_x")
    assert "Spannung Brücke, A1_x" in found.findings[0].message
    mapping = Mapping({"Spannung Brücke": "X_mm", "A1_x": "Y_mm"})
    found = read_recording(written(tmp_path, text, "cp1252"), mapping)
    assert found.other_channels == ()
    assert any("Z_mm are missing" in finding.message for finding in found.findings)


def test_a_mapping_out_of_a_file(tmp_path):
    path = tmp_path / "channels.yaml"
    path.write_text("channels:\n  Lage 1: A1_deg\ngear_ratio: [1, 2, 3, 4, 5, -6]\n")
    found = read_mapping(path)
    assert found == Mapping({"Lage 1": "A1_deg"}, (1.0, 2.0, 3.0, 4.0, 5.0, -6.0))


@pytest.mark.parametrize(
    "text",
    ["channels: [1]\n", "channels: {a: A9_deg}\n", "channels: {a: 1}\n", "gear_ratio: [1, 2]\n", "gears: 1\n", "7\n",
     "gear_ratio: [1, 1, 1, 1, 1, 0]\n", "gear_ratio: 7\n", f"gear_ratio: [1, 1, 1, 1, 1, {10**400}]\n"],
)  # fmt: skip
def test_a_mapping_that_is_wrong(tmp_path, text):
    (tmp_path / "channels.yaml").write_text(text)
    with pytest.raises(InputError, match=r"channels\.yaml"):
        read_mapping(tmp_path / "channels.yaml")


@pytest.mark.parametrize(
    ("change", "says"),
    [
        (lambda text: text.replace("t_s", "time"), "line 1: no column t_s"),
        (lambda text: text.replace("A6_deg", "A5_deg"), "line 1: the column A5_deg is there twice"),
        (lambda text: text.replace("A6_deg", "A6_grad"), "neither six joint angles nor a tip"),
        (lambda text: text.replace("0.04,", "0.02,"), "line 6: the time 0.02 does not rise after 0.03"),
        (lambda text: text.replace("0.04,", "0.03,"), "line 6: the time 0.03 does not rise after 0.03"),
        (lambda text: text.replace("0.04,", "nan,"), "line 6: 'nan' is not a finite number"),
        (lambda text: text.replace("6.4", ""), "line 6: '' is not a finite number"),
        (lambda text: text.replace("6.4", "1e999"), "line 6: '1e999' is not a finite number"),
        (lambda text: text.replace("6.4", "1_0"), "line 6: '1_0' is not a finite number"),
        (lambda text: text.replace("6.4", "6.4,1"), "line 6: 8 cells"),
        (lambda text: text.replace("6.4", '"6.4'), "line"),
        (lambda text: text.replace("6.4", "6.4\x00"), "line 6: holds a control character"),
        (lambda text: text.splitlines()[0], "no rows"),
        (lambda text: "\n".join(text.splitlines()[:5]), "4 samples"),
        (lambda text: "", "is empty"),
        (lambda text: text.replace("t_s", ",".join(["t_s", *(f"c{n}" for n in range(500))])), "columns"),
    ],
)
def test_a_table_that_is_wrong_is_one_message(tmp_path, change, says):
    with pytest.raises(InputError) as refused:
        read_recording(written(tmp_path, change(rows(["t_s", *JOINTS]))))
    assert says in str(refused.value)
    assert "run.csv" in str(refused.value)


def test_time_may_begin_below_zero(tmp_path):
    text = rows(["t_s", *JOINTS]).replace("0.00,", "-3.5,")
    assert read_recording(written(tmp_path, text)).time[0] == -3.5


@pytest.mark.parametrize(
    "members",
    [
        {"time": [0.0, 1.0]},
        {"time": np.arange(9.0)},
        {"time": np.arange(9.0)[::-1], "joints": np.zeros((9, 6))},
        {"time": np.arange(9.0), "joints": np.zeros((8, 6))},
        {"time": np.arange(9.0), "joints": np.full((9, 6), np.nan)},
        {"time": np.arange(9.0), "tcp": np.zeros((9, 6))},
    ],
)
def test_the_noun_refuses(members):
    with pytest.raises(InputError):
        Recording(**members)
