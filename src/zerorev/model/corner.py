"""How a motion turns round at its deepest point, and what is known of how each maker's controllers do it."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from math import radians
from typing import Literal, get_args

from zerorev.errors import InputError
from zerorev.model.cycle import Cycle

__all__ = [
    "CONTROLLERS",
    "MOST_TILT",
    "Controller",
    "ControllerName",
    "CornerKind",
    "Turning",
    "controller_of",
    "known_controller",
    "turning_of",
]

CornerKind = Literal["blend", "joint", "spin", "stop"]
ControllerName = Literal["krl", "rapid", "tp", "urscript", "inform"]

IN_ONE_GO = Cycle()
MOST_TILT = math.radians(0.01)
"""Greatest angle of the tool against the drill axis on joint moves at the corner [rad]."""


@dataclass(frozen=True)
class Controller:
    """What is known of the controllers of one maker.

    Attributes:
        name: of their language, in jobs and on the command line.
        language: for people.
        maker: of its robots, for people.
        makers: the first words of a robot's `manufacturer`, in small letters.
        usual: how the corner is passed where the job does not say.
        share: of the shorter move that a blend may take, at most.
        parabola: whether a blend of straight moves is taken for a parabola, as far as one can know; else its curve is
            not known, and a motion has to hold for every one.
        sized: whether a program says how large a blend is; else the controller's settings and the feed do.
        turn_speed: up to which its controllers turn the tool, as far as is usual [rad/s]; above it a feed may be
            throttled.
        refused: ways of passing the corner that are not offered, and why.
    """

    name: ControllerName
    language: str
    maker: str
    makers: tuple[str, ...]
    usual: CornerKind
    share: float = 0.5
    parabola: bool = False
    sized: bool = True
    turn_speed: float = radians(200.0)
    refused: Mapping[CornerKind, str] = field(default_factory=dict)


CONTROLLERS: Mapping[str, Controller] = {
    each.name: each
    for each in (
        Controller(
            "krl",
            "KRL",
            "KUKA",
            ("kuka",),
            "blend",
            parabola=True,
            refused={
                "joint": "the speed of a PTP is a whole percentage, too coarse for the feed of a drill",
                "spin": "the speed of a PTP is a whole percentage, and a LIN that hardly moves the tip gives C_DIS no "
                "distance to go by, so that nobody knows whether the joints would rest",
            },
        ),
        Controller("rapid", "RAPID", "ABB", ("abb",), "joint"),
        Controller(
            "tp",
            "TP",
            "FANUC",
            ("fanuc",),
            "joint",
            sized=False,
            turn_speed=radians(100.0),
            refused={"blend": "how far CNT reaches depends on the feed and on the override, and so would the depth"},
        ),
        Controller(
            "urscript",
            "URScript",
            "Universal Robots",
            ("universal robots", "ur"),
            "joint",
            share=0.45,
            turn_speed=radians(100.0),  # a movel has none of its own, and nothing says at which the feed is cut
        ),
        Controller(
            "inform",
            "INFORM",
            "Yaskawa",
            ("yaskawa", "motoman"),
            "joint",
            sized=False,
            refused={"blend": "how far a position level (PL) reaches is not in the program, nor the depth lost to it"},
        ),
    )
}
assert tuple(CONTROLLERS) == get_args(ControllerName)

UNKNOWN = Controller("krl", "", "", (), "blend", parabola=True)


def controller_of(manufacturer: str) -> Controller | None:
    """The controller of a maker's robots; None where the maker has none that is known.

    Args:
        manufacturer: as the robot's file has it; words may follow the maker's name.
    """
    for each in CONTROLLERS.values():
        for maker in each.makers:
            if re.match(rf"\s*{maker}(\s|,|$)", manufacturer, re.IGNORECASE):
                return each
    return None


def known_controller(name: str | None) -> Controller:
    """A controller by its name; None: one of which nothing is known but what is usual."""
    return UNKNOWN if name is None else CONTROLLERS[name]


@dataclass(frozen=True)
class Turning:
    """How a motion turns round at the corner, as a job asks for it.

    Attributes:
        kind: how.
        radius: of the blend there [m]; 0: none.
        reach: how far from the corner joint moves begin and end, at most [m]; 0: there are none.
        shortfall: how far short of the corner the tip turns back [m].
        interval: least and greatest shortfall [m].
        law: by what the shortfall is expected, in words.
    """

    kind: CornerKind
    radius: float
    reach: float
    shortfall: float
    interval: tuple[float, float]
    law: str


def turning_of(
    controller: str | None,
    corner: CornerKind | None,
    blend: float,
    measured: float | None,
    cycle: Cycle = IN_ONE_GO,
    creep: float = 0.0,
) -> Turning:
    """How the corner is passed.

    A blend is taken for a parabola, which turns back half its radius short; every symmetric curve whose speed changes
    steadily lies between that and the corner.

    Args:
        controller: its name; None: not known.
        corner: as asked for; None: as usual for the controller.
        blend: radius, or reach of the joint moves, as asked for [m]; 0 is a stop.
        measured: depth lost, as measured [m]; None: not measured.
        cycle: says how long the tool dwells there, and whether it spins on.
        creep: how far it creeps in where it spins on [m].

    Raises:
        InputError: a stop with another kind, a kind that is not offered for the controller, or that does not fit to a
            dwell.
    """
    known = known_controller(controller)
    _refuse_dwell(corner, cycle)
    kind = corner or ("spin" if cycle.moving else "stop" if blend == 0 or cycle.dwell > 0 else known.usual)
    if blend == 0 and kind != "stop":
        raise InputError(
            f"a corner of kind {kind} has no room in a blend of 0", where="corner", accepted="stop, or blend_mm above 0"
        )
    if kind in known.refused:
        offered = [each for each in get_args(CornerKind) if each not in known.refused]
        why = known.refused[kind]
        raise InputError(
            f"{kind} is not offered for {known.language}: {why}", where="corner", accepted=" or ".join(offered)
        )
    if kind == "stop":
        return Turning(kind, 0.0, 0.0, 0.0, (0.0, 0.0), "an exact stop")
    reach = blend if kind in ("joint", "spin") else 0.0
    radius = blend if kind == "blend" else known.share * (creep if kind == "spin" else reach)
    if measured is not None:
        return Turning(kind, radius, reach, measured, (measured, measured), "as measured")
    if known.sized:
        law = "r/2, a parabolic blend; the controller's own curve may differ"
        return Turning(kind, radius, reach, radius / 2, (0.0, radius / 2), law)
    law = "r/2, a parabolic blend over half of each joint move; how far the controller blends is not in the program"
    return Turning(kind, radius, reach, radius / 2, (0.0, reach), law)


def _refuse_dwell(corner: CornerKind | None, cycle: Cycle) -> None:
    """Refuse a kind of corner that does not fit to a dwell.

    Raises:
        InputError: it does not.
    """
    if corner == "spin" and cycle.dwell == 0:
        raise InputError(
            "the tool spins on at the target, but not for how long", where="corner",
            accepted="cycle: {dwell_s: 0.2} beside it",
        )  # fmt: skip
    if cycle.moving and corner not in (None, "spin"):
        raise InputError(
            f"a corner of kind {corner} beside moving: true, with which the tool spins on there", where="corner",
            accepted="spin, or none; or moving: false",
        )  # fmt: skip
    if cycle.dwell > 0 and corner not in (None, "stop", "spin"):
        raise InputError(
            f"a corner of kind {corner} beside a dwell of {cycle.dwell:g} s: where the tool stands, nothing is blended",
            where="corner", accepted="stop, spin, or none; or dwell_s: 0",
        )  # fmt: skip
    if (corner == "spin" or cycle.moving) and cycle.kind == "peck":
        raise InputError(
            "the tool spins on at the target of a hole that is drilled in several strokes", where="cycle, moving",
            accepted="kind: single or chip_break; or a dwell that stands",
        )  # fmt: skip
