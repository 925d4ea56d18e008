"""KRC4 traces through their real bytes: written by hand as controllers do, or by the writer."""

from __future__ import annotations

import struct
import subprocess
import sys

import numpy as np
import pytest

from oracles.recordings import kick, run_of
from zerorev.cell.recordings.channels import Mapping
from zerorev.cell.recordings.krc4 import modules_of, read_krc4
from zerorev.cell.recordings.krc4_write import write_krc4
from zerorev.cell.recordings.read import read_recording
from zerorev.errors import InputError
from zerorev.model.recording import JOINT_ARRAYS, TIP_ARRAYS

MEMBERS = ("time", *JOINT_ARRAYS, *TIP_ARRAYS)


@pytest.fixture(scope="module")
def run(robot, tool):
    from oracles.published import POSITIONS

    return run_of(robot, tool, POSITIONS[1], error=kick, tips=True, noise=1e-5).recording


def by_hand(folder, name, columns, *, step=0.012, count=None, order="<", encoding="cp1252", offset=0.0, more=""):
    """A module as a controller writes it: (name, unit, factor, offset, values) of each column."""
    rows = len(columns[0][4])
    high = "High -> Low" if order == ">" else "Low -> High"
    lines = ["DIAEXTENDED  {@:ENGLISH", "#BEGINGLOBALHEADER", "1,WINDOWS", f"112,{high}", "111,9.9E+34"]
    lines += [
        "102,A comment",
        "of two lines",
        "#ENDGLOBALHEADER",
        "#BEGINCHANNELHEADER",
        "200,Zeit",
        "201,Zeitkanal für alle",
        "202,s",
    ]
    lines += ["210,IMPLIZIT", f"220,{count or rows}", f"240,{offset}", f"241,{step}", "#ENDCHANNELHEADER"]
    for n, (channel, unit, factor, shift, _) in enumerate(columns, 1):
        lines += ["#BEGINCHANNELHEADER", f"200,{channel}", f"202,{unit}", "210,EXPLIZIT", f"211,{name}.r64"]
        lines += ["213,BLOCK", "214,REAL64", f"220,{count or rows}", f"221,{n}", f"240,{shift}", f"241,{factor}"]
        lines += [*([more] if more else []), "#ENDCHANNELHEADER"]
    (folder / f"{name}.dat").write_bytes("\r\n".join(lines).encode(encoding))
    numbers = [column[4][k] for k in range(rows) for column in columns]
    (folder / f"{name}.r64").write_bytes(struct.pack(f"{order}{len(numbers)}d", *numbers))


def drives(folder, stem="T", *, rows=50, step=0.012, **options):
    """Six drives that turn at 1 deg per sample and joint; positions are stored in units of 0.5 deg, less 3."""
    for n in range(1, 7):
        angle = [n * k for k in range(rows)]
        stored = [(value - 3.0) / 0.5 for value in angle]
        columns = [
            ("Sollposition", "°", 0.5, 3.0, stored),
            ("Istposition", "Grad", 0.5, 3.0, stored),
            ("Motortemperatur", "°C", 1.0, 0.0, [300.0] * rows),
            ("Istmoment", "Nm", 1.0, 0.0, [0.1 * n] * rows),
        ]
        by_hand(folder, f"{stem}_NextGenDrive#{n}", columns, step=step, **options)


@pytest.mark.parametrize("order", ["<", ">"])
@pytest.mark.parametrize("encoding", ["cp1252", "utf-8", "latin-1"])
def test_a_trace_as_a_controller_writes_it(tmp_path, order, encoding):
    drives(tmp_path, order=order, encoding=encoding)
    found = read_recording(tmp_path / "T_NextGenDrive#3.dat")
    assert np.allclose(found.time, 0.012 * np.arange(50), rtol=0, atol=1e-15)
    assert np.allclose(np.rad2deg(found.joints), np.outer(np.arange(50), np.arange(1, 7)), rtol=0, atol=1e-12)
    assert np.array_equal(found.joints, found.joints_commanded)
    assert np.allclose(found.torque, 0.1 * np.arange(1, 7))
    assert found.tcp is None
    assert found.torque_commanded is None
    assert found.other_channels == ()
    assert found.findings == ()


@pytest.mark.parametrize("name", ["T", "T_NextGenDrive#1.dat", "T_NextGenDrive#6.r64", "T_KRCIpo.dat", "t_krcipo.R64"])
def test_the_modules_are_found_from_any_of_them(tmp_path, name):
    drives(tmp_path)
    by_hand(tmp_path, "T_KRCIpo", [("Override", "%", 1, 0, [100.0] * 50)])
    by_hand(tmp_path, "Other_KRCIpo", [("Override", "%", 1, 0, [100.0] * 50)])
    assert len(modules_of(tmp_path / name)) == 7
    found = read_recording(tmp_path / name)
    assert found.other_channels == ("KRCIpo/Override",)
    assert [finding.kind for finding in found.findings] == ["channels"]
    assert "KRCIpo/Override" in found.findings[0].message


def test_rates_that_differ_are_resampled_to_the_finest(tmp_path):
    drives(tmp_path, step=0.012)
    path = 0.004 * np.arange(140)
    tip = [(f"{axis}_mm", "mm", 1, 0, (100 * path + n).tolist()) for n, axis in enumerate("XYZ")]
    by_hand(tmp_path, "T_KRCIpo", tip, step=0.004, offset=0.02)
    found = read_krc4(tmp_path / "T")
    assert np.allclose(np.diff(found.time), 0.004)
    assert (found.time[0], found.time[-1]) == pytest.approx((0.02, min(0.02 + 139 * 0.004, 49 * 0.012)))
    # what was linear in time is so between samples
    assert np.allclose(np.rad2deg(found.joints), np.outer(found.time / 0.012, np.arange(1, 7)), rtol=0, atol=1e-9)
    assert np.array_equal(found.tcp[:, 0], (100 * path * 1e-3)[: found.time.size])
    assert [finding.kind for finding in found.findings] == ["resampled"]
    assert "12 ms are resampled to 4 ms" in found.findings[0].message


def test_a_mapping_names_channels_and_gears(tmp_path):
    for n in range(1, 7):
        columns = [("Lage", "", 1, 0, [100.0 * n + k for k in range(20)])]
        by_hand(tmp_path, f"T_NextGenDrive#{n}", columns)
    with pytest.raises(
        InputError, match=r"neither six joint angles nor a tip; of unknown meaning: NextGenDrive#1/Lage"
    ):
        read_krc4(tmp_path / "T")
    channels = {f"NextGenDrive#{n}/Lage": f"A{n}_rad" for n in range(1, 7)}
    ratio = (100.0, -100.0, 1.0, 1.0, 2.0, 1.0)
    found = read_krc4(tmp_path / "T", Mapping(channels, ratio))
    assert np.allclose(found.joints[0], 100.0 * np.arange(1, 7) / ratio)


def test_a_drive_that_is_missing_is_reported(tmp_path):
    drives(tmp_path)
    (tmp_path / "T_NextGenDrive#4.dat").unlink()
    with pytest.raises(InputError, match="neither six joint angles"):
        read_krc4(tmp_path / "T")
    by_hand(tmp_path, "T_KRCIpo", [(f"{axis}_mm", "mm", 1, 0, [float(k) for k in range(50)]) for axis in "XYZ"])
    found = read_krc4(tmp_path / "T")
    assert found.joints is None
    assert any("A4_deg are missing" in finding.message for finding in found.findings)


@pytest.mark.parametrize("lost", [1, 8, 31])
def test_a_torn_last_row_is_dropped_and_said(tmp_path, lost):
    drives(tmp_path)
    whole = read_krc4(tmp_path / "T")
    file = tmp_path / "T_NextGenDrive#2.r64"
    file.write_bytes(file.read_bytes()[:-lost])
    found = read_krc4(tmp_path / "T")
    assert np.array_equal(found.joints, whole.joints[:-1])
    assert [finding.kind for finding in found.findings] == ["rows_dropped"]
    assert "NextGenDrive#2" in found.findings[0].message


@pytest.mark.parametrize("change", [lambda data: data[:-65], lambda data: data + bytes(8), lambda data: b""])
def test_numbers_that_do_not_fit_the_header_are_refused(tmp_path, change):
    drives(tmp_path)
    file = tmp_path / "T_NextGenDrive#2.r64"
    file.write_bytes(change(file.read_bytes()))
    with pytest.raises(InputError, match=r"NextGenDrive#2\.r64: .* do not fit the file|2 samples|0 samples"):
        read_krc4(tmp_path / "T")


def test_values_beyond_the_range_of_the_header_are_refused(tmp_path):
    # as many numbers as three channels have, but they are of two
    drives(tmp_path, more="250,-1000\r\n251,1000")
    read_krc4(tmp_path / "T")
    drives(tmp_path, more="250,-1000\r\n251,7")
    with pytest.raises(InputError, match="beyond the -1000 to 7 of the header"):
        read_krc4(tmp_path / "T")


def test_no_value_is_dropped_of_positions_and_starts_the_torque(tmp_path):
    drives(tmp_path)
    for n in range(1, 7):
        angle = [float(k) for k in range(50)]
        columns = [
            ("Istposition", "deg", 1, 0, [9.9e34, *angle[1:]] if n == 2 else angle),
            ("Sollmoment", "Nm", 1, 0, [9.9e34] * 20 + [0.0] * 5 + [1.0] * 25),
        ]
        by_hand(tmp_path, f"T_NextGenDrive#{n}", columns)
    found = read_krc4(tmp_path / "T")
    assert found.time.size == 49
    assert found.time[0] == pytest.approx(0.012)
    assert found.commanded_from == pytest.approx(20 * 0.012)  # "even if zero"
    assert not found.torque_commanded[:24].any()
    assert "1 of 50 samples" in found.findings[0].message


def test_channels_one_after_the_other(tmp_path):
    drives(tmp_path)
    values = np.arange(50.0)
    lines = (tmp_path / "T_NextGenDrive#1.dat").read_bytes().decode("cp1252").replace("213,BLOCK", "213,CHANNEL")
    for n in (4, 3, 2):
        lines = lines.replace(f"221,{n}", f"221,{50 * (n - 1) + 1}")
    (tmp_path / "T_NextGenDrive#1.dat").write_bytes(lines.encode("cp1252"))
    (tmp_path / "T_NextGenDrive#1.r64").write_bytes(np.concatenate([values, values + 7, values, values * 2]).tobytes())
    found = read_krc4(tmp_path / "T")
    assert np.allclose(np.rad2deg(found.joints_commanded[:, 0]), 0.5 * values + 3)
    assert np.allclose(np.rad2deg(found.joints[:, 0]), 0.5 * (values + 7) + 3)
    assert np.array_equal(found.torque[:, 0], values * 2)


def test_a_clock_in_the_file(tmp_path):
    drives(tmp_path)
    clock = 0.01 * np.arange(50) + 0.001 * (np.arange(50) % 2)
    for n in range(1, 7):
        dat = tmp_path / f"T_NextGenDrive#{n}.dat"
        by_hand(tmp_path, dat.stem, [("Zeit", "s", 1, 0, clock.tolist()), ("Istposition", "rad", 1, 0, clock.tolist())])
        text = dat.read_bytes().decode("cp1252")
        head, _, rest = text.partition("#BEGINCHANNELHEADER\r\n200,Zeit\r\n201")
        dat.write_bytes((head + rest.partition("#ENDCHANNELHEADER\r\n")[2]).encode("cp1252"))
    found = read_krc4(tmp_path / "T")
    assert np.array_equal(found.time, clock)
    assert np.array_equal(found.joints, np.repeat(clock[:, None], 6, axis=1))
    back = clock.copy()
    back[30] = back[20]
    by_hand(tmp_path, "U", [("Zeit", "s", 1, 0, back.tolist()), ("X_m", "m", 1, 0, clock.tolist())])
    dat = tmp_path / "U.dat"
    head, _, rest = dat.read_bytes().decode("cp1252").partition("#BEGINCHANNELHEADER\r\n200,Zeit\r\n201")
    dat.write_bytes((head + rest.partition("#ENDCHANNELHEADER\r\n")[2]).encode("cp1252"))
    with pytest.raises(InputError, match=r"U\.r64, byte 480: the time does not rise"):
        read_krc4(dat)


@pytest.mark.parametrize(
    ("before", "after", "says"),
    [
        (b"DIAEXTENDED", b"SOMETHING", "line 1: does not begin as the header"),
        (b"241,0.012", b"241,-0.012", "a time step"),
        (b"241,0.012", b"241,nan", "'nan' is not a number"),
        (b"220,50", b"220,1e99", "is not a count"),
        (b"213,BLOCK", b"213,CLOCK", "213"),
        (b"214,REAL64", b"214,INT16", "214"),
        (b"210,IMPLIZIT", b"210,UNDEUTLICH", "210"),
        (b"221,2", b"221,7", "are not 1, 2, 3"),
        (b"202,s", b"202,h", "the time is in 'h'"),
        (b"211,T_NextGenDrive#1.r64", b"211,../../etc/passwd", "names a folder"),
        (b"240,3.0", b"240;3.0", "is not a code, a comma and a value"),
    ],
)
def test_a_header_that_is_wrong_is_one_message(tmp_path, before, after, says):
    drives(tmp_path)
    file = tmp_path / "T_NextGenDrive#1.dat"
    file.write_bytes(file.read_bytes().replace(before, after))
    with pytest.raises(InputError, match=r"NextGenDrive#1\.(dat|r64)") as refused:
        read_krc4(file)
    assert says in str(refused.value)


@pytest.mark.parametrize("big_endian", [False, True])
def test_what_is_written_is_read_bit_for_bit(tmp_path, run, big_endian):
    write_krc4(run, tmp_path / "a", angle="rad", big_endian=big_endian)
    found = read_recording(tmp_path / "a")
    for name in MEMBERS[1:]:
        assert np.array_equal(getattr(found, name), getattr(run, name)), name
    assert np.allclose(found.time, run.time, rtol=0, atol=1e-12)
    assert found.commanded_from == pytest.approx(run.commanded_from)
    assert found.findings == ()
    write_krc4(found, tmp_path / "b", angle="rad", big_endian=big_endian)
    pairs = [(file, tmp_path / file.name.replace("a_", "b_", 1)) for file in sorted(tmp_path.glob("a_*.r64"))]
    assert len(pairs) == 7
    assert all(one.read_bytes() == other.read_bytes() for one, other in pairs)


def test_degrees_lose_no_more_than_rounding(tmp_path, run):
    write_krc4(run, tmp_path / "a")
    found = read_recording(tmp_path / "a")
    for name in MEMBERS:
        assert np.allclose(getattr(found, name), getattr(run, name), rtol=0, atol=2e-15), name


def test_uneven_time_is_not_written(tmp_path, run):
    from dataclasses import replace

    time = run.time.copy()
    time[7] += 1e-4
    with pytest.raises(InputError, match="not even"):
        write_krc4(replace(run, time=time), tmp_path / "a")


@pytest.mark.long
def test_a_trace_of_a_gibibyte_is_read_in_bounded_memory(tmp_path):
    rows = 2**30 // 6 // 4 // 8  # six files of four channels
    for n in range(1, 7):
        name = f"T_NextGenDrive#{n}"
        columns = [(each, "rad", 1, 0, [0.0]) for each in ("Sollposition", "Istposition", "Strom", "Spannung")]
        by_hand(tmp_path, name, columns, count=rows, step=0.001)
        with (tmp_path / f"{name}.r64").open("r+b") as stream:
            stream.truncate(rows * 32)
            stream.seek((rows // 2) // 16 * 16 * 32)
            stream.write(struct.pack("<4d", n, n, 0, 0))
    code = (
        "import resource, sys, numpy as np; from zerorev.cell.recordings.read import read_recording;"
        "before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss;"
        "found = read_recording(sys.argv[1]);"
        "print(found.time.size, [f.kind for f in found.findings], np.abs(found.joints).max(axis=0).tolist());"
        "print((resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before) // 1024)"
    )
    done = subprocess.run(
        [sys.executable, "-c", code, str(tmp_path / "T")], capture_output=True, text=True, timeout=300
    )
    assert done.returncode == 0, done.stderr
    about, used = done.stdout.splitlines()
    assert int(about.split()[0]) <= 500_000
    assert "resampled" in about
    assert int(used) < 400, f"{used} MiB"
