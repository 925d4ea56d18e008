"""Small helpers by which the nouns check and hold their arrays."""

from __future__ import annotations

from typing import TypeAlias

import numpy as np
import numpy.typing as npt

from zerorev.errors import InputError

Array: TypeAlias = npt.NDArray[np.float64]

UNIT_TOLERANCE = 4e-12  # more than the rounding in a plan file can change a unit vector's length by


def finite(value: npt.ArrayLike, shape: tuple[int, ...], name: str) -> Array:
    """Return `value` as a fresh float array of the given shape.

    Raises:
        InputError: the shape differs, or an entry is not a finite number.
    """
    accepted = f"{' x '.join(map(str, shape))} finite numbers"
    try:
        array = np.array(value, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise InputError("not numbers", where=name, accepted=accepted) from error
    if array.shape != shape:
        raise InputError(f"has shape {array.shape}", where=name, accepted=accepted)
    if not np.isfinite(array).all():
        raise InputError("NaN or infinite", where=name, accepted=accepted)
    return array


def unit(value: npt.ArrayLike, name: str) -> Array:
    """Return the 3-vector `value` scaled to length one; one that is so already stays as it is, digit for digit.

    Raises:
        InputError: not three finite numbers, or all of them zero.
    """
    vector = finite(value, (3,), name)
    greatest = float(np.abs(vector).max())
    if greatest == 0:
        raise InputError("the zero vector has no direction", where=name, accepted="a vector of any length above 0")
    # by a power of two, which changes no digit, so that no square is too great or too small for a number
    near_one = np.ldexp(vector, -int(np.frexp(greatest)[1]))
    length = float(np.linalg.norm(vector)) if greatest < 2 else np.inf
    return vector if abs(length - 1) < UNIT_TOLERANCE else near_one / float(np.linalg.norm(near_one))


def rotation_rpy(roll: float, pitch: float, yaw: float) -> Array:
    """R = Rz(yaw) Ry(pitch) Rx(roll), angles [rad], shape (3, 3) (conventions: rpy)."""
    cr, sr, cp, sp, cy, sy = np.cos(roll), np.sin(roll), np.cos(pitch), np.sin(pitch), np.cos(yaw), np.sin(yaw)
    return np.array(
        [
            [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
            [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
            [-sp, cp * sr, cp * cr],
        ]
    )


def rpy_of(R: Array) -> tuple[float, float, float]:
    """Roll, pitch, yaw [rad] of R = Rz(yaw) Ry(pitch) Rx(roll); at pitch = +-90 deg the yaw is set to 0."""
    pitch = float(np.arctan2(-R[2, 0], np.hypot(R[0, 0], R[1, 0])))
    if np.hypot(R[0, 0], R[1, 0]) < 1e-12:
        return float(np.arctan2(-R[1, 2], R[1, 1])), pitch, 0.0
    return float(np.arctan2(R[2, 1], R[2, 2])), pitch, float(np.arctan2(R[1, 0], R[0, 0]))


def transform(R: Array, p: Array) -> Array:
    """Homogeneous transform, shape (4, 4), of a rotation (3, 3) and a translation (3,) [m]."""
    T = np.eye(4)
    T[:3, :3] = R
    T[:3, 3] = p
    return T


def is_rigid(T: Array) -> bool:
    """Whether T, shape (4, 4), is a rotation and a translation."""
    R = T[:3, :3]
    orthonormal = np.allclose(R @ R.T, np.eye(3), atol=1e-9) and np.linalg.det(R) > 0
    return bool(orthonormal and np.array_equal(T[3], [0.0, 0.0, 0.0, 1.0]))
