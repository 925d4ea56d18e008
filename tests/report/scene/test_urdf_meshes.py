from __future__ import annotations

from pathlib import Path
from xml.sax.saxutils import quoteattr

import numpy as np
import pytest

from zerorev.errors import InputError
from zerorev.model._arrays import rotation_rpy, rpy_of
from zerorev.motion.links import chain, link_frames

pytest.importorskip("defusedxml", reason="descriptions need defusedxml (pip install 'zerorev[view]')")
trimesh = pytest.importorskip("trimesh", reason="meshes need trimesh (pip install 'zerorev[view]')")

from zerorev.report.scene.urdf_meshes import read_meshes  # noqa: E402


def write_urdf(
    robot,
    folder: Path,
    *,
    signs=(1, -1, 1, 1, -1, 1),
    quarters=(0, 1, -1, 0, 0, 0),
    mesh="meshes/box.stl",
    more="",
    long=0.0,
):
    """A description that counts its joints in its own way: its joint = sign * controller angle + quarter * 90 deg.

    Each link is a box whose corner lies in the link's frame of the description, turned by a frame of its own.
    """
    rng = np.random.default_rng(3)
    (folder / "meshes").mkdir(exist_ok=True)
    box = trimesh.creation.box(extents=(100, 60, 40))
    box.apply_translation((50, 30, 20))
    box.export(folder / "meshes" / "box.stl")
    # frames of the description: our frames at joints 0, each turned in its own way
    joints = np.zeros(6)
    ours = [np.eye(4), *link_frames(robot, joints)]
    turned = [np.eye(4)]
    for T in ours[1:]:
        own = np.eye(4)
        own[:3, :3] = rotation_rpy(*rng.uniform(-2, 2, 3))
        turned.append(T @ own)
    parts = [link("base_link", mesh)]
    for i, joint in enumerate(chain(robot)):
        axis = joint.sign * signs[i] * np.eye(3)[joint.axis]  # in our frame
        in_own = turned[i + 1][:3, :3].T @ ours[i + 1][:3, :3] @ axis
        # at its own zero the joint is turned back by its offset
        back = np.eye(4)
        angle = -quarters[i] * np.pi / 2
        K = np.cross(np.eye(3), in_own)
        back[:3, :3] += np.sin(angle) * K + (1 - np.cos(angle)) * K @ K
        T = np.linalg.inv(turned[i]) @ turned[i + 1] @ back
        xyz, rpy = T[:3, 3] + (0, 0, long if i == 2 else 0), rpy_of(T[:3, :3])
        parts += [
            link(f"link_{i + 1}", mesh),
            f'<joint name="j{i + 1}" type="revolute"><parent link="{"base_link" if i == 0 else f"link_{i}"}"/>'
            f'<child link="link_{i + 1}"/><origin xyz="{text(xyz)}" rpy="{text(rpy)}"/>'
            f'<axis xyz="{text(in_own)}"/></joint>',
        ]
    path = folder / "robot.urdf"
    path.write_text(f'<?xml version="1.0"?>{more}<robot name="r">{"".join(parts)}</robot>')
    return path, turned


def link(name, mesh):
    return (
        f'<link name="{name}"><visual><geometry><mesh filename={quoteattr(mesh)} scale="0.001 0.001 0.001"/></geometry>'
        '<material name="m"><color rgba="1 0.5 0 1"/></material></visual></link>'
    )


def text(values):
    return " ".join(f"{value:.15g}" for value in values)


@pytest.mark.parametrize("quarters", [(0, 0, 0, 0, 0, 0), (0, 1, -1, 0, 0, 0), (1, 2, 1, 0, 1, 0)])
def test_meshes_stand_where_the_description_has_them(any_robot, tmp_path, quarters):
    """At any joints, our link frame with the mesh in it is the description's link with the mesh in that."""
    path, turned = write_urdf(any_robot, tmp_path, quarters=quarters)
    links = read_meshes(path, any_robot)
    assert [len(link) for link in links] == [1] * 7
    ours = [np.eye(4), *link_frames(any_robot, np.zeros(6))]
    corners = np.array(np.meshgrid([0, 0.1], [0, 0.06], [0, 0.04])).reshape(3, -1).T
    for number, (mesh,) in enumerate(links):
        T = np.linalg.inv(ours[number]) @ turned[number]
        expected = corners @ T[:3, :3].T + T[:3, 3]
        apart = np.linalg.norm(mesh.vertices[:, None] - expected, axis=2)
        assert apart.min(axis=0).max() < 1e-6
        assert apart.min(axis=1).max() < 1e-6
        assert mesh.colour == "#ff8000"


def test_another_robot_is_refused(robot, tmp_path):
    path, _ = write_urdf(robot, tmp_path, long=0.004)
    with pytest.raises(InputError, match=r"axis \d lies elsewhere than that of kuka_kr6_r700_2"):
        read_meshes(path, robot)


def test_entities_are_refused(robot, tmp_path):
    path, _ = write_urdf(robot, tmp_path, more='<!DOCTYPE robot [<!ENTITY a "b">]>')
    with pytest.raises(InputError, match="document type or entities"):
        read_meshes(path, robot)


@pytest.mark.parametrize(
    "mesh", ["../secret.stl", "/etc/passwd", "http://example.com/a.stl", "file:///etc/passwd", "meshes/no.stl"]
)
def test_meshes_outside_the_folder_are_refused(robot, tmp_path, mesh):
    inner = tmp_path / "inner"
    inner.mkdir()
    trimesh.creation.box().export(tmp_path / "secret.stl")
    path, _ = write_urdf(robot, inner, mesh=mesh)
    with pytest.raises(InputError, match="mesh"):
        read_meshes(path, robot)


def test_not_through_a_link_either(robot, tmp_path):
    inner = tmp_path / "inner"
    inner.mkdir()
    trimesh.creation.box().export(tmp_path / "secret.stl")
    (inner / "link.stl").symlink_to(tmp_path / "secret.stl")
    path, _ = write_urdf(robot, inner, mesh="link.stl")
    with pytest.raises(InputError, match=r"no mesh link\.stl inside"):
        read_meshes(path, robot)


def test_packages_are_looked_for_beside_the_file(robot, tmp_path):
    path, _ = write_urdf(robot, tmp_path, mesh="package://some_support/meshes/box.stl")
    assert len(read_meshes(path, robot)) == 7


def test_other_formats_and_broken_meshes_are_refused(robot, tmp_path):
    (tmp_path / "a.dae").write_text("<x/>")
    with pytest.raises(InputError, match=r"\.dae.*stl"):
        read_meshes(write_urdf(robot, tmp_path, mesh="a.dae")[0], robot)
    (tmp_path / "a.stl").write_bytes(b"nothing")
    with pytest.raises(InputError, match=r"a\.stl"):
        read_meshes(write_urdf(robot, tmp_path, mesh="a.stl")[0], robot)


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ("", "not XML"),
        ("<sdf/>", "begins with <sdf>"),
        ("<robot/>", "0 root links"),
        ('<robot><link name="a"/></robot>', "0 moving joints"),
        ('<robot><link name="a"/><joint name="j" type="prismatic"/></robot>', "type 'prismatic'"),
        ('<robot><link name="a"/><link name="b"/><joint name="j" type="fixed"><parent link="a"/><child link="b"/>'
         '<origin xyz="1 x 2"/></joint></robot>', "is not 3 numbers"),
        ('<robot><link name="a"/><link name="b"/><joint name="j" type="fixed"><parent/>'
         '<child link="b"/></joint></robot>', "joint j.*names no link"),
    ],
)  # fmt: skip
def test_what_is_not_a_description(robot, tmp_path, content, message):
    path = tmp_path / "r.urdf"
    path.write_text(content)
    with pytest.raises(InputError, match=message):
        read_meshes(path, robot)


def test_a_file_that_is_not_there(robot, tmp_path):
    with pytest.raises(InputError, match="no such file"):
        read_meshes(tmp_path / "no.urdf", robot)


def test_shapes_without_a_file(robot, tmp_path):
    path, _ = write_urdf(robot, tmp_path)
    written = path.read_text()
    path.write_text(
        written.replace(
            '<mesh filename="meshes/box.stl" scale="0.001 0.001 0.001"/>', '<cylinder radius="0.05" length="0.3"/>'
        )
    )
    (mesh,) = read_meshes(path, robot)[0]
    assert np.ptp(mesh.vertices, axis=0) == pytest.approx([0.1, 0.1, 0.3], abs=1e-3)
