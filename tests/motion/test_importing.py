"""Robots out of descriptions: the numbers of public ones, read by an outside library; what is refused, and why."""

from __future__ import annotations

import json
import shutil
from pathlib import Path
from xml.sax.saxutils import quoteattr

import numpy as np
import pinocchio
import pytest

from oracles.arm import rotation, translation
from zerorev.errors import InputError
from zerorev.files.conversion import robot_data
from zerorev.files.io import read_robot
from zerorev.model._arrays import rotation_rpy, transform
from zerorev.model.axes import Axes
from zerorev.motion import from_axes
from zerorev.motion.from_axes import robot_of_axes
from zerorev.motion.importing import import_robot, robot_file
from zerorev.motion.kinematics import forward, inverse

# facts of public descriptions: frames and axes of their joints; "source" says which
ARMS = json.loads((Path(__file__).parents[1] / "oracles" / "described_arms.json").read_text(encoding="utf-8"))
REFUSED = {
    "crx10ia": "axes 4 and 5 meet 150 mm from axis 6",
    "hc10": "axes 4 and 5 meet 162 mm from axis 6",
    "m710ic_50e": "axes 4 and 5 meet 160 mm from axis 6",
    "m430ia2p": "axes 4 and 5 meet 95 mm from axis 6",
    "crb15000_5_95": "axes 5 and 6 pass each other 80 mm apart",
    "lbr_iiwa14_r820": "7 turning joints",
    "lrmate200ic5h": "5 turning joints",
    "ur5e": "axes 2, 3 and 4 are parallel",
    "ur10e": "axes 2, 3 and 4 are parallel",
}
ROUNDED = {"a0509", "h2017", "m1013", "kr10_r1100_3", "kr20_r1820_2_e", "gp8", "gp25"}  # angles to four digits or so


def urdf(arm, changed=lambda joint: joint):
    """A description with the numbers of a public one."""
    parts = [f"<link name={quoteattr(link)}/>" for link in arm["links"]]
    for joint in map(changed, map(dict, arm["joints"])):
        inner = f"<parent link={quoteattr(joint['parent'])}/><child link={quoteattr(joint['child'])}/>"
        inner += '<origin xyz="{} {} {}" rpy="{} {} {}"/>'.format(*map(repr, [*joint["xyz"], *joint["rpy"]]))
        if "axis" in joint:
            inner += '<axis xyz="{} {} {}"/>'.format(*joint["axis"])
        if joint.get("limit"):
            inner += '<limit lower="{!r}" upper="{!r}" velocity="{!r}" effort="1"/>'.format(*joint["limit"])
        inner += joint.get("more", "")
        parts.append(f'<joint name={quoteattr(joint["name"])} type="{joint["type"]}">{inner}</joint>')
    return f'<?xml version="1.0"?><robot name="arm">{"".join(parts)}</robot>'


def poses(text, tip, names, joints):
    """T_root_tip of an outside library; what else hangs on the arm, as a piston does, stands at 0."""
    model = pinocchio.buildModelFromXML(text)
    data, frame = model.createData(), model.getFrameId(tip)
    found = []
    for q in joints:
        angles = [dict(zip(names, q, strict=True)).get(name, 0.0) for name in model.names[1:]]
        # a continuous joint has two numbers there
        of_joint = [[x] if n == 1 else [np.cos(x), np.sin(x)] for x, n in zip(angles, list(model.nqs)[1:], strict=True)]
        pinocchio.forwardKinematics(model, data, np.concatenate(of_joint))
        found.append(pinocchio.updateFramePlacement(model, data, frame).homogeneous)
    return np.array(found)


def written(tmp_path, text, name="arm.urdf"):
    path = tmp_path / name
    path.write_text(text, encoding="utf-8")
    return path


@pytest.mark.parametrize("name", [name for name in ARMS if name not in REFUSED])
def test_an_arm_moves_as_an_outside_library_reads_its_description(name, tmp_path):
    path = written(tmp_path, urdf(ARMS[name]))
    found = import_robot(path)
    robot = found.robot
    tip = robot.sources["geometry"].rsplit(" ", 1)[-1]
    joints = np.random.default_rng(5).uniform(-np.pi, np.pi, (200, 6))
    theirs = poses(path.read_text(encoding="utf-8"), tip, robot.joint_names, joints)
    ours = forward(robot, joints)
    if name == "kr210l150":  # axis 1 of this one was measured, and stands 3 mm beside the root
        ours = np.linalg.inv(robot.T_root_base) @ ours
    behind = np.linalg.inv(ours[0]) @ theirs[0]
    if name in ROUNDED:
        assert any("rounded" in note for note in found.notes)
        np.testing.assert_allclose(ours @ behind, theirs, atol=2e-3)
        return
    np.testing.assert_allclose(ours @ behind, theirs, atol=1e-9)
    # where the tip is not the flange of the class, the robot says so
    assert np.abs(behind - np.eye(4)).max() < 1e-9 or any(note.startswith("Tools count from") for note in found.notes)
    wanted = joints[np.abs(np.sin(robot.bend(joints))) > 0.05][:20]
    apart = np.abs(np.angle(np.exp(1j * (inverse(robot, forward(robot, wanted)) - wanted[:, None]))))
    assert np.nanmin(np.nan_to_num(apart.max(axis=2), nan=9.0), axis=1).max() < 1e-6


@pytest.mark.parametrize(("name", "reason"), REFUSED.items())
def test_an_arm_of_another_class_is_refused_with_the_reason(name, reason, tmp_path):
    with pytest.raises(InputError, match=reason):
        import_robot(written(tmp_path, urdf(ARMS[name])))


def test_what_is_written_is_read_as_the_same_robot(tmp_path):
    for name in ("kr6_r700_2", "r2000ic_165f", "gp25", "mh5"):
        robot = import_robot(written(tmp_path, urdf(ARMS[name])), manufacturer="FANUC" if name[0] == "r" else "").robot
        again = read_robot(written(tmp_path, robot_file(robot), "arm.yaml"))
        assert robot_data(again) == robot_data(robot)
        assert (again.sources, again.caveats) == (robot.sources, robot.caveats)
        np.testing.assert_array_equal(forward(again, np.ones(6)), forward(robot, np.ones(6)))


def test_the_shipped_numbers_come_out_again(tmp_path):
    for name, ships in (("kr6_r700_2", "kuka_kr6_r700_2"), ("m710ic_70", "fanuc_m710ic_70"), ("gp8", "yaskawa_gp8")):
        robot, shipped = import_robot(written(tmp_path, urdf(ARMS[name]))).robot, read_robot(ships)
        np.testing.assert_allclose(robot.arm[:7], shipped.arm[:7], atol=1e-9)
        assert robot.arm.sign == shipped.arm.sign
        np.testing.assert_allclose(robot.arm.offset, shipped.arm.offset, atol=1e-12)
        np.testing.assert_allclose(robot.limits.lower, shipped.limits.lower, atol=2e-5)
        assert robot.base_in_root == shipped.base_in_root


def random_axes(seed):
    """The six axes of a random arm, by the definition of the class, in a random frame with a random tip."""
    rng = np.random.default_rng(seed)
    a1, a2, b, c1 = rng.uniform(-0.4, 0.4, 4) * rng.integers(0, 2, 4)
    c2, c3, c4 = rng.uniform(0.2, 1.5, 3)
    places = ((0, 0, 0), (a1, b, c1), (0, 0, c2), (a2, 0, c3), (0, 0, 0), (0, 0, c4))
    zero, sign = rng.integers(-3, 4, 6) * np.pi / 6, rng.choice([-1.0, 1.0], 6)
    upright = rng.random() < 0.7
    T = np.eye(4) if upright else transform(rotation_rpy(*rng.uniform(-3, 3, 3)), rng.uniform(-1, 1, 3))
    root, direction, point = T.copy(), [], []
    for k, place in enumerate(places):
        axis = np.eye(3)[[2, 1, 1, 2, 1, 2][k]]
        T = T @ translation(*place)
        direction.append(sign[k] * T[:3, :3] @ axis)
        point.append(T[:3, 3] + rng.uniform(-1, 1) * (T[:3, :3] @ axis))  # any point of the axis says the same
        T = T @ rotation(axis, zero[k])
    tip = transform(rotation_rpy(*rng.uniform(-3, 3, 3)), rng.uniform(-0.2, 0.2, 3)) if seed % 2 else np.eye(4)
    six = tuple(f"J{k}" for k in range(1, 7))
    whole = np.full(6, 3.0)
    return Axes("arm", six, np.array(direction), np.array(point), T @ tip, "tip", root, -whole, whole, whole)


def test_random_arms_of_the_class_are_found_in_any_frame():
    apart = [robot_of_axes(random_axes(seed)).apart for seed in range(1000)]
    assert max(apart) < 1e-9


def test_an_arm_outside_the_class_by_a_little_is_refused():
    axes = random_axes(0)
    for k, moved in ((3, 2e-6), (5, 1e-3)):
        point = axes.point.copy()
        point[k] += moved * np.cross(axes.direction[4], axes.direction[k])
        changed = Axes(**(vars(axes) | {"point": point}))
        assert from_axes.conditions(changed)
    assert not from_axes.conditions(axes)


class TestDescriptions:
    """What a description may hold beside the arm, and what is refused."""

    ARM = ARMS["kr6_r700_2"]

    def of(self, tmp_path, changed=lambda joint: joint, arm=None, **more):
        return import_robot(written(tmp_path, urdf(arm or self.ARM, changed)), **more)

    def test_the_tip_is_chosen_and_said(self, tmp_path):
        assert "the tip is the link tool0; others: " in self.of(tmp_path).notes[0]
        fanuc = import_robot(written(tmp_path, urdf(ARMS["m710ic_70"])))
        assert "the tip is the link fanuc_flange" in fanuc.notes[0]

    def test_another_tip_is_taken_by_name(self, tmp_path):
        found = self.of(tmp_path, tip="flange")
        assert found.robot.sources["geometry"].endswith("tip flange")
        with pytest.raises(InputError, match=r"--tip: no link nose \(accepted: .*tool0"):
            self.of(tmp_path, tip="nose")

    def test_limits_that_nobody_states_are_asked_for(self, tmp_path):
        def endless(joint):
            if joint["name"] == "joint_6":
                joint |= {"type": "continuous", "limit": [0.0, 0.0, 5.0]}
            if joint["name"] == "joint_4":
                del joint["limit"]
            return joint

        with pytest.raises(InputError, match=r"no limits or no speed of joint_4, joint_6 .*--limit joint_4=LOWER"):
            self.of(tmp_path, endless)
        given = {"joint_4": (-185.0, 185.0, 400.0), "joint_6": (-350.0, 350.0, None)}
        robot = self.of(tmp_path, endless, limits=given).robot
        np.testing.assert_allclose(np.rad2deg(robot.limits.upper[[3, 5]]), [185, 350])
        assert robot.limits.speed[5] == pytest.approx(5.0, abs=1e-6)  # of the file
        assert "given by hand: joint_4, joint_6" in robot.sources["limits"]
        with pytest.raises(InputError, match="--limit: no joint A9"):
            self.of(tmp_path, limits={"A9": (0.0, 1.0, 1.0)})

    def test_a_missing_mesh_does_not_matter(self, tmp_path):
        mesh = (
            '<link name="base_link"><visual><geometry><mesh filename="package://x/no.stl"/></geometry></visual></link>'
        )
        text = urdf(self.ARM).replace('<link name="base_link"/>', mesh)
        assert "no.stl" in text
        assert import_robot(written(tmp_path, text)).apart < 1e-9

    def test_joints_that_follow_others_or_slide_are_left_aside_or_refused(self, tmp_path):
        def gripper(kind, more):
            finger = {
                "name": "finger",
                "type": kind,
                "parent": "tool0",
                "child": "f",
                "xyz": [0, 0, 0.1],
                "rpy": [0] * 3,
            }
            return self.ARM | {
                "links": [*self.ARM["links"], "f"],
                "joints": [*self.ARM["joints"], finger | {"axis": [1, 0, 0], "limit": [0, 1, 1], "more": more}],
            }

        for kind, more in (("prismatic", ""), ("revolute", '<mimic joint="joint_1"/>')):
            found = self.of(tmp_path, arm=gripper(kind, more))
            assert "what follows finger is left aside" in found.notes[0]
            with pytest.raises(InputError, match=r"joint finger (is prismatic|follows another)"):
                self.of(tmp_path, arm=gripper(kind, more), tip="f")
        with pytest.raises(InputError, match=r"7 turning joints from .* to f"):
            self.of(tmp_path, arm=gripper("revolute", ""))

    def test_a_joint_of_another_kind_within_the_arm_is_the_reason(self, tmp_path):
        def coupled(joint):
            return joint | ({"more": '<mimic joint="joint_2"/>'} if joint["name"] == "joint_3" else {})

        with pytest.raises(InputError, match=r"joint joint_3 follows another \(mimic\)"):
            self.of(tmp_path, coupled)

    def test_loops_and_loose_ends_are_refused(self, tmp_path):
        def to_itself(joint):
            return joint | ({"parent": "tool0"} if joint["name"] == "joint_1" else {})

        def nowhere(joint):
            return joint | ({"parent": "elsewhere"} if joint["name"] == "joint_1" else {})

        with pytest.raises(InputError, match=r"root links|loop"):
            self.of(tmp_path, to_itself)
        with pytest.raises(InputError, match="no link elsewhere, which a joint names"):
            self.of(tmp_path, nowhere)
        with pytest.raises(InputError, match="no links"):
            import_robot(written(tmp_path, '<robot name="r"/>'))

    def test_two_arms_ask_for_the_tip(self, tmp_path):
        def renamed(joint):
            names = {key: f"left_{joint[key]}" for key in ("name", "child")}
            parent = joint["parent"] if joint["parent"] == "world" else f"left_{joint['parent']}"
            return joint | names | {"parent": parent}

        arm = self.ARM
        root = {joint["parent"] for joint in arm["joints"]} - {joint["child"] for joint in arm["joints"]}
        other = [renamed(joint) | ({"parent": min(root)} if joint["parent"] in root else {}) for joint in arm["joints"]]
        both = {"links": arm["links"] + [f"left_{link}" for link in arm["links"] if link not in root],
                "joints": arm["joints"] + other}  # fmt: skip
        with pytest.raises(InputError, match=r"two arms of six joints .*--tip"):
            self.of(tmp_path, arm=both)
        assert self.of(tmp_path, arm=both, tip="left_tool0").apart < 1e-9

    def test_xacro_is_expanded_with_packages_beside_the_file(self, tmp_path):
        pytest.importorskip("xacro")
        (tmp_path / "repo" / "urdf").mkdir(parents=True)
        (tmp_path / "repo" / "package.xml").write_text("<package><name>my_support</name></package>")
        numbers = urdf(self.ARM).replace('<?xml version="1.0"?>', "").replace('<robot name="arm">', "")
        macro = numbers.removesuffix("</robot>")
        head = '<robot xmlns:xacro="http://www.ros.org/wiki/xacro" name="arm">'
        written(
            tmp_path / "repo/urdf", f'{head}<xacro:macro name="arm" params="">{macro}</xacro:macro></robot>', "m.xacro"
        )
        top = '<xacro:include filename="$(find {})/urdf/m.xacro"/><xacro:arm/></robot>'
        found = import_robot(written(tmp_path / "repo/urdf", head + top.format("my_support"), "arm.xacro"))
        assert found.robot.arm[:7] == pytest.approx(read_robot("kuka_kr6_r700_2").arm[:7], abs=1e-12)
        with pytest.raises(InputError, match="no folder of the package other_support"):
            import_robot(written(tmp_path / "repo/urdf", head + top.format("other_support"), "arm.xacro"))
        with pytest.raises(InputError, match=r"is not expanded: .*ode"):
            import_robot(written(tmp_path / "repo/urdf", head + "${ode}</robot>", "arm.xacro"))

    def test_what_is_not_a_description(self, tmp_path):
        with pytest.raises(InputError, match="no such file"):
            import_robot(tmp_path / "no.urdf")
        with pytest.raises(InputError, match="no such file"):
            import_robot(tmp_path / "no.xacro")
        with pytest.raises(InputError, match="not XML"):
            import_robot(written(tmp_path, "robot: x"))


DH = """
format: zerorev.dh/1
name: kr6
convention: {kind}
joints:
{rows}
{base}
"""
LIMITS = "lower_deg: -100, upper_deg: 100, speed_deg_s: 200"


def table(kind, rows, base=""):
    names = [f"A{k}" for k in range(1, 7)]
    lines = [
        f"  - {{name: {name}, a_mm: {a}, alpha_deg: {alpha}, d_mm: {d}, theta_deg: {theta}, sign: {sign}, {LIMITS}}}"
        for name, (a, alpha, d, theta, sign) in zip(names, rows, strict=True)
    ]
    return DH.format(kind=kind, rows="\n".join(lines), base=base)


def test_a_table_of_link_parameters_of_either_kind(tmp_path):
    """The thesis' arm, whose Table 1 (modified) theory §6 compares with the shipped one."""
    modified = [(0, 180, -400, 0, 1), (25, 90, 0, 0, 1), (335, 0, 0, -90, 1), (25, 90, -365, 0, 1), (0, -90, 0, 0, 1),
                (0, 90, -90, 0, 1)]  # fmt: skip
    standard = [(25, 90, -400, 0, 1), (335, 0, 0, 0, 1), (25, 90, 0, -90, 1), (0, -90, -365, 0, 1), (0, 90, 0, 0, 1),
                (0, 180, -90, 0, 1)]  # fmt: skip
    over = "base: {rpy_deg: [180, 0, 0]}"
    one = import_robot(written(tmp_path, table("modified", modified), "m.yaml"))
    other = import_robot(written(tmp_path, table("standard", standard, over), "s.yaml"))
    shipped = read_robot("kuka_kr6_r700_2").arm
    for found in (one, other):
        assert found.apart < 1e-9
        np.testing.assert_allclose(np.abs(found.robot.arm[:7]), np.abs(shipped[:7]), atol=1e-12)
        assert found.robot.arm.sign[:5] == shipped.sign[:5]
    ur5e = [(0, 90, 162.5, 0, 1), (-425, 0, 0, 0, 1), (-392.2, 0, 0, 0, 1), (0, 90, 133.3, 0, 1), (0, -90, 99.7, 0, 1),
            (0, 0, 99.6, 0, 1)]  # fmt: skip
    with pytest.raises(InputError, match="axes 2, 3 and 4 are parallel"):
        import_robot(written(tmp_path, table("standard", ur5e), "u.yaml"))
    with pytest.raises(InputError, match="one tip"):
        import_robot(tmp_path / "m.yaml", tip="x")
    with pytest.raises(InputError, match=r"convention"):
        import_robot(written(tmp_path, table("craig", modified), "c.yaml"))
    shutil.copy(tmp_path / "m.yaml", tmp_path / "n.yaml")
