"""The slow twin of a whole motion: joints at dense samples by the inverse kinematics of single poses, figures by steps.

Units as in the kernels: m, rad, controller angles.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from oracles import arm as twin
from zerorev.motion import kinematics

__all__ = ["Dense", "dense"]


@dataclass(frozen=True)
class Dense:
    """A motion at dense samples; joints (N, 6), continuous; corner: the row at which the plunge ends."""

    standoff: np.ndarray
    joints: np.ndarray
    corner: int

    @property
    def moved(self):
        """Angle moved on the plunge and on the retract, shape (2, 6)."""
        steps = np.abs(np.diff(self.joints, axis=0))
        return np.array([steps[: self.corner].sum(axis=0), steps[self.corner :].sum(axis=0)])

    @property
    def slowest(self):
        """Least |d theta / d path| by steps, shape (6,)."""
        return (np.abs(np.diff(self.joints, axis=0)) / np.abs(np.diff(self.standoff))[:, None]).min(axis=0)

    @property
    def turns(self):
        """For each joint the rows at which it turns round."""
        return twin.reversals(self.joints, nil=1e-11)


def dense(robot, tool, hole, profile, branch, per_segment):
    """The motion at so many steps a segment; None where it is out of reach."""
    shares = np.linspace(0.0, 1.0, per_segment, endpoint=False)
    s, p = profile.standoff, profile.psi
    standoff = np.append((s[:-1, None] + np.diff(s)[:, None] * shares).ravel(), s[-1])
    psi = np.append((p[:-1, None] + np.diff(p)[:, None] * shares).ravel(), p[-1])
    poses = kinematics.tcp_pose(hole, standoff, psi) @ np.linalg.inv(tool.T_flange_tcp)
    joints = kinematics.inverse(robot, poses)[:, branch]
    if np.isnan(joints).any():
        return None
    return Dense(standoff, np.unwrap(joints, axis=0), profile.corner * per_segment)
