"""The letters and numbers of KRL: comments, fixed decimals, KUKA's angles A, B, C, and how the axes of the tool lie."""

from __future__ import annotations

import re
import textwrap
import unicodedata

import numpy as np

from zerorev.model._arrays import Array, transform

__all__ = [
    "T_TCP_TOOL",
    "aggregate",
    "axis_angles",
    "comment",
    "degrees",
    "fixed",
    "frame_angles",
    "in_ascii",
    "settled",
    "turn_about_x",
]

T_TCP_TOOL = transform(np.array([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]]), np.zeros(3))
"""The tool frame as written, in the tcp frame: X along the plunge (X = -Z_tcp), Y = Y_tcp and so Z = X_tcp.

The hole's axis is then the X direction of every pose of a hole, and the spin is a turn about X alone: of KUKA's angles
(A, B, C about Z, Y', X'') only C varies along a hole, for any direction of the hole. The tool as the thesis draws it
does not have this, and passes the singularity of those angles within the range of position 1.
"""

LINE = 100
POLE = 1e-9  # below this length across Z an axis points straight up or down, for the angle A, which is then undefined

MEANT_OTHERWISE = str.maketrans({"%": " percent", "{": "(", "}": ")"})


def comment(text: str, *, first: str = "", longest: int = 0) -> list[str]:
    """Comment lines of a text, wrapped; `first` leads the first line and the others are indented by as much.

    KRL source is ASCII, a comment ends with its line, and `;%{...}` hides text from the operator: what cannot stand is
    replaced.
    """
    plain = clean(text)
    if longest and len(plain) > longest:
        plain = plain[: longest - 3] + "..."
    indents = f"; {first}", "; " + " " * len(first)
    # an id with hyphens stays in one piece
    return textwrap.wrap(
        plain, LINE, initial_indent=indents[0], subsequent_indent=indents[1], break_on_hyphens=False
    ) or [";"]


def clean(text: str) -> str:
    """A text on one line, in printable ASCII, without the characters that mean something in a KRL comment."""
    one_line = " ".join(in_ascii(text).split())
    return re.sub(r"[^ -~]", "?", one_line).translate(MEANT_OTHERWISE)


def in_ascii(text: str) -> str:
    """Accents taken off their letters, everything else beyond ASCII made a question mark."""
    spread = unicodedata.normalize("NFKD", text)
    return "".join(c for c in spread if not unicodedata.combining(c)).encode("ascii", "replace").decode("ascii")


def fixed(value: float, decimals: int = 4) -> str:
    """A number with fixed decimals, never a negative zero."""
    return f"{round(float(value), decimals) + 0.0:.{decimals}f}"


def settled(value: float, decimals: int = 4) -> str:
    """A number above 0 as `fixed`, but one just between two decimals always goes down: its last bits do not decide."""
    return fixed(value - 1e-4 * 10.0**-decimals, decimals)


def degrees(angle: float, decimals: int = 4) -> str:
    """An angle [rad] in degrees, wrapped to (-180, 180] after it is rounded, so that -180 is not written."""
    rounded = round(float(np.rad2deg(angle)), decimals)
    return fixed(rounded - 360.0 * np.ceil((rounded - 180.0) / 360.0), decimals)


def aggregate(kind: str, names: str, values: list[str]) -> str:
    """`{KIND: A value,B value}`, or without a kind `{A value,B value}`."""
    fields = ",".join(f"{name} {value}" for name, value in zip(names.split(), values, strict=True))
    return f"{{{kind}: {fields}}}" if kind else f"{{{fields}}}"


def axis_angles(axis: Array) -> tuple[float, float]:
    """A and B [rad] of every frame whose X points along a unit axis, shape (3,): R = Rz(A) Ry(B) Rx(C).

    Straight up or down (B = -90 or +90 deg) A and C turn about the same line: A is then 0 by choice, C takes it all.
    """
    across = float(np.hypot(axis[0], axis[1]))
    A = float(np.arctan2(axis[1], axis[0])) if across > POLE else 0.0
    return A, float(np.arctan2(-axis[2], across))


def turn_about_x(R: Array, A: float, B: float) -> float:
    """C [rad] of a rotation, shape (3, 3), for given A and B [rad]; well conditioned for every direction of X."""
    y = np.array([-np.sin(A), np.cos(A), 0.0])
    z = np.array([np.cos(A) * np.sin(B), np.sin(A) * np.sin(B), np.cos(B)])
    return float(np.arctan2(R[:, 1] @ z, R[:, 1] @ y))


def frame_angles(R: Array) -> tuple[float, float, float]:
    """A, B, C [rad] of a rotation, shape (3, 3)."""
    A, B = axis_angles(R[:, 0])
    return A, B, turn_about_x(R, A, B)
