"""Every language in which a program can be written and read, and which one a file is in."""

from __future__ import annotations

from pathlib import Path

from zerorev.errors import InputError, NotExportableError
from zerorev.files.text import read_bytes
from zerorev.model.corner import controller_of
from zerorev.model.plan import Plan
from zerorev.model.written import WrittenProgram
from zerorev.program.dialect import Dialect, ProgramFile
from zerorev.program.inform.dialect import INFORM
from zerorev.program.krl.dialect import KRL
from zerorev.program.rapid.dialect import RAPID
from zerorev.program.refusals import refuse_other_makers
from zerorev.program.tp.dialect import TP
from zerorev.program.urscript.dialect import URSCRIPT

__all__ = ["DIALECTS", "dialect_called", "dialect_of", "program_file", "read_program"]

MOST_BYTES = 16 * 2**20  # of a program: some 20,000 holes
BYTE_ORDER_MARK = b"\xef\xbb\xbf"

DIALECTS: dict[str, Dialect] = {each.name: each for each in (KRL, RAPID, TP, URSCRIPT, INFORM)}


def dialect_called(name: str) -> Dialect:
    """A dialect by its name.

    Raises:
        InputError: there is none of it.
    """
    if name not in DIALECTS:
        raise InputError(f"unknown controller '{name}'", where="controller", accepted=", ".join(DIALECTS))
    return DIALECTS[name]


def dialect_of(path: Path) -> Dialect:
    """The dialect that a program's file is in, by the ending of its name.

    Raises:
        InputError: it ends like no program.
    """
    for dialect in DIALECTS.values():
        if path.suffix.lower() == dialect.suffix.lower():
            return dialect
    known = " or ".join(f"{each.suffix} ({each.name}, {each.controller.maker})" for each in DIALECTS.values())
    raise InputError(
        f"'{path.suffix}' is the ending of no program", where=str(path), accepted=f"a program that ends in {known}"
    )


def dialect_for(plan: Plan, controller: str | None = None) -> Dialect:
    """The dialect in which a plan is written: the one asked for, the one it was planned for, or that of the maker.

    Args:
        plan: whose robot it is.
        controller: one of `DIALECTS`; None: not asked for.

    Raises:
        InputError: there is none of that name.
        NotExportableError: the robot is another maker's, or of one whose controller is not known; the plan was made for
            another controller.
    """
    planned, own = plan.settings.controller, controller_of(plan.robot.manufacturer)
    name = controller or planned or (None if own is None else own.name)
    if name is None:
        made = plan.robot.manufacturer.strip() or "a maker that its file does not name"
        raise NotExportableError((f"the robot {plan.robot.name} is of {made}, for which no program can be written",))
    dialect = dialect_called(name)
    refuse_other_makers(name, plan.robot)
    if planned is not None and planned != name:
        why = (
            f"the plan was made for the controller {planned}: plan again with controller: {name}, whose corner differs"
        )
        raise NotExportableError((why,))
    return dialect


def program_file(name: str, controller: str) -> str:
    """How the file of a program is called that is started.

    Args:
        name: of the plan.
        controller: one of `DIALECTS`.

    Raises:
        InputError: an unknown controller.
    """
    dialect = dialect_called(controller)
    return dialect.program_name(name) + dialect.suffix


def read_program(path: Path) -> WrittenProgram:
    """Read a program that `zerorev export` has written, with the parts that lie beside it.

    Args:
        path: of the file that is started.

    Raises:
        InputError: a file that cannot be read, or a statement that `export` does not write.
    """
    main = _file(path)
    dialect = dialect_of(path)
    names = dialect.parts(main)
    beside = {each.name.lower(): each for each in path.parent.iterdir()} if names else {}
    parts = [_file(beside.get(name.lower(), path.with_name(name))) for name in names]
    return dialect.read((main, *parts))


def _file(path: Path) -> ProgramFile:
    known = ", ".join(f"{each.name}, {each.suffix}" for each in DIALECTS.values())
    content = read_bytes(path, f"a program that zerorev has exported ({known})", MOST_BYTES)
    # byte by byte, so that a message can name the line of one that is not ASCII
    return ProgramFile(str(path), content.removeprefix(BYTE_ORDER_MARK).decode("latin-1"))
