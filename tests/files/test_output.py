"""Paths are examined before, and files written whole or not at all."""

from __future__ import annotations

import os
import platform
import subprocess
import sys

import pytest

from zerorev.errors import OutputError
from zerorev.files import output


def test_writes(tmp_path):
    output.write_bytes(tmp_path / "a", b"1")
    output.write_bytes(tmp_path / "a", b"2")
    assert (tmp_path / "a").read_bytes() == b"2"
    assert [path.name for path in tmp_path.iterdir()] == ["a"]


def test_what_a_killed_process_left_is_cleared(tmp_path):
    """And nothing else: not of a process that runs, of another machine, of another file."""
    ended = subprocess.Popen([sys.executable, "-c", ""])
    ended.wait()
    here = platform.node()
    gone = [f".a.{here}-{ended.pid}.tmp", f".a.{here}-{ended.pid}.old"]
    stays = [f".a.{here}-{os.getppid()}.tmp", f".a.elsewhere-{ended.pid}.tmp", f".b.{here}-{ended.pid}.tmp", ".a.tmp"]
    (tmp_path / gone[0]).mkdir()
    (tmp_path / gone[0] / "f").touch()
    for name in [gone[1], *stays]:
        (tmp_path / name).touch()
    output.write_bytes(tmp_path / "a", b"1")
    assert sorted(path.name for path in tmp_path.iterdir()) == sorted([*stays, "a"])


def test_through_a_link(tmp_path):
    (tmp_path / "real").write_bytes(b"1")
    (tmp_path / "link").symlink_to("real")
    output.write_bytes(tmp_path / "link", b"2")
    assert (tmp_path / "link").is_symlink()
    assert (tmp_path / "real").read_bytes() == b"2"


@pytest.mark.parametrize("check", [output.check_file, output.check_folder, output.make_folder])
def test_no_such_folder(check, tmp_path):
    with pytest.raises(OutputError, match=r"the folder .*no does not exist"):
        check(tmp_path / "no" / "x")


def test_a_folder_is_not_a_file(tmp_path):
    with pytest.raises(OutputError, match="it is a folder"):
        output.check_file(tmp_path)


def test_a_file_is_not_a_folder(tmp_path):
    (tmp_path / "f").touch()
    with pytest.raises(OutputError, match="it is a file"):
        output.check_folder(tmp_path / "f")
    with pytest.raises(OutputError, match="is not a folder"):
        output.check_folder(tmp_path / "f" / "g")


@pytest.mark.parametrize("check", [output.check_file, output.check_folder])
def test_no_permission(check, tmp_path, monkeypatch):
    # root may write everywhere, so let the system's answer be given
    monkeypatch.setattr(os, "access", lambda *_: False)
    with pytest.raises(OutputError, match="no write permission"):
        check(tmp_path / "x")
    assert list(tmp_path.iterdir()) == []


def test_a_null_byte():
    with pytest.raises(OutputError, match="null"):
        output.check_file(output.Path("a\0b"))


def test_makes_one_folder(tmp_path):
    output.make_folder(tmp_path / "f")
    output.make_folder(tmp_path / "f")
    assert (tmp_path / "f").is_dir()
