"""RSI captures: documents in lines, back to back and in gzip; cycles that are missing, repeated, or not XML."""

from __future__ import annotations

import gzip
import tracemalloc

import numpy as np
import pytest

from zerorev.cell.recordings import rsi
from zerorev.cell.recordings.channels import Mapping
from zerorev.cell.recordings.read import read_recording
from zerorev.errors import InputError

FIRST = 4208163634


def document(n, *, ipoc=None, extra="", joints=True, tip=True):
    axes = " ".join(f'A{k}="{k + n / 1000}"' for k in range(1, 7))
    places = f'X="{100 + n}" Y="2.5" Z="-3" A="1" B="2" C="3"'
    parts = [f"<RIst {places} /><RSol {places}/>" if tip else "", f"<AIPos {axes}/><ASPos {axes}/>" if joints else ""]
    counter = FIRST + 4 * n if ipoc is None else ipoc
    return f'<Rob Type="KUKA">{"".join(parts)}<MACur {axes}/><Delay D="0"/>{extra}<IPOC>{counter}</IPOC></Rob>'


def capture(folder, documents, between="\n", packed=False):
    path = folder / ("run.xml.gz" if packed else "run.xml")
    data = between.join(documents).encode()
    path.write_bytes(gzip.compress(data) if packed else data)
    return path


@pytest.mark.parametrize("between", ["\n", "", "\r\n", "\n\n  "])
@pytest.mark.parametrize("packed", [False, True])
def test_a_capture(tmp_path, between, packed):
    found = read_recording(capture(tmp_path, [document(n) for n in range(40)], between, packed))
    assert np.allclose(found.time, 0.004 * np.arange(40))
    assert np.allclose(np.rad2deg(found.joints[:, 2]), 3 + np.arange(40) / 1000)
    assert np.array_equal(found.joints, found.joints_commanded)
    assert np.allclose(found.tcp[:, 0], 0.1 + np.arange(40) / 1000)
    assert found.torque is None
    assert [finding.kind for finding in found.findings] == ["no_torque"]


def test_pieces_may_end_anywhere(tmp_path, monkeypatch):
    path = capture(tmp_path, [document(n) for n in range(20)])
    whole = read_recording(path)
    for size in (1, 7, 64, 333):
        monkeypatch.setattr(rsi, "PIECE", size)
        assert np.array_equal(read_recording(path).joints, whole.joints)


def test_a_document_may_have_a_declaration_and_comments(tmp_path):
    documents = [document(n).replace("<AIPos", "<!-- x --><AIPos") for n in range(20)]
    found = read_recording(capture(tmp_path, ["<?xml version='1.0' encoding='UTF-8'?>" + each for each in documents]))
    assert np.array_equal(found.joints, read_recording(capture(tmp_path, [document(n) for n in range(20)])).joints)


def test_lost_cycles_are_counted_and_not_filled(tmp_path):
    documents = [document(n) for n in range(40) if n not in (5, 20, 21, 22)]
    found = read_recording(capture(tmp_path, documents))
    assert found.time.size == 36
    assert found.findings[0].kind == "lost_cycles"
    assert found.findings[0].message.startswith("4 cycles of 4 ms are missing")


def test_repeated_documents_are_dropped(tmp_path):
    documents = [document(n) for n in range(20)]
    found = read_recording(capture(tmp_path, [*documents[:10], documents[9], *documents[10:]]))
    assert found.time.size == 20
    assert "1 documents repeat" in found.findings[0].message


def test_what_is_there_is_taken(tmp_path):
    assert read_recording(capture(tmp_path, [document(n, tip=False) for n in range(9)])).tcp is None
    assert read_recording(capture(tmp_path, [document(n, joints=False) for n in range(9)])).joints is None
    with pytest.raises(InputError, match="neither six joint angles nor a tip"):
        read_recording(capture(tmp_path, [document(n, joints=False, tip=False) for n in range(9)]))


def test_user_elements_are_named_and_can_be_mapped(tmp_path):
    torque = "<GearTorque " + " ".join(f'A{k}="{k}.5"' for k in range(1, 7)) + "/><Text>ready</Text>"
    path = capture(tmp_path, [document(n, extra=torque) for n in range(12)])
    found = read_recording(path)
    assert "GearTorque.A1" in found.other_channels
    mapped = read_recording(path, Mapping({f"GearTorque.A{k}": f"A{k}_torque_nm" for k in range(1, 7)}))
    assert mapped.torque[3].tolist() == [1.5, 2.5, 3.5, 4.5, 5.5, 6.5]
    assert mapped.other_channels == ("Text",)


def test_an_element_that_comes_later_leaves_samples_without_value(tmp_path):
    documents = [document(n, joints=n > 3) for n in range(30)]
    found = read_recording(capture(tmp_path, documents))
    assert found.time.size == 26
    assert any(finding.kind == "rows_dropped" for finding in found.findings)


BOMB = '<!DOCTYPE x [<!ENTITY a "aaaa">]>'


@pytest.mark.parametrize(
    ("documents", "says"),
    [
        ([BOMB + document(0)], "document 1: holds a document type"),
        ([document(0).replace("<AIPos", "<!ELEMENT x ANY><AIPos")], "document 1: is not XML"),
        ([document(0).replace("<AIPos", "&a;<AIPos")], "document 1: is not XML"),
        (["<?xml version='1.0' encoding='utf-7'?>" + document(0)], "document 1: is not XML"),
        ([document(0), document(1).replace("<AIPos", "<AIPos <")], "document 2: is not XML"),
        ([document(0), document(1).replace("IPOC", "IPAC")], "document 2: no IPOC"),
        ([document(0), document(1, ipoc="x")], "document 2: the IPOC 'x'"),
        ([document(1), document(0)], "document 2: the IPOC"),
        ([document(0), document(1).replace('A3="3.001"', 'A3="nan"')], "document 2, AIPos.A3: 'nan' is not a number"),
        ([document(0)[:-6]], "the last document does not end"),
        (["<Rob>" + " " * 70_000 + document(0)], "a document of more than 65,535 bytes"),
        (["<html></html>"], "does not end"),
        ([document(n) for n in range(3)], "3 samples"),
    ],
)  # fmt: skip
def test_a_capture_that_is_wrong_is_one_message(tmp_path, documents, says):
    with pytest.raises(InputError) as refused:
        read_recording(capture(tmp_path, documents))
    assert says in str(refused.value)
    assert "run.xml" in str(refused.value)


def test_gzip_that_is_damaged_or_a_bomb(tmp_path, monkeypatch):
    path = capture(tmp_path, [document(n) for n in range(40)], packed=True)
    path.write_bytes(path.read_bytes()[:-20])
    with pytest.raises(InputError, match="is damaged"):
        read_recording(path)
    path.write_bytes(gzip.compress(b" " * 50_000_000))
    tracemalloc.start()
    with pytest.raises(InputError, match="more than 65,535 bytes"):
        read_recording(path)
    assert tracemalloc.get_traced_memory()[1] < 5e6
    tracemalloc.stop()
    monkeypatch.setattr(rsi, "MAX_UNPACKED", 500_000)
    monkeypatch.setattr(rsi, "PIECE", 1_000)
    path.write_bytes(gzip.compress(("\n".join(document(n) for n in range(2_000))).encode()))
    with pytest.raises(InputError, match="MiB"):
        read_recording(path)


@pytest.mark.parametrize(
    ("counters", "cycle", "lost"),
    [([], 0, 0), ([7], 0, 0), ([0, 4, 8, 12], 4, 0), ([0, 12, 24, 60, 72], 12, 2), ([0, 4, 8, 13, 17, 21], 4, 0)],
)
def test_lost_cycles(counters, cycle, lost):
    assert rsi.lost_cycles(counters) == (cycle, lost)
