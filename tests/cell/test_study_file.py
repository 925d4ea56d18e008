"""A study on disk comes back as it was."""

from __future__ import annotations

from dataclasses import fields, replace

import numpy as np
import pytest

pytest.importorskip("zarr")

from zerorev.cell.ensemble import study
from zerorev.cell.parameters import drawn
from zerorev.cell.reference import Manner
from zerorev.cell.study_file import StudyFolder, read_holes


def same(one, other):
    for field in fields(one):
        np.testing.assert_array_equal(getattr(one, field.name), getattr(other, field.name))


def test_comes_back_as_it_was(published_plan, tmp_path):
    plan, sets, manner = replace(published_plan, holes=published_plan.holes[:1]), drawn(2, 0), Manner(feed=0.2)
    (hole,) = study(plan, sets, manner=manner, motions=())
    path = tmp_path / "study.zarr"
    StudyFolder(path, plan, sets, 0, manner, 0.0).add(0, hole)
    (found,) = read_holes(path)
    same(found, hole)
