"""From a motion to its certificate: a walk along the legs and the blends, and the sum of what it has shown."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Literal

import numpy as np
from flint import arb

from zerorev.model._arrays import Array
from zerorev.model.plan import Certificate
from zerorev.model.robot import Robot
from zerorev.verify.certificate.arm import Setting, posture_of
from zerorev.verify.certificate.claims import Proven
from zerorev.verify.certificate.joints import Joints
from zerorev.verify.certificate.mix import mixed
from zerorev.verify.certificate.path import Arc, Blend, JointLeg, Motion
from zerorev.verify.certificate.triangle import Triangle
from zerorev.verify.certificate.walk import LostError, Slowest, Walk
from zerorev.verify.mix import Mixes

__all__ = ["nothing", "prove"]

PIECES = 2000  # examined before giving up, and so many more a hundred arcs
ROUNDING = 2e-12  # relative: more than the 13 digits of a plan file can add to a bound


def prove(
    robot: Robot,
    motion: Motion,
    stated: Array,
    reversing: Iterable[int] = (),
    untrue: Callable[[Proven], Iterable[str]] = lambda proven: (),
    *,
    margin: float = 0.0,
    mixes: Mixes | None = None,
) -> Certificate:
    """Prove or refute that a motion reverses no joint.

    Args:
        robot: the arm.
        motion: all of it; the least rates are those of the stroke, not of what comes before it. In the air, before the
            lead-in and after the stroke, only reach and limits are proven.
        stated: controller angles with turns [rad], shape (n, 6): at the begin, and if n > 1 at the breakpoints that
            follow. The first row gives the posture and the turns.
        reversing: joints that are said to reverse, counted from 0: they are not certified.
        untrue: one sentence for each statement about the motion that does not hold, from what is proven of it.
        margin: room that every joint has to keep to its limits [rad].
        mixes: blends that are proven besides the parabolas, of any curve; None: none.
    """
    posture = posture_of(robot.arm, stated[0])
    if posture is None:
        return nothing("undecided", ("the posture of the first joints is singular, or all but so",))
    setting = Setting(robot.arm, posture)
    walk = Walk(setting, robot.joint_names, set(range(6)), PIECES * (1 + len(motion.legs) // 100))
    walk.followed -= (leaving := set(reversing))
    walk.undecided += [f"{robot.joint_names[i]} is claimed to reverse: not certified" for i in sorted(leaving)]
    aloft = Walk(setting, robot.joint_names, set(), walk.budget)
    joints = Joints(robot, setting, stated, margin)
    before, stroke, blended = Slowest(), Slowest(), Slowest()
    try:
        ends = [joints.begin(_straight(motion.legs[0]))]
        for k, arc in enumerate(motion.legs):
            on = walk if motion.first <= k < motion.last else aloft
            slowest = stroke if motion.start <= k < motion.last else before
            if isinstance(arc, JointLeg):
                on.evenly(arc, slowest)
                ends.append(joints.after(arc, ends[-1]))
            else:
                ends.append(joints.end(arc, on.along(arc, ends[-1], slowest)))
        for blend in motion.blends:
            arc = blend.arc
            cut = joints.end(arc, walk.along(arc, ends[blend.first], blended))
            _same_turns(walk, arc, cut, ends[blend.first + 2])
            if mixes is not None:
                _mix(walk, blend, mixes, blended)
    except LostError as lost:
        (walk.refuted if lost.proven else walk.undecided).append(lost.reason)
        nan = np.full(6, np.nan)
        return _outcome(walk, joints, nan, nan, nan)

    walk.pieces += aloft.pieces
    walk.settle_pauses()
    room = joints.limit_distance()
    if not joints.refuted and (room < margin).any():
        near = [name for name, distance in zip(walk.names, room, strict=True) if distance < margin]
        kept = f"the room of {np.rad2deg(margin):g} deg to a limit is kept" if margin else "a limit is passed"
        walk.undecided.append(f"{', '.join(near)}: whether {kept} could not be decided")
    knots = ends[motion.start], ends[motion.turn], ends[motion.last]
    walk.refuted += untrue(
        Proven(walk.names, walk.followed, knots, motion.leg_lengths, stroke.met, joints.limit_distance_met())
    )
    steady = np.isin(np.arange(6), list(walk.followed))
    min_rate = np.where(steady, stroke.bound * (1 - ROUNDING), np.nan)
    blend_min_rate = np.where(steady & bool(motion.blends), blended.bound * (1 - ROUNDING), np.nan)
    return _outcome(walk, joints, min_rate, blend_min_rate, room - ROUNDING * np.abs(room))


def nothing(verdict: Literal["refuted", "undecided"], reasons: tuple[str, ...]) -> Certificate:
    """A certificate of nothing, and why."""
    nan = np.full(6, np.nan)
    return Certificate(verdict, 0, nan, nan, nan, reasons)


def _straight(leg: Arc | JointLeg) -> Arc:
    """The first move of a motion.

    Raises:
        LostError: it is one of all joints.
    """
    if isinstance(leg, JointLeg):
        raise LostError("the first move of the motion is not straight", proven=True)
    return leg


def _mix(walk: Walk, blend: Blend, mixes: Mixes, slowest: Slowest) -> None:
    """All blends at a bend, of any curve: their joints keep the directions of the legs."""
    triangle = Triangle.between(*blend.moves)
    found = mixed(walk.setting, triangle, {joint: walk.direction.get(joint, 0) for joint in walk.followed}, mixes)
    walk.pieces += found.boxes
    slowest.bound = np.fmin(slowest.bound, found.least)
    for joint, counter in found.turns.items():
        walk.refuted.append(f"{walk.names[joint]} turns round: it moves the other way {counter.said(triangle)}")
    for joint, at in found.undecided.items():
        what = f"the direction of {walk.names[joint]} could not be decided"
        walk.undecided.append(f"{what} {triangle.place(*at)}, for every blend")
    for joint, at in found.still.items():
        walk.paused.setdefault(joint, {}).setdefault(0, triangle.place(*at))
    walk.followed -= {*found.turns, *found.undecided}


def _same_turns(walk: Walk, arc: Arc, blended: list[arb], leg: list[arb]) -> None:
    """Where a blend joins its leg again, each joint must be where the leg has brought it."""
    for name, there, here in zip(walk.names, blended, leg, strict=True):
        if abs(there - here) > 1:
            walk.refuted.append(f"{arc.where} {name} ends up whole turns away from where the leg brings it")


def _outcome(walk: Walk, joints: Joints, min_rate: Array, blend_min_rate: Array, room: Array) -> Certificate:
    refuted = (*walk.refuted, *joints.refuted)
    verdict: Literal["certified", "refuted", "undecided"]
    verdict = "refuted" if refuted else "undecided" if walk.undecided else "certified"
    return Certificate(verdict, walk.pieces, min_rate, blend_min_rate, room, (*refuted, *walk.undecided))
