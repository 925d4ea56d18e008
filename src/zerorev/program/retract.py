"""Out of a hole in which the robot has stopped: back along the drill axis, from wherever it stands."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from zerorev.errors import NotExportableError
from zerorev.model._arrays import Array, transform
from zerorev.model.finding import Finding
from zerorev.model.plan import HolePlan, Plan
from zerorev.motion.drilling import Drilling
from zerorev.motion.joint_path import joint_path
from zerorev.program.head import listed, mark
from zerorev.program.letters import Comments, fixed
from zerorev.program.names import label
from zerorev.program.neutral import HoleProgram, Program, build_program
from zerorev.program.outward import Line, outward
from zerorev.program.selection import number_of

__all__ = ["DEEPER", "OFF_AXIS", "OFF_DIRECTION", "Retract", "retract_head", "retract_of"]

OFF_AXIS, OFF_DIRECTION = 1.0, 0.5
"""By how much the tool may stand beside the hole's axis, or be turned from it, so that it moves [mm], [deg]."""

DEEPER = 0.5
"""How far below the deepest point of the motion it may stand [mm]."""

BEYOND = 5e-3  # [m] least way beyond the start of the stroke
SAMPLES = 81  # places of the motion from which the way out is examined


@dataclass(frozen=True)
class Retract:
    """What brings the drill out of one hole.

    Attributes:
        program: of this hole alone: frames, settings, and whose it is.
        T_base_hole: X along the drill axis into the part, origin at the target, shape (4, 4), translation [m].
        end: stand-off at which it ends [m].
        deepest: stand-off of the deepest point of the motion [m], 0 or less.
        feed: [m/s].
        findings: what a user should know of it.
    """

    program: Program
    T_base_hole: Array
    end: float
    deepest: float
    feed: float
    findings: tuple[Finding, ...]

    @property
    def hole(self) -> HoleProgram:
        """The hole."""
        return self.program.holes[0]


def retract_of(plan: Plan, hole_id: str, plan_file: str = "") -> Retract:
    """The way out of a hole of a plan.

    Args:
        plan: whose holes are checked.
        hole_id: of the hole.
        plan_file: name of the file that the plan is in; empty: of none.

    Raises:
        InputError: there is no such hole.
        NotExportableError: the hole must not be exported; the tool cannot be brought out straight from anywhere on it.
    """
    number = number_of(plan, hole_id, "retract")
    # no move to the hole or away from it is made, so none is refused
    alone = replace(plan, settings=replace(plan.settings, home_joints=None))
    program = build_program(alone, only=[hole_id], plan_file=plan_file)
    (hole,) = program.holes
    places = [hole.start.standoff, hole.moves[-1].standoff, hole.depth + BEYOND]
    answer = plan.holes[number - 1]
    end = float(max(places))
    y = np.cross([0.0, 0.0, 1.0] if abs(hole.axis[2]) < 0.9 else [0.0, 1.0, 0.0], hole.axis)
    y /= np.linalg.norm(y)
    R = np.stack([hole.axis, y, np.cross(hole.axis, y)], axis=1)
    target = np.linalg.inv(plan.T_base_part) @ np.array([*answer.hole.target, 1.0])
    return Retract(
        program,
        plan.T_base_part @ transform(R, target[:3]),
        end,
        float(min(move.standoff for move in hole.moves)),
        min(plan.settings.feed_plunge, plan.settings.feed_retract),
        _reach(plan, answer, end),
    )


def _reach(plan: Plan, answer: HolePlan, end: float) -> tuple[Finding, ...]:
    """From how much of the motion the tool comes out at constant spin, within reach and limits."""
    motion = answer.motion
    assert motion is not None
    drilling = Drilling(plan.robot, plan.tool, answer.hole)
    path = joint_path(drilling, motion.profile, motion.branch, samples=SAMPLES)
    turns = np.round((motion.joints[0] - path.joints[0]) / (2 * np.pi)) * 2 * np.pi
    failed = {}
    for s, psi, joints in zip(path.standoff, path.psi, path.joints + turns, strict=True):
        line = Line(drilling, motion.branch, float(s), float(psi), 0.0, joints)
        way = outward(line, end - float(s), 0.0)
        if way.why:
            failed[float(s)] = way.why
    if len(failed) == len(path.standoff):
        raise NotExportableError((f"hole {answer.hole.id}: at constant spin {failed.popitem()[1]}",))
    if failed:
        least, most = min(failed), max(failed)
        message = (
            f"from stand-offs {least * 1e3:.1f} to {most * 1e3:.1f} mm the drill may not come out at constant spin: "
            f"{failed[most]}"
        )
        return (Finding("warning", "retract", message, answer.hole.id),)
    return ()


def retract_head(
    retract: Retract, version: str, comments: Comments, sentences: Sequence[str], **names: str
) -> list[str]:
    """The comment block of a retract program.

    Args:
        retract: which.
        version: of zerorev.
        comments: of the language.
        sentences: what has to be known before it is started; `{off}`, `{turned}`, `{end}` and `{deep}` are figures.
        names: further words.
    """
    program, hole = retract.program, retract.hole
    words = {
        "off": f"{OFF_AXIS:g}",
        "turned": f"{OFF_DIRECTION:g}",
        "end": fixed(retract.end * 1e3, 3),
        "deep": fixed(-retract.deepest * 1e3 + DEEPER, 3),
        **names,
    }
    facts = (
        f"Out of hole {hole.number} of {program.listed}: {label(hole.id, comments)}",
        f"Plan {program.name}, robot {program.robot.manufacturer} {program.robot.model}, tool {program.tool.name}",
        *(f"{finding.level}: {finding.message}" for finding in retract.findings),
    )
    return [
        comments.rule,
        *comments.lines(f"Written by zerorev {version}"),
        *mark(program, comments),
        *(line for text in facts for line in comments.lines(text)),
        comments.sign,
        *listed([text.format(**words) for text in sentences], comments),
        comments.rule,
    ]
