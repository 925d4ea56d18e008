"""No field of a plan file or a depth file is left without a word on how `zerorev check` treats it."""

from __future__ import annotations

import types
from collections.abc import Iterator
from typing import Annotated, Any, get_args, get_origin

import pytest
from pydantic import BaseModel

from zerorev.files.plan_fields import HEAD_FIELDS, HOLE_FIELDS, field_of
from zerorev.files.plan_schema import DepthFile, DepthHole, PlanFile, PlanHead, PlanHole


def forms_in(annotation: Any) -> Iterator[type[BaseModel]]:
    """The forms that a field may hold: alone, in a list, or as one of several."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        yield annotation
    elif get_origin(annotation) is Annotated or isinstance(annotation, types.UnionType) or get_args(annotation):
        for part in get_args(annotation):
            yield from forms_in(part)


def schema_leaves(form: type[BaseModel], path: str = "") -> Iterator[tuple[str, tuple[str, ...]]]:
    """Every field that holds no form, by its path, and the descriptions on the way to it."""
    for name, field in form.model_fields.items():
        key = field.alias or name
        there, inner = f"{path}.{key}" if path else key, list(forms_in(field.annotation))
        words = (field.description or "",)
        if not inner:
            yield there, words
        for each in inner:
            for leaf, below in schema_leaves(each, there):
                yield leaf, words + below


HOLE = dict(schema_leaves(PlanHole))
# what a further tool does is a plan of its own, made of the same forms
HEAD = {path: words for path, words in schema_leaves(PlanHead) if not path.startswith("tools.")} | {"tools": ()}


@pytest.mark.parametrize(("fields", "schema"), [(HOLE_FIELDS, HOLE), (HEAD_FIELDS, HEAD)], ids=["hole", "head"])
def test_every_field_is_an_input_or_recomputed_or_says_that_it_is_not(fields, schema):
    assert len(schema) > 20
    for path, words in schema.items():
        field = field_of(path, fields)
        assert field is not None, f"{path}: not in zerorev.files.plan_fields; say how check computes it again"
        said = any("not recomputed" in text for text in words)
        assert (field.how == "not recomputed") == said, f"{path}: {field.how}, yet its description says {words}"


@pytest.mark.parametrize(("fields", "schema"), [(HOLE_FIELDS, HOLE), (HEAD_FIELDS, HEAD)], ids=["hole", "head"])
def test_no_field_is_named_that_the_schema_has_not(fields, schema):
    known = {path[:end] for path in schema for end in range(len(path) + 1) if path[end : end + 1] in ("", ".")}
    assert set(fields) <= known


def test_the_files_are_made_of_the_head_and_the_holes_alone():
    assert set(PlanFile.model_fields) == set(DepthFile.model_fields) == set(PlanHead.model_fields) | {"holes"}
    # the two beside the plan are held against the same two within it when a depth file is read
    assert set(DepthHole.model_fields) == {"id", "deepest_mm", "plan"}


def test_a_new_figure_below_an_old_one_is_not_covered_by_it():
    assert field_of("settings.anything_new", HEAD_FIELDS).how == "input"
    assert field_of("baseline.anything_new", HOLE_FIELDS) is None
    assert field_of("events[3].standoff_mm", HOLE_FIELDS) is HOLE_FIELDS["events.standoff_mm"]
