"""How much deeper than needed each hole of a part could go, at many places of the part."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from zerorev.errors import InputError
from zerorev.model._arrays import Array
from zerorev.model.job import Job
from zerorev.motion.drilling import Drilling
from zerorev.placement.freedom import job_at
from zerorev.search.cycles import deepest_in_cycle
from zerorev.workers import Workers

__all__ = ["Look", "Margins", "least"]


@dataclass(frozen=True)
class Look:
    """What is asked about a place.

    Attributes:
        place: shift [m] and turn [rad], shape (4,).
        order: of the holes to look at, by their index in the job.
        enough: margin [m]; once a hole has no more than that, the others are not examined.
    """

    place: Array
    order: tuple[int, ...]
    enough: float


class Margins:
    """Asks about places; what is answered does not depend on how many processes do it.

    Attributes:
        floor: the margin [m] below which no hole is: it cannot be drilled at all.
        strokes: how many deepest strokes were found.
    """

    def __init__(self, job: Job, workers: Workers[Look, Array]) -> None:
        """Begin.

        Args:
            job: whose part is moved.
            workers: that do `Asked(job)`.
        """
        self._workers, self.count = workers, len(job.holes)
        self.floor = -max(hole.depth for hole in job.holes)
        self.strokes = 0
        self._worst = np.zeros(self.count)

    def __call__(self, places: Array, enough: float = -np.inf, holes: Sequence[int] | None = None) -> Iterator[Array]:
        """Of each place in turn the margin of each hole [m], shape (H,): deepest less needed; NaN: not examined.

        Args:
            places: shape (P, 4).
            enough: a place is left as soon as one of its holes has no more than that.
            holes: those to look at, by their index; None: all, those that were most often the worst first.
        """
        order = tuple(np.argsort(-self._worst, kind="stable").tolist() if holes is None else holes)
        for margins in self._workers.map((Look(place, order, enough) for place in places), len(places)):
            self.strokes += int(np.isfinite(margins).sum())
            self._worst[int(np.nanargmin(margins))] += 1
            yield margins


class Asked:
    """The task of a worker."""

    def __init__(self, job: Job) -> None:
        self.job = job

    def __call__(self, look: Look) -> Array:
        """The margins [m], shape (H,), of the holes that were examined; NaN of the others."""
        margins = np.full(len(self.job.holes), np.nan)
        try:
            moved = job_at(self.job, look.place)
        except InputError:  # the reference of the spin has no meaning there, so no job could stand there
            return np.array([-hole.depth for hole in self.job.holes])
        for k in look.order:
            deepest = deepest_in_cycle(Drilling.of(moved, moved.holes[k]), moved.settings.without_proof)
            margins[k] = deepest.depth - moved.holes[k].depth
            if margins[k] <= look.enough:
                break
        return margins


def least(margins: Array, enough: float = -np.inf) -> float:
    """The least of some margins [m]; minus infinity where it is no more than `enough`: some may be missing then."""
    value = float(np.nanmin(margins))
    return value if value > enough else -np.inf
