"""What many holes came to, in one sentence."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable
from typing import Literal

from zerorev.model.plan import HolePlan
from zerorev.report.words.hole_rows import Standing, standing
from zerorev.report.words.terminal import duration

__all__ = ["STANDINGS", "curves", "outcome"]

STANDINGS: dict[Standing, str] = {
    "zero": "without a reversal",
    "reversals": "with reversals",
    "infeasible": "without a motion",
    "failed": "failed the check",
}
CURVES: dict[Literal["any", "one_way", "parabola"], str] = {
    "any": "every curve",
    "one_way": "every curve that turns one way",
    "parabola": "a parabola alone",
}
VERDICTS: tuple[Literal["certified", "undecided", "refuted"], ...] = ("certified", "undecided", "refuted")


def outcome(done: str, answers: Iterable[HolePlan], seconds: float, *, proven: bool = False) -> str:
    """How many holes were done, how they stand, and how long it took.

    Args:
        done: what was done with them, e.g. `planned`.
        answers: of the holes.
        seconds: how long it took [s].
        proven: whether their certificates count, and not their reversals.
    """
    answers = list(answers)
    if proven:
        counts = Counter(answer.certificate.verdict for answer in answers if answer.certificate is not None)
        parts = [f"{counts[verdict]:,} {verdict}" for verdict in VERDICTS if counts[verdict]]
    else:
        stands = Counter(standing(answer) for answer in answers)
        parts = [f"{stands[each]:,} {words}" for each, words in STANDINGS.items() if stands[each]]
    taken = f"{seconds:.0f} s" if seconds < 59.5 else duration(seconds)
    holes = f"{len(answers):,} hole{'' if len(answers) == 1 else 's'}"
    return f"{holes} {done} in {taken}: {', '.join(parts)}."


def curves(answers: Iterable[HolePlan]) -> str:
    """For which curves of the blends the certificates hold; empty where no straight moves are blended."""
    counts = Counter(
        answer.certificate.curve
        for answer in answers
        if answer.certificate is not None and answer.certificate.verdict == "certified"
    )
    parts = [(counts[curve], words) for curve, words in CURVES.items() if counts[curve]]
    if len(parts) == 1:
        return f"the blends are proven for {parts[0][1]}"
    return "the blends are proven for " + ", ".join(f"{words} ({count:,})" for count, words in parts) if parts else ""
