"""Of which curves of a blend a motion is proven: of as many as can be shown."""

from __future__ import annotations

from dataclasses import replace
from typing import Protocol

from zerorev.model.plan import Certificate
from zerorev.verify.mix import Mixes

__all__ = ["for_the_widest"]


class Proof(Protocol):
    """A proof of a motion with blends."""

    def __call__(self, *, mixes: Mixes | None) -> Certificate:
        """Prove it.

        Args:
            mixes: blends besides the parabola.
        """
        ...


def for_the_widest(proof: Proof, *, blended: bool, curve_known: bool) -> Certificate:
    """A certificate for every curve of the blends that can be shown to do.

    Args:
        proof: of the motion.
        blended: whether there are blends of straight moves.
        curve_known: whether the controller is known to run a parabola; else one that is proven alone decides nothing.
    """
    if not blended:
        return proof(mixes=None)
    found = proof(mixes="any")
    if found.verdict == "certified":
        return replace(found, curve="any")
    plain = proof(mixes=None)
    if plain.verdict != "certified":
        return plain
    found = proof(mixes="one_way")
    if found.verdict == "certified":
        return replace(found, curve="one_way")
    if curve_known:
        return replace(plain, curve="parabola")
    reason = "the blends are proven for a parabola alone, and which curve the controller runs is not known"
    return replace(plain, verdict="undecided", reasons=(*plain.reasons, reason), curve="parabola")
