"""The way to each hole, from one to the next and away: along the drill axis, over the surface, and as exported."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import zerorev as zr
from zerorev.errors import NotExportableError
from zerorev.motion.kinematics import forward
from zerorev.planning.job import plan_job
from zerorev.planning.restated import check_plan
from zerorev.planning.sequence import moves_of
from zerorev.program.as_exported import as_exported
from zerorev.program.dialect import ProgramFile
from zerorev.program.export import export
from zerorev.program.krl.dialect import KRL
from zerorev.verify.certificate.program import certify_program

PANEL = "examples/jobs/panel.yaml"
ELSEWHERE = "PTP {AXIS: A1 0.00000,A2 -90.00000,A3 90.00000,A4 0.00000,A5 0.00000,A6 0.00000}"
APPROACH, RETRACT, HEIGHT = 0.010, 0.015, 0.040


@pytest.fixture(scope="module")
def panel():
    job = zr.read_job(PANEL)
    return replace(job, holes=job.holes[8:14], settings=job.settings.without_proof)


@pytest.fixture(scope="module")
def planned(panel):
    settings = replace(panel.settings, approach=APPROACH, retract=RETRACT, safe_height=HEIGHT, clearance=5e-3)
    return plan_job(replace(panel, settings=settings))


def tips(plan, joints):
    T = forward(plan.robot, joints) @ plan.tool.T_flange_tcp
    return T[..., :3, 3], T[..., :3, :3]


def read(plan, text):
    program = KRL.read((ProgramFile("panel.src", text),))
    return certify_program(plan, program, as_exported(plan, program, KRL))


class TestAlongTheAxis:
    def test_points_over_the_hole_at_the_spin_of_the_ends(self, planned):
        for move, other in zip(planned.transitions, planned.in_order[1:], strict=True):
            at, axes = tips(planned, move.joints)
            one = next(hole for hole in planned.holes if hole.hole.id == move.start)
            heights = [
                (one, RETRACT, one.motion.joints[-1]), (one, HEIGHT, one.motion.joints[-1]),
                (other, HEIGHT, None), (other, planned.settings.lead_in + APPROACH, None),
            ]  # fmt: skip
            for k, (hole, height, same) in enumerate(heights):
                away = hole.hole.target - (hole.hole.depth + height) * hole.hole.direction
                np.testing.assert_allclose(at[k], away, rtol=0, atol=1e-9)
                if same is not None:
                    np.testing.assert_allclose(axes[k], tips(planned, same)[1], rtol=0, atol=1e-9)
            np.testing.assert_allclose(axes[2], axes[3], rtol=0, atol=1e-9)

    def test_the_time_of_the_linear_moves(self, planned, panel):
        bare = plan_job(panel)
        for hole, without in zip(planned.holes, bare.holes, strict=True):
            if np.array_equal(hole.motion.profile.psi, without.motion.profile.psi):
                more = (APPROACH + RETRACT) / planned.settings.feed_retract
                assert hole.cycle_time == pytest.approx(without.cycle_time + more)

    def test_no_higher_than_the_arm_can(self, panel):
        settings = replace(panel.settings, approach=3.0, retract=3.0, safe_height=5.0)
        found = plan_job(replace(panel, holes=panel.holes[:1], settings=settings))
        shorter = [finding for finding in export(found).findings if finding.kind == "approach"]
        assert [finding.level for finding in shorter] == ["warning"] * 4
        for word in ("approach of", "retract of", "safe height on arrival of", "safe height on leaving of"):
            (message,) = [finding.message for finding in shorter if finding.message.startswith(word)]
            assert "instead of 3000 mm" in message or "instead of 5000 mm" in message

    def test_the_check_recomputes_the_clearance(self, planned):
        assert not check_plan(planned).wrong
        wrong = replace(planned.transitions[2], clearance=planned.transitions[2].clearance + 1e-3)
        (found,) = check_plan(
            replace(planned, transitions=(*planned.transitions[:2], wrong, *planned.transitions[3:]))
        ).wrong
        assert found.message.startswith("transitions[2].clearance_mm")


class TestThePart:
    def test_a_move_that_would_dip_rises(self, panel):
        """With a change of turns: straight through the panel, or over it."""
        straight = plan_job(replace(panel, settings=replace(panel.settings, safe_height=0.0)))
        rising = plan_job(panel)
        through = [finding for finding in straight.all_findings if finding.kind == "through_part"]
        assert {finding.level for finding in through} == {"error"}
        crossing = {finding.hole for finding in through}
        assert not any(finding.kind in ("through_part", "near_part") for finding in rising.all_findings)
        for one, other in zip(straight.transitions, rising.transitions, strict=True):
            assert len(one.joints) == 2
            assert (one.clearance < -1e-3) == (one.to in crossing)
            assert (len(other.joints) == 4) == (one.clearance < -2e-5)
        assert min(move.clearance for move in rising.transitions) > -2e-5
        low = plan_job(replace(panel, settings=replace(panel.settings, safe_height=6e-3)))
        assert {len(move.joints) for move in low.transitions} == {4}
        assert min(move.clearance for move in low.transitions) > -2e-5

    def test_a_move_through_the_part_stops_the_export(self, panel):
        straight = plan_job(replace(panel, settings=replace(panel.settings, safe_height=0.0)))
        with pytest.raises(NotExportableError, match=r"from R\w+ to R\w+ the drill passes .* through the part"):
            export(straight, skip_failed=True)
        assert "through the part" not in export(replace(straight, holes=straight.holes[:2])).text

    def test_what_is_nearer_than_asked(self, panel):
        found = plan_job(replace(panel, settings=replace(panel.settings, clearance=5e-3)))
        near = [finding for finding in found.all_findings if finding.kind == "near_part"]
        assert len(near) == len(found.transitions)
        assert "comes within 0.00 mm of the part, and 5 mm are asked for" in near[0].message
        export(found)

    def test_no_part_at_all(self, panel):
        found = plan_job(replace(panel, settings=replace(panel.settings, part_thickness=0.0, safe_height=0.0)))
        assert all(move.clearance is None for move in found.transitions)
        export(found)

    def test_home_behind_the_surface(self, panel):
        home = tuple(np.deg2rad([0, -90, 90, 0, 0, 0]))
        found = plan_job(replace(panel, holes=panel.holes[:2], settings=replace(panel.settings, home_joints=home)))
        last = found.transitions[-1]
        assert last.clearance < -0.01
        assert [finding.level for finding in last.findings if finding.kind == "near_part"] == ["warning"]
        text = export(found).text
        at_home = "PTP {AXIS: A1 0.00000,A2 -90.00000,A3 90.00000,A4 0.00000,A5 0.00000,A6 0.00000}"
        assert text.count(at_home) == 2


class TestTheProgram:
    def test_is_certified(self, planned):
        assert {hole.certificate.verdict for hole in read(planned, export(planned).text).holes} == {"certified"}

    def test_stops_at_both_ends_of_the_stroke(self, planned, krl):
        hole = krl.read(export(planned).text).holes()[0]
        kinds = [(move.kind, move.blended) for move in hole]
        assert kinds == [
            ("PTP", False), ("LIN", False), ("LIN", True), ("LIN", True), ("LIN", False), ("LIN", False)
        ]  # fmt: skip

    @pytest.mark.parametrize(
        ("old", "new"),
        [
            ("PTP {AXIS: A1 ", f"{ELSEWHERE}\nPTP {{AXIS: A1 "),
            ("\nEND\n", f"\n{ELSEWHERE}\nEND\n"),
            ("$APO.CDIS=1.0000", "$APO.CDIS=2.0000"),
            ("$VEL.CP=0.020000 ; approach", "$APO.CDIS=1.0000\n$VEL.CP=0.020000 ; approach"),
            ("} ; end of the stroke", "} C_DIS ; end of the stroke"),
            ("} ; retracted", "} ; retracted\n;"),
        ],
    )  # fmt: skip
    def test_another_way_is_refuted(self, planned, old, new):
        text = export(planned).text
        changed = text.replace(old, new, 1)
        assert changed != text
        verdicts = [hole.certificate.verdict for hole in read(planned, changed).holes]
        assert ("refuted" in verdicts) == (not new.endswith(";"))

    def test_a_point_on_the_way_that_is_moved_is_refuted(self, planned):
        lines = export(planned).text.split("\n")
        ways = [k for k, line in enumerate(lines) if line.startswith("PTP") and lines[k + 1].startswith("PTP")]
        lines[ways[3]] = lines[ways[3]].replace("A1 ", "A1 1", 1)
        assert sum(hole.certificate.verdict == "refuted" for hole in read(planned, "\n".join(lines)).holes) == 1

    def test_of_some_holes_alone(self, planned, panel):
        """The ways lead from one of them to the next, in the program as in its proof."""
        from zerorev.program.krl.write import to_krl
        from zerorev.program.neutral import build_program

        some = [panel.holes[k].id for k in (0, 2, 3)]
        found = read(planned, to_krl(build_program(planned, only=some)))
        assert [hole.certificate.verdict == "certified" for hole in found.holes] == [
            hole.hole.id in some for hole in found.holes
        ]

    def test_of_a_plan_file_as_in_memory(self, planned, tmp_path):
        path = tmp_path / "plan.json"
        zr.write_plan(planned, path)
        again = zr.read_plan(path)
        assert export(again).text == export(planned).text
        for one, other in zip(moves_of(again), planned.transitions, strict=True):
            np.testing.assert_allclose(one.joints, other.joints, rtol=0, atol=1e-9)


@pytest.mark.long
def test_the_panel_as_it_was_run_before():
    """Case c01: each hole with its own best motion, straight from one to the next: 5 moves go through the panel.

    So version 0.1.0 planned it, of which a script sampled the tip: at most 179 mm behind the holes' ends, from R0C3 to
    R0C4. That by default none does is tested beside all else of the panel (tests/test_package.py).
    """
    job = zr.read_job(PANEL)
    as_before = replace(job.settings.without_proof, posture_freedom=0.0, safe_height=0.0)
    found = plan_job(replace(job, settings=as_before))
    depth = job.holes[0].depth
    behind = {(move.start, move.to): -move.clearance - depth for move in found.transitions}
    through = {pair for pair, far in behind.items() if far > 0}
    assert len(through) == 5
    assert behind["R0C3", "R0C4"] == max(behind.values()) == pytest.approx(0.179, abs=0.001)
    assert through <= {(move.start, move.to) for move in found.transitions if any(
        finding.kind == "through_part" for finding in move.findings
    )}  # fmt: skip
