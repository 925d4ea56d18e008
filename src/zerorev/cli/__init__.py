"""The command line: arguments in, calls out.

A module that takes long to import is imported by the command that needs it, so that `--help` answers at once.
"""

from __future__ import annotations

import os
import sys
import traceback
from collections.abc import Sequence

from cyclopts import CycloptsError

# a file that defines commands joins them to the app when it is imported; the order is that of --help
from zerorev.cli import (  # noqa: F401
    check,
    compare,
    depth,
    export,
    holes,
    identify,
    map,
    map_compare,
    map_show,
    methods,
    offset,
    parameter_map,
    place,
    plan,
    rates,
    recordings,
    recordings_compare,
    recordings_holes,
    recordings_record,
    recordings_repeat,
    replay,
    reproduce,
    robots,
    robots_import,
    share,
    simulate,
    view,
)
from zerorev.cli.common import BAD_INPUT, BUG, FINE, FOUND, INTERRUPTED, PIPE_CLOSED, app
from zerorev.errors import NotExportableError, ZerorevError
from zerorev.report.words import terminal

__all__ = ["app", "main"]


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line and return its exit code; no error leaves it but as one message.

    Args:
        arguments: without the program's name; by default those of the process.
    """
    terminal.replace_what_cannot_be_shown()
    with terminal.notices():
        try:
            result = app(
                arguments, exit_on_error=False, print_error=False, console=terminal.out(), error_console=terminal.err()
            )
            sys.stdout.flush()
        except (ZerorevError, CycloptsError) as error:
            terminal.complain(str(error).strip())
            # that a plan must not become a program is an answer, not a fault of the question
            return FOUND if isinstance(error, NotExportableError) else BAD_INPUT
        except KeyboardInterrupt as interrupt:
            terminal.complain(str(interrupt) or "interrupted; no file was left half-written")
            return INTERRUPTED
        except BrokenPipeError:
            os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())  # else the interpreter complains at its end
            return PIPE_CLOSED
        except Exception:
            traceback.print_exc()
            terminal.complain("a fault in zerorev itself; please report the lines above")
            return BUG
    return result if isinstance(result, int) else FINE
