"""From recordings to a cell: sweeps, then a measurement at the tool where there is one, then baselines."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from zerorev.cell.identify.controller import Baseline, Nearest, controller_ranges, nearest
from zerorev.cell.identify.friction import Fitted, fitted
from zerorev.cell.identify.lost_motion import Reversal, lost_motion_ranges
from zerorev.cell.identify.segments import segments
from zerorev.cell.parameters import drawn
from zerorev.cell.reference import Manner
from zerorev.errors import InputError
from zerorev.model._arrays import Array
from zerorev.model.dynamics import nominal_drives
from zerorev.model.plan import Plan
from zerorev.model.ranges import RANGES, Cell, Conditioning, Range
from zerorev.model.recording import Recording
from zerorev.motion.drilling import Drilling
from zerorev.workers import HERE, Machines

__all__ = ["Identified", "identified"]

WIDE = 0.8  # of the prior, in its logarithm: a range that wide is the prior
NARROWEST = 0.01  # of a value, which no sweep knows better


@dataclass(frozen=True)
class Identified:
    """A cell, and what it was made of.

    Attributes:
        cell: all ranges.
        friction: of the sweeps.
        nearest: the sets that fit the baselines; None: none were given.
        baselines: as they were recorded.
    """

    cell: Cell
    friction: Fitted
    nearest: Nearest | None
    baselines: tuple[Baseline, ...]


def identified(
    plan: Plan,
    drilling: Drilling,
    posture: Array,
    sweeps: Sequence[Recording],
    *,
    torque_ratio: Sequence[float] = (1.0,) * 6,
    reversals: Sequence[Reversal] = (),
    reversals_source: str = "",
    baselines: Sequence[Baseline] = (),
    manner: Manner | None = None,
    sets: int = 600,
    seed: int = 0,
    machines: Machines = HERE,
    progress: Callable[[int, int], None] | None = None,
) -> Identified:
    """The cell of an arm.

    Args:
        plan: whose robot and tool were recorded.
        drilling: the hole at which the sweeps begin.
        posture: about which they were run [rad], shape (6,).
        sweeps: recordings of them.
        torque_ratio: by which logged torques are multiplied to be those of the joints.
        reversals: measured at the tool, at that posture.
        reversals_source: where they come from.
        baselines: recorded.
        manner: in which these were run.
        sets: to choose among for the controller.
        seed: of them.
        machines: where.
        progress: called with (blocks done, blocks in all).

    Raises:
        InputError: recordings that cannot be used; the message says which.
    """
    dynamics = plan.robot.dynamics
    if dynamics is None:
        raise InputError(
            f"the masses of the robot {plan.robot.name} are not known, so that nothing can be identified",
            where="robot", accepted="a robot file with dynamics: links, payload_kg",
        )  # fmt: skip
    if not sweeps:
        raise InputError("no recording of sweeps", where="identify", accepted="one file or more")
    source = ", ".join(each.source for each in sweeps)
    found = [each for one in sweeps for each in segments(one, drilling, posture, torque_ratio)]
    friction = fitted(found, plan.robot, source)
    ranges = dict(RANGES) | _friction_ranges(friction, nominal_drives(dynamics.payload).coulomb,
                                             nominal_drives(dynamics.payload).viscous, source)  # fmt: skip
    if reversals:
        ranges |= lost_motion_ranges(reversals, drilling, posture, ranges, reversals_source)
    manner = manner or Manner()
    kept = conditioning = None
    if baselines:
        kept = nearest(plan, drawn(sets, seed, ranges), baselines, manner, machines=machines, progress=progress)
        words = f"baselines of {', '.join(dict.fromkeys(each.hole for each in baselines))}"
        ranges |= controller_ranges(kept, ranges, words)
        conditioning = _conditioning(baselines, manner)
    return Identified(Cell(ranges, conditioning, plan.robot.name), friction, kept, tuple(baselines))


def _conditioning(baselines: Sequence[Baseline], manner: Manner) -> Conditioning:
    greatest: dict[str, list[float]] = {}
    for each in baselines:
        greatest.setdefault(each.hole, []).append(each.measured.deviation_max)
    return Conditioning({hole: float(np.mean(own)) for hole, own in greatest.items()}, manner.feed, manner.corner)


def _friction_ranges(found: Fitted, coulomb: Array, viscous: Array, source: str) -> dict[str, Range]:
    """Each joint has its own dry friction; what is common to all joints in the model is spanned by them."""
    ranges = {"friction": _fitted(RANGES["friction"], np.ones(3), "each joint has its own", narrowest=0.0)}
    for joint in range(6):
        name = f"friction_{joint + 1}"
        ranges[name] = _fitted(RANGES[name], found.coulomb[:, joint] / coulomb[joint], source)
    factors = np.clip(found.viscous / viscous, 0.05, 20.0)
    middle = float(np.exp(np.mean(np.log(factors[0]))))
    ranges["viscous"] = _fitted(RANGES["viscous"], np.array([middle, factors[0].min(), factors[0].max()]), source)
    for name, values in (
        ("stribeck", found.stribeck), ("breakaway", found.breakaway), ("tool_mass", found.mass),
        ("tool_lever", found.lever),
    ):  # fmt: skip
        prior = RANGES[name]
        if name == "tool_mass" or _says(prior, values):
            ranges[name] = _fitted(prior, values, source)
    return ranges


def _says(prior: Range, values: Array) -> bool:
    """Whether values narrow their prior."""
    of = np.log if prior.law == "log" else np.asarray
    low, high = max(values[1], prior.low), min(values[2], prior.high)
    return bool(low < high and of(high) - of(low) < WIDE * (of(prior.high) - of(prior.low)))


def _fitted(prior: Range, values: Array, source: str, narrowest: float = NARROWEST) -> Range:
    value = float(values[0])
    low = max(min(float(values[1]), value * (1 - narrowest)), 1e-3 * value)
    high = max(float(values[2]), value * (1 + narrowest))
    return replace(prior, nominal=value, low=low, high=high, source=source, basis="fitted")
