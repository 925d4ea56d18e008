"""The options of `zerorev check` that have the proofs of optimality checked."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, NamedTuple

from zerorev.cli.common import FINE, FOUND
from zerorev.errors import InputError
from zerorev.report.words import terminal

if TYPE_CHECKING:
    from zerorev.model.plan import Plan
    from zerorev.planning.proof_check import StatementCheck

__all__ = ["Proofs"]


class Proofs(NamedTuple):
    """The options as they were given.

    Attributes:
        wanted: `--proof`.
        sample: `--proof-sample`.
    """

    wanted: bool
    sample: int | None

    def check(self, *, program: bool) -> None:
        """Refuse options that contradict each other, or that do not state a number of boxes.

        Raises:
            InputError: they do, or are not.
        """
        if self.sample is not None and not self.wanted:
            raise InputError("has no use", where="--proof-sample", accepted="--proof beside it")
        if self.sample is not None and self.sample < 0:
            raise InputError(f"{self.sample} is not a number of boxes", where="--proof-sample", accepted="0 or more")
        if self.wanted and program:
            raise InputError("a program states nothing of its optimality", where="--proof", accepted="no --program")

    def checked(self, plan: Plan) -> list[StatementCheck]:
        """What the plan states of its optimality, checked; nothing where that is not wanted."""
        if not self.wanted:
            return []
        from zerorev.planning.proof_check import check_proofs

        with terminal.progress("checking proofs", len(plan.holes)) as progress:
            return check_proofs(plan, sample=self.sample, progress=progress)

    def show(self, found: list[StatementCheck]) -> None:
        """One line for each statement."""
        if self.wanted and not found:
            terminal.say("the plan states nothing of straight legs that rests on a proof")
        for one in found:
            terminal.say(f"{one.hole}: {one.words}: {_outcome(one)}")
            for failure in one.proof.failures if one.proof else ():
                terminal.say(f"  {failure}")

    def as_json(self, found: list[StatementCheck]) -> dict[str, Any]:
        """What is printed beside the plan."""
        return {"proofs": [_data(one) for one in found]} if self.wanted else {}

    def verdict(self, found: list[StatementCheck]) -> int:
        """The exit code: whether all statements are confirmed."""
        return FINE if all(one.confirmed for one in found) else FOUND


def _outcome(one: StatementCheck) -> str:
    """The verdict in words, and what it rests on."""
    proof = one.proof
    if proof is None:
        return "not proven by the search, run again"
    boxes = f"{proof.boxes:,}" if proof.boxes == proof.of else f"{proof.boxes:,} of {proof.of:,}"
    words = f"{proof.verdict} ({boxes} boxes, {proof.pairs:,} pairs"
    if proof.undecided:
        words += f", {proof.undecided:,} undecided"
    if math.isfinite(proof.most_reversals):
        words += f"; motions of at most {proof.most_reversals:g} reversals"
    return words + ")"


def _data(one: StatementCheck) -> dict[str, Any]:
    proof = one.proof
    data: dict[str, Any] = {"id": one.hole, "field": one.field, "verdict": proof.verdict if proof else "not proven"}
    if proof is not None:
        data |= {
            "boxes": proof.boxes,
            "boxes_of": proof.of,
            "pairs": proof.pairs,
            "parts": proof.parts,
            "undecided": proof.undecided,
            "most_reversals": proof.most_reversals if math.isfinite(proof.most_reversals) else None,
            "failures": list(proof.failures),
        }
    return data
