"""The arm as rigid bodies, against pinocchio on the numbers of KUKA's own description."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest

from zerorev.files.io import read_robot, read_tool
from zerorev.kernels.dynamics import inverse_dynamics, mass_matrix
from zerorev.motion.bodies import bodies_of
from zerorev.motion.kinematics import forward, jacobian

DESCRIPTION = Path(__file__).parents[1] / "data/dynamics/kuka_kr6_r700_2.json"
GRAVITY = 9.81


class Peer:
    """The KR 6 in pinocchio, built joint by joint from the description, with a tool on its flange."""

    def __init__(self, tool):
        stated = json.loads(DESCRIPTION.read_text(encoding="utf-8"))
        self.model, joint = pin.Model(), 0
        for joint_of, link in zip(stated["joints"], stated["links"], strict=True):
            at = pin.SE3(pin.rpy.rpyToMatrix(np.array(joint_of["origin_rpy_rad"])), np.array(joint_of["origin_xyz_m"]))
            joint = self.model.addJoint(joint, pin.JointModelRZ(), at, joint_of["joint"])
            R = pin.rpy.rpyToMatrix(np.array(link["inertia_frame_rpy_rad"]))
            inertia = R @ np.diag(link["principal_inertia_kgm2"]) @ R.T
            body = pin.Inertia(link["mass_kg"], np.array(link["com_m"]), inertia)
            self.model.appendBodyToJoint(joint, body, pin.SE3.Identity())
        flange = stated["tool0"]
        self.flange = pin.SE3(pin.rpy.rpyToMatrix(np.array(flange["origin_rpy_rad"])), np.array(flange["origin_xyz_m"]))
        self.model.appendBodyToJoint(joint, pin.Inertia(tool.load.mass, tool.load.com, tool.load.inertia), self.flange)
        self.model.addFrame(pin.Frame("flange", joint, self.flange, pin.FrameType.OP_FRAME))
        self.data = self.model.createData()

    def torques(self, q, qd, qdd):
        return np.array([pin.rnea(self.model, self.data, *state) for state in zip(q, qd, qdd, strict=True)])

    def mass_matrix(self, q):
        upper = np.triu(pin.crba(self.model, self.data, q))
        return upper + np.triu(upper, 1).T

    def flange_pose(self, q):
        pin.framesForwardKinematics(self.model, self.data, q)
        return self.data.oMf[self.model.getFrameId("flange")].homogeneous


@pytest.fixture(scope="module")
def arm():
    robot, tool = read_robot("kuka_kr6_r700_2"), read_tool("thesis_drill")
    return robot, tool, bodies_of(robot, tool), Peer(tool)


def states(count, seed=0):
    rng = np.random.default_rng(seed)
    return rng.uniform(-2, 2, (count, 6)), rng.uniform(-3, 3, (count, 6)), rng.uniform(-20, 20, (count, 6))


def test_the_chain_of_the_description_is_the_house_own(arm):
    robot, _, _, peer = arm
    q = states(1000)[0]
    poses = np.array([peer.flange_pose(each) for each in q])
    np.testing.assert_allclose(forward(robot, q), poses, rtol=0, atol=1e-12)


@pytest.mark.parametrize("count", [1000])
def test_torques_of_a_motion(arm, count):
    robot, _, bodies, peer = arm
    q, qd, qdd = states(count)
    out = np.empty((count, 6))
    inverse_dynamics(robot.arm, bodies, q, qd, qdd, GRAVITY, out)
    np.testing.assert_allclose(out, peer.torques(q, qd, qdd), rtol=0, atol=1e-9)
    still = np.zeros_like(q)
    inverse_dynamics(robot.arm, bodies, q, still, still, GRAVITY, out)
    np.testing.assert_allclose(out, peer.torques(q, still, still), rtol=0, atol=1e-9)


def test_mass_matrix(arm):
    robot, _, bodies, peer = arm
    q = states(200)[0]
    out = np.empty((len(q), 6, 6))
    mass_matrix(robot.arm, bodies, q, out)
    np.testing.assert_allclose(out, [peer.mass_matrix(each) for each in q], rtol=0, atol=1e-12)


def test_forces_at_the_tip(arm):
    """By the Jacobian of the house, against pinocchio's torques with an outer force."""
    robot, tool, _, peer = arm
    rng = np.random.default_rng(3)
    q, still = states(50)[0], np.zeros(6)
    forces = rng.uniform(-200, 200, (len(q), 3))
    J = jacobian(robot, tool, q)[:, :3]
    for each, force, columns in zip(q, forces, J, strict=True):
        flange = peer.flange_pose(each)
        tip = (flange @ tool.T_flange_tcp)[:3, 3]
        pin.forwardKinematics(peer.model, peer.data, each)
        last = peer.data.oMi[6]
        at_joint = last.actInv(pin.Force(force, np.cross(tip, force)))
        outer = pin.StdVec_Force()
        for _ in range(6):
            outer.append(pin.Force.Zero())
        outer.append(at_joint)
        without = pin.rnea(peer.model, peer.data, each, still, still)
        with_force = pin.rnea(peer.model, peer.data, each, still, still, outer)
        np.testing.assert_allclose(columns.T @ force, without - with_force, rtol=0, atol=1e-9)
