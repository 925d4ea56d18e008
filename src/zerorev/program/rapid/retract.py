"""A retract program in RAPID: it asks the controller where the tool stands, and moves only if that is in the hole."""

from __future__ import annotations

import numpy as np

from zerorev.program.letters import fixed, settled
from zerorev.program.rapid.controller import frames, refuse
from zerorev.program.rapid.names import RAPID_COMMENTS, part_frame, procedure, tool
from zerorev.program.rapid.text import aggregate
from zerorev.program.rapid.write import AFTERWARDS, LEAST_TURN_SPEED, OUTER_SPEEDS, SETTINGS, joined
from zerorev.program.refusals import refuse_other_makers
from zerorev.program.retract import DEEPER, OFF_AXIS, OFF_DIRECTION, Retract, retract_head

__all__ = ["retract_to_rapid"]

SENTENCES = (
    "Run this program where the robot has stopped with the drill in this hole, before anything else is moved.",
    "It reads where the tool stands (CRobT) in the frame of the hole: origin at the target, x along the drill axis. It "
    "moves only if that is within {off} mm of the axis, {turned} deg of its direction, and between {end} mm before the "
    "target and {deep} mm behind it; else it stops and does not move.",
    "Then one MoveL pulls the drill out along its own axis (tool Z), the tool not turning, to {end} mm before the "
    "target. Joints may reverse on the way: what counts is that the drill comes out straight.",
    "It takes for granted that tool and part stand as they did while drilling, and that the drill is not jammed. The "
    "spindle is not switched: let it turn, or stand, as your process wants it while the drill comes out.",
    "Manual mode at reduced speed, override low, a hand on the enabling device. Put the program pointer to {run}; "
    "do not let the controller regain the path. Afterwards drill the hole again, or what follows it: "
    "zerorev export --from.",
)


def retract_to_rapid(retract: Retract, name: str, version: str) -> str:
    """The text of a module.

    Args:
        retract: what to write.
        name: of the program, a RAPID identifier.
        version: of zerorev, stated in the comment block.

    Raises:
        NotExportableError: the robot is not an ABB; what RAPID cannot say, or a controller refuses to run.
    """
    program = retract.program
    refuse_other_makers("rapid", program.robot)
    refuse(program)
    end, deep = fixed(-retract.end * 1e3, 3), fixed(-retract.deepest * 1e3 + DEEPER, 3)
    begin = retract_head(retract, version, RAPID_COMMENTS, SENTENCES, run=procedure(name))
    speed = aggregate([settled(retract.feed * 1e3, 3), fixed(LEAST_TURN_SPEED, 1), *OUTER_SPEEDS])
    data = [*frames(program, name, retract.T_base_hole), f"LOCAL CONST speeddata out_speed:={speed};"]
    used = f"{tool(name)}\\WObj:={part_frame(name)}"
    # the x of the tool's Z: the cosine of its angle against the axis
    along = "2*(here.rot.q2*here.rot.q4+here.rot.q1*here.rot.q3)"
    elsewhere = " OR ".join(
        (
            f"here.trans.x<{end}",
            f"here.trans.x>{deep}",
            f"here.trans.y*here.trans.y+here.trans.z*here.trans.z>{fixed(OFF_AXIS**2)}",
            f"{along}<{np.cos(np.deg2rad(OFF_DIRECTION)):.7f}",
        )
    )
    body = [
        "VAR robtarget here;",
        *SETTINGS,
        f"here:=CRobT(\\Tool:={tool(name)}\\WObj:={part_frame(name)});",
        f"IF {elsewhere} THEN",
        '  TPWrite "The tool is not in this hole: nothing is moved";',
        "  Stop;",
        "ELSE",
        f"  MoveL RelTool(here,0,0,{end}-here.trans.x),out_speed,fine,{used};",
        "ENDIF",
        AFTERWARDS,
    ]
    return joined(name, begin, data, body)
