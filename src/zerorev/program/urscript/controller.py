"""URScript of what fits a program to its controller: tool, payload, part frame, calls."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from zerorev.model.controller import Call
from zerorev.program.dialect import Z_ALONG_PLUNGE
from zerorev.program.letters import fixed
from zerorev.program.neutral import Program
from zerorev.program.urscript.text import number_list, pose

__all__ = ["PART", "called", "frames_and_payload", "tool_and_payload"]

PART = "part"
WORDS = {"TRUE": "True", "FALSE": "False"}


def frames_and_payload(program: Program) -> list[str]:
    """The tool, what it weighs, and the part frame from the base that the controller counts from.

    The frame is a local variable: one of the same name on the pendant is neither read nor changed.
    """
    T_controller_part = np.linalg.inv(program.robot.T_root_base) @ program.T_base_part
    return [*tool_and_payload(program), f"local {PART} = {pose(T_controller_part)}"]


def tool_and_payload(program: Program) -> list[str]:
    """The tool with Z along the plunge, and mass and centre of mass where the tool file has them."""
    lines = [f"set_tcp({pose(program.tool.T_flange_tcp @ Z_ALONG_PLUNGE)})"]
    if (load := program.tool.load) is not None:
        lines.append(f"set_payload({fixed(load.mass)}, {number_list(load.com, 5)})")
    return lines


def called(calls: Sequence[Call]) -> list[str]:
    """The statements that call functions of the controller: a move without a blend has ended before them."""
    return [f"{call.name}({', '.join(WORDS.get(each.upper(), each) for each in call.arguments)})" for call in calls]
