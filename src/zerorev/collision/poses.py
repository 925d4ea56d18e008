"""How near single poses of the twist plane come to what stands around the arm, and to the arm itself."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import numpy.typing as npt

from zerorev.collision.arms import Setting
from zerorev.kernels import bodies as kernels
from zerorev.model._arrays import Array
from zerorev.motion.drilling import Drilling

__all__ = ["poses_keep", "poses_nearest"]

Mask = npt.NDArray[np.bool_]


def poses_keep(setting: Setting, drilling: Drilling, branch: int, standoff: Array, psi: Array) -> Mask:
    """Whether poses keep the clearance, shape (n,).

    Args:
        setting: the bodies and what stands around.
        drilling: robot, tool and hole.
        branch: 0..7.
        standoff: [m], shape (n,).
        psi: [rad], shape (n,).
    """
    out = np.empty(standoff.size, dtype=np.bool_)
    _ask(kernels.poses_keep, setting, drilling, branch, standoff, psi, setting.drilled, out)
    return out


def poses_nearest(
    setting: Setting, drilling: Drilling, branch: int, standoff: Array, psi: Array
) -> tuple[Array, Array, Array]:
    """What of the arm is nearest to what stands around it at poses; NaN out of reach.

    Args:
        setting: the bodies and what stands around.
        drilling: robot, tool and hole.
        branch: 0..7.
        standoff: [m], shape (n,).
        psi: [rad], shape (n,).

    Returns:
        the distance [m], shape (n,); the number of the pair, shape (n,); the nearest points of both, on the line of a
        capsule, or in a box or a triangle: base frame [m], shape (n, 2, 3).
    """
    out = np.empty((standoff.size, 8))
    _ask(kernels.poses_nearest, setting, drilling, branch, standoff, psi, setting.drilled & setting.against, out)
    return out[:, 0], out[:, 1], out[:, 2:].reshape(-1, 2, 3)


def _ask(
    kernel: Callable[..., None],
    setting: Setting,
    drilling: Drilling,
    branch: int,
    standoff: Array,
    psi: Array,
    pairs: Mask,
    out: Array | Mask,
) -> None:
    """Ask a kernel of poses, one answer each."""
    kernel(
        drilling.robot.arm, drilling.plane, branch, np.ascontiguousarray(standoff), np.ascontiguousarray(psi),
        setting.arms, pairs, setting.desk(), out,
    )  # fmt: skip
