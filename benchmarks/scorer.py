"""One independent scorer for every answer of every method: the whole motion at N = 40,001 samples, in plain NumPy.

A joint has turned round where it has backed up from its farthest point by more than the arithmetic can err. What lies
between two samples is not seen; `zerorev.motion.evaluation.evaluate` locates that, and is asked where the two disagree.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from benchmarks.arm_numpy import inverse, wrapped
from benchmarks.cases import Answer, Case
from zerorev.model._arrays import Array
from zerorev.motion.evaluation import evaluate
from zerorev.motion.kinematics import tcp_pose

__all__ = ["SAMPLES", "Rescored", "Verdict", "compare", "located_reversals", "rescore", "turning_points", "words"]

SAMPLES = 40_001
BACKED_UP = 1e-11  # [rad] more than the arithmetic errs, and far less than a joint moves between two samples
JUMP = 0.5  # [rad] a step that no drilling motion makes
LEAST_GAIN = 1e-6  # of the travel


@dataclass(frozen=True)
class Rescored:
    """What an answer is worth.

    Attributes:
        wrong: what keeps the robot from running it: fault, jump, limit; "" where nothing does.
        reversals: over all joints.
        travel: [rad].
    """

    wrong: str
    reversals: float
    travel: float


def rescore(case: Case, answer: Answer, samples: int = SAMPLES) -> Rescored:
    """Score an answer from its spins and its branch alone.

    Args:
        case: the hole.
        answer: the motion.
        samples: on the whole path; odd, so that the target of legs of equal length is among them.
    """
    profile, robot = answer.profile, case.robot
    standoff, psi = profile.at(np.linspace(0.0, profile.distance[-1], samples))
    T = tcp_pose(case.hole, standoff, psi) @ np.linalg.inv(case.tool.T_flange_tcp)
    joints = inverse(robot.arm, T, (answer.branch,))[:, 0]
    if np.isnan(joints).any():
        return Rescored("fault", np.inf, np.inf)
    steps = wrapped(np.diff(joints, axis=0))
    if np.abs(steps).max() > JUMP:
        return Rescored("jump", np.inf, np.inf)
    joints = joints[0] + np.concatenate([np.zeros((1, 6)), np.cumsum(steps, axis=0)])
    least = np.ceil((robot.limits.lower - joints.min(axis=0)) / (2 * np.pi) - 1e-9)
    most = np.floor((robot.limits.upper - joints.max(axis=0)) / (2 * np.pi) + 1e-9)
    if (least > most).any():
        return Rescored("limit", np.inf, np.inf)
    turns = sum(turning_points(joints[:, i]) for i in range(6))
    return Rescored("", turns, float(np.abs(steps).sum()))


def turning_points(angle: Array) -> int:
    """How often an angle changes direction, shape (N,) [rad]; backing up by no more than `BACKED_UP` is not a turn."""
    steps = np.diff(angle)
    # only where the sign of the step changes can it turn
    corners = np.flatnonzero(np.sign(steps[1:]) * np.sign(steps[:-1]) <= 0) + 1
    turns, direction, farthest = 0, 0.0, angle[0]
    for value in angle[[*corners, -1]]:
        moved = value - farthest
        if direction * moved > 0:
            farthest = value
        elif abs(moved) > BACKED_UP:
            turns += int(direction != 0)
            direction, farthest = np.sign(moved), value
    return turns


def words(score: Rescored | None) -> str:
    """A score in words."""
    if score is None or score.wrong:
        return "no motion"
    return f"{score.reversals:g} reversals and {np.rad2deg(score.travel):.5f} deg of travel"


Verdict = Literal["worse", "equal", "between samples", "better"]


def compare(case: Case, theirs: Answer, their_score: Rescored, our_score: Rescored | None) -> Verdict:
    """Is a peer's answer better than the exact one? By reversals first, then by travel.

    Args:
        case: the hole.
        theirs: the peer's answer.
        their_score: as rescored.
        our_score: the exact answer's, or None where the search found no motion.

    Returns:
        `between samples` where it only looks better: it has reversals that even the samples of the scorer overlook.
    """
    if their_score.wrong:
        return "worse"
    if our_score is None:
        return "better"
    if their_score.reversals == our_score.reversals:
        gain = 1 - their_score.travel / our_score.travel
        verdict: Verdict = "better" if gain > LEAST_GAIN else "equal" if gain > -LEAST_GAIN else "worse"
    else:
        verdict = "better" if their_score.reversals < our_score.reversals else "worse"
    if verdict == "better" and located_reversals(case, theirs) > their_score.reversals:
        return "between samples"
    return verdict


def located_reversals(case: Case, answer: Answer) -> float:
    """Reversals as zerorev locates them, between the samples, too; infinite where the motion cannot be run."""
    score = evaluate(case.robot, case.tool, case.hole, *answer).score
    return np.inf if score is None else score.reversals
