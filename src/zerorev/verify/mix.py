"""Blends of which the curve is not known: samples of all the places to which one can take the tool.

Within a blend a controller goes over from the velocity of one move to that of the next. If it has one path parameter
for tip and spin, its velocity is at each moment a mix of the two, with weights that are not negative; then the tool
stays in the triangle between entry, bend and exit (as long as it stays within the radius), and a joint keeps its
direction in every such blend if it has that direction at every place of the triangle, moving as on the one move and as
on the other (theory §5.1).
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Literal, NamedTuple

import numpy as np

from zerorev.model._arrays import Array
from zerorev.model.hole import Hole
from zerorev.model.profile import Profile
from zerorev.model.robot import Robot
from zerorev.model.tool import Tool
from zerorev.verify.arm import posture_of
from zerorev.verify.lever import line_rates
from zerorev.verify.path import Path, follow

__all__ = ["Mixed", "Mixes", "mix_holds", "mixed"]

Mixes = Literal["any", "one_way"]
"""Blends with any mix at any moment; or those alone in which the share of the second velocity never falls.

The velocity of the latter turns one way, from the first move's to the second's, and their curve is convex: at each
place it lies between the straight lines from the entry there and from there to the exit. So it is with a parabola, and
wherever one move dies away while the next sets in.
"""
POINTS = 33  # along either side of the triangle


class Mixed(NamedTuple):
    """What blends do to the six joints, shape (6,) each; NaN for a joint that turns round without a blend, too.

    Attributes:
        slowest: least rate in the direction that a joint has on the moves, over all mixes [rad/m]: below 0 if it turns
            round in some blend; of a joint that stands still on them, how fast it moves, below 0.
        left: where that is: path left on the move before the bend [m].
        done: path done on the move behind it [m].
        share: of the first velocity in that mix, 0 to 1.
    """

    slowest: Array
    left: Array
    done: Array
    share: Array


def mix_holds(
    robot: Robot,
    tool: Tool,
    hole: Hole,
    profile: Profile,
    joints: Array,
    k: int,
    radius: float,
    mixes: Mixes = "any",
    *,
    points: int = POINTS,
) -> Iterator[str]:
    """No joint that keeps its direction on two moves may turn round in a blend of them, of any curve.

    Args:
        robot: the arm.
        tool: the drill.
        hole: the drill axis.
        profile: spin along the path, n breakpoints.
        joints: at the breakpoints [rad], shape (n, 6).
        k: the breakpoint that is blended, 1 to n - 2.
        radius: of the blend [m], above 0; clipped to half the shorter of the two moves.
        mixes: which blends.
        points: along either side of the triangle.

    Yields:
        One sentence for each joint that turns round, or for a pose out of reach.
    """
    found = mixed(robot, tool, hole, profile, joints, k, radius, mixes, points=points)
    where = "in the blended corner" if k == profile.corner else f"in the blend at breakpoint {k + 1}"
    if found is None:
        yield f"{where}, out of reach or singular at some place between entry, bend and exit"
        return
    first, second = ("the plunge", "the retract") if k == profile.corner else ("the move before", "the move behind")
    for joint, name in enumerate(robot.joint_names):
        if found.slowest[joint] < 0:
            left, done, share = 1e3 * found.left[joint], 1e3 * found.done[joint], 100 * found.share[joint]
            yield (
                f"{where}, {name} turns round in a blend with {left + 0.0:.4g} mm of {first} left, {done + 0.0:.4g} mm "
                f"of {second} done, and {share + 0.0:.3g} % of its velocity from {first}"
            )


def mixed(
    robot: Robot,
    tool: Tool,
    hole: Hole,
    profile: Profile,
    joints: Array,
    k: int,
    radius: float,
    mixes: Mixes = "any",
    *,
    points: int = POINTS,
) -> Mixed | None:
    """What the blends at a breakpoint do to the joints; arguments as in `mix_holds`.

    Returns:
        The slowest mix of each joint; None where a pose is out of reach or singular.
    """
    steps = np.diff(profile.standoff)[k - 1 : k + 1]
    cut = float(min(radius, *(np.abs(steps) / 2)))
    place, shares = _places(mixes, points)
    a, b = cut * place
    along, slope = np.sign(steps), profile.twist_rate[k - 1 : k + 1]
    standoff = profile.standoff[k] - along[0] * a + along[1] * b
    psi = profile.psi[k] - along[0] * slope[0] * a + along[1] * slope[1] * b
    posture = posture_of(robot.arm, joints[k])
    q = follow(robot, tool, hole, Path(standoff, psi, (), 0), posture, joints[k])
    both = np.stack([line_rates(robot, tool, hole, q, along[m], along[m] * slope[m]) for m in (0, 1)])
    if not np.isfinite(both).all():
        return None

    nil = robot.nil_rate
    sides = np.concatenate([both[0, b == 0], both[1, a == 0]])
    way = (sides.min(axis=0) > nil).astype(float) - (sides.max(axis=0) < -nil)
    still = (np.abs(sides) <= nil).all(axis=0)
    rates = shares[:, :, None] * both[0] + (1 - shares[:, :, None]) * both[1]  # (mixes, places, joints)
    moved = np.where(still, np.where(np.abs(rates) > nil, -np.abs(rates), 0.0), way * rates).reshape(-1, 6)
    least, own = moved.argmin(axis=0), np.arange(6)
    at = least % a.size
    kept = still | (way != 0)
    values = moved[least, own], a[at], b[at], shares.reshape(-1)[least]
    return Mixed(*(np.where(kept, value, np.nan) for value in values))


def _places(mixes: Mixes, points: int) -> tuple[Array, Array]:
    """Places of the triangle, as shares of the radius, and which mixes are the outermost there.

    Returns:
        What is left of the first move and done of the second, shape (2, N); shares of the first velocity, (mixes, N).
    """
    x, y = (values.ravel() for values in np.meshgrid(*[np.linspace(0.0, 1.0, points)] * 2))
    if mixes == "any":
        return np.stack([x * (1 - y), x * y]), np.stack([np.ones_like(x), np.zeros_like(x)])
    # seen from the entry, and from the exit: in the direction from there, where the velocity leads straight on
    far, beside, share = 1 - x, x * y, 1 / (1 + y)
    places = np.stack([np.concatenate([far, beside]), np.concatenate([beside, far])])
    return places, np.concatenate([share, 1 - share])[None]
