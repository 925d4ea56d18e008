"""All pairs of the legs of a grid, with any reversals: an upper bound on the fewest reversals (theory §3)."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from zerorev.kernels import compass, legs
from zerorev.kernels import fan as fans
from zerorev.model._arrays import Array
from zerorev.search.problem import Mask, Problem
from zerorev.search.rank import SAME_COST, Candidate

__all__ = ["Fan", "settled", "survey", "surveyed"]

COARSE_NODES, NODES, FINE_NODES = 12, 24, 96  # points on a leg: looking over, refining, where those did not see all
MOST_SETTLINGS = 4  # along an edge, on fine legs; a long one takes several
SEEDS, MOST_SEEDS = 2, 6  # pairs that are refined on a branch: good ones, all
APART = 4  # steps of the grid within which two pairs go down the same valley


class Fan(NamedTuple):
    """Legs out of every spin of a grid, in 4 postures; a NamedTuple, so that kernels take it whole.

    Attributes:
        legs: as traced on the unflipped wrist, shape (4, K, MAX_FAN, ROWS, 6).
        slopes: twist rates, rising [rad/m], shape (4, K, MAX_FAN).
        critical: whether a slope is a critical rate, shape (4, K, MAX_FAN).
        fits: whether a leg can be run within the limits on either wrist flip, shape (4, K, MAX_FAN, 2).
        counts: how many slopes there are, shape (4, K).
    """

    legs: Array
    slopes: Array
    critical: Mask
    fits: Mask
    counts: npt.NDArray[np.int64]


def survey(problem: Problem) -> Array:
    """Cost, lack, value and slopes of the best pair of the grid at every spin, shape (8, K, 5); inf: none can be run.

    Args:
        problem: what is asked.
    """
    out = np.empty((8, problem.psi.size, 5))
    constraints, mode = problem.objective()
    branches = np.isin(np.arange(8), problem.branches)
    arm, plane, psi = problem.drilling.robot.arm, problem.plane, problem.psi
    fan = _fan(psi.size)
    fans.follow(arm, plane, psi, problem.constraints(0.0), COARSE_NODES, branches, fan)
    fans.survey(arm, plane, psi, fan, problem.weights, constraints, mode, branches, out)
    return out


def surveyed(problem: Problem) -> list[Candidate]:
    """The best few pairs of the grid on each branch, refined.

    Args:
        problem: what is asked.
    """
    pairs = survey(problem)
    return [found for branch in problem.branches for found in _best_of(problem, branch, pairs[branch])]


def _best_of(problem: Problem, branch: int, pairs: Array) -> list[Candidate]:
    found: list[Candidate] = []
    fewest = np.inf
    taken: list[int] = []
    for n in sorted(np.flatnonzero(np.isfinite(pairs[:, 0])).tolist(), key=lambda n: tuple(pairs[n, :3])):
        # the coarse nodes may have jumped over a singularity: what cannot be run after all does not bound anything
        if len(found) == SEEDS or len(taken) == MOST_SEEDS or pairs[n, 0] > fewest + SAME_COST:
            break
        if any(abs(n - other) <= APART for other in taken):
            continue
        taken.append(n)
        refined = _refined(problem, branch, np.array([problem.psi[n], *pairs[n, 3:]]))
        if refined is not None:
            found.append(refined)
            fewest = min(fewest, problem.order.reversals(refined))
    return found


def _refined(problem: Problem, branch: int, seed: Array) -> Candidate | None:
    for nodes in (NODES, FINE_NODES, 4 * FINE_NODES):
        found, best = _searched(compass.refine, problem, branch, seed, problem.step / 2, nodes)
        # what the nodes did not see: search again, with more of them
        if found is not None and problem.order.reversals(found) <= best[0] + SAME_COST:
            break
    return found


def settled(problem: Problem, motion: Candidate) -> Candidate:
    """The bottom of the valley in which a motion lies, with any reversals; the motion itself where that is no better.

    Args:
        problem: what is asked.
        motion: the best one so far.
    """
    for nodes, share in ((NODES, 0.1), *[(FINE_NODES, 0.025)] * MOST_SETTLINGS):
        point = np.array([motion.profile.psi[1], *motion.profile.twist_rate])
        found, _ = _searched(compass.settle, problem, motion.branch, point, share * problem.step, nodes)
        if found is not None and problem.order.rank(found) < problem.order.rank(motion):
            motion = found
        elif nodes == FINE_NODES:
            break
    return motion


def _searched(
    search: Any, problem: Problem, branch: int, seed: Array, step: float, nodes: int
) -> tuple[Candidate | None, Array]:
    """Where a compass search ends, and cost, lack and value there as the nodes see them."""
    (constraints, mode), best, point = problem.objective(), np.empty(3), seed.copy()
    search(
        problem.drilling.robot.arm, problem.plane, branch, point, step, problem.weights, constraints, mode, nodes, best
    )
    return problem.found(branch, point[0], (point[1], point[2])), best


def _fan(spins: int) -> Fan:
    """Room for one."""
    shape = (4, spins, fans.MAX_FAN)
    return Fan(
        legs=np.empty((*shape, legs.ROWS, 6)),
        slopes=np.empty(shape),
        critical=np.zeros(shape, dtype=np.bool_),
        fits=np.zeros((*shape, 2), dtype=np.bool_),
        counts=np.zeros(shape[:2], dtype=np.int64),
    )
