"""The controller-neutral program: what every controller's file says, before any dialect.

Every point carries its joints with turns beside its pose, so that a dialect may write either. Poses are those of the
tcp frame; how the axes of the tool lie that a dialect writes is its own choice.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from zerorev.errors import NotExportableError
from zerorev.model._arrays import Array
from zerorev.model.finding import Finding
from zerorev.model.job import Settings
from zerorev.model.plan import HolePlan, Plan
from zerorev.model.robot import Robot
from zerorev.model.tool import Tool
from zerorev.motion.drilling import Drilling
from zerorev.motion.joint_path import FULL_TURN, joints_along
from zerorev.motion.kinematics import tcp_pose
from zerorev.program.between import moves_between
from zerorev.program.plan_mark import plan_mark
from zerorev.program.refusals import left_out, refusals
from zerorev.program.stroke_points import feed_of, points_of
from zerorev.program.waypoints import Leg, Waypoint
from zerorev.program.ways import Stop, stop_of

__all__ = ["HoleProgram", "Move", "Point", "Program", "build_program", "split"]

BETWEEN = 64  # samples from point to point, along which the joints are followed


@dataclass(frozen=True)
class Point:
    """A point of a hole's motion.

    Attributes:
        T_part_tcp: pose of the tcp frame, shape (4, 4), translation [m].
        joints: controller angles with turns [rad], shape (6,).
        standoff: [m].
        psi: spin [rad], with turns, so that the sense of a turn can be read.
    """

    T_part_tcp: Array
    joints: Array
    standoff: float
    psi: float


@dataclass(frozen=True)
class Move:
    """A move to a point: straight, the tool turning evenly about the drill axis; or of all joints evenly.

    Attributes:
        end: where it ends.
        length: along the drill axis [m].
        feed: of the tip [m/s].
        blend: radius at its end [m]; 0 is an exact stop.
        leg: which part of the motion it belongs to.
        comment: what its end is.
        linear: whether the tip goes straight.
        wait: for which the tool stands at its end [s].
    """

    end: Point
    length: float
    feed: float
    blend: float
    leg: Leg
    comment: str
    linear: bool = True
    wait: float = 0.0

    @property
    def standoff(self) -> float:
        """Where it ends [m]."""
        return self.end.standoff

    @property
    def psi(self) -> float:
        """Spin where it ends [rad]."""
        return self.end.psi

    @property
    def time(self) -> float:
        """That it takes at its feed [s]."""
        return self.length / self.feed


@dataclass(frozen=True)
class HoleProgram:
    """The moves of one hole.

    Attributes:
        id: of the hole.
        axis: unit plunge direction in the part frame, shape (3,).
        depth: stroke [m].
        way: joints through which moves of all axes lead to the start, with a stop at each [rad], shape (n, 6).
        start: to which all axes move, and where the tool stops before the moves of the hole begin.
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
    start: Point
    lead_in: float
    moves: tuple[Move, ...]
    corner: int
    reversals_per_joint: tuple[int, ...]
    number: int = 1

    @property
    def corner_move(self) -> Move:
        """The move that ends at the turning point."""
        return self.moves[self.corner]


@dataclass(frozen=True)
class Program:
    """A plan as moves, before any dialect.

    Attributes:
        name: of the plan.
        robot: the arm.
        tool: the drill.
        T_base_part: the part frame, shape (4, 4), translation [m]; every pose is given in it.
        settings: how the motion is run.
        holes: as they are drilled.
        end: joints through which moves of all axes lead away from the last hole [rad], shape (n, 6).
        findings: what was shortened or left out on the way here.
        listed: how many holes the plan has.
        plan_file: name of the file that the plan is in; empty: of none.
        parts: how many holes each of the files has into which it is split; empty: it is one file.
    """

    name: str
    robot: Robot
    tool: Tool
    T_base_part: Array
    settings: Settings
    holes: tuple[HoleProgram, ...]
    end: Array
    findings: tuple[Finding, ...] = ()
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
        robot=plan.robot,
        tool=plan.tool,
        T_base_part=plan.T_base_part,
        settings=plan.settings,
        holes=tuple(holes),
        end=end,
        findings=tuple(findings),
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
    return [stops[0].way.arrival[:-1], *(move.joints[1:-1] for move in moves)], stops[-1].departure[1:]


def _hole_program(plan: Plan, hole: HolePlan, stop: Stop, way: Array) -> HoleProgram:
    motion, settings = hole.motion, plan.settings.of(hole.hole)
    assert motion is not None
    lead_in, approach = stop.way.lead_in, stop.way.approach
    points, corner = points_of(settings, motion, hole.corner, stop.way)
    T_part_base = np.asarray(np.linalg.inv(plan.T_base_part), dtype=np.float64)
    joints = _joints(Drilling.of(plan, hole.hole), motion.branch, points, approach.joints)
    ends = [
        Point(np.asarray(T_part_base @ tcp_pose(hole.hole, each.standoff, each.psi)), row, each.standoff, each.psi)
        for each, row in zip(points, joints, strict=True)
    ]
    moves = tuple(
        Move(
            end,
            abs(point.standoff - before.standoff),
            feed_of(settings, hole.corner, before, point),
            point.blend,
            point.leg,
            point.comment,
            point.linear,
            settings.standing if point is points[corner] else 0.0,
        )
        for (before, point), end in zip(pairwise(points), ends[1:], strict=True)
    )
    return HoleProgram(
        id=hole.hole.id,
        axis=T_part_base[:3, :3] @ hole.hole.direction,
        depth=float(motion.profile.standoff[0]),
        way=way,
        start=ends[0],
        lead_in=lead_in.length,
        moves=moves,
        corner=corner - 1,
        reversals_per_joint=hole.score.reversals_per_joint if hole.score else (0,) * 6,
    )


def _joints(drilling: Drilling, branch: int, points: Sequence[Waypoint], first: Array) -> Array:
    """Joints with turns at some points of a motion [rad], shape (n, 6), those at the first point as given."""
    samples = np.concatenate([np.arange(0, len(points) - 1, 1 / BETWEEN), [len(points) - 1.0]])
    numbers = np.arange(len(points), dtype=float)
    standoff, psi = (
        np.interp(samples, numbers, [getattr(each, name) for each in points]) for name in ("standoff", "psi")
    )
    found = joints_along(drilling, branch, standoff, psi)[::BETWEEN]
    return np.asarray(found + FULL_TURN * np.round((first - found[0]) / FULL_TURN))
