"""Is a program that is read back the one of this plan: its frames, its points, its blends, its feeds.

All but the rounding of the printed numbers must agree, so that a stale program, or one edited by hand, is refused. That
the statements are those of `export` is compared elsewhere (`zerorev.program.as_exported`); here the points are held to
the plan by geometry alone, so that a fault of `export` does not certify itself.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from zerorev.model._arrays import Array, rotation_rpy, transform
from zerorev.model.plan import HolePlan, Motion, Plan
from zerorev.model.written import Six, WrittenHole, WrittenProgram
from zerorev.verify.arm import branch_of, skeleton

__all__ = ["Places", "frames_as_planned", "moves_as_planned", "places"]

LENGTH = 3e-7  # [m]: four decimals of a millimetre in three coordinates, of the point and of $BASE
BY_AXES = 2e-6  # [m]: five decimals of a degree in six axes, over a lever of up to three metres
ANGLE = float(np.deg2rad(3e-4))  # four decimals of a degree in three angles
FRAME_ANGLE = float(np.deg2rad(3e-6))  # six decimals
FEED = 1e-6  # [m/s]: six decimals
TURN = float(np.deg2rad(179.0))  # no move may turn the tool further: the short way round would be in doubt
AS_WRITTEN = transform(np.array([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]]), np.zeros(3))
"""The tool frame of a program, X along the plunge, in the tcp frame (docs/howto/program.md)."""


class Places(NamedTuple):
    """The points of a hole's moves, the first of them where its axis values lead; n points.

    Attributes:
        T_base_tool: poses of the program's tool frame, shape (n, 4, 4), translation [m].
        standoff: along the planned axis [m], shape (n,).
        first: index of the point at which the lead-in begins; before it is the approach, in the air.
        lead: index of the point at which the stroke begins.
        corner: index of the deepest point.
        last: index of the point at which the stroke ends; after it the tool is retracted, in the air.
    """

    T_base_tool: Array
    standoff: Array
    first: int
    lead: int
    corner: int
    last: int


def places(plan: Plan, hole_plan: HolePlan, program: WrittenProgram, written: WrittenHole) -> Places:
    """Where the points of a hole's moves lie.

    Args:
        plan: whose robot it is.
        hole_plan: whose axis it is.
        program: whose frames the points are given in.
        written: the moves.
    """
    body = skeleton(plan.robot.arm, np.deg2rad(_floats(written.axes_deg))[None])
    begin = transform(body.R_base_flange[:, :, 0], body.flange[:, 0]) @ _frame(program.tool_mm_deg)
    T_base_part = np.linalg.inv(_world(plan)) @ _frame(program.base_mm_deg)
    poses = np.stack([begin, *(T_base_part @ _frame(move.point_mm_deg) for move in written.moves)])
    hole = hole_plan.hole
    standoff = (hole.target - poses[:, :3, 3]) @ hole.direction
    corner = int(np.argmin(standoff))
    # on the stroke and its lead-in every point but the corner is blended
    stops = [k for k, move in enumerate(written.moves[:-1], start=1) if not move.blend_mm and k != corner]
    first, last = int(1 in stops), len(poses) - 1 - int(len(poses) - 2 in stops)
    # where the tool is already at the start of the stroke, there is no lead-in
    lead = first + int(np.argmin(np.abs(standoff[first : corner + 1] - hole.depth)))
    return Places(poses, standoff, first, lead, corner, last)


def frames_as_planned(plan: Plan, program: WrittenProgram) -> Iterator[str]:
    """$TOOL and $BASE must be the plan's."""
    for name, planned, printed in (
        ("$TOOL", plan.tool.T_flange_tcp @ AS_WRITTEN, program.tool_mm_deg),
        ("$BASE", _world(plan) @ plan.T_base_part, program.base_mm_deg),
    ):
        off, turned = _apart(planned[None], _frame(printed)[None])
        if off[0] > LENGTH or turned[0] > FRAME_ANGLE:
            yield f"{name} of the program is {_mm(off[0])} and {_deg(turned[0])} off the plan's"


def moves_as_planned(
    plan: Plan, hole_plan: HolePlan, motion: Motion, written: WrittenHole, at: Places
) -> Iterator[str]:
    """The points must lie on the planned path, in order, all its breakpoints among them; blends and feeds its own.

    Args:
        plan: robot and settings.
        hole_plan: the drill axis.
        motion: its motion.
        written: the moves.
        at: their points.
    """
    profile, settings = motion.profile, plan.settings
    names = ["the first point", *(f"line {move.line}" for move in written.moves)]
    steps = np.diff(at.standoff)
    if not (0 < at.corner < len(steps) and (steps[: at.corner] < 0).all() and (steps[at.corner :] > 0).all()):
        yield "the points do not lead in to one deepest point and out again"
        return

    # distance along the planned path, below 0 before the stroke; the corner is where the plan has it
    depth, corner = float(profile.standoff[0]), float(profile.standoff.min())
    inwards = np.arange(len(at.standoff)) <= at.corner
    distance = np.where(inwards, depth - at.standoff, depth + at.standoff - 2 * corner)
    knots = profile.distance
    turning = np.clip(distance, distance[at.first], 0)  # the lead-in; in the air the spin stays
    psi = np.interp(distance, knots, profile.psi) + turning * -profile.twist_rate[0]
    off, turned = _apart(_poses(hole_plan, at.standoff, psi), at.T_base_tool)
    slack = np.where(np.arange(len(distance)) == 0, BY_AXES, LENGTH)
    steepest = float(np.abs(profile.twist_rate).max())
    for name, apart, angle, length in zip(names, off, turned, slack, strict=True):
        if apart > length or angle > ANGLE + length * steepest:
            yield f"{name} lies {_mm(apart)} off the planned axis, the tool turned {_deg(angle)} from the planned spin"
    for standoff, knot in zip(profile.standoff, knots, strict=True):
        if (np.abs(distance - knot) > slack).all():
            yield f"no point of the program lies at the plan's breakpoint at stand-off {_mm(standoff)}"
    in_the_air = distance[at.first] - distance[0], distance[-1] - distance[at.last]
    if (
        distance[at.first] < -settings.lead_in - slack[at.first]
        or in_the_air[0] > settings.approach + slack[0]
        or abs(distance[at.last] - knots[-1]) > LENGTH
        or in_the_air[1] > settings.retract + LENGTH
    ):
        yield f"the program runs from {_mm(at.standoff[0])} to {_mm(at.standoff[-1])} of stand-off, beyond the plan"
    for name, turn in zip(names[1:], np.abs(np.diff(psi)), strict=True):
        if turn > TURN:
            yield f"{name} turns the tool by {_deg(turn)}: the short way round is another one"
    if (branch := branch_of(plan.robot.arm, np.deg2rad(_floats(written.axes_deg)))) != motion.branch:
        yield f"the axis values at line {written.line} are of branch {branch}, the plan says {motion.branch}"

    for k, move in enumerate(written.moves[:-1], start=1):
        asked = settings.blend if k == at.corner else 0.0 if k in (at.first, at.last) else settings.passing_blend
        fits = min(asked, abs(steps[k - 1]) / 2, abs(steps[k]) / 2)
        blend = float(move.blend_mm) * 1e-3
        if abs(blend - fits) > LENGTH or (blend > 0) != (asked > 0):
            yield f"line {move.line} is blended by {_mm(blend)}, the plan asks for {_mm(fits)}"
    for k, move in enumerate(written.moves):
        feed = settings.feed_plunge if at.first <= k < at.corner else settings.feed_retract
        if abs(float(move.feed_m_s) - feed) > FEED:
            yield f"line {move.line} has a feed of {float(move.feed_m_s) * 1e3:g} mm/s, the plan {feed * 1e3:g} mm/s"


def _world(plan: Plan) -> Array:
    """The robot's base in the frame from which $BASE counts, shape (4, 4), translation [m]."""
    if not isinstance(plan.settings.robroot, tuple):
        return np.eye(4)
    x, y, z, roll, pitch, yaw = plan.settings.robroot
    return transform(rotation_rpy(roll, pitch, yaw), np.array([x, y, z]))


def _poses(hole_plan: HolePlan, standoff: Array, psi: Array) -> Array:
    """The tool frame as written at stand-offs [m] and spins [rad], each (n,): shape (n, 4, 4)."""
    hole = hole_plan.hole
    y = np.cos(psi)[:, None] * hole.psi_zero + np.sin(psi)[:, None] * np.cross(-hole.direction, hole.psi_zero)
    x = np.broadcast_to(hole.direction, y.shape)
    T = np.broadcast_to(np.eye(4), (len(psi), 4, 4)).copy()
    T[:, :3, :3] = np.stack([x, y, np.cross(x, y)], axis=-1)
    T[:, :3, 3] = hole.target - standoff[:, None] * hole.direction
    return T


def _apart(first: Array, second: Array) -> tuple[Array, Array]:
    """Distance [m] and angle [rad] between poses, (n, 4, 4) each: shape (n,) each."""
    off = np.linalg.norm(first[:, :3, 3] - second[:, :3, 3], axis=1)
    chord = np.linalg.norm(first[:, :3, :3] - second[:, :3, :3], axis=(1, 2)) / np.sqrt(8)
    return off, 2 * np.arcsin(np.minimum(chord, 1.0))


def _frame(values_mm_deg: Six) -> Array:
    values = _floats(values_mm_deg)
    A, B, C = np.deg2rad(values[3:])
    return transform(rotation_rpy(float(C), float(B), float(A)), values[:3] * 1e-3)


def _floats(values: Six) -> Array:
    return np.array([float(value) for value in values])


def _mm(length: float) -> str:
    return f"{length * 1e3 + 0.0:.4g} mm"


def _deg(angle: float) -> str:
    return f"{np.rad2deg(angle):.4g} deg"
