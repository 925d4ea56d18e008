"""A proof, in ball arithmetic, that the continuous motion of a plan reverses no joint (issue 3: a certificate).

On every piece of the two legs, and of the blended breakpoints: the rate of each joint has one sign throughout;
the pose is in reach, in the posture of the first joints, and clear of singularities; no joint passes a limit. What is
certified is the motion of the numbers given, as they are: of a plan file, those that stand in it.

Each breakpoint is looked at both sharp and blended, for a program may be stepped. A lead-in is not looked at.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Literal

import numpy as np
from flint import arb

from zerorev.model._arrays import Array
from zerorev.model.hole import Hole
from zerorev.model.job import Settings
from zerorev.model.plan import Certificate, HolePlan, Plan, Score
from zerorev.model.profile import Profile
from zerorev.model.robot import Robot
from zerorev.model.tool import Tool
from zerorev.verify.certificate_arm import posture_of, setting_of
from zerorev.verify.certificate_claims import Proven, claimed_reversals, false_claims
from zerorev.verify.certificate_joints import Joints
from zerorev.verify.certificate_path import Arc, Motion, motion_of
from zerorev.verify.certificate_piece import ball_arithmetic
from zerorev.verify.certificate_walk import LostError, Slowest, Walk
from zerorev.verify.claims import as_asked, complete

__all__ = ["certify_hole", "certify_motion", "certify_plan"]

PIECES = 2000  # looked at before giving up, and so many more a hundred segments
ROUNDING = 2e-12  # relative: more than the 13 digits of a plan file can add to a bound


def certify_plan(plan: Plan) -> Plan:
    """The plan with `certificate` filled in for each hole that has a motion.

    Args:
        plan: any plan, also a wrong one.
    """
    robot, tool, settings = plan.robot, plan.tool, plan.settings
    holes = tuple(
        hole if hole.motion is None else replace(hole, certificate=certify_hole(robot, tool, settings, hole))
        for hole in plan.holes
    )
    return replace(plan, holes=holes)


def certify_hole(robot: Robot, tool: Tool, settings: Settings, hole_plan: HolePlan) -> Certificate:
    """Prove or refute what a plan claims of one hole; a wrong plan is reported, never raised.

    Args:
        robot: the arm.
        tool: the drill.
        settings: blend, corner and bounds as planned.
        hole_plan: what is claimed.
    """
    wrong = tuple(complete(hole_plan))
    motion, score = hole_plan.motion, hole_plan.score
    if wrong or motion is None or score is None:
        return _nothing("refuted", wrong)
    if wrong := tuple(as_asked(robot, tool, settings, hole_plan, motion)):
        return _nothing("refuted", wrong)
    return certify_motion(
        robot,
        tool,
        hole_plan.hole,
        motion.profile,
        motion.joints,
        blend=settings.blend,
        passing_blend=settings.passing_blend,
        claims=score,
    )


def certify_motion(
    robot: Robot,
    tool: Tool,
    hole: Hole,
    profile: Profile,
    joints: Array,
    *,
    blend: float = 0.0,
    passing_blend: float = 0.0,
    claims: Score | None = None,
) -> Certificate:
    """Prove or refute that a motion reverses no joint; for any numbers, such as those read back from a program.

    Args:
        robot: the arm.
        tool: the drill.
        hole: the drill axis; its depth is not looked at.
        profile: spin along the path, n breakpoints.
        joints: controller angles with turns [rad], right to 1e-6 rad: at the start alone, shape (1, 6), or at all
            breakpoints, shape (n, 6). The first row gives the posture and the turns.
        blend: radius of the blended corner [m]; 0 for none.
        passing_blend: radius of the blends at the other inner breakpoints [m]; 0 for none.
        claims: figures to be held against the motion, or None.
    """
    with ball_arithmetic():
        posture = posture_of(robot.arm, joints[0])
        if posture is None:
            return _nothing("undecided", ("the posture of the first joints is singular, or all but so",))
        setting = setting_of(robot.arm, tool, hole, posture)
        walk = Walk(setting, robot.joint_names, set(range(6)), PIECES * (1 + profile.psi.size // 100))
        if claims is not None:
            reversing = claimed_reversals(claims)
            walk.followed -= reversing
            names = [robot.joint_names[i] for i in sorted(reversing)]
            walk.undecided += [f"{name} is claimed to reverse: not certified" for name in names]
        return _prove(walk, Joints(robot, setting, joints), motion_of(profile, blend, passing_blend), claims)


def _prove(walk: Walk, joints: Joints, motion: Motion, claims: Score | None) -> Certificate:
    """Walk along the legs and the blend, and draw the sum."""
    legs, blend, nan = Slowest(), Slowest(), np.full(6, np.nan)
    try:
        ends = [joints.begin(motion.legs[0])]
        for arc in motion.legs:
            ends.append(joints.end(arc, walk.along(arc, ends[-1], legs)))
        for arc, first in motion.blends:
            cut = joints.end(arc, walk.along(arc, ends[first], blend))
            _same_turns(walk, arc, cut, ends[first + 2])
    except LostError as lost:
        (walk.refuted if lost.proven else walk.undecided).append(lost.reason)
        return _outcome(walk, joints, nan, nan, nan)

    walk.settle_pauses()
    room = joints.limit_distance()
    if not joints.refuted and (room < 0).any():
        near = [name for name, distance in zip(walk.names, room, strict=True) if distance < 0]
        walk.undecided.append(f"{', '.join(near)}: whether a limit is passed could not be decided")
    if claims is not None:
        knots = ends[0], ends[motion.turn], ends[-1]
        proven = Proven(walk.names, walk.followed, knots, motion.leg_lengths, legs.met, joints.limit_distance_met())
        walk.refuted += false_claims(claims, proven)
    steady = np.isin(np.arange(6), list(walk.followed))
    min_rate = np.where(steady, legs.bound * (1 - ROUNDING), np.nan)
    blend_min_rate = np.where(steady & bool(motion.blends), blend.bound * (1 - ROUNDING), np.nan)
    return _outcome(walk, joints, min_rate, blend_min_rate, room - ROUNDING * np.abs(room))


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


def _nothing(verdict: Literal["refuted", "undecided"], reasons: tuple[str, ...]) -> Certificate:
    nan = np.full(6, np.nan)
    return Certificate(verdict, 0, nan, nan, nan, reasons)
