"""Between the forms of the files and the nouns: robot, tool, frame, settings, hole; mm and degrees end here.

`plan_data` and `plan_conversion` do the same for the plan, which is made of these.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Sequence
from dataclasses import fields, replace
from pathlib import Path
from typing import Any

import numpy as np

from zerorev.errors import InputError
from zerorev.files.robot_schema import BaseInRootForm, DynamicsForm, FrameForm, GivenToolForm, RobotForm, ToolForm
from zerorev.files.schema import CycleForm, HoleForm, JobFile, SettingsForm
from zerorev.files.solids import bodies_data, bodies_from
from zerorev.files.stated_forms import data_of, noun_from
from zerorev.files.units import deg, m, mm, plain, rad
from zerorev.files.validation import inside
from zerorev.model._arrays import Array, rotation_rpy, rpy_of, transform, unit
from zerorev.model.controller import Call, Calls, ExternalAxis
from zerorev.model.cycle import MOST_BACK, Cycle
from zerorev.model.dynamics import Dynamics, Link, Load
from zerorev.model.hole import Hole, psi_zero_vector
from zerorev.model.profile import Profile
from zerorev.model.robot import LENGTHS, ArmGeometry, Display, JointLimits, Robot, Six, six
from zerorev.model.settings import Settings
from zerorev.model.stated import stated
from zerorev.model.tool import Tool

__all__ = [
    "cycle_from",
    "frame_data",
    "frame_from",
    "given_profile",
    "hole_from",
    "robot_data",
    "robot_from",
    "settings_data",
    "settings_from",
    "tool_data",
    "tool_from",
    "with_feeds",
]

# from a tool frame with X along the plunge to one with Z against it: a turn by -90 deg about Y
X_DRILLS = np.array([[0.0, 0.0, -1.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]])
NOMINAL_DEPTH_MM = 1.0  # of a hole whose depth is to be found


def robot_from(form: RobotForm, folder: Path | None = None, **sources: Any) -> Robot:
    """The robot of a robot file or a plan file.

    Args:
        form: as it was read.
        folder: where paths in it start; None: no other file is opened.
        sources: as `Robot` has them.
    """
    joints = form.joints
    offset = six(rad(joints.offset_deg))
    arm = noun_from(ArmGeometry, form.geometry_mm, LENGTHS, sign=six(joints.sign), offset=offset)
    limits = noun_from(JointLimits, joints)
    a, b, c, d, e, f = joints.names
    return noun_from(
        Robot,
        form,
        name=form.name,
        arm=arm,
        limits=limits,
        joint_names=(a, b, c, d, e, f),
        manufacturer=form.manufacturer,
        model=form.model,
        dynamics=_dynamics_from(form.dynamics),
        display=noun_from(Display, form.display),
        base_in_root=None if form.base_in_root is None else _six_from(form.base_in_root),
        bodies=bodies_from(form.bodies, folder, np.eye(4)),
        **sources,
    )


def _dynamics_from(form: DynamicsForm | None) -> Dynamics | None:
    if form is None:
        return None
    links = []
    for number, link in enumerate(form.links):
        with inside(f"dynamics.links[{number}]"):
            links.append(noun_from(Link, link, T_base_link=frame_from(link.frame)))
    with inside("dynamics"):
        return noun_from(Dynamics, form, links=tuple(links))


def robot_data(robot: Robot) -> dict[str, Any]:
    """The robot as a plan file holds it, with the fingerprint of its numbers."""
    arm, limits = robot.arm, robot.limits
    numbers: dict[str, Any] = plain(
        {
            "geometry_mm": data_of(arm),
            "joints": {
                "names": robot.joint_names,
                "sign": [int(s) for s in arm.sign],
                "offset_deg": deg(arm.offset),
            }
            | {key: value for key, value in data_of(limits).items() if value is not None},
        }
        | ({} if robot.dynamics is None else {"dynamics": _dynamics_data(robot.dynamics)})
        | _controller_data(robot)
    )
    words = {"name": robot.name, "manufacturer": robot.manufacturer, "model": robot.model}
    if robot.payload is not None:
        words |= data_of(robot, ("payload",))
    return words | numbers | {"sha256": _fingerprint(numbers)}


def _controller_data(robot: Robot) -> dict[str, Any]:
    """How the controller counts; a robot of which nothing is said has no key of it, as before these existed."""
    data: dict[str, Any] = {"display": data_of(robot.display)} if robot.display != Display() else {}
    if robot.pulses_per_deg is not None:
        data |= data_of(robot, ("pulses_per_deg",))
    if robot.base_in_root is not None:
        data["base_in_root"] = _six_data(robot.base_in_root)
    if robot.bodies:
        links = [body.link for body in robot.bodies]
        data["bodies"] = [{**each, "link": link} for each, link in zip(bodies_data(robot.bodies), links, strict=True)]
    return data


def _six_data(frame: Sequence[float]) -> dict[str, Any]:
    """A frame of x, y, z [m] and roll, pitch, yaw [rad] as a file holds it."""
    return {"xyz_mm": plain(mm(np.array(frame[:3]))), "rpy_deg": plain(deg(np.array(frame[3:])))}


def _dynamics_data(dynamics: Dynamics) -> dict[str, Any]:
    links = [data_of(link) | {"frame": frame_data(link.T_base_link)} for link in dynamics.links]
    return {"links": links} | data_of(dynamics)


def tool_from(form: ToolForm, folder: Path | None = None, **sources: Any) -> Tool:
    """The tool of a tool file, a job or a plan file.

    Args:
        form: as it was read.
        folder: where paths in it start; None: no other file is opened.
        sources: as `Tool` has them.

    Raises:
        InputError: a mass without its centre, or the other way round; a mass that no body has.
    """
    with inside(f"tool {form.name}"):
        load = _load_from(form)
        R = rotation_rpy(*rad(form.rpy_deg))
        if isinstance(form, GivenToolForm) and form.tool_x == "drill":
            R = R @ X_DRILLS
        T_flange_tcp = transform(R, m(form.tcp_mm))
        bodies = bodies_from(form.bodies, folder, T_flange_tcp)
    return Tool(form.name, T_flange_tcp, **sources, load=load, bodies=bodies)


def _load_from(form: ToolForm) -> Load | None:
    given = {each.path[0]: getattr(form, each.path[0]) for each in stated(Load)}
    if all(value is None for value in given.values()):
        return None
    for key in ("mass_kg", "com_mm"):
        if given[key] is None:
            raise InputError("is missing", where=key, accepted="mass_kg and com_mm together, or neither")
    point = {"inertia_kgm2": given["inertia_kgm2"] or [0.0] * 6}
    return noun_from(Load, form.model_copy(update=point))


def tool_data(tool: Tool) -> dict[str, Any]:
    """The tool as a plan file holds it, with the fingerprint of its numbers."""
    T = tool.T_flange_tcp
    weight: dict[str, Any] = {} if tool.load is None else data_of(tool.load)
    numbers: dict[str, Any] = plain({"tcp_mm": mm(T[:3, 3]), "rpy_deg": deg(rpy_of(T[:3, :3]))} | weight)
    numbers |= {"bodies": bodies_data(tool.bodies)} if tool.bodies else {}
    return {"name": tool.name} | numbers | {"sha256": _fingerprint(numbers)}


def _fingerprint(numbers: dict[str, Any]) -> str:
    """SHA-256 of the numbers as a plan file has them, in a canonical JSON."""
    return hashlib.sha256(json.dumps(numbers, sort_keys=True, separators=(",", ":")).encode()).hexdigest()


def frame_from(form: FrameForm) -> Array:
    """T_base_part, shape (4, 4), translation [m]."""
    return transform(rotation_rpy(*rad(form.rpy_deg)), m(form.xyz_mm))


def frame_data(T_base_part: Array) -> dict[str, Any]:
    """The frame as a plan file holds it."""
    return dict(plain({"xyz_mm": mm(T_base_part[:3, 3]), "rpy_deg": deg(rpy_of(T_base_part[:3, :3]))}))


def settings_from(form: SettingsForm, *, before: bool = False) -> Settings:
    """The settings of a job or of a file of answers.

    Args:
        form: as it was read.
        before: whether a missing key means what it meant before it existed, as in a file of answers.
    """
    with inside("calls"):
        calls = Calls(**{place: _calls_from(place, texts) for place, texts in form.calls.model_dump().items()})
    frame = form.robroot
    return noun_from(
        Settings,
        form,
        before=before,
        robroot=frame if frame is None or isinstance(frame, str) else _six_from(frame),
        external_axes=tuple(ExternalAxis(axis.name, axis.at) for axis in form.external_axes),
        calls=calls,
        header=tuple(form.header),
        cycle=cycle_from(form.cycle),
    )


def with_feeds(form: JobFile, settings: Settings) -> Settings:
    """The settings of a job with the feeds that it states in another unit.

    Raises:
        InputError: a feed that is stated twice, or one for each turn of a spindle whose speed is not known.
    """
    beside = sorted({"feed_mm_s", "feed_mm_rev"} & form.model_fields_set)
    if form.feed_mm_min is not None and beside:
        raise InputError(f"stands beside {beside[0]}", where="feed_mm_min", accepted="one of them")
    if form.feed_mm_min is not None:
        plunge, retract = form.feed_mm_min.plunge / 60e3, form.feed_mm_min.retract / 60e3
        return replace(settings, feed_plunge=plunge, feed_retract=retract)
    if form.feed_mm_rev is None:
        return settings
    if settings.spindle_rpm is None:
        raise InputError("the speed of the spindle is not given", where="feed_mm_rev", accepted="spindle_rpm beside it")
    if "plunge" in getattr(form, "feed_mm_s").model_fields_set:  # noqa: B009  # a key that is made of Settings
        raise InputError("stands beside feed_mm_s.plunge", where="feed_mm_rev", accepted="one of them")
    return replace(settings, feed_plunge=form.feed_mm_rev * settings.spindle_rpm / 60e3)


def cycle_from(form: CycleForm) -> Cycle:
    """How a hole is drilled.

    Raises:
        InputError: what does not fit together.
    """
    return noun_from(Cycle, form)


def _calls_from(place: str, texts: list[str]) -> tuple[Call, ...]:
    with inside(place):
        return tuple(Call.parse(text) for text in texts)


def _six_from(frame: FrameForm | BaseInRootForm) -> Six:
    """x, y, z [m] and roll, pitch, yaw [rad]."""
    return six([*m(frame.xyz_mm), *rad(frame.rpy_deg)])


def settings_data(settings: Settings) -> dict[str, Any]:
    """The settings as a file of answers holds them."""
    frame, calls = settings.robroot, settings.calls
    return data_of(settings) | {
        "robroot": _six_data(frame) if isinstance(frame, tuple) else frame,
        "external_axes": [{"name": axis.name, "at": plain(axis.at)} for axis in settings.external_axes],
        "calls": {each.name: [str(call) for call in getattr(calls, each.name)] for each in fields(calls)},
        "header": list(settings.header),
        "cycle": data_of(settings.cycle),
    }


def hole_from(form: HoleForm, reference: str | list[float], tool: Tool, T_base_part: Array) -> Hole:
    """The hole of a job in the base frame, its spin counted from the job's reference.

    One without a depth has a nominal one, and no given motion. Its numbers are those that a plan file will hold, to the
    last digit, so that what is found for the hole of the job is found again for that of the file.

    Raises:
        InputError: a direction of zero length, a reference along the drill axis, a given motion that is none.
    """
    where, R = f"hole {form.id}", T_base_part[:3, :3]
    depth_mm = plain(form.depth_mm or NOMINAL_DEPTH_MM)
    target = m(plain(mm(T_base_part[:3, 3] + R @ m(form.target_mm))))
    direction = np.array(plain(unit(R @ unit(form.direction, f"{where}, direction"), where)))
    vector = reference if isinstance(reference, str) else np.array(reference)
    with inside(where):
        given = plain(form.standoff_mm), plain(form.psi_deg)
        profile = None if form.depth_mm is None else given_profile(*given, depth_mm)
    return Hole(
        id=form.id,
        target=target,
        direction=direction,
        depth=float(m(depth_mm)),
        psi_zero=np.array(plain(psi_zero_vector(vector, target, direction, tool, T_base_part, where))),
        profile=profile,
        branch=form.branch,
        group=form.group or "",
        cycle=None if form.cycle is None else cycle_from(form.cycle),
    )


def given_profile(standoff_mm: list[float] | None, psi_deg: list[float] | None, depth_mm: float) -> Profile | None:
    """A motion given beforehand: stand-offs [mm], spins [deg]; three spins alone are those at start, target and end.

    Raises:
        InputError: stand-offs without spins, another number of the one than of the other, not down and up again.
    """
    if psi_deg is None:
        if standoff_mm is not None:
            raise InputError("is missing beside standoff_mm", where="psi_deg", accepted="as many spins as stand-offs")
        return None
    if standoff_mm is None:
        if len(psi_deg) != 3:
            raise InputError(
                f"has {len(psi_deg)} spins", where="psi_deg", accepted="three, or standoff_mm with as many entries"
            )
        standoff_mm = [depth_mm, 0.0, depth_mm]
    if len(standoff_mm) != len(psi_deg):
        raise InputError(
            f"has {len(psi_deg)} spins for {len(standoff_mm)} stand-offs", where="psi_deg", accepted="as many as these"
        )
    profile = Profile(m(standoff_mm), rad(psi_deg))
    backs = np.diff(profile.standoff[: profile.corner + 1])
    if backs.max() > MOST_BACK:
        raise InputError(
            "the stand-off does not fall to the target and rise again",
            where="standoff_mm",
            accepted=f"falling values, drawn back on the way by {MOST_BACK * 1e3:g} mm at most to break chips, the "
            "target, then rising values; pecking, in and out of a hole in steps, is not planned as one motion",
        )
    return profile
