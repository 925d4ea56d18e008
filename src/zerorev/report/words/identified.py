"""What `zerorev identify` shows: each range, what it rests on, and what nothing recorded says."""

from __future__ import annotations

from typing import Any

from rich import box
from rich.table import Table
from rich.text import Text

from zerorev.cell.identify.cell import Identified
from zerorev.files.units import mm
from zerorev.model._arrays import Array
from zerorev.model.ranges import Basis, Range

__all__ = ["identified_data", "identified_lines", "identified_table"]

STYLES: dict[Basis, str] = {"prior": "dim", "fitted": "green", "conditioned": "cyan"}
UNSEEN = ("gap", "stiffness", "behind", "kind")


def identified_data(found: Identified) -> dict[str, Any]:
    """All as plain data."""
    friction = found.friction
    return {
        "parameters": {name: _range_data(each) for name, each in found.cell.ranges.items()},
        "friction_nm": _values(friction.coulomb.T),
        "viscous_nms_per_rad": _values(friction.viscous.T),
        "tool_mass_kg": _values(friction.mass),
        "residual_nm": _values(friction.residual),
        "segments": [round(count) for count in friction.rows],
        "sticking": [{"joint": joint + 1, "speed_rad_s": speed} for joint, speed in friction.sticking],
        "baselines_mm": {each.hole: float(mm(each.measured.deviation_max)) for each in found.baselines},
        "sets": None if found.nearest is None else {
            "tried": found.nearest.tried, "kept": len(found.nearest.sets),
            "nearest": float(found.nearest.distance[0]), "farthest_kept": float(found.nearest.distance[-1]),
        },
    }  # fmt: skip


def _range_data(each: Range) -> dict[str, Any]:
    return {
        "nominal": float(each.nominal), "low": float(each.low), "high": float(each.high), "law": each.law,
        "basis": each.basis, "source": each.source,
    }  # fmt: skip


def _values(table: Array) -> Any:
    return table.tolist()


def identified_table(found: Identified) -> Table:
    """Every range that is not its prior."""
    table = Table(box=box.SIMPLE_HEAD)
    for name in ("parameter", "value", "low", "high", "basis", "what it is"):
        table.add_column(name, justify="right" if name in ("value", "low", "high") else "left")
    for name, each in found.cell.ranges.items():
        if each.basis != "prior":
            numbers = (f"{number:.3g}" for number in (each.nominal, each.low, each.high))
            table.add_row(name, *numbers, each.basis, each.means, style=STYLES[each.basis])
    return table


def identified_lines(found: Identified, names: tuple[str, ...]) -> list[Text]:
    """What was found in words."""
    friction, ranges = found.friction, found.cell.ranges
    dry = ", ".join(f"{name} {value:.3g}" for name, value in zip(names, friction.coulomb[0], strict=True))
    mass, low, high = friction.mass
    lines = [f"dry friction [N m]: {dry}", f"mass of the tool: {mass:.3g} kg ({low:.3g} to {high:.3g})"]
    for joint in sorted({joint for joint, _ in friction.sticking}):
        speeds = ", ".join(f"{speed:g}" for own, speed in friction.sticking if own == joint)
        lines.append(f"{names[joint]} sticks and slips at {speeds} rad/s: left out")
    if found.nearest is not None:
        share = 100 * found.nearest.distance
        lines.append(
            f"{len(found.nearest.sets)} of {found.nearest.tried} sets stray as the recorded baseline does, within "
            f"{share[0]:.0f} to {share[-1]:.0f} %"
        )
    for each in found.baselines:
        lines.append(f"baseline of hole {each.hole}: {mm(each.measured.deviation_max):.3f} mm by the encoders")
    guessed = [name for name in UNSEEN if ranges[name].basis == "prior"]
    if guessed:
        lines.append(
            f"still a guess: {', '.join(guessed)}; no encoder sees what gears give behind it, a measurement at the "
            "tool does (--reversal-values)"
        )
    if found.nearest is None:
        lines.append("still a guess: the controller; recordings of baselines narrow it (--baseline)")
    return [Text(line) for line in lines]
