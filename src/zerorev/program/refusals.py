"""Which holes of a plan must not become a program, and what is said of them."""

from __future__ import annotations

from collections.abc import Mapping

from zerorev.errors import NotExportableError
from zerorev.model.corner import CONTROLLERS, controller_of
from zerorev.model.finding import Finding
from zerorev.model.plan import HolePlan, Plan, named_holes
from zerorev.model.robot import Robot

__all__ = ["left_out", "refusals", "refuse_other_makers"]


def refuse_other_makers(controller: str, robot: Robot) -> None:
    """Let only the robots pass that a controller can drive: those of its maker.

    Args:
        controller: one of `CONTROLLERS`.
        robot: the arm.

    Raises:
        NotExportableError: another maker's robot.
    """
    known, own = CONTROLLERS[controller], controller_of(robot.manufacturer)
    if own is not known:
        made = robot.manufacturer
        by = f"by {made}" if made.strip() else "of a maker that its file does not name"
        why = f"the robot {robot.name} is {by}, and {known.language} runs on {known.maker} controllers alone"
        raise NotExportableError((f"{why} (manufacturer: {known.maker} in its file)",))


def left_out(plan: Plan, refused: Mapping[str | None, str]) -> list[Finding]:
    """Which holes of the job are missing from the program: those that the plan lacks, then those that it refuses."""
    found = [finding for finding in plan.findings if finding.kind == "unfinished"]
    if refused:
        kept, ids = len(plan.holes) - len(refused), [str(hole_id) for hole_id in refused]
        message = f"only {kept:,} of {len(plan.holes):,} holes are in the program; left out: {named_holes(ids)}"
        found.append(Finding("warning", "incomplete", message))
    return found + [
        Finding("warning", "skipped", f"left out of the program: {why}", hole_id) for hole_id, why in refused.items()
    ]


def refusals(plan: Plan) -> dict[str | None, str]:
    """Why a hole must not be exported, by its id; under None, why the whole plan must not.

    Args:
        plan: with its checks and findings.
    """
    reasons: dict[str | None, str] = {}
    errors = [finding for finding in plan.findings if finding.level == "error"]
    if whole := [finding.message for finding in errors if finding.hole is None]:
        reasons[None] = "; ".join(whole)
    for hole in plan.holes:
        own = [*hole.findings, *(finding for finding in errors if finding.hole == hole.hole.id)]
        if why := _why_not(hole, [finding.message for finding in own if finding.level == "error"]):
            reasons[hole.hole.id] = why
    return reasons


def _why_not(hole: HolePlan, errors: list[str]) -> str:
    if errors:
        return "; ".join(errors)
    if hole.status == "infeasible" or hole.motion is None:
        return "it has no motion"
    if hole.verified is None:
        return "it was not verified"
    if not hole.verified.passed:
        return "it did not pass the check: " + ("; ".join(hole.verified.failures) or "no reason given")
    return ""
