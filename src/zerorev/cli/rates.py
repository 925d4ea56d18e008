"""`zerorev rates`: what is predicted before any search."""

from __future__ import annotations

import math
from pathlib import Path

from zerorev.cli.common import FINE, Whole, app, job_of, of_tool
from zerorev.report.words import terminal

__all__ = ["rates"]


@app.command
def rates(job: Path, /, *, psi_deg: float | None = None, tool: Whole | None = None, json: bool = False) -> int:
    """Show the critical twist rates of each hole and what they predict, before any search.

    Args:
        job: The job file (YAML): robot, tool, holes.
        psi_deg: Show the rates at this spin on every branch that reaches, instead of where zero reversals are cheapest.
        tool: Of a job of several tools: those of this one, from 1; by default the first.
        json: Print JSON on standard output, and nothing else there.
    """
    wanted = of_tool(job_of(job, every_tool=True), tool)

    from zerorev.motion.critical import critical_at
    from zerorev.motion.drilling import Drilling
    from zerorev.report.words import rates as shown
    from zerorev.search.prediction import predict

    if psi_deg is not None:
        psi = math.radians(psi_deg)
        drillings = [Drilling.of(wanted, hole) for hole in wanted.holes]
        found = [(one.hole, each) for one in drillings for each in critical_at(one, psi)]
        if json:
            terminal.print_json([{"id": hole.id} | shown.rates_data(each) for hole, each in found])
        else:
            terminal.out().print(shown.rates_table(wanted, found))
        return FINE
    predicted = [predict(Drilling.of(wanted, hole), wanted.settings) for hole in wanted.holes]
    if json:
        pairs = zip(wanted.holes, predicted, strict=True)
        terminal.print_json([shown.predicted_data(hole, each) for hole, each in pairs])
    else:
        terminal.out().print(shown.predicted_table(wanted, predicted))
    return FINE
