"""The arm as solid shapes, made from its own geometry.

The shapes are not those of a maker: they are as thick as an arm of this reach usually is, but each joint's housing lies
on the very axis that the planner computes with, so that what is seen to turn is what turns.

The link frames are those of `zerorev.motion.links`.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal, NamedTuple

import numpy as np

from zerorev.model._arrays import Array
from zerorev.model.robot import Robot
from zerorev.model.tool import Tool
from zerorev.motion.links import ORIGIN, Place

__all__ = ["Solid", "arm_solids", "rings", "tool_solids"]

MOST_SLANT = 0.966  # cosine of the angle to the flange's axis up to which a drill counts as standing across it


@dataclass(frozen=True)
class Solid:
    """A solid shape in a link frame.

    Attributes:
        kind: `rod` (round, from start to end), `plate` (the hull of two discs that stand across y), `beam` (a bar of
            square section, from start to end).
        start: centre of one end [m].
        end: centre of the other end [m].
        radii: at the two ends [m]; of a beam, half of its width.
        thickness: of a plate, along y [m].
        paint: `body`, `joint` (housings), `dark`, `steel`, or `A1` to `A6`: the colour of that joint.
    """

    kind: Literal["rod", "plate", "beam"]
    start: Place
    end: Place
    radii: tuple[float, float]
    paint: str = "body"
    thickness: float = 0.0


def arm_solids(robot: Robot) -> tuple[tuple[Solid, ...], ...]:
    """Solids of the foot and of the six links, each in its own link frame (the foot's in the base frame)."""
    arm = robot.arm
    foot, shoulder, elbow, wrist = _girths(robot)
    return (
        tuple(_foot(arm.c1, foot)),
        tuple(_turret((arm.a1, arm.b, arm.c1), foot, shoulder)),
        tuple(_upper_arm(arm.c2, shoulder, elbow)),
        tuple(_elbow(arm.a2, arm.c3, shoulder, elbow)),
        tuple(_forearm(arm.c3, elbow, wrist)),
        tuple(_wrist(arm.c4, wrist)),
        (
            _z_rod(-0.26 * wrist, -0.13 * wrist, 0.66 * wrist, 0.66 * wrist, "A6"),
            _z_rod(-0.13 * wrist, 0.0, 0.62 * wrist, 0.62 * wrist, "steel"),
        ),
    )


def rings(robot: Robot) -> tuple[tuple[Place, float], ...]:
    """Centre in its own link frame and radius [m] of a ring around the housing of each joint, about its axis."""
    arm = robot.arm
    girths = _girths(robot)
    elbow, wrist = girths.elbow, girths.wrist
    return (
        ((0.0, 0.0, 0.412 * arm.c1), 1.2 * girths.foot),
        (ORIGIN, 1.22 * girths.shoulder),
        (ORIGIN, 1.25 * elbow),
        ((0.0, 0.0, -0.6 * arm.c3 + 0.06 * elbow), 1.0 * elbow),
        (ORIGIN, 1.3 * wrist),
        ((0.0, 0.0, -0.2 * wrist), 0.95 * wrist),
    )


def tool_solids(robot: Robot, tool: Tool) -> tuple[Solid, ...]:
    """Bracket, spindle and drill in the flange frame, the drill along Z_tcp with its tip at the TCP."""
    tip, back = tool.T_flange_tcp[:3, 3], tool.T_flange_tcp[:3, 2]
    across = abs(back[2]) < MOST_SLANT
    # where the spindle is held: the point of the drill axis nearest to the flange
    held = float(-tip @ back)
    bit = max(0.6 * held, 0.02)
    offset = float(np.linalg.norm(tip + held * back))
    girth = float(np.clip(0.36 * (tip + held * back)[2] if across else 0.3 * max(held, offset), 0.012, 0.045))
    behind = max(held, bit) + (1.9 * girth if across else -0.1 * girth)
    body = max(bit + 0.9 * girth, min(held - 1.5 * girth, behind - 2 * girth))
    behind = max(behind, body + girth)

    def along(distance: float) -> Place:
        return _place(tip + distance * back)

    drill = 0.003 + 0.03 * girth
    clamp = max(held - 0.75 * girth, body)
    solids = [
        Solid("rod", ORIGIN, (0.0, 0.0, 0.35 * girth), (1.15 * girth, 1.15 * girth), "dark"),
        Solid("rod", along(0.0), along(2.2 * drill), (0.0002, drill), "steel"),
        Solid("rod", along(2.2 * drill), along(bit), (drill, drill), "steel"),
        Solid("rod", along(bit), along(body), (0.3 * girth, 0.62 * girth), "dark"),
        Solid("rod", along(body), along(behind), (0.95 * girth, 0.95 * girth), "joint"),
        Solid("rod", along(behind), along(behind + 0.2 * girth), (0.8 * girth, 0.6 * girth), "dark"),
        Solid(
            "rod",
            along(clamp),
            along(max(min(held + 0.75 * girth, behind), clamp + 0.5 * girth)),
            (1.12 * girth, 1.12 * girth),
            "body",
        ),
    ]
    if offset > 1e-3:
        solids.append(Solid("beam", ORIGIN, _place(tip + held * back), (0.7 * girth, 0.7 * girth), "body"))
    return tuple(solids)


class _Girths(NamedTuple):
    """Half widths [m]."""

    foot: float
    shoulder: float
    elbow: float
    wrist: float


def _girths(robot: Robot) -> _Girths:
    reach = robot.reach
    return _Girths(0.155 * reach, 0.122 * reach, 0.094 * reach, min(0.062 * reach, 0.62 * robot.arm.c4))


def _foot(c1: float, girth: float) -> Iterator[Solid]:
    top = 0.40 * c1
    yield Solid("beam", (0.0, 0.0, 0.0), (0.0, 0.0, 0.16 * girth), (1.3 * girth, 1.3 * girth), "dark")
    yield _z_rod(0.16 * girth, top, 1.12 * girth, 0.98 * girth)
    yield _z_rod(top, 1.06 * top, 0.9 * girth, 0.9 * girth, "A1")


def _turret(shoulder: Place, girth: float, radius: float) -> Iterator[Solid]:
    x, y, z = shoulder
    bottom, wide = 0.424 * z, 1.46 * radius
    yield _z_rod(bottom, bottom + 0.3 * girth, 0.98 * girth, 0.98 * girth)
    low = min(bottom + 0.55 * girth, z)
    yield Solid("plate", (0.35 * x, y, low), shoulder, (0.86 * girth, 0.95 * radius), thickness=wide)
    yield _y_rod(shoulder, -0.79 * radius, 0.79 * radius, 0.9 * radius, "joint")
    yield _y_rod(shoulder, -1.28 * radius, 1.28 * radius, 0.42 * radius, "dark")


def _upper_arm(length: float, shoulder: float, elbow: float) -> Iterator[Solid]:
    """Two cheeks, a web between them, caps on both axes."""
    inner, thick = 0.8 * shoulder, 0.40 * shoulder
    for side in (-1, 1):
        y = side * (inner + thick / 2)
        yield Solid("plate", (0.0, y, 0.0), (0.0, y, length), (shoulder, elbow), thickness=thick)
        out = side * (inner + thick)
        for z, radius, paint in ((0.0, 0.66 * shoulder, "A2"), (length, 0.66 * elbow, "A3")):
            yield _y_rod((0.0, 0.0, z), out, out + side * 0.07 * shoulder, radius, paint)
            yield _y_rod((0.0, 0.0, z), out, out + side * 0.12 * shoulder, 0.8 * radius, "dark")
    ends = 1.12 * shoulder + 0.62 * elbow, length - 1.12 * elbow - 0.62 * elbow
    if ends[1] > ends[0]:
        yield Solid("plate", (0.0, 0.0, ends[0]), (0.0, 0.0, ends[1]), (0.62 * elbow,) * 2, "body", 2 * inner)


def _elbow(a2: float, c3: float, shoulder: float, elbow: float) -> Iterator[Solid]:
    wide = 1.56 * shoulder
    yield _y_rod(ORIGIN, -wide / 2, wide / 2, 0.9 * elbow, "joint")
    yield Solid("plate", ORIGIN, (a2, 0.0, 0.0), (0.92 * elbow, 0.92 * elbow), "body", 0.93 * wide)
    end = 0.40 * c3
    yield Solid("rod", (a2, 0.0, -1.05 * elbow), (a2, 0.0, end), (0.84 * elbow, 0.74 * elbow))
    yield Solid("rod", (a2, 0.0, -1.2 * elbow), (a2, 0.0, -1.05 * elbow), (0.66 * elbow, 0.7 * elbow), "dark")
    yield Solid("rod", (a2, 0.0, end), (a2, 0.0, end + 0.12 * elbow), (0.7 * elbow, 0.7 * elbow), "A4")


def _forearm(c3: float, elbow: float, wrist: float) -> Iterator[Solid]:
    """From joint 4 to the fork that holds the wrist; the frame lies in the wrist centre."""
    start, fork = -0.6 * c3 + 0.12 * elbow, -2.0 * wrist
    yield _z_rod(start, fork, 0.66 * elbow, 1.02 * wrist)
    yield _z_rod(fork, -1.5 * wrist, 1.02 * wrist, 1.02 * wrist)
    for side in (-1, 1):
        y = side * 0.83 * wrist
        yield Solid("plate", (0.0, y, -1.55 * wrist), (0.0, y, 0.0), (0.8 * wrist, 0.8 * wrist), "body", 0.36 * wrist)
        yield _y_rod(ORIGIN, side * 1.01 * wrist, side * 1.08 * wrist, 0.56 * wrist, "A5")
        yield _y_rod(ORIGIN, side * 1.01 * wrist, side * 1.14 * wrist, 0.42 * wrist, "dark")


def _wrist(c4: float, wrist: float) -> Iterator[Solid]:
    yield _y_rod(ORIGIN, -0.63 * wrist, 0.63 * wrist, 0.74 * wrist, "joint")
    yield _z_rod(0.0, c4 - 0.26 * wrist, 0.62 * wrist, 0.62 * wrist)


def _z_rod(low: float, high: float, at_low: float, at_high: float, paint: str = "body") -> Solid:
    return Solid("rod", (0.0, 0.0, low), (0.0, 0.0, high), (at_low, at_high), paint)


def _y_rod(centre: Place, start: float, end: float, radius: float, paint: str) -> Solid:
    x, y, z = centre
    return Solid("rod", (x, y + start, z), (x, y + end, z), (radius, radius), paint)


def _place(point: Array) -> Place:
    x, y, z = map(float, point)
    return x, y, z
