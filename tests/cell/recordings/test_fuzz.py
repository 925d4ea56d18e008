"""Bytes of good files changed, hundreds of times: each is refused in one message, or what it holds is finite."""

from __future__ import annotations

import gzip
import random
import warnings
from collections import Counter

import numpy as np
import pytest

from oracles.hostile_inputs import changed_bytes
from oracles.published import POSITIONS
from oracles.recordings import kick, run_of
from oracles.rsi_peer import FIRST, document
from zerorev.cell.recordings.channels import read_mapping
from zerorev.cell.recordings.holes import read_holes
from zerorev.cell.recordings.krc4_write import write_krc4
from zerorev.cell.recordings.metrics import metrics
from zerorev.cell.recordings.read import read_recording
from zerorev.cell.recordings.run import drilling_run
from zerorev.cell.recordings.table import write_csv
from zerorev.errors import ZerorevError
from zerorev.model.recording import JOINT_ARRAYS, TIP_ARRAYS

HOLES = b"hole,depth_mm,diameter_mm,x_mm,y_mm\nA1,1,6.01,0.03,0.04\nA1,9,6.03,0.05,0.12\nB,1,6,0,0\n"
MAPPING = b"channels:\n  Lage Achse 1: A1_deg\n  GearTorque.A1: A1_torque_nm\ngear_ratio: [1, 2, 3, 4, 5, -6]\n"
KINDS = ("csv", "dat", "r64", "xml", "gz", "holes", "mapping")


@pytest.fixture(scope="module")
def good(tmp_path_factory, robot, tool):
    """A good file of each kind, and the folder of a trace."""
    folder = tmp_path_factory.mktemp("good")
    run = run_of(robot, tool, POSITIONS[1], interval=0.02, before=10, tips=True, error=kick).recording
    write_csv(run, folder / "run.csv")
    write_krc4(run, folder / "T")
    documents = b"\n".join(document(FIRST + 4 * n, n) for n in range(60))
    return {
        "csv": (folder / "run.csv").read_bytes(), "dat": (folder / "T_KRCIpo.dat").read_bytes(),
        "r64": (folder / "T_KRCIpo.r64").read_bytes(), "xml": documents, "gz": gzip.compress(documents, mtime=0),
        "holes": HOLES, "mapping": MAPPING, "folder": folder,
    }  # fmt: skip


def tried(good, kind, data):
    """What became of it: refused, or read."""
    folder = good["folder"]
    path = folder / {"dat": "T_KRCIpo.dat", "r64": "T_KRCIpo.r64"}.get(kind, f"changed.{kind}")
    before = path.read_bytes() if path.exists() else None
    path.write_bytes(data)
    try:
        if kind in ("holes", "mapping"):
            (read_holes if kind == "holes" else read_mapping)(path)
            return "read"
        recording = read_recording(path)
        for name in ("time", *JOINT_ARRAYS, *TIP_ARRAYS):
            array = getattr(recording, name)
            assert array is None or np.isfinite(array).all(), name
        assert (np.diff(recording.time) > 0).all()
        found = metrics(drilling_run(recording))
        assert np.isfinite([found.deviation_max, found.deviation_rms, found.path_length]).all()
        return "measured"
    except ZerorevError as error:
        return "refused" if len(str(error)) < 2_000 and "\x1b" not in str(error) else "refused badly"
    finally:
        if before is not None and kind in ("dat", "r64"):
            path.write_bytes(before)


def fuzzed(good, count, seed):
    chance = random.Random(seed)
    seen: Counter[tuple[str, str]] = Counter()
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        for n in range(count):
            kind = KINDS[n % len(KINDS)]
            seen[kind, tried(good, kind, changed_bytes(good[kind], chance))] += 1
    return seen


def test_good_files_are_measured(good):
    assert tried(good, "csv", good["csv"]) == "measured"
    assert tried(good, "dat", good["dat"]) == "measured"
    assert tried(good, "holes", good["holes"]) == "read"
    assert tried(good, "mapping", good["mapping"]) == "read"


@pytest.mark.long
def test_two_hundred_changed_files(good, record_property):
    seen = fuzzed(good, 210, seed=18)
    record_property("measured", f"recordings fuzzed: {dict(sorted(seen.items()))}")
    assert sum(seen.values()) == 210
    assert {kind for kind, what in seen if what == "refused"} == set(KINDS)
    assert "refused badly" not in {what for _, what in seen}


@pytest.mark.soak
def test_five_thousand_changed_files(good):
    assert "refused badly" not in {what for _, what in fuzzed(good, 5_000, seed=19)}
