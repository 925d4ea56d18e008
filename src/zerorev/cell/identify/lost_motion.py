"""Lost motion and stiffness of the gears, from a measurement at the tool: what no encoder sees.

The reversal value of a joint is how far the tool turns about it between two stands at one angle of the encoder,
approached from either side. Of a gear with a gap b and a stiffness k, friction F behind it and a load G,

    r = 2 F / k + b   where |G| < F ,   else 2 F / k :

a joint that its load holds on one flank does not show its gap. Of a gear with hysteresis it is less, and does not drop
when a weight is hung on it. F is a share phi of the dry friction, which nothing recorded says: every share of the prior
that the values allow is tried, and the ranges are those of all that fit.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from zerorev.cell.recordings.cells import number, rows_of
from zerorev.errors import InputError
from zerorev.files.text import read_bytes
from zerorev.kernels import dynamics
from zerorev.model._arrays import Array
from zerorev.model.dynamics import Load, nominal_drives
from zerorev.model.ranges import RANGES, Range
from zerorev.motion.bodies import bodies_of
from zerorev.motion.drilling import Drilling
from zerorev.motion.loads import GRAVITY

__all__ = ["Reversal", "loads_at", "lost_motion_ranges", "read_reversals", "reversal_value"]

COLUMNS = ("joint", "value_deg", "weight_kg")
ACCEPTED = "a header joint,value_deg,weight_kg and rows such as A2,0.031,0"
ARCMIN = float(np.deg2rad(1 / 60))
SHARES = 81
SAME = 0.1  # of a value: if it drops by no more when a weight is hung on the joint, it has not dropped
HYSTERESIS = (0.33, 1.1)  # reversal value over 2 F / k: found with simulated gears of that kind


@dataclass(frozen=True)
class Reversal:
    """One reversal value.

    Attributes:
        joint: 0..5.
        value: [rad].
        weight: hung at the tip while it was measured [kg].
    """

    joint: int
    value: float
    weight: float


def reversal_value(friction: float, stiffness: float, gap: float, load: float) -> float:
    """The reversal value of a gear with a gap [rad].

    Args:
        friction: behind the gear, at the speed of approach [N m].
        stiffness: [N m/rad].
        gap: [rad].
        load: that the joint carries [N m].
    """
    return 2 * friction / stiffness + (gap if abs(load) < friction else 0.0)


def read_reversals(path: str | Path, names: Sequence[str]) -> list[Reversal]:
    """Reversal values of a CSV file.

    Args:
        path: of the file.
        names: of the joints.

    Raises:
        InputError: not such a file; the message names the line.
    """
    source = str(path)
    rows = rows_of(read_bytes(Path(path), "reversal values (CSV)"), source)
    line, header = next(rows, (1, []))
    if tuple(cell.strip() for cell in header) != COLUMNS:
        raise InputError("another header", where=f"{source}, line {line}", accepted=ACCEPTED)
    found: list[Reversal] = []
    for line, cells in rows:
        where = f"{source}, line {line}"
        if len(cells) != len(COLUMNS):
            raise InputError(f"{len(cells)} cells", where=where, accepted=ACCEPTED)
        if cells[0].strip() not in names:
            raise InputError(f"no joint '{cells[0]}'", where=where, accepted=", ".join(names))
        value, weight = number(cells[1], where), number(cells[2], where)
        if not 0 < value < 1:
            raise InputError(f"a reversal value of {value:g} deg", where=where, accepted="above 0, below 1 deg")
        if not 0 <= weight < 1e3:
            raise InputError(f"a weight of {weight:g} kg", where=where, accepted="0 or more, below 1000 kg")
        found.append(Reversal(names.index(cells[0].strip()), float(np.deg2rad(value)), weight))
    if not found:
        raise InputError("no rows", where=source, accepted=ACCEPTED)
    return found


def loads_at(drilling: Drilling, posture: Array, mass: float, lever: float, weight: float) -> Array:
    """What the joints carry at a posture [N m], shape (6,).

    Args:
        drilling: robot with dynamics, and tool.
        posture: [rad], shape (6,).
        mass: of the tool [kg].
        lever: share of the way to the tip at which it lies.
        weight: at the tip besides [kg].
    """
    tip, whole = drilling.tool.T_flange_tcp[:3, 3], mass + weight
    load = Load(whole, tip * (mass * lever + weight) / whole, np.zeros((3, 3)))
    bodies = bodies_of(drilling.robot, replace(drilling.tool, load=load))
    assert bodies is not None
    out, still = np.empty((1, 6)), np.zeros((1, 6))
    dynamics.inverse_dynamics(drilling.robot.arm, bodies, posture[None].copy(), still, still, GRAVITY, out)
    return np.asarray(out[0])


def lost_motion_ranges(
    values: Sequence[Reversal], drilling: Drilling, posture: Array, ranges: dict[str, Range], source: str
) -> dict[str, Range]:
    """Ranges of gap, stiffness and kind that the values leave; joints without values keep theirs.

    Args:
        values: measured at one posture.
        drilling: robot with dynamics, and tool.
        posture: at which they were measured [rad], shape (6,).
        ranges: of all parameters; friction and tool mass as fitted.
        source: where the values come from.

    Raises:
        InputError: values that no gear of the prior has.
    """
    assert drilling.robot.dynamics is not None
    nominal = nominal_drives(drilling.robot.dynamics.payload)
    gaps: dict[int, Array] = {}
    stiffness: list[float] = []
    dropped = False
    for joint in sorted({each.joint for each in values}):
        own = [each for each in values if each.joint == joint]
        mass, lever = ranges["tool_mass"].nominal, ranges["tool_lever"].nominal
        loads = np.array([loads_at(drilling, posture, mass, lever, each.weight)[joint] for each in own])
        friction = nominal.coulomb[joint] * ranges["friction"].nominal * ranges[f"friction_{joint + 1}"].nominal
        fits = _fits(np.array([each.value for each in own]), loads, friction, nominal.stiffness[joint], ranges)
        if not fits:
            raise InputError(
                f"no gear has the reversal values of {drilling.robot.joint_names[joint]}", where=source,
                accepted="values at the posture where the motion of the plan's hole begins, [deg] of the joint",
            )  # fmt: skip
        dropped |= _dropped(own)
        gaps[joint] = np.array([gap for gap, _ in fits]) / ARCMIN
        stiffness += [factor for _, factor in fits]
    return _ranges(gaps, np.array(stiffness), dropped, source)


def _dropped(own: Sequence[Reversal]) -> bool:
    """Whether a weight takes away a part of the value, as only a gap lets it."""
    without = [each.value for each in own if each.weight == 0]
    under = [each.value for each in own if each.weight > 0]
    return bool(without and under and max(under) < (1 - SAME) * min(without))


def _fits(
    measured: Array, loads: Array, friction: float, nominal: float, ranges: dict[str, Range]
) -> list[tuple[float, float]]:
    """Gaps [rad] and factors on the nominal stiffness that give the values, over all shares and stiffnesses."""
    found = []
    prior, behind = RANGES["stiffness"], ranges["behind"]
    most = RANGES["gap"].high * RANGES["gap_1"].high * ARCMIN
    for share in np.linspace(behind.low, behind.high, SHARES):
        F = share * friction
        free = np.abs(loads) < F
        if free.all():  # nothing shows 2 F / k alone: any stiffness that leaves a gap
            for factor in prior.at(np.linspace(0, 1, SHARES)):
                gap = float(measured.mean() - 2 * F / (nominal * factor))
                if 0 < gap <= most:
                    found.append((gap, float(factor)))
            continue
        factor = 2 * F / float(measured[~free].mean()) / nominal
        if not prior.low <= factor <= prior.high:
            continue
        if free.any():
            gap = float(measured[free].mean() - measured[~free].mean())
            if 0 < gap <= most:
                found.append((gap, factor))
        else:  # its load holds it on one flank all the time: of the gap nothing is seen
            low = RANGES["gap"].low * RANGES["gap_1"].low * ARCMIN
            found += [(low, factor), (most, factor)]
    return found


def _ranges(gaps: dict[int, Array], stiffness: Array, dropped: bool, source: str) -> dict[str, Range]:
    """Ranges of what fits; wider where nothing shows that it is a gap, for a hysteresis gives less than the formula."""
    common, own, prior = RANGES["gap"], RANGES["gap_1"], RANGES["stiffness"]
    least = common.low * own.low
    found = {"gap": replace(common, low=1.0, high=1.0, source="each joint has its own", basis="fitted")}
    for joint in range(6):
        name = f"gap_{joint + 1}"
        if joint not in gaps:
            found[name] = replace(own, low=least, high=common.high * own.high, source=common.source)
            continue
        low, high = float(gaps[joint].min()) if dropped else least, float(gaps[joint].max())
        found[name] = _fitted(own, min(low, high), high, source)
    low = float(stiffness.min()) * (1.0 if dropped else HYSTERESIS[0])
    high = float(stiffness.max()) * (1.0 if dropped else HYSTERESIS[1])
    found["stiffness"] = _fitted(prior, max(low, prior.low), min(high, prior.high), source)
    if dropped:
        found["kind"] = replace(RANGES["kind"], high=0.49, source=source, basis="fitted")
    return found


def _fitted(prior: Range, low: float, high: float, source: str) -> Range:
    nominal = float(np.clip(np.sqrt(low * high), low, high))
    return replace(prior, nominal=nominal, low=low, high=high, source=source, basis="fitted")
