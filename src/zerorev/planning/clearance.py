"""How near a hole's own moves come to what stands around, and what a user should know of that."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

from zerorev.collision.arms import Setting, setting_of
from zerorev.collision.motions import paths_of
from zerorev.collision.near import Nearest, Path, lines, nearest_of
from zerorev.model.finding import Finding
from zerorev.model.plan import Clearance, HolePlan, Motion
from zerorev.model.settings import Settings
from zerorev.motion.drilling import Drilling
from zerorev.program.ways import Way

__all__ = ["Approached", "approached", "clearance_findings", "clearance_of", "near_words", "none_clear", "too_near"]

SLACK = 2e-5  # [m] to which a least distance is known


class Approached(NamedTuple):
    """Where a hole's own moves come nearest to what stands around.

    Attributes:
        clearance: how near, and where.
        psi: spin there [rad].
    """

    clearance: Clearance
    psi: float


def clearance_of(drilling: Drilling, settings: Settings, motion: Motion) -> Clearance | None:
    """The least distance on a hole's own moves, its lead-in, approach and retract among them.

    Args:
        drilling: robot, tool and hole.
        settings: how, with what stands around.
        motion: of the hole.

    Returns:
        None where nothing is known to stand around. It is called certified; the check holds it to that.
    """
    found = approached(drilling, settings, motion)
    return None if found is None else found.clearance


def approached(drilling: Drilling, settings: Settings, motion: Motion) -> Approached | None:
    """Where a hole's own moves come nearest, as `clearance_of`; a few milliseconds.

    Args:
        drilling: robot, tool and hole.
        settings: how, with what stands around.
        motion: of the hole.
    """
    setting = setting_of(drilling.robot, drilling.tool, settings)
    if setting is None:
        return None
    way = Way.of(drilling, motion, settings)
    paths = list(_all_paths(drilling, settings, motion, way))
    found = nearest_of(setting, drilling.robot, paths, setting.drilled & setting.against)
    if found is None:
        return None
    begin, end = paths[found.path].ends[:, 1].tolist()
    near = Clearance(
        found.distance, found.standoff, found.between, certified=found.proven, lead_in=way.lead_in.length,
        approach=way.approach.length, retract=way.retract.length,
    )  # fmt: skip
    return Approached(near, begin + found.share * (end - begin))


def _all_paths(drilling: Drilling, settings: Settings, motion: Motion, way: Way) -> Iterator[Path]:
    """The legs, the corner, and the way to them and away."""
    profile, branch = motion.profile, motion.branch
    yield from paths_of(drilling, settings, profile, branch)
    first, last = way.ahead, way.after
    start = (way.surface + way.lead_in.length, first.psi)
    yield from lines(drilling, branch, [(way.surface, float(profile.psi[0])), start, (first.standoff, first.psi)])
    yield from lines(drilling, branch, [(way.surface, float(profile.psi[-1])), (last.standoff, last.psi)])


def clearance_findings(drilling: Drilling, settings: Settings, answer: HolePlan) -> Iterator[Finding]:
    """That a motion comes nearer to something than asked for, and what is not held apart from the part.

    Args:
        drilling: robot, tool and hole.
        settings: how.
        answer: of the hole, with a motion.
    """
    said = too_near(answer.clearance, settings)
    if said is not None:
        yield Finding("error", "collision", said, answer.hole.id)


def too_near(near: Clearance | None, settings: Settings) -> str | None:
    """That a motion comes nearer to something than is asked for, in words; None where it does not.

    Args:
        near: how near it comes; None: nothing stands around.
        settings: that ask.
    """
    if near is None or near.least >= settings.clearance - SLACK:
        return None
    body, other = near.between
    where = "" if near.standoff is None else f", {near.standoff * 1e3:.2f} mm out"
    if near.least <= SLACK:
        return f"the {body} touches {other}{where}"
    wanted = f"{settings.clearance * 1e3:g} mm are asked for (clearance_mm)"
    return f"the {body} comes within {near.least * 1e3:.2f} mm of {other}{where}, and {wanted}"


def near_words(setting: Setting, hit: Nearest) -> str:
    """What a motion meets, in words."""
    if not hit.between[0]:
        return "it could not be proven to keep clear"
    body, other = hit.between
    guessed = any(each.guessed for each in setting.bodies if each.id in hit.between)
    guess = " (how thick it is is a guess; bodies in the file of the robot or the tool say it)" if guessed else ""
    met = f"touches {other}" if hit.distance <= 0 else f"comes within {hit.distance * 1e3:.2f} mm of {other}"
    where = "" if hit.standoff is None else f", {hit.standoff * 1e3:.2f} mm out"
    return f"the {body}{guess} {met}{where}"


def none_clear(drilling: Drilling, settings: Settings, hit: Nearest) -> HolePlan:
    """The answer of a hole of which no motion keeps clear of what stands around.

    Args:
        drilling: robot, tool and hole.
        settings: how.
        hit: what the best motion would have met.
    """
    setting = setting_of(drilling.robot, drilling.tool, settings)
    assert setting is not None
    wanted = f" by {settings.clearance * 1e3:g} mm (clearance_mm)" if settings.clearance > 0 else ""
    message = f"no motion was found that keeps clear{wanted}: on the best one {near_words(setting, hit)}"
    finding = Finding("error", "collision", message, drilling.hole.id)
    return HolePlan(drilling.hole, "infeasible", drilling.wrist_offset, findings=(finding,))
