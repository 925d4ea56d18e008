"""The parameter map (sec. 4.7, Figure 26), its symmetry (eq. 4.12), and where its missing block comes from (4.11)."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from zerorev.model._arrays import Array
from zerorev.motion.drilling import Drilling
from zerorev.report.figures.style import png
from zerorev.search.exact import search
from zerorev.thesis.figures.parameter_map import parameter_slices, zero_volume
from zerorev.thesis.measures import best_cell, mirrored, zero_reversals
from zerorev.thesis.parameter_map import parameter_map
from zerorev.thesis.reproduce.context import Context
from zerorev.thesis.reproduce.published import MAP_EXAMPLE_RAD, MAP_EXAMPLE_REVERSALS, POSITIONS
from zerorev.thesis.reproduce.section import Column, Picture, Result, Section, Table
from zerorev.thesis.sampled import SampledObjective, Turns, Weighing

if TYPE_CHECKING:
    from xarray import Dataset

__all__ = ["make"]

SHOWN = np.array([0.0])  # psi_t of Fig. 26 [rad]
WAYS: dict[str, Turns] = {"turns for the whole path": "after_extents", "turns of the first point": "first_point"}


def make(context: Context) -> Section:
    """The map with each way of choosing turns, as a slice and as a whole."""
    slices = {name: _map(context, turns, SHOWN) for name, turns in WAYS.items()}
    whole = {name: _map(context, turns, None) for name, turns in WAYS.items()}
    chosen = next(iter(whole.values()))
    table, results = _table(whole), [_symmetry(whole), _example(context), _share(context, chosen)]
    pictures = (
        Picture(
            "fig_26",
            "Figure 26, the slice at ψt = 0, with each way of choosing the turns: above the objective (eq. 4.7),"
            " below the reversals. Left both halves mirror each other; right, where the turns are those"
            " of the first point, motions are"
            " lost on one side of the diagonal.",
            png(parameter_slices(slices)),
        ),
        Picture(
            "zero_volume",
            "All spins with zero reversals, coloured by travel, with their shadows on the walls.",
            png(zero_volume(chosen)),
        ),
    )
    text = (
        "The objective is evaluated over all three spins, on all eight branches. Its map is built from pairs of legs"
        " instead of motion by motion, which changes nothing but the time.",
        "Turns of the first point: every joint begins within ±180°, joint 6 within 0 to 360° as in"
        " Appendix B. The thesis"
        " finds its map “mostly symmetrical … apart from a missing block” and lays the block to joint limits."
        " It is a matter of turns: a joint that runs over 200° fits within its limits only if it begins on the right"
        " one, which the first point alone cannot tell.",
    )
    return Section(text, tuple(results), (table,), pictures)


def _map(context: Context, turns: Turns, psi_target: Array | None) -> Dataset:
    return parameter_map(
        context.robot,
        context.tool,
        POSITIONS[0].hole,
        Weighing(turns=turns),
        size=context.map_size,
        psi_target=psi_target,
        progress=context.tell,
    )


def _table(whole: dict[str, Dataset]) -> Table:
    columns = (
        Column("turns"),
        Column("cells that differ from their mirror", "%", 3),
        Column("lost in the mirror", "%", 3),
        Column("cannot be run", "%", 2),
        Column("zero reversals", "% of cells", 4),
        Column("best cell, travel", "deg"),
    )
    rows = []
    for name, found in whole.items():
        apart = mirrored([found])
        stuck = 100 * float((found["reversals"].values < 0).mean())
        best = best_cell(found)
        rows.append(
            (
                name,
                100 * apart.differing,
                100 * apart.lost,
                stuck,
                100 * zero_reversals(found).share,
                best.travel_deg if best.reversals == 0 else None,
            )
        )
    return Table("parameter_map", "The whole map, with each way of choosing the turns.", columns, tuple(rows))


def _symmetry(whole: dict[str, Dataset]) -> Result:
    chosen, fixed = (mirrored([found]) for found in whole.values())
    return Result(
        "symmetry of the map about ψs = ψe",
        "mostly, apart from a missing block above ψe = −1 rad",
        "sec. 4.7, Figure 26, eq. 4.12",
        f"turns of the first point: {100 * fixed.differing:.2f} % of the cells differ from their mirror",
        f"turns for the whole path: {100 * chosen.differing:.2f} %, greatest difference {chosen.greatest:.0e}",
        "The block is not a property of the arm: it goes when the turns are chosen after the extents are known.",
    )


def _example(context: Context) -> Result:
    there, back = np.array([MAP_EXAMPLE_RAD, MAP_EXAMPLE_RAD[::-1]])[:, None]
    counted = []
    for name, turns in WAYS.items():
        objective = SampledObjective(Drilling(context.robot, context.tool, POSITIONS[0].hole), Weighing(turns=turns))
        counts = [int(objective.reversals(spins)[0]) for spins in (there, back)]
        counted.append(f"{name}: " + " and ".join("none can be run" if n < 0 else f"{n} reversals" for n in counts))
    return Result(
        "ψ = [−1, 0, 1] and [1, 0, −1] rad",
        f"{MAP_EXAMPLE_REVERSALS} reversals on one branch; none can be run",
        "sec. 4.7",
        counted[1],
        counted[0],
        "The thesis' own example of a lost mirror image.",
    )


def _share(context: Context, found: Dataset) -> Result:
    zero, best = zero_reversals(found), best_cell(found)
    exact = search(Drilling(context.robot, context.tool, POSITIONS[0].hole), context.thesis)
    assert exact is not None
    travel = f"best cell {best.travel_deg:.1f}° of travel" if best.reversals == 0 else "no cell of this grid has zero"
    return Result(
        "share of the cube of spins with zero reversals",
        "not stated; 100³ cells, 8 configurations",
        "sec. 4.7",
        f"{100 * zero.share:.3f} % of {found['score'].size:,} cells; {travel}",
        f"{exact.reversals} reversals, {np.rad2deg(exact.score.travel):.1f}°",
        "A grid comes near the optimum, the exact search meets it.",
    )
