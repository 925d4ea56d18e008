"""`zerorev simulate`: what a plan gains on arms as they may be."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from zerorev.cli.common import FINE, FOUND, Output, Whole, app, machines, need, of_tool
from zerorev.errors import InputError
from zerorev.report.words import terminal

if TYPE_CHECKING:
    from zerorev.cell.ensemble import HoleStudy

__all__ = ["simulate"]


@app.command
def simulate(
    plan: Path,
    /,
    *,
    cell: Path | None = None,
    sets: Whole = 300,
    seed: Whole = 0,
    feed_mm_s: float | None = None,
    thrust_n: float | None = None,
    corner_mm: float | None = None,
    vary_cell: bool = False,
    tool: Whole | None = None,
    output: Output = None,
    figures: Path | None = None,
    workers: int | None = None,
    scheduler: str | None = None,
    json: bool = False,
) -> int:
    """Simulate a plan on many arms as they may be: how far the tip strays, by the encoders and at the tool.

    Each set of parameters is one possible arm: friction, stiffness and lost motion of its gears, its controller, its
    tool. Most of them nobody knows, so they are ranges, and so are the answers: medians with the 5th and 95th
    percentile. So are position, tilt and ovality of the hole that a free tip leaves, as upper bounds. Compared are the
    plan, the same holes at constant spin (the baseline), the plan's twin, a controller that compensates lost motion,
    and gears that were laid on one flank before.

    Args:
        plan: The plan file (JSON), of a robot whose file has masses (dynamics).
        cell: What is known of the arm (YAML), as zerorev identify writes it; without it every parameter has its prior.
            Where the file says what was measured of the plan's baselines, the sets that are far from that are dropped.
        sets: How many sets of parameters are drawn.
        seed: Of the sets; the same seed gives the same answer, on any number of workers.
        feed_mm_s: Feed of both legs; by default as planned.
        thrust_n: Thrust of the drill while it cuts; by default the plan's thrust_n.
        corner_mm: Radius of the blend at the corner; by default as planned.
        vary_cell: Vary the corner, acceleration, smoothing and the tool centre point, too.
        tool: Of a plan of several tools: what this one does, from 1; by default the first.
        output: Folder of zarr for all figures of all sets. With it an interrupted study resumes.
        figures: Folder for pictures (PNG); it is made if its parent exists.
        workers: Processes to run it on; by default all cores where it is worth it. The answer is the same.
        scheduler: Address of a dask.distributed scheduler to run it on instead, e.g. tcp://10.0.0.1:8786.
        json: Print the answer as JSON on standard output, and nothing else there.
    """
    where = machines(workers, scheduler)
    for option, value, least in (
        ("--feed-mm-s", feed_mm_s, 0.0), ("--corner-mm", corner_mm, 0.0), ("--sets", sets, 0.0),
    ):  # fmt: skip
        if value is not None and not least < value < float("inf"):
            raise InputError(f"{value:g} is out of range", where=option, accepted="a number above 0")
    if thrust_n is not None and not 0 <= thrust_n < float("inf"):
        raise InputError(f"{thrust_n:g} is out of range", where="--thrust-n", accepted="a number, 0 or more [N]")
    if figures is not None:
        need("matplotlib", "matplotlib", "--figures", "figures")
        from zerorev.files.output import check_folder

        check_folder(figures)
    if output is not None:
        need("xarray", "xarray", "--output", "maps")
        need("zarr", "zarr", "--output", "maps")
        from zerorev.cell.study_file import StudyFolder, check_place

        check_place(output)
    from zerorev.cell.ensemble import HoleStudy, study
    from zerorev.cell.possible import check_robot, finished, possible_arms
    from zerorev.cell.reference import Manner
    from zerorev.files.cell_file import read_cell
    from zerorev.files.io import read_plan
    from zerorev.model.ranges import Cell
    from zerorev.model.strokes import by_stroke
    from zerorev.report.words import study as shown

    stated = by_stroke(of_tool(read_plan(plan), tool))
    thrust = stated.settings.thrust if thrust_n is None else thrust_n
    known_arm = Cell() if cell is None else read_cell(cell)
    check_robot(known_arm, stated.robot.name, str(cell))
    arms = finished(possible_arms(stated, known_arm, sets, seed, vary=vary_cell, machines=where))
    if (words := shown.kept_words(arms)) is not None:
        terminal.note(words)
    manner = Manner(
        feed=None if feed_mm_s is None else feed_mm_s * 1e-3, corner=None if corner_mm is None else corner_mm * 1e-3
    )
    folder, known = None, {}
    if output is not None:
        folder = StudyFolder(output, stated, arms.sets, seed, manner, thrust)
        known = folder.known()
        if known:
            terminal.note(f"resuming after {len(known):,} of {len(stated.holes):,} holes in {output}")
    numbers = {hole.hole.id: number for number, hole in enumerate(stated.holes)}
    studied: list[HoleStudy] = []
    left_out: dict[str, str] = {}
    with terminal.progress("simulating", len(stated.holes), each="block") as progress:
        for found in study(
            stated, arms.sets, manner=manner, thrust=thrust, machines=where, known=known, progress=progress
        ):
            if not isinstance(found, HoleStudy):
                left_out[found[0]] = found[1]
                continue
            studied.append(found)
            if folder is not None and found.id not in known:
                folder.add(numbers[found.id], found)
    answer: dict[str, Any] = shown.answer(
        studied, left_out, sets=len(arms.sets), seed=seed, cell=None if cell is None else cell.name
    )
    if json:
        terminal.print_json(answer)
    else:
        terminal.out().print(shown.table(studied))
        terminal.out().print(shown.holes_table(studied))
        terminal.print_lines(shown.lines(studied, left_out, thrust, known_arm, stated.tool))
    if figures is not None and studied:
        from zerorev.report.figures.study import write_figures

        for path in write_figures(studied, stated.robot.joint_names, figures):
            if not json:
                terminal.say(f"picture {path}")
    if output is not None and not json:
        terminal.say(f"study written to {output}")
    return FINE if studied and not left_out else FOUND
