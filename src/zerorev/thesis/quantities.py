"""The thesis' own two ways to a deepest stroke, as quantities of a map (sec. 4.6)."""

from __future__ import annotations

from zerorev.maps.quantities import stroke_found
from zerorev.model.hole import Hole
from zerorev.model.map_task import Question
from zerorev.model.quantity import Found, Quantity
from zerorev.motion.drilling import Drilling
from zerorev.thesis.stroke import Way, thesis_stroke

__all__ = ["QUANTITIES"]


def _quantity(way: Way, how: str) -> Quantity:
    def solve(question: Question, hole: Hole, seed: int) -> Found | None:
        found = thesis_stroke(Drilling.of(question, hole), question.settings, way, seed)
        return stroke_found(found.depth, found.profile, found.branch)

    return Quantity(
        f"thesis_{way}",
        "deepest_mm",
        "mm",
        title=f"deepest stroke by a swarm and {how}",
        digits=1,
        more_is_better=True,
        nothing=0.0,
        free_legs=False,
        cycles=False,
        seeded=True,
        chunk=4,
        offered=False,
        solve=solve,
    )


QUANTITIES = (_quantity("bisection", "bisection"), _quantity("stepping", "steps of 5 mm"))
