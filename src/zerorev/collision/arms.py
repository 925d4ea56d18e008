"""The bodies of an arm with a tool and what stands around it, made ready for the kernels, once."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from functools import cached_property, lru_cache

import numpy as np
import numpy.typing as npt

from zerorev.kernels import solids
from zerorev.kernels.bodies import SPANNED, Arms, Desk, apart_at, desk
from zerorev.kernels.solids import Solids
from zerorev.model._arrays import Array
from zerorev.model.arm_bodies import Pair, bodies_of, pairs_of
from zerorev.model.body import Body, Box, Capsule, Mesh, Obstacle, Shape
from zerorev.model.fingerprint import fingerprint
from zerorev.model.robot import Robot
from zerorev.model.settings import Settings
from zerorev.model.tool import Tool
from zerorev.motion.kinematics import wrist_in_tcp

__all__ = ["Setting", "setting_of", "standing_hits"]

KEPT = 4  # settings that stay ready
EDGES = np.array([[x, y, z] for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-0.5, 0.5)])


@dataclass(frozen=True)
class Setting:
    """An arm with its tool and its surroundings.

    Attributes:
        bodies: that move, or are the base.
        obstacles: that stand still.
        arms: both of them for the kernels, bodies first.
        against: of each pair whether it is of a body and an obstacle, shape (K,); else it is of two bodies.
        exempt: of each pair whether it is of the part and a body that touches it where a hole is drilled, shape (K,).
        lever_w: distance of the wrist centre from the drill axis [m].
    """

    bodies: tuple[Body, ...]
    obstacles: tuple[Obstacle, ...]
    arms: Arms
    against: npt.NDArray[np.bool_]
    exempt: npt.NDArray[np.bool_]
    lever_w: float

    def names(self, pair: int) -> tuple[str, str]:
        """What a pair is called: the body, and what it is held apart from."""
        everything = (*self.bodies, *self.obstacles)
        one, other = self.arms.pairs[pair]
        return everything[one].id, everything[other].id

    @cached_property
    def all_pairs(self) -> npt.NDArray[np.bool_]:
        """Every pair, as on moves between holes, shape (K,)."""
        return np.ones(len(self.arms.pairs), dtype=np.bool_)

    @cached_property
    def drilled(self) -> npt.NDArray[np.bool_]:
        """The pairs that count where a hole is drilled, shape (K,)."""
        return ~self.exempt

    def desk(self) -> Desk:
        """Where the kernels work."""
        return desk(self.arms, solids.room())


def setting_of(robot: Robot, tool: Tool, settings: Settings) -> Setting | None:
    """The bodies and the surroundings of a job; None where neither is stated, so that nothing can be touched.

    Args:
        robot: the arm.
        tool: on its flange.
        settings: with the surroundings, and with the clearance that is asked for.
    """
    if not (settings.surroundings.obstacles or robot.bodies or any(not body.guessed for body in tool.bodies)):
        return None
    key = fingerprint(robot.arm, robot.bodies, tool.T_flange_tcp, tool.bodies, settings.surroundings)
    return _made(_Asked(key, settings.clearance, robot, tool, settings))


def standing_hits(robot: Robot, tool: Tool, settings: Settings) -> Iterator[tuple[str, str]]:
    """Bodies of the base and what stands in them, by their names; the floor aside.

    Args:
        robot: the arm.
        tool: on its flange.
        settings: with what stands around.
    """
    setting = setting_of(robot, tool, settings)
    if setting is None:
        return
    own = setting.desk()
    own.links[:] = np.append(np.eye(3).ravel(), np.zeros(3))
    for b, body in enumerate(setting.bodies):
        for o, obstacle in enumerate(setting.obstacles):
            if body.link > 0 or obstacle.kind == "floor":
                continue
            own.known[:] = False
            pair = setting.arms._replace(pairs=np.array([[b, len(setting.bodies) + o]]))
            if apart_at(pair, 0, np.inf, own) <= 0:
                yield body.id, obstacle.id


@dataclass(frozen=True)
class _Asked:
    """What a setting is made of; it is compared by its fingerprint and the clearance."""

    key: str
    clearance: float
    robot: Robot = field(compare=False)
    tool: Tool = field(compare=False)
    settings: Settings = field(compare=False)


@lru_cache(maxsize=KEPT)
def _made(asked: _Asked) -> Setting:
    robot, tool = asked.robot, asked.tool
    bodies, obstacles = bodies_of(robot, tool), asked.settings.surroundings.obstacles
    pairs = pairs_of(robot, tool, asked.settings)
    shapes = [*(body.shape for body in bodies), *(obstacle.shape for obstacle in obstacles)]
    own = [_own_frame(shape) for shape in shapes]
    places = [body.T_link for body in bodies] + [obstacle.T_base for obstacle in obstacles]
    T = np.array([place @ frame for place, (frame, _) in zip(places, own, strict=True)])
    frames = np.concatenate([T[:, :3, :3].reshape(-1, 9), T[:, :3, 3]], axis=1)
    spans = [_spanned(body.T_link @ frame, shape) for body, (frame, shape) in zip(bodies, own, strict=False)]
    spans += [np.zeros((SPANNED, 3))] * len(obstacles)
    link = np.array([body.link for body in bodies] + [0] * len(obstacles))
    reach, around = _reach(robot, link, np.array(spans))
    flange_in_tcp = np.linalg.inv(tool.T_flange_tcp)
    in_tcp = np.array(spans) @ flange_in_tcp[:3, :3].T + flange_in_tcp[:3, 3]
    arms = Arms(
        solids=_solids([shape for _, shape in own]),
        link=link,
        frames=np.ascontiguousarray(frames),
        pairs=np.array([_numbers(pair, len(bodies)) for pair in pairs], dtype=np.int64).reshape(-1, 2),
        least=np.array([pair.least for pair in pairs]),
        balls=np.array([_ball(shape) for _, shape in own]),
        spanned=np.array([2 if isinstance(shape, Capsule) else SPANNED for shape in shapes]),
        reach=reach,
        around=around,
        lever=np.hypot(in_tcp[..., 0], in_tcp[..., 1]).max(axis=1),
    )
    wrist = wrist_in_tcp(robot, tool)
    return Setting(
        bodies=bodies,
        obstacles=obstacles,
        arms=arms,
        against=np.array([pair.obstacle is not None for pair in pairs], dtype=np.bool_),
        exempt=np.array([pair.exempt for pair in pairs], dtype=np.bool_),
        lever_w=float(np.hypot(wrist[0], wrist[1])),
    )


def _numbers(pair: Pair, bodies: int) -> tuple[int, int]:
    """The two solids of a pair, where obstacles follow the bodies."""
    if pair.obstacle is not None:
        return pair.body, bodies + pair.obstacle
    assert pair.other is not None
    return pair.body, pair.other


def _own_frame(shape: Shape) -> tuple[Array, Shape]:
    """A frame along whose axes a shape lies, shape (4, 4), and the shape in it: trees of boxes are tight there."""
    T = np.eye(4)
    if not isinstance(shape, Capsule):
        return T, shape
    along = shape.ends[1] - shape.ends[0]
    length = float(np.linalg.norm(along))
    if length > 0:
        z = along / length
        x = np.cross(np.eye(3)[np.argmin(np.abs(z))], z)
        x /= np.linalg.norm(x)
        T[:3, :3] = np.column_stack([x, np.cross(z, x), z])
    T[:3, 3] = shape.ends.mean(axis=0)
    ends = np.array([[0.0, 0.0, -length / 2], [0.0, 0.0, length / 2]])
    return T, replace(shape, ends=ends)


def _ball(shape: Shape) -> Array:
    """A ball about a shape in its own frame: centre and radius [m], shape (4,)."""
    if isinstance(shape, Mesh):
        middle = (shape.vertices.min(axis=0) + shape.vertices.max(axis=0)) / 2
        return np.append(middle, np.linalg.norm(shape.vertices - middle, axis=1).max())
    half = shape.size / 2 if isinstance(shape, Box) else shape.ends[1] - shape.ends.mean(axis=0)
    middle = np.zeros(3) if isinstance(shape, Box) else shape.ends.mean(axis=0)
    return np.append(middle, np.linalg.norm(half) + (0.0 if isinstance(shape, Box) else shape.radius))


def _spanned(T: Array, shape: Shape) -> Array:
    """Points whose hull a shape lies in, but for its radius, in the link frame [m], shape (SPANNED, 3)."""
    if isinstance(shape, Capsule):
        points = np.tile(shape.ends, (SPANNED // 2, 1))
    elif isinstance(shape, Box):
        points = EDGES * shape.size
    else:
        low, high = shape.vertices.min(axis=0), shape.vertices.max(axis=0)
        points = (low + high) / 2 + EDGES * (high - low)
    return np.asarray(points @ T[:3, :3].T + T[:3, 3])


def _reach(robot: Robot, link: npt.NDArray[np.int64], points: Array) -> tuple[Array, Array]:
    """Greatest distances of points of links from the axes before them, and from the wrist centre [m].

    From a link inwards each link adds its length at most, however the joints between stand.

    Args:
        robot: the arm.
        link: of each body, 0 to 6, shape (S,).
        points: in the link frame [m], shape (S, SPANNED, 3).

    Returns:
        shapes (S, SPANNED, 6) and (S, SPANNED); 0 and inf where a link has no such axis, or no wrist centre.
    """
    arm = robot.arm
    # the place of each joint in the frame of the joint before it, as `motion.links.chain` has it
    steps = [0.0, float(np.linalg.norm([arm.a1, arm.b, arm.c1])), abs(arm.c2), float(np.hypot(arm.a2, arm.c3)), 0.0,
             abs(arm.c4)]  # fmt: skip
    axis = (2, 1, 1, 2, 1, 2)
    wrist = {3: np.array([arm.a2, 0.0, arm.c3]), 4: np.zeros(3), 5: np.zeros(3), 6: np.array([0.0, 0.0, -arm.c4])}
    reach, around = np.zeros((*points.shape[:2], 6)), np.full(points.shape[:2], np.inf)
    for s, own in enumerate(link.tolist()):
        if own == 0:
            continue
        across = np.delete(points[s], axis[own - 1], axis=1)
        reach[s, :, own - 1] = np.linalg.norm(across, axis=1)
        away = np.linalg.norm(points[s], axis=1)
        for i in range(own - 1, 0, -1):
            away = away + steps[i]
            reach[s, :, i - 1] = away
        # axis 1 stands upright through the origin: heights do not count
        if own > 1:
            reach[s, :, 0] -= steps[1] - float(np.hypot(arm.a1, arm.b))
        if own in wrist:
            around[s] = np.linalg.norm(points[s] - wrist[own], axis=1)
    return reach, around


def _solids(shapes: list[Shape]) -> Solids:
    """Trees of all of them."""
    trees = [_tree(shape) for shape in shapes]
    boxes, links, first, radius, points, root, thick = [], [], [np.zeros(1, dtype=np.int64)], [], [], [], []
    nodes = pieces = spread = 0
    for tree in trees:
        own = tree.links.copy()
        own[:, 0] += np.where(own[:, 1] > 0, pieces, nodes)
        root.append(nodes)
        boxes.append(tree.boxes)
        links.append(own)
        first.append(tree.first[1:] + spread)
        radius.append(tree.radius)
        points.append(tree.points)
        thick.append(tree.thick)
        nodes, pieces, spread = nodes + len(own), pieces + len(tree.radius), spread + len(tree.points)
    return Solids(
        np.concatenate(boxes), np.concatenate(links), np.array(root, dtype=np.int64), np.concatenate(first),
        np.concatenate(radius), np.concatenate(points), np.concatenate(thick),
    )  # fmt: skip


@lru_cache(maxsize=16)
def _tree(shape: Shape) -> Solids:
    """The tree of one shape; shapes are compared by their fingerprints."""
    if isinstance(shape, Mesh):
        corners, thick = shape.vertices[shape.faces], 0.0
    elif isinstance(shape, Box):
        corners, thick = (EDGES * shape.size)[None], 0.0
    else:
        corners, thick = shape.ends[None], shape.radius
    count, spanned, _ = corners.shape
    lows, highs = corners.min(axis=1), corners.max(axis=1)
    order = np.arange(count)
    boxes, links = np.empty((2 * count, 6)), np.empty((2 * count, 2), dtype=np.int64)
    used = solids.build((lows + highs) / 2, lows, highs, order, boxes, links)
    return Solids(
        boxes[:used].copy(), links[:used].copy(), np.zeros(1, dtype=np.int64), spanned * np.arange(count + 1),
        np.full(count, thick), np.ascontiguousarray(corners[order].reshape(-1, 3)), np.array([thick]),
    )  # fmt: skip
