"""`zerorev recordings holes`: what a measuring machine says of drilled holes, and what was predicted of them."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

from cyclopts import Parameter

from zerorev.cli.common import FINE, FOUND, Whole, check_outputs, first_tool, machines, need, recordings_app
from zerorev.errors import InputError
from zerorev.report.words import terminal

if TYPE_CHECKING:
    from zerorev.cell.recordings.holes_predicted import Comparison
    from zerorev.model.measured_hole import MeasuredHole
    from zerorev.model.plan import Plan

__all__ = ["holes"]

SETS = 300
Drilled = Literal["plan", "baseline", "twin"]


@recordings_app.command(name="holes")
def holes(
    file: Path,
    /,
    *,
    plan: Path | None = None,
    study: Path | None = None,
    cell: Path | None = None,
    sets: Whole | None = None,
    seed: Whole | None = None,
    motion: Drilled = "plan",
    output: Annotated[Path | None, Parameter(name=["--output", "-o"])] = None,
    json: bool = False,
) -> int:
    """Show measured holes: position error, tilt, range of the diameter, roundness; beside the prediction of their plan.

    Args:
        file: A table (CSV) with a row for each section: hole, depth_mm, diameter_mm, x_mm, y_mm, roundness_mm.
        plan: The plan file (JSON) that was drilled: each hole is set beside the range that is predicted of it.
        study: The study of the plan, which `zerorev simulate -o` has written; without it the plan is simulated.
        cell: What is known of the arm (YAML), as `zerorev identify` writes it.
        sets: How many sets of parameters are simulated, 300 by default.
        seed: Of the sets, 0 by default.
        motion: Which motion drilled them; by default the plan.
        output: A page (HTML) with table and picture; it needs no network.
        json: Print the figures as JSON on standard output, and nothing else there.
    """
    _check_options(plan, study, cell, sets, seed, motion, output)
    check_outputs((output,), *(path for path in (file, plan, cell) if path is not None))
    if output is not None:
        need("matplotlib", "matplotlib", "--output", "figures")
    from zerorev.cell.recordings.holes import read_holes
    from zerorev.report.words import measured_holes as shown

    found, unused = read_holes(file)
    if unused:
        terminal.note(f"columns that are not used: {', '.join(unused)}")
    if plan is None:
        if json:
            terminal.print_json(shown.holes_data(found))
        else:
            terminal.out().print(shown.holes_table(found))
        return FINE

    from zerorev.cell.recordings.holes_predicted import check_of_plan
    from zerorev.files.io import read_plan

    stated = first_tool(read_plan(plan))
    check_of_plan(found, stated, str(file))
    compared = _compared(found, stated, study, cell, sets, seed, motion)
    if json:
        terminal.print_json(shown.holes_data(found, compared))
    else:
        terminal.out().print(shown.holes_table(found))
        terminal.out().print(shown.beside_table(compared))
        terminal.print_lines(shown.beside_lines(compared))
    if output is not None:
        from zerorev.files.output import write_text
        from zerorev.report.figures.measured_holes import holes_page

        write_text(output, holes_page(compared, file.name, stated.name or plan.name))
        if not json:
            terminal.say(f"page written to {output}")
    return FINE if compared.holes and not compared.left_out else FOUND


def _check_options(plan: Path | None, study: Path | None, cell: Path | None, *others: object) -> None:
    sets, seed, motion, output = others
    if plan is None:
        for option, given in (
            ("--study", study), ("--cell", cell), ("--sets", sets), ("--seed", seed), ("--output", output),
        ):  # fmt: skip
            if given is not None:
                raise InputError("has no meaning without a plan", where=option, accepted="--plan PLAN.json beside it")
        if motion != "plan":
            raise InputError("has no meaning without a plan", where="--motion", accepted="--plan PLAN.json beside it")
    if study is not None:
        need("xarray", "xarray", "--study", "maps")
        need("zarr", "zarr", "--study", "maps")
        for option, given in (("--cell", cell), ("--sets", sets), ("--seed", seed)):
            if given is not None:
                raise InputError("has no meaning beside a study, which has its own", where=option)


def _compared(
    found: Sequence[MeasuredHole],
    stated: Plan,
    study: Path | None,
    cell: Path | None,
    sets: int | None,
    seed: int | None,
    motion: Drilled,
) -> Comparison:
    from dataclasses import replace

    from zerorev.cell.ensemble import HoleStudy
    from zerorev.cell.ensemble import study as simulated
    from zerorev.cell.possible import check_robot, finished, possible_arms
    from zerorev.cell.recordings.holes_predicted import Basis, beside_prediction
    from zerorev.files.cell_file import read_cell
    from zerorev.model.ranges import Cell
    from zerorev.report.words.study import kept_words

    why_not: dict[str, str] = {}
    if study is not None:
        from zerorev.cell.study_file import read_study

        stored = read_study(study, stated)
        predicted = {each.id: each for each in stored.holes}
        basis = Basis(motion, stored.sets, stored.seed, stored.thrust, study=study.name)
    else:
        where = machines(None, None)
        own_seed = 0 if seed is None else seed
        known = Cell() if cell is None else read_cell(cell)
        check_robot(known, stated.robot.name, str(cell))
        arms = finished(possible_arms(stated, known, SETS if sets is None else sets, own_seed, machines=where))
        if (words := kept_words(arms)) is not None:
            terminal.note(words)
        ids = {hole.id for hole in found}
        drilled = replace(stated, holes=tuple(hole for hole in stated.holes if hole.hole.id in ids))
        predicted = {}
        with terminal.progress("simulating", len(drilled.holes), each="block") as progress:
            for each in simulated(
                drilled, arms.sets, thrust=stated.settings.thrust, motions=(motion,), machines=where, progress=progress
            ):
                if isinstance(each, HoleStudy):
                    predicted[each.id] = each
                else:
                    why_not[each[0]] = each[1]
        basis = Basis(motion, len(arms.sets), own_seed, stated.settings.thrust, None if cell is None else cell.name)
    return beside_prediction(found, stated, predicted, why_not, basis)
