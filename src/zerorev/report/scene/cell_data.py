"""What the player of the cell is given, in the page and in the replay file: plain data in mm and degrees."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict
from typing import Any

import numpy as np

from zerorev.files.units import deg, mm
from zerorev.model._arrays import Array
from zerorev.model.hole import Hole
from zerorev.model.job import Settings
from zerorev.model.plan import HolePlan
from zerorev.model.profile import Profile
from zerorev.model.robot import Robot
from zerorev.model.tool import Tool
from zerorev.motion.drilling import Drilling
from zerorev.motion.joint_path import joint_path
from zerorev.motion.kinematics import tcp_pose
from zerorev.motion.links import chain
from zerorev.report.scene.arm_shapes import Solid, arm_solids, rings, tool_solids
from zerorev.report.scene.clearance_data import nearest_data
from zerorev.report.scene.motion_look import Mark, held, look, signed_distance
from zerorev.report.scene.packing import in_mm, packed, pose_in_mm
from zerorev.report.scene.palette import BASELINE_COLOUR, CANNOT_RUN, JOINT_COLOURS, REVERSAL_COLOURS
from zerorev.report.scene.skeleton import home
from zerorev.report.scene.urdf_meshes import Mesh
from zerorev.report.words.as_shown import shown_note

__all__ = ["arm_data", "holes_data", "motion_data", "reversals_data", "slice_data", "track_data"]

SAMPLES = 120  # of a motion, about
UNPLANNED, INFEASIBLE = -1, -2  # what a hole's count of reversals is where it has none
MOST_PLATES = 24  # faces of a part that are drawn as plates; the holes of others lie on small discs
MARGIN = 0.06  # [m] of a plate around its outermost holes
SAME_FACE = 1e-3  # [m] distance up to which holes are taken to begin on the same face
RIBBON = (0.03, 0.07)  # [m] least and greatest width of the ribbon that shows the spin


def arm_data(robot: Robot, tool: Tool, meshes: Sequence[Sequence[Mesh]] | None = None) -> dict[str, Any]:
    """The robot and its tool: the chain of joints, the solids of each link, colours, and joints to stand at.

    Args:
        robot: the arm.
        tool: on its flange.
        meshes: of the foot and the six links, to be shown in place of the solids (`report.urdf_meshes`).
    """
    links = [[_solid(solid) for solid in link] for link in arm_solids(robot)]
    if meshes is not None:
        links = [[_mesh(mesh) for mesh in link] for link in meshes]
    return {
        "robot": f"{robot.manufacturer} {robot.model}".strip() or robot.name,
        "tool": tool.name,
        "names": robot.joint_names,
        "chain": [{**joint._asdict(), "place": in_mm(joint.place)} for joint in chain(robot)],
        "links": links,
        "tool_solids": [_solid(solid) for solid in tool_solids(robot, tool)],
        "rings": [{"place": in_mm(place), "radius": in_mm(radius)} for place, radius in rings(robot)],
        "tip": in_mm(tool.T_flange_tcp[:3, 3]),
        "home_deg": deg(home(robot)).tolist(),
        "j3_less_j2": robot.display.j3_less_j2,
        "shown_note": shown_note(robot),
        "reach_mm": float(mm(robot.reach)),
        "colours": {
            "joints": JOINT_COLOURS, "reversals": REVERSAL_COLOURS, "cannot": CANNOT_RUN, "baseline": BASELINE_COLOUR,
        },
    }  # fmt: skip


def holes_data(
    holes: Sequence[Hole], T_base_part: Array, answers: Mapping[str, HolePlan], *, shaped: bool = False
) -> dict[str, Any]:
    """The part frame, the faces that the holes begin on, and the holes with what is known of each.

    Args:
        holes: of a job.
        T_base_part: part frame, shape (4, 4).
        answers: by the hole's id.
        shaped: whether the shape of the part is known and shown; then no plates stand for it.
    """
    target, direction = (np.array([getattr(hole, name) for hole in holes]) for name in ("target", "direction"))
    depth = np.array([hole.depth for hole in holes])
    return {
        "part": pose_in_mm(T_base_part),
        "ids": [hole.id for hole in holes],
        "target_mm": packed(mm(target)),
        "direction": packed(direction),
        "depth_mm": packed(mm(depth)),
        "reversals": reversals_data(holes, answers),
        "plates": [] if shaped else _plates(target, direction, depth, T_base_part),
        "shaped": shaped,
    }


def reversals_data(holes: Sequence[Hole], answers: Mapping[str, HolePlan]) -> list[int]:
    """What is known of each hole: the reversals of its motion, or why there is no such count (below 0).

    Args:
        holes: of a job.
        answers: by the hole's id.
    """
    return [_known(answers.get(hole.id)) for hole in holes]


def motion_data(
    drilling: Drilling, profile: Profile, branch: int, settings: Settings, samples: int = SAMPLES
) -> dict[str, Any]:
    """A motion and, beside it, its baseline: the same path at the constant spin of its start.

    Args:
        drilling: robot, tool and hole.
        profile: the spin along the path.
        branch: 0..7.
        settings: turns of the joints, feeds.
        samples: how many points, about.
    """
    planned = track_data(drilling, profile, branch, settings, samples, near=True)
    baseline = track_data(drilling, held(profile), branch, settings, samples)
    return {"hole": drilling.hole.id, "planned": planned, "held": baseline}


def track_data(
    drilling: Drilling,
    profile: Profile,
    branch: int,
    settings: Settings,
    samples: int = SAMPLES,
    *,
    near: bool = False,
) -> dict[str, Any] | None:
    """One motion to be played, drawn as far as it can be; None where the branch reaches no point of it.

    Args:
        drilling: robot, tool and hole.
        profile: the spin along the path.
        branch: 0..7.
        settings: turns of the joints, feeds.
        samples: how many points, about; reversals are always among them.
        near: whether it is shown, too, what of the arm is nearest to what stands around.
    """
    looked = look(drilling, profile, branch, settings)
    corner = profile.distance[profile.corner]
    path = joint_path(
        drilling, profile, branch, near=settings.near_joints, samples=samples,
        through=sorted({float(corner + mark.distance) for mark in looked.marks if mark.leg != "target"}),
    )  # fmt: skip
    reached = ~np.isnan(path.joints[:, 0])
    if not reached.any():
        return None
    x = signed_distance(profile, path.distance)
    seconds = np.minimum(path.distance, corner) / settings.feed_plunge + np.maximum(x, 0.0) / settings.feed_retract
    settings = settings.of(drilling.hole)
    # where the tool spins on, it creeps in meanwhile
    spins = np.clip(1 + x / settings.creep, 0.0, 1.0) if settings.creep else x > 0
    seconds = seconds + settings.cycle.dwell * spins
    known = np.flatnonzero(reached)
    nearest = known[np.abs(np.arange(reached.size)[:, None] - known).argmin(axis=1)]
    return {
        "x_mm": packed(mm(x)),
        "seconds": packed(seconds),
        "standoff_mm": packed(mm(path.standoff)),
        "psi_deg": packed(deg(path.psi)),
        "joints_deg": packed(deg(path.joints[nearest])),
        "ribbon_mm": packed(mm(_ribbon(drilling, path.standoff, path.psi))),
        "reversals": looked.reversals,
        "marks": [_mark(mark) for mark in looked.marks],
        "faults_mm": [[float(mm(fault.start)), float(mm(fault.end))] for fault in looked.faults],
        "runs": looked.runs,
        "why": looked.why,
        "nearest": nearest_data(drilling, settings, branch, path.standoff, path.psi) if near else None,
    }


def slice_data(
    position: Array, edges: Array, colours: Sequence[str], words: Sequence[str], title: str = ""
) -> dict[str, Any]:
    """Cells of a map, to be shown among the holes; a click on one tells its number.

    Args:
        position: middle of each cell [m], base frame, shape (N, 3).
        edges: the two edges of a cell [m], shape (2, 3).
        colours: of each cell, as #rrggbb.
        words: of each cell: what it holds.
        title: what the cells are of.
    """
    rgb = np.array([[int(colour[n : n + 2], 16) for n in (1, 3, 5)] for colour in colours], dtype=np.uint8)
    return {
        "position_mm": packed(mm(position)), "edges_mm": mm(edges).tolist(), "rgb": packed(rgb, "u1"),
        "words": list(words), "title": title,
    }  # fmt: skip


def _solid(solid: Solid) -> dict[str, Any]:
    return {key: value if isinstance(value, str) else in_mm(value) for key, value in asdict(solid).items()}


def _mesh(mesh: Mesh) -> dict[str, Any]:
    return {
        "kind": "mesh", "vertices_mm": packed(mm(mesh.vertices)), "faces": packed(mesh.faces, "<u4"),
        "paint": mesh.colour,
    }  # fmt: skip


def _known(answer: HolePlan | None) -> int:
    if answer is None:
        return UNPLANNED
    return INFEASIBLE if answer.score is None else answer.score.reversals


def _mark(mark: Mark) -> dict[str, Any]:
    return {"joint": mark.joint, "name": mark.name, "x_mm": float(mm(mark.distance)), "leg": mark.leg}


def _ribbon(drilling: Drilling, standoff: Array, psi: Array) -> Array:
    """The tip, and a point beside it towards the wrist centre, whose circle is the lever of the spin [m], (N, 6)."""
    wrist, lever = np.array(drilling.plane.wrist[:2]), drilling.wrist_offset
    way = wrist / lever if lever > 1e-6 else np.array([0.0, 1.0])
    T = tcp_pose(drilling.hole, standoff, psi)
    beside = T[:, :3, :2] @ way
    return np.hstack([T[:, :3, 3], T[:, :3, 3] + float(np.clip(lever / 2, *RIBBON)) * beside])


def _plates(target: Array, direction: Array, depth: Array, T_base_part: Array) -> list[dict[str, Any]]:
    """The faces that holes begin on, as plates as thick as the deepest hole; none where there are too many."""
    face = np.einsum("ij,ij->i", target, direction) - depth
    keys = np.column_stack([np.round(direction, 4), np.round(face / SAME_FACE)])
    kinds, of = np.unique(keys, axis=0, return_inverse=True)
    if len(kinds) > MOST_PLATES:
        return []
    plates = []
    for n in range(len(kinds)):
        mine = of.ravel() == n
        d = direction[mine][0]
        side = T_base_part[:3, np.abs(d @ T_base_part[:3, :3]).argmin()]
        side = side - side @ d * d
        u = side / np.linalg.norm(side)
        R = np.stack([u, np.cross(d, u), d])
        local = target[mine] @ R.T
        low, high = local.min(axis=0) - MARGIN, local.max(axis=0) + MARGIN
        low[2], high[2] = face[mine].min(), local[:, 2].max() + 0.004
        pose = np.eye(4)
        pose[:3, :3], pose[:3, 3] = R.T, (low + high) / 2 @ R
        plates.append({"pose": pose_in_mm(pose), "size_mm": in_mm(high - low)})
    return plates
