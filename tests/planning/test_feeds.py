"""Feeds: of the last of the way in, for each turn of the spindle, and what a countersink asks for."""

from dataclasses import replace

import numpy as np
import pytest
import yaml

from zerorev.errors import InputError, NotExportableError
from zerorev.files.io import read_job
from zerorev.planning.job import plan_job
from zerorev.program.as_exported import as_exported
from zerorev.program.export import export
from zerorev.program.krl.dialect import KRL
from zerorev.program.neutral import build_program
from zerorev.verify.certificate.program import certify_program

JOB = {
    "robot": "kuka_kr6_r700_2", "tool": "thesis_drill", "proof_boxes": 0,
    "holes": [{"id": "a", "target_mm": [500, 300, 800], "direction": [1, 0, 0], "depth_mm": 20}],
}  # fmt: skip


@pytest.fixture
def job(tmp_path):
    def job(**keys):
        path = tmp_path / "job.yaml"
        path.write_text(yaml.safe_dump(JOB | keys))
        return read_job(path)

    return job


class TestTheLastOfTheWayIn:
    def test_has_its_own_feed_in_the_program_which_is_certified(self, job):
        asked = job(breakthrough={"last_mm": 3, "feed_mm_s": 1.5}, feed_mm_s={"plunge": 5})
        plan = plan_job(asked)
        exported = export(plan, version="x")
        program = KRL.read(exported.files)
        feeds = [(float(move.pace.value), move.end.xyz_mm[0]) for move in program.holes[0].moves]
        assert [feed for feed, _ in feeds] == [0.005, 0.005, 0.0015, 0.02]
        assert [float(x) for _, x in feeds] == [480, 497, 500, 480]
        (hole,) = certify_program(plan, program, as_exported(plan, program, KRL)).holes
        assert hole.certificate.reasons == ()

    def test_a_program_with_another_feed_there_is_refuted(self, job):
        plan = plan_job(job(breakthrough={"last_mm": 3, "feed_mm_s": 1.5}))
        text = export(plan, version="x").text.replace("$VEL.CP=0.001500", "$VEL.CP=0.005000")
        program = KRL.read([replace(export(plan, version="x").files[0], text=text)])
        (hole,) = certify_program(plan, program, as_exported(plan, program, KRL)).holes
        assert hole.certificate.verdict == "refuted"

    def test_the_plan_says_the_same_of_speeds_as_the_export(self, job):
        """A joint that is too slow for the plunge, but not on the last of the way in, and the other way round."""
        for feeds, part in (((60, 3), "the plunge at a feed of 60"), ((3, 60), "the plunge at a feed of 60")):
            asked = job(breakthrough={"last_mm": 8, "feed_mm_s": feeds[1]}, feed_mm_s={"plunge": feeds[0]})
            limits = replace(asked.robot.limits, speed=np.deg2rad(np.full(6, 22.0)))
            slow = replace(asked, robot=replace(asked.robot, limits=limits))
            plan = plan_job(slow)
            said = [each.message for each in plan.holes[0].findings if each.kind == "joint_speed"]
            with pytest.raises(NotExportableError) as refused:
                export(plan, version="x")
            assert said
            assert all(message in str(refused.value) for message in said)
            assert sum(part in message for message in said) == 1

    def test_the_time_of_the_plan_is_that_of_the_program(self, job):
        for cycle in ({}, {"cycle": {"kind": "chip_break", "depth_mm": 4}}):
            asked = job(breakthrough={"last_mm": 5, "feed_mm_s": 1.5}, approach_mm=10, **cycle)
            plan = plan_job(asked)
            (hole,) = build_program(plan).holes
            assert plan.holes[0].cycle_time == pytest.approx(sum(move.time for move in hole.moves), rel=1e-9)

    def test_takes_its_time(self, job):
        slow = plan_job(job(breakthrough={"last_mm": 3, "feed_mm_s": 1.5}))
        usual = plan_job(job())
        assert slow.holes[0].cycle_time - usual.holes[0].cycle_time == pytest.approx(3 / 1.5 - 3 / 5)

    def test_with_joint_moves_at_the_corner_too(self, job):
        asked = job(robot="abb_irb1200_5_90", breakthrough={"last_mm": 3, "feed_mm_s": 1.5})
        assert asked.settings.turning.kind == "joint"
        assert plan_job(asked).holes[0].verified.passed


class TestOtherUnits:
    def test_for_each_turn_of_the_spindle(self, job):
        """Feed = turns per minute times feed per turn over 60."""
        assert job(feed_mm_rev=0.05, spindle_rpm=2600).settings.feed_plunge == pytest.approx(2600 * 0.05e-3 / 60)

    def test_per_minute(self, job):
        settings = job(feed_mm_min={"plunge": 130, "retract": 1200}).settings
        assert (settings.feed_plunge, settings.feed_retract) == (pytest.approx(130e-3 / 60), pytest.approx(20e-3))

    @pytest.mark.parametrize(
        ("keys", "message"),
        [
            ({"feed_mm_rev": 0.05}, "feed_mm_rev.*speed of the spindle is not given.*spindle_rpm beside it"),
            ({"feed_mm_rev": 0.05, "spindle_rpm": 3000, "feed_mm_s": {"plunge": 5}}, "beside feed_mm_s.plunge"),
            ({"feed_mm_min": {"plunge": 100, "retract": 900}, "feed_mm_s": {"retract": 5}}, "beside feed_mm_s"),
            ({"feed_mm_rev": 0, "spindle_rpm": 3000}, "feed_mm_rev.*above 0"),
        ],
    )
    def test_what_is_stated_twice_or_not_at_all_is_refused(self, keys, message, job):
        with pytest.raises(InputError, match=message):
            job(**keys)


class TestCountersink:
    def test_a_depth_that_is_not_measured_is_a_warning_with_what_it_costs(self, job):
        """A sink of 100 deg is 2.38 times as wide as deep: 0.5 mm less deep, 1.19 mm less wide."""
        plan = plan_job(job(countersink={"diameter_mm": 9.5, "angle_deg": 100}))
        (finding,) = [each for each in plan.holes[0].findings if each.kind == "countersink"]
        assert finding.level == "warning"
        assert "0 to 1.2 mm narrower" in finding.message
        assert 2 * np.tan(np.deg2rad(50)) * 0.5 == pytest.approx(1.19, abs=5e-3)

    def test_with_a_measured_depth_there_is_none(self, job):
        plan = plan_job(job(countersink={"diameter_mm": 9.5}, blend_shortfall_mm=0.4))
        assert not [each for each in plan.holes[0].findings if each.kind == "countersink"]


class TestJointSpeeds:
    def test_a_feed_that_a_joint_cannot_follow_is_said_of_the_plan(self, job):
        """And refused by export."""
        plan = plan_job(job(feed_mm_s={"plunge": 400, "retract": 2000}))
        found = [each for each in plan.holes[0].findings if each.kind == "joint_speed"]
        assert {each.level for each in found} == {"warning"}
        with pytest.raises(NotExportableError) as refusal:
            export(plan)
        for each in found:
            assert any(each.message.partition(" would")[0] in reason for reason in refusal.value.reasons)

    def test_the_feed_that_is_named_fits(self, job):
        (finding, *_) = [
            each for each in plan_job(job(feed_mm_s={"retract": 2000})).holes[0].findings if each.kind == "joint_speed"
        ]
        fits = float(finding.message.rpartition(" is ")[2].removesuffix(" mm/s"))
        slower = plan_job(job(feed_mm_s={"retract": fits}))
        assert not [each for each in slower.holes[0].findings if each.kind == "joint_speed"]
        export(slower)

    def test_a_tool_that_turns_fast_is_said_in_the_plan(self, job):
        fast = plan_job(job(feed_mm_s={"retract": 2000})).holes[0]
        profile = fast.motion.profile
        slope = abs(np.diff(profile.psi) / np.diff(profile.standoff))[-1]
        (said,) = [each for each in fast.findings if each.kind == "turn_speed"]
        assert f"{np.rad2deg(slope) * 2:.0f} deg/s" in said.message
        slow = plan_job(job(feed_mm_s={"retract": 20})).holes[0]
        assert not [each for each in slow.findings if each.kind == "turn_speed"]
