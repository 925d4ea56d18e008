"""Where the tool is asked to be: samples of the two legs and of the blended corner, and the joints that follow them."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from zerorev.model._arrays import Array
from zerorev.model.hole import Hole
from zerorev.model.profile import Profile
from zerorev.model.robot import NIL_RATE, Robot
from zerorev.model.tool import Tool
from zerorev.verify import compiled
from zerorev.verify.arm import Posture, Sums, solve, with_turns

__all__ = ["Path", "Track", "around", "blend", "follow", "joined", "legs", "residual"]

# a segment gets so many steps however short it is: a narrow kink must not hide between samples
LEAST_STEPS = 16


class Path(NamedTuple):
    """Samples in the twist plane, in order of motion.

    Attributes:
        standoff: [m], shape (N,).
        psi: [rad], shape (N,).
        knots: indices of the profile's breakpoints, shape (n,).
        corner: index of the sample at which the plunge ends; -1 where all lie behind it, N where all lie before it.
    """

    standoff: Array
    psi: Array
    knots: tuple[int, ...]
    corner: int

    def place(self, index: int) -> str:
        """Where a sample lies, for a message."""
        leg = "at the corner" if index == self.corner else f"on the {'plunge' if index < self.corner else 'retract'}"
        return f"{leg}, stand-off {round(self.standoff[index] * 1e3, 4) + 0.0:g} mm"


class Moves(NamedTuple):
    """What the joints do from sample to sample, shape (6,) each; NaN for a joint that is NaN at any sample.

    Attributes:
        least: the step farthest backwards [rad], or the shortest one forwards.
        most: the step farthest forwards [rad], or the shortest one backwards.
        plunge: angle moved before the corner [rad].
        retract: angle moved behind it [rad].
        slowest: least |d theta / d path| between two samples [rad/m].
    """

    least: Array
    most: Array
    plunge: Array
    retract: Array
    slowest: Array


@dataclass(frozen=True)
class Track:
    """A path and the joints that follow it.

    Attributes:
        path: samples.
        joints: controller angles with turns [rad], shape (N, 6); NaN out of reach.
        nil_rate: up to which a joint does not move [rad/m], that of the robot (conventions: signature).
    """

    path: Path
    joints: Array
    nil_rate: float = NIL_RATE

    @cached_property
    def moves(self) -> Moves:
        """What the joints do from sample to sample: a joint after the other, which takes little memory at a time."""
        found, corner = np.empty((5, 6)), self.path.corner
        with np.errstate(invalid="ignore", divide="ignore"):
            for joint in range(6):
                steps = np.diff(self.joints[:, joint])
                found[:2, joint] = steps.min(), steps.max()
                np.abs(steps, out=steps)
                found[2:4, joint] = steps[:corner].sum(), steps[corner:].sum()
                steps /= self.path_steps
                found[4, joint] = steps.min()
        return Moves(*found)

    @cached_property
    def path_steps(self) -> Array:
        """Path distance between neighbouring samples [m], shape (N - 1,)."""
        steps = np.diff(self.path.standoff)
        return np.abs(steps, out=steps)

    @cached_property
    def distance(self) -> Array:
        """Path distance [m] of the samples from the first, shape (N,)."""
        return np.concatenate([[0.0], np.cumsum(self.path_steps)])

    @cached_property
    def extents(self) -> tuple[Array, Array]:
        """Least and greatest angle of each joint [rad], shape (6,) each; NaN where any sample of it is."""
        return self.joints.min(axis=0), self.joints.max(axis=0)


def legs(profile: Profile, samples: int) -> Path:
    """Samples spread evenly over the path distance, with every breakpoint among them.

    Args:
        profile: spin along the path, n breakpoints.
        samples: about how many; short segments get more than their share.
    """
    lengths = np.abs(np.diff(profile.standoff))
    steps = np.maximum(LEAST_STEPS, np.rint(lengths / lengths.sum() * (samples - 1))).astype(int)

    knots = tuple(int(k) for k in np.concatenate([[0], np.cumsum(steps)]))
    numbers = np.arange(steps.max(), dtype=float)

    def spread(values: Array) -> Array:
        found = np.empty(knots[-1] + 1)
        for k, n in enumerate(steps):
            piece = found[knots[k] : knots[k + 1]]
            np.multiply(numbers[:n], (values[k + 1] - values[k]) / n, out=piece)
            piece += values[k]
        found[-1] = values[-1]
        return found

    return Path(spread(profile.standoff), spread(profile.psi), knots, knots[int(np.argmin(profile.standoff))])


def blend(profile: Profile, k: int, radius: float, samples: int) -> Path:
    """A breakpoint cut by a parabola (theory §5): a quadratic Bezier in (stand-off, psi).

    It leaves one segment `radius` before the breakpoint and joins the next `radius` behind it; the radius is clipped to
    half the shorter of the two. At the corner it turns back radius / 2 short.

    Args:
        profile: spin along the path, n breakpoints.
        k: which breakpoint, 1 to n - 2.
        radius: of the blend [m], above 0.
        samples: how many.
    """
    middle, before, after = (np.array([profile.standoff[i], profile.psi[i]]) for i in (k, k - 1, k + 1))
    sides = [end - middle for end in (before, after)]
    radius = min(radius, *(abs(side[0]) / 2 for side in sides))
    t = np.linspace(0.0, 1.0, samples)
    entry, leave = (middle + side * (radius / abs(side[0])) for side in sides)
    first, between, last = (1 - t) ** 2, 2 * t * (1 - t), t**2
    standoff, psi = (a * first + b * between + c * last for a, b, c in zip(entry, middle, leave, strict=True))
    # on one leg the whole blend lies before or behind the corner
    at_corner = k == int(np.argmin(profile.standoff))
    corner = int(np.argmin(standoff)) if at_corner else (samples if sides[0][0] > 0 else -1)
    return Path(standoff, psi, (), corner)


def around(track: Track, k: int, curve: Path) -> tuple[int, int]:
    """The samples of the legs between which a blend at breakpoint k lies: the last before it, the first behind it."""
    at = track.path.knots[k]
    radius = (
        abs(curve.standoff[0] - track.path.standoff[at]) + 1e-12
    )  # [m]: a sample at the very end is the blend's own
    low, high = track.distance[at] - radius, track.distance[at] + radius
    return int(np.searchsorted(track.distance, low)) - 1, int(np.searchsorted(track.distance, high, "right"))


def joined(track: Track, curve: Track, before: int, behind: int) -> Track:
    """A blend with a sample of the legs on either side, so that the joints are also seen to run into it.

    Args:
        track: both legs.
        curve: the blend, M samples.
        before: the last sample of the legs before the blend.
        behind: the first behind it.

    Returns:
        M + 2 samples.
    """

    def join(legs: Array, cut: Array) -> Array:
        return np.concatenate([legs[..., before : before + 1], cut, legs[..., behind : behind + 1]], axis=-1)

    legs, cut = track.path, curve.path
    corner = cut.corner + (cut.corner >= 0) + (cut.corner >= cut.psi.size)
    path = Path(join(legs.standoff, cut.standoff), join(legs.psi, cut.psi), (), corner)
    return Track(path, join(track.joints.T, curve.joints.T).T, track.nil_rate)


def follow(robot: Robot, tool: Tool, hole: Hole, path: Path, posture: Posture, start: Array) -> Array:
    """Joints along a path in one posture, continuous from the turns of `start`.

    Args:
        robot: the arm.
        tool: the drill.
        hole: the drill axis.
        path: N samples.
        posture: which way round the arm reaches them.
        start: joints [rad] near the first sample, shape (6,).

    Returns:
        Controller angles [rad], shape (N, 6); NaN out of reach.
    """
    wanted = _sums(_flange(robot, tool, _asked(hole)))
    return with_turns(solve(robot.arm, wanted, posture, path.standoff, path.psi), start)


def residual(robot: Robot, tool: Tool, hole: Hole, path: Path, joints: Array) -> tuple[Array, Array]:
    """How far the tool is from where it is asked to be, by forward kinematics.

    Args:
        robot: the arm.
        tool: the drill.
        hole: the drill axis.
        path: N samples.
        joints: controller angles [rad], shape (N, 6).

    Returns:
        Distance between the tips [m] and angle between the tools [rad], each of shape (N,).
    """
    T, reached = tool.T_flange_tcp, np.eye(4)
    reached[:3, :3], reached[3, :3] = T[:3, :3].T, T[:3, 3] + [0, 0, robot.arm.c4]
    off2, chord2 = np.empty((2, path.psi.size))
    q = np.ascontiguousarray(joints.T)
    weights, asked = tuple(map(tuple, reached.tolist())), _sums(_asked(hole))
    compiled.residual(robot.arm, weights, asked, path.standoff, path.psi, q, off2, chord2)
    # |R - R'| (Frobenius) = 2 sqrt(2) sin(angle / 2): exact for small angles, where an arccos of the trace is not
    half_sine = np.minimum(np.sqrt(chord2 / 8, out=chord2), 1.0, out=chord2)
    return np.sqrt(off2, out=off2), 2 * np.arcsin(half_sine, out=half_sine)


def _asked(hole: Hole) -> Array:
    """The tool in the twist plane: its axes x, y, z and its tip [m] as `Sums`, shape (4, 3, 4).

    The tool's Z is -direction; its Y is psi_zero turned by psi about Z.
    """
    z, y = -hole.direction, hole.psi_zero
    x = np.array([y[1] * z[2] - y[2] * z[1], y[2] * z[0] - y[0] * z[2], y[0] * z[1] - y[1] * z[0]])
    asked = np.zeros((4, 3, 4))
    asked[0, :, 2], asked[0, :, 3] = x, y
    asked[1, :, 2], asked[1, :, 3] = y, -x
    asked[2, :, 0] = z
    asked[3, :, 0], asked[3, :, 1] = hole.target, z
    return asked


def _flange(robot: Robot, tool: Tool, asked: Array) -> Array:
    """The axes of the flange and the wrist centre, as `_asked` has the tool's axes and its tip, shape (4, 3, 4)."""
    T, flange = tool.T_flange_tcp, np.empty((4, 3, 4))
    flange[:3] = (T[:3, :3] @ asked[:3].reshape(3, 12)).reshape(3, 3, 4)
    flange[3] = asked[3] - ((T[:3, 3] + [0, 0, robot.arm.c4]) @ flange[:3].reshape(3, 12)).reshape(3, 4)
    return flange


def _sums(values: Array) -> Sums:
    """An array of shape (4, 3, 4) as kernels take it."""
    return tuple(tuple(map(tuple, rows)) for rows in values.tolist())
