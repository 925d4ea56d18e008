"""Forms without a browser: what is made of what stands in the fields, and what is said beside them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

pytest.importorskip("nicegui")

from oracles.published import POSITIONS
from zerorev.errors import InputError
from zerorev.model._arrays import rotation_rpy, transform
from zerorev.model.job import Job, Settings
from zerorev.model.profile import Profile
from zerorev.report.words.hole_rows import part_data
from zerorev.web.job_edits import with_hole, with_holes, with_settings, without_hole
from zerorev.web.session import Session
from zerorev.web.state import opened_job
from zerorev.web.views.fields import Fields, number
from zerorev.web.views.hole_form import hole_of, reference_of
from zerorev.web.views.settings_form import settings_of

GOOD = {"id": "new", "target_mm": [500.0, 300.0, 800.0], "direction": [0.0, 0.0, -2.0], "depth_mm": 40.0}


@pytest.fixture
def job(robot, tool):
    frame = transform(rotation_rpy(0.0, 0.0, 0.3), np.array([0.1, 0.0, 0.2]))
    return Job(robot, tool, tuple(position.hole for position in POSITIONS), Settings(), frame, psi_reference="part_x")


class TestNumbers:
    @pytest.mark.parametrize(
        ("text", "value"), [("12.5", 12.5), (" -3,25 ", -3.25), ("1e-3", 1e-3), ("abc", "abc"), ("", ""), (None, "")]
    )
    def test_a_number_or_the_text_itself(self, text, value):
        assert number(text) == value

    def test_nothing_that_only_python_takes(self):
        assert number("1_000") == "1_000"


class TestHole:
    def test_a_good_one_stands_where_the_job_s_part_frame_says(self, job):
        hole, wrong = hole_of(GOOD, job, None)
        assert not wrong
        target, direction, depth = part_data(hole, job.T_base_part)
        assert (target, direction, depth) == ([500.0, 300.0, 800.0], [0.0, 0.0, -1.0], 40.0)

    @pytest.mark.parametrize(
        ("change", "path", "said"),
        [
            ({"id": ""}, ("id",), "''"),
            ({"target_mm": [1.0, "abc", 2.0]}, ("target_mm", 1), "'abc' is not a number"),
            ({"target_mm": [1.0, 2.0, float("nan")]}, ("target_mm", 2), "not a finite number"),
            ({"direction": [0.0, 0.0, 0.0]}, ("direction",), "zero vector"),
            ({"direction": [1.0, 0.0, 0.0]}, ("direction",), "parallel"),
            ({"depth_mm": 0.0}, ("depth_mm",), "too small"),
            ({"depth_mm": ""}, ("depth_mm",), "not a number"),
        ],
    )
    def test_each_bad_field_is_named_with_what_is_accepted(self, job, change, path, said):
        hole, wrong = hole_of(GOOD | change, job, None)
        assert hole is None
        assert [each for each, _ in wrong] == [path]
        assert said in wrong[0][1].what
        assert wrong[0][1].accepted

    def test_all_bad_fields_at_once(self, job):
        _, wrong = hole_of({**GOOD, "depth_mm": -1.0, "target_mm": ["x", 0.0, "y"]}, job, None)
        assert {path for path, _ in wrong} == {("depth_mm",), ("target_mm", 0), ("target_mm", 2)}

    def test_an_edited_hole_keeps_what_the_form_does_not_show(self, job):
        profile = Profile.straight(0.05, 0.1, 0.0, -0.1)
        old = replace(job.holes[0], branch=4, profile=profile)
        target, direction, depth = part_data(old, job.T_base_part)
        data = {"id": "P", "target_mm": target, "direction": direction, "depth_mm": depth}
        free = replace(job, psi_reference=None)
        hole, _ = hole_of(data, free, old)
        assert (hole.id, hole.branch, hole.profile) == ("P", 4, profile)
        np.testing.assert_array_equal(hole.psi_zero, old.psi_zero)
        deeper, _ = hole_of(data | {"depth_mm": depth + 1}, free, old)
        assert deeper.profile is None
        assert reference_of(free) == "base_y"
        assert reference_of(replace(job, psi_reference=(0.0, 1.0, 0.0))) == [0.0, 1.0, 0.0]


class TestSettings:
    def test_what_is_not_asked_for_stays(self, job):
        old = replace(job, settings=Settings(near_joints=(0.1,) * 6, blend=2e-3, weights=(("travel", 1.0),)))
        asked = {("min_rate_deg_per_mm",): 0.02, ("objective",): "weights", ("psi_bound_deg",): "", ("legs",): "free"}
        settings, wrong = settings_of(asked, old)
        assert not wrong
        assert np.rad2deg(settings.min_rate) / 1e3 == pytest.approx(0.02)
        assert settings.legs == "free"
        assert settings.blend == pytest.approx(2e-3)
        assert settings.weights == (("travel", 1.0),)
        np.testing.assert_allclose(settings.near_joints, 0.1)

    def test_a_weighted_sum_with_the_stiffness_it_needs(self, job):
        asked = {("objective",): "weights", ("objective", "travel"): 1.0, ("objective", "margin"): "",
                 ("objective", "compliance_axial"): 0.2}  # fmt: skip
        _, wrong = settings_of(asked, job)
        assert [path for path, _ in wrong] == [("objective",)]
        assert "stiffness" in wrong[0][1].what
        asked |= {("joint_stiffness_nm_per_rad", n): 1e5 + n for n in range(6)}
        settings, wrong = settings_of(asked, job)
        assert not wrong
        assert settings.weights == (("travel", 1.0), ("compliance_axial", 0.2))
        assert settings.joint_stiffness == tuple(1e5 + n for n in range(6))

    def test_weights_without_a_choice_for_them_are_left_alone(self, job):
        settings, _ = settings_of({("objective",): "margin", ("objective", "travel"): 1.0}, job)
        assert (settings.objective, settings.weights) == ("margin", ())

    def test_weights_that_weigh_nothing_are_refused(self, job):
        for weight in (0.0, ""):
            settings, wrong = settings_of({("objective",): "weights", ("objective", "travel"): weight}, job)
            assert settings is None
            assert [path for path, _ in wrong] == [("objective",)]

    def test_six_or_none(self, job):
        six = {("near_joints_deg", n): 10.0 * n for n in range(6)}
        settings, _ = settings_of(six, job)
        np.testing.assert_allclose(np.rad2deg(settings.near_joints), np.arange(6) * 10.0)
        _, wrong = settings_of(six | {("near_joints_deg", 4): ""}, job)
        assert [path for path, _ in wrong] == [("near_joints_deg", 4)]
        there = replace(job, settings=settings)
        none, _ = settings_of({("near_joints_deg", n): "" for n in range(6)}, there)
        assert none.near_joints is None

    def test_the_same_again_changes_nothing(self, job):
        settings, _ = settings_of({("blend_mm",): 1.0, ("feed_mm_s", "plunge"): 5.0}, job)
        assert settings is job.settings

    @pytest.mark.parametrize(
        ("path", "value"),
        [
            (("min_rate_deg_per_mm",), "x"),
            (("psi_bound_deg",), 0.0),
            (("max_twist_deg_per_mm",), -1.0),
            (("reversal_weights", 2), 0.0),
            (("feed_mm_s", "retract"), 0.0),
            (("blend_shortfall_mm",), 7.0),
            (("lead_in_mm",), ""),
        ],
    )
    def test_a_bad_one_is_named(self, job, path, value):
        settings, wrong = settings_of({path: value}, job)
        assert settings is None
        assert [each for each, _ in wrong] == [path]


class Field:
    """Stands in for a field of the page."""

    error = None


class TestMessages:
    def test_each_stands_beside_its_field_and_goes_when_all_is_well(self):
        fields = Fields()
        fields["id",], fields["depth_mm",] = Field(), Field()
        assert fields.show([(("id",), InputError("is taken", accepted="another"))])
        assert (fields["id",].error, fields["depth_mm",].error) == ("is taken; accepted: another", None)
        assert not fields.show([])
        assert fields["id",].error is None

    def test_what_belongs_to_several_fields_stands_at_the_first(self):
        fields = Fields()
        for n in range(3):
            fields["direction", n] = Field()
        assert fields.show([(("direction",), InputError("is not a direction"))])
        assert fields["direction", 0].error == "is not a direction"


class TestUndo:
    def test_edits_are_taken_back_one_by_one(self, job):
        session = Session(opened_job(job))
        first = session.state
        assert not session.can_undo
        session.change(without_hole(session.state, job.holes[1].id))
        session.change(with_settings(session.state, Settings(legs="free")))
        session.undo()
        assert session.state.job.settings is job.settings
        assert len(session.state.job.holes) == 2
        session.undo()
        assert session.state.job is first.job
        assert not session.can_undo
        session.undo()
        assert session.state.job is first.job

    def test_what_one_work_finds_bit_by_bit_is_one_edit(self, job):
        session, work = Session(opened_job(job)), object()
        for hole in job.holes:
            deeper = replace(hole, depth=hole.depth + 0.01)
            session.change(with_hole(session.state, deeper, instead_of=hole.id), of=work)
        session.undo()
        assert session.state.job is job
        assert not session.can_undo

    def test_an_edit_amid_a_work_is_an_edit_of_its_own(self, job):
        session, work = Session(opened_job(job)), object()
        first, second = (replace(hole, depth=hole.depth + 0.01) for hole in job.holes[:2])
        session.change(with_hole(session.state, first, instead_of=first.id), of=work)
        session.change(without_hole(session.state, job.holes[2].id))
        session.change(with_hole(session.state, second, instead_of=second.id), of=work)
        for count in (2, 3, 3):
            session.undo()
            assert len(session.state.job.holes) == count
        assert session.state.job is job

    def test_selecting_is_not_an_edit(self, job):
        session = Session(opened_job(job))
        session.change(replace(session.state, selected=job.holes[2].id))
        assert not session.can_undo

    def test_a_table_of_holes_is_one_edit(self, job):
        session = Session(opened_job(job))
        holes = [replace(job.holes[0], id=f"N{n}") for n in range(5)]
        session.change(with_holes(session.state, holes))
        assert (len(session.state.job.holes), session.state.selected) == (8, "N0")
        session.undo()
        assert session.state.job is job

    def test_nothing_to_add_and_an_id_twice_are_refused(self, job):
        state = opened_job(job)
        for holes in ([], [job.holes[0]]):
            with pytest.raises(InputError):
                with_holes(state, holes)
        with pytest.raises(InputError, match="used twice"):
            with_hole(state, job.holes[1])
