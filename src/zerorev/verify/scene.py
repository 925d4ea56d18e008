"""The solids of an arm and what stands around it, placed and paired, as the check has them."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from zerorev.model._arrays import Array
from zerorev.model.arm_bodies import Pair, bodies_of, pairs_of
from zerorev.model.body import Body, Box, Capsule, Obstacle, Shape
from zerorev.model.fingerprint import fingerprint
from zerorev.model.robot import Robot
from zerorev.model.settings import Settings
from zerorev.model.tool import Tool
from zerorev.verify.heaps import EDGES, Heap, heap_of

__all__ = ["Mask", "Scene", "Solids", "scene_of"]

Whole = npt.NDArray[np.int64]
Mask = npt.NDArray[np.bool_]


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
class Scene:
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


def scene_of(robot: Robot, tool: Tool, settings: Settings) -> Scene | None:
    """The solids of a job; None where no file states any, so that nothing can be touched.

    Args:
        robot: the arm.
        tool: the drill.
        settings: with what stands around, and the clearance that is asked for.
    """
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
def _made(asked: _Asked) -> Scene:
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
    return Scene(bodies, obstacles, pairs, solids, heap_of(shapes))


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
