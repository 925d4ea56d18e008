"""The criteria: each figure against its own definition, worked out another way; the thesis' sum of two of them."""

from __future__ import annotations

import json
from dataclasses import fields, replace

import numpy as np
import pytest

from oracles import arm as twin
from zerorev.errors import InputError
from zerorev.files.io import read_job, read_plan, write_plan
from zerorev.files.plan_data import plan_data
from zerorev.model.finding import Finding
from zerorev.model.job import Settings
from zerorev.model.measures import CRITERIA, Measures
from zerorev.model.plan import Plan
from zerorev.model.profile import Profile
from zerorev.model.robot import JointLimits
from zerorev.model.tool import Tool
from zerorev.motion import kinematics
from zerorev.motion.criteria import (
    Reversals,
    WeighedCriteria,
    compliance,
    manipulability,
    measure,
    objective_of,
    thesis_objective,
)
from zerorev.motion.drilling import Drilling
from zerorev.motion.evaluation import Evaluation, evaluate
from zerorev.motion.joint_path import joint_path
from zerorev.planning.hole import plan

STIFFNESS = (4e4, 5e4, 3e4, 1e4, 1.2e4, 6e3)
BENT = Tool.from_mm_deg((30, -40, 150), (10, -120, 25))
ALL = tuple((name, 1.0) for name in CRITERIA)


def measured(robot, tool, position, profile=None, **settings):
    settings = Settings(**settings)
    evaluation = evaluate(robot, tool, position.hole, profile or position.profile, position.branch, settings)
    return measure(Drilling(robot, tool, position.hole), evaluation, settings)


class TestFigures:
    def test_travel_and_margin_are_those_of_the_score(self, robot, tool, position):
        score = evaluate(robot, tool, position.hole, position.profile, position.branch).score
        figures = measured(robot, tool, position)
        assert figures.travel == score.travel
        assert figures.margin == score.min_rate.min()
        assert measured(robot, tool, position, min_rate_rule="mean").margin == score.mean_rate.min()

    def test_the_margin_leaves_out_joints_that_reverse(self, robot, tool, positions):
        second = positions[1]
        score = evaluate(robot, tool, second.hole, second.held_spin, second.branch).score
        assert score.reversals_per_joint == (1, 1, 1, 0, 1, 1)
        assert measured(robot, tool, second, second.held_spin).margin == score.min_rate[3]
        assert measured(robot, tool, positions[0], positions[0].held_spin).margin == 0  # all of them do

    def test_rotation_during_the_plunge(self, robot, tool, positions):
        first = positions[0]
        assert np.rad2deg(measured(robot, tool, first).plunge_rotation) == pytest.approx(14.1646 + 5.9388)
        there_and_back = Profile(np.array([0.05, 0.02, 0, 0.05]), np.deg2rad([10, 14, 11, 0]))
        assert np.rad2deg(measured(robot, tool, first, there_and_back).plunge_rotation) == pytest.approx(4 + 3)

    def test_change_of_the_drills_speed_is_equation_5_4(self, robot, tool, positions):
        """30 deg in half a second are 10 rev/min."""
        first = positions[0]
        profile = Profile.straight(0.05, np.deg2rad(30), 0, -0.5)
        figures = measured(robot, tool, first, profile, feed_plunge=0.05 / 0.5)
        assert figures.tool_speed_change * 60 / (2 * np.pi) == pytest.approx(10)
        assert CRITERIA["tool_speed_change"](figures) == pytest.approx(1)
        # the steepest piece counts
        steep = Profile(np.array([0.05, 0.01, 0, 0.05]), np.deg2rad([20, 20, 0, -30]))
        figures = measured(robot, tool, first, steep, feed_plunge=0.01)
        assert figures.tool_speed_change * 60 / (2 * np.pi) == pytest.approx(20 / 360 * 60)

    def test_distance_to_limits_is_a_share_of_half_the_range(self, robot, tool, position):
        path = joint_path(Drilling(robot, tool, position.hole), position.profile, position.branch, samples=4000)
        middle = (robot.limits.lower + robot.limits.upper) / 2
        off = np.abs(path.joints - middle) / (robot.limits.upper - middle)
        figures = measured(robot, tool, position)
        assert figures.limit_distance == pytest.approx(1 - off.max(), abs=1e-6)
        tight = JointLimits(path.joints.min(axis=0), path.joints.max(axis=0), robot.limits.speed)
        assert measured(replace(robot, limits=tight), tool, position).limit_distance == pytest.approx(0, abs=1e-6)

    def test_a_push_at_the_tip_moves_it_by_the_compliance(self, any_robot):
        """tau = J^T F turns each joint by tau / k: the tip by differences of the forward kinematics."""
        rng = np.random.default_rng(3)
        for joints in rng.uniform(-2, 2, (10, 6)):
            direction = rng.normal(size=3)
            direction /= np.linalg.norm(direction)
            J = kinematics.jacobian(any_robot, BENT, joints)
            axial, lateral = compliance(J, STIFFNESS, direction)

            jacobian = twin.jacobian(any_robot, joints, twin.tcp(any_robot, BENT, joints)[:3, 3])[:3]

            def give(force, joints=joints, jacobian=jacobian):
                """Of the tip, to a force [N]."""
                small = 1e-4 * jacobian.T @ force / STIFFNESS
                pushed, pulled = (twin.tcp(any_robot, BENT, joints + step)[:3, 3] for step in (small, -small))
                return (pushed - pulled) / 2e-4

            assert axial == pytest.approx(direction @ give(direction), rel=1e-6)
            x = np.cross(direction, [1.0, 0.3, -0.2])
            x /= np.linalg.norm(x)
            y = np.cross(direction, x)

            def across(angle, x=x, y=y, give=give):
                force = np.cos(angle) * x + np.sin(angle) * y
                return force @ give(force)

            step = np.pi / 60
            soft = max(np.arange(60) * step, key=across)  # then closer, where it gives most
            most = max(across(angle) for angle in np.linspace(soft - step, soft + step, 61))
            assert lateral == pytest.approx(most, rel=1e-5)

    def test_compliance_of_a_motion_is_its_worst(self, robot, tool, position):
        figures = measured(robot, tool, position, joint_stiffness=STIFFNESS)
        path = joint_path(Drilling(robot, tool, position.hole), position.profile, position.branch, samples=50)
        give = []
        for joints in path.joints:
            J = twin.jacobian(robot, joints, twin.tcp(robot, tool, joints)[:3, 3])[:3]
            give.append(J @ np.diag(1 / np.array(STIFFNESS)) @ J.T)
        assert figures.compliance_axial == pytest.approx(max(C[0, 0] for C in give), rel=1e-3)
        assert figures.compliance_lateral == pytest.approx(
            max(np.linalg.eigvalsh(C[1:, 1:])[-1] for C in give), rel=1e-3
        )

    def test_without_stiffness_the_compliance_is_unknown(self, robot, tool, positions):
        figures = measured(robot, tool, positions[0])
        assert np.isnan([figures.compliance_axial, figures.compliance_lateral]).all()
        assert np.isfinite(figures.manipulability)

    def test_manipulability_is_the_determinant_of_the_jacobian(self, any_robot):
        arm = any_robot.arm
        joints = np.random.default_rng(5).uniform(-3, 3, (200, 6))
        det = np.abs([np.linalg.det(twin.jacobian(any_robot, q, twin.tcp(any_robot, BENT, q)[:3, 3])) for q in joints])
        figures = manipulability(any_robot, joints)
        forearm = np.hypot(arm.a2, arm.c3)
        np.testing.assert_allclose(figures * arm.c2 * forearm * (abs(arm.a1) + arm.c2 + forearm), det, atol=1e-12)
        assert (figures < 1).all()
        assert manipulability(any_robot, np.array([0.1, -0.8, 0.9, 0.3, 0, 0.2])) == 0

    def test_manipulability_of_a_motion_is_its_least(self, robot, tool, position):
        path = joint_path(Drilling(robot, tool, position.hole), position.profile, position.branch, samples=4000)
        least = manipulability(robot, path.joints).min()
        assert measured(robot, tool, position).manipulability == pytest.approx(least, rel=1e-5)


class TestCosts:
    def test_the_job_knows_them_all_and_each_reads_its_own_figure(self):
        names = [field.name for field in fields(Measures)]
        assert tuple(CRITERIA) == tuple(names)
        base = dict.fromkeys(names, 0.25)
        for name, criterion in CRITERIA.items():
            for other in names:
                moved = criterion(Measures(**base | {other: 0.26})) != criterion(Measures(**base))
                assert moved == (other == name)

    @pytest.mark.parametrize("name", ["margin", "limit_distance", "manipulability"])
    def test_of_some_more_is_better(self, name):
        poor, good = (Measures(**dict.fromkeys(CRITERIA, value)) for value in (0.1, 0.2))
        assert CRITERIA[name](good) < CRITERIA[name](poor)

    def test_published_motions_cost_between_0_and_about_1(self, robot, tool, position):
        figures = measured(robot, tool, position, joint_stiffness=STIFFNESS)
        costs = [criterion(figures) for criterion in CRITERIA.values()]
        assert all(0 < cost < 3.5 for cost in costs), costs  # the lost motion of position 3 is 0.15 mm

    def test_is_a_weighted_sum(self, robot, tool, positions):
        figures = measured(robot, tool, positions[0])
        mixed = WeighedCriteria(((0.3, CRITERIA["plunge_rotation"]), (0.7, CRITERIA["travel"])))
        by_hand = 0.3 * figures.plunge_rotation / np.pi + 0.7 * figures.travel / (12 * np.pi)
        assert mixed(figures) == pytest.approx(by_hand)
        asked = Settings(weights=(("plunge_rotation", 0.3), ("travel", 0.7)))
        assert objective_of(asked)(figures) == pytest.approx(by_hand)
        assert objective_of(Settings(objective="margin"))(figures) == CRITERIA["margin"](figures)

    def test_of_many_motions_at_once(self, robot, tool, positions):
        several = [measured(robot, tool, position, joint_stiffness=STIFFNESS) for position in positions]
        arrays = Measures(*(np.array([getattr(one, name) for one in several]) for name in CRITERIA))
        cost = objective_of(Settings(weights=ALL, joint_stiffness=STIFFNESS))
        np.testing.assert_allclose(cost(arrays), [cost(one) for one in several])


class TestThesis:
    def test_is_equation_4_7_by_hand(self, robot, tool, positions):
        first = positions[0]
        held = evaluate(robot, tool, first.hole, first.held_spin, first.branch)
        best = evaluate(robot, tool, first.hole, first.profile, first.branch)
        assert thesis_objective(held) == pytest.approx(6 / 6 * 6 / 7 + 52.496 / 2160 / 7, abs=1e-6)
        assert thesis_objective(best) == pytest.approx(107.119 / 2160 / 7, abs=1e-6)

    def test_each_kind_of_trouble_costs_one(self):
        def trouble(*kinds):
            return Evaluation(None, None, tuple(Finding("error", kind, "") for kind in kinds))

        assert thesis_objective(trouble("unreachable")) == 1.0
        assert thesis_objective(trouble("jump", "limit")) == 2.0
        assert thesis_objective(trouble("limit", "limit")) == 1.0

    def test_joints_may_weigh_differently(self, robot, tool, positions):
        score = evaluate(robot, tool, positions[1].hole, positions[1].held_spin, 0).score
        assert Reversals()(score) == pytest.approx(5 / 6)
        assert Reversals((2, 1, 1, 5, 1, 2))(score) == pytest.approx(7 / 12)


JOB = """
robot: kuka_kr6_r700_2
tool: thesis_drill
{}
holes:
  - {{id: 1, target_mm: [500, 300, 800], direction: [1, 0, 0], depth_mm: 50, psi_deg: [14.16, -5.94, -30.46]}}
"""


class TestFiles:
    def read(self, tmp_path, text):
        path = tmp_path / "job.yaml"
        path.write_text(JOB.format(text))
        return read_job(path)

    def test_a_job_weighs_criteria(self, tmp_path):
        text = "objective: {margin: 0.5, travel: 1, manipulability: 0}\njoint_stiffness_nm_per_rad: [1, 2, 3, 4, 5, 6]"
        settings = self.read(tmp_path, text).settings
        assert dict(settings.weights) == {"travel": 1.0, "margin": 0.5}
        assert settings.joint_stiffness == (1, 2, 3, 4, 5, 6)
        hash(settings)

    def test_a_word_is_still_a_word(self, tmp_path):
        settings = self.read(tmp_path, "objective: margin").settings
        assert (settings.objective, settings.weights) == ("margin", ())

    @pytest.mark.parametrize(
        ("text", "says"),
        [
            ("objective: speed", "objective: 'speed' is not among.*mapping of criteria"),
            ("objective: {travle: 1}", "objective.travle: unknown key.*did you mean 'travel'"),
            ("objective: {travel: -1}", "objective.travel: -1 is too small"),
            ("objective: {}", "objective: no criterion weighs anything"),
            ("objective: {travel: 0}", "objective: no criterion weighs anything"),
            ("objective: {compliance_axial: 1}", "compliance_axial needs the stiffness.*joint_stiffness_nm_per_rad"),
            ("joint_stiffness_nm_per_rad: [1, 2, 3, 4, 5]", "joint_stiffness_nm_per_rad: has 5 entries"),
            ("joint_stiffness_nm_per_rad: [1, 2, 3, 4, 5, 0]", "joint_stiffness_nm_per_rad.*0 is too small"),
        ],
    )
    def test_what_is_not_a_weight_is_one_clear_error(self, tmp_path, text, says):
        with pytest.raises(InputError, match=says):
            self.read(tmp_path, text)

    @pytest.mark.parametrize(
        "weights", [(("speed", 1.0),), (("travel", 1.0), ("travel", 2.0)), (("travel", 0.0),), (("travel", np.nan),)]
    )
    def test_settings_refuse_what_they_do_not_know(self, weights):
        with pytest.raises(InputError, match="objective"):
            Settings(weights=weights)
        with pytest.raises(InputError, match="joint_stiffness"):
            Settings(joint_stiffness=(1.0,) * 5)

    def test_a_plan_states_the_figures_and_is_read_again(self, tmp_path):
        stiff = "joint_stiffness_nm_per_rad: [4.0e+4, 5.0e+4, 3.0e+4, 1.0e+4, 1.2e+4, 6.0e+3]"
        asked = self.read(tmp_path, "objective: {travel: 1, compliance_lateral: 0.2}\n" + stiff)
        answer = plan(asked.robot, asked.tool, asked.holes[0], asked.settings)
        whole = Plan(asked.robot, asked.tool, asked.settings, (answer,))
        stated = plan_data(whole)["holes"][0]["criteria"]
        evaluation = Evaluation(answer.motion, answer.score, ())
        figures = measure(Drilling(asked.robot, asked.tool, asked.holes[0]), evaluation, asked.settings)
        assert stated["travel_deg"] == pytest.approx(np.rad2deg(figures.travel))
        assert stated["margin_deg_per_mm"] == pytest.approx(np.rad2deg(figures.margin) / 1e3)
        assert stated["plunge_rotation_deg"] == pytest.approx(20.1)
        assert stated["tool_speed_change_rpm"] == pytest.approx(20.1 / (50 / 5) / 360 * 60)
        assert stated["compliance_lateral_um_per_n"] == pytest.approx(figures.compliance_lateral * 1e6)
        write_plan(whole, tmp_path / "plan.json")
        again = read_plan(tmp_path / "plan.json")
        assert again.settings == asked.settings
        for name in CRITERIA:
            assert getattr(again.holes[0].measures, name) == pytest.approx(getattr(figures, name), rel=1e-10)

    def test_a_plan_without_the_figures_is_still_read(self, tmp_path):
        asked = self.read(tmp_path, "")
        whole = Plan(asked.robot, asked.tool, asked.settings,
                     (plan(asked.robot, asked.tool, asked.holes[0], asked.settings),))  # fmt: skip
        path = tmp_path / "plan.json"
        write_plan(whole, path)
        data = json.loads(path.read_text())
        assert data["holes"][0]["criteria"]["compliance_axial_um_per_n"] is None
        del data["holes"][0]["criteria"], data["settings"]["joint_stiffness_nm_per_rad"]
        path.write_text(json.dumps(data))
        assert read_plan(path).holes[0].measures is None
