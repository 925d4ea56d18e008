"""Hole + profile + branch -> joint path, with the turns chosen after the extents of the whole path are known."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import numpy.typing as npt

from zerorev.kernels import arm as kernels
from zerorev.kernels.field import rates
from zerorev.model._arrays import Array
from zerorev.model.plan import Motion
from zerorev.model.profile import Profile
from zerorev.model.robot import JointLimits
from zerorev.motion.drilling import Drilling

__all__ = [
    "JUMP",
    "SAMPLES",
    "JointPath",
    "choose_turns",
    "direction_changes",
    "joint_path",
    "joints_along",
    "outward_rates",
    "sample_distances",
    "turns_within",
]

JUMP = 0.5  # [rad] a joint step between neighbouring samples that no drilling motion makes: the thesis' B_jump
SAMPLES = 1000  # steps of a motion, about: so close that a jump to another posture shows
FULL_TURN = 2 * np.pi


@dataclass(frozen=True)
class JointPath:
    """The joints along a motion, and what is wrong with it, if anything.

    Attributes:
        distance: path distance [m], shape (N,).
        standoff: [m], shape (N,).
        psi: [rad], shape (N,).
        joints: controller angles with turns [rad], shape (N, 6); NaN where the branch cannot reach.
        fault: stand-off [m] of the first pose out of reach, or None (thesis: B_fault).
        jump: stand-off [m] of the first discontinuity, or None (B_jump).
        over_limit: joints (1..6) that no choice of turns keeps within their limits (B_limit).
    """

    distance: Array
    standoff: Array
    psi: Array
    joints: Array
    fault: float | None
    jump: float | None
    over_limit: tuple[int, ...]

    @property
    def runs(self) -> bool:
        """Whether the robot can run the motion."""
        return self.fault is None and self.jump is None and not self.over_limit

    def at_breakpoints(self, profile: Profile, branch: int) -> Motion:
        """The joints at the breakpoints of the profile that this path was made of."""
        rows = np.searchsorted(self.distance, profile.distance - 1e-12)
        return Motion(profile, branch, self.joints[rows])


def sample_distances(profile: Profile, samples: int, through: Sequence[float] = ()) -> Array:
    """About `samples` path distances [m], evenly spread, with the breakpoints and all of `through` among them."""
    knots = profile.distance
    # rounding must not add a sample: whoever computes a figure again looks at the same points
    counts = [max(2, int(np.ceil(samples * (b - a) / knots[-1] - 1e-9)) + 1) for a, b in pairwise(knots)]
    parts = [np.linspace(a, b, count)[:-1] for (a, b), count in zip(pairwise(knots), counts, strict=True)]
    return np.sort(np.concatenate([*parts, knots[-1:], np.array(through)]))


def joints_along(drilling: Drilling, branch: int, standoff: Array, psi: Array) -> Array:
    """Continuous controller angles [rad], shape (N, 6), along points (N,) of the twist plane that lie close together.

    The first reachable row lies within (-pi, pi]; rows out of reach are NaN.
    """
    joints = np.empty((standoff.size, 6))
    kernels.angles_along(
        drilling.robot.arm, drilling.plane, np.ascontiguousarray(standoff, dtype=float),
        np.ascontiguousarray(psi, dtype=float), branch, joints,
    )  # fmt: skip
    reached = ~np.isnan(joints[:, 0])
    if reached.any():
        joints[reached] = np.unwrap(joints[reached], axis=0)
    return joints


def direction_changes(steps: Array, at_rest: float) -> npt.NDArray[np.int64]:
    """How often each joint turns round over a sequence of steps, shape (6,); one that rests for a while has not turned.

    Args:
        steps: of the joints, one after the other [rad], shape (n, 6).
        at_rest: a joint that moves by no more than this on a step rests on it [rad].
    """
    signs = np.where(np.abs(steps) > at_rest, np.sign(steps), 0.0)
    moving = [own[own != 0] for own in signs.T]
    return np.array([np.count_nonzero(own[1:] != own[:-1]) for own in moving])


def choose_turns(
    low: Array, high: Array, limits: JointLimits, near: tuple[float, ...] | None = None
) -> tuple[Array, tuple[int, ...]]:
    """Multiples of 2 pi that bring the extents of a whole path within the limits (theory §2, thesis sec. 4.7).

    Args:
        low: least angle of each joint along the path [rad], shape (6,).
        high: greatest angle of each joint [rad], shape (6,).
        limits: of the robot.
        near: where several turns fit, take those nearest to these angles [rad]; None: those farthest from the limits.

    Returns:
        the turns [rad], shape (6,), and the joints (1..6) that no turn brings within their limits; for those the turn
        is the one that goes least far beyond.
    """
    turns, fits = turns_within(low, high, limits, near)
    return turns, tuple((np.flatnonzero(~fits) + 1).tolist())


def turns_within(
    low: Array, high: Array, limits: JointLimits, near: tuple[float, ...] | None = None
) -> tuple[Array, npt.NDArray[np.bool_]]:
    """`choose_turns` for many paths: the turns [rad], and which joints they bring within, each (..., 6).

    Args:
        low: least angle of each joint along each path [rad], shape (..., 6).
        high: greatest angle of each joint [rad], shape (..., 6).
        limits: of the robot.
        near: see `choose_turns`.
    """
    centre, middle = (low + high) / 2, (limits.lower + limits.upper) / 2
    # farthest from the limits is nearest to the middle between them
    aim = middle if near is None else np.array(near)
    first = np.ceil((limits.lower - low) / FULL_TURN - 1e-12)
    last = np.floor((limits.upper - high) / FULL_TURN + 1e-12)
    fits = first <= last
    within = np.minimum(np.maximum(np.round((aim - centre) / FULL_TURN), first), last)
    turns = np.where(fits, within, np.round((middle - centre) / FULL_TURN)) * FULL_TURN
    return turns, fits


def joint_path(
    drilling: Drilling,
    profile: Profile,
    branch: int,
    *,
    near: tuple[float, ...] | None = None,
    samples: int = SAMPLES,
    through: Sequence[float] = (),
) -> JointPath:
    """The joints along a motion on one branch (thesis eq. 3.20, 4.5), turns chosen for the whole path.

    Args:
        drilling: robot, tool and hole.
        profile: the spin along the path.
        branch: 0..7.
        near: see `choose_turns`.
        samples: how many points, about; breakpoints are always among them.
        through: path distances [m] that must be among them, too, e.g. those of known turning points.
    """
    distance = sample_distances(profile, samples, through)
    standoff, psi = profile.at(distance)
    joints = joints_along(drilling, branch, standoff, psi)
    lost = np.flatnonzero(np.isnan(joints[:, 0]))
    if lost.size:
        return JointPath(distance, standoff, psi, joints, float(standoff[lost[0]]), None, ())
    steps = np.abs(np.diff(joints, axis=0)).max(axis=1)
    jumps = np.flatnonzero(steps > JUMP)
    turns, over = choose_turns(joints.min(axis=0), joints.max(axis=0), drilling.limits, near)
    jump = float(standoff[jumps[0]]) if jumps.size else None
    return JointPath(distance, standoff, psi, joints + turns, None, jump, over)


def outward_rates(drilling: Drilling, branch: int, standoff: Array, psi: Array, twist_rate: float | Array) -> Array:
    """D theta / d s at points (N,) of legs of slope u [rad/m], read outwards [rad/m], shape (N, 6) (theory §2)."""
    theta_s, theta_psi = np.empty((2, 6, standoff.size))
    rates(
        drilling.robot.arm, drilling.plane, branch // 2, np.ascontiguousarray(standoff),
        np.ascontiguousarray(psi), theta_s, theta_psi,
    )  # fmt: skip
    found = (theta_s + twist_rate * theta_psi).T
    found[:, 4] *= kernels.flip_sign(drilling.robot.arm, branch)
    return found
