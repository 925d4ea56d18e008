"""CAD files with bytes changed: each is read, or refused in one message; nothing is printed, and nobody crashes."""

from __future__ import annotations

import io

import ezdxf
import numpy as np
import pytest

from oracles.places import ROOT
from zerorev.errors import InputError
from zerorev.files.cad.dxf import dxf_holes, found_in_dxf
from zerorev.files.cad.step import step_holes

PANEL = ROOT / "examples/jobs/cad_panel.step"


def drawing() -> bytes:
    document = ezdxf.new("R2000")
    document.header["$INSUNITS"] = 4
    document.blocks.new("B").add_circle((1, 2), radius=3)
    for n in range(4):
        document.modelspace().add_circle((10 * n, 0), radius=2)
        document.modelspace().add_blockref("B", (0, 10 * n))
    stream = io.StringIO()
    document.write(stream)
    return stream.getvalue().encode()


def spoilt(content: bytes, rng: np.random.Generator, begins: int = 0) -> bytes:
    """Some bytes changed, a stretch taken out or doubled; the ends of the file stay."""
    start, count = (int(each) for each in (rng.integers(begins, len(content) - 400), rng.integers(1, 200)))
    match rng.integers(4):
        case 0:
            return content[:start] + content[start + count : -300] + content[-300:]
        case 1:
            return content[:start] + content[start : start + count] * 2 + content[start + count :]
        case 2:
            changed = bytearray(content)
            for at in rng.integers(begins, len(content) - 300, 5):
                changed[at] = rng.integers(256)
            return bytes(changed)
    number = rng.choice([b"1e308", b"-1e308", b"nan", b"0", b"#1", b"''", b"99999999999999999999", b"$"])
    return content[:start] + bytes(number) + content[start + len(number) :]


def test_drawings_with_bytes_changed(capfd):
    rng, content, read = np.random.default_rng(1), drawing(), 0
    capfd.readouterr()
    for _ in range(40):
        try:
            found = found_in_dxf(spoilt(content, rng), None)
        except InputError:
            pass
        else:
            read += 1
            assert all(np.isfinite(hole.entry).all() for hole in found.holes)
    assert capfd.readouterr() == ("", "")
    assert read


def test_a_damaged_drawing_prints_nothing(capfd):
    """What ezdxf logs of each entity with a handle that is used twice."""
    content = drawing()
    start = content.index(b"  0\nCIRCLE", content.index(b"ENTITIES"))
    end = content.index(b"  0\n", start + 4)
    capfd.readouterr()
    assert dxf_holes(content[:end] + content[start:end] * 50 + content[end:]).holes
    assert capfd.readouterr() == ("", "")


@pytest.mark.parametrize("count", [3, pytest.param(150, marks=pytest.mark.soak)])
def test_models_with_bytes_changed(count, capfd, record_property):
    rng, content, refused = np.random.default_rng(2), PANEL.read_bytes(), 0
    capfd.readouterr()
    for _ in range(count):
        try:
            found = step_holes(spoilt(content, rng, begins=600))
        except InputError:
            refused += 1
        else:
            assert all(np.isfinite([*hole.entry, hole.depth, hole.diameter]).all() for hole in found.holes)
    assert capfd.readouterr() == ("", "")
    record_property("measured", f"{refused} of {count} damaged STEP files are refused, the others read")
