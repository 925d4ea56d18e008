"""A small KRL reader: runs a .src file the way a controller's interpreter would, and says which motions it commands.

It shares nothing with the writer. It is strict: a statement that it does not know is an error, so that a golden program
cannot come to hold one that nobody has thought about. Lengths in mm, angles in deg, as in the file.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from fractions import Fraction

import numpy as np

FIELDS = {"FRAME": "X Y Z A B C", "AXIS": "A1 A2 A3 A4 A5 A6"}
OPTIONAL = ("$ACT_TOOL", "$ACT_BASE", "$LOAD")
LATER = {"PTP": ("$VEL.CP", "$APO.CDIS"), "LIN": ("$APO.CDIS",)}
KEPT = ("$VEL.CP", "$VEL.ORI1", "$VEL.ORI2", "$APO.CDIS", "$IPO_MODE", "$ORI_TYPE", "$ADVANCE", "$TOOL", "$BASE")


class KrlError(Exception):
    """A line that a controller would refuse, or that no drilling program should hold."""


@dataclass(frozen=True)
class Move:
    """One motion, with the state of the controller's variables in which it was commanded."""

    kind: str  # PTP or LIN
    values: dict[str, float]
    blended: bool  # C_DIS
    state: dict[str, object]
    line: int

    @property
    def axes(self):
        return np.array([self.values[f"A{i}"] for i in range(1, 7)])

    @property
    def T_base_tool(self):
        """Pose of the tool in the robot's own base: $BASE times the target."""
        return self.state["$BASE"] @ self.T_part_tool

    @property
    def T_part_tool(self):
        return frame(self.values)


@dataclass
class KrlProgram:
    name: str
    moves: list[Move] = field(default_factory=list)
    comments: list[str] = field(default_factory=list)
    folds: list[str] = field(default_factory=list)
    statements: list[str] = field(default_factory=list)  # in order, without comments
    header: list[str] = field(default_factory=list)
    calls: list[tuple[int, str]] = field(default_factory=list)  # after how many moves, and what

    def holes(self) -> list[list[Move]]:
        """The motions, one list per hole: each begins with the last PTP that leads to it."""
        holes: list[list[Move]] = []
        for move, after in zip(self.moves, [*self.moves[1:], None], strict=True):
            if move.kind == "PTP":
                if after is None or after.kind == "PTP":
                    continue  # on the way
                holes.append([])
            holes[-1].append(move)
        return holes


def frame(values):
    """KUKA: R = Rz(A) Ry(B) Rx(C); shape (4, 4), translation [mm]."""
    (ca, cb, cc), (sa, sb, sc) = (f(np.deg2rad([values[n] for n in "ABC"])) for f in (np.cos, np.sin))
    Rz = np.array([[ca, -sa, 0], [sa, ca, 0], [0, 0, 1]])
    Ry = np.array([[cb, 0, sb], [0, 1, 0], [-sb, 0, cb]])
    Rx = np.array([[1, 0, 0], [0, cc, -sc], [0, sc, cc]])
    T = np.eye(4)
    T[:3, :3], T[:3, 3] = Rz @ Ry @ Rx, [values[n] for n in "XYZ"]
    return T


def aggregate(text, kind, line):
    """Values of `{KIND: A 1.0,B 2.0}`; every field of the kind must be there, once, and no other."""
    match = re.fullmatch(rf"\{{(?:{kind}: )?([^{{}}:]*)\}}", text)
    if not match:
        raise KrlError(f"line {line}: not a {kind}: {text}")
    pairs = [part.split() for part in match.group(1).split(",")]
    if [pair[0] for pair in pairs] != FIELDS[kind].split():
        raise KrlError(f"line {line}: fields of {text}")
    for _, number in pairs:
        if not re.fullmatch(r"-?\d+\.\d+", number) or (float(number) == 0 and number.startswith("-")):
            raise KrlError(f"line {line}: number {number}")
    return {name: float(number) for name, number in pairs}


def read(text: str) -> KrlProgram:
    if not text.isascii() or "\r" in text or "\t" in text:
        raise KrlError("characters that no KRL source should have")
    program, state, declared, ended = None, {}, False, False
    header, resting = [], False
    for number, whole in enumerate(text.splitlines(), start=1):
        line, _, remark = whole.partition(";")
        line = line.strip()
        if remark.startswith("FOLD"):
            program.folds.append(remark[4:].strip())
        elif remark and not remark.startswith("ENDFOLD"):
            program.comments.append(remark.strip())
        if not line:
            continue
        if ended:
            raise KrlError(f"line {number}: after END")
        if line.startswith("&"):
            if program:
                raise KrlError(f"line {number}: header after DEF")
            header.append(line)
            continue
        if match := re.fullmatch(r"DEF ([A-Za-z][A-Za-z0-9_]{0,23}) \( \)", line):
            program = KrlProgram(match.group(1), header=header)
            continue
        program.statements.append(line)
        if line.startswith(("EXT ", "DECL ")):
            if declared:
                raise KrlError(f"line {number}: a declaration after a statement")
            continue
        declared, waited, resting = True, resting, False
        if line == "WAIT SEC 0.0":
            if program.moves and program.moves[-1].blended:
                raise KrlError(f"line {number}: a blend becomes a stop")
            resting = True
        elif re.fullmatch(r"[A-Za-z]\w*\((?: |[^(){}$;]+)\)", line) and not line.startswith("BAS"):
            if not waited:
                raise KrlError(f"line {number}: called while the robot may move")
            program.calls.append((len(program.moves), line))
            resting = True
        elif line == "END":
            ended = True
        elif re.fullmatch(r"BAS \(#(INITMOV|VEL_PTP|ACC_PTP),\d+ \)", line):
            if "INITMOV" in line and state:
                raise KrlError(f"line {number}: INITMOV would undo what was set before it")
        elif match := re.fullmatch(r"(\$[A-Z_]+(?:\.[A-Z0-9]+)?)=(.*)", line):
            state = {**state, match.group(1): value(match.group(1), match.group(2).strip(), number)}
        elif match := re.fullmatch(r"(PTP|LIN) (\{.*\})( C_DIS)?", line):
            kind, target, blended = match.groups()
            outer = {}
            if match2 := re.fullmatch(r"\{E6AXIS: (.*?)((?:,E[1-6] -?\d+\.\d+)+)\}", target):
                target, outer = f"{{AXIS: {match2[1]}}}", dict(part.split() for part in match2[2][1:].split(","))
            if missing := [name for name in KEPT if name not in state and name not in LATER[kind]]:
                raise KrlError(f"line {number}: {missing} not set")
            if kind == "PTP" and blended:
                raise KrlError(f"line {number}: C_DIS at a PTP")
            if blended and not state.get("$APO.CDIS", 0.0) > 0:
                raise KrlError(f"line {number}: C_DIS without a radius")
            values = aggregate(target, "AXIS" if kind == "PTP" else "FRAME", number)
            values |= {name: float(at) for name, at in outer.items()}
            program.moves.append(Move(kind, values, bool(blended), state, number))
        else:
            raise KrlError(f"line {number}: {line}")
    if not ended:
        raise KrlError("no END")
    return program


def commands(text: str) -> list[tuple[str | Fraction, ...]]:
    """What a text tells a controller, character by character: words in capitals, signs and exact numbers, line by line.

    A text with a character that is not certain to be read so by every controller is an error.
    """
    found: list[tuple[str | Fraction, ...]] = []
    line: list[str] = []
    word, remark, header = "", False, False
    for at, character in enumerate(text + "\n"):
        if character == "\r" and text[at + 1 : at + 2] == "\n":
            continue
        if character == "\n":
            line += [word] if word else []
            if line:
                found.append(tuple(exact(each) for each in line))
            line, word, remark, header = [], "", False, False
        elif not (character == "\t" or " " <= character <= "~"):
            raise KrlError(f"character {ord(character)}")
        elif remark or header:
            continue
        elif character == ";":
            remark = True
        elif character == "&" and not found and not line and not word:
            header = True
        elif character in " \t{}(),:=":
            line += ([word] if word else []) + ([character] if character.strip() else [])
            word = ""
        else:
            word += character.upper()
    return found


def exact(word: str) -> str | Fraction:
    return Fraction(word) if word.lstrip("-").replace(".", "", 1).isdigit() else word


def value(name, text, line):
    if name not in KEPT + OPTIONAL:
        raise KrlError(f"line {line}: {name}")
    if name == "$LOAD":
        return text
    if name == "$BASE" and not text.startswith("{"):
        variable, _, text = text.partition(":")
        if not re.fullmatch(r"\$?[A-Z_]+", variable):
            raise KrlError(f"line {line}: {variable}")
    if name in ("$TOOL", "$BASE"):
        return frame(aggregate(text, "FRAME", line))
    if text.startswith("#"):
        return text
    return float(text)
