"""The answer of one hole in a line: what counts, in few words."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from zerorev.files.units import deg, deg_per_mm, mm
from zerorev.model.hole import Hole
from zerorev.model.job import Settings
from zerorev.model.plan import HolePlan
from zerorev.report.scene.motion_look import Look
from zerorev.report.words.hole_rows import standing
from zerorev.report.words.tables import slowest

__all__ = ["Headline", "Tone", "headline"]

Tone = Literal["good", "warn", "bad", "plain"]


@dataclass(frozen=True)
class Headline:
    """What is said of one hole; None where a value is not known.

    Attributes:
        before: reversals with constant spin.
        after: reversals of the motion that is shown.
        travel: of all joints [deg].
        slowest: rate [deg/mm] of the slowest joint that does not reverse, and the joint's name.
        depth: of the hole [mm].
        margin: by how much it could be deeper without a reversal [mm]; not known of a motion by hand.
        branch: 0..7.
        verdict: what is known of the motion, in a few words.
        tone: how good that is.
        why: one sentence more, or an empty string.
    """

    before: int | None
    after: int | None
    travel: float | None
    slowest: tuple[float, str] | None
    depth: float
    margin: float | None
    branch: int | None
    verdict: str
    tone: Tone
    why: str = ""


def headline(
    hole: Hole,
    answer: HolePlan | None,
    names: tuple[str, ...],
    settings: Settings,
    look: Look | None,
    branch: int | None,
) -> Headline:
    """The line of a hole.

    Args:
        hole: of the job.
        answer: what was found for it, or None.
        names: of the joints.
        settings: of the job.
        look: at the edited motion where one is shown instead of the answer's, else None.
        branch: of the motion that is shown, or None.
    """
    score = look.score if look else answer.score if answer else None
    verdict, tone, why = _by_hand(look) if look else _of(answer)
    slow = slowest(score, settings) if score else None
    return Headline(
        before=answer.baseline.reversals if answer and answer.baseline else None,
        after=None if score is None else score.reversals,
        travel=None if score is None else float(deg(score.travel)),
        slowest=None if slow is None else (float(deg_per_mm(slow[0])), names[slow[1]]),
        depth=float(mm(hole.depth)),
        margin=None if look or answer is None or answer.deepest is None else float(mm(answer.deepest - hole.depth)),
        branch=branch,
        verdict=verdict,
        tone=tone,
        why=why,
    )


def _by_hand(look: Look) -> tuple[str, Tone, str]:
    if not look.runs:
        return "cannot run", "bad", look.why
    return "by hand, not checked", "warn", look.why


def _of(answer: HolePlan | None) -> tuple[str, Tone, str]:
    """Words, tone and reason of an answer."""
    if answer is None:
        return "not planned", "plain", ""
    if standing(answer) == "infeasible":
        return "no motion", "bad", answer.findings[0].message if answer.findings else ""
    if answer.certificate is not None:
        reasons = answer.certificate.reasons
        tones: dict[str, Tone] = {"certified": "good", "refuted": "bad", "undecided": "warn"}
        return answer.certificate.verdict, tones[answer.certificate.verdict], reasons[0] if reasons else ""
    if answer.verified is None:
        return "not checked", "warn", ""
    if not answer.verified.passed:
        return "check failed", "bad", answer.verified.failures[0] if answer.verified.failures else ""
    return "verified", "good", ""
