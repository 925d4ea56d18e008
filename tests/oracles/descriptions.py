"""What is published of the shipped FANUC, Yaskawa and ABB arms, as it stands there, and forward kinematics of it.

`CHAINS` are the joints of the makers' and ROS-Industrial's descriptions: where each sits on the link before it [m], and
its axis, all joints at 0. `TABLES` are modified Denavit-Hartenberg rows of another author (PyPI
robotkinematicscatalogue 1.1.2), in the controller's base frame and for the joints that the pendant shows. Both are
independent of the seven lengths by which zerorev knows an arm.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from oracles.arm import X, Y, Z, rotation, translation

__all__ = ["CHAINS", "TABLES", "Chain", "Table"]

FORWARD = (Z, Y, -Y, -X, -Y, -X)  # axes of FANUC's and Yaskawa's joints
OUT = rotation(Y, -np.pi / 2) @ rotation(X, np.pi)  # their flange: Z out of it, X up


@dataclass(frozen=True)
class Chain:
    """A description.

    Attributes:
        places: of the six joints, each on the link before it [m].
        axes: of the joints.
        tip: the flange on link 6, shape (4, 4).
        base: height of the controller's base [m].
    """

    places: tuple[tuple[float, float, float], ...]
    axes: tuple[np.ndarray, ...]
    tip: np.ndarray
    base: float

    def forward(self, joints):
        """The flange in the root frame of the description."""
        T = np.eye(4)
        for place, axis, angle in zip(self.places, self.axes, joints, strict=True):
            T = T @ translation(*place) @ rotation(axis, angle)
        return T @ self.tip


@dataclass(frozen=True)
class Table:
    """A table of modified Denavit-Hartenberg rows.

    Attributes:
        a: [m], of six rows.
        d: [m], of six rows.
        signs: of the joints.
        ground: whether joint 3 counts against the ground.
        turned: angle of the flange [rad].
    """

    a: tuple[float, ...]
    d: tuple[float, ...]
    signs: tuple[int, ...]
    ground: bool = False
    turned: float = 0.0

    def forward(self, shown):
        """The flange in the controller's base frame."""
        alphas = (0, -np.pi / 2, 0, -np.pi / 2, np.pi / 2, -np.pi / 2)
        zeros = (0, -np.pi / 2, 0, 0, 0, self.turned)
        T = np.eye(4)
        for i in range(6):
            T = T @ rotation(X, alphas[i]) @ translation(self.a[i], 0, 0)
            T = T @ rotation(Z, zeros[i] + self.signs[i] * shown[i]) @ translation(0, 0, self.d[i])
            if i == 2 and self.ground:
                T = T @ rotation(Z, -self.signs[1] * shown[1])
        return T


def _chain(a1, a2, c1, c2, c3, c4, axes=FORWARD, tip=OUT, base=None):
    places = ((0, 0, c1), (a1, 0, 0), (0, 0, c2), (0, 0, a2), (c3, 0, 0), (c4, 0, 0))
    return Chain(places, axes, tip, c1 if base is None else base)


def _table(a1, c2, a2, c3, c4, signs=(1, 1, -1, -1, -1, -1), height=0.0, **more):
    return Table((0, a1, c2, a2, 0, 0), (height, 0, 0, c3, 0, c4), signs, **more)


CHAINS = {
    # ros-industrial/fanuc @ 8fee5e30e535, FANUC-CORPORATION/fanuc_description @ 250d3fa4713b (twice)
    "fanuc_lrmate200id": _chain(0.050, 0.035, 0.330, 0.330, 0.335, 0.080),
    "fanuc_m710ic_50": _chain(0.15, 0.17, 0.565, 0.87, 1.016, 0.175),
    "fanuc_r2000ic_165f": _chain(0.312, 0.225, 0.67, 1.075, 1.28, 0.215),
    # ros-industrial/motoman @ 433be15f6a27
    "yaskawa_gp8": _chain(0.040, 0.040, 0.330, 0.345, 0.340, 0.080),
    "yaskawa_gp25": _chain(0.150, 0.200, 0.505, 0.760, 0.795, 0.100),
    "yaskawa_ma2010": _chain(0.150, 0.200, 0.505, 0.760, 1.082, 0.100),
    # ros-industrial/abb @ 77db19bdb098
    "abb_irb6640_185_280": _chain(
        0.320, 0.2, 0.780, 1.075, 1.392, 0.2, axes=(Z, Y, Y, X, Y, X), tip=rotation(Y, np.pi / 2), base=0.0
    ),
}
TABLES = {
    "fanuc_lrmate200id": _table(0.050, 0.330, 0.035, 0.335, 0.080, ground=True),
    "fanuc_m710ic_50": _table(0.150, 0.870, 0.170, 1.016, 0.175, ground=True),
    "fanuc_r2000ic_165f": _table(0.312, 1.075, 0.225, 1.280, 0.215, ground=True),
    "yaskawa_gp8": _table(0.040, 0.345, 0.040, 0.340, 0.080),
    "yaskawa_gp25": _table(0.150, 0.760, 0.200, 0.795, 0.100),
    "abb_irb6640_185_280": _table(0.320, 1.075, 0.200, 1.392, 0.200, signs=(1,) * 6, height=0.780, turned=np.pi),
}
