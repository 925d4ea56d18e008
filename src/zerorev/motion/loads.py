"""What the joints carry along a motion, and the lost motion that their gears add to it at the tip.

Under load a gear lies on one of its flanks. Where the load of a joint changes its sign along the motion, the gear
crosses to the other flank, as it does where the joint reverses; and on one flank it gives way by the load over its
stiffness. What of that moves the tip across the drill axis is predicted here in closed form, quasi-statically, with the
guessed drives of `nominal_drives`: good to choose between motions, not to state a gain.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import lru_cache

import numpy as np
import numpy.typing as npt

from zerorev.kernels import loads as kernels
from zerorev.kernels.loads import Gears
from zerorev.model._arrays import Array
from zerorev.model.dynamics import nominal_drives
from zerorev.model.plan import LegName, LostMotion, LostMotionEvent
from zerorev.model.profile import Profile
from zerorev.motion.drilling import Drilling
from zerorev.motion.joint_path import sample_distances

__all__ = ["GRAVITY", "LEVELS", "gears_of", "held_at", "loads", "lost_motion", "lost_motion_of", "twins_lost_motion"]

Mask = npt.NDArray[np.bool_]
GRAVITY = 9.81  # [m/s^2], along -Z of the base: the arm stands on the floor
LEVELS = (0.1, 0.4, 1.0)  # shares of the dry friction that may lie behind the gear: known within a factor of ten
SAME_PLACE = 1e-12  # [m]
CLOSER, CLOSER_TIMES = 33, 5  # points between two samples, each time 32 times closer
SAMPLES = 400  # of a motion, between which a load that changes its sign is interpolated


@lru_cache(maxsize=16)
def gears_of(payload: float) -> Gears:
    """The guessed gears of an arm of this payload [kg], with the levels of friction that are examined."""
    drives = nominal_drives(payload)
    return Gears(np.outer(LEVELS, drives.coulomb), drives.stiffness, drives.lost_motion)


def loads(
    drilling: Drilling, profile: Profile, branch: int, distance: Array, outwards: Mask
) -> tuple[Array, Array, Array]:
    """What the joints carry at points along a motion.

    Args:
        drilling: of a robot with dynamics.
        profile: the spin along the path.
        branch: 0..7.
        distance: path distances [m], shape (N,).
        outwards: whether a point is one of the retract; at the corner both legs have one, shape (N,).

    Returns:
        the torques that hold links and tool [N m], shape (N, 6); the velocity of the tip per speed of each joint, base
        frame [m], (N, 6, 3); which way each joint turns, (N, 6). NaN where the branch does not reach.
    """
    bodies = drilling.bodies
    assert bodies is not None
    standoff, psi = profile.at(distance)
    knots, twist = profile.distance, profile.twist_rate
    segment = np.clip(
        np.searchsorted(knots, distance + np.where(outwards, SAME_PLACE, -SAME_PLACE)) - 1, 0, twist.size - 1
    )
    held, sense = np.empty((2, distance.size, 6))
    lever = np.empty((distance.size, 6, 3))
    kernels.loads_along(
        drilling.robot.arm, bodies, drilling.plane, branch, standoff, psi, twist[segment], outwards, GRAVITY,
        held, lever, sense,
    )  # fmt: skip
    return held, lever, sense


def held_at(drilling: Drilling, branch: int, standoff: Array, psi: Array, thrust: float = 0.0) -> Array:
    """The torques that hold links, tool and the thrust of the drill, without friction [N m], shape (N, 6).

    Args:
        drilling: of a robot with dynamics.
        branch: 0..7.
        standoff: s [m], shape (N,).
        psi: spin [rad], shape (N,).
        thrust: of the drill [N].

    Returns:
        NaN rows where the branch does not reach.
    """
    bodies = drilling.bodies
    assert bodies is not None
    held, sense = np.empty((2, standoff.size, 6))
    lever = np.empty((standoff.size, 6, 3))
    still, outwards = np.zeros(standoff.size), np.ones(standoff.size, dtype=bool)  # neither matters to what is held
    kernels.loads_along(
        drilling.robot.arm, bodies, drilling.plane, branch, standoff, psi, still, outwards, GRAVITY, held, lever, sense
    )
    return np.asarray(held + thrust * (lever @ drilling.hole.direction))


def lost_motion(drilling: Drilling, profile: Profile, branch: int, thrust: float = 0.0) -> float | None:
    """The lost motion at the tip that a motion is predicted to have [m] (the greatest of the levels of friction).

    Over half a stroke on either side of the turn. None for a robot without dynamics, and of a motion that turns round
    more than once, to break chips; infinite where a joint cannot be
    followed.

    Args:
        drilling: robot, tool and hole.
        profile: the spin along the path.
        branch: 0..7.
        thrust: of the drill while it plunges [N].
    """
    bodies, dynamics = drilling.bodies, drilling.robot.dynamics
    if bodies is None or dynamics is None or len(profile.turns) > 1:
        return None
    corner = profile.corner
    window = 0.5 * float(profile.standoff[0] - profile.standoff[corner])
    found = kernels.tip_lost_motion(
        drilling.robot.arm, bodies, gears_of(dynamics.payload), drilling.plane, branch, profile.standoff, profile.psi,
        corner, window, float(thrust), GRAVITY,
    )  # fmt: skip
    return float(found) if np.isfinite(found) else np.inf


def twins_lost_motion(drilling: Drilling, profile: Profile, branch: int, thrust: float = 0.0) -> LostMotion | None:
    """`lost_motion_of` without its events, which take most of the time.

    Args:
        drilling: robot, tool and hole.
        profile: the spin along the path.
        branch: 0..7.
        thrust: of the drill while it plunges [N].
    """
    at_tip = lost_motion(drilling, profile, branch, thrust)
    if at_tip is None or not np.isfinite(at_tip):
        return None
    twin = lost_motion(drilling, profile.reversed(), branch, thrust)
    return LostMotion(at_tip, twin if twin is not None and np.isfinite(twin) else None)


def lost_motion_of(drilling: Drilling, profile: Profile, branch: int, thrust: float = 0.0) -> LostMotion | None:
    """The lost motion of a motion and of its twin, and where loads change their sign without a reversal.

    None for a robot without dynamics, of a motion that breaks chips, and where a joint cannot be followed.

    Args:
        drilling: robot, tool and hole.
        profile: the spin along the path.
        branch: 0..7.
        thrust: of the drill while it plunges [N].
    """
    found = twins_lost_motion(drilling, profile, branch, thrust)
    return None if found is None else replace(found, events=_events(drilling, profile, branch, thrust))


def _events(drilling: Drilling, profile: Profile, branch: int, thrust: float) -> tuple[LostMotionEvent, ...]:
    dynamics = drilling.robot.dynamics
    assert dynamics is not None
    friction = gears_of(dynamics.payload).friction

    def carried(distance: Array, outwards: Mask) -> tuple[Array, Array]:
        """Loads, shape (N, levels, 6), and which way the joints turn, (N, 6)."""
        held, lever, sense = loads(drilling, profile, branch, distance, outwards)
        pushed = np.where(outwards, 0.0, thrust)[:, None] * (lever @ drilling.hole.direction)
        return held[:, None] + sense[:, None] * friction + pushed[:, None], sense

    distance, outwards = _both_legs(profile)
    _, sense = carried(distance, outwards)
    # a joint that reverses splits an interval: its load may change its sign on either side of that
    turns: list[tuple[float, bool]] = []
    for row, joint in np.argwhere(sense[:-1] * sense[1:] < 0).tolist():
        low, high, back = float(distance[row]), float(distance[row + 1]), bool(outwards[row + 1])
        ends = _closed_in(lambda places, on: carried(places, on)[1], joint, low, high, back)
        turns += [(end, back) for end in ends if low < end < high]
    order = sorted([*zip(distance.tolist(), outwards.tolist(), strict=True), *turns], key=lambda each: each[::-1])
    distance, outwards = np.array([each[0] for each in order]), np.array([each[1] for each in order])

    load, sense = carried(distance, outwards)
    with np.errstate(invalid="ignore"):
        crossed = (load[:-1] * load[1:] < 0) & (sense[:-1] * sense[1:] > 0)[:, None]
    found: list[tuple[float, int, float, LostMotionEvent]] = []
    for row, level, joint in np.argwhere(crossed).tolist():
        place, leg = float(distance[row]), _leg(outwards[row], outwards[row + 1])
        if leg != "target":
            high = float(distance[row + 1])
            ends = _closed_in(lambda places, on: carried(places, on)[0], (level, joint), place, high, leg == "retract")
            place = sum(ends) / 2
        standoff = float(np.interp(place, profile.distance, profile.standoff))
        found.append((place, joint, LEVELS[level], LostMotionEvent(joint + 1, leg, standoff, LEVELS[level])))
    return tuple(event for *_, event in sorted(found, key=lambda each: each[:3]))


def _leg(before: bool, after: bool) -> LegName:
    return "target" if before != after else "retract" if after else "plunge"


def _both_legs(profile: Profile) -> tuple[Array, Mask]:
    """Places along a motion [m] and whether they are of the retract, the corner once for each leg."""
    turn = float(profile.distance[profile.corner])
    distance = sample_distances(profile, SAMPLES)
    at_corner = int(np.searchsorted(distance, turn - SAME_PLACE))
    distance = np.insert(distance, at_corner, distance[at_corner])
    return distance, np.arange(distance.size) > at_corner


def _closed_in(
    values: Callable[[Array, Mask], Array], which: int | tuple[int, int], low: float, high: float, outwards: bool
) -> tuple[float, float]:
    """Two places, as close as makes sense, between which one of some values changes its sign on one leg."""
    back = np.full(CLOSER, outwards)
    for _ in range(CLOSER_TIMES):
        places = np.linspace(low, high, CLOSER)
        near = np.moveaxis(values(places, back), 0, -1)[which]
        k = max(int(np.argmax(near * near[0] <= 0)), 1)
        low, high = float(places[k - 1]), float(places[k])
    return low, high


def leg_gives(drilling: Drilling, branch: int, psi_t: Array, slope: Array, thrust: float) -> Array:
    """Where the gears let the tip go along straight legs, shape (n, 2, levels, 13, 3) [m], run inwards and outwards.

    Args:
        drilling: of a robot with dynamics.
        branch: 0..7.
        psi_t: spins at the target [rad], shape (n,).
        slope: twist rates [rad/m], shape (n,).
        thrust: of the drill while it plunges [N].
    """
    bodies, dynamics = drilling.bodies, drilling.robot.dynamics
    assert bodies is not None
    assert dynamics is not None
    out = np.empty((psi_t.size, 2, len(LEVELS), kernels.WINDOW_STEPS + 1, 3))
    kernels.leg_gives(
        drilling.robot.arm, bodies, gears_of(dynamics.payload), drilling.plane, branch, psi_t, slope,
        0.5 * drilling.hole.depth, float(thrust), GRAVITY, out,
    )  # fmt: skip
    return out


def pair_lost_motion(one: Array, other: Array) -> Array:
    """The lost motion at the tip of all pairs of legs out of one spin [m], shape (n, m), each in its better order.

    Args:
        one: from `leg_gives`, of n legs.
        other: of m legs, likewise.
    """
    out = np.empty((len(one), len(other)))
    kernels.pair_lost_motion(one, other, out)
    return out
