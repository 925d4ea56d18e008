"""The kernels against their slow twin, the thesis' tables and numbers, an outside library, and themselves."""

from __future__ import annotations

import numba
import numpy as np
import py_opw_kinematics as opw
import pytest

from oracles import arm as twin
from zerorev.kernels.arm import WRIST_SINGULAR, other_flip
from zerorev.model.hole import Hole
from zerorev.model.tool import Tool
from zerorev.motion import kinematics
from zerorev.motion.drilling import Drilling, joint_rates

POSES = 1_000 if numba.config.DISABLE_JIT else 10_000
FEW = 100

FRAME_6_FLANGE = np.diag([-1.0, 1.0, -1.0, 1.0])  # theory §6: the thesis' frame 6, seen from KUKA's flange


def random_joints(robot, count, seed=1):
    return np.random.default_rng(seed).uniform(robot.limits.lower, robot.limits.upper, (count, 6))


def angle_between(a, b):
    """Difference of angles, modulo a full turn."""
    return np.abs((a - b + np.pi) % (2 * np.pi) - np.pi)


def distance(many, one):
    """Greatest joint difference modulo full turns; infinite from a NaN row."""
    return np.nan_to_num(angle_between(many, one).max(axis=-1), nan=np.inf)


def hole_at(robot, tool, joints, offset=0.0):
    """The hole whose bottom the tool's tip touches at psi = 0 with these joints, `offset` [m] further along +Z_tcp."""
    T = kinematics.forward(robot, joints) @ tool.T_flange_tcp
    return Hole("here", T[:3, 3] + offset * T[:3, 2], -T[:3, 2], 0.01, psi_zero=T[:3, 1])


class TestDenavitHartenberg:
    """Both tables of the thesis describe the arm that the kernels move (theory §6)."""

    def test_table_2_is_table_1_with_joint_3_counted_the_other_way_round(self, robot):
        B = twin.translation(0, 0, 0.4) @ twin.rotation(twin.X, np.pi)  # base height and the downward z of Table 1
        for q in random_joints(robot, FEW):
            other_way = q * [1, 1, -1, 1, 1, 1]
            np.testing.assert_allclose(twin.standard_dh(other_way), B @ twin.modified_dh(q), atol=1e-12)

    def test_table_1_counts_the_joints_as_the_controller_does(self, robot):
        for q in random_joints(robot, FEW):
            np.testing.assert_allclose(kinematics.forward(robot, q), twin.modified_dh(q) @ FRAME_6_FLANGE, atol=1e-12)

    def test_the_tool_is_equation_3_10_with_its_two_lengths_swapped_back(self, tool):
        T_6_tcp = np.array([[0, 0, 1, -0.1], [0, 1, 0, 0], [-1, 0, 0, -0.065], [0, 0, 0, 1]])
        np.testing.assert_allclose(tool.T_flange_tcp, FRAME_6_FLANGE @ T_6_tcp, atol=1e-15)


class TestForward:
    def test_agrees_with_the_twin(self, any_robot):
        for joints in random_joints(any_robot, FEW):
            np.testing.assert_allclose(
                kinematics.forward(any_robot, joints), twin.forward(any_robot, joints), atol=1e-14
            )

    def test_appendix_b_joints_put_the_tip_where_its_text_says(self, robot, tool, position):
        T = kinematics.forward(robot, np.deg2rad(position.axis_deg)) @ tool.T_flange_tcp
        behind_mm = np.array([position.depth_mm, 0, position.depth_mm])
        tip_mm = np.array(position.target_mm) - behind_mm[:, None] * [1, 0, 0]
        assert np.linalg.norm(T[:, :3, 3] * 1e3 - tip_mm, axis=1).max() < 0.002
        np.testing.assert_allclose(T[:, :3, 2], np.tile([-1.0, 0.0, 0.0], (3, 1)), atol=2e-5)

    def test_appendix_b_joints_are_the_published_spins(self, robot, tool, position):
        T = kinematics.tcp_pose(position.hole, position.profile.standoff, position.profile.psi)
        joints = kinematics.inverse(robot, T @ np.linalg.inv(tool.T_flange_tcp))[:, position.branch]
        assert np.rad2deg(angle_between(joints, np.deg2rad(position.axis_deg))).max() < 0.005


class TestInverse:
    def test_every_solution_reproduces_the_pose(self, any_robot):
        T = kinematics.forward(any_robot, random_joints(any_robot, POSES))
        solutions = kinematics.inverse(any_robot, T)
        reached = ~np.isnan(solutions).any(axis=-1)
        again = kinematics.forward(any_robot, solutions)
        assert np.abs(again - T[:, None])[reached].max() < 1e-9
        assert (np.abs(solutions[reached]) <= np.pi).all()
        assert np.isnan(solutions[~reached]).all()

    def test_the_seed_is_among_the_solutions(self, any_robot):
        joints = random_joints(any_robot, POSES)
        # a joint angle itself is known only as well as sin(q5), the elbow and the shoulder let it be
        well_posed = np.abs(np.sin(joints[:, 4])) > 1e-3
        solutions = kinematics.inverse(any_robot, kinematics.forward(any_robot, joints))
        assert distance(solutions, joints[:, None]).min(axis=1)[well_posed].max() < 1e-9

    def test_finds_what_opw_kinematics_finds(self, any_robot):
        arm = any_robot.arm
        model = opw.KinematicModel(*arm[:7], offsets=arm.offset, flip_axes=tuple(sign < 0 for sign in arm.sign))
        T = kinematics.forward(any_robot, random_joints(any_robot, POSES, seed=2))
        ours = kinematics.inverse(any_robot, T)
        theirs = opw.Robot(model, degrees=False).reach(opw.RigidTransform.from_matrix(T)).joints
        assert (np.isnan(ours[..., 0]).sum(axis=1) == np.isnan(theirs[..., 0]).sum(axis=1)).all()
        apart = distance(ours[:, :, None], theirs[:, None])
        assert apart.min(axis=2)[~np.isnan(ours[..., 0])].max() < 1e-7
        assert apart.min(axis=1)[~np.isnan(theirs[..., 0])].max() < 1e-7

    def test_the_other_flip_of_a_branch_is_its_neighbour(self, any_robot):
        T = kinematics.forward(any_robot, random_joints(any_robot, FEW, seed=4))
        branches, found = kinematics.inverse(any_robot, T).reshape(-1, 2, 6), np.empty(6)
        for pair in branches[~np.isnan(branches).any(axis=(1, 2))]:
            for one, other in (pair, pair[::-1]):
                other_flip(any_robot.arm, one, found)
                np.testing.assert_allclose(found, other, atol=1e-14)

    def test_branches_stand_in_the_order_of_their_bits(self, any_robot):
        T = kinematics.forward(any_robot, random_joints(any_robot, FEW, seed=3))
        for solutions in kinematics.inverse(any_robot, T):
            for branch, joints in enumerate(solutions):
                if np.isnan(joints).any():
                    continue
                shoulder, elbow, wrist = twin.points_of_arm(any_robot, joints)
                upper, line = elbow - shoulder, wrist - shoulder
                behind = wrist[0] < 0
                # the elbow's side of the line, for an arm that reaches forward; mirrored for one that reaches back
                below = (upper[1] * line[0] - upper[0] * line[1] < 0) != behind
                assert branch == 4 * behind + 2 * below + (joints[4] < 0)

    def test_what_is_out_of_reach_is_nan(self, any_robot):
        T = np.eye(4)
        T[:3, 3] = 10.0, 0.0, 0.0
        assert np.isnan(kinematics.inverse(any_robot, T)).all()


class TestRates:
    """theta_s and theta_psi (theory §1)."""

    @pytest.fixture
    def places(self, any_robot, tool):
        """Holes at the tips of random arms that stand well away from singularities, and those arms' joints."""
        found = []
        for joints in random_joints(any_robot, 60, seed=4):
            hole = hole_at(any_robot, tool, joints)
            J = twin.jacobian(any_robot, joints, hole.target)
            if np.linalg.cond(J) < 50 * max(1, 1 / any_robot.arm.c2):
                found.append((hole, joints))
        assert len(found) >= 10
        return found[:10]

    def test_are_the_inverse_jacobian_of_the_twin(self, any_robot, tool, places):
        for hole, _ in places:
            T = kinematics.tcp_pose(hole, 0.003, 0.2) @ np.linalg.inv(tool.T_flange_tcp)
            rates = joint_rates(Drilling(any_robot, tool, hole), 0.003, 0.2)
            for branch, joints in enumerate(kinematics.inverse(any_robot, T)):
                for ours, theirs in zip(rates, self.by_twin(any_robot, tool, hole, joints), strict=True):
                    np.testing.assert_allclose(ours[branch], theirs, rtol=1e-8, atol=1e-8)

    @staticmethod
    def by_twin(robot, tool, hole, joints):
        if np.isnan(joints).any():
            return np.full((2, 6), np.nan)
        return twin.rates(robot, tool, hole.direction, joints)

    def test_are_the_derivatives_of_the_joints(self, any_robot, tool, places):
        step = 1e-5
        standoff, psi = np.array([[step, -step, 0, 0], [0, 0, step, -step]])
        for hole, _ in places:
            T = kinematics.tcp_pose(hole, standoff, psi) @ np.linalg.inv(tool.T_flange_tcp)
            joints = kinematics.inverse(any_robot, T)
            rates = joint_rates(Drilling(any_robot, tool, hole), 0.0, 0.0)
            for (ahead, behind), rate in zip(joints.reshape(2, 2, 8, 6), rates, strict=True):
                moved = (ahead - behind + np.pi) % (2 * np.pi) - np.pi
                slope = moved / (2 * step)
                # the error of a central difference grows with the third derivative, so with the rate's cube
                size = np.abs(rate).max(axis=-1, keepdims=True)
                assert (np.abs(slope - rate) <= 1e-6 * (1 + size**3))[~np.isnan(slope + rate)].all()
                assert (np.isnan(slope) == np.isnan(rate)).all()

    def test_wrist_flips_share_their_rates_but_for_the_sign_of_joint_5(self, any_robot, tool, places):
        for hole, _ in places:
            for field in joint_rates(Drilling(any_robot, tool, hole), 0.002, -0.3):
                np.testing.assert_array_equal(field[0::2], field[1::2] * [1, 1, 1, 1, -1, 1])

    def test_spin_cannot_move_joints_1_to_3_where_the_drill_axis_meets_the_wrist_centre(self, any_robot):
        straight = Tool.from_mm_deg((0, 0, 120), (180, 0, 0))
        assert kinematics.wrist_offset(any_robot, straight) < 1e-15
        for joints in random_joints(any_robot, FEW, seed=5):
            hole = hole_at(any_robot, straight, joints)
            _, theta_psi = joint_rates(Drilling(any_robot, straight, hole), 0.0, 0.0)
            assert np.abs(np.nan_to_num(theta_psi[:, :3])).max() < 1e-12

    def test_fields_keep_the_shape_of_the_points(self, robot, tool, positions):
        standoff, psi = np.linspace(0, 0.05, 5)[:, None], np.linspace(-1, 1, 3)
        theta_s, theta_psi = joint_rates(Drilling(robot, tool, positions[0].hole), standoff, psi)
        assert theta_s.shape == theta_psi.shape == (5, 3, 8, 6)
        alone = joint_rates(Drilling(robot, tool, positions[0].hole), standoff[3, 0], psi[1])
        # the last bits depend on how many points are worked on at once
        np.testing.assert_allclose([theta_s[3, 1], theta_psi[3, 1]], alone, rtol=1e-12, atol=1e-12)


NEAR = [0.0, *(side * size for size in (1e-15, 1e-12, 1e-9, 1e-6, 1e-3) for side in (1, -1))]


class TestSingularities:
    """NaN or a finite answer, never a wrong one, and never a warning (which would be an error here)."""

    @pytest.mark.parametrize("off", NEAR)
    def test_wrist(self, any_robot, tool, off):
        for joints in random_joints(any_robot, 5, seed=6):
            joints[4] = off
            self.check(any_robot, tool, joints, 0.0)
            if off == 0.0:
                assert self.nearest_rates_are_nan(any_robot, tool, joints)

    @pytest.mark.parametrize("off", NEAR)
    def test_elbow_straight_and_the_edge_of_reach(self, any_robot, tool, off):
        arm = any_robot.arm
        for joints in random_joints(any_robot, 5, seed=7):
            straight = np.arctan2(-arm.a2, arm.c3)  # the model angle that puts the forearm in line with the upper arm
            joints[2] = (straight + arm.offset[2]) * arm.sign[2]
            joints[4] = 0.7
            self.check(any_robot, tool, joints, off)

    @pytest.mark.parametrize("off", NEAR)
    def test_wrist_centre_over_axis_1(self, any_robot, tool, off):
        T = np.eye(4)
        T[:3, :3] = twin.rotation(twin.X, 0.3)[:3, :3] @ twin.rotation(twin.Y, 0.4)[:3, :3]
        side = np.array([np.cos(0.8), np.sin(0.8), 0.0])
        arm = any_robot.arm
        for lever in (0.0, arm.b):  # on axis 1, and on the cylinder within which a lateral offset cannot reach
            T[:3, 3] = (lever + off) * side + [0, 0, arm.c1 + 0.7 * (arm.c2 + arm.c3)] + arm.c4 * T[:3, 2]
            solutions = kinematics.inverse(any_robot, T)
            self.reproduces(any_robot, T, solutions)
            if abs(lever + off) < arm.b - 1e-12:
                assert np.isnan(solutions).all()

    def test_a_pose_of_nan_is_nan(self, robot):
        T = np.eye(4)
        T[0, 3] = np.nan
        assert np.isnan(kinematics.inverse(robot, T)).all()

    def check(self, robot, tool, joints, offset):
        hole = hole_at(robot, tool, joints, offset)
        T = kinematics.tcp_pose(hole, 0.0, 0.0) @ np.linalg.inv(tool.T_flange_tcp)
        solutions = kinematics.inverse(robot, T)
        self.reproduces(robot, T, solutions)
        fields = joint_rates(Drilling(robot, tool, hole), 0.0, 0.0)
        for field, twist in zip(fields, twin.twists(hole.direction), strict=True):
            for rates, solution in zip(field, solutions, strict=True):
                if np.isnan(rates).any():
                    assert np.isnan(rates).all()
                    continue
                if np.isnan(solution).any():  # on the very edge of reach the last bit decides
                    assert abs(offset) < 1e-12
                    continue
                J = twin.jacobian(robot, solution, hole.target)
                size = np.linalg.norm(J) * np.linalg.norm(rates)
                assert np.abs(J @ rates - twist).max() < 1e-9 + 1e-11 * size**2

    @staticmethod
    def reproduces(robot, T, solutions):
        reached = ~np.isnan(solutions).any(axis=-1)
        if reached.any():
            # within WRIST_SINGULAR the wrist is taken for straight
            assert np.abs(kinematics.forward(robot, solutions[reached]) - T).max() < 10 * WRIST_SINGULAR

    @staticmethod
    def nearest_rates_are_nan(robot, tool, joints):
        hole = hole_at(robot, tool, joints)
        T = kinematics.forward(robot, joints)
        posture = distance(kinematics.inverse(robot, T)[:, :3], joints[:3]).argmin()
        return all(np.isnan(field[posture]).all() for field in joint_rates(Drilling(robot, tool, hole), 0.0, 0.0))
