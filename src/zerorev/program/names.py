"""Names of programs and of holes: made of any text, and no two texts get the same one.

A name that can stand as it is stays as it is. Where something is cut, replaced or put before it, a short digest of the
whole text follows. Controllers do not tell capitals from small letters, nor does Windows: two texts that differ in
nothing else get names that do so, too.
"""

from __future__ import annotations

import base64
import hashlib
import re
from dataclasses import dataclass, field

from zerorev.program.letters import Comments, in_ascii

__all__ = ["LONGEST_ID", "WINDOWS", "Names", "digest", "label"]

LONGEST_ID = 60  # characters of a hole's id in a comment
DIGEST = 6  # characters, of 32 letters and digits: two of a thousand texts share one in one case of two thousand
WINDOWS = frozenset(
    ["AUX", "CLOCK$", "CON", "CONIN$", "CONOUT$", "NUL", "PRN"]
    + [f"{port}{n}" for port in ("COM", "LPT") for n in range(10)]
)
"""Devices: no file can be called so."""


@dataclass(frozen=True)
class Names:
    """What a language accepts as the name of a program: letters, digits and `_`, a letter first.

    Attributes:
        longest: characters, at most.
        reserved: what it must not be called, in capitals.
        prefix: before a text that does not begin with a letter, or that is reserved.
        capitals: whether names are written in capitals.
    """

    longest: int
    reserved: frozenset[str] = field(default=WINDOWS)
    prefix: str = "drill_"
    capitals: bool = False

    def fits(self, name: str) -> bool:
        """Whether a text can stand as it is."""
        good = re.fullmatch(rf"[A-Za-z][A-Za-z0-9_]{{0,{self.longest - 1}}}", name) is not None
        return good and name.upper() not in self.reserved and (not self.capitals or name == name.upper())

    def of(self, text: str) -> str:
        """A name made of any text.

        Args:
            text: kept as it is where it is such a name, and not reserved; else a digest of it is at the end.
        """
        if self.fits(text):
            return text
        if self.capitals and self.fits(text.upper()):
            return text.upper()  # two texts that differ in capitals alone are one name to the controller
        kept = re.sub(r"[^A-Za-z0-9_]+", "_", in_ascii(text)).strip("_")
        if not kept or not kept[0].isalpha() or kept.upper() in self.reserved:
            kept = f"{self.prefix}{kept}"
        name = f"{kept[: self.longest - DIGEST - 1].rstrip('_')}_{digest(text)}"
        return name.upper() if self.capitals else name

    def part(self, name: str, number: int) -> str:
        """What the part of a program is called, which the program calls: `NAME_1` and so on.

        Args:
            name: of the program.
            number: of the part, from 1.
        """
        end = f"_{number}"
        if len(name) + len(end) <= self.longest:
            return name + end
        own, room = digest(name).upper() if self.capitals else digest(name), self.longest - len(end)
        if room <= DIGEST + 1:  # for a letter and as much of the digest as there is room
            return f"{name[0]}{own[: room - 1]}{end}"
        return f"{name[: room - DIGEST - 1].rstrip('_')}_{own}{end}"


def label(hole_id: str, comments: Comments) -> str:
    """What a comment calls a hole: its id, or where that has to be cut or replaced its two ends and a digest."""
    plain = comments.clean(hole_id)
    if plain == hole_id and len(plain) <= LONGEST_ID:
        return plain
    rest = LONGEST_ID - DIGEST - 2
    if len(plain) > rest:  # ids from CAD differ at the end
        plain = f"{plain[: rest // 2 - 3].rstrip()}...{plain[-(rest // 2) :].lstrip()}"
    return f"{plain} ~{digest(hole_id)}"


def digest(text: str) -> str:
    """Six small letters and digits that differ where the texts do."""
    code = hashlib.sha256(text.encode("utf-8", "surrogatepass")).digest()
    return base64.b32encode(code).decode().lower()[:DIGEST]
