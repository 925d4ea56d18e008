"""The motions that a study compares: the plan, the same hole at constant spin, what others do about lost motion."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Literal, get_args

import numpy as np

from zerorev.cell.followed import STEP, Followed
from zerorev.cell.reference import Manner, followed, track_of
from zerorev.model._arrays import Array
from zerorev.model.plan import HolePlan, Motion, Plan
from zerorev.model.profile import Profile
from zerorev.motion.drilling import Drilling
from zerorev.motion.evaluation import evaluated
from zerorev.program.neutral import build_program

__all__ = ["MOTIONS", "Compared", "MotionName", "compared"]

MotionName = Literal["baseline", "plan", "twin", "compensated", "biased"]
MOTIONS: tuple[MotionName, ...] = get_args(MotionName)
"""Constant spin; as planned; the plan with its legs swapped; constant spin, the command moved by half the guessed gap
with the direction of each joint; constant spin after a short move of all joints that lays the gears on one flank."""

GUESSED_GAP = float(np.deg2rad(1 / 60))  # [rad] by which a controller compensates
FADES = 20e-3  # [s] over which it moves the command from one side to the other
BIAS, BIAS_TIME = float(np.deg2rad(0.1)), 0.4  # [rad], [s] of the move before


@dataclass(frozen=True)
class Compared:
    """References of one hole.

    Attributes:
        followed: by the name of the motion; one that cannot be run is missing.
        shift: what is added to the command of it [rad], shape (N, 6), likewise; missing: nothing.
    """

    followed: Mapping[MotionName, Followed]
    shift: Mapping[MotionName, Array]


def compared(plan: Plan, hole: HolePlan, manner: Manner, names: tuple[MotionName, ...] = MOTIONS) -> Compared:
    """The references of a planned hole, each from the program that would be exported for its motion.

    Args:
        plan: whose robot, tool and settings they are.
        hole: with a motion that passed its check.
        manner: of the controller.
        names: of the motions; those that cannot be run on the plan's branch are left out.
    """
    motion = hole.motion
    assert motion is not None
    drilling = Drilling.of(plan, hole.hole)
    profile = motion.profile
    constant = profile.at_constant_spin()
    asked: dict[MotionName, Profile] = {
        "baseline": constant, "plan": profile, "twin": profile.reversed(), "compensated": constant, "biased": constant,
    }  # fmt: skip
    found: dict[MotionName, Followed] = {}
    shift: dict[MotionName, Array] = {}
    for name in names:
        evaluation = evaluated(drilling, asked[name], motion.branch, plan.settings)
        if evaluation.motion is None or evaluation.score is None:
            continue
        reference = _followed(plan, hole, drilling, evaluation.motion, manner)
        if name == "compensated":
            shift[name] = _compensation(reference)
        elif name == "biased":
            reference, shift[name] = _biased(reference)
        found[name] = reference
    return Compared(found, shift)


def _followed(plan: Plan, hole: HolePlan, drilling: Drilling, motion: Motion, manner: Manner) -> Followed:
    """Of the hole alone, from its lead-in on: what goes before is in the air."""
    own = replace(hole, motion=motion, findings=())
    settings = replace(plan.settings, approach=0.0, retract=0.0, safe_height=None, home_joints=None)
    (program,) = build_program(replace(plan, settings=settings, holes=(own,), findings=())).holes
    return followed(drilling, motion.branch, track_of(program, manner), manner)


def _compensation(reference: Followed) -> Array:
    """Half the guessed gap towards where each joint moves, faded in and out."""
    sense = np.sign(np.where(np.abs(reference.qd) < 1e-6, 0.0, reference.qd))
    width = round(FADES / STEP)
    kernel = np.hanning(width + 2)[1:-1]
    kernel /= kernel.sum()
    ends = np.concatenate([np.repeat(sense[:1], width, axis=0), sense, np.repeat(sense[-1:], width, axis=0)])
    faded = np.stack([np.convolve(ends[:, j], kernel, mode="same") for j in range(6)], axis=1)[width:-width]
    return faded * GUESSED_GAP / 2


def _biased(reference: Followed) -> tuple[Followed, Array]:
    """The reference after a move of all joints forth and back, which leaves each gear on the same flank."""
    count = round(BIAS_TIME / STEP)
    share = np.linspace(0.0, 1.0, count, endpoint=False)
    move = BIAS * 0.5 * (1 - np.cos(2 * np.pi * share))
    shift = np.zeros((count + len(reference.q), 6))
    shift[:count] = move[:, None]

    def longer(values: Array) -> Array:
        return np.concatenate([np.repeat(values[:1], count, axis=0), values])

    return replace(
        reference,
        standoff=longer(reference.standoff),
        psi=longer(reference.psi),
        q=longer(reference.q),
        qd=longer(reference.qd * 1.0),
        qdd=longer(reference.qdd * 1.0),
    ), shift
