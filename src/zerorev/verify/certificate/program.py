"""A proof that a program reverses no joint: of its printed, rounded numbers, as they were read back.

The legs and blends of a plan are one thing, what a controller makes of the printed points is another: a straight move
between two rounded poses lies a little beside the drill axis, and turns about an axis that is a little tilted against
it. Here the latter is certified, from the first point of a hole on: the lead-in too, each corner sharp and blended by
the radius that the program sets there. The plan is needed to say that it is this program that was meant: only what is
equal to it is proven, so that most programs that are not the plan's never reach ball arithmetic.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from zerorev.model.plan import Certificate, HolePlan, Plan
from zerorev.model.written import Drilled, WrittenHole, WrittenProgram
from zerorev.verify.as_planned import frames_as_planned, moves_as_planned, places
from zerorev.verify.certificate.at_corner import joint_corners, near_the_axis
from zerorev.verify.certificate.blends import for_the_widest
from zerorev.verify.certificate.claims import Proven, claimed_reversals
from zerorev.verify.certificate.moves import written_motion
from zerorev.verify.certificate.piece import ball_arithmetic
from zerorev.verify.certificate.proof import nothing, prove
from zerorev.verify.claims import complete
from zerorev.verify.printed import angle_slack, joints_of, length_slack

__all__ = ["certify_program", "certify_program_hole"]

JOINTS = float(np.deg2rad(0.1))  # between the plan and the rounded program; another turn or branch is far beyond


def certify_program(plan: Plan, program: WrittenProgram, drilled: Sequence[Drilled]) -> Plan:
    """The plan with each `certificate` replaced by the program's, and without `certified_within`, which is the plan's.

    Args:
        plan: from which the program was exported.
        program: as read back.
        drilled: what the program has for each hole of the plan, and what of it is not the plan's.
    """
    return replace(
        plan,
        holes=tuple(
            replace(hole_plan, certificate=_certified(plan, hole_plan, program, own), certified_within=None)
            for hole_plan, own in zip(plan.holes, drilled, strict=True)
        ),
    )


def _certified(plan: Plan, hole_plan: HolePlan, program: WrittenProgram, own: Drilled) -> Certificate | None:
    if own.hole is not None:
        return certify_program_hole(plan, hole_plan, program, own.hole, own.wrong)
    return None if hole_plan.motion is None else nothing("refuted", ("the program does not drill this hole",))


def certify_program_hole(
    plan: Plan, hole_plan: HolePlan, program: WrittenProgram, written: WrittenHole, differs: Sequence[str] = ()
) -> Certificate:
    """Prove or refute that a program drills one hole of a plan without reversing a joint.

    Args:
        plan: robot, tool, part frame and settings.
        hole_plan: one hole of it.
        program: as read back.
        written: the moves for that hole.
        differs: what was found in the program that is not the plan's, one sentence each.
    """
    wrong, motion, score = tuple(complete(hole_plan)), hole_plan.motion, hole_plan.score
    if wrong or motion is None or score is None:
        return nothing("refuted", wrong)
    at = places(plan, hole_plan, program, written)
    moves = (_in_file(written, each) for each in moves_as_planned(plan, hole_plan, motion, written, at))
    wrong = (*differs, *frames_as_planned(plan, program), *moves)
    if wrong:
        return nothing("refuted", wrong)

    planned = motion.joints[0]

    def on_other_turns(proven: Proven) -> Iterator[str]:
        for name, found, there in zip(proven.names, proven.knots[0], planned, strict=True):
            if not abs(found - float(there)) <= JOINTS:
                yield (
                    f"{name} is at {np.rad2deg(float(found)):.6g} deg at the start of the stroke, the plan says "
                    f"{np.rad2deg(there):.6g} deg"
                )

    first = joints_of(plan.robot, written.start)[None]
    with ball_arithmetic():
        path = written_motion(plan, program, written, hole_plan.hole, at)
        # the room that is kept to limits, but for what the last digits take of it
        digits = max(angle_slack(plan.robot, end) for end in (written.start, *(move.end for move in written.moves)))
        margin = max(plan.settings.limit_margin - digits, 0.0)
        proof = for_the_widest(
            partial(prove, plan.robot, path, first, claimed_reversals(score), on_other_turns, margin=margin),
            blended=bool(path.blends),
            curve_known=plan.settings.curve_known,
        )
        corners = joint_corners(path)
        slack = max((length_slack(plan.robot, move.end) for move in written.moves), default=0.0)
        proof = near_the_axis(plan.robot, plan.tool, plan.settings, hole_plan, corners, slack, proof)
    return replace(proof, reasons=tuple(_in_file(written, reason) for reason in proof.reasons))


def _in_file(written: WrittenHole, reason: str) -> str:
    """A reason with the file whose lines it names, where the program has several."""
    return f"{written.file}: {reason}" if written.file else reason
