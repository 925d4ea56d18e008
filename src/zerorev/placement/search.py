"""Where a part should stand: a coarse grid over the freedom, its best places improved, and the room about the best.

What a place is worth is its least margin: how much deeper than needed its worst hole could be drilled without a
reversal.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from zerorev.errors import InputError
from zerorev.model._arrays import Array
from zerorev.model.job import Job
from zerorev.placement.distance import Distance
from zerorev.placement.enough import Sufficient, nearest, roomiest, sufficient
from zerorev.placement.freedom import Freedom
from zerorev.placement.margins import Asked, Margins, least
from zerorev.placement.refine import END, GAIN, improved
from zerorev.placement.room import Slice, room, slices
from zerorev.workers import HERE, Machines, Workers

__all__ = ["Placement", "place", "placements"]

KEPT = 8  # the best places of the grid, known in full
STARTS = 3  # those of them from which it goes on
INWARD = 4  # final steps of the search, from an end of a range, within which the least margin has to fall
BATCH = 32  # places that are asked about with the same bar to clear

Progress = Callable[[str, int, int], None]
_Known = tuple["Placement", list[tuple[Array, Array]]]


@dataclass(frozen=True)
class Placement:
    """Where a part should stand.

    Attributes:
        place: shift along X, Y, Z of the base frame [m] and turn about the vertical [rad], shape (4,).
        margins: how much deeper than needed each hole could be drilled there [m], shape (H,).
        as_it_stands: the same where the job has the part.
        grid: values of the coarse grid along each axis [m or rad], four of them.
        found: least margin of its places [m], shape (X, Y, Z, T); NaN: no better than others, so not known in full.
        room: how far the part may be moved from the best place along each axis, the others as they are, before some
            hole is too shallow [m or rad], shape (4, 2), 0 or less and 0 or more; None: not examined, or too shallow.
        pressed: the axes, with 0 (start) or 1 (stop), at whose end the best place lies because the least margin rises
            towards it: a better place may lie beyond.
        slices: the least margin over the granted axes, two at a time, through the best place.
        enough: the margin [m] that was asked for; None: none was.
        nearest: the nearest place to where the part stands with that margin; None: not asked for, or none was found.
        roomiest: the place with most room around it that has that margin; likewise.
        strokes: how many deepest strokes were found.
        finished: whether nothing is left to be examined.
    """

    place: Array
    margins: Array
    as_it_stands: Array
    grid: tuple[Array, ...]
    found: Array
    room: Array | None = None
    pressed: tuple[tuple[int, int], ...] = ()
    slices: tuple[Slice, ...] = ()
    enough: float | None = None
    nearest: Sufficient | None = None
    roomiest: Sufficient | None = None
    strokes: int = 0
    finished: bool = False

    @property
    def least(self) -> float:
        """The margin of the worst hole [m]; every hole is drilled without a reversal where it is 0 or more."""
        return least(self.margins)

    @property
    def worst(self) -> int:
        """Index of the worst hole."""
        return int(self.margins.argmin())


def place(
    job: Job,
    freedom: Freedom,
    *,
    grid: int = 7,
    cells: int = 0,
    enough: float | None = None,
    machines: Machines = HERE,
    progress: Progress | None = None,
) -> Placement:
    """Where the part of a job should stand, so that every hole is drilled without a reversal and with a margin.

    Args:
        job: robot, tool, holes with their depths, settings, and where the part stands now.
        freedom: how far it may be moved.
        grid: places of the coarse grid along each granted axis; what is narrower than its meshes may be overlooked.
        cells: of each slice, along each axis; 0: no slices.
        enough: margin [m] with which the nearest place and the one with most room are sought; None: they are not.
        machines: to run it on; the answer is the same.
        progress: called with what is done, how much of it is done, how much it is in all.

    Raises:
        InputError: a grid of fewer than two places, a hole with a given motion, nothing that may be varied, a margin
            below 0.
    """
    *_, last = placements(job, freedom, grid=grid, cells=cells, enough=enough, machines=machines, progress=progress)
    return last


def placements(
    job: Job,
    freedom: Freedom,
    *,
    grid: int = 7,
    cells: int = 0,
    enough: float | None = None,
    machines: Machines = HERE,
    progress: Progress | None = None,
) -> Iterator[Placement]:
    """What is known so far, time and again, each better than the one before; the last is that of `place`.

    Args and errors are those of `place`.
    """
    _check(job, freedom, grid, cells, enough)
    tell = progress or (lambda what, done, total: None)
    with Workers(Asked(job), machines) as processes:
        margins = Margins(job, processes)
        for seen in _coarse(margins, freedom, grid, tell):
            known, best = seen
            yield known
        for better in _refined(known, best, margins, freedom, tell):
            known = better
            yield known
        known = replace(known, pressed=_pressed(margins, freedom, known))
        if known.least >= 0:
            known = replace(known, room=room(margins, freedom, known.place, tell), strokes=margins.strokes)
            yield known
        for asked in _enough(known, job, margins, freedom, enough, tell) if enough is not None else ():
            known = asked
            yield known
        for shown in slices(margins, freedom, known.place, cells, tell) if cells else ():
            known = replace(known, slices=(*known.slices, shown), strokes=margins.strokes)
            yield known
        yield replace(known, finished=True)


def _check(job: Job, freedom: Freedom, grid: int, cells: int, enough: float | None) -> None:
    if grid < 2:
        raise InputError(f"{grid} places", where="grid", accepted="2 or more along each axis")
    if cells and cells < 2:
        raise InputError(f"{cells} cells", where="cells", accepted="2 or more along each axis, or 0 for none")
    if enough is not None and not 0 <= enough < np.inf:
        raise InputError(f"{enough * 1e3:g} mm", where="--enough-mm", accepted="0 or more [mm]")
    for hole in job.holes:
        if hole.profile is not None:
            raise InputError(
                "has a given motion, which would not fit where the part is moved to",
                where=f"hole {hole.id}",
                accepted="holes without psi_deg",
            )
    if not freedom.granted:
        raise InputError(
            "nothing may be varied: each range is a single place",
            where="--x-mm, --y-mm, --z-mm, --turn-deg",
            accepted="START:STOP of one of them at least, e.g. --z-mm=-100:100",
        )


def _coarse(margins: Margins, freedom: Freedom, grid: int, tell: Progress) -> Iterator[_Known]:
    """The grid, from its middle outwards; a place is left at the first hole that keeps it from the best few."""
    axes = tuple(freedom.values(axis, grid) for axis in range(4))
    places, found = freedom.grid(grid), np.full([axis.size for axis in axes], np.nan)
    as_it_stands, middle = margins(np.array([np.zeros(4), places[0]]))
    known = Placement(places[0], middle, as_it_stands, axes, found)
    best: list[tuple[float, int, Array]] = []
    for first in range(0, len(places), BATCH):
        tell("coarse grid", first, len(places))
        bar = best[-1][0] if len(best) == KEPT else margins.floor
        batch = places[first : first + BATCH]
        for n, seen in enumerate(margins(batch, bar), first):
            if least(seen, bar) > bar:
                best.append((least(seen), n, seen))
                found[tuple(int(np.abs(axis - at).argmin()) for axis, at in zip(axes, places[n], strict=True))] = least(
                    seen
                )
        best = sorted(best, key=lambda entry: (-entry[0], entry[1]))[:KEPT]
        if best and best[0][0] > known.least:
            known = replace(known, place=places[best[0][1]], margins=best[0][2])
        known = replace(known, found=found.copy(), strokes=margins.strokes)
        yield known, [(places[n], seen) for _, n, seen in best]
    tell("coarse grid", len(places), len(places))


def _pressed(margins: Margins, freedom: Freedom, known: Placement) -> tuple[tuple[int, int], ...]:
    """The ends at which the best place lies and away from which the least margin falls."""
    ends = freedom.ends_at(known.place)
    inward = np.repeat(known.place[None], len(ends), axis=0)
    for row, (axis, side) in zip(inward, ends, strict=True):
        row[axis] += (1 - 2 * side) * INWARD * END[axis]
    seen = margins(freedom.rounded(inward)) if ends else ()
    return tuple(end for end, there in zip(ends, seen, strict=True) if least(there) < known.least - GAIN)


def _refined(
    known: Placement, best: Sequence[tuple[Array, Array]], margins: Margins, freedom: Freedom, tell: Progress
) -> Iterator[Placement]:
    """From the best places of the grid that are not neighbours of each other to the best near each."""
    mesh = _mesh(known)
    starts: list[tuple[Array, Array]] = []
    for there, seen in best or [(known.place, known.margins)]:
        if len(starts) < STARTS and not any((np.abs(there - other) < 1.5 * mesh).all() for other, _ in starts):
            starts.append((there, seen))
    total = 100 * len(starts)
    for n, start in enumerate(starts):

        def report(part: float, before: int = 100 * n) -> None:
            tell("refining", before + int(100 * part), total)

        report(0.0)
        there, seen = improved(margins, freedom, *start, mesh / 2, report)
        if least(seen) > known.least:
            known = replace(known, place=there, margins=seen)
        known = replace(known, strokes=margins.strokes)
        yield known
    tell("refining", total, total)


def _enough(
    known: Placement, job: Job, margins: Margins, freedom: Freedom, enough: float, tell: Progress
) -> Iterator[Placement]:
    """What is known, with the places that have enough margin."""
    distance, grid = Distance(job), freedom.grid(max(axis.size for axis in known.grid))
    places = np.vstack([freedom.rounded(np.zeros(4)), known.place, grid])
    places = places[np.sort(np.unique(places, axis=0, return_index=True)[1])]
    known = replace(known, enough=enough)
    good, bad = sufficient(margins, distance, places, enough, tell)
    if good:
        found = nearest(margins, freedom, distance, enough, good, _mesh(known), tell)
        known = replace(known, nearest=found, strokes=margins.strokes)
        yield known
        found = roomiest(margins, freedom, distance, enough, good, bad, _mesh(known), tell)
        known = replace(known, roomiest=found)
    yield replace(known, strokes=margins.strokes)


def _mesh(known: Placement) -> Array:
    """Of the grid along each axis [m or rad], shape (4,); 1 where it has one place."""
    return np.array([axis[1] - axis[0] if axis.size > 1 else 1.0 for axis in known.grid])
