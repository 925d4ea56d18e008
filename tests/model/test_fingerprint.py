"""Equal content has one fingerprint, and any change of it another."""

import contextlib
import pickle
from dataclasses import fields, is_dataclass, replace

import numpy as np
import pytest

import zerorev as zr
from zerorev.model.fingerprint import fingerprint
from zerorev.model.hole import Hole


@pytest.fixture(scope="module")
def answer(robot, tool):
    return zr.plan(robot, tool, Hole("a", np.array([0.5, 0.3, 0.8]), np.array([1.0, 0, 0]), 0.02))


def changes(noun):
    """A noun with one thing of it changed, for each number, text and flag that is anywhere in it."""
    for field in fields(noun):
        for other in others(getattr(noun, field.name)):
            with contextlib.suppress(zr.InputError, TypeError, AttributeError):  # what this noun may not hold
                yield replace(noun, **{field.name: other})


def others(value):
    if isinstance(value, bool):
        yield not value
    elif isinstance(value, int):
        yield value + 1
    elif isinstance(value, float):
        yield 0.0 if np.isnan(value) else np.nextafter(value, np.inf).item()
    elif isinstance(value, str):
        yield value + "x"
    elif isinstance(value, np.ndarray):
        yield value + 1e-9 * np.arange(1, value.size + 1).reshape(value.shape)  # no mere length of a direction
        yield value[..., None]
    elif isinstance(value, tuple) and value and not hasattr(value, "_fields"):
        yield value[:-1]
        for k, each in enumerate(value):
            yield from ((*value[:k], other, *value[k + 1 :]) for other in others(each))
    elif is_dataclass(value):
        yield from changes(value)
    yield None if value is not None else 0


def test_any_change_of_an_answer_is_seen(answer):
    own, seen = fingerprint(answer), 0
    for other in changes(answer):
        seen += 1
        assert fingerprint(other) != own, other
    assert seen > 60


def test_equal_content_is_equal(answer, robot, tool):
    for thing in (answer, robot, tool, (robot, tool), {"b": 1, "a": np.float64(2.0)}):
        assert fingerprint(pickle.loads(pickle.dumps(thing))) == fingerprint(thing)
    assert fingerprint(np.float64(0.1)) == fingerprint(0.1)
    assert fingerprint({"a": 1, "b": 2}) == fingerprint({"b": 2, "a": 1})


def test_what_runs_together_stays_apart():
    apart = [
        (),
        ((),),
        ("",),
        ("", ""),
        ("ab", "c"),
        ("a", "bc"),
        (1, 2),
        ((1, 2),),
        (12,),
        (1.0,),
        ("1",),
        (True,),
        (None,),
    ]
    apart += [(0.0,), (-0.0,), (np.zeros(2),), (np.zeros((2, 1)),), (np.zeros(2, dtype=int),), ((0.0, 0.0),)]
    assert len({fingerprint(*things) for things in apart}) == len(apart)
    assert fingerprint("\ud800") != fingerprint("?")


def test_something_else_is_refused():
    with pytest.raises(TypeError, match="no fingerprint of a set"):
        fingerprint({1, 2})
