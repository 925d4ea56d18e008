"""The figures say what the plan says, in units, and leave nothing behind."""

from __future__ import annotations

import subprocess
import sys
from dataclasses import replace

import matplotlib as mpl
import numpy as np
import pytest
from matplotlib.colors import to_hex
from PIL import Image

from oracles.published import POSITIONS
from zerorev.errors import InputError, OutputError
from zerorev.files.io import read_robot
from zerorev.model.hole import Hole
from zerorev.model.job import Settings
from zerorev.model.plan import LostMotion, LostMotionEvent, Plan
from zerorev.model.profile import Profile
from zerorev.model.tool import Tool
from zerorev.motion.critical import kappa_of
from zerorev.motion.drilling import Drilling, joint_rates
from zerorev.motion.loads import lost_motion_of
from zerorev.report import figures
from zerorev.report.figures import FIGURES, critical_rates, file_stems, joint_angles, twist_plane, write_figures
from zerorev.report.figures.plane import SLATE
from zerorev.report.figures.style import JOINT_COLOURS, png, signed, spread_out
from zerorev.report.scene.bracket import broken_at_poles
from zerorev.workers import Machines


def texts(figure):
    found = [text.get_text() for text in figure.texts]
    for axes in figure.axes:
        found += [axes.get_title(loc) for loc in ("left", "center", "right")] + [text.get_text() for text in axes.texts]
    return found + [text.get_text() for legend in figure.legends for text in legend.get_texts()]


def line(axes, label):
    (found,) = [line for line in axes.lines if line.get_label() == label]
    return found


@pytest.mark.parametrize("name", FIGURES)
def test_heading_names_robot_hole_branch_and_reversals(published, name):
    heading = " ".join(text.get_text() for text in FIGURES[name](published, published.holes[1]).texts)
    for part in ("KUKA KR 6 R700-2", "hole position 2", "branch 0", "0 here"):
        assert part in heading


@pytest.mark.parametrize("name", FIGURES)
def test_every_axis_has_a_unit(published, name):
    figure = FIGURES[name](published, published.holes[0])
    labels = {label for axes in figure.axes for label in (axes.get_xlabel(), axes.get_ylabel()) if label}
    assert len(labels) >= 2
    assert all(label.endswith("]") or "[deg/mm]" in label for label in labels)


@pytest.mark.parametrize("name", FIGURES)
def test_an_infeasible_hole_has_nothing_to_draw(published, name):
    with pytest.raises(InputError, match="hole far: has no motion"):
        FIGURES[name](published, published.holes[3])


def test_no_global_state(published):
    before = dict(mpl.rcParams)
    for draw in FIGURES.values():
        png(draw(published, published.holes[0]))
    assert dict(mpl.rcParams) == before
    code = "import sys, zerorev.report.figures; sys.exit('matplotlib.pyplot' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


class TestJointAngles:
    @pytest.mark.parametrize("n", range(3))
    def test_shows_the_published_joints(self, published, n):
        figure = joint_angles(published, published.holes[n])
        depth = POSITIONS[n].depth_mm
        for i, axes in enumerate(figure.axes):
            planned = line(axes, f"A{i + 1} planned")
            assert to_hex(planned.get_color()) == JOINT_COLOURS[i].lower()
            shown = np.interp([0, depth, 2 * depth], planned.get_xdata(), planned.get_ydata())
            off = shown - np.array(POSITIONS[n].axis_deg)[:, i]
            np.testing.assert_allclose(off, np.round(off / 360) * 360, atol=0.005)
            np.testing.assert_allclose(np.round(off / 360), round(off[0] / 360), atol=0)

    def test_baseline_starts_with_the_plan_and_comes_back(self, published):
        for axes, name in zip(
            joint_angles(published, published.holes[0]).axes, published.robot.joint_names, strict=True
        ):
            baseline, planned = line(axes, f"{name} baseline").get_ydata(), line(axes, f"{name} planned").get_ydata()
            assert baseline[0] == pytest.approx(planned[0], abs=1e-9)
            assert baseline[-1] == pytest.approx(baseline[0], abs=1e-6)

    def test_loads_that_change_their_sign_are_marked(self, published):
        hole = published.holes[2]
        assert not any("load" in text for text in texts(joint_angles(published, hole)))
        events = (LostMotionEvent(2, "plunge", 0.01, 0.1), LostMotionEvent(4, "target", 0.0, 1.0))
        figure = joint_angles(published, replace(hole, lost_motion=LostMotion(1e-4, None, events)))
        assert line(figure.axes[1], "A2 loads").get_xdata() == pytest.approx([20])
        assert line(figure.axes[3], "A4 loads").get_xdata() == pytest.approx([30])
        assert len(line(figure.axes[0], "A1 loads").get_xdata()) == 0
        assert texts(figure).count("its load changes sign") == 1

    def test_reversals_are_marked_where_they_happen(self, make_plan):
        # the five-point motion turns A6 round twice within the plunge
        plan = make_plan((50, 20, 0, 30, 50), (14, 4, -5.9, -15, -30))
        figure = joint_angles(plan, plan.holes[0])
        for i, axes in enumerate(figure.axes):
            events = [event for event in plan.holes[0].score.events if event.joint == i + 1]
            marks = [mark for mark in axes.lines if "reversals" in mark.get_label()]
            colour = [mark for mark in marks if to_hex(mark.get_color()) == JOINT_COLOURS[i].lower()]
            shown = [x for mark in colour for x in mark.get_xdata()]
            expected = [50 - 1e3 * e.standoff if e.leg == "plunge" else 50 + 1e3 * e.standoff for e in events]
            np.testing.assert_allclose(shown, expected, atol=1e-9)

    def test_counts_reversals_joint_by_joint(self, published):
        shown = [axes.get_title("right") for axes in joint_angles(published, published.holes[1]).axes]
        assert shown == [f"reversals {n} → 0" for n in (1, 1, 1, 0, 1, 1)]

    def test_a_limit_is_shown_only_when_it_is_near(self, published):
        shown = [text.get_text() for axes in joint_angles(published, published.holes[0]).axes for text in axes.texts]
        assert [text for text in shown if text.startswith("limit")] == ["limit +120"]

    def test_a_baseline_that_cannot_be_run_is_reported(self, make_plan):
        plan = make_plan()
        joints = plan.holes[0].motion.joints[:, 1]
        # A2 of the baseline goes up where the plan goes down
        upper = plan.robot.limits.upper.copy()
        upper[1] = joints.max() + np.deg2rad(0.01)
        lower = plan.robot.limits.lower.copy()
        lower[3] = plan.holes[0].motion.joints[:, 3].min() - 0.01
        upper[3] = plan.holes[0].motion.joints[0, 3] + np.deg2rad(0.01)
        tight = replace(plan.robot, limits=replace(plan.robot.limits, lower=lower, upper=upper))
        figure = joint_angles(replace(plan, robot=tight), plan.holes[0])
        assert any("cannot be run" in text for text in texts(figure))
        assert figure.axes[0].get_title("right") == "reversals ? → 0"


class TestTwistPlane:
    def test_draws_the_legs_whole_beyond_the_wall_at_180(self, published):
        axes = twist_plane(published, published.holes[1]).axes[0]
        np.testing.assert_allclose(line(axes, "plunge leg").get_xdata(), [-20, 0])
        np.testing.assert_allclose(line(axes, "plunge leg").get_ydata(), [180, 178.1])
        np.testing.assert_allclose(line(axes, "retract leg").get_ydata(), [178.1, 142.49])
        low, high = axes.get_ylim()
        assert high - low >= 360
        assert low < 142 < 180 < high

    def test_more_than_a_turn_is_shown_whole(self, make_plan):
        plan = make_plan()
        motion = plan.holes[0].motion
        wide = replace(motion, profile=Profile(motion.profile.standoff, np.deg2rad([200.0, 0, -200])))
        low, high = twist_plane(plan, replace(plan.holes[0], motion=wide)).axes[0].get_ylim()
        assert low < -200 < 200 < high

    def test_lines_lie_where_theta_psi_changes_sign(self, published):
        # position 1: spin does not move A1 where the wrist centre passes radially, at psi = 90 deg
        axes = twist_plane(published, published.holes[0]).axes[0]
        heights = {text.get_text(): text.xy[1] for text in axes.texts if text.get_text() in published.robot.joint_names}
        assert heights["A1"] == pytest.approx(90, abs=1.0)
        assert set(heights) == {"A1", "A2", "A3", "A4", "A5"}

    def test_legend_tells_reach_and_limits(self, published):
        legend = [text.get_text() for text in twist_plane(published, published.holes[0]).legends[0].get_texts()]
        assert "out of reach" in legend
        assert "over a joint limit (A5)" in legend
        assert "reversal" not in legend

    def test_curves_of_zero_load_are_of_the_way_the_joints_turn(self, published):
        # at position 3 the plunge crosses those of A2 and A4 at a tenth of their friction
        hole = published.holes[2]
        axes = twist_plane(published, hole).axes[0]
        drawn = {to_hex(each.get_color()) for each in axes.lines if each.get_label() == "load"}
        assert {JOINT_COLOURS[1].lower(), JOINT_COLOURS[3].lower()} <= drawn
        names = {text.get_text() for text in axes.texts if "%" in text.get_text()}
        assert {"A2 10%", "A4 10%"} <= names
        profile = hole.motion.profile
        events = lost_motion_of(Drilling(published.robot, published.tool, hole.hole), profile, 4).events
        assert len(events) == 2
        for event in events:
            spin = np.rad2deg(np.interp(event.standoff, profile.standoff[1::-1], profile.psi[1::-1]))
            curves = [
                np.column_stack([each.get_xdata(), each.get_ydata()])
                for each in axes.lines
                if each.get_label() == "load" and to_hex(each.get_color()) == JOINT_COLOURS[event.joint - 1].lower()
            ]
            apart = np.concatenate(curves) - [-event.standoff * 1e3, spin]
            assert np.abs(apart / [60, 360]).max(axis=1).min() < 0.01  # of the picture
        assert texts(twist_plane(published, hole)).count("load 0 with % of friction") == 1

    def test_without_masses_nothing_is_said_of_loads(self, published):
        bare = replace(published, robot=replace(published.robot, dynamics=None))
        assert not any("load" in text for text in texts(twist_plane(bare, bare.holes[2])))

    def test_names_the_joints_that_reverse(self, make_plan):
        plan = make_plan(psi_deg=(0, 0, 0))
        assert "A1 A2 A3 A5 A6" in texts(twist_plane(plan, plan.holes[0]))

    def test_stand_off_is_the_axis_on_both_sides(self, published):
        axes = twist_plane(published, published.holes[0]).axes[0]
        shown = dict(zip(axes.get_xticks(), [label.get_text() for label in axes.get_xticklabels()], strict=True))
        assert shown[-50] == shown[50] == "50"
        assert shown[0] == "0"

    def test_a_deeper_corner_is_the_middle(self, make_plan):
        plan = make_plan((50, -0.5, 50))
        axes = twist_plane(plan, plan.holes[0]).axes[0]
        shown = dict(zip(axes.get_xticks(), [label.get_text() for label in axes.get_xticklabels()], strict=True))
        assert shown[0] == "−0.5"
        assert axes.get_xlim() == pytest.approx((-50.5, 50.5))

    def test_a_tool_without_a_lever_says_so(self, robot, make_plan):
        straight = Tool.from_mm_deg((0, 0, 100), (180, 0, 0), name="straight")
        hole = Hole("e0", np.array([0.5, 0.1, 0.6]), np.array([1.0, 0, 0]), 0.03)
        profile = Profile.straight(0.03, *np.deg2rad([0, 20, 50]))
        plan = Plan(robot, straight, Settings(), (_evaluated(robot, straight, hole, profile, 0),))
        for draw in (twist_plane, critical_rates):
            assert any(text.startswith("spin never moves A1, A2, A3") for text in texts(draw(plan, plan.holes[0])))

    def test_the_map_is_even_in_lightness(self):
        rgb = SLATE(np.linspace(0, 1, 32))[:, :3]
        linear = np.where(rgb <= 0.04045, rgb / 12.92, ((rgb + 0.055) / 1.055) ** 2.4)
        lightness = 116 * np.cbrt(linear @ [0.2126, 0.7152, 0.0722]) - 16
        steps = np.diff(lightness)
        assert (steps < 0).all()
        assert steps.min() / steps.max() < 1.5


class TestCriticalRates:
    def test_the_bracket_is_the_published_one(self, published):
        axes = critical_rates(published, published.holes[0]).axes[0]
        # theory §2: +0.402 and -0.490 deg/mm
        assert line(axes, "plunge leg").get_ydata()[0] == pytest.approx(0.402, abs=5e-4)
        assert line(axes, "retract leg").get_ydata()[0] == pytest.approx(-0.490, abs=5e-4)

    def test_crossings_are_the_critical_rates_of_the_theory(self, published):
        axes = critical_rates(published, published.holes[0]).axes[0]
        shown = [line(axes, f"crossing {i + 1}").get_ydata()[0] for i in range(6)]
        np.testing.assert_allclose(shown, (0.294, -0.480, -0.436, -0.005, 0.167, 0.388), atol=1.1e-3)
        assert all(line(axes, f"crossing {i + 1}").get_xdata()[0] == pytest.approx(-5.9388) for i in range(6))

    def test_curves_are_the_kernel_s(self, published):
        axes = critical_rates(published, published.holes[2]).axes[0]
        hole = published.holes[2]
        for i, name in enumerate(published.robot.joint_names):
            x, y = line(axes, name).get_data()
            sample = np.isfinite(y) & (np.abs(y) < 1e3)
            drilling = Drilling(published.robot, published.tool, hole.hole)
            expected = kappa_of(*joint_rates(drilling, 0.0, np.deg2rad(x[sample])))[:, 4, i]
            np.testing.assert_allclose(y[sample], np.rad2deg(expected) * 1e-3, rtol=1e-9)

    def test_no_line_joins_the_ends_of_an_asymptote(self, published):
        axes = critical_rates(published, published.holes[0]).axes[0]
        height = np.diff(axes.get_ylim())[0]
        for name in published.robot.joint_names:
            y = line(axes, name).get_ydata()
            crosses = (np.sign(y[:-1]) * np.sign(y[1:]) < 0) & (np.abs(np.diff(y)) > height)
            assert not crosses.any()

    def test_a_broken_curve_runs_off_on_both_sides(self):
        x = np.linspace(-1, 1, 8)
        xs, ys = broken_at_poles(x, 1 / x, x)
        assert xs.size == 11
        np.testing.assert_allclose(xs[4:7], 0, atol=1e-12)
        assert ys[4] < -1e5
        assert np.isnan(ys[5])
        assert ys[6] > 1e5

    def test_all_six_are_named_apart(self, make_plan):
        plan = make_plan(psi_deg=(30, -40, 35))  # both slopes far above all six
        axes = critical_rates(plan, plan.holes[0]).axes[0]
        named = [text for text in axes.texts if text.get_text().startswith("A")]
        assert len(named) == 6
        places = sorted(text.get_position()[1] for text in named)
        low, high = axes.get_ylim()
        assert low < places[0]
        assert places[-1] < high
        assert np.diff(places).min() > 0.06 * (high - low)


class TestWriteFigures:
    def test_three_files_a_hole_and_none_for_the_infeasible(self, published, tmp_path):
        reported = []
        files = write_figures(published, tmp_path / "figures", lambda done, of: reported.append((done, of)))
        assert reported == [(n, 9) for n in range(1, 10)]
        assert [file.name for file in files[:3]] == [f"position_1_{name}.png" for name in FIGURES]
        assert sorted((tmp_path / "figures").iterdir()) == sorted(files)
        for file in files:
            with Image.open(file) as image:
                image.load()
                assert image.width == 1200
                assert np.ptp(np.asarray(image.convert("L"))) > 200

    def test_workers_make_no_difference(self, published, tmp_path):
        here, there = (write_figures(published, tmp_path / str(count), machines=Machines(count)) for count in (1, 2))
        assert [file.name for file in here] == [file.name for file in there]
        for one, other in zip(here, there, strict=True):
            assert one.read_bytes() == other.read_bytes()

    def test_chosen_holes_have_the_files_that_they_have_among_all(self, published, tmp_path):
        reported = []
        files = write_figures(
            published, tmp_path, lambda done, of: reported.append((done, of)), ids={"position 3", "position 1"}
        )
        assert [file.name for file in files] == [f"position_{n}_{name}.png" for n in (1, 3) for name in FIGURES]
        assert reported == [(n, 6) for n in range(1, 7)]

    @pytest.mark.parametrize("robot_name", ["yaskawa_gp8", "staubli_tx2_90l"])
    def test_other_robots(self, robot_name, tool, tmp_path):
        robot = read_robot(robot_name)
        hole = Hole("h", np.array([0.6, 0.2, 0.8]), np.array([1.0, 0, 0]), 0.02)
        profile = Profile.straight(0.02, *np.deg2rad([10, -5, -30]))
        answers = [_evaluated(robot, tool, hole, profile, branch) for branch in range(8)]
        plan = Plan(robot, tool, Settings(), tuple([found for found in answers if found][:1]))
        assert len(write_figures(plan, tmp_path)) == 3

    def test_any_id_makes_a_drawing(self, make_plan, tmp_path):
        plan = make_plan(name="$x_1$ {a} 孔/..\\\n" + 200 * "ö")
        for file in write_figures(plan, tmp_path):
            assert file.parent == tmp_path
            assert file.name.isascii()

    def test_stems_differ_even_where_case_does_not_count(self):
        stems = file_stems(("a/b", "a_b", "A b", "..", "孔", ""))
        assert stems == ["a_b", "a_b-2", "A_b-3", "hole", "hole-2", "hole-3"]

    def test_a_failure_leaves_no_half_of_a_file(self, make_plan, tmp_path, monkeypatch):
        def fail(*_):
            raise OSError(28, "No space left on device")

        monkeypatch.setattr("os.replace", fail)
        with pytest.raises(OutputError, match="No space left"):
            write_figures(make_plan(), tmp_path)
        assert list(tmp_path.iterdir()) == []

    def test_a_folder_without_a_parent(self, make_plan, tmp_path):
        with pytest.raises(OutputError, match="does not exist"):
            write_figures(make_plan(), tmp_path / "no" / "such")


class TestHelpers:
    def test_labels_far_apart_stay(self):
        np.testing.assert_allclose(spread_out([3.0, 1.0, 2.0], 0.5), [3, 1, 2])

    def test_labels_too_close_part_evenly_and_keep_their_order(self):
        np.testing.assert_allclose(spread_out([1.0, 1.0, 1.1, 9.0], 1.0), [1 / 30, 31 / 30, 61 / 30, 9], atol=1e-9)

    def test_labels_stay_within(self):
        places = spread_out([0.0, 0.0, 0.0], 1.0, low=0.0, high=5.0)
        np.testing.assert_allclose(places, [0, 1, 2])
        assert spread_out([], 1.0).size == 0

    @pytest.mark.parametrize(("value", "text"), [(1.25, "+1.2"), (-0.01, "0.0"), (-2, "−2.0")])
    def test_signed(self, value, text):
        assert signed(value, 1) == text


def _evaluated(robot, tool, hole, profile, branch):
    from zerorev.model.plan import HolePlan
    from zerorev.motion.evaluation import evaluate

    found = evaluate(robot, tool, hole, profile, branch)
    return HolePlan(hole, "evaluated", 0.1, found.motion, found.score) if found.score else None


def test_public_names():
    assert all(hasattr(figures, name) for name in figures.__all__)
