"""Where the tool is asked to be: samples of the two legs and of the blended corner, and the joints that follow them."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from zerorev.model._arrays import Array
from zerorev.model.hole import Hole
from zerorev.model.profile import Profile
from zerorev.model.robot import Robot
from zerorev.model.tool import Tool
from zerorev.verify.arm import Posture, skeleton, solve, with_turns

__all__ = ["Path", "Track", "around", "blend", "follow", "legs", "residual", "with_blend"]

# a segment gets so many steps however short it is: a narrow kink must not hide between samples
LEAST_STEPS = 16


class Path(NamedTuple):
    """Samples in the twist plane, in order of motion.

    Attributes:
        standoff: [m], shape (N,).
        psi: [rad], shape (N,).
        knots: indices of the profile's breakpoints, shape (n,).
        corner: index of the sample at which the plunge ends.
    """

    standoff: Array
    psi: Array
    knots: tuple[int, ...]
    corner: int

    def place(self, index: int) -> str:
        """Where a sample lies, for a message."""
        leg = "at the corner" if index == self.corner else f"on the {'plunge' if index < self.corner else 'retract'}"
        return f"{leg}, stand-off {round(self.standoff[index] * 1e3, 4) + 0.0:g} mm"


class Track(NamedTuple):
    """A path and the joints that follow it.

    Attributes:
        path: samples.
        joints: controller angles with turns [rad], shape (N, 6); NaN out of reach.
    """

    path: Path
    joints: Array

    def part(self, first: int, last: int) -> Track:
        """The samples first to last, both included."""
        path, there = self.path, slice(first, last + 1)
        piece = Path(path.standoff[there], path.psi[there], (), path.corner - first)
        return Track(piece, self.joints[there])


def legs(profile: Profile, samples: int) -> Path:
    """Samples spread evenly over the path distance, with every breakpoint among them.

    Args:
        profile: spin along the path, n breakpoints.
        samples: about how many; short segments get more than their share.
    """
    lengths = np.abs(np.diff(profile.standoff))
    steps = np.maximum(LEAST_STEPS, np.rint(lengths / lengths.sum() * (samples - 1))).astype(int)

    def spread(values: Array) -> Array:
        pieces = [np.linspace(values[k], values[k + 1], n, endpoint=False) for k, n in enumerate(steps)]
        return np.concatenate([*pieces, values[-1:]])

    knots = tuple(int(k) for k in np.concatenate([[0], np.cumsum(steps)]))
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
    t = np.linspace(0.0, 1.0, samples)[:, None]
    entry, leave = (middle + side * (radius / abs(side[0])) for side in sides)
    standoff, psi = ((1 - t) ** 2 * entry + 2 * t * (1 - t) * middle + t**2 * leave).T
    # on one leg the whole blend lies before or behind the corner
    at_corner = k == int(np.argmin(profile.standoff))
    corner = int(np.argmin(standoff)) if at_corner else (samples if sides[0][0] > 0 else -1)
    return Path(standoff, psi, (), corner)


def around(path: Path, k: int, curve: Path) -> tuple[int, int]:
    """The samples of the legs between which a blend at breakpoint k lies: the last before it, the first behind it."""
    distance = np.concatenate([[0.0], np.cumsum(np.abs(np.diff(path.standoff)))])
    knot = path.knots[k]
    radius = abs(curve.standoff[0] - path.standoff[knot]) + 1e-12  # [m]: a sample at the very end is the blend's own
    before = np.flatnonzero(distance < distance[knot] - radius)[-1]
    behind = np.flatnonzero(distance > distance[knot] + radius)[0]
    return int(before), int(behind)


def with_blend(track: Track, curve: Track, before: int, behind: int) -> tuple[Track, int, int]:
    """A track in which the samples between two are replaced by a blend.

    Args:
        track: both legs, N samples.
        curve: the blend, M samples.
        before: the last sample of the legs that is kept before the blend.
        behind: the first that is kept behind it.

    Returns:
        The blended track, and the indices in it of the blend's first and last sample.
    """

    def join(legs: Array, cut: Array) -> Array:
        return np.concatenate([legs[: before + 1], cut, legs[behind:]])

    added, corner = curve.path.standoff.size, track.path.corner
    if before < corner < behind:
        corner = before + 1 + curve.path.corner
    elif corner >= behind:
        corner += added - (behind - before - 1)
    whole = Path(join(track.path.standoff, curve.path.standoff), join(track.path.psi, curve.path.psi), (), corner)
    return Track(whole, join(track.joints, curve.joints)), before + 1, before + added


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
    tip, R_base_tcp = _asked(hole, path)
    T = tool.T_flange_tcp
    R_base_flange = _onto(R_base_tcp, T[:3, :3].T)
    flange = tip - _onto(R_base_flange, T[:3, 3:])[:, 0]
    return with_turns(solve(robot.arm, flange, R_base_flange, posture), start)


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
    tip, R_asked = _asked(hole, path)
    body = skeleton(robot.arm, joints)
    T = tool.T_flange_tcp
    R = _onto(body.R_base_flange, T[:3, :3])
    reached = body.flange + _onto(body.R_base_flange, T[:3, 3:])[:, 0]
    # |R - R'| (Frobenius) = 2 sqrt(2) sin(angle / 2): exact for small angles, where an arccos of the trace is not
    chord = np.sqrt(((R - R_asked) ** 2).sum(axis=(0, 1)) / 8)
    return np.sqrt(((reached - tip) ** 2).sum(axis=0)), 2 * np.arcsin(np.minimum(chord, 1.0))


def _onto(R: Array, M: Array) -> Array:
    """The product of rotations (3, 3, N), samples last, with one matrix (3, m): shape (3, m, N)."""
    return M.T @ R


def _asked(hole: Hole, path: Path) -> tuple[Array, Array]:
    """Tip [m], shape (3, N), and rotation of the tool, shape (3, 3, N): Z = -direction, Y = psi_zero turned by psi."""
    z = -hole.direction[:, None]
    y0 = hole.psi_zero[:, None]
    x0 = np.cross(hole.psi_zero, -hole.direction)[:, None]
    c, s = np.cos(path.psi), np.sin(path.psi)
    x, y = c * x0 + s * y0, c * y0 - s * x0
    tip = hole.target[:, None] - path.standoff * hole.direction[:, None]
    return tip, np.stack([x, y, np.broadcast_to(z, x.shape)], axis=1)
