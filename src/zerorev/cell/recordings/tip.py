"""The tip in a recording: of the joints where a plan gives robot and tool, else as the controller has it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from zerorev.errors import InputError
from zerorev.model._arrays import Array
from zerorev.model.finding import Finding
from zerorev.model.plan import HolePlan, Motion, Plan
from zerorev.model.recording import Recording
from zerorev.model.strokes import by_stroke
from zerorev.motion.drilling import Drilling
from zerorev.motion.kinematics import forward

__all__ = ["PlannedHole", "Tip", "planned_hole", "tip_of"]

TELLING_DIFFERENCE = 0.5e-3  # [m] above it, another tool or base is likelier than rounding
IDS_NAMED = 8


@dataclass(frozen=True)
class PlannedHole:
    """A hole of a plan, and what of the plan says how its motion is run.

    Attributes:
        drilling: robot, tool and hole.
        motion: as planned.
        lead_in: run along the axis before the hole and after it, at most [m].
        blend: radius of the blend at the corner [m].
    """

    drilling: Drilling
    motion: Motion
    lead_in: float
    blend: float


@dataclass(frozen=True)
class Tip:
    """Where the tip was, sample by sample.

    Attributes:
        measured: [m], base frame, shape (N, 3).
        commanded: [m], shape (N, 3), or None.
        pointing: unit direction of the drill, into the material, shape (N, 3), or None.
        findings: how far the controller's tip is from this one.
    """

    measured: Array
    commanded: Array | None
    pointing: Array | None
    findings: tuple[Finding, ...] = ()

    @property
    def led(self) -> Array:
        """The commanded tip, or the measured one where there is none."""
        return self.measured if self.commanded is None else self.commanded


def planned_hole(plan: Plan, hole: str | None) -> PlannedHole:
    """The hole of a plan that is meant, by its id; None: the only one.

    Raises:
        InputError: no such hole, one without a motion, or several and none is named.
    """
    plan = by_stroke(plan)
    found = [each for each in plan.holes if each.motion is not None and hole in (None, each.hole.id)]
    if len(found) != 1:
        ids = ", ".join(each.hole.id for each in plan.holes[:IDS_NAMED] if each.motion is not None)
        what = f"has no hole '{hole}' with a motion" if hole is not None else f"has {len(found)} holes with a motion"
        raise InputError(what, where=f"plan {plan.name}", accepted=f"--hole with one of {ids or 'a planned hole'}")
    return _planned(plan, found[0])


def _planned(plan: Plan, hole: HolePlan) -> PlannedHole:
    assert hole.motion is not None
    drilling = Drilling.of(plan, hole.hole)
    return PlannedHole(drilling, hole.motion, plan.settings.lead_in, plan.settings.blend)


def tip_of(recording: Recording, planned: PlannedHole | None) -> Tip:
    """Where the tip was, measured and commanded.

    Args:
        recording: of one run.
        planned: whose robot and tool take the joints to the tip; None: the controller's tip is taken as it is.

    Raises:
        InputError: only joints are recorded, and no robot and tool are known.
    """
    measured, commanded, pointing = recording.tcp, recording.tcp_commanded, None
    findings: list[Finding] = []
    if planned is not None:
        if recording.joints is not None:
            poses = _poses(planned, recording.joints)
            if measured is not None:
                findings.append(_difference(poses[:, :3, 3], measured))
            measured, pointing = poses[:, :3, 3], -poses[:, :3, 2]
        if recording.joints_commanded is not None:
            poses = _poses(planned, recording.joints_commanded)
            commanded, pointing = poses[:, :3, 3], -poses[:, :3, 2]
    if measured is None:
        raise InputError(
            "no measured tip is recorded" if recording.joints is None else "only joint angles are recorded",
            where=recording.source,
            accepted="a recording of X, Y, Z, or of joint angles with --plan, whose robot and tool give the tip",
        )
    return Tip(measured, commanded, pointing, tuple(findings))


def _poses(planned: PlannedHole, joints: Array) -> Array:
    return forward(planned.drilling.robot, joints) @ planned.drilling.tool.T_flange_tcp


def _difference(ours: Array, controllers: Array) -> Finding:
    """A tool or a base that is not the controller's shows here, and as an error once the tool spins."""
    apart = controllers - ours
    mean, most = float(np.linalg.norm(apart.mean(axis=0))), float(np.linalg.norm(apart, axis=1).max())
    spread = float(np.linalg.norm(apart - apart.mean(axis=0), axis=1).max())
    return Finding(
        "warning" if most > TELLING_DIFFERENCE else "info",
        "tip_difference",
        f"the controller's tip is {mean * 1e3:.3f} mm from the one of the plan's robot and tool in the mean, "
        f"{most * 1e3:.3f} mm at most, and moves {spread * 1e3:.3f} mm against it",
    )
