"""A program written from a plan in memory is the program of the same plan in a file, whose last bits differ."""

from dataclasses import replace

import numpy as np
import pytest

from zerorev.files.io import plan_from_text, plan_to_json
from zerorev.files.text import json_text
from zerorev.model.profile import Profile
from zerorev.program.as_exported import as_exported
from zerorev.program.export import export
from zerorev.program.krl.dialect import KRL
from zerorev.program.krl.read import read_krl


def wrong(plan, text):
    """What the program of a plan in memory has that the plan does not, once it was in a file."""
    in_file = plan_from_text(json_text(plan_to_json(plan)), "plan.json")
    return [own.wrong for own in as_exported(in_file, read_krl(text), KRL)]


@pytest.mark.parametrize("depth_mm", [25.3, 30.0, 49.7, 12.35])
@pytest.mark.parametrize("segments", [8, 40])
def test_many_equal_moves(depth_mm, segments, published, planned, plan_of):
    """Half of a fortieth of 25.3 mm is 0.31625 mm: its last bits must not decide which digit is printed."""
    first, depth = published(1), depth_mm * 1e-3
    share = np.concatenate([np.linspace(1, 0, segments + 1), np.linspace(0, 1, segments + 1)[1:]])
    psi = -5.9388 + np.where(np.arange(share.size) <= segments, 20.1, -24.52) * share * depth_mm / 50
    hole = planned(
        replace(first.hole, depth=depth), Profile(share * depth, np.deg2rad(psi)), near=[143, -108, -79, 11, 88, 217]
    )
    plan = plan_of(hole, blend=5e-3)
    text = export(plan).text
    assert wrong(plan, text) == [()]
    assert text.count("$APO.CDIS") == 1 + (depth_mm / segments > 5)


@pytest.mark.parametrize("feed", [0.0045675, 0.0045674999, 1 / 300, 0.00299925])
def test_feeds_between_two_printed_digits(feed, published, plan_of):
    plan = plan_of(published(1), feed_plunge=feed, feed_retract=2 * feed)
    assert wrong(plan, export(plan).text) == [()]


def test_a_turn_at_a_whole_number_of_degrees_a_second(published, planned, plan_of):
    """18 deg over 1 mm at 20 mm/s are 360 deg/s, and 432 with the reserve: the last bits do not decide."""
    first = published(1)
    near, psi = [143, -108, -79, 11, 88, 217], np.deg2rad([12.0, 2.0, -16.0])
    hole = planned(replace(first.hole, depth=1e-3), Profile(np.array([1e-3, 0.0, 1e-3]), psi), near=near)
    plan = plan_of(hole, feed_plunge=0.01, feed_retract=0.02, blend=1e-4)
    text = export(plan).text
    assert "$VEL.ORI1=432.0" in text
    assert wrong(plan, text) == [()]
