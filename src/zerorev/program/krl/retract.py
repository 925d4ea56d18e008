"""A retract program in KRL: it asks the controller where the tool stands, and moves only if that is in the hole."""

from __future__ import annotations

from zerorev.program.krl.controller import AT_REST, base, header, tool_and_load
from zerorev.program.krl.text import KRL_COMMENTS
from zerorev.program.krl.write import EXT_BAS, PTP_ACCELERATION
from zerorev.program.letters import fixed, settled
from zerorev.program.refusals import refuse_other_makers
from zerorev.program.retract import DEEPER, OFF_AXIS, OFF_DIRECTION, Retract, retract_head

__all__ = ["retract_to_krl"]

PTP_SPEED = 1  # [%]: the only PTP ends where it begins

SENTENCES = (
    "Run this program where the robot has stopped with the drill in this hole, before anything else is moved.",
    "It reads where the tool stands ($POS_ACT) in the frame of the hole: origin at the target, X along the drill axis. "
    "It moves only if that is within {off} mm of the axis, {turned} deg of its direction, and between {end} mm before "
    "the target and {deep} mm behind it; else it halts and does not move.",
    "Then one LIN pulls the drill out along its own axis (tool X), the tool not turning, to {end} mm before the "
    "target. Joints may reverse on the way: what counts is that the drill comes out straight.",
    "It takes for granted that $TOOL and the part stand as they did while drilling, and that the drill is not jammed. "
    "The spindle is not switched: let it turn, or stand, as your process wants it while the drill comes out.",
    "T1, override low, a hand on the enabling switch. Afterwards drill the hole again, or what follows it: "
    "zerorev export --from.",
)


def retract_to_krl(retract: Retract, name: str, version: str) -> str:
    """The text of a .src file; the file must be called like the program in it.

    Args:
        retract: what to write.
        name: of the program, a KRL identifier.
        version: of zerorev, stated in the comment block.

    Raises:
        NotExportableError: the robot is not a KUKA.
    """
    program = retract.program
    refuse_other_makers("krl", program.robot)
    end, deep = fixed(-retract.end * 1e3, 3), fixed(-retract.deepest * 1e3 + DEEPER, 3)
    off = [
        f"(HERE.{first}*HERE.{first}+HERE.{second}*HERE.{second} > {fixed(most**2)})"
        for first, second, most in (("Y", "Z", OFF_AXIS), ("A", "B", OFF_DIRECTION))
    ]
    elsewhere = " OR ".join([f"(HERE.X < {end})", f"(HERE.X > {deep})", *off])
    return "\n".join(
        [
            *header(program.settings.header),
            f"DEF {name} ( )",
            EXT_BAS,
            "DECL FRAME HERE,BACK,GOAL",
            *retract_head(retract, version, KRL_COMMENTS, SENTENCES),
            ";FOLD INI",
            "BAS (#INITMOV,0 )",
            f"BAS (#VEL_PTP,{PTP_SPEED} )",
            f"BAS (#ACC_PTP,{PTP_ACCELERATION} )",
            *tool_and_load(program),
            f"$BASE={base(retract.T_base_hole, program.settings)} ; the hole",
            "$IPO_MODE=#BASE",
            "$ORI_TYPE=#CONSTANT",
            "$ADVANCE=0",
            f"$VEL.CP={settled(retract.feed, 6)} ; {retract.feed * 1e3:g} mm/s",
            ";ENDFOLD (INI)",
            "PTP $AXIS_ACT ; to where the robot stands: it does not move, and $TOOL and $BASE hold from here on",
            AT_REST,
            "HERE=$POS_ACT",
            f"IF {elsewhere} THEN",
            "HALT ; the tool is not in this hole: nothing is moved",
            "ELSE",
            "BACK={FRAME: X 0.0,Y 0.0,Z 0.0,A 0.0,B 0.0,C 0.0}",
            f"BACK.X={end}-HERE.X",
            "GOAL=HERE:BACK",
            "LIN GOAL ; out along tool X",
            "ENDIF",
            "END",
            "",
        ]
    )
