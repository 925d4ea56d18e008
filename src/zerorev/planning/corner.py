"""How the motion of a hole turns round at its corner, as its program will have it, and what that costs."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from zerorev.model._arrays import Array
from zerorev.model.corner import MOST_TILT
from zerorev.model.finding import Finding
from zerorev.model.plan import Corner, HolePlan, Motion
from zerorev.model.profile import Profile
from zerorev.model.settings import Settings
from zerorev.motion.drilling import Drilling
from zerorev.motion.joint_corner import joint_corner, off_axis_and_tilt
from zerorev.motion.joint_path import joints_along
from zerorev.search.spin import MOST_MOVES

__all__ = ["corner_findings", "corner_of", "countersink_findings"]

TIME_DIGITS = 6  # of a time [s] that comes out of an angle
CLOSE = 9  # samples from one end of a joint move to the other


def corner_of(drilling: Drilling, settings: Settings, motion: Motion) -> Corner:
    """How a motion turns round.

    Joint moves are as long as asked for, or as long as the tolerance lets them be; where none are short enough, the
    corner is an exact stop.

    Args:
        drilling: robot, tool and hole.
        settings: controller, corner and blend.
        motion: of the hole.
    """
    settings, profile = settings.of(drilling.hole), motion.profile
    turning = settings.turning
    around = np.abs(np.diff(profile.standoff))[[profile.corner - 1, profile.corner]]
    reach = off_axis = tilt = 0.0
    dwell, spin, spin_moves = settings.standing or None, None, None
    kind, radius, law = turning.kind, min(turning.radius, settings.blend_share * float(around.min())), turning.law
    if kind == "spin":
        dwell, spin, spin_moves = _spin_of(settings, profile)
    if kind in ("joint", "spin"):
        tolerances = settings.corner_tolerance, MOST_TILT
        moves = joint_corner(drilling, motion, turning.reach, *tolerances, spin_moves or 0)
        if moves is None:
            return Corner(
                "stop", 0.0, (0.0, 0.0), "an exact stop, for joint moves leave the axis too far", 0.0, 0.0, 0.0
            )
        reach, off_axis, tilt = moves.reach, moves.off_axis, moves.tilt
        for joints in _at_breaks(drilling, motion, reach):
            there = off_axis_and_tilt(drilling, joints)
            off_axis, tilt = max(off_axis, there[0]), max(tilt, there[1])
        radius = min(radius, settings.blend_share * reach)
    share = radius / turning.radius if turning.radius > 0 else 0.0
    least, most = turning.interval
    interval = least * share, most * (share if kind != "spin" or settings.sized else 1.0)
    return Corner(
        kind, turning.shortfall * share, interval, law, reach, off_axis, tilt, dwell, spin, spin_moves
    )  # fmt: skip


def _spin_of(settings: Settings, profile: Profile) -> tuple[float, float, int]:
    """For how long the tool spins on [s], by how much [rad], and on how many joint moves.

    The time is the one that is asked for, or the shorter one for which so much spin is right.

    Args:
        settings: of the hole, which ask for a spin.
        profile: of a motion with it.
    """
    count = profile.just_before_corner(settings.creep_in(settings.cycle.dwell))
    k = profile.corner
    spin = float(profile.psi[k] - profile.psi[k - count])
    creep = float(profile.standoff[k - count] - profile.standoff[k])
    slopes = profile.twist_rate[[k - count - 1, k]]
    speed = np.array([settings.feed_inwards(0.0), settings.feed_retract])
    # spin = (time - inwards) speed_1 slope_1 - inwards speed_0 slope_0
    # inwards = (creep + speed_1 time) / sum of speeds
    each = (speed[1] * slopes[1] + speed[0] * slopes[0]) / speed.sum()
    time = (spin + creep * each) / (speed[1] * slopes[1] - speed[1] * each)
    return round(float(time), TIME_DIGITS), spin, count


def _at_breaks(drilling: Drilling, motion: Motion, reach: float) -> Iterator[Array]:
    """Joints at the ends of the joint moves that meet where chips are broken [rad], shape (3, 6) each."""
    profile = motion.profile
    for k in profile.turns:
        if k != profile.corner:
            knots = profile.distance
            before, behind = (min(reach, float(knots[k + n] - knots[k + n - 1])) for n in (0, 1))
            along = np.concatenate([np.linspace(-before, 0.0, CLOSE), np.linspace(0.0, behind, CLOSE)[1:]])
            standoff, psi = profile.at(knots[k] + along)
            yield joints_along(drilling, motion.branch, standoff, psi)[[0, CLOSE - 1, -1]]


def corner_findings(settings: Settings, answer: HolePlan) -> tuple[Finding, ...]:
    """What a user should know of the corner of one hole.

    Args:
        settings: that ask for it.
        answer: with its corner.
    """
    settings = settings.of(answer.hole)
    corner, asked = answer.corner, settings.turning
    if corner is None or corner.kind == asked.kind:
        if corner is not None and max(corner.off_axis / settings.corner_tolerance, corner.tilt / MOST_TILT) > 1:
            message = (
                f"where chips are broken the joint moves leave the drill axis by {corner.off_axis * 1e3:.3g} mm and "
                f"{np.rad2deg(corner.tilt):.2g} deg: more than asked for (corner_tolerance_mm); less back_mm brings "
                "them nearer"
            )
            return (Finding("warning", "corner", message, answer.hole.id),)
        if corner is not None and corner.kind == "spin":
            return (_spins_on(settings, answer.hole.id, corner),)
        if corner is not None and corner.kind == "stop":
            stands = f"stands at the target for {settings.cycle.dwell:g} s" if settings.cycle.dwell else ""
            what = f"the tool {stands}" if stands else "the program stops at the target"
            message = f"{what}, with all joints at rest: each has to break loose there again"
            return (Finding("warning", "corner", message, answer.hole.id),)
        return ()
    message = (
        f"no joint moves at the corner stay within {settings.corner_tolerance * 1e3:g} mm and "
        f"{np.rad2deg(MOST_TILT):g} deg of the drill axis: all joints rest there (corner_tolerance_mm)"
    )
    return (Finding("warning", "corner", message, answer.hole.id),)


def _spins_on(settings: Settings, hole_id: str, corner: Corner) -> Finding:
    """That the tool spins on at the target, for how long, and what nobody knows of it."""
    assert corner.dwell is not None
    assert corner.spin is not None
    time = f"{corner.dwell:.2g} s"
    if corner.dwell < settings.cycle.dwell * (1 - 1e-6):
        time += (
            f" instead of {settings.cycle.dwell:g} s (for longer no motion was found that turns no joint round, keeps "
        )
        time += f"the limits and needs {MOST_MOVES} joint moves or fewer)"
    message = (
        f"the tool spins on at the target for {time}, by {np.rad2deg(corner.spin):.3g} deg, so that no joint rests: "
        "whether a controller runs into such a short move and out of it without a stop was not tried on any"
    )
    return Finding("warning", "corner", message, hole_id)


def countersink_findings(settings: Settings, answer: HolePlan) -> tuple[Finding, ...]:
    """What a depth that is not known at the corner does to a countersink.

    Args:
        settings: with the countersink.
        answer: with its corner.
    """
    corner = answer.corner
    if settings.sink_diameter is None or corner is None or corner.interval[0] == corner.interval[1]:
        return ()
    wide = 2 * np.tan(settings.sink_angle / 2)
    least, most = (wide * each * 1e3 for each in corner.interval)
    lost = f"{corner.interval[0] * 1e3:g} to {corner.interval[1] * 1e3:g} mm"
    angle, diameter = np.rad2deg(settings.sink_angle), settings.sink_diameter * 1e3
    message = (
        f"the tip turns back {lost} short of the corner, so a countersink of {angle:g} deg comes out {least:.2g} to "
        f"{most:.2g} mm narrower than the {diameter:g} mm that a known depth gives: measure the depth lost "
        "(blend_shortfall_mm), or use a depth stop"
    )
    return (Finding("warning", "countersink", message, answer.hole.id),)
