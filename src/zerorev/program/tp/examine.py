"""What TP asks of a program beyond what every language does."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

import numpy as np

from zerorev.model._arrays import Array
from zerorev.model.finding import Finding
from zerorev.motion.kinematics import forward
from zerorev.program.neutral import HoleProgram, Move, Program
from zerorev.program.tp.names import argument
from zerorev.program.tp.text import CM_MIN, DECIMALS, LONGEST_TEXT, joint_time, tip_speed

__all__ = ["errors", "examine"]

USUAL_FRAMES = 10  # tool and user frames of a controller
LONGEST_TIME = 32_000  # [msec]
FASTEST = 2.0  # [m/s]
NOTICEABLE = 0.01  # share by which a feed may differ unsaid
ROUNDED = float(np.deg2rad(0.5 * 10.0**-DECIMALS))  # [rad]
NEAR_LIMIT = 5 * ROUNDED


def examine(program: Program) -> tuple[Finding, ...]:
    """What there is to say of a program in TP; an error among it stops the export."""
    if wrong := errors(program):
        return wrong
    return (*_frames(program), *_paces(program), *(each for hole in program.holes for each in _hole(program, hole)))


def errors(program: Program) -> tuple[Finding, ...]:
    """Why a program cannot be written in TP."""
    return tuple(Finding("error", "controller", message) for message in _refused(program))


def _refused(program: Program) -> Iterator[str]:
    settings = program.settings
    if settings.tool_number is None:
        yield "a TP program selects its tool frame by number: set tool_number in the job"
    for name, given, why in (
        ("header", settings.header, "a header of KRL"),
        ("robroot", settings.robroot is not None, "a TP program counts from the robot's own base"),
        ("external_axes", settings.external_axes, "no external axes are written in TP"),
    ):
        if given:
            yield f"{name} is set in the job, but {why}: leave it out"
    for place, calls in settings.calls.places():
        for call in calls:
            if any(argument(each) is None for each in call.arguments):
                yield (
                    f"{call}, called {place}: arguments in TP are numbers from 0 on, or texts of at most "
                    f"{LONGEST_TEXT} characters without quotes"
                )
    yield from dict.fromkeys(why for move in _moves(program) if (why := _too_coarse(move)))


def _too_coarse(move: Move) -> str:
    """Why the pace of a move cannot be written; empty: it can."""
    feed = f"the feed of {move.feed * 1e3:.3g} mm/s"
    if move.linear:
        if tip_speed(move.feed).value == 0:
            return f"{feed} rounds to zero: the least in TP is 1 cm/min, {CM_MIN * 1e3:.3g} mm/s"
        return f"{feed} is above {FASTEST * 1e3:g} mm/s, the greatest in TP" if move.feed > FASTEST else ""
    time = f"a joint move of {move.length * 1e3:.3g} mm at {move.feed * 1e3:.3g} mm/s"
    if joint_time(move.time).value == 0:
        return f"{time} takes less than 1 msec, the least in TP: a lower feed, or a greater blend_mm"
    if joint_time(move.time).value > LONGEST_TIME:
        return f"{time} takes more than {LONGEST_TIME} msec, the most in TP: a greater feed, or a smaller blend_mm"
    return ""


def _frames(program: Program) -> Iterator[Finding]:
    robot, settings = program.robot, program.settings
    for name, number in (("tool_number", settings.tool_number), ("base_number", settings.base_number)):
        if number is not None and number > USUAL_FRAMES:
            yield _warning(f"{name} is {number}: most controllers have {USUAL_FRAMES} such frames")
    if not robot.display.j3_less_j2:
        yield _warning(
            f"the file of the robot {robot.name} does not say that its controller shows J3 less J2, as FANUC's do: J3 "
            "is printed as it stands in the plan; set display: {j3_less_j2: true} where the arm is such a one"
        )
    if robot.base_in_root is None:
        yield _warning(
            f"the file of the robot {robot.name} does not say where its controller counts from (base_in_root): FANUC's "
            "count Z from the height of axis 2"
        )


def _paces(program: Program) -> Iterator[Finding]:
    """Feeds that whole numbers change: each of a straight move once, and the worst of the joint moves."""
    straight: dict[str, float] = {}
    joint: dict[str, float] = {}
    for move in _moves(program):
        if move.linear:
            speed = tip_speed(move.feed)
            found = speed.value * (1e-3 if speed.unit == "mm/sec" else CM_MIN)
        else:
            speed = joint_time(move.time)
            found = move.length / (speed.value * 1e-3)
        share = abs(found / move.feed - 1)
        if share > 1e-6:
            over = "" if move.linear else f" over {move.length * 1e3:.3g} mm"
            what = f"a feed of {move.feed * 1e3:g} mm/s{over} is written as {speed}, which is {found * 1e3:.4g} mm/s"
            (straight if move.linear else joint)[what] = share
    if joint:
        worst = max(joint, key=lambda what: joint[what])
        many = f"; of {len(joint)} such changes at the corner the greatest" if len(joint) > 1 else ""
        straight[worst + many] = joint[worst]
    for what, share in straight.items():
        yield Finding("warning" if share > NOTICEABLE else "info", "controller", what)


def _hole(program: Program, hole: HoleProgram) -> Iterator[Finding]:
    joints = np.stack([hole.start.joints, *(move.end.joints for move in hole.moves)])
    limits = program.robot.limits
    room = np.minimum(joints - limits.lower, limits.upper - joints).min(axis=0)
    if (room < NEAR_LIMIT).any():
        name = program.robot.joint_names[int(np.argmin(room))]
        message = (
            f"{name} comes so near to its limit that the {DECIMALS} decimals of a program may pass it: plan with "
            "limit_margin_deg"
        )
        yield Finding("warning", "controller", message, hole.id)
    if names := _unmoved(program, hole):
        message = (
            f"{' '.join(names)} moves by less than the {DECIMALS} decimals of joint values on a joint move at the "
            "corner, and may stand still there or turn back: plan with min_rate_deg_per_mm, or a greater blend_mm"
        )
        yield Finding("warning", "controller", message, hole.id)
    if (off := _rounded_off(program, hole)) > program.settings.corner_tolerance:
        message = (
            f"joint values have {DECIMALS} decimals, which alone places the tip up to {off * 1e3:.3f} mm beside the "
            "drill axis at the joint moves"
        )
        yield Finding("warning", "controller", message, hole.id)


def _unmoved(program: Program, hole: HoleProgram) -> list[str]:
    """Names of the joints that do not move, as printed, as they do in the plan on one of the joint moves."""
    still, before = np.zeros(6, dtype=bool), hole.start.joints
    for move in hole.moves:
        if not move.linear:
            # the joints where the straight move before has ended are computed by the controller
            planned, printed = move.end.joints - before, _printed(program, move.end.joints) - before
            still |= (planned * printed <= 0) | (np.abs(printed) < ROUNDED)
            before = _printed(program, move.end.joints)
        else:
            before = move.end.joints
    return [name for name, bad in zip(program.robot.joint_names, still, strict=True) if bad]


def _printed(program: Program, joints: Array) -> Array:
    """Joints as the decimals of a program have them [rad]."""
    robot = program.robot
    shown = np.round(np.rad2deg(robot.shown(joints)), DECIMALS)
    return robot.from_shown(np.deg2rad(shown))


def _rounded_off(program: Program, hole: HoleProgram) -> float:
    """How far printed joints lie beside the drill axis at most [m]."""
    ends = [move.end for move in hole.moves if not move.linear]
    if not ends:
        return 0.0
    printed = _printed(program, np.stack([end.joints for end in ends]))
    tips = (forward(program.robot, printed) @ program.tool.T_flange_tcp)[:, :3, 3]
    meant = (program.T_base_part @ np.stack([end.T_part_tcp for end in ends]))[:, :3, 3]
    axis = program.T_base_part[:3, :3] @ hole.axis
    return float(np.linalg.norm(np.cross(tips - meant, axis), axis=1).max())


def _moves(program: Program) -> Iterable[Move]:
    return (move for hole in program.holes for move in hole.moves)


def _warning(message: str) -> Finding:
    return Finding("warning", "controller", message)
