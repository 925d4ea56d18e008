"""A small reader of TP listings: which motions they command, with the frames and the position of each.

It shares nothing with the reader of the product, nor with the writer. Lengths in mm, angles in deg, as in the file.
"""

from __future__ import annotations

import re
from typing import NamedTuple

import numpy as np
from scipy.spatial.transform import Rotation

__all__ = ["Motion", "motions", "remarks", "statements"]


class Motion(NamedTuple):
    """One motion.

    Attributes:
        kind: J or L.
        speed: number and unit.
        end: FINE or CNT100.
        frames: numbers of user and tool frame.
        config: what stands after CONFIG, or an empty string.
        values: X, Y, Z, W, P, R or J1 to J6.
    """

    kind: str
    speed: tuple[int, str]
    end: str
    frames: tuple[int, int]
    config: str
    values: np.ndarray

    @property
    def pose(self):
        """Of a position that is one, shape (4, 4), [mm]."""
        T = np.eye(4)
        T[:3, :3] = Rotation.from_euler("xyz", self.values[3:], degrees=True).as_matrix()
        T[:3, 3] = self.values[:3]
        return T

    def turning_joints(self, coupled):
        """The joints of a position in joint values, J3 against link 2 [rad]."""
        joints = self.values.copy()
        joints[2] += coupled * joints[1]
        return np.deg2rad(joints)


def motions(text: str) -> list[Motion]:
    """Every motion of a file, in order."""
    listing, _, positions = text.partition("/POS\n")
    known = {int(number): body for number, body in re.findall(r"P\[(\d+)\]\{(.*?)\};", positions, re.DOTALL)}
    found = []
    for kind, number, value, unit, end in re.findall(
        r"^ *\d+:([JL]) P\[(\d+)\] (\d+)(\S+) (\S+) +;$", listing, re.MULTILINE
    ):
        body = known[int(number)]
        frames = re.search(r"UF : (\d+), UT : (\d+),", body)
        config = re.search(r"CONFIG : '(.*?)'", body)
        values = np.array([float(value) for value in re.findall(r"= *(-?[\d.]+) +(?:mm|deg)", body)])
        assert values.shape == (6,), body
        found.append(
            Motion(kind, (int(value), unit), end, (int(frames[1]), int(frames[2])), config[1] if config else "", values)
        )
    assert len(found) == len(known)
    return found


def statements(text: str) -> list[str]:
    """What is neither a comment nor a motion."""
    lines = re.findall(r"^ *\d+:  (.*?) ?;$", text, re.MULTILINE)
    return [line for line in lines if not line.startswith("!")]


def remarks(text: str) -> list[str]:
    """The comments, without their sign."""
    return re.findall(r"^ *\d+:  !(.*?) ?;$", text, re.MULTILINE)
