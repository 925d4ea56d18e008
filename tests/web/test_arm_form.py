"""What a simulation is asked for: numbers as people type them, and what is wrong beside the field."""

from __future__ import annotations

import pytest

pytest.importorskip("nicegui")

from zerorev.model.job import Settings
from zerorev.web.real_arm import Asked
from zerorev.web.views.arm_form import asked_of

TYPED = {"arms": "40", "seed": "0", "feed": "", "thrust": ""}


def test_what_is_left_empty_is_as_the_job_has_it():
    assert asked_of(TYPED, Settings(thrust=30.0)) == (Asked(40, 0, None, 30.0), {})
    typed = {"arms": " 7 ", "seed": "12", "feed": "2,5", "thrust": "0"}
    assert asked_of(typed, Settings(thrust=30.0)) == (Asked(7, 12, 0.0025, 0.0), {})


@pytest.mark.parametrize(
    ("name", "typed"),
    [
        *(("arms", typed) for typed in ("", "0", "2.5", "1001", "many", None)),
        *(("seed", typed) for typed in ("", "-1", "0.5", "4294967296", "nan")),
        *(("feed", typed) for typed in ("0", "-5", "inf", "nan", "fast", "1_0")),
        *(("thrust", typed) for typed in ("-1", "1e6", "nan", "a lot")),
    ],
)
def test_what_cannot_be_used_is_said_beside_its_field(name, typed):
    asked, wrong = asked_of(TYPED | {name: typed}, Settings())
    assert asked is None
    assert list(wrong) == [name]
    assert wrong[name].accepted
