"""Does a motion keep clear of what stands around as a plan says: the check's own solids, distances and proof.

Which solids there are, and which are held apart, is the model's to say (`zerorev.model.arm_bodies`); where they are,
how far apart, and what lies between samples is found here once more.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise

import numpy as np

from zerorev.model._arrays import Array
from zerorev.model.arm_bodies import withdrawn
from zerorev.model.body import Box
from zerorev.model.plan import Clearance
from zerorev.model.robot import Robot
from zerorev.model.settings import Settings
from zerorev.model.tool import Tool
from zerorev.verify import solids as kernels
from zerorev.verify.heaps import corners_of
from zerorev.verify.scene import Mask, Scene, scene_of

__all__ = ["clear_between", "clearance_claimed", "proven"]

SAMPLES = 200  # of a leg, or of a move between two stops, where distances are compared
OVERSTATED = 2e-5  # [m] by which the least distance may be overstated
PROVEN = 5e-5  # [m] by which a body may come nearer than is said and still be called certified


def clearance_claimed(
    robot: Robot,
    tool: Tool,
    settings: Settings,
    claimed: Clearance | None,
    tracks: list[tuple[Array, Array, Array]],
    corner: Array,
    *,
    planned: bool,
) -> Iterator[str]:
    """One sentence for each thing that is said of a hole's clearance and is not so.

    Args:
        robot: the arm.
        tool: the drill.
        settings: with what stands around.
        claimed: what is said.
        tracks: stand-off [m] (N,), spin [rad] (N,) and joints [rad] (N, 6) of the legs, of each blend, and of the way
            to them and away.
        corner: joints [rad] (n, 6) at the ends of the joint moves that the corner is made of; they leave the drill axis
            a little, so that of them it is only asked that nothing touches.
        planned: whether the motion was searched for, so that it has to keep what is asked.
    """
    scene = scene_of(robot, tool, settings)
    if scene is None or not scene.pairs:
        return
    if claimed is None:
        if planned and settings.surroundings.obstacles:
            yield "nothing is said of how near it comes to what stands around"
        return
    wanted = scene.at_hole & scene.outside
    for _, _, joints in tracks:
        chosen = np.unique(np.linspace(0, len(joints) - 1, SAMPLES).astype(int))
        yield from _nearer(scene, joints[chosen], wanted, claimed)
    if planned and claimed.least < settings.clearance - OVERSTATED:
        yield f"it comes within {_mm(claimed.least)} of what stands around, {_mm(settings.clearance)} are asked for"
    if claimed.certified:
        for standoff, psi, joints in tracks:
            if (why := _unproven(scene, scene.at_hole, claimed.least, joints, standoff, psi)) is not None:
                yield f"it is not proven to keep clear: {why}"
                return
    for one, other in pairwise(corner):
        if (why := _unproven(scene, scene.at_hole, 0.0, np.stack([one, other]))) is not None:
            yield f"the joint moves of its corner are not proven to touch nothing: {why}"
            return


def clear_between(
    robot: Robot, tool: Tool, settings: Settings, claimed: Clearance | None, joints: Array
) -> Iterator[str]:
    """The same of a move of all axes between holes.

    Args:
        robot: the arm.
        tool: the drill.
        settings: with what stands around.
        claimed: what is said.
        joints: where it begins, stops and ends [rad], shape (n, 6).
    """
    scene = scene_of(robot, withdrawn(robot, tool), settings)
    if scene is None or not scene.pairs or claimed is None:
        return
    everything = np.ones(len(scene.pairs), dtype=np.bool_)
    share = np.linspace(0.0, 1.0, SAMPLES)[:, None]
    for one, other in pairwise(joints):
        yield from _nearer(scene, one + share * (other - one), scene.outside, claimed)
    if claimed.certified:
        for one, other in pairwise(joints):
            if (why := _unproven(scene, everything, claimed.least, np.stack([one, other]))) is not None:
                yield f"is not proven to keep clear: {why}"
                return


def proven(robot: Robot, tool: Tool, settings: Settings, claimed: Clearance, joints: Array) -> bool:
    """Whether a move between holes is proven to keep clear as it is said to.

    Args:
        robot: the arm.
        tool: the drill.
        settings: with what stands around.
        claimed: what is said.
        joints: where it begins, stops and ends [rad], shape (n, 6).
    """
    return not any(clear_between(robot, tool, settings, claimed, joints))


def _nearer(scene: Scene, joints: Array, wanted: Mask, claimed: Clearance) -> Iterator[str]:
    """That a sample comes nearer than is said."""
    joints = np.ascontiguousarray(joints)
    found, _, k = kernels.least_of_samples(scene.solids, scene.heap, joints, wanted, claimed.least - OVERSTATED)
    if k < 0 and _inside(scene, joints[0], wanted):
        found, k = 0.0, int(np.flatnonzero(wanted)[0])
    if k >= 0:
        body, other = scene.names(int(k))
        yield f"{body} comes within {_mm(max(found, 0.0))} of {other}, the plan says {_mm(claimed.least)}"


def _inside(scene: Scene, joints: Array, wanted: Mask) -> bool:
    """Whether a body lies wholly within a box, whose surface it does not touch: asked where a motion begins."""
    solids = scene.solids
    frames = np.empty((7, 12))
    kernels._frames(solids.chain, solids.sign * joints - solids.offset, frames)
    for k, pair in enumerate(scene.pairs):
        if not wanted[k] or pair.obstacle is None:
            continue
        obstacle = scene.obstacles[pair.obstacle]
        if not isinstance(obstacle.shape, Box):
            continue
        L, own = frames[solids.link[pair.body]], solids.frames[pair.body]
        point = L[:9].reshape(3, 3) @ (
            own[:9].reshape(3, 3) @ corners_of(scene.bodies[pair.body].shape)[0, 0] + own[9:]
        )
        at = obstacle.T_base[:3, :3].T @ (point + L[9:] - obstacle.T_base[:3, 3])
        if (np.abs(at) < obstacle.shape.size / 2).all():
            return True
    return False


def _unproven(
    scene: Scene, wanted: Mask, least: float, joints: Array, standoff: Array | None = None, psi: Array | None = None
) -> str | None:
    """Which pair is not proven to keep its distance; None where all are."""
    most = max(least - PROVEN, 0.0)
    apart = np.array([most if pair.obstacle is not None else 0.0 for pair in scene.pairs])
    if np.isnan(joints).any():
        return "it leaves the reach of the arm"
    # between two samples a joint lies off the line by an eighth of how the steps differ, to second order
    bend = np.abs(np.diff(joints, n=2, axis=0)).max(axis=0) / 8 if len(joints) > 2 else np.zeros(6)
    nothing = np.empty(0)
    k, _ = kernels.held(
        scene.solids, scene.heap, np.ascontiguousarray(joints), nothing if standoff is None else standoff,
        nothing if psi is None else psi, bend, wanted, apart,
    )  # fmt: skip
    return None if k < 0 else " from ".join(scene.names(int(k)))


def _mm(length: float) -> str:
    return f"{length * 1e3 + 0.0:.6g} mm"
