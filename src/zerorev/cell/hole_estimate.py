"""The hole that a simulated motion leaves: where it lies, how it is tilted, how far it is from round.

The drill cuts a circle about each place of its tip. What the plunge leaves is a round hole about the tip's path; where
the retract is on another path, the drill touches the wall again, and the union of the two circles is longer than it is
wide by the distance between their centres. The tip is free: no hole guides it and no wall holds it back, so that all
three figures are upper bounds.

Parts are calibrated with the same arm, so that its sag does not count: the axis from which the hole is measured is the
commanded one, moved by the sag of the arm at rest, on average over the hole, in the postures of the motion at constant
spin. A wrong tool centre point is not calibrated away.
"""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from zerorev.cell.followed import Followed
from zerorev.cell.parameters import ParameterSet
from zerorev.cell.plant import Run, weighs_itself
from zerorev.kernels.dynamics import inverse_dynamics
from zerorev.kernels.plant import GAP
from zerorev.model._arrays import Array
from zerorev.model.dynamics import Load
from zerorev.model.measured_hole import mean_centre, tilt_of
from zerorev.motion.bodies import bodies_of
from zerorev.motion.loads import GRAVITY

__all__ = ["THROUGH", "HoleEstimate", "calibrated_axis", "hole_estimate"]

THROUGH = 2e-3  # [m] before the turn: the drill is through the part
DEPTHS = 51  # from entry to exit, evenly


class HoleEstimate(NamedTuple):
    """A hole as a free tip leaves it: upper bounds.

    Attributes:
        position: distance of its mean centre from the calibrated axis [m].
        tilt: angle between that axis and the line that fits its centres best [rad].
        ovality: how much longer it is than wide [m], shape (2,): at its entry and exit.
    """

    position: float
    tilt: float
    ovality: Array


def hole_estimate(done: Run, axis: Array) -> HoleEstimate:
    """The hole that a run leaves.

    Args:
        done: a run.
        axis: calibrated axis less the nominal one [m], base frame, shape (3,).
    """
    reference = done.reference
    turn, standoff = reference.turn, reference.standoff
    depth = _sections(reference)
    tip = _across(done.tool, reference) - axis
    # up to the turn and from it, by rising stand-off: of nodes at rest those next to the motion
    plunged = _at(depth, np.minimum.accumulate(standoff[: turn + 1])[::-1], tip[: turn + 1][::-1])
    retracted = _at(depth, np.maximum.accumulate(standoff[turn:]), tip[turn:])
    apart = np.linalg.norm(retracted - plunged, axis=1)
    return HoleEstimate(mean_centre(plunged), tilt_of(depth, plunged), apart[[0, -1]])


def calibrated_axis(baseline: Followed, parameters: ParameterSet) -> Array:
    """The axis that the arm drills on when it is calibrated, less the nominal one [m], base frame, shape (3,).

    With the encoders where they should be, and each link in the middle of where it comes to rest from either side: its
    gear lies on the flank of the load only where friction behind it cannot hold that load.

    Args:
        baseline: the motion at constant spin.
        parameters: of the arm.
    """
    drilling = baseline.drilling
    robot, tool = drilling.robot, drilling.tool
    dynamics = robot.dynamics
    assert dynamics is not None
    if not weighs_itself(drilling, parameters):
        com = parameters["tool_lever"] * tool.T_flange_tcp[:3, 3]
        tool = replace(tool, load=Load(parameters["tool_mass"], com, np.zeros((3, 3))))
    bodies = bodies_of(robot, tool)
    assert bodies is not None
    plunge = np.minimum.accumulate(baseline.standoff[: baseline.turn + 1])
    rows = np.searchsorted(-plunge, -_sections(baseline)).clip(max=baseline.turn)
    q = np.ascontiguousarray(baseline.q[rows])
    still, load = np.zeros_like(q), np.empty_like(q)
    inverse_dynamics(robot.arm, bodies, q, still, still, GRAVITY, load)
    arm = parameters.arm(dynamics)
    give = load / arm.stiffness
    if arm.kind == GAP:
        held = arm.behind * arm.coulomb
        give += 0.5 * (np.sign(load + held) + np.sign(load - held)) * 0.5 * arm.gap
    sag = np.einsum("njk,nj->nk", baseline.levers[rows], -give)
    return np.asarray(_across(sag, baseline).mean(axis=0))


def _sections(reference: Followed) -> Array:
    """Stand-off of the sections from entry to exit [m], falling, shape (51,)."""
    standoff, turn = reference.standoff, reference.turn
    entry = min(reference.drilling.hole.depth, standoff[: turn + 1].max(), standoff[turn:].max())
    deepest = max(float(standoff[turn]), 0.0)
    return np.linspace(entry, deepest + min(THROUGH, 0.5 * (entry - deepest)), DEPTHS)


def _across(vectors: Array, reference: Followed) -> Array:
    d = reference.drilling.hole.direction
    return np.asarray(vectors - np.outer(vectors @ d, d))


def _at(standoff: Array, own: Array, values: Array) -> Array:
    """Values at some stand-offs, of those at rising ones; of equal ones the first counts."""
    own, first = np.unique(own, return_index=True)
    return np.stack([np.interp(standoff, own, values[first, k]) for k in range(values.shape[1])], axis=1)
