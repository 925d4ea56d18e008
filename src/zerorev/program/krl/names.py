"""Names of programs and of holes in KRL: made of any text, and no two texts get the same one.

A name that can stand as it is stays as it is. Where something is cut, replaced or put before it, a short digest of the
whole text follows. KRL and Windows do not tell capitals from small letters: two texts that differ in nothing else get
names that do so, too.
"""

from __future__ import annotations

import base64
import hashlib
import re

from zerorev.program.krl.text import clean, in_ascii

__all__ = ["KEPT", "LONGEST_ID", "RESERVED", "digest", "identifier", "label", "part_name"]

LONGEST_NAME = 24  # KSS 8: names have at most 24 characters
LONGEST_ID = 60  # characters of a hole's id in a comment
DIGEST = 6  # characters, of 32 letters and digits: two of a thousand texts share one in one case of two thousand
PREFIX = "drill_"

_LANGUAGE = """
AND ANIN ANOUT ASYCANCEL ASYCONT ASYPTP ASYSTOP AXIS BOOL BRAKE BRAKE_F B_AND B_EXOR B_NOT B_OR CA CASE CAST_FROM
CAST_TO CCLOSE CHANNEL CHAR CIOCTL CIRC CIRC_REL CONFIRM CONST CONTINUE COPEN CP CREAD CWRITE C_DIS C_ORI C_PTP C_SPL
C_VEL DECL DEF DEFAULT DEFDAT DEFFCT DELAY DIGIN DISABLE DISTANCE DIV DO E3AXIS E3POS E6AXIS E6POS ELSE ENABLE END
ENDDAT ENDFCT ENDFOR ENDIF ENDLOOP ENDSPLINE ENDSWITCH ENDWHILE ENUM EXIT EXOR EXT EXTFCT EXTFCTP EXTP FALSE FOR FRAME
GLOBAL GOTO HALT IF IMPORT INERTIA INT INTERRUPT IS LIN LIN_REL LOAD LOOP MAXIMUM MINIMUM MOD NOT OFF ON ONSTART
ON_ERROR_PROCEED OR PATH POS PRIO PTP PTP_REL PUBLIC PULSE REAL REPEAT RESUME RETURN SCIRC SCIRC_REL SEC SIGNAL SLIN
SLIN_REL SPL SPLINE SPL_REL SPTP SPTP_REL SREAD STEP STOP STRUC SWITCH SWRITE SYNC THEN TIME_BLOCK TO TRIGGER TRUE UNTIL
WAIT WHEN WHILE WITH
"""
_BUILT_IN = """
ABS ACOS ATAN ATAN2 CANCELPROGSYNC CLEAR_KRLMSG COS EB EK EO ERR_CLEAR ERR_RAISE EXECFUNC EXISTS_KRLDLG EXISTS_KRLMSG
FORWARD FRAND GETCYCDEF GETSYSSTATE GETVARSIZE GET_DECL_PLACE GET_MSGBUFFER GET_SIG_INF GET_SYSTEM_DATA INVERSE INV_POS
IOCTL ISMESSAGESET IS_KEY_PRESSED LK MAXIMIZE_USEDXROBVERS MBX_REC MD_ASGN MD_CMD MD_GETSTATE MD_SETSTATE M_COMMENT
REMOTECMD REMOTEREAD ROB_STOP ROB_STOP_RELEASE ROUND SET_BRAKE_DELAY SET_KRLDLG SET_KRLDLGANSWER SET_KRLMSG
SET_OPT_FILTER SET_SYSTEM_DATA SET_SYSTEM_DATA_DELAYED SET_USEDXROBVERS SIN SQRT STRADD STRCLEAR STRCOMP STRCOPY
STRDECLLEN STRFIND STRLEN STRTOAXIS STRTOBOOL STRTOE3AXIS STRTOE3POS STRTOE6AXIS STRTOE6POS STRTOFRAME STRTOINT STRTOPOS
STRTOREAL STRTOSTRING SYNCCMD TAN TIMER_LIMIT TOOL_ADJ TRUNC VARSTATE VARTYPE WSPACEGIVE WSPACETAKE
"""
_DELIVERED = """
A10 A20 A50 ADAT ARC_MSG BAS BASE_DATA BAS_COMMAND BOSCH CELL COLLMONUSER COR_T1 FDAT FLT_SERV GRIPPER GRP_MAIN H50 H70
IR_STOPM ISR_GRP LDAT LOAD_DATA MACHINE MASREF_MAIN MASREF_USER MSGLIB NEW_SERV P00 P00_COMMAND PDAT PERCEPT ROBCOR SPS
TM_MAIN TOOL_DATA USERSAVE USERSPOT USER_GLO USER_GRP USER_MSG WEAV_DEF
"""
_WINDOWS = "AUX CLOCK$ CON CONIN$ CONOUT$ NUL PRN " + " ".join(
    f"{port}{n}" for port in ("COM", "LPT") for n in range(10)
)

KEPT = frozenset(f"{_LANGUAGE} {_BUILT_IN}".split())
"""Words of the language and functions that are built in: what no call may be called."""

RESERVED = KEPT | frozenset(f"{_DELIVERED} {_WINDOWS}".split())
"""The same, modules and data that a controller has, and Windows' devices: a program so called would not load, or would
take the place of what is called so."""

_NAME = re.compile(rf"[A-Za-z][A-Za-z0-9_]{{0,{LONGEST_NAME - 1}}}")


def identifier(name: str) -> str:
    """A name of a program made of any text: letters, digits and `_`, a letter first, at most 24 characters.

    Args:
        name: kept as it is where it is such a name, and not reserved; else a digest of it is at the end.
    """
    if _NAME.fullmatch(name) and name.upper() not in RESERVED:
        return name
    kept = re.sub(r"[^A-Za-z0-9_]+", "_", in_ascii(name)).strip("_")
    if not kept or not kept[0].isalpha() or kept.upper() in RESERVED:
        kept = f"{PREFIX}{kept}"
    return f"{kept[: LONGEST_NAME - DIGEST - 1].rstrip('_')}_{digest(name)}"


def part_name(name: str, number: int) -> str:
    """What the part of a program is called, which the program calls: `NAME_1` and so on.

    Args:
        name: of the program, an `identifier`.
        number: of the part, from 1.
    """
    end = f"_{number}"
    if len(name) + len(end) <= LONGEST_NAME:
        return name + end
    return f"{name[: LONGEST_NAME - len(end) - DIGEST - 1].rstrip('_')}_{digest(name)}{end}"


def label(hole_id: str) -> str:
    """What a comment calls a hole: its id, or where that has to be cut or replaced its two ends and a digest."""
    plain = clean(hole_id)
    if plain == hole_id and len(plain) <= LONGEST_ID:
        return plain
    rest = LONGEST_ID - DIGEST - 2
    if len(plain) > rest:  # ids from CAD differ at the end
        plain = f"{plain[: rest // 2 - 3].rstrip()}...{plain[-(rest // 2) :].lstrip()}"
    return f"{plain} ~{digest(hole_id)}"


def digest(text: str) -> str:
    """Six small letters and digits that differ where the texts do."""
    code = hashlib.sha256(text.encode("utf-8", "surrogatepass")).digest()
    return base64.b32encode(code).decode().lower()[:DIGEST]
