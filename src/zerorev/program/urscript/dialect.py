"""URScript among the dialects."""

from __future__ import annotations

from zerorev.model.corner import CONTROLLERS
from zerorev.program.dialect import Dialect
from zerorev.program.urscript.examine import examine, most_holes
from zerorev.program.urscript.names import URSCRIPT_NAMES
from zerorev.program.urscript.read import read_starter, read_urscript
from zerorev.program.urscript.retract import retract_to_urscript
from zerorev.program.urscript.source import alike
from zerorev.program.urscript.write import urscript_files

__all__ = ["URSCRIPT"]

URSCRIPT = Dialect(
    CONTROLLERS["urscript"],
    ".script",
    URSCRIPT_NAMES,
    alike,
    urscript_files,
    read_urscript,
    read_starter,
    lambda part: (part, "(", ")"),
    "set_tcp or part",
    retract_to_urscript,
    examine,
    most_holes,
)
