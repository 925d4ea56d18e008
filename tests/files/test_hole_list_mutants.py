"""A thousand lists of holes, written and damaged in many ways: each is read rightly or refused with its line."""

from __future__ import annotations

import re
from collections import Counter

import numpy as np
import pytest

from oracles.hole_lists import DAMAGES, written
from zerorev.errors import InputError
from zerorev.files import io
from zerorev.files.hole_list import in_base_frame, read_hole_list, text_of_list
from zerorev.files.hole_meaning import Meaning
from zerorev.files.table_layout import Given

FRAME = {"robot": "kuka_kr6_r700_2", "tool": "thesis_drill", "psi_reference": [0.123, 0.456, 0.789]}


def check(folder, seed, damage=None):
    """Whether a list was read; that it was read rightly, or refused with its line, here and by the app."""
    made = written(seed, damage)
    said = f"seed {seed}, {made.damage or 'whole'}, {made.keys}:\n{made.content[:600]!r}"
    (folder / "holes.csv").write_bytes(made.content)
    try:
        job = io.job_from_dict(FRAME | made.keys | {"holes": "holes.csv"}, folder)
    except InputError as error:
        job, message = None, str(error)
    if job is None:
        assert re.search(r"line \d+", message), f"{said}\n{message}"
        assert "accepted" in message, f"{said}\n{message}"
    else:
        right(made, job.holes, said)
    in_the_app(made, said)
    return made.damage, job is not None


def in_the_app(made, said):
    """The same table pasted: each good row is one of the holes, unless the numbers were pasted as they are."""
    keys = made.keys
    given = Given(keys.get("columns", {}), keys.get("unit"), None, header=bool(keys.get("columns")))
    meaning = Meaning(keys.get("normals", "in"), keys.get("point", "bottom"), keys.get("depth_mm"))
    try:
        listed = in_base_frame(read_hole_list(text_of_list(made.content), given, meaning), [0.123, 0.456, 0.789],
                               io.read_tool("thesis_drill"), np.eye(4))  # fmt: skip
    except InputError:
        return
    if made.damage in ("no header", "text in a cell"):  # in the order that is shown above the rows; an id of "x"
        return
    good = [row.hole is not None for row in listed.rows]
    for at, row in enumerate(listed.rows):
        # what stands beside a row that is shown as bad may be a part of it
        if row.hole is not None and all(good[max(at - 1, 0) : at + 2]):
            n = made.ids.index(row.hole.id)
            same(made, n, row.hole, said)


def right(made, holes, said):
    kept = [hole.id for hole in holes]
    if made.damage != "text in a cell":  # of an id, another text is another id
        assert kept == made.ids, said
    assert len(holes) == len(made.ids), said
    for n, hole in enumerate(holes):
        same(made, n, hole, said)


def same(made, n, hole, said):
    far = made.tolerance
    np.testing.assert_allclose(hole.target * 1e3, made.bottom[n], atol=2 * far + 60 * 1e-5 * (far > 1e-6), err_msg=said)
    np.testing.assert_allclose(hole.direction, made.into[n], atol=2e-2 if far > 1e-4 else 2e-5, err_msg=said)
    assert hole.depth * 1e3 == pytest.approx(made.depth[n], abs=2 * far), said


def test_a_hundred_lists_are_read_rightly_or_refused(tmp_path):
    outcomes = Counter(check(tmp_path, seed) for seed in range(100))
    whole = outcomes["", True], outcomes["", False]
    assert whole[0] >= 9 * whole[1] > 0 or whole[1] == 0
    assert whole[0] > 20


@pytest.mark.parametrize("damage", DAMAGES)
def test_no_damage_is_read_wrongly(damage, tmp_path):
    for seed in range(6):
        check(tmp_path, seed, damage)


@pytest.mark.soak
def test_a_thousand_lists_and_more_are_read_rightly_or_refused(tmp_path):
    outcomes = Counter(check(tmp_path, seed) for seed in range(100, 6100))
    assert outcomes["", True] >= 9 * outcomes["", False]
