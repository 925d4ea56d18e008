"""The tree of a branch and bound as data, complete enough to be checked alone: what it claims, and what it rests on."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
import numpy.typing as npt

from zerorev.model._arrays import Array

__all__ = ["NO_VALUE", "PER_REVERSAL", "Claim", "ProofCheck", "ProofTree"]

PER_REVERSAL = 1e4  # [rad] more than any travel: what a reversal counts in a value
NO_VALUE = 1e300  # of what does not exist


@dataclass(frozen=True)
class Claim:
    """That no motion of two straight legs has a lesser value, reversals x PER_REVERSAL + travel [rad].

    It is about the motions that keep the robot's limits and the rules below; what they cost in reversals is the sum of
    the joints' counts, each times its weight.

    Attributes:
        depth: of the legs [m].
        min_rate: of a joint that does not reverse, at every point [rad/m]; 0: none.
        psi_bound: spins within +- this [rad]; 0: periodic.
        branch: the only one that counts (conventions: branch), or None.
        weights: what a reversal of each joint costs, shape (6,).
        most_cost: what a motion may cost in reversals at most.
        value: none is below; NO_VALUE: there is no motion.
        limit_margin: room that is kept to the robot's limits [rad].
    """

    depth: float
    min_rate: float
    psi_bound: float
    branch: int | None
    weights: Array
    most_cost: float
    value: float
    limit_margin: float = 0.0


@dataclass(frozen=True)
class ProofTree:
    """Nodes of legs: each an interval of spins at the target and a list of intervals of slopes, on one posture.

    Some intervals of a node's list are closed. The others are the lists of its two halves; where a node has none, two
    legs out of what is not dead reach the value, whichever they are.

    Attributes:
        claim: what the tree proves.
        spins: interval of each node [rad], shape (N, 2).
        parents: of which node it is a half, or -1, shape (N,).
        postures: 0..3, branch // 2, shape (N,).
        lists: where its slopes start, and how many they are, shape (N, 2).
        slopes: intervals [rad/m], shape (S, 2).
        closed_of: node of each interval that is closed, shape (C,).
        closed: these intervals [rad/m], shape (C, 2).
        dead: whether that is because no leg of it keeps the rules; else because no two legs, one of it and one of what
            is not dead, have a lesser value, shape (C,).
        cuts: stand-offs that were found to matter, as shares of the depth, one array per node.
        terms: conditions on rates that pairs of a node are weighed with: leg (0, 1), joint (0..5), stand-off as a share
            of the depth, direction of the joint on that leg (+1, -1), multiplier [m], 0: no term; shape (N, T, 5).
        of_travel: whether the terms are added to the travel; else they contradict each other, shape (N,).
    """

    claim: Claim
    spins: Array
    parents: npt.NDArray[np.int64]
    postures: npt.NDArray[np.int64]
    lists: npt.NDArray[np.int64]
    slopes: Array
    closed_of: npt.NDArray[np.int64]
    closed: Array
    dead: npt.NDArray[np.bool_]
    cuts: tuple[Array, ...]
    terms: Array
    of_travel: npt.NDArray[np.bool_]

    def resized(self, factor: float) -> ProofTree:
        """The same where all lengths are multiplied by a factor; by a power of two no digit changes."""
        claim = replace(self.claim, depth=self.claim.depth * factor, min_rate=self.claim.min_rate / factor)
        terms = self.terms * [1.0, 1.0, 1.0, 1.0, factor]
        return replace(self, claim=claim, slopes=self.slopes / factor, closed=self.closed / factor, terms=terms)


@dataclass(frozen=True)
class ProofCheck:
    """What a check of a proof came to.

    Attributes:
        verdict: `confirmed`; `refuted`: the tree leaves something out, or legs were found that it says do not exist;
            `undecided`: some boxes could not be shown to be what the tree says.
        boxes: how many were checked, dead or left out for their pairs.
        of: how many there are.
        pairs: how many pairs of boxes were checked.
        parts: how many boxes were examined, those that were cut included.
        undecided: how many boxes were left undecided.
        reasons: how many boxes are dead, or were left out, and why.
        most_reversals: motions with more than so many may have steeper slopes than the tree; infinite: none has.
        failures: what is refuted or undecided, one sentence each, the first few.
    """

    verdict: Literal["confirmed", "refuted", "undecided"]
    boxes: int
    of: int
    pairs: int
    parts: int
    undecided: int
    reasons: dict[str, int]
    most_reversals: float
    failures: tuple[str, ...] = ()
