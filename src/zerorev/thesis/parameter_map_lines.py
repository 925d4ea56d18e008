"""What the command `parameter-map` says of a map, in a few lines."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from zerorev.thesis.measures import Mirrored, best_cell, zero_reversals
from zerorev.thesis.sampled import Turns

if TYPE_CHECKING:
    from xarray import Dataset

__all__ = ["TURNS", "map_lines"]

TURNS: dict[Turns, str] = {
    "after_extents": "turns chosen after the extents",
    "first_point": "turns fixed at the first point",
}


def map_lines(found: Dataset, mirrors: Mapping[Turns, Mirrored]) -> list[str]:
    """The map in a few lines: zero reversals, best cell, symmetry.

    Args:
        found: the map.
        mirrors: its symmetry by choice of turns, as `Weighing.turns` names them.
    """
    zero, best = zero_reversals(found), best_cell(found)
    cells = " x ".join(str(found.sizes[name]) for name in ("psi_start_deg", "psi_target_deg", "psi_end_deg"))
    lines = [
        f"{cells} motions; zero reversals: {zero.cells:,} cells, {_percent(zero.share)} of them,"
        f" {_percent(zero.volume)} of the cube of spins"
    ]
    if best.reversals < 0:
        lines.append("no motion of the map can be run")
    else:
        spins = ", ".join(f"{psi + 0.0:.2f}" for psi in best.psi_deg)
        lines.append(
            f"best cell: psi {spins} deg (start, target, end), branch {best.branch}, {best.reversals} reversals,"
            f" travel {best.travel_deg:.1f} deg, objective {best.score:.4f}"
        )
    for turns, mirror in mirrors.items():
        lines.append(
            f"symmetry (eq. 4.12), {TURNS[turns]}: {_percent(mirror.differing)} of the cells differ from their mirror,"
            f" by {mirror.greatest:.3g} at most; {_percent(mirror.lost)} cannot be run although their mirror can"
        )
    return lines


def _percent(share: float) -> str:
    return f"{share * 100:.3g} %"
