"""Statements of attributes: units there and back, ranges, sizes, and that they say what the attributes are."""

from __future__ import annotations

import types
from dataclasses import replace
from typing import Literal, Union, get_args, get_origin, get_type_hints

import numpy as np
import pytest

from zerorev.errors import InputError
from zerorev.model import plan, units
from zerorev.model.measures import Measures
from zerorev.model.settings import Settings
from zerorev.model.stated import Choice, Number, Six, Switch, Weighed, Whole, scaled, stated
from zerorev.model.stated_figures import Count, Figure, SixCounts, SixFigures, Text, Texts

NOUNS = (
    Settings, Measures, plan.Finding, plan.Event, plan.Baseline, plan.Verification, plan.Certificate, plan.Within,
    plan.Optimality,
)  # fmt: skip


@pytest.mark.parametrize(
    ("unit", "outside", "inside"),
    [
        (units.MM, 1.5, 1.5e-3),
        (units.MM_S, 5.0, 5e-3),
        (units.DEG, 90.0, np.pi / 2),
        (units.DEG_PER_MM, 0.01, np.pi / 18),
        (units.NM_PER_RAD, 4e4, 4e4),
        (units.RPM, 60.0, 2 * np.pi),
        (units.UM_PER_N, 3.0, 3e-6),
        (units.PERCENT, 12.5, 0.125),
        (units.ONE, 7.0, 7.0),
    ],
)
def test_units_there_and_back(unit, outside, inside):
    assert unit.inside(outside) == pytest.approx(inside, rel=1e-15)
    assert unit.outside(inside) == pytest.approx(outside, rel=1e-15)
    np.testing.assert_allclose(unit.outside(unit.inside(np.arange(-3.0, 4.0))), np.arange(-3.0, 4.0), rtol=1e-15)


@pytest.mark.parametrize("noun", NOUNS)
def test_a_statement_is_of_the_type_of_its_attribute(noun):
    kinds = {
        float: (Number, Figure), int: (Whole, Count), bool: (Switch,), str: (Text,),
        Literal: (Choice,), tuple: (Six, SixCounts, Texts, Weighed), np.ndarray: (SixFigures,),
    }  # fmt: skip
    hints = get_type_hints(noun)
    for each in stated(noun):
        hint = hints[each.name]
        members = get_args(hint) if get_origin(hint) in (Union, types.UnionType) else (hint,)
        kind = next(member for member in members if member is not type(None))
        if noun is not Measures:
            assert type(each) in kinds[get_origin(kind) or kind], each.name
            inside_none = each.null is None if isinstance(each, Figure) else bool(each.none)
            assert (type(None) in members) == inside_none, each.name
        if isinstance(each, Choice):
            assert tuple(each.words) == get_args(kind), each.name


def test_at_another_size_lengths_grow_and_rates_per_length_shrink():
    small = Settings(blend_shortfall=0.2e-3, psi_bound=1.0, joint_stiffness=(1e4,) * 6, spindle_rpm=6e3)
    large = scaled(small, 4.0)
    grown = {"blend", "blend_shortfall", "corner_tolerance", "lead_in", "feed_plunge", "feed_retract"}
    for name in vars(small):
        before, after = getattr(small, name), getattr(large, name)
        factor = 4.0 if name in grown else 0.25 if name in ("min_rate", "max_twist") else None
        assert after == (before if factor is None else before * factor), name
    assert scaled(Settings(), 2.0).blend_shortfall is None


@pytest.mark.parametrize(
    ("change", "accepted"),
    [
        ({"min_rate": -1.0}, "0 or more"),
        ({"min_rate": np.nan}, "0 or more"),
        ({"max_twist": 0.0}, "above 0"),
        ({"psi_bound": 0.0}, "above 0, or none: the spin is periodic"),
        ({"blend_shortfall": 1.1e-3}, "0 to blend, or none: half of the blend"),
        ({"reversal_weights": (1.0,) * 5}, "six numbers above 0"),
        ({"joint_stiffness": (1.0,) * 5 + (np.inf,)}, "six numbers above 0"),
        ({"near_joints": (0.0,) * 5}, "six numbers"),
        ({"proof_boxes": -1}, "0 or more"),
        ({"spindle_rpm": -1.0}, "above 0, or none: the program need not know it"),
    ],
)
def test_what_is_out_of_range_is_refused_with_what_is_accepted(change, accepted):
    with pytest.raises(InputError) as caught:
        Settings(**change)
    assert (caught.value.where, caught.value.accepted) == (next(iter(change)), accepted)


def test_at_the_ends_of_a_range():
    assert replace(Settings(), min_rate=0.0, blend_shortfall=1e-3, proof_boxes=0).turning.shortfall == 1e-3
    assert Settings(blend_shortfall=0.0).turning.shortfall == 0.0
