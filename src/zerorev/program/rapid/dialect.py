"""RAPID among the dialects."""

from __future__ import annotations

from zerorev.model.corner import CONTROLLERS
from zerorev.program.dialect import Dialect
from zerorev.program.rapid.examine import examine
from zerorev.program.rapid.names import RAPID_NAMES, procedure
from zerorev.program.rapid.read import read_rapid, read_starter
from zerorev.program.rapid.retract import retract_to_rapid
from zerorev.program.rapid.source import alike
from zerorev.program.rapid.write import most_holes, rapid_modules

__all__ = ["RAPID"]

RAPID = Dialect(
    CONTROLLERS["rapid"],
    ".mod",
    RAPID_NAMES,
    alike,
    rapid_modules,
    read_rapid,
    read_starter,
    lambda part: (procedure(part).upper(), ";"),
    "the tool or the work object",
    retract_to_rapid,
    examine,
    most_holes,
)
