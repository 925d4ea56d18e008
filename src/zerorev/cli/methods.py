"""`zerorev methods`: search methods against each other."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from zerorev.cli.common import FINE, Output, Whole, app, check_outputs, job_of, need
from zerorev.errors import InputError
from zerorev.report.words import terminal

__all__ = ["methods"]

USUAL = "exact,swarm,differential_evolution,dual_annealing,direct"


@app.command
def methods(
    job: Path,
    /,
    *,
    methods: str = USUAL,
    seeds: Whole = 20,
    hole: str | None = None,
    budget: Whole | None = None,
    samples: Whole | None = None,
    crowded: bool = False,
    output: Output = None,
    figure: Path | None = None,
    json: bool = False,
) -> int:
    """Compare search methods: how often they find zero reversals, how good what they find is, and how long they take.

    All of them look for the least of the thesis' objective (eq. 4.7, no motion threshold), with as many evaluations
    each; what they find is evaluated exactly. After Ctrl-C what is finished is shown.

    Args:
        job: The job file (YAML): robot, tool, holes.
        methods: Names with commas between them: exact, swarm, swarm_trial_1 to swarm_trial_8, differential_evolution,
            direct, dual_annealing, pymoo_pso, pymoo_ga, pymoo_de, cma; by default exact, swarm and those of SciPy.
        seeds: How many runs of each method, with the seeds 0, 1, 2, ...; a method without chance runs once.
        hole: The id of the only hole to compare at.
        budget: Evaluations a run at most; by default 5,100, the thesis'.
        samples: Steps of a motion that the objective looks at; by default 200, the thesis'.
        crowded: The samples crowd at the ends of the legs, where reversals hide between even ones, as the thesis' are.
        output: Where to write the answer: JSON, or a row per run where it ends in .csv.
        figure: Picture to draw (PNG): box plots.
        json: Print the answer as JSON on standard output, and nothing else there.
    """
    from zerorev.files.output import write_bytes, write_text

    check_outputs((output, figure), job)
    if figure is not None:
        need("matplotlib", "matplotlib", "--figure", "figures")
    if seeds < 1:
        raise InputError(f"{seeds} seeds", where="--seeds", accepted="1 or more")
    wanted = job_of(job)

    from zerorev.files.text import json_text
    from zerorev.thesis import comparison as shown
    from zerorev.thesis.compare import comparison, runs

    given = {"budget": budget, "samples": samples}
    limits = {key: value for key, value in given.items() if value is not None}
    names = [name.strip() for name in methods.split(",") if name.strip()]
    asked = comparison(wanted, names, range(seeds), hole=hole, crowded=crowded, **limits)
    found, interrupted = [], False
    try:
        with terminal.progress("comparing", asked.expected, each="run") as progress:
            for run in runs(asked):
                found.append(run)
                if progress:
                    progress(len(found), asked.expected)
    except KeyboardInterrupt:
        interrupted = True
    answer = replace(asked, runs=tuple(found))
    data = shown.comparison_data(answer)
    if json:
        terminal.print_json(data)
    elif found:
        terminal.out().print(shown.comparison_table(answer))
        terminal.print_lines(shown.comparison_lines(answer))
    if interrupted:
        raise KeyboardInterrupt(f"interrupted after {len(found)} of {asked.expected} runs; no file was written")
    if output is not None:
        write_text(output, shown.comparison_csv(answer) if output.suffix.lower() == ".csv" else json_text(data))
    if figure is not None:
        from zerorev.report.figures.style import png
        from zerorev.thesis.figures.comparison import comparison_boxes

        write_bytes(figure, png(comparison_boxes(answer)))
    for what, path in (("answer", output), ("figure", figure)):
        if path is not None and not json:
            terminal.say(f"{what} written to {path}")
    return FINE
