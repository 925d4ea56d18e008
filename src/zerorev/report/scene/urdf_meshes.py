"""The maker's meshes of a robot, from its description (URDF), in the link frames of the model that is planned with.

A description may count its joints otherwise than the controller does. Signs and offsets are found by comparing the two
arms, and what does not agree within 1 mm is refused: better no picture than one that moves otherwise than the plan.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from zerorev.errors import InputError
from zerorev.files.meshes import loaded
from zerorev.files.urdf import Description, Joint, Visual, read_urdf
from zerorev.model._arrays import Array
from zerorev.model.robot import Robot
from zerorev.motion.links import chain, link_frames

__all__ = ["Mesh", "read_meshes"]

AGREE = 1e-3  # [m] between the axes of the two arms, and their flanges
PARALLEL = 1e-3  # [1] between the directions of their axes
MOST_TRIANGLES = 400_000
MOST_MESH = 24 * 2**20  # [bytes] of the file of one
SAMPLES = 12  # joint positions at which the two arms are compared
QUARTERS = (0.0, np.pi / 2, -np.pi / 2, np.pi)  # offsets of a joint that are looked for, the nearest first


@dataclass(frozen=True)
class Mesh:
    """Triangles in a link frame (`zerorev.motion.links`).

    Attributes:
        vertices: [m], shape (N, 3).
        faces: numbers of vertices, shape (M, 3).
        colour: as #rrggbb.
    """

    vertices: Array
    faces: npt.NDArray[np.uint32]
    colour: str


def read_meshes(path: str | Path, robot: Robot) -> tuple[tuple[Mesh, ...], ...]:
    """Meshes of the foot and of the six links, as `arm_shapes.arm_solids` has its solids.

    Args:
        path: the description (URDF); its meshes lie in its own folder or in its package's, as STL, OBJ, PLY or GLB.
        robot: that it must describe.

    Raises:
        InputError: as `read_urdf`; or it moves otherwise than the robot, or a mesh cannot be read.
    """
    description = read_urdf(path)
    sign, offset = _agreed(description, robot)
    joints = np.zeros((1, 6))
    placed = _placed(description, sign * joints + offset)
    ours = np.concatenate([np.eye(4)[None], link_frames(robot, joints)[0]])
    links: list[list[Mesh]] = [[] for _ in range(7)]
    for name, (T, number) in placed.items():
        for visual in description.visuals.get(name, ()):
            links[number].append(_mesh(visual, np.linalg.inv(ours[number]) @ T[0] @ visual.pose))
    triangles = sum(len(mesh.faces) for link in links for mesh in link)
    if not 0 < triangles <= MOST_TRIANGLES:
        raise InputError(
            f"{triangles:,} triangles to show", where=str(path), accepted=f"1 to {MOST_TRIANGLES:,}: simpler meshes"
        )
    return tuple(map(tuple, links))


def _agreed(description: Description, robot: Robot) -> tuple[Array, Array]:
    """Signs and offsets, each (6,), with which the description is the robot: its joint = sign * ours + offset [rad].

    Of several that agree (a wrist turned half round, and bent the other way) the one of the least offsets is taken. The
    offset of the sixth shows nowhere but in the picture of the flange, and is 0.
    """
    joints = np.random.default_rng(0).uniform(-1.5, 1.5, (SAMPLES, 6))
    lines = _lines(robot, joints)
    reached, found = 0, list[tuple[Array, Array]]()

    def sample(i: int, sign: Array, offset: Array) -> None:
        """Compare axis i, where the axes before it agree; the offset of the joint before shows in where it lies."""
        nonlocal reached
        reached = max(reached, i)
        if i == 6:
            found.append((sign, offset))
            return
        for quarter in QUARTERS if i else (0.0,):
            tried = offset.copy()
            tried[i - 1] = quarter
            place, axis = _axes(description, sign * joints + tried)[i]
            ours, way = lines[i]
            along = np.einsum("ij,ij->i", axis, way)
            apart = np.linalg.norm(np.cross(place - ours, way), axis=1)
            if (np.abs(along) > 1 - PARALLEL).all() and (along * along[0] > 0).all() and apart.max() < AGREE:
                sample(i + 1, np.where(np.arange(6) == i, np.sign(along[0]), sign), tried)

    sample(0, np.ones(6), np.zeros(6))
    if not found:
        raise InputError(
            f"its axis {reached + 1} lies elsewhere than that of {robot.name}", where=str(description.file),
            accepted="the description of this very robot, its base link where the robot's base is",
        )  # fmt: skip
    sign, offset = min(found, key=lambda each: float(np.abs(each[1]).sum()))
    _check_flange(description, robot, joints, sign * joints + offset)
    return sign, offset


def _check_flange(description: Description, robot: Robot, ours: Array, theirs: Array) -> None:
    """Where the description has frames beyond the last axis, one of them must be the flange."""
    beyond = [T[:, :3, 3] for T, number in _placed(description, theirs).values() if number == 6]
    flange = link_frames(robot, ours)[:, 5, :3, 3]
    least = min(np.linalg.norm(places - flange, axis=1).max() for places in beyond)
    if len(beyond) > 1 and least > AGREE:
        raise InputError(
            f"its flange lies {least * 1e3:.1f} mm beside that of {robot.name}", where=str(description.file),
            accepted="the description of this very robot",
        )  # fmt: skip


def _lines(robot: Robot, joints: Array) -> list[tuple[Array, Array]]:
    """A point of each axis [m] and its direction as the controller counts, each (N, 3), of the model."""
    frames = link_frames(robot, joints)
    return [
        (frames[:, i, :3, 3], joint.sign * frames[:, i, :3, joint.axis]) for i, joint in enumerate(chain(robot))
    ]  # fmt: skip


def _axes(description: Description, joints: Array) -> list[tuple[Array, Array]]:
    """The same of the description, at its own joints [rad], shape (N, 6)."""
    T, found, number = np.broadcast_to(np.eye(4), (len(joints), 4, 4)), [], 0
    for joint in description.chain:
        T = T @ joint.pose
        if joint.axis is not None:
            found.append((T[:, :3, 3], T[:, :3, :3] @ joint.axis))
            T = T @ _turns(joint.axis, joints[:, number])
            number += 1
    return found


def _placed(description: Description, joints: Array) -> dict[str, tuple[Array, int]]:
    """Of each link: T_base_link, shape (N, 4, 4), and which of our links it is part of (0, the foot, to 6)."""
    still = np.broadcast_to(np.eye(4), (len(joints), 4, 4))
    placed: dict[str, tuple[Array, int]] = {description.base: (still, 0)}

    def add(joint: Joint) -> None:
        T, number = placed[joint.parent]
        T = T @ joint.pose
        if joint.axis is not None:
            T, number = T @ _turns(joint.axis, joints[:, number]), number + 1
        placed[joint.child] = T, number

    for joint in description.chain:
        add(joint)
    waiting = list(description.fixed)
    while ready := [joint for joint in waiting if joint.parent in placed]:
        for joint in ready:
            add(joint)
        waiting = [joint for joint in waiting if joint.child not in placed]
    return placed


def _turns(axis: Array, angles: Array) -> Array:
    """Rodrigues' formula, shape (N, 4, 4)."""
    K = np.cross(np.eye(3), axis)
    T = np.broadcast_to(np.eye(4), (len(angles), 4, 4)).copy()
    c, s = np.cos(angles)[:, None, None], np.sin(angles)[:, None, None]
    T[:, :3, :3] += s * K + (1 - c) * (K @ K)
    return T


def _mesh(visual: Visual, T: Array) -> Mesh:
    shape: Any = loaded(visual.file, MOST_MESH) if visual.file else _primitive(visual)
    scale = np.array(visual.size if visual.kind == "mesh" else (1.0, 1.0, 1.0))
    vertices = np.asarray(shape.vertices, dtype=float) * scale @ T[:3, :3].T + T[:3, 3]
    faces = np.asarray(shape.faces, dtype=np.uint32)
    return Mesh(vertices, faces[:, ::-1] if np.prod(scale) < 0 else faces, visual.colour)


def _primitive(visual: Visual) -> Any:
    from trimesh import creation

    size = visual.size
    if visual.kind == "box":
        return creation.box(extents=size)
    if visual.kind == "cylinder":
        return creation.cylinder(radius=size[0], height=size[1])
    return creation.icosphere(radius=size[0])
