"""A listing: numbered lines, and behind them the positions to which they refer."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field

import numpy as np

from zerorev.model._arrays import Array, rpy_of
from zerorev.model.robot import Robot
from zerorev.program.dialect import Z_ALONG_PLUNGE
from zerorev.program.letters import degrees, fixed
from zerorev.program.neutral import Point, Program
from zerorev.program.tp.text import DECIMALS, Speed, configuration

__all__ = ["Frames", "Listing", "lengths_and_angles"]


@dataclass(frozen=True)
class Frames:
    """In which the points of a program are given.

    Attributes:
        robot: the arm.
        T_from_part: the part frame in the frame of the points, shape (4, 4), translation [m].
        user: number of the user frame; 0: the world frame.
        tool: number of the tool frame.
    """

    robot: Robot
    T_from_part: Array
    user: int
    tool: int

    @classmethod
    def of(cls, program: Program) -> Frames:
        """Those of a program whose tool has a number."""
        settings = program.settings
        assert settings.tool_number is not None
        if settings.base_number is not None:
            return cls(program.robot, np.eye(4), settings.base_number, settings.tool_number)
        return cls(program.robot, part_in_world(program), 0, settings.tool_number)

    def joints(self, joints: Array) -> str:
        """What stands between the brackets of a position in joint values.

        Args:
            joints: that turn [rad], shape (6,).
        """
        values = [fixed(angle, DECIMALS).rjust(10) for angle in np.rad2deg(self.robot.shown(joints))]
        named = [f"J{number}={value} deg" for number, value in enumerate(values, start=1)]
        return self._between("", named)

    def pose(self, point: Point) -> str:
        """What stands between the brackets of a position as a pose of the tool, whose Z is along the plunge."""
        numbers = lengths_and_angles(self.T_from_part @ point.T_part_tcp @ Z_ALONG_PLUNGE)
        named = [
            f"{name} ={value:>10} {unit}"
            for name, value, unit in zip("XYZWPR", numbers, 3 * [" mm"] + 3 * ["deg"], strict=True)
        ]
        return self._between(f"\t\tCONFIG : '{configuration(self.robot, point.joints)}',", named)

    def _between(self, posture: str, named: list[str]) -> str:
        first, second = ",\t".join(named[:3]), ",\t".join(named[3:])
        return f"   GP1:\n\tUF : {self.user}, UT : {self.tool},{posture or chr(9)}\n\t{first},\n\t{second}"


@dataclass
class Listing:
    """What has been written so far.

    Attributes:
        frames: in which its points are.
        lines: numbered.
        positions: as they are moved to.
    """

    frames: Frames
    lines: list[str] = field(default_factory=list)
    positions: list[str] = field(default_factory=list)

    def remarks(self, texts: Iterable[str]) -> None:
        """Comments, one a line, each with its sign."""
        for text in texts:
            self.say(f"{text.rstrip()} ")

    def say(self, statement: str) -> None:
        """A statement that is not a motion."""
        self.lines.append(f"{len(self.lines) + 1:4d}:  {statement};")

    def move(self, kind: str, position: str, speed: Speed, *, stops: bool) -> None:
        """A motion to a position that has not been moved to.

        Args:
            kind: J or L.
            position: what stands between its brackets.
            speed: of the motion.
            stops: whether the robot stands at its end.
        """
        self.positions.append(position)
        termination = "FINE" if stops else "CNT100"
        self.lines.append(f"{len(self.lines) + 1:4d}:{kind} P[{len(self.positions)}] {speed} {termination}    ;")

    def text(self, name: str, comment: str) -> str:
        """The file of a program.

        Args:
            name: of the program.
            comment: of at most 16 characters.
        """
        head = [f"/PROG  {name}", "/ATTR", f'COMMENT\t\t= "{comment}";', "DEFAULT_GROUP\t= 1,*,*,*,*;", "/MN"]
        positions = [f"P[{number}]{{\n{text}\n}};" for number, text in enumerate(self.positions, start=1)]
        return "\n".join([*head, *self.lines, "/POS", *positions, "/END", ""])


def part_in_world(program: Program) -> Array:
    """The part frame as the controller counts, shape (4, 4), translation [m]."""
    return np.asarray(np.linalg.inv(program.robot.T_root_base) @ program.T_base_part)


def lengths_and_angles(T: Array) -> tuple[str, ...]:
    """X, Y, Z [mm] and W, P, R [deg] of a pose, shape (4, 4), translation [m]: R = Rz(R) Ry(P) Rx(W)."""
    lengths = (fixed(length * 1e3, DECIMALS) for length in T[:3, 3])
    return (*lengths, *(degrees(angle, DECIMALS) for angle in rpy_of(T[:3, :3])))
