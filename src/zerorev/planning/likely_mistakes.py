"""What is probably wrong with a job, said with the likely cure: units, angles, tool, places; nothing is searched for.

Each is a guess about what a user meant, not a claim about the motion: `check` neither asks for them nor minds them. A
warning that is wrong costs more than one that is missing, so each begins where no real cell is.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from zerorev.collision.arms import standing_hits
from zerorev.model._arrays import Array, rotation_rpy, rpy_of
from zerorev.model.body import Mesh
from zerorev.model.corner import controller_of, known_controller
from zerorev.model.finding import Finding, FindingKind
from zerorev.model.hole import Hole
from zerorev.model.job import Job
from zerorev.model.plan import named_holes
from zerorev.model.robot import Robot
from zerorev.model.settings import Settings
from zerorev.model.tool import Tool
from zerorev.planning.same_holes import same_holes

__all__ = ["GUESSES", "likely_mistakes", "points_back"]

GUESSES: tuple[FindingKind, ...] = (
    "units", "normals", "tool_direction", "frame_angles", "duplicate", "base_column", "controller",
)  # fmt: skip

SMALLEST_ARM = 0.2  # [m] lengths added up: a quarter of those of the smallest arms that are sold
FEWEST_DEGREES = np.deg2rad(10.0)  # no arm has all of its limits within
SLOWEST_JOINT = np.deg2rad(20.0)  # [rad/s] every arm has a joint that is faster
SHORTEST_TOOL = 10e-3  # [m] from the flange to the tip
SMALLEST_MESH, LARGEST_MESH, FAR_FROM_PART = 20e-3, 100.0, 0.1  # [m], of the reach, [m]
SMALLEST_PART, SEVERAL = 3e-3, 4  # [m] within which so many holes do not fit
SHALLOWEST = 1e-3  # [m]
SLOWEST_FEED, FASTEST_FEED = 0.1e-3, 0.2  # [m/s]
MOST_PER_TURN = 1e-3  # [m] that a drill enters per turn of its own
NEAR_BASE = 0.1  # of the reach: all holes are so near to the base's origin
COLUMN = 0.12  # of the reach: radius of the column about axis 1, less than that of any arm
BACK = -0.2  # cosine between the way from flange to tip and the way in which the drill points
BESIDE_AXIS = 0.04  # of the reach: a drill that points back passes axis 6 as near as this where it is not meant so
TOWARDS = -0.5  # cosine between the way from the shoulder to a hole and its direction
A_RADIAN = 2e-3  # [deg] about pi / 4 and its multiples, taken for degrees


def likely_mistakes(job: Job) -> tuple[Finding, ...]:
    """What is probably wrong with a job, as warnings of the kinds `GUESSES`.

    Args:
        job: as it was read.
    """
    robot, tool, settings, holes = job.robot, job.tool, job.settings, job.holes
    checks: tuple[tuple[FindingKind, Iterator[str]], ...] = (
        ("units", _robot_units(robot)),
        ("units", _tool_units(tool)),
        ("units", _radians("part_frame.rpy_deg", job.T_base_part)),
        ("units", _radians("tool.rpy_deg", tool.T_flange_tcp)),
        ("units", _hole_units(robot, holes)),
        ("units", _setting_units(settings, holes)),
        ("units", _part_units(robot, settings, holes)),
        ("base_column", _touch_already(robot, tool, settings)),
        ("normals", _towards_the_robot(robot, holes)),
        ("tool_direction", _tool_direction(robot, tool)),
        ("frame_angles", _tool_angles(robot, tool)),
        ("base_column", _in_the_column(robot, holes, job.T_base_part)),
        ("controller", _controller(robot, settings)),
        ("duplicate", iter(()) if _in_one_place(holes) else same_holes(holes)),
    )
    return tuple(Finding("warning", kind, message) for kind, messages in checks for message in messages)


def _controller(robot: Robot, settings: Settings) -> Iterator[str]:
    known, own = known_controller(settings.controller), controller_of(robot.manufacturer)
    if settings.controller is not None and known is not own:
        yield (
            f"the controller {settings.controller} is {known.maker}'s, and the robot {robot.name} is by "
            f"{robot.manufacturer.strip() or 'a maker that its file does not name'}: no program of this plan can be "
            f"written (controller{'' if own is None else f': {own.name}'}, or manufacturer in the robot's file)"
        )


def _robot_units(robot: Robot) -> Iterator[str]:
    length = float(np.abs(robot.arm[:7]).sum())
    if length < SMALLEST_ARM:
        unit = "metres" if length < 0.015 else "inches"
        yield (
            f"the lengths of the robot {robot.name} add up to {length * 1e3:.3g} mm: are they in {unit}? "
            "geometry_mm takes millimetres"
        )
    limits = robot.limits
    for what, values, most in (
        ("joint limits", np.concatenate([limits.lower, limits.upper]), FEWEST_DEGREES),
        ("joint speeds", limits.speed, SLOWEST_JOINT),
    ):
        if np.abs(values).max() < most:
            degrees = np.rad2deg(np.abs(values).max())
            yield (
                f"the {what} of the robot {robot.name} are {degrees:.3g} at most: are they in radians? "
                "lower_deg, upper_deg and speed_deg_s take degrees"
            )
    offset = np.rad2deg(robot.arm.offset)
    if any(map(_is_a_radian, offset)):
        found = _radian_in(offset)
        yield f"an offset of the robot {robot.name} is {found:.5g}: is it in radians? offset_deg takes degrees"


def _tool_units(tool: Tool) -> Iterator[str]:
    length = float(np.linalg.norm(tool.T_flange_tcp[:3, 3]))
    if 0 < length < SHORTEST_TOOL:
        unit = "metres" if length < 1e-3 else "inches"
        yield f"the tip lies {length * 1e3:.3g} mm from the flange: is it in {unit}? tcp_mm takes millimetres"


def _is_a_radian(degrees: float) -> bool:
    quarters = round(degrees / (np.pi / 4))
    return 0 < abs(quarters) <= 8 and abs(degrees - quarters * np.pi / 4) < A_RADIAN


def _radian_in(degrees: Sequence[float] | Array) -> float:
    return next(float(each) for each in degrees if _is_a_radian(each))


def _radians(where: str, T: Array) -> Iterator[str]:
    angles = np.rad2deg(rpy_of(T[:3, :3]))
    if any(map(_is_a_radian, angles)):
        found = _radian_in(angles)
        yield f"an angle of {where} is {found:.5g}: is it in radians? in degrees it is {np.rad2deg(found):.4g}"


def _in_one_place(holes: Sequence[Hole]) -> bool:
    """Whether several holes are where there is no room for them."""
    targets = np.array([hole.target for hole in holes])
    return len(holes) >= SEVERAL and 1e-9 < float(np.linalg.norm(np.ptp(targets, axis=0))) < SMALLEST_PART


def _part_units(robot: Robot, settings: Settings, holes: Sequence[Hole]) -> Iterator[str]:
    """A part that is too small or too large for any, or far away from its holes."""
    part = settings.surroundings.part
    if part is None or not isinstance(part.shape, Mesh):
        return
    size = float(part.shape.extent.max())
    if size < SMALLEST_MESH or size > LARGEST_MESH * robot.reach:
        unit = "metres" if size < SMALLEST_MESH else "micrometres or inches"
        yield (
            f"the part is {size * 1e3:.4g} mm long: are the lengths of its file in {unit}? "
            "part: {file: ..., unit: mm, m or in} says so"
        )
        return
    at = (np.array([hole.target for hole in holes]) - part.T_base[:3, 3]) @ part.T_base[:3, :3]
    low, high = part.shape.vertices.min(axis=0), part.shape.vertices.max(axis=0)
    beside = np.linalg.norm(np.maximum(np.maximum(low - at, at - high), 0.0), axis=1)
    if (beside > FAR_FROM_PART).all():
        yield (
            f"all holes lie {beside.min() * 1e3:.0f} mm or more beside the part: is its file in the part frame "
            "(part_frame), and in millimetres (unit)?"
        )


def _touch_already(robot: Robot, tool: Tool, settings: Settings) -> Iterator[str]:
    """What stands where the base of the arm is, which does not move: nothing is planned for it."""
    for body, other in standing_hits(robot, tool, settings):
        yield f"{other} touches the {body} of the robot, which does not move: is it where it stands?"


def _hole_units(robot: Robot, holes: Sequence[Hole]) -> Iterator[str]:
    targets = np.array([hole.target for hole in holes])
    far, apart = float(np.linalg.norm(targets, axis=1).max()), float(np.linalg.norm(np.ptp(targets, axis=0)))
    if far < NEAR_BASE * robot.reach:
        yield (
            f"all holes lie within {far * 1e3:.3g} mm of the base's origin: are they in metres or inches, or is "
            "part_frame missing? target_mm takes millimetres (a CSV file: unit)"
        )
    elif _in_one_place(holes):
        yield (
            f"all holes lie within {apart * 1e3:.3g} mm of each other: are they in metres? "
            "target_mm takes millimetres (a CSV file: unit: m)"
        )
    deepest = max(hole.depth for hole in holes)
    if deepest < SHALLOWEST:
        yield (
            f"no hole is deeper than {deepest * 1e3:.3g} mm: are depths in metres or inches? depth_mm takes millimetres"
        )


def _setting_units(settings: Settings, holes: Sequence[Hole]) -> Iterator[str]:
    feed = settings.feed_plunge
    mm_s = f"{feed * 1e3:g} mm/s"
    if feed < SLOWEST_FEED:
        minutes = max(hole.depth for hole in holes) / feed / 60
        yield f"a plunge at {mm_s} takes up to {minutes:.3g} min: is feed_mm_s.plunge in m/s? It takes mm/s"
    elif feed > FASTEST_FEED:
        yield f"a plunge at {mm_s} is faster than drills run: is feed_mm_s.plunge in mm/min? It takes mm/s"
    elif settings.spindle_rpm and (per_turn := feed * 60 / settings.spindle_rpm) > MOST_PER_TURN:
        yield (
            f"a plunge at {mm_s} is {per_turn * 1e3:.3g} mm per turn of the drill: is feed_mm_s.plunge in mm/min? "
            "It takes mm/s"
        )
    if settings.feed_retract < SLOWEST_FEED:
        yield f"a retract at {settings.feed_retract * 1e3:g} mm/s: is feed_mm_s.retract in m/s? It takes mm/s"
    if settings.psi_bound is not None and _is_a_radian(degrees := float(np.rad2deg(settings.psi_bound))):
        yield f"psi_bound_deg is {degrees:.5g}: is it in radians? in degrees it is {np.rad2deg(degrees):.4g}"


def points_back(T_flange_tcp: Array, near: float) -> bool:
    """Whether a drill points back at the flange: against the way from there to its tip, and towards axis 6.

    Args:
        T_flange_tcp: shape (4, 4).
        near: distance [m] within which it then passes that axis.
    """
    tip, drill = T_flange_tcp[:3, 3], -T_flange_tcp[:3, 2]
    if drill @ tip >= BACK * np.linalg.norm(tip):
        return False
    across = float(np.hypot(drill[0], drill[1]))
    ahead = 0.0 if across == 0 else max(0.0, -float(drill[:2] @ tip[:2]) / across**2)
    return bool(np.hypot(*(tip[:2] + ahead * drill[:2])) < near)


def _tool_direction(robot: Robot, tool: Tool) -> Iterator[str]:
    T, near = tool.T_flange_tcp, BESIDE_AXIS * robot.reach
    if not points_back(T, near):
        return
    along, tip = ("({:g}, {:g}, {:g})".format(*(v.round(3) + 0.0)) for v in (-T[:3, 2], T[:3, 3] * 1e3))
    message = f"the drill points back at the flange, along {along} from a tip at {tip} mm"
    other = _turned_about(T, near)
    yield message + (f": is its turn the other way round, rpy_deg {other}?" if other else ": check rpy_deg and tcp_mm")


def _tool_angles(robot: Robot, tool: Tool) -> Iterator[str]:
    T, near = tool.T_flange_tcp, BESIDE_AXIS * robot.reach
    roll, pitch, yaw = rpy_of(T[:3, :3])
    swapped = rotation_rpy(yaw, pitch, roll)
    ahead = -swapped[:, 2] @ T[:3, 3] > -BACK * np.linalg.norm(T[:3, 3])
    if not (points_back(T, near) and ahead) or _turned_about(T, near):
        return
    other = ", ".join(f"{angle:.6g}" for angle in np.rad2deg([yaw, pitch, roll]).round(6) + 0.0)
    yield (
        "with the angles of the tool in the other order the drill does not point back at the flange: are they A, B, C, "
        f"which are yaw, pitch, roll? rpy_deg: [{other}], or abc_deg"
    )


def _towards_the_robot(robot: Robot, holes: Sequence[Hole]) -> Iterator[str]:
    if len(holes) < 2:
        return
    away = np.array([hole.target for hole in holes]) - [0.0, 0.0, robot.arm.c1]
    cosine = np.einsum("ij,ij->i", away, [hole.direction for hole in holes]) / np.linalg.norm(away, axis=1)
    if (cosine < TOWARDS).all():
        yield (
            f"all {len(holes)} holes are drilled towards the robot: do their directions point out of the material "
            "(normals: out)?"
        )


def _with_rotation(T: Array, R: Array) -> Array:
    turned = T.copy()
    turned[:3, :3] = R
    return turned


def _turned_about(T: Array, near: float) -> str:
    """The angles of a tool with the sign of one turned, where its drill then points ahead; else an empty text."""
    angles = np.rad2deg(rpy_of(T[:3, :3]))
    for n in (1, 0, 2):
        other = np.where(np.arange(3) == n, -angles, angles)
        if abs(angles[n]) > 1e-6 and not points_back(_with_rotation(T, rotation_rpy(*np.deg2rad(other))), near):
            return "[" + ", ".join(f"{angle:.6g}" for angle in other.round(6) + 0.0) + "]"
    return ""


def _in_the_column(robot: Robot, holes: Sequence[Hole], T_base_part: Array) -> Iterator[str]:
    targets = np.array([hole.target for hole in holes])
    if float(np.linalg.norm(targets, axis=1).max()) < NEAR_BASE * robot.reach:
        return  # a matter of units
    radius, top = COLUMN * robot.reach, robot.arm.c1
    within = (np.hypot(targets[:, 0], targets[:, 1]) < radius) & (targets[:, 2] > 0) & (targets[:, 2] < top)
    if within.any():
        inside = [hole.id for hole, there in zip(holes, within, strict=True) if there]
        cure = "is part_frame missing?" if np.array_equal(T_base_part, np.eye(4)) else "check part_frame"
        yield (
            f"inside the robot's column, {radius * 1e3:.0f} mm about axis 1 and below the shoulder: "
            f"{named_holes(inside)}; {cure}"
        )
