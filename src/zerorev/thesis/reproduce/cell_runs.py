"""The published motions in the virtual cell, computed once for all sections of chapter 5."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import TypeVar

from zerorev.cell.ensemble import HoleStudy, study
from zerorev.cell.motions import MotionName
from zerorev.cell.parameters import ParameterSet, drawn
from zerorev.cell.possible import conditioned
from zerorev.cell.reference import Manner
from zerorev.model.plan import Plan
from zerorev.model.settings import Settings
from zerorev.planning.hole import plan
from zerorev.thesis.reproduce.context import Context
from zerorev.thesis.reproduce.published import POSITIONS
from zerorev.workers import Machines

__all__ = ["CORNER", "FAST", "RECORDED", "SEED", "SLOW", "kept_sets", "planned", "published", "studied"]

T = TypeVar("T")

SEED = 1
FAST, SLOW, CORNER = 0.2, 0.02, 10e-3  # [m/s], [m]: as in sec. 5.3, and a feed that all motions reach; APO.CDIS
RECORDED = (0.20e-3, 0.14e-3, 0.15e-3)  # [m] greatest deviation of the baselines, sec. 5.4
TOOL_HELD = ("tool_lever",)


def published(context: Context) -> Plan:
    """The three published motions, evaluated and checked, as the thesis ran them."""
    return _kept(context, "published", lambda: _plan(context, searched=False))


def planned(context: Context, thrust: float = 0.0) -> Plan:
    """The motions that are planned for the same holes, of equal ones those with the least predicted lost motion.

    Args:
        context: robot and tool.
        thrust: of the drill [N]; above 0 the predicted lost motion weighs, and the travel beside it.
    """
    return _kept(context, f"planned {thrust:g}", lambda: _plan(context, searched=True, thrust=thrust))


def _plan(context: Context, *, searched: bool, thrust: float = 0.0) -> Plan:
    settings = Settings(min_rate=context.thesis.min_rate, blend=CORNER, lead_in=0.0, proof_boxes=0)
    if thrust > 0:
        settings = replace(settings, weights=(("travel", 1.0), ("lost_motion", 1.0)), thrust=thrust)
    holes = []
    for position in POSITIONS:
        hole = position.hole
        if not searched:
            hole = replace(hole, profile=position.profile)
        holes.append(plan(context.robot, context.tool, hole, settings))
    return Plan(context.robot, context.tool, settings, tuple(holes), name="the positions of the thesis")


def kept_sets(context: Context) -> list[ParameterSet]:
    """Three sets a seed, of which those are kept whose baselines are within a factor of two of the recorded ones."""

    def make() -> list[ParameterSet]:
        sets = drawn(3 * context.seeds, SEED, held=TOOL_HELD)
        names = [hole.hole.id for hole in published(context).holes]
        recorded = dict(zip(names, RECORDED, strict=True))
        return conditioned(published(context), sets, recorded, Manner(feed=FAST, corner=CORNER), machines=Machines())

    return _kept(context, "kept sets", make)


def studied(
    context: Context,
    of: Plan,
    *,
    feed: float = SLOW,
    corner: float = CORNER,
    thrust: float = 0.0,
    motions: tuple[MotionName, ...] = (),
    sets: Sequence[ParameterSet] | None = None,
) -> list[HoleStudy]:
    """What the kept sets, or others, do at the three positions.

    Args:
        context: of the reproduction.
        of: the motions.
        feed: of both legs [m/s].
        corner: radius of its blend [m].
        thrust: of the drill [N].
        motions: besides baseline and plan.
        sets: None: the kept ones.
    """
    own = kept_sets(context) if sets is None else sets
    key = (id(of), feed, corner, thrust, motions, None if sets is None else id(sets))

    def make() -> list[HoleStudy]:
        manner = Manner(feed=feed, corner=corner)
        found = study(
            of, own, manner=manner, thrust=thrust, motions=motions, machines=Machines(),
            progress=context.tell,
        )  # fmt: skip
        return [each for each in found if isinstance(each, HoleStudy)]

    return _kept(context, key, make)


def _kept(context: Context, key: object, make: Callable[[], T]) -> T:
    if key not in context.kept:
        context.kept[key] = make()
    found: T = context.kept[key]
    return found
