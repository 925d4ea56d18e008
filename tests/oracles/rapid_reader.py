"""A small RAPID reader: what a module of ours tells an ABB controller to do. It shares nothing with the product.

It is strict: a statement that it does not know is an error. Lengths in mm, angles in deg, as in the file.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from fractions import Fraction

import numpy as np
import py_opw_kinematics as opw
from scipy.spatial.transform import Rotation

__all__ = ["Arm", "Module", "Move", "RapidError", "commands", "joints_of_hole", "read"]

N = r"-?\d+(?:\.\d+)?"
SET = ("ConfL\\Off", "ConfJ\\On", "SingArea\\Off", "PDispOff", "EOffsOff", "AccSet 100,100", "VelSet 100,5000")


class RapidError(Exception):
    """A line that a controller would refuse, or that no drilling program should hold."""


@dataclass(frozen=True)
class Move:
    """One motion: `joints` [deg] or a pose `T_part_tool`; `time` [s] or None; `speed` and `zone` as declared."""

    kind: str
    joints: np.ndarray | None
    T_part_tool: np.ndarray | None
    conf: tuple[int, ...] | None
    external: tuple[str, ...]
    speed: list[float]
    time: float | None
    zone: list[float] | None  # None: fine
    line: int


@dataclass
class Module:
    name: str
    tool: np.ndarray = None
    load: list = None
    part: np.ndarray = None
    moves: list[Move] = field(default_factory=list)
    calls: list[tuple[int, str]] = field(default_factory=list)  # after how many moves, and what
    comments: list[str] = field(default_factory=list)
    zones: dict[str, list[float]] = field(default_factory=dict)
    speeds: dict[str, list[float]] = field(default_factory=dict)

    def holes(self):
        """The motions, one list per hole: each begins with the last untimed MoveAbsJ before its moves."""
        holes = []
        for move, after in zip(self.moves, [*self.moves[1:], None], strict=True):
            if is_way(move):
                if after is None or is_way(after):
                    continue
                holes.append([])
            holes[-1].append(move)
        return holes


def is_way(move):
    return move.kind == "MoveAbsJ" and move.time is None


def frame(numbers):
    """x, y, z and a unit quaternion, scalar first; a controller refuses one that is not of length 1."""
    q = np.array(numbers[3:])
    if abs(np.linalg.norm(q) - 1) > 1e-6:
        raise RapidError(f"a quaternion of length {np.linalg.norm(q)}")
    T = np.eye(4)
    T[:3, :3], T[:3, 3] = Rotation.from_quat(np.roll(q, -1)).as_matrix(), numbers[:3]
    return T


def numbers_of(text):
    found = [part for part in re.split(r"[\[\],]+", text) if part]
    for part in found:
        if not re.fullmatch(N, part) or (float(part) == 0 and part.startswith("-")):
            raise RapidError(f"number {part}")
    return [float(part) for part in found]


def read(text: str) -> Module:
    if not text.isascii() or "\r" in text or "\t" in text:
        raise RapidError("characters that no RAPID source should have")
    module, within, settings, closed = None, False, [], False
    for number, whole in enumerate(text.splitlines(), start=1):
        line = whole.strip()
        if line.startswith("!"):
            module.comments.append(line[1:].strip())
            continue
        if "!" in re.sub('"[^"]*"', "", line):
            raise RapidError(f"line {number}: a comment behind a statement")
        if not line:
            continue
        if match := re.fullmatch(r"MODULE ([A-Za-z]\w{0,31})", line):
            module = Module(match[1])
        elif line == f"PROC {module.name}_run()":
            within = True
        elif line == "ENDPROC":
            within, closed = False, True
        elif line == "ENDMODULE":
            if not closed:
                raise RapidError("no procedure")
            return module
        elif not line.endswith(";"):
            raise RapidError(f"line {number}: no semicolon")
        elif within:
            statement(module, line[:-1], number, settings)
        else:
            declare(module, line[:-1])
    raise RapidError("no ENDMODULE")


def declare(module, line):
    names = re.escape(module.name)
    if match := re.fullmatch(rf"PERS tooldata {names}_tool:=\[TRUE,\[(.*?\])\],\[(.*)\]\]", line):
        module.tool, module.load = frame(numbers_of(match[1])), numbers_of(match[2])
        if not (module.load[0] > 0 and any(module.load[1:4])):
            raise RapidError("a load of 0")
    elif match := re.fullmatch(
        rf'PERS wobjdata {names}_part:=\[FALSE,TRUE,"",\[(.*?\])\],\[\[0,0,0\],\[1,0,0,0\]\]\]', line
    ):
        module.part = frame(numbers_of(match[1]))
    elif match := re.fullmatch(r"LOCAL CONST speeddata (\w+):=(\[.*\])", line):
        module.speeds[match[1]] = numbers_of(match[2])
    elif match := re.fullmatch(r"LOCAL CONST zonedata (\w+):=\[FALSE,(.*)\]", line):
        module.zones[match[1]] = numbers_of(match[2])
    else:
        raise RapidError(line)


def statement(module, line, number, settings):
    frames = rf"{module.name}_tool\WObj:={module.name}_part"
    if line in SET:
        if module.moves:
            raise RapidError(f"line {number}: {line} after a move")
        settings.append(line)
        return
    if line == "ConfL\\On":
        settings.append(line)
        return
    if match := re.fullmatch(r"(MoveAbsJ|MoveL) (\[.*\]),(\w+)(?:\\T:=([\d.]+))?,(\w+),(\S+)", line):
        kind, target, speed, time, zone, used = match.groups()
        if used != frames or sorted(settings) != sorted(SET):
            raise RapidError(f"line {number}: {used}, {settings}")
        outer = target[1:-1].rpartition("[")[2][:-1].split(",")
        inner = numbers_of(target[1:-1].rpartition("[")[0])
        if kind == "MoveL":
            joints, T, conf = None, frame(inner[:7]), tuple(int(each) for each in inner[7:])
        else:
            joints, T, conf = np.array(inner), None, None
        if len(outer) != 6 or len(inner) != (11 if T is not None else 6):
            raise RapidError(f"line {number}: {target}")
        module.moves.append(
            Move(
                kind,
                joints,
                T,
                conf,
                tuple(outer),
                module.speeds[speed],
                float(time) if time else None,
                None if zone == "fine" else module.zones[zone],
                number,
            )
        )
        return
    if not re.fullmatch(r"[A-Za-z]\w*(?: [^\\;]+)?", line) or line.startswith(("Move", "Conf")):
        raise RapidError(f"line {number}: {line}")
    if module.moves and module.moves[-1].zone:
        raise RapidError(f"line {number}: called while the robot moves")
    module.calls.append((len(module.moves), line))


class Arm:
    """A robot's joints at poses, by opw_kinematics."""

    def __init__(self, robot):
        arm = robot.arm
        model = opw.KinematicModel(*arm[:7], offsets=arm.offset, flip_axes=tuple(sign < 0 for sign in arm.sign))
        self.arm = opw.Robot(model, degrees=False)

    def forward(self, joints_deg):
        """Flange, shape (4, 4), translation [mm]."""
        T = np.array(self.arm.forward(np.deg2rad(joints_deg)).as_matrix())
        T[:3, 3] *= 1e3
        return T

    def along(self, tips, turns, tool, near):
        """Joints [deg] of poses, each solution nearest to the one before."""
        T = np.tile(np.eye(4), (len(tips), 1, 1))
        T[:, :3, :3], T[:, :3, 3] = turns.as_matrix(), tips
        flange = T @ np.linalg.inv(tool)
        flange[:, :3, 3] *= 1e-3
        found = []
        for eight in np.rad2deg(self.arm.reach(opw.RigidTransform.from_matrix(flange)).joints):
            eight = eight - 360 * np.round((eight - near) / 360)
            near = eight[np.nanargmin(np.abs(eight - near).max(axis=1))]
            found.append(near)
        return np.array(found)


def joints_of_hole(module: Module, hole: list[Move], arm: Arm, samples: int = 50) -> list[np.ndarray]:
    """Joints [deg] along each move of a hole: straight, with an even turn about one axis; or all joints evenly."""
    start, *moves = hole
    joints, T = start.joints, arm.forward(start.joints) @ module.tool
    shares, found = np.arange(samples + 1)[:, None] / samples, []
    for move in moves:
        if move.kind == "MoveAbsJ":
            way = joints + shares * (move.joints - joints)
        else:
            end = module.part @ move.T_part_tool
            whole = (Rotation.from_matrix(end[:3, :3]) * Rotation.from_matrix(T[:3, :3]).inv()).as_rotvec()
            turns = Rotation.from_rotvec(shares * whole) * Rotation.from_matrix(T[:3, :3])
            way = arm.along(T[:3, 3] + shares * (end[:3, 3] - T[:3, 3]), turns, module.tool, joints)
        found.append(way)
        joints = way[-1]
        T = arm.forward(joints) @ module.tool
    return found


def commands(text: str) -> list[tuple[str | Fraction, ...]]:
    """What a text tells a controller: words in capitals, signs and exact numbers, statement by statement."""
    found = []
    for line in text.replace("\r\n", "\n").split("\n"):
        kept = re.match(r'(?:[^"!]|"[^"]*")*', line)[0]
        if any(not (character == "\t" or " " <= character <= "~") for character in line):
            raise RapidError("a character that is not certain to be read")
        words = re.findall(r'"[^"]*"|:=|[\[\](),;\\]|[^ \t:"\[\](),;\\]+|\S', kept)
        if words:
            found.append(tuple(Fraction(word) if re.fullmatch(N, word) else word.upper() for word in words))
    return found
