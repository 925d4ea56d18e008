"""Is what a plan says of its motion true: branch, joints at the breakpoints, reversals, and the score's figures."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator

import numpy as np
import numpy.typing as npt

from zerorev.model.job import Settings
from zerorev.model.plan import HolePlan, Motion, Score
from zerorev.model.robot import Robot
from zerorev.model.tool import Tool
from zerorev.verify.arm import branch_of
from zerorev.verify.joint_corner import corner_figures
from zerorev.verify.measure import Reversals, mean_rates, slowest_at, travel
from zerorev.verify.path import Track
from zerorev.verify.sound import least_room, nearest_to_limit
from zerorev.verify.spin import spins_as_asked

__all__ = ["as_asked", "blend_keeps", "complete", "corner_keeps", "joints_stated", "reversals_claimed", "score_claimed"]

# lengths and rates for an arm of size 1 (`Robot.size`)
PLACE_TOLERANCE = 1e-9  # [m]
OFFSET_TOLERANCE = 1e-6  # [m]
JOINT_TOLERANCE = 1e-6  # [rad]; a plan file may have rounded its angles a little
TRAVEL_TOLERANCE = 1e-6  # relative
RATE_TOLERANCE = 0.02  # relative
SAMPLED = 0.01  # relative: of a greatest distance that is sampled
RATE_FLOOR = 2e-4  # [rad/m], about 1e-5 deg/mm


def complete(hole_plan: HolePlan) -> Iterator[str]:
    """A motion and a score must be there, of the right shapes, and finite."""
    motion, score = hole_plan.motion, hole_plan.score
    if motion is None:
        yield "there is no motion to check"
        return
    shape = (motion.profile.standoff.size, 6)
    if np.shape(motion.joints) != shape:
        yield f"the joints at the breakpoints have shape {np.shape(motion.joints)}, not {shape}"
    elif not np.isfinite(motion.joints).all():
        yield "the joints at the breakpoints have NaN or infinite among them"
    if score is None:
        yield "the plan claims nothing: it has no score"
        return
    figures: dict[str, tuple[npt.ArrayLike, tuple[int, ...]]] = {
        "reversals_per_joint": (score.reversals_per_joint, (6,)),
        "travel": (score.travel, ()),
        "min_rate": (score.min_rate, (6,)),
        "mean_rate": (score.mean_rate, (6,)),
        "limit_distance": (score.limit_distance, (6,)),
    }
    for name, (value, expected) in figures.items():
        if np.shape(value) != expected:
            yield f"the score's {name} has shape {np.shape(value)}, not {expected}"
        elif not np.isfinite(value).all():
            yield f"the score's {name} is NaN or infinite"


def as_asked(robot: Robot, tool: Tool, settings: Settings, hole_plan: HolePlan, motion: Motion) -> Iterator[str]:
    """The motion must drill the hole that was asked for, on the branch that is named."""
    hole, standoff = hole_plan.hole, motion.profile.standoff
    for end, where in ((standoff[0], "starts"), (standoff[-1], "ends")):
        if abs(end - hole.depth) > PLACE_TOLERANCE * robot.size:
            yield f"the motion {where} at {_mm(end)} of stand-off, not at the depth of {_mm(hole.depth)}"
    corner = standoff.min()
    if corner > PLACE_TOLERANCE * robot.size:
        yield f"the corner lies {_mm(corner)} short of the target"
    if corner < settings.corner_standoff - PLACE_TOLERANCE * robot.size:
        yield f"the corner lies {_mm(-corner)} behind the target, {_mm(-settings.corner_standoff)} are allowed"
    branch = branch_of(robot.arm, motion.joints[0])
    if branch != motion.branch:
        yield f"the joints at the start are of branch {branch}, the plan says {motion.branch}"
    if hole.branch is not None and hole.branch != motion.branch:
        yield f"branch {hole.branch} is asked for, the plan says {motion.branch}"
    if hole_plan.status == "planned":
        yield from _breaks_as_asked(robot, settings, hole_plan, motion)
        if settings.turning.kind == "spin":
            yield from spins_as_asked(robot, tool, settings, hole_plan, motion)
    bound = settings.psi_bound
    if hole_plan.status == "planned" and bound is not None:
        psi = float(np.abs(motion.profile.psi).max())
        if psi > bound + JOINT_TOLERANCE:
            yield f"a spin of {_deg(psi)} passes the bound of {_deg(bound)}"
    # the wrist centre is fixed in the tool: its distance from Z_tcp needs no arm
    T = tool.T_flange_tcp
    wrist = T[:3, :3].T @ (np.array([0.0, 0.0, -robot.arm.c4]) - T[:3, 3])
    offset = float(np.hypot(wrist[0], wrist[1]))
    if not abs(offset - hole_plan.wrist_offset) <= OFFSET_TOLERANCE * robot.size:
        yield f"the wrist centre is {_mm(offset)} off the drill axis, the plan says {_mm(hole_plan.wrist_offset)}"


def _breaks_as_asked(robot: Robot, settings: Settings, hole_plan: HolePlan, motion: Motion) -> Iterator[str]:
    """Chips must be broken where the cycle asks for it, by drawing back as far, and nowhere else."""
    hole, profile = hole_plan.hole, motion.profile
    cycle = hole.cycle or settings.cycle
    if (strokes := len(cycle.strokes(hole.depth))) > 1:
        yield f"{strokes} strokes are asked for, and there is one"
    wanted = [place for at in cycle.breaks(hole.depth) for place in (at, at + cycle.back)]
    found = [float(profile.standoff[k]) for k in profile.turns if k < profile.corner]
    if len(found) != len(wanted):
        yield f"the tool turns round {len(found)} times before the corner, {len(wanted)} times are asked for"
        return
    for there, asked in zip(found, wanted, strict=True):
        if abs(there - asked) > PLACE_TOLERANCE * robot.size:
            yield f"the tool turns round at {_mm(there)} of stand-off, asked is {_mm(asked)}"
            return


def corner_keeps(robot: Robot, tool: Tool, settings: Settings, hole_plan: HolePlan) -> Iterator[str]:
    """Joint moves at the corner must keep each joint's direction, and the tool as near to the axis as stated and asked.

    Args:
        robot: the arm.
        tool: the drill.
        settings: as planned.
        hole_plan: with a motion, and with what it states of its corner.
    """
    motion, corner = hole_plan.motion, hole_plan.corner
    if motion is None or corner is None:
        return
    asked = settings.turning.kind
    if corner.kind != asked and (corner.kind != "stop" or asked == "spin"):
        yield f"the corner is of kind {corner.kind}, asked is {asked}"
    if (corner.dwell or 0.0) != settings.standing and corner.kind != "spin":
        yield f"the tool stands at the corner for {corner.dwell or 0.0:g} s, asked are {settings.standing:g} s"
    spin = corner.spin_moves or 0
    if corner.kind not in ("joint", "spin") or not spin < motion.profile.corner:  # which is said elsewhere
        return
    if not 0 < corner.reach <= settings.turning.reach * (1 + 1e-9):
        asked_for = _mm(settings.turning.reach)
        yield f"the joint moves at the corner begin {_mm(corner.reach)} from it, asked are {asked_for}"
        return
    found = corner_figures(robot, tool, hole_plan.hole, motion, corner.reach, spin)
    for name, keeps in zip(robot.joint_names, found.keeps, strict=True):
        if not keeps:
            yield f"{name} moves another way on the joint moves at the corner than on the leg"
    # both are sampled, each in its own way
    if not found.off_axis <= corner.off_axis * (1 + SAMPLED) + PLACE_TOLERANCE * robot.size:
        stated = _mm(corner.off_axis)
        yield f"the tip leaves the drill axis by {_mm(found.off_axis)} at the corner, the plan says {stated}"
    if not found.tilt <= corner.tilt * (1 + SAMPLED) + JOINT_TOLERANCE:
        yield f"the tool tilts by {_deg(found.tilt)} at the corner, the plan says {_deg(corner.tilt)}"


def joints_stated(robot: Robot, motion: Motion, track: Track) -> Iterator[str]:
    """The joints at every breakpoint must lie on the path that is followed from the first one."""
    off = np.abs(track.joints[list(track.path.knots)] - motion.joints)
    if not (off > JOINT_TOLERANCE).any():
        return
    for joint, name in enumerate(robot.joint_names):
        k = int(np.argmax(np.nan_to_num(off[:, joint])))
        if off[k, joint] > JOINT_TOLERANCE:
            yield (
                f"{name} at breakpoint {k + 1} is given as {_deg(motion.joints[k, joint])}, "
                f"{np.rad2deg(off[k, joint]):.4g} deg off the path {track.path.place(track.path.knots[k])}"
            )


def reversals_claimed(robot: Robot, score: Score, track: Track, turned: Reversals) -> Iterator[str]:
    """Each joint must reverse as often as claimed, and have as many events."""
    events = Counter(event.joint for event in score.events)
    for joint, (name, found) in enumerate(zip(robot.joint_names, turned, strict=True)):
        claimed = score.reversals_per_joint[joint]
        if len(found) != claimed:
            places = f" ({'; '.join(track.path.place(i) for i in found[:3])})" if found else ""
            yield f"{name} reverses {_times(len(found))}{places}, the plan claims {claimed}"
        if events[joint + 1] != claimed:
            yield f"{name} has {events[joint + 1]} reversals listed as events, the plan claims {claimed}"


def blend_keeps(robot: Robot, where: str, turned: Reversals, blended: list[list[str]]) -> Iterator[str]:
    """Blending a breakpoint must not make a joint reverse more often.

    Args:
        robot: the arm.
        where: which blend, for a message.
        turned: reversals of both legs up to the corner.
        blended: where each joint reverses with that breakpoint blended, in words.
    """
    for name, sharp, blunt in zip(robot.joint_names, turned, blended, strict=True):
        if len(blunt) > len(sharp):
            places = "; ".join(blunt[:3])
            yield f"{where}{name} reverses: {_times(len(blunt))} in all ({places}), {len(sharp)} without the blend"


def score_claimed(robot: Robot, score: Score, track: Track, turned: Reversals) -> Iterator[str]:
    """Travel must be right; slowest motion and distance to the limits must not be overstated.

    The least rate of a joint that turns round within a leg is nil, and nothing rests on what is claimed of it: the
    motion threshold leaves it out (theory §5).
    """
    moved = travel(track)
    if abs(moved - score.travel) > TRAVEL_TOLERANCE * max(moved, 1e-3):
        yield f"the joints travel {np.rad2deg(moved):.6f} deg, the plan claims {np.rad2deg(score.travel):.6f}"
    slowest, mean = track.moves.slowest, mean_rates(track)
    floor = RATE_FLOOR / robot.size
    for joint, name in enumerate(robot.joint_names):
        claimed = score.min_rate[joint]
        if set(turned[joint]) <= {track.path.corner} and _overstated(claimed, slowest[joint], floor):
            place = track.path.place(slowest_at(track, joint))
            yield f"{name} has a least rate of {_rate(slowest[joint])} {place}, the plan claims {_rate(claimed)}"
        claimed = score.mean_rate[joint]
        if _overstated(claimed, mean[joint], floor):
            yield f"{name} has a mean rate of {_rate(mean[joint])} on a leg, the plan claims {_rate(claimed)}"
    room = least_room(robot, track)
    for joint, name in enumerate(robot.joint_names):
        stated = score.limit_distance[joint]
        if stated > room[joint] + JOINT_TOLERANCE:
            place = track.path.place(nearest_to_limit(robot, track, joint))
            yield f"{name} comes within {_deg(room[joint])} of a limit {place}, the plan claims {_deg(stated)}"


def _overstated(claimed: float, measured: float, floor: float) -> bool:
    return bool(claimed > measured * (1 + RATE_TOLERANCE) + floor)


def _times(count: int) -> str:
    return "once" if count == 1 else f"{count} times"


def _mm(length: float) -> str:
    return f"{length * 1e3 + 0.0:.6g} mm"


def _deg(angle: float) -> str:
    return f"{np.rad2deg(angle):.8g} deg"


def _rate(rate: float) -> str:
    return f"{np.rad2deg(rate) / 1e3:.5g} deg/mm"
