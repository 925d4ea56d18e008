"""`zerorev parameter-map`: the thesis' objective everywhere in the cube of spins."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Literal

from zerorev.cli.common import FINE, Output, Whole, app, job_of, need
from zerorev.errors import InputError
from zerorev.report.words import terminal

if TYPE_CHECKING:
    from zerorev.model.hole import Hole
    from zerorev.model.job import Job

__all__ = ["map_parameters"]

Turns = Literal["after_extents", "first_point"]
SLICES_AT_ONCE = 16  # of the map that is measured and not kept


@app.command(name="parameter-map")
def map_parameters(
    job: Path,
    /,
    *,
    output: Output = None,
    hole: str | None = None,
    size: Whole = 100,
    turns: Turns = "after_extents",
    figures: Path | None = None,
    psi_target_deg: float = 0.0,
) -> int:
    """Map the thesis' objective (eq. 4.7) over the spins at start, target and end, each motion on its best branch.

    Says how much of the cube of spins has zero reversals, which cell is the best, and how far the map is from its own
    mirror (eq. 4.12) with either choice of turns.

    Args:
        job: The job file (YAML): robot, tool, holes. Spins go from -180 to 180 deg, or as far as its bound lets them.
        output: Where to write the map: a folder of zarr. Without it the answer is only shown.
        hole: The id of the hole; by default the first.
        size: Spins on each axis.
        turns: after_extents, or first_point as in the thesis, from where the missing block of its Fig. 26 comes.
        figures: Folder for two pictures (PNG) and a page with a slice to be moved (HTML).
        psi_target_deg: Spin at the target of the slice in the picture.
    """
    need("xarray", "xarray", "parameter-map", "maps")
    if output is not None:
        need("zarr", "zarr", "--output", "maps")
    if figures is not None:
        need("matplotlib", "matplotlib", "--figures", "figures")
        need("plotly", "plotly", "--figures", "maps")
    from zerorev.files.output import check_folder, check_whole_folder, make_folder, write_bytes, write_text

    if output is not None:
        check_whole_folder(output, "zarr.json")
    if figures is not None:
        check_folder(figures)
    if not math.isfinite(psi_target_deg):
        raise InputError(f"{psi_target_deg!r}", where="--psi-target-deg", accepted="a finite angle")
    wanted = job_of(job)
    place = _hole(wanted, hole)

    from zerorev.thesis.measures import mirrored
    from zerorev.thesis.parameter_map import parameter_map, spin_axis
    from zerorev.thesis.parameter_map_lines import TURNS, map_lines
    from zerorev.thesis.sampled import Weighing
    from zerorev.thesis.store import write_map

    bound = wanted.settings.psi_bound or math.pi
    robot = replace(wanted.robot, limits=wanted.robot.allowed(wanted.settings.limit_margin))
    made = partial(parameter_map, robot, wanted.tool, place, size=size, psi_range=(-bound, bound))
    with terminal.progress("mapping", size, each="slice") as progress:
        found = made(Weighing(turns=turns), progress=progress)
    other: Turns = "first_point" if turns == "after_extents" else "after_extents"
    axis = spin_axis(size, (-bound, bound))
    parts = (axis[first : first + SLICES_AT_ONCE] for first in range(0, size, SLICES_AT_ONCE))
    with terminal.busy("mapping with the other choice of turns"):
        mirrors = {
            turns: mirrored([found]),
            other: mirrored(made(Weighing(turns=other), psi_target=part) for part in parts),
        }
    terminal.say(f"hole {place.id}, {TURNS[turns]}")
    for line in map_lines(found, mirrors):
        terminal.say(line)
    if output is not None:
        write_map(found, output)
        terminal.say(f"map written to {output}")
    if figures is not None:
        from zerorev.report.figures.style import png
        from zerorev.thesis.figures.parameter_map import parameter_slices, zero_volume
        from zerorev.thesis.figures.parameter_map_page import map_page

        make_folder(figures)
        psi_target = [math.radians(psi_target_deg)]
        shown = {TURNS[way]: made(Weighing(turns=way), psi_target=psi_target) for way in sorted(TURNS)}
        write_bytes(figures / "parameter_slices.png", png(parameter_slices(shown)))
        write_bytes(figures / "zero_volume.png", png(zero_volume(found)))
        write_text(figures / "parameter_map.html", map_page(found))
        terminal.say(f"figures written to {figures}")
    return FINE


def _hole(job: Job, name: str | None) -> Hole:
    """The hole of this id, or the first, free of a given motion and its branch."""
    ids = [each.id for each in job.holes]
    if name is not None and name not in ids:
        raise InputError(f"there is no hole '{name}'", where="--hole", accepted=", ".join(ids[:8]))
    place = job.holes[0 if name is None else ids.index(name)]
    return place if place.profile is None else replace(place, profile=None, branch=None)
