"""KRL among the dialects."""

from __future__ import annotations

from zerorev.model.corner import CONTROLLERS
from zerorev.program.dialect import Dialect
from zerorev.program.krl.names import KRL_NAMES
from zerorev.program.krl.read import read_krl, read_starter
from zerorev.program.krl.retract import retract_to_krl
from zerorev.program.krl.source import alike
from zerorev.program.krl.write import krl_modules

__all__ = ["KRL"]

KRL = Dialect(
    CONTROLLERS["krl"],
    ".src",
    KRL_NAMES,
    alike,
    krl_modules,
    read_krl,
    read_starter,
    lambda part: (part.upper(), "(", ")"),
    "$TOOL or $BASE",
    retract_to_krl,
    at_rest=1,
    asks_for_base=True,
)
