"""What a user should know about a plan or one of its holes."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Literal, get_args

from zerorev.model.stated import Choice
from zerorev.model.stated_figures import Text

__all__ = ["Finding", "FindingKind", "Level"]

Level = Literal["error", "warning", "info"]

FindingKind = Literal[
    "approach",
    "base_column",
    "blend",
    "blend_clipped",
    "cad",
    "calls",
    "certificate",
    "channels",
    "clearance",
    "collision",
    "controller",
    "corner",
    "corner_not_deepened",
    "countersink",
    "deepest",
    "depth",
    "duplicate",
    "frame_angles",
    "incomplete",
    "joint_speed",
    "joints",
    "jump",
    "lead_in",
    "limit",
    "long_turn",
    "lost_cycles",
    "lost_motion",
    "move_turn",
    "near_limit",
    "near_part",
    "no_stroke",
    "no_torque",
    "normals",
    "peck",
    "posture_change",
    "printable",
    "program_size",
    "rejected",
    "resampled",
    "retract",
    "reversal",
    "rows_dropped",
    "sampling",
    "short_move",
    "skipped",
    "spindle_speed",
    "tcp_calibration",
    "threshold",
    "through_part",
    "tip_difference",
    "tolerance",
    "tool_direction",
    "tool_turn",
    "turn_speed",
    "unchecked_moves",
    "unfinished",
    "units",
    "unreachable",
    "verification",
    "wrist_offset",
]
"""Every kind there is: a fixed word for machines. What each means is said in docs/howto/findings.md."""


@dataclass(frozen=True)
class Finding:
    """Something a user should know about a plan or one of its holes.

    Of an error no program can be made; a warning asks to look at it first.
    """

    level: Annotated[Level, Choice(words=dict.fromkeys(get_args(Level), ""))]
    kind: Annotated[FindingKind, Choice("a fixed word for machines", words=dict.fromkeys(get_args(FindingKind), ""))]
    message: Annotated[str, Text("one sentence for people")]
    hole: Annotated[str | None, Text("the hole's id", none="the whole plan is meant")] = None
