"""How a hole is drilled: in one go, breaking chips, or in several strokes; and how long the tool dwells."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Literal

from zerorev.errors import InputError
from zerorev.model.stated import Choice, Number, Switch, check, with_attributes
from zerorev.model.units import MM, S

if TYPE_CHECKING:
    from zerorev.model._arrays import Array

__all__ = ["LONGEST_DWELL", "MOST_BACK", "Cycle", "CycleKind"]

CycleKind = Literal["single", "chip_break", "peck"]
MOST_PECKS = 200
MOST_BACK = 2e-3  # [m] that a drill is drawn back within one motion: further is a retract
LONGEST_DWELL = 10.0  # [s]: two or three turns of the slowest spindle are far shorter
HUNDREDTHS = 100.0  # per second: the coarsest clock of a controller counts them, so that none has to round


@dataclass(frozen=True)
class Cycle:
    """How a hole is drilled."""

    kind: Annotated[
        CycleKind,
        Choice(
            words={
                "single": "in one go",
                "chip_break": "drawing back by back_mm each depth_mm, the drill in the hole, all of it one motion",
                "peck": "pulling the drill out of the hole each depth_mm, each stroke a motion of its own",
            }
        ),
    ] = "single"
    depth: Annotated[
        float | None,
        Number("drilled from one break of the chips, or one stroke, to the next", MM, none="in one go", above=0),
    ] = None
    back: Annotated[
        float, Number("how far the tool draws back to break them, at the feed of the plunge", MM, above=0)
    ] = 0.3e-3
    dwell: Annotated[
        float,
        Number(
            "how long the tool dwells at the target; 0: not at all",
            S,
            least=0,
            to=LONGEST_DWELL,
            note="In hundredths; it stands there, with all joints at rest, or spins on",
        ),
    ] = 0.0
    moving: Annotated[
        bool,
        Switch(
            "whether it spins on meanwhile, so that no joint rests",
            off="the tool stands",
            on="the tool spins on, and the corner is of kind spin",
        ),
    ] = False

    def __post_init__(self) -> None:
        """Check ranges, and that a depth is there where chips are broken or strokes are made."""
        check(self)
        if abs(self.dwell * HUNDREDTHS - round(self.dwell * HUNDREDTHS)) > 1e-9:
            raise InputError(
                f"a dwell of {self.dwell:g} s", where="cycle, dwell_s", accepted="hundredths of a second, e.g. 0.12"
            )
        if self.moving and self.dwell == 0:
            raise InputError(
                "spins on, but not for how long", where="cycle, moving", accepted="dwell_s beside it, e.g. 0.2"
            )
        if self.kind != "single" and self.depth is None:
            what = "breaks chips, but not how often" if self.kind == "chip_break" else "pecks, but not how deep"
            raise InputError(what, where="cycle", accepted="depth_mm beside it, e.g. 5")
        if self.back > MOST_BACK:
            raise InputError(
                f"draws back by {self.back * 1e3:g} mm", where="cycle, back_mm", accepted=f"{MOST_BACK * 1e3:g} or less"
            )
        if self.kind == "chip_break" and self.depth is not None and self.back >= self.depth:
            raise InputError(
                f"draws back by {self.back * 1e3:g} mm each {self.depth * 1e3:g} mm", where="cycle, back_mm",
                accepted="less than depth_mm",
            )  # fmt: skip

    @property
    def said(self) -> str:
        """What it is, in words."""
        parts = []
        if self.kind == "chip_break" and self.depth is not None:
            parts.append(f"chips broken each {self.depth * 1e3:g} mm by drawing back {self.back * 1e3:g} mm")
        if self.kind == "peck" and self.depth is not None:
            parts.append(f"strokes of {self.depth * 1e3:g} mm more each, out of the hole between them")
        if self.dwell:
            parts.append(f"a dwell of {self.dwell:g} s at the target{', spinning on' if self.moving else ''}")
        return ", ".join(parts) or "in one go"

    @property
    def nearest(self) -> float:
        """A break lies further out than this [m]: where the tool can draw back and has something left to drill."""
        return self.back * 1.000001

    def breaks(self, depth: float) -> Array:
        """Stand-offs at which chips are broken in a stroke, falling [m], shape (n,).

        Args:
            depth: of the stroke [m].

        Raises:
            InputError: there are too many.
        """
        import numpy as np  # not with the settings, which the help of the commands reads

        if self.kind != "chip_break" or self.depth is None:
            return np.empty(0)
        self.check_count(depth)
        found = depth - self.depth * np.arange(1, MOST_PECKS + 1)
        return np.asarray(found[found > self.nearest])

    def strokes(self, depth: float) -> tuple[float, ...]:
        """How deep each stroke of a hole goes, rising, the last one all the way [m].

        Args:
            depth: of the hole [m].

        Raises:
            InputError: there are too many.
        """
        if self.kind != "peck" or self.depth is None:
            return (depth,)
        self.check_count(depth)
        whole = int(depth / self.depth * (1 - 1e-9))
        return (*(self.depth * n for n in range(1, whole + 1)), depth)

    @property
    def of_one_stroke(self) -> Cycle:
        """How the deepest of its strokes is drilled; itself where it has no others."""
        return Cycle(dwell=self.dwell) if self.kind == "peck" else self

    def check_count(self, depth: float, where: str = "cycle, depth_mm") -> None:
        """Refuse more breaks or strokes than a hole may have.

        Args:
            depth: of the hole [m].
            where: as a message names it.

        Raises:
            InputError: there are too many.
        """
        if self.kind != "single" and self.depth is not None and depth / self.depth > MOST_PECKS:
            raise InputError(
                f"{depth / self.depth:.0f} pecks in {depth * 1e3:g} mm", where=where,
                accepted=f"{MOST_PECKS} or fewer, so {depth * 1e3 / MOST_PECKS:g} mm or more",
            )  # fmt: skip


Cycle.__doc__ = with_attributes(Cycle)
