"""A proof, in ball arithmetic, that the continuous motion of a plan reverses no joint (issue 3: a certificate).

On every piece of the two legs, and of the blended breakpoints: the rate of each joint has one sign throughout;
the pose is in reach, in the posture of the first joints, and clear of singularities; no joint passes a limit, or the
room to it that the settings ask for. What is
certified is the motion of the numbers given, as they are: of a plan file, those that stand in it.

Each breakpoint is examined both sharp and blended, for a program may be stepped. A lead-in is not examined.
"""

from __future__ import annotations

from dataclasses import replace
from functools import partial

from zerorev.model._arrays import Array
from zerorev.model.hole import Hole
from zerorev.model.job import Settings
from zerorev.model.plan import Certificate, HolePlan, Plan, Score
from zerorev.model.profile import Profile
from zerorev.model.robot import Robot
from zerorev.model.strokes import stroke_by_stroke
from zerorev.model.tool import Tool
from zerorev.verify.certificate.at_corner import planned_corner
from zerorev.verify.certificate.blends import for_the_widest
from zerorev.verify.certificate.claims import claimed_reversals, false_claims
from zerorev.verify.certificate.legs import planned_motion
from zerorev.verify.certificate.piece import ball_arithmetic
from zerorev.verify.certificate.proof import nothing, prove
from zerorev.verify.claims import as_asked, complete
from zerorev.verify.mix import Mixes

__all__ = ["certify_hole", "certify_motion", "certify_plan"]


def certify_plan(plan: Plan) -> Plan:
    """The plan with `certificate` filled in for each hole that has a motion; `certified_within` is taken out.

    Args:
        plan: any plan, also a wrong one.
    """

    def certified(strokes: Plan) -> Plan:
        robot, tool, settings = strokes.robot, strokes.tool, strokes.settings
        holes = tuple(
            hole
            if hole.motion is None
            else replace(hole, certificate=certify_hole(robot, tool, settings, hole), certified_within=None)
            for hole in strokes.holes
        )
        return replace(strokes, holes=holes)

    return stroke_by_stroke(plan, certified)


def certify_hole(robot: Robot, tool: Tool, settings: Settings, hole_plan: HolePlan) -> Certificate:
    """Prove or refute what a plan claims of one hole; a wrong plan is reported, never raised.

    Args:
        robot: the arm.
        tool: the drill.
        settings: blend, corner and bounds as planned.
        hole_plan: what is claimed.
    """
    wrong, settings = tuple(complete(hole_plan)), settings.of(hole_plan.hole)
    motion, score = hole_plan.motion, hole_plan.score
    if wrong or motion is None or score is None:
        return nothing("refuted", wrong)
    if wrong := tuple(as_asked(robot, tool, settings, hole_plan, motion)):
        return nothing("refuted", wrong)
    certificate = for_the_widest(
        partial(
            certify_motion,
            robot,
            tool,
            hole_plan.hole,
            motion.profile,
            motion.joints,
            blend=settings.corner_blend,
            passing_blend=settings.passing_blend,
            claims=score,
            limit_margin=settings.limit_margin,
        ),
        blended=settings.corner_blend > 0 or motion.profile.psi.size > 3,
        curve_known=settings.curve_known,
    )
    return planned_corner(robot, tool, settings, hole_plan, certificate)


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
    limit_margin: float = 0.0,
    mixes: Mixes | None = None,
) -> Certificate:
    """Prove or refute that a motion reverses no joint; for any numbers, such as those read back from a program.

    Args:
        robot: the arm.
        tool: the drill.
        hole: the drill axis; its depth is not examined.
        profile: spin along the path, n breakpoints.
        joints: controller angles with turns [rad], right to 1e-6 rad: at the start alone, shape (1, 6), or at all
            breakpoints, shape (n, 6). The first row gives the posture and the turns.
        blend: radius of the blended corner [m]; 0 for none.
        passing_blend: radius of the blends at the other inner breakpoints [m]; 0 for none.
        claims: figures to be held against the motion, or None.
        limit_margin: room that every joint has to keep to its limits [rad].
        mixes: blends that are proven besides the parabolas, of any curve; None: none.
    """
    with ball_arithmetic():
        path = planned_motion(robot.arm, tool, hole, profile, blend, passing_blend)
        if claims is None:
            return prove(robot, path, joints, margin=limit_margin, mixes=mixes)
        untrue = partial(false_claims, claims)
        return prove(robot, path, joints, claimed_reversals(claims), untrue, margin=limit_margin, mixes=mixes)
