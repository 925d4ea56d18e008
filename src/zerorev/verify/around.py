"""Does a motion keep clear of what stands around as a plan says: the check's own solids, distances and proof.

Which solids there are, and which are held apart, is the model's to say (`zerorev.model.arm_bodies`); where they are,
how far apart, and what lies between samples is found here once more.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache
from itertools import pairwise
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from zerorev.model._arrays import Array
from zerorev.model.arm_bodies import Pair, bodies_of, pairs_of, withdrawn
from zerorev.model.body import Body, Box, Capsule, Obstacle, Shape
from zerorev.model.fingerprint import fingerprint
from zerorev.model.plan import Clearance
from zerorev.model.robot import Robot
from zerorev.model.settings import Settings
from zerorev.model.tool import Tool
from zerorev.verify import solids as kernels

__all__ = ["clear_between", "clearance_claimed", "proven"]

Whole = npt.NDArray[np.int64]
Mask = npt.NDArray[np.bool_]

TOGETHER = 32  # pieces in a group, groups in a group of groups
SAMPLES = 200  # of a leg, or of a move between two stops, where distances are compared
OVERSTATED = 2e-5  # [m] by which the least distance may be overstated
PROVEN = 5e-5  # [m] by which a body may come nearer than is said and still be called certified
EDGES = np.array([[x, y, z] for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-0.5, 0.5)])
SIDES = ((0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3))  # corners round a box


class Heap(NamedTuple):
    """The pieces of all solids, with spheres about groups of them; each in the frame of its solid.

    Attributes:
        corners: of the pieces [m], shape (P, 3, 3); a line has its second corner twice.
        sides: 3, or 2 of a line, shape (P,).
        starts: first piece of each group, and behind the last, shape (G + 1,).
        axes: a line that each group lies about [m], shape (G, 6).
        wide: how far from it at most [m], shape (G,).
        spheres: about each group: centre and radius [m], shape (G, 4).
        members: first group of each group of groups, shape (S + 1,).
        balls: about each of these, shape (S, 4).
        groups: first group of each solid, shape (N + 1,).
        supers: first group of groups of each solid, shape (N + 1,).
        thick: of each solid [m], shape (N,).
    """

    corners: Array
    sides: Whole
    starts: Whole
    axes: Array
    wide: Array
    spheres: Array
    members: Whole
    balls: Array
    groups: Whole
    supers: Whole
    thick: Array


class Solids(NamedTuple):
    """How solids move; a NamedTuple, so that kernels take it whole.

    Attributes:
        chain: as `solids._frames` has it.
        sign: model angle = sign * controller angle - offset, shape (6,).
        offset: [rad], shape (6,).
        link: with which each solid moves, shape (N,).
        frames: in that of the link, shape (N, 12).
        pairs: numbers of solids, shape (K, 2).
        arms: greatest distances of the points that span a solid from each axis [m], shape (N, 8, 6).
        from_wrist: their distances from the wrist centre [m], shape (N, 8).
        lever: greatest distance of those on the flange from the drill axis [m], shape (N,).
        offset_w: distance of the wrist centre from it [m].
    """

    chain: Array
    sign: Array
    offset: Array
    link: Whole
    frames: Array
    pairs: Whole
    arms: Array
    from_wrist: Array
    lever: Array
    offset_w: float


@dataclass(frozen=True)
class _Scene:
    """Solids that are held apart."""

    bodies: tuple[Body, ...]
    obstacles: tuple[Obstacle, ...]
    pairs: tuple[Pair, ...]
    solids: Solids
    heap: Heap

    @property
    def at_hole(self) -> Mask:
        """The pairs that are held apart where a hole is drilled, shape (K,)."""
        return np.array([not pair.exempt for pair in self.pairs], dtype=np.bool_)

    @property
    def outside(self) -> Mask:
        """The pairs of a body and what stands around, shape (K,)."""
        return np.array([pair.obstacle is not None for pair in self.pairs], dtype=np.bool_)

    def names(self, k: int) -> tuple[str, str]:
        """The two solids of a pair."""
        pair = self.pairs[k]
        if pair.obstacle is not None:
            return self.bodies[pair.body].id, self.obstacles[pair.obstacle].id
        assert pair.other is not None
        return self.bodies[pair.body].id, self.bodies[pair.other].id


def clearance_claimed(
    robot: Robot,
    tool: Tool,
    settings: Settings,
    claimed: Clearance | None,
    tracks: list[tuple[Array, Array, Array]],
    *,
    planned: bool,
) -> Iterator[str]:
    """One sentence for each thing that is said of a hole's clearance and is not so.

    Args:
        robot: the arm.
        tool: the drill.
        settings: with what stands around.
        claimed: what is said.
        tracks: stand-off [m] (N,), spin [rad] (N,) and joints [rad] (N, 6) of the legs, and of each blend.
        planned: whether the motion was searched for, so that it has to keep what is asked.
    """
    scene = _scene_of(robot, tool, settings)
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
    scene = _scene_of(robot, withdrawn(robot, tool), settings)
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


def _nearer(scene: _Scene, joints: Array, wanted: Mask, claimed: Clearance) -> Iterator[str]:
    """That a sample comes nearer than is said."""
    joints = np.ascontiguousarray(joints)
    found, _, k = kernels.least_of_samples(scene.solids, scene.heap, joints, wanted, claimed.least - OVERSTATED)
    if k < 0 and _inside(scene, joints[0], wanted):
        found, k = 0.0, int(np.flatnonzero(wanted)[0])
    if k >= 0:
        body, other = scene.names(int(k))
        yield f"{body} comes within {_mm(max(found, 0.0))} of {other}, the plan says {_mm(claimed.least)}"


def _inside(scene: _Scene, joints: Array, wanted: Mask) -> bool:
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
        point = L[:9].reshape(3, 3) @ (own[:9].reshape(3, 3) @ _corners(scene.bodies[pair.body].shape)[0, 0] + own[9:])
        at = obstacle.T_base[:3, :3].T @ (point + L[9:] - obstacle.T_base[:3, 3])
        if (np.abs(at) < obstacle.shape.size / 2).all():
            return True
    return False


def _unproven(
    scene: _Scene, wanted: Mask, least: float, joints: Array, standoff: Array | None = None, psi: Array | None = None
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


def _scene_of(robot: Robot, tool: Tool, settings: Settings) -> _Scene | None:
    if not (settings.surroundings.obstacles or robot.bodies or any(not body.guessed for body in tool.bodies)):
        return None
    key = fingerprint(robot.arm, robot.bodies, tool.T_flange_tcp, tool.bodies, settings.surroundings)
    return _made(_Asked(key, settings.clearance, (robot, tool, settings)))


class _Asked:
    """What a scene is made of, compared by a fingerprint."""

    def __init__(self, key: str, clearance: float, made_of: tuple[Robot, Tool, Settings]) -> None:
        self.key, self.made_of = (key, clearance), made_of

    def __hash__(self) -> int:
        return hash(self.key)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, _Asked) and self.key == other.key


@lru_cache(maxsize=4)
def _made(asked: _Asked) -> _Scene:
    robot, tool, settings = asked.made_of
    bodies, obstacles = bodies_of(robot, tool), settings.surroundings.obstacles
    pairs = pairs_of(robot, tool, settings)
    places = np.array([body.T_link for body in bodies] + [obstacle.T_base for obstacle in obstacles])
    link = np.array([body.link for body in bodies] + [0] * len(obstacles))
    shapes = [*(body.shape for body in bodies), *(obstacle.shape for obstacle in obstacles)]
    spans = np.array([_spanned(shape) for shape in shapes])
    spans = np.einsum("nij,npj->npi", places[:, :3, :3], spans) + places[:, None, :3, 3]
    arm, T = robot.arm, tool.T_flange_tcp
    in_tcp = (spans - T[:3, 3]) @ T[:3, :3]
    wrist = T[:3, :3].T @ (np.array([0.0, 0.0, -arm.c4]) - T[:3, 3])
    chain = np.array([
        [0, 0, 0, 2], [arm.a1, arm.b, arm.c1, 1], [0, 0, arm.c2, 1], [arm.a2, 0, arm.c3, 2], [0, 0, 0, 1],
        [0, 0, arm.c4, 2],
    ])  # fmt: skip
    solids = Solids(
        chain=chain,
        sign=np.array(arm.sign),
        offset=np.array(arm.offset),
        link=link,
        frames=np.concatenate([places[:, :3, :3].reshape(-1, 9), places[:, :3, 3]], axis=1),
        pairs=np.array([(p.body, p.other if p.obstacle is None else len(bodies) + p.obstacle) for p in pairs],
                       dtype=np.int64).reshape(-1, 2),
        arms=_arms(chain, link, spans),
        from_wrist=np.array([_from_wrist(robot, n, points) for n, points in zip(link.tolist(), spans, strict=True)]),
        lever=np.hypot(in_tcp[..., 0], in_tcp[..., 1]).max(axis=1),
        offset_w=float(np.hypot(wrist[0], wrist[1])),
    )  # fmt: skip
    return _Scene(bodies, obstacles, pairs, solids, _heap(shapes))


def _spanned(shape: Shape) -> Array:
    """Eight points whose hull holds a shape, but for its radius [m], shape (8, 3)."""
    if isinstance(shape, Capsule):
        return np.repeat(shape.ends, 4, axis=0)
    if isinstance(shape, Box):
        return np.asarray(EDGES * shape.size)
    low, high = shape.vertices.min(axis=0), shape.vertices.max(axis=0)
    return np.asarray((low + high) / 2 + EDGES * (high - low))


def _arms(chain: Array, link: Whole, spans: Array) -> Array:
    """How far points of links can be from the axes before them, for any joints between: lengths added up."""
    found = np.zeros((*spans.shape[:2], 6))
    for n, own in enumerate(link.tolist()):
        away = np.linalg.norm(spans[n], axis=-1)
        for joint in range(own - 1, -1, -1):
            found[n, :, joint] = away
            away = away + np.linalg.norm(chain[joint, :3])
    return found


def _from_wrist(robot: Robot, link: int, points: Array) -> Array:
    arm = robot.arm
    at = {3: [arm.a2, 0.0, arm.c3], 4: [0.0] * 3, 5: [0.0] * 3, 6: [0.0, 0.0, -arm.c4]}
    return np.linalg.norm(points - at[link], axis=-1) if link in at else np.full(len(points), np.inf)


def _corners(shape: Shape) -> Array:
    """The pieces of a shape [m], shape (P, 3, 3)."""
    if isinstance(shape, Capsule):
        return shape.ends[None, [0, 1, 1]]
    if isinstance(shape, Box):
        box = EDGES * shape.size
        return np.array([box[list(each)] for a, b, c, d in SIDES for each in ((a, b, c), (a, c, d))])
    return np.asarray(shape.vertices[shape.faces])


def _heap(shapes: list[Shape]) -> Heap:
    """The pieces of all of them."""
    parts = [_grouped(shape) for shape in shapes]
    counts = [len(part.corners) for part in parts]
    groups = [len(part.wide) for part in parts]
    before, groups_before = np.cumsum([0, *counts]), np.cumsum([0, *groups])
    return Heap(
        corners=np.concatenate([part.corners for part in parts]),
        sides=np.concatenate([part.sides for part in parts]),
        starts=np.concatenate([*(part.starts[:-1] + n for part, n in zip(parts, before[:-1], strict=True)),
                               before[-1:]]),
        axes=np.concatenate([part.axes for part in parts]),
        wide=np.concatenate([part.wide for part in parts]),
        spheres=np.concatenate([part.spheres for part in parts]),
        members=np.concatenate([*(part.members[:-1] + n for part, n in zip(parts, groups_before[:-1], strict=True)),
                                groups_before[-1:]]),
        balls=np.concatenate([part.balls for part in parts]),
        groups=groups_before,
        supers=np.cumsum([0, *(len(part.balls) for part in parts)]),
        thick=np.concatenate([part.thick for part in parts]),
    )  # fmt: skip


@lru_cache(maxsize=16)
def _grouped(shape: Shape) -> Heap:
    """The pieces of one shape; those that lie together are grouped along a curve through space (Morton order)."""
    corners = _corners(shape)
    middles = corners.mean(axis=1)
    low, high = middles.min(axis=0), middles.max(axis=0)
    cells = ((middles - low) / np.maximum((high - low).max(), 1e-12) * 1023).astype(np.int64)
    corners = corners[np.argsort(_spread(cells), kind="stable")]
    starts = np.append(np.arange(0, len(corners), TOGETHER), len(corners))
    spheres = _balls(corners, starts)
    members = np.append(np.arange(0, len(spheres), TOGETHER), len(spheres))
    balls = _balls(corners, np.append(starts[members[:-1]], len(corners)))
    line = isinstance(shape, Capsule)
    return Heap(
        corners=corners,
        sides=np.full(len(corners), 2 if line else 3),
        starts=starts,
        axes=corners[:, :2].reshape(1, 6) if line else np.concatenate([spheres[:, :3], spheres[:, :3]], axis=1),
        wide=np.zeros(1) if line else spheres[:, 3].copy(),
        spheres=spheres,
        members=members,
        balls=balls,
        groups=np.array([0, len(spheres)]),
        supers=np.array([0, len(balls)]),
        thick=np.array([shape.radius if isinstance(shape, Capsule) else 0.0]),
    )


def _spread(cells: Whole) -> Whole:
    """Morton numbers: the bits of three coordinates by turns."""
    found = np.zeros(len(cells), dtype=np.int64)
    for bit in range(10):
        for axis in range(3):
            found |= ((cells[:, axis] >> bit) & 1) << (3 * bit + axis)
    return found


def _balls(corners: Array, starts: Whole) -> Array:
    """Spheres about runs of pieces, shape (G, 4)."""
    low = np.minimum.reduceat(corners.min(axis=1), starts[:-1])
    high = np.maximum.reduceat(corners.max(axis=1), starts[:-1])
    centre = (low + high) / 2
    which = np.repeat(np.arange(len(centre)), np.diff(starts))
    away = np.linalg.norm(corners - centre[which][:, None], axis=2).max(axis=1)
    return np.concatenate([centre, np.maximum.reduceat(away, starts[:-1])[:, None]], axis=1)


def _mm(length: float) -> str:
    return f"{length * 1e3 + 0.0:.6g} mm"
