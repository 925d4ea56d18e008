"""The controller-neutral program: what every controller's file says, before any dialect.

The tool frame *as written* has X along the plunge (X = -Z_tcp), Y = Y_tcp and so Z = X_tcp. The hole's axis is then the
X direction of every pose of a hole, and the spin is a turn about X alone: of KUKA's angles (A, B, C about Z, Y', X'')
only C varies along a hole, for any direction of the hole. The tool as the thesis draws it does not have this, and
passes the singularity of those angles within the range of position 1.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace

import numpy as np

from zerorev.errors import NotExportableError
from zerorev.model._arrays import Array, transform
from zerorev.model.dynamics import Load
from zerorev.model.finding import Finding
from zerorev.model.job import Settings
from zerorev.model.plan import HolePlan, Plan
from zerorev.motion.kinematics import tcp_pose
from zerorev.program.between import moves_between
from zerorev.program.plan_mark import plan_mark
from zerorev.program.refusals import left_out, refusals
from zerorev.program.waypoints import Leg, Waypoint, waypoints, with_blends
from zerorev.program.ways import Stop, stop_of

__all__ = ["HoleProgram", "JointMove", "LinearMove", "Program", "build_program", "split"]

T_TCP_TOOL = transform(np.array([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]]), np.zeros(3))
"""The tool frame as written, in the tcp frame."""


@dataclass(frozen=True)
class JointMove:
    """A move of all axes at once, to the point where a hole's linear moves begin; the tool stops there.

    Attributes:
        joints: controller angles with turns [rad], shape (6,).
        T_part_tool: the pose it arrives at, shape (4, 4), translation [m].
        standoff: [m].
        psi: spin [rad].
    """

    joints: Array
    T_part_tool: Array
    standoff: float
    psi: float


@dataclass(frozen=True)
class LinearMove:
    """A straight move of the tool tip, the tool turning evenly about the drill axis.

    Attributes:
        T_part_tool: where it ends, shape (4, 4), translation [m].
        standoff: where it ends [m].
        psi: spin where it ends [rad], with turns, so that the sense of the turn can be read.
        feed: of the tip [m/s].
        blend: radius at its end [m]; 0 is an exact stop.
        leg: which part of the motion it belongs to.
        comment: what its end is.
    """

    T_part_tool: Array
    standoff: float
    psi: float
    feed: float
    blend: float
    leg: Leg
    comment: str


@dataclass(frozen=True)
class HoleProgram:
    """The moves of one hole.

    Attributes:
        id: of the hole.
        axis: unit plunge direction in the part frame, shape (3,).
        depth: stroke [m].
        way: joints through which moves of all axes lead to the start, with a stop at each [rad], shape (n, 6).
        start: the move to where the linear moves begin.
        lead_in: length run along the plunge leg before the stroke begins [m].
        moves: in order.
        corner: index of the move that ends at the turning point of the motion.
        reversals_per_joint: as planned, shape (6,).
        number: of the hole among all of the plan, as they are listed, from 1.
    """

    id: str
    axis: Array
    depth: float
    way: Array
    start: JointMove
    lead_in: float
    moves: tuple[LinearMove, ...]
    corner: int
    reversals_per_joint: tuple[int, ...]
    number: int = 1

    @property
    def corner_move(self) -> LinearMove:
        """The move that ends at the turning point."""
        return self.moves[self.corner]


@dataclass(frozen=True)
class Program:
    """A plan as moves, before any dialect.

    Attributes:
        name: of the plan.
        robot: name of the robot file.
        manufacturer: of the robot.
        model: the maker's name of the robot.
        joint_names: as the controller shows them.
        tool: name of the tool.
        T_flange_tool: the tool frame as written, shape (4, 4), translation [m].
        T_base_part: the part frame, shape (4, 4), translation [m]; every pose is given in it.
        settings: how the motion is run.
        holes: as they are drilled.
        end: joints through which moves of all axes lead away from the last hole [rad], shape (n, 6).
        findings: what was shortened or left out on the way here.
        load: what hangs on the flange; None: not known.
        listed: how many holes the plan has.
        plan_file: name of the file that the plan is in; empty: of none.
        parts: how many holes each of the files has into which it is split; empty: it is one file.
    """

    name: str
    robot: str
    manufacturer: str
    model: str
    joint_names: tuple[str, ...]
    tool: str
    T_flange_tool: Array
    T_base_part: Array
    settings: Settings
    holes: tuple[HoleProgram, ...]
    end: Array
    findings: tuple[Finding, ...] = ()
    load: Load | None = None
    listed: int = 0
    plan_file: str = ""
    parts: tuple[int, ...] = ()

    @property
    def mark(self) -> str:
        """By which the programs of the plan are known."""
        return plan_mark(self.name, self.plan_file)


def build_program(
    plan: Plan, *, skip_failed: bool = False, only: Collection[str] | None = None, plan_file: str = ""
) -> Program:
    """Make the moves of a plan.

    Args:
        plan: verified, without error findings.
        skip_failed: leave out the holes that must not be exported, and say so in a finding, instead of refusing.
        only: ids of the holes that are wanted; None: all.
        plan_file: name of the file that the plan is in; empty: of none.

    Raises:
        NotExportableError: a hole that was not verified, has an error finding or has no motion; with `skip_failed`,
            only where no hole is left or the plan as a whole has an error finding. A move between holes that leads
            through the part.
    """
    refused = refusals(plan)
    if only is not None:
        refused = {hole_id: why for hole_id, why in refused.items() if hole_id is None or hole_id in only}
    wanted = [hole for hole in plan.in_order if only is None or hole.hole.id in only]
    kept = [hole for hole in wanted if hole.hole.id not in refused]
    if None in refused or (refused and not skip_failed) or not kept:
        reasons = (f"{'the plan' if hole_id is None else f'hole {hole_id}'}: {why}" for hole_id, why in refused.items())
        raise NotExportableError(tuple(reasons) or ("the plan has no holes",))
    findings = left_out(plan, refused)
    stops = [_stop(plan, hole) for hole in kept]
    ways, end = _between(plan, stops)
    numbers = {hole.hole.id: number for number, hole in enumerate(plan.holes, start=1)}
    holes = [
        replace(_hole_program(plan, hole, stop, way), number=numbers[hole.hole.id])
        for hole, stop, way in zip(kept, stops, ways, strict=True)
    ]
    findings += [finding for stop in stops for finding in stop.way.findings]
    return Program(
        name=plan.name,
        robot=plan.robot.name,
        manufacturer=plan.robot.manufacturer,
        model=plan.robot.model,
        joint_names=plan.robot.joint_names,
        tool=plan.tool.name,
        T_flange_tool=plan.tool.T_flange_tcp @ T_TCP_TOOL,
        T_base_part=plan.T_base_part,
        settings=plan.settings,
        holes=tuple(holes),
        end=end,
        findings=tuple(findings),
        load=plan.tool.load,
        listed=len(plan.holes),
        plan_file=plan_file,
    )


def split(program: Program) -> tuple[Program, ...]:
    """The parts of a program, each with its own holes; none where it is one file.

    A part begins where the one before it ends, and only the last one leads away from its last hole.
    """
    ends = np.cumsum(program.parts)
    return tuple(
        replace(
            program,
            holes=program.holes[end - size : end],
            end=program.end if end == len(program.holes) else program.end[:0],
            parts=(),
        )
        for size, end in zip(program.parts, ends, strict=True)
    )


def _stop(plan: Plan, hole: HolePlan) -> Stop:
    assert hole.motion is not None  # _why_not has seen to it
    return stop_of(plan.robot, plan.tool, plan.settings, hole.hole, hole.motion)


def _between(plan: Plan, stops: Sequence[Stop]) -> tuple[list[Array], Array]:
    """The points through which all axes move before each hole, and after the last one [rad], shape (n, 6) each.

    Raises:
        NotExportableError: a move leads through the part.
    """
    moves = moves_between(plan.robot, plan.tool, plan.settings, stops)
    errors = [finding.message for move in moves for finding in move.findings if finding.level == "error"]
    if errors:
        raise NotExportableError(tuple(errors))
    if plan.settings.home_joints is not None:
        return [moves[0].joints[:-1], *(move.joints[1:-1] for move in moves[1:-1])], moves[-1].joints[1:]
    return [stops[0].way.arrival[:-1], *(move.joints[1:-1] for move in moves)], stops[-1].way.departure[1:]


def _hole_program(plan: Plan, hole: HolePlan, stop: Stop, way: Array) -> HoleProgram:
    motion, settings = hole.motion, plan.settings
    assert motion is not None
    lead_in, approach, retract = stop.way.lead_in, stop.way.approach, stop.way.retract
    points, corner = waypoints(motion.profile, lead_in.length)
    points = with_blends(points, corner, settings)
    if approach.length > 0:
        ahead = replace(points[0], standoff=points[0].standoff + approach.length)
        points = (ahead, replace(points[0], leg="approach"), *points[1:])
        corner += 1
    if retract.length > 0:
        out = points[-1].standoff + retract.length
        points = (*points, Waypoint(out, points[-1].psi, "depart", "retracted"))
    T_part_base = np.asarray(np.linalg.inv(plan.T_base_part), dtype=np.float64)
    poses = [_tool_pose(T_part_base, hole, point) for point in points]
    moves = tuple(
        LinearMove(
            pose,
            point.standoff,
            point.psi,
            settings.feed_plunge if point.leg in ("lead-in", "plunge") else settings.feed_retract,
            point.blend,
            point.leg,
            point.comment,
        )
        for point, pose in zip(points[1:], poses[1:], strict=True)
    )
    return HoleProgram(
        id=hole.hole.id,
        axis=T_part_base[:3, :3] @ hole.hole.direction,
        depth=float(motion.profile.standoff[0]),
        way=way,
        start=JointMove(approach.joints, poses[0], points[0].standoff, points[0].psi),
        lead_in=lead_in.length,
        moves=moves,
        corner=corner - 1,
        reversals_per_joint=hole.score.reversals_per_joint if hole.score else (0,) * 6,
    )


def _tool_pose(T_part_base: Array, hole: HolePlan, point: Waypoint) -> Array:
    return np.asarray(T_part_base @ tcp_pose(hole.hole, point.standoff, point.psi) @ T_TCP_TOOL)
