"""Why a hole has no motion, in the words that a user can act on."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from zerorev.model.finding import Finding
from zerorev.model.hole import Hole
from zerorev.model.job import Settings
from zerorev.model.robot import Robot
from zerorev.motion.drilling import Drilling
from zerorev.planning.out_of_reach import shift_into_reach
from zerorev.search.exact import can_run
from zerorev.search.optimum import LEAST_STROKE

__all__ = ["why_infeasible", "why_none", "why_too_short"]

SHORT = 1e-3  # [m] a stroke that can be run wherever any can, for an arm of size 1 (`Robot.size`)


def why_infeasible(drilling: Drilling, settings: Settings) -> tuple[Finding, ...]:
    """Which of reach, limits or the bound on the spin leaves no motion at all."""
    limits = replace(drilling.robot.limits, lower=np.full(6, -4 * np.pi), upper=np.full(6, 4 * np.pi))
    free = replace(drilling, robot=replace(drilling.robot, limits=limits), limit_margin=0.0)
    if can_run(free, settings):
        spins = "" if settings.psi_bound is None else f" within +-{np.rad2deg(settings.psi_bound):g} deg of spin"
        message = f"no branch drills it within the joint limits{spins}"
        if settings.limit_margin:
            message += f" and {np.rad2deg(settings.limit_margin):g} deg away from them (limit_margin_deg)"
            if can_run(replace(drilling, limit_margin=0.0), settings):
                message += "; nearer to them there is a motion"
        if settings.keep_lead_in and can_run(drilling, settings):
            message = (
                f"no motion was found whose whole lead-in of {settings.lead_in * 1e3:g} mm runs without a reversal"
            )
            return (Finding("error", "lead_in", message, drilling.hole.id),)
        return (Finding("error", "limit", message, drilling.hole.id),)
    where = ", ".join(f"{value:.1f}" for value in drilling.hole.target * 1e3)
    message = f"no branch and spin brings the tool along the axis at ({where}) mm"
    shift = shift_into_reach(drilling)
    if shift is None:
        return (Finding("error", "unreachable", f"out of reach: {message}", drilling.hole.id),)
    way = ", ".join(f"{value:.0f}" for value in (shift * 1e3).round() + 0.0)
    message = f"out of reach by {np.linalg.norm(shift) * 1e3:.0f} mm: {message}; moved by ({way}) mm it is within reach"
    return (Finding("error", "unreachable", message, drilling.hole.id),)


def why_too_short(robot: Robot, hole: Hole) -> Finding:
    """That a stroke is too short for figures that mean anything."""
    least = np.format_float_positional(LEAST_STROKE * robot.reach * 1e3, 2, fractional=False)
    message = f"a depth of {hole.depth * 1e3:g} mm is too short: on this arm it takes {least} mm or more to be checked"
    return Finding("error", "depth", message, hole.id)


def why_none(drilling: Drilling, settings: Settings) -> tuple[Finding, ...]:
    """Why no stroke, however short, has zero reversals."""
    short = drilling.deep(SHORT * drilling.robot.size)
    if not can_run(short, settings):
        return why_infeasible(short, settings)
    rate = (
        f" while every joint moves {np.rad2deg(settings.min_rate) / 1e3:g} deg/mm or more" if settings.min_rate else ""
    )
    message = f"no stroke, however short, is without a reversal{rate}"
    if drilling.hole.drilled_by(settings.cycle).kind == "chip_break":
        message = f"no stroke that breaks chips was found without a reversal{rate}"
    return (Finding("error", "no_stroke", message, drilling.hole.id),)
