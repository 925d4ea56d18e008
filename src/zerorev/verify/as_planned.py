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
from zerorev.model.profile import Profile
from zerorev.model.written import WrittenFrame, WrittenHole, WrittenJoints, WrittenProgram
from zerorev.verify.arm import branch_of, skeleton
from zerorev.verify.paces import paces_differ, spins_differ, waits_differ
from zerorev.verify.printed import angle_slack, frame_of, half_a_unit, joints_of, length_slack

__all__ = ["Places", "frames_as_planned", "moves_as_planned", "places"]

TURN = float(np.deg2rad(179.0))  # no move may turn the tool further: the short way round would be in doubt
NUMBERED = transform(np.diag([1.0, -1.0, -1.0]), np.zeros(3))
"""The tool frame of a program that has only its number, Z along the plunge, in the tcp frame."""


class Places(NamedTuple):
    """The points of a hole's moves, the first of them where its axis values lead; n points.

    Attributes:
        T_base_tcp: poses of the tcp frame, shape (n, 4, 4), translation [m].
        standoff: along the planned axis [m], shape (n,).
        first: index of the point at which the lead-in begins; before it is the approach, in the air.
        lead: index of the point at which the stroke begins.
        corner: index of the deepest point.
        last: index of the point at which the stroke ends; after it the tool is retracted, in the air.
    """

    T_base_tcp: Array
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
    T_flange_tool = _tool(plan, program)
    T_base_part = np.linalg.inv(_world(plan)) @ _part(plan, program)

    def pose(end: WrittenFrame | WrittenJoints) -> Array:
        if isinstance(end, WrittenFrame):
            return T_base_part @ frame_of(end)
        body = skeleton(plan.robot.arm, joints_of(plan.robot, end)[None])
        return transform(body.R_base_flange[:, :, 0], body.flange[:, 0]) @ T_flange_tool

    T_tool_tcp = _axes(plan, T_flange_tool).T  # a rotation
    poses = np.stack([pose(written.start), *(pose(move.end) for move in written.moves)]) @ T_tool_tcp
    hole = hole_plan.hole
    standoff = (hole.target - poses[:, :3, 3]) @ hole.direction
    corner = _deepest(plan, hole_plan, written, standoff)
    # on the stroke and its lead-in every point but the corner is blended
    stops = [k for k, move in enumerate(written.moves[:-1], start=1) if move.stops and k != corner]
    first, last = int(1 in stops), len(poses) - 1 - int(len(poses) - 2 in stops)
    # where the tool is already at the start of the stroke, there is no lead-in
    lead = first + int(np.argmin(np.abs(standoff[first : corner + 1] - hole.depth)))
    return Places(poses, standoff, first, lead, corner, last)


def _deepest(plan: Plan, hole_plan: HolePlan, written: WrittenHole, standoff: Array) -> int:
    """The index of the deepest point; where the tool spins on before it, the last digits do not tell.

    It is then where the last of the joint moves begins, if that is no less deep but for what the tool creeps in, and
    for the digits.
    """
    lowest = int(np.argmin(standoff))
    if hole_plan.corner is None or not hole_plan.corner.spin_moves:
        return lowest
    jointly = [k for k, move in enumerate(written.moves) if not move.linear]
    last = jointly[-1] if jointly else lowest
    slack = sum(length_slack(plan.robot, written.moves[max(k - 1, 0)].end) for k in (lowest, last))
    creep = plan.settings.of(hole_plan.hole).creep
    return last if standoff[last] - standoff[lowest] <= creep + slack else lowest


def frames_as_planned(plan: Plan, program: WrittenProgram) -> Iterator[str]:
    """The tool frame and the part frame must be the plan's, but for how a dialect names the axes of the tool."""
    if program.tool is not None:
        printed = frame_of(program.tool)
        off, turned = _apart((plan.tool.T_flange_tcp @ _axes(plan, printed))[None], printed[None])
        if off[0] > length_slack(plan.robot, program.tool) or turned[0] > angle_slack(plan.robot, program.tool):
            yield f"the tool frame of the program is {_mm(off[0])} and {_deg(turned[0])} off the plan's"
    # points that are given from the controller's own base are held to the plan one by one
    if program.base is not None and any((*program.base.xyz_mm, *program.base.turn)):
        off, turned = _apart((_world(plan) @ plan.T_base_part)[None], frame_of(program.base)[None])
        if off[0] > length_slack(plan.robot, program.base) or turned[0] > angle_slack(plan.robot, program.base):
            yield f"the part frame of the program is {_mm(off[0])} and {_deg(turned[0])} off the plan's"


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
    profile, settings = motion.profile, plan.settings.of(hole_plan.hole)
    names = ["the first point", *(f"line {move.line}" for move in written.moves)]
    steps = np.diff(at.standoff)
    ends = [written.start, *(move.end for move in written.moves)]
    slack = np.array([length_slack(plan.robot, end) for end in ends])
    slack_angle = np.array([angle_slack(plan.robot, end) for end in ends])

    # distance along the planned path, below 0 before the stroke, beyond its length after it
    depth, knots = float(profile.standoff[0]), profile.distance
    distance = np.concatenate([[0.0], np.cumsum(np.abs(steps))])
    distance += depth - float(at.standoff[at.lead]) - distance[at.lead]
    planned = profile.at(distance)[0] + np.maximum(-distance, 0) + np.maximum(distance - knots[-1], 0)
    beside = np.abs(planned - at.standoff) > np.cumsum(2 * slack)
    count = hole_plan.corner.spin_moves or 0 if hole_plan.corner else 0
    spins = range(at.corner - count, at.corner)  # the moves on which the tool spins on
    still = any(step == 0 for k, step in enumerate(steps) if k not in spins)
    if not (count < at.corner < len(steps) and count < profile.corner) or still or beside.any():
        place = f", first at {names[int(np.argmax(beside))]}" if beside.any() else ""
        yield f"the points do not lead in to one deepest point and out again as planned{place}"
        return
    distance = _along(profile, distance, at.standoff)
    if count:  # so close to each other that the last digits do not tell where on the path they lie
        distance[at.corner - count : at.corner + 1] = knots[profile.corner - count : profile.corner + 1]

    turning = np.clip(distance, distance[at.first], 0)  # the lead-in; in the air the spin stays
    psi = np.interp(distance, knots, profile.psi) + turning * -profile.twist_rate[0]
    off, turned = _apart(_poses(hole_plan, at.standoff, psi), at.T_base_tcp)
    drilled = np.delete(profile.twist_rate, np.arange(profile.corner - count, profile.corner))
    steepest = float(np.abs(drilled).max())
    for name, apart, angle, length, little in zip(names, off, turned, slack, slack_angle, strict=True):
        if apart > length or angle > little + length * steepest:
            yield f"{name} lies {_mm(apart)} off the planned axis, the tool turned {_deg(angle)} from the planned spin"
    for standoff, knot in zip(profile.standoff, knots, strict=True):
        if (np.abs(distance - knot) > slack).all():
            yield f"no point of the program lies at the plan's breakpoint at stand-off {_mm(standoff)}"
    in_the_air = distance[at.first] - distance[0], distance[-1] - distance[at.last]
    if (
        distance[at.first] < -settings.lead_in - slack[at.first]
        or in_the_air[0] > settings.approach + slack[0]
        or abs(distance[at.last] - knots[-1]) > slack[at.last]
        or in_the_air[1] > settings.retract + slack[at.last]
    ):
        yield f"the program runs from {_mm(at.standoff[0])} to {_mm(at.standoff[-1])} of stand-off, beyond the plan"
    for name, turn in zip(names[1:], np.abs(np.diff(psi)), strict=True):
        if turn > TURN:
            yield f"{name} turns the tool by {_deg(turn)}: the short way round is another one"
    if (branch := branch_of(plan.robot.arm, joints_of(plan.robot, written.start))) != motion.branch:
        yield f"the axis values at line {written.line} are of branch {branch}, the plan says {motion.branch}"

    stops = hole_plan.corner is not None and hole_plan.corner.kind == "stop"
    yield from _blends_differ(plan, written, at, steps, 0.0 if stops else settings.turning.radius)
    yield from paces_differ(settings, plan.robot, written, at.standoff, range(at.first, at.corner), spins)
    if hole_plan.corner is not None and count:
        yield from spins_differ(plan.robot, written, spins, hole_plan.corner)
    yield from waits_differ(written, at.corner, settings.standing)


def _along(profile: Profile, distance: Array, standoff: Array) -> Array:
    """Where on the planned path points lie, by their stand-offs on the piece that leads to each [m], shape (n,).

    The way from point to point sums up what each is rounded by; it only says which piece it is.

    Args:
        profile: the path.
        distance: of the points, about [m], shape (n,).
        standoff: of the points [m], shape (n,).
    """
    middle = np.concatenate([distance[:1], (distance[1:] + distance[:-1]) / 2])
    piece = np.clip(np.searchsorted(profile.distance, middle) - 1, 0, len(profile.distance) - 2)
    sense = np.sign(np.diff(profile.standoff))[piece]
    return np.asarray(profile.distance[piece] + sense * (standoff - profile.standoff[piece]))


def _blends_differ(plan: Plan, written: WrittenHole, at: Places, steps: Array, at_corner: float) -> Iterator[str]:
    """Blends must be as large as asked for, as far as a share of the shorter neighbouring move allows."""
    settings = plan.settings
    for k, move in enumerate(written.moves[:-1], start=1):
        asked = at_corner if k == at.corner else 0.0 if k in (at.first, at.last) else settings.passing_blend
        fits = settings.blend_share * float(min(abs(steps[k - 1]), abs(steps[k])))
        fits = min(asked, fits)
        if move.stops != (asked == 0):
            yield f"line {move.line} {'stops' if move.stops else 'is blended'}, the plan asks for {_mm(fits)} of blend"
        elif move.blend_mm is not None:
            blend = float(move.blend_mm) * 1e-3
            if abs(blend - fits) > length_slack(plan.robot, move.end) + half_a_unit(move.blend_mm) * 1e-3:
                yield f"line {move.line} is blended by {_mm(blend)}, the plan asks for {_mm(fits)}"


def _world(plan: Plan) -> Array:
    """The arm's base in the frame from which the part frame of a program counts, shape (4, 4), translation [m]."""
    from_base = np.linalg.inv(_placed(plan.robot.base_in_root))
    root = plan.settings.robroot
    return np.asarray((_placed(root) if isinstance(root, tuple) else np.eye(4)) @ from_base)


def _placed(frame: tuple[float, ...] | None) -> Array:
    """x, y, z [m], roll, pitch, yaw [rad] as a transform; None: none."""
    x, y, z, roll, pitch, yaw = frame or (0.0,) * 6
    return transform(rotation_rpy(roll, pitch, yaw), np.array([x, y, z]))


def _tool(plan: Plan, program: WrittenProgram) -> Array:
    """The tool frame of a program in the flange frame, shape (4, 4), translation [m]."""
    return plan.tool.T_flange_tcp @ NUMBERED if program.tool is None else frame_of(program.tool)


def _axes(plan: Plan, T_flange_tool: Array) -> Array:
    """How the axes of a program's tool lie in the tcp frame: each along one of that, shape (4, 4)."""
    axes = np.eye(4)
    axes[:3, :3] = np.rint(plan.tool.T_flange_tcp[:3, :3].T @ T_flange_tool[:3, :3])
    return axes


def _part(plan: Plan, program: WrittenProgram) -> Array:
    """The part frame of a program, from where it counts, shape (4, 4), translation [m]."""
    return _world(plan) @ plan.T_base_part if program.base is None else frame_of(program.base)


def _poses(hole_plan: HolePlan, standoff: Array, psi: Array) -> Array:
    """The tcp frame at stand-offs [m] and spins [rad], each (n,): shape (n, 4, 4)."""
    hole = hole_plan.hole
    y = np.cos(psi)[:, None] * hole.psi_zero + np.sin(psi)[:, None] * np.cross(-hole.direction, hole.psi_zero)
    z = np.broadcast_to(-hole.direction, y.shape)
    T = np.broadcast_to(np.eye(4), (len(psi), 4, 4)).copy()
    T[:, :3, :3] = np.stack([np.cross(y, z), y, z], axis=-1)
    T[:, :3, 3] = hole.target - standoff[:, None] * hole.direction
    return T


def _apart(first: Array, second: Array) -> tuple[Array, Array]:
    """Distance [m] and angle [rad] between poses, (n, 4, 4) each: shape (n,) each."""
    off = np.linalg.norm(first[:, :3, 3] - second[:, :3, 3], axis=1)
    chord = np.linalg.norm(first[:, :3, :3] - second[:, :3, :3], axis=(1, 2)) / np.sqrt(8)
    return off, 2 * np.arcsin(np.minimum(chord, 1.0))


def _mm(length: float) -> str:
    return f"{length * 1e3 + 0.0:.4g} mm"


def _deg(angle: float) -> str:
    return f"{np.rad2deg(angle):.4g} deg"
