"""The check itself: follow the motion from its first joint vector, and hold every claim of the plan against it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from zerorev.model._arrays import Array
from zerorev.model.fingerprint import fingerprint
from zerorev.model.job import Settings
from zerorev.model.plan import HolePlan, Plan, Verification
from zerorev.model.profile import Profile
from zerorev.model.robot import Robot
from zerorev.model.strokes import stroke_by_stroke
from zerorev.model.tool import Tool
from zerorev.verify.arm import posture_of
from zerorev.verify.around import clearance_claimed
from zerorev.verify.claims import (
    as_asked,
    blend_keeps,
    complete,
    corner_keeps,
    joints_stated,
    reversals_claimed,
    score_claimed,
)
from zerorev.verify.measure import reversals, reversals_through
from zerorev.verify.mix import mix_holds
from zerorev.verify.path import Track, around, blend, follow, joined, legs, residual
from zerorev.verify.sound import continuity, greatest_step, least_room, limit_distances, limits, on_the_axis, reach
from zerorev.verify.way import corner_moves, way_as_asked, way_tracks

__all__ = ["known_as_checked", "subject", "verify_hole", "verify_plan"]

SAMPLES, BLEND_SAMPLES = USUAL = 40_000, 4_000  # on the two legs, on the blended corner
PASSING = 4  # a blend within a leg is so many times shorter of samples: it bends less, and is still finer than the legs


def verify_plan(plan: Plan) -> Plan:
    """The plan with `verified` filled in for each hole that has a motion.

    Args:
        plan: any plan, also a wrong one.
    """

    def checked(strokes: Plan) -> Plan:
        robot, tool, settings = strokes.robot, strokes.tool, strokes.settings
        holes = tuple(
            hole if hole.motion is None else replace(hole, verified=verify_hole(robot, tool, settings, hole))
            for hole in strokes.holes
        )
        return replace(strokes, holes=holes)

    return stroke_by_stroke(plan, checked)


def verify_hole(
    robot: Robot,
    tool: Tool,
    settings: Settings,
    hole_plan: HolePlan,
    *,
    samples: int = SAMPLES,
    blend_samples: int = BLEND_SAMPLES,
) -> Verification:
    """Prove or refute what a plan claims of one hole, from the model alone.

    The joints of the whole motion are computed again, from the hole, the profile and the joints at its first
    breakpoint, and every claim is held against them. A wrong plan is reported, never raised.

    Args:
        robot: the arm.
        tool: the drill.
        settings: blend, corner and bounds as planned.
        hole_plan: what is claimed.
        samples: points on the two legs.
        blend_samples: points on the blended corner; a blend within a leg has a quarter of them.

    Returns:
        What was examined, and one sentence for each claim that does not hold.
    """
    flaws = tuple(complete(hole_plan))
    motion, score = hole_plan.motion, hole_plan.score
    if flaws or motion is None or score is None:
        return Verification(False, 0, 0, (0,) * 6, np.nan, np.nan, np.nan, np.nan, flaws)

    hole, start = hole_plan.hole, motion.joints[0]
    settings = settings.of(hole)
    posture = posture_of(robot.arm, start)
    asked = legs(motion.profile, samples)
    track = Track(asked, follow(robot, tool, hole, asked, posture, start), robot.nil_rate)
    turned = reversals(track)
    failures = [
        *as_asked(robot, tool, settings, hole_plan, motion),
        *joints_stated(robot, motion, track),
        *reversals_claimed(robot, score, track, turned),
        *score_claimed(robot, score, track, turned),
    ]
    examined, on_blends = [("", track)], 0
    for k, radius in _blends(motion.profile, settings):
        at_corner = k == motion.profile.corner
        where = "in the blended corner, " if at_corner else f"in the blend at breakpoint {k + 1}, "
        curve = blend(motion.profile, k, radius, blend_samples if at_corner else blend_samples // PASSING)
        before, behind = around(track, k, curve)
        joints = follow(robot, tool, hole, curve, posture, track.joints[before])
        piece = joined(track, Track(curve, joints), before, behind)
        failures += blend_keeps(robot, where, turned, reversals_through(track, turned, piece, before, behind))
        if not settings.curve_known:
            failures += mix_holds(robot, tool, hole, motion.profile, motion.joints, k, radius, "one_way")
        examined.append((where, piece))
        on_blends += curve.psi.size

    failures += corner_keeps(robot, tool, settings, hole_plan)
    pieces = [piece for _, piece in examined]
    if hole_plan.clearance is not None:
        pieces += way_tracks(robot, tool, hole, motion, hole_plan.clearance)
        failures += way_as_asked(robot, settings, hole_plan.clearance)
    failures += clearance_claimed(
        robot, tool, settings, hole_plan.clearance,
        [(piece.path.standoff, piece.path.psi, piece.joints) for piece in pieces],
        corner_moves(robot, tool, hole, motion, hole_plan.corner), planned=hole_plan.status == "planned",
    )  # fmt: skip
    figures = []
    for where, piece in examined:
        position, rotation = residual(robot, tool, hole, piece.path, piece.joints)
        checks = (
            *reach(piece),
            *on_the_axis(piece, position, rotation),
            *continuity(robot, piece),
            *limits(robot, piece, settings.limit_margin),
        )
        failures += [where + failure for failure in checks]
        figures.append([_most(position), _most(rotation), greatest_step(piece), _least_room(robot, piece)])
    position_error, rotation_error, step, short_room = zip(*figures, strict=True)
    return Verification(
        passed=not failures,
        samples=asked.standoff.size,
        blend_samples=on_blends,
        reversals_per_joint=tuple(map(len, turned)),
        max_position_error=max(position_error),
        max_rotation_error=max(rotation_error),
        max_joint_step=max(step),
        min_limit_distance=min(short_room),
        failures=tuple(failures),
        subject=subject(robot, tool, settings, hole_plan) if (samples, blend_samples) == USUAL else None,
    )


def known_as_checked(plan: Plan) -> Plan:
    """The plan, taken as it says of its own checks; for a caller who knows that they were made of what stands in it.

    Args:
        plan: as read from a file that is known (`zerorev.files.checked_files`).
    """

    def known(strokes: Plan) -> Plan:
        robot, tool, settings = strokes.robot, strokes.tool, strokes.settings
        holes = tuple(
            hole
            if hole.verified is None
            else replace(hole, verified=replace(hole.verified, subject=subject(robot, tool, settings, hole)))
            for hole in strokes.holes
        )
        return replace(strokes, holes=holes)

    return stroke_by_stroke(plan, known)


def subject(robot: Robot, tool: Tool, settings: Settings, hole_plan: HolePlan) -> str:
    """Fingerprint of what the program of a hole is made of: of equal ones the check finds the same.

    Args:
        robot: the arm.
        tool: the drill.
        settings: as planned.
        hole_plan: the hole, its motion and what is claimed of that.
    """
    own, settings = hole_plan, settings.of(hole_plan.hole)
    return fingerprint(
        robot, tool, settings, own.hole, own.status, own.motion, own.score, own.wrist_offset, own.corner, own.clearance
    )


def _blends(profile: Profile, settings: Settings) -> list[tuple[int, float]]:
    """The inner breakpoints at which the motion does not stop, and the radius [m] of the blend at each."""
    inner = range(1, profile.standoff.size - 1)
    radii = [(k, settings.corner_blend if k == profile.corner else settings.passing_blend) for k in inner]
    return [(k, radius) for k, radius in radii if radius > 0]


def _least_room(robot: Robot, track: Track) -> float:
    """Least distance of a joint to its limits [rad] over the samples that are in reach."""
    room = least_room(robot, track)
    if np.isnan(room).any():
        room = limit_distances(robot, track.joints)
    return -_most(-room)


def _most(values: Array) -> float:
    """The greatest value that is not NaN; NaN where there is none."""
    most = values.max()
    return float(np.fmax.reduce(values, axis=None) if np.isnan(most) else most)
