"""How far the end effector turns, over a hole and over a job: hoses, cables and a foot turn with it.

Two turns are counted. The *tool* turns about its own axis, the drill axis, as seen from the base: in a hole that is its
spin, and between holes the part of its rotation that is about that axis, summed along the move. The *last joint* turns
the tool against the arm. Both are counted on over the whole run, so that two turns one way are not taken for none.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from zerorev.collision.arms import setting_of
from zerorev.model._arrays import Array
from zerorev.model.finding import Finding
from zerorev.model.plan import HolePlan, Motion, Plan, Transition
from zerorev.model.strokes import each_stroke
from zerorev.motion.drilling import Drilling
from zerorev.motion.kinematics import forward
from zerorev.program.lead_in import LeadIn, find_lead_in

__all__ = ["ToolTurn", "hole_turn", "with_tool_turn"]

NOTABLE = float(np.deg2rad(90.0))  # over a hole: below it nothing is said
MUCH = float(np.deg2rad(360.0))
STEP = float(np.deg2rad(2.0))  # of the joint that turns furthest, between two samples of a move


def hole_turn(answer: HolePlan, lead_in: LeadIn) -> Iterator[Finding]:
    """How far the tool turns over a hole, where that is worth a word.

    Args:
        answer: with a motion.
        lead_in: of that.
    """
    assert answer.motion is not None
    spins = _spins(answer.motion, lead_in)
    turn = float(np.ptp(spins))
    if turn >= NOTABLE:
        message = f"the tool turns by {np.rad2deg(turn):.0f} deg about its own axis over the hole"
        if turn > MUCH:
            message += ": see that hoses and cables allow it; psi_bound_deg keeps the spin within bounds"
        yield Finding("warning" if turn > MUCH else "info", "tool_turn", message, answer.hole.id)


def with_tool_turn(plan: Plan) -> Plan:
    """The plan with the finding of how far the tool turns over the whole job, in place of an older one.

    Args:
        plan: with the moves between its holes.
    """
    turns = ToolTurn(plan)
    for answer in plan.holes:
        turns.add(answer)
    others = (finding for finding in plan.findings if finding.kind != "tool_turn")
    return replace(plan, findings=(*others, *turns.findings()))


class _Run(NamedTuple):
    """What one hole does to the end effector.

    Attributes:
        spins: at the points between which the tool turns one way [rad], shape (n,).
        last: angles of the last joint there [rad], shape (n,).
    """

    spins: Array
    last: Array


class ToolTurn:
    """Takes the answers of a job in any order, and says at the end how far the end effector turns over all of them."""

    def __init__(self, plan: Plan) -> None:
        """Begin.

        Args:
            plan: with its order and the moves between its holes; its answers are given one by one.
        """
        self._plan = plan
        self._runs: dict[str, _Run] = {}

    def add(self, answer: HolePlan) -> None:
        """Take the next answer."""
        strokes = [each for each in each_stroke(answer) if each.motion is not None]
        if strokes:
            spins, last = zip(*(self._stroke(each) for each in strokes), strict=True)
            self._runs[answer.hole.id] = _Run(np.concatenate(spins), np.concatenate(last))

    def _stroke(self, answer: HolePlan) -> tuple[Array, Array]:
        """Spins and angles of the last joint where the lead-in begins and at the breakpoints [rad], (n,) each."""
        motion, plan = answer.motion, self._plan
        assert motion is not None
        setting = setting_of(plan.robot, plan.tool, plan.settings)
        lead_in = find_lead_in(Drilling.of(plan, answer.hole), motion, plan.settings.lead_in, setting)
        return _spins(motion, lead_in), np.append(lead_in.joints[5], motion.joints[:, 5])

    def findings(self) -> tuple[Finding, ...]:
        """How far it turns; nothing where no hole has a motion."""
        if not self._runs:
            return ()
        turns, where = [0.0], [""]
        for name, turned in self._turned():
            turns += (turns[-1] + turned).tolist()
            where += [name] * len(turned)
        last = np.concatenate([
            *(run.last for run in self._runs.values()), *(move.joints[:, 5] for move in self._plan.transitions)
        ])  # fmt: skip
        tool, joint = float(np.ptp(turns)), float(np.ptp(last))
        one, other = where[int(np.argmin(turns))], where[int(np.argmax(turns))]
        name = self._plan.robot.joint_names[5]
        message = (
            f"over the job the tool turns by {np.rad2deg(tool):.0f} deg about its own axis, seen from the base, and "
            f"{name} by {np.rad2deg(joint):.0f} deg"
        )
        much = max(tool, joint) > MUCH
        if much:
            way = f" (from {one or 'the beginning'} to {other or 'the beginning'})"
            message += (
                f"{way}: see that hoses and cables allow it; psi_bound_deg, near_joints_deg, branch and the order of "
                "the holes change it"
            )
        return (Finding("warning" if much else "info", "tool_turn", message),)

    def _turned(self) -> Iterator[tuple[str, Array]]:
        """Name of each hole or move, in order, and how far the tool has turned since its beginning [rad], (n,)."""
        moves = {(move.start, move.to): move for move in self._plan.transitions}
        order = [hole for hole in self._plan.order or self._runs if hole in self._runs]
        for start, to in pairwise([None, *order, None]):
            if (start, to) in moves:
                yield f"the way to {'hole ' + to if to else 'the home position'}", self._rolled(moves[start, to])
            if to is not None:
                spins = self._runs[to].spins
                yield f"hole {to}", spins[1:] - spins[0]

    def _rolled(self, move: Transition) -> Array:
        """How far the tool turns about its own axis along a move [rad], shape (n,)."""
        parts = []
        for one, other in pairwise(move.joints):
            count = int(np.ceil(np.abs(other - one).max() / STEP)) + 1
            parts.append(one + np.linspace(0.0, 1.0, count, endpoint=False)[:, None] * (other - one))
        joints = np.concatenate([*parts, move.joints[-1:]])
        R = (forward(self._plan.robot, joints) @ self._plan.tool.T_flange_tcp)[:, :3, :3]
        turned = np.swapaxes(R[:-1], 1, 2) @ R[1:]
        # of the rotation vector from one sample to the next the share along the tool's own Z
        angle = np.arccos(np.clip((np.trace(turned, axis1=1, axis2=2) - 1) / 2, -1.0, 1.0))
        return np.asarray(np.cumsum((turned[:, 1, 0] - turned[:, 0, 1]) / 2 / np.sinc(angle / np.pi)))


def _spins(motion: Motion, lead_in: LeadIn) -> Array:
    """Spins at the beginning of the lead-in and at the breakpoints [rad], shape (n + 1,)."""
    profile = motion.profile
    return np.append(profile.psi[0] + profile.twist_rate[0] * lead_in.length, profile.psi)
