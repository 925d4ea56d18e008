"""A small URScript reader: runs a file the way a controller would, and says which motions it commands.

It shares nothing with the writer. It is strict: a statement that it does not know is an error, so that a golden program
cannot come to hold one that nobody has thought about. Metres and radians, as in the file.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from fractions import Fraction

import numpy as np
from scipy.spatial.transform import Rotation

NUMBER = r"-?\d+\.\d+"
SIX = rf"{NUMBER}(?:, {NUMBER}){{5}}"
FORMS = {
    "tool": rf"set_tcp\(p\[({SIX})\]\)",
    "payload": rf"set_payload\(({NUMBER}), \[({NUMBER}, {NUMBER}, {NUMBER})\]\)",
    "part": rf"local part = p\[({SIX})\]",
    "go": rf"movej\(\[({SIX})\], a=({NUMBER}), v=({NUMBER})\)",
    "straight": rf"movel\(pose_trans\(part, p\[({SIX})\]\), a=({NUMBER}), v=({NUMBER})(?:, r=({NUMBER}))?\)",
    "jointly": rf"movej\(\[({SIX})\], t=({NUMBER})(?:, r=({NUMBER}))?\)",
    "call": r"([A-Za-z]\w*\((?:[^()\[\]#]*)\))",
}


class ScriptError(Exception):
    """A line that a controller would refuse, or that no drilling program should hold."""


@dataclass(frozen=True)
class Move:
    """One motion.

    Attributes:
        kind: go, straight or jointly.
        joints: [rad]; None of a straight one.
        T_base_tool: in the controller's base, of a straight one.
        feed: [m/s] or None.
        time: [s] or None.
        radius: of the blend at its end [m]; 0 is a stop.
        line: from 1.
    """

    kind: str
    joints: np.ndarray | None
    T_base_tool: np.ndarray | None
    feed: float | None
    time: float | None
    radius: float
    line: int


@dataclass
class Script:
    name: str = ""
    T_flange_tool: np.ndarray | None = None
    T_base_part: np.ndarray | None = None
    payload: tuple[float, ...] | None = None
    moves: list[Move] = field(default_factory=list)
    calls: list[tuple[int, str]] = field(default_factory=list)  # after how many moves, and what
    comments: list[str] = field(default_factory=list)

    def holes(self) -> list[list[Move]]:
        """One list per hole: each begins with the last movej to a stop before its moves."""
        holes: list[list[Move]] = []
        for move, after in zip(self.moves, [*self.moves[1:], None], strict=True):
            if move.kind == "go":
                if after is None or after.kind == "go":
                    continue
                holes.append([])
            holes[-1].append(move)
        return holes


def pose(numbers):
    """Of six numbers [m], [rad]."""
    T = np.eye(4)
    T[:3, 3], T[:3, :3] = numbers[:3], Rotation.from_rotvec(numbers[3:]).as_matrix()
    return T


def six(text):
    return np.array([float(number) for number in text.split(", ")])


def read(text: str) -> Script:
    if not text.isascii() or "\r" in text or "\t" in text or not text.endswith("end\n"):
        raise ScriptError("characters that no script should have, or no end")
    script, lines = Script(), text.splitlines()
    for number, whole in enumerate(lines, start=1):
        line, _, remark = whole.partition("#")
        if remark:
            script.comments.append(remark.strip())
        if not (line := line.rstrip()):
            continue
        if match := re.fullmatch(r"def ([A-Za-z]\w{0,31})\(\):", line):
            if script.name:
                raise ScriptError(f"line {number}: a second function")
            script.name = match[1]
        elif line == "end":
            if number != len(lines):
                raise ScriptError(f"line {number}: after it there is something")
        else:
            take(script, line, number)
    return script


def take(script, line, number):
    if not line.startswith("  ") or not script.name:
        raise ScriptError(f"line {number}: {line}")
    fits = ((name, re.fullmatch(form, line[2:])) for name, form in FORMS.items())
    name, match = next(((name, match) for name, match in fits if match), ("", None))
    if match is None:
        raise ScriptError(f"line {number}: {line}")
    if name in ("tool", "part", "payload") and script.moves:
        raise ScriptError(f"line {number}: {name} after a move")
    if name == "tool":
        script.T_flange_tool = pose(six(match[1]))
    elif name == "part":
        script.T_base_part = pose(six(match[1]))
    elif name == "payload":
        script.payload = (float(match[1]), *(float(each) for each in match[2].split(", ")))
        assert script.payload[0] > 0
    elif name == "call":
        if script.moves and script.moves[-1].radius:
            raise ScriptError(f"line {number}: called between blended moves")
        script.calls.append((len(script.moves), match[1]))
    else:
        if script.T_flange_tool is None or script.T_base_part is None:
            raise ScriptError(f"line {number}: a move before its frames")
        script.moves.append(move(script, name, match, number))


def move(script, name, match, number):
    if name == "straight":
        T = script.T_base_part @ pose(six(match[1]))
        return Move(name, None, T, float(match[3]), None, float(match[4] or 0), number)
    if name == "go":
        return Move(name, six(match[1]), None, None, None, 0.0, number)
    return Move(name, six(match[1]), None, None, float(match[2]), float(match[3] or 0), number)


def commands(text: str) -> list[tuple[str | Fraction, ...]]:
    """What a text tells a controller, character by character: words, signs and exact numbers, line by line.

    A text with a character that is not certain to be read so by every controller is an error.
    """
    found = []
    for line in text.replace("\r\n", "\n").split("\n"):
        if re.search(r"[^\t -~]", line):
            raise ScriptError("an odd character")
        code = line.split("#")[0]
        parts = re.findall(r"[A-Za-z_]\w*\[?|-?\d+(?:\.\d+)?|[^\sA-Za-z_]", code)
        if "".join(parts) != re.sub(r"\s", "", code):
            raise ScriptError(f"'{code}'")
        if parts:
            found.append(tuple(Fraction(each) if re.fullmatch(r"-?\d+(\.\d+)?", each) else each for each in parts))
    return found
