"""A retract program in URScript: it asks where the tool stands, and moves only if that is in the hole."""

from __future__ import annotations

import numpy as np

from zerorev.model._arrays import transform
from zerorev.program.letters import fixed, settled
from zerorev.program.refusals import refuse_other_makers
from zerorev.program.retract import DEEPER, OFF_AXIS, OFF_DIRECTION, Retract, retract_head
from zerorev.program.urscript.controller import tool_and_payload
from zerorev.program.urscript.text import INDENT, URSCRIPT_COMMENTS, pose
from zerorev.program.urscript.write import ACCELERATION, FEW_DECIMALS

__all__ = ["retract_to_urscript"]

Z_ALONG_X = transform(np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]), np.zeros(3))
"""A frame with its Z along the X of another: the hole's frame as the tool of this language lies in it."""

SENTENCES = (
    "Run this program where the robot has stopped with the drill in this hole, before anything else is moved: a "
    "Script node with this file, and after it a Script line {name}(). The program on the pendant must have another "
    "name.",
    "It reads where the tool stands in the frame of the hole: origin at the target, Z along the drill axis. It moves "
    "only if that is within {off} mm of the axis, {turned} deg of its direction, and between {end} mm before the "
    "target and {deep} mm behind it; else it shows a message, halts and does not move.",
    "Then one movel pulls the drill out along its own axis (tool Z), the tool not turning, to {end} mm before the "
    "target. Joints may reverse on the way: what counts is that the drill comes out straight.",
    "It takes for granted that tool and part stand as they did while drilling, that the payload is right, and that the "
    "drill is not jammed. The spindle is not switched: let it turn, or stand, as your process wants it while the drill "
    "comes out.",
    "Manual mode, the speed slider low, a hand on the emergency stop. Afterwards drill the hole again, or what follows "
    "it: zerorev export --from.",
)


def retract_to_urscript(retract: Retract, name: str, version: str) -> str:
    """The text of a .script file.

    Args:
        retract: what to write.
        name: of the function.
        version: of zerorev, stated in the comment block.

    Raises:
        NotExportableError: the robot is another maker's.
    """
    program = retract.program
    refuse_other_makers("urscript", program.robot)
    T_controller_hole = np.linalg.inv(program.robot.T_root_base) @ retract.T_base_hole @ Z_ALONG_X
    end, deep = fixed(-retract.end, 6), fixed(-retract.deepest + DEEPER * 1e-3, 6)
    off, turned = fixed((OFF_AXIS * 1e-3) ** 2, 9), fixed(float(np.sin(np.deg2rad(OFF_DIRECTION))) ** 2, 9)
    body = [
        *retract_head(retract, version, URSCRIPT_COMMENTS, SENTENCES, name=name),
        *tool_and_payload(program),
        "sync() # from here on the controller counts from this tool",
        f"local hole = {pose(T_controller_hole)}",
        "local stood = get_actual_tcp_pose()",
        "local here = pose_trans(pose_inv(hole), stood)",
        "local ahead = pose_trans(here, p[0, 0, 1, 0, 0, 0]) # one metre along the drill",
        "local beside = here[0] * here[0] + here[1] * here[1]",
        "local across = (ahead[0] - here[0]) * (ahead[0] - here[0]) + (ahead[1] - here[1]) * (ahead[1] - here[1])",
        f"if here[2] < {end} or here[2] > {deep} or beside > {off} or across > {turned} or ahead[2] < here[2]:",
        f'{INDENT}popup("The tool is not in this hole: nothing is moved.", "zerorev", False, True, True)',
        f"{INDENT}halt",
        "end",
        f"movel(pose_trans(stood, p[0, 0, {end} - here[2], 0, 0, 0]), a={ACCELERATION}, "
        f"v={settled(retract.feed, FEW_DECIMALS)}) # out along tool Z",
    ]
    return "\n".join([f"def {name}():", *(INDENT + line for line in body), "end", ""])
