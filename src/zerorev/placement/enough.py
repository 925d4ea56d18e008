"""Places with enough margin: the nearest to where the part stands, and the one with most room around it.

Both begin with the grid of the search, of which each place is left at the first hole that has not enough. Nothing but
what was examined counts as enough.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import product

import numpy as np
from scipy.optimize import minimize

from zerorev.model._arrays import Array
from zerorev.placement.distance import Distance
from zerorev.placement.freedom import Freedom
from zerorev.placement.margins import Margins, least
from zerorev.placement.refine import ACTIVE, CREEP, END, LEVER, MOST_ROUNDS, REACH, SHRINK, box, slopes_about

__all__ = ["Sufficient", "nearest", "roomiest", "sufficient"]

STARTS = 3  # the nearest places of the grid, no neighbours of each other, from which it goes on
FRACTIONS = (1.0, 0.7, 0.4)  # of the way to a place that is predicted: the margins bend
CENTRES = 16  # places about which the room is examined before it is left as it is
NEAR = 400  # of the insufficient places: those from which a centre keeps away
SHELLS = (0.4, 0.7, 0.95)  # of the room, at which it is examined
Progress = Callable[[str, int, int], None]


@dataclass(frozen=True)
class Sufficient:
    """A place where every hole has enough margin.

    Attributes:
        place: shift [m] and turn [rad], shape (4,).
        margins: of each hole there [m], shape (H,).
        distance: from where the part stands [m], as `Distance` has it.
        room: no place within this distance [m] was found to have too little; infinite: none at all was found; None:
            not examined.
    """

    place: Array
    margins: Array
    distance: float
    room: float | None = None


def sufficient(
    margins: Margins, distance: Distance, places: Array, enough: float, tell: Progress
) -> tuple[list[Sufficient], Array]:
    """Which places have enough margin, the nearest first; and those that have not, shape (Q, 4).

    Args:
        margins: asks about places.
        distance: of places.
        places: to examine, shape (P, 4).
        enough: margin [m] that each hole needs.
        tell: called with the progress.
    """
    away = distance(places, np.zeros((1, 4)))[:, 0]
    order = np.lexsort((np.abs(places[:, 3]), away.round(9)))
    good, bad = [], []
    for n, (k, seen) in enumerate(zip(order, margins(places[order], _below(enough)), strict=True)):
        tell("enough", n, len(places))
        if least(seen, _below(enough)) >= enough:
            good.append(Sufficient(places[k], seen, float(away[k])))
        else:
            bad.append(places[k])
    tell("enough", len(places), len(places))
    return good, np.array(bad).reshape(-1, 4)


def nearest(
    margins: Margins, freedom: Freedom, distance: Distance, enough: float, known: Sequence[Sufficient], mesh: Array,
    tell: Progress,
) -> Sufficient:  # fmt: skip
    """The nearest place with enough margin.

    Args:
        margins: asks about places.
        freedom: that it stays in.
        distance: of places.
        enough: margin [m] that each hole needs.
        known: places that have it, one or more, the nearest first.
        mesh: of their grid, shape (4,).
        tell: called with the progress.
    """
    starts: list[Sufficient] = []
    for each in known:
        apart = all((np.abs(each.place - other.place) > 1.5 * mesh).any() for other in starts)
        if len(starts) < STARTS and apart:
            starts.append(each)
    found = starts[0]
    for n, start in enumerate(starts):
        tell("nearest", n, len(starts))
        nearer = _nearer(margins, freedom, distance, enough, start, mesh / 2)
        if nearer.distance < found.distance:
            found = nearer
    tell("nearest", len(starts), len(starts))
    return found


def _nearer(
    margins: Margins, freedom: Freedom, distance: Distance, enough: float, now: Sufficient, step: Array
) -> Sufficient:
    """From a place to the nearest one that is reached through places with enough margin, by slopes of the worst."""
    axes = freedom.granted
    for _ in range(MOST_ROUNDS):
        if (step <= END)[axes].all() or now.distance == 0:
            break
        active = np.argsort(now.margins, kind="stable")[:ACTIVE].tolist()
        probes, seen, slopes = slopes_about(margins, freedom, now.place, step, active)
        bends = _bends(freedom, now, step, probes, seen, active)
        aims = _predicted(freedom, distance, enough, now, step, slopes, bends, active)
        tried = np.array([*(now.place + part * (aim - now.place) for aim in aims for part in FRACTIONS), *probes])
        tried = freedom.rounded(tried)
        away = distance(tried, np.zeros((1, 4)))[:, 0]
        order = [k for k in np.argsort(away, kind="stable") if away[k] < now.distance - 1e-9]
        before = now.distance
        for k, there in zip(order, margins(tried[order], _below(enough)), strict=True):
            if away[k] < now.distance and least(there, _below(enough)) >= enough:
                now = Sufficient(tried[k], there, float(away[k]))
        if before - now.distance < CREEP * (LEVER * step)[axes].max():
            step = step / SHRINK
    return now


def _bends(freedom: Freedom, now: Sufficient, step: Array, probes: Array, seen: Array, active: list[int]) -> Array:
    """How much each margin falls below its slope a step away along each axis [m], 0 or less, shape (K, A)."""
    bends = np.zeros((len(active), len(freedom.granted)))
    for n, axis in enumerate(freedom.granted):
        if np.allclose(np.abs(probes[2 * n : 2 * n + 2, axis] - now.place[axis]), step[axis], rtol=0.05):
            bends[:, n] = (seen[2 * n] + seen[2 * n + 1]) / 2 - now.margins[active]
    return np.minimum(bends, 0.0)


def _predicted(
    freedom: Freedom, distance: Distance, enough: float, now: Sufficient, step: Array, slopes: Array, bends: Array,
    active: list[int],
) -> list[Array]:  # fmt: skip
    """The nearest places that should still have enough margin, by slopes and bends, in boxes of each reach."""
    axes, origin = freedom.granted, np.zeros((1, 4))

    def at(move: Array) -> Array:
        there = now.place.copy()
        there[axes] += move * step[axes]
        return there

    def away(move: Array) -> float:
        return float(distance(at(move)[None], origin)[0, 0]) / max(now.distance, 1e-6)

    def left(move: Array) -> Array:
        return np.asarray((now.margins[active] + slopes @ move + bends @ move**2 - enough) * 1e3)

    places = []
    for reach in REACH:
        bounds = list(zip(*box(freedom, now.place, step, reach), strict=True))
        enough_left = {"type": "ineq", "fun": left}
        answer = minimize(away, np.zeros(len(axes)), method="SLSQP", bounds=bounds, constraints=[enough_left])
        if np.isfinite(answer.x).all():
            places.append(at(answer.x))
    return places


def roomiest(
    margins: Margins, freedom: Freedom, distance: Distance, enough: float, known: Sequence[Sufficient], bad: Array,
    mesh: Array, tell: Progress,
) -> Sufficient:  # fmt: skip
    """The place from which every place with too little margin, within the freedom, is farthest.

    The centre is put where the places known to be insufficient are farthest; then its surroundings are examined, and
    what is insufficient there moves it on, until nothing nearer is found.

    Args:
        margins: asks about places.
        freedom: beyond which nothing is examined.
        distance: of places.
        enough: margin [m] that each hole needs.
        known: places that have it, one or more.
        bad: places that have not, shape (Q, 4).
        mesh: of their grid, shape (4,).
        tell: called with the progress.
    """
    best = max(known, key=lambda each: least(each.margins))
    if not len(bad):  # so far: from here on it is looked for
        centre, room = best.place, float(distance(freedom.grid(2), best.place[None]).max())
    good, examined = list(known), list[Sufficient]()
    for n in range(CENTRES):
        tell("most room", n, CENTRES + 1)
        if len(bad):
            centre, room = _centre(freedom, distance, np.array([each.place for each in good]), bad, mesh)
        found, worse = _surroundings(margins, freedom, distance, enough, centre, room)
        if found is not None:
            good.append(found)
            examined.append(found)
        bad = np.vstack([bad, worse])
        if not len(worse):
            break
    tell("most room", CENTRES, CENTRES + 1)
    if not len(bad):
        return replace(best, room=np.inf)
    rooms = distance(np.array([each.place for each in examined or known]), bad).min(axis=1)
    best, room = (examined or known)[int(rooms.argmax())], float(rooms.max())
    for _ in range(CENTRES):
        _, worse = _surroundings(margins, freedom, distance, enough, best.place, room)
        if not len(worse):
            break
        room = float(distance(best.place[None], worse).min())
    tell("most room", CENTRES + 1, CENTRES + 1)
    return replace(best, room=room)


def _surroundings(
    margins: Margins, freedom: Freedom, distance: Distance, enough: float, centre: Array, room: float
) -> tuple[Sufficient | None, Array]:
    """The centre, where it has enough margin; and what all round it, within the room, has not, shape (Q, 4)."""
    tried = np.vstack([centre, *(_shell(freedom, distance, centre, part * room) for part in SHELLS)])
    seen = list(margins(tried, _below(enough)))
    fine = np.array([least(each, _below(enough)) >= enough for each in seen])
    away = float(distance(centre[None], np.zeros((1, 4)))[0, 0])
    return Sufficient(centre, seen[0], away) if fine[0] else None, tried[~fine]


def _centre(freedom: Freedom, distance: Distance, good: Array, bad: Array, mesh: Array) -> tuple[Array, float]:
    """Where within the freedom the insufficient places are farthest, and how far; from the best sufficient one on."""
    rooms = distance(good, bad).min(axis=1)
    centre, room = good[int(rooms.argmax())], float(rooms.max())
    ways, step = _ways(freedom), mesh / 2
    near = bad[np.argsort(distance(bad, centre[None])[:, 0], kind="stable")[:NEAR]]
    while (step > END)[freedom.granted].any():
        tried = freedom.rounded(centre + ways * step)
        rooms = distance(tried, near).min(axis=1)
        if rooms.max() > room + 1e-9:
            centre, room = tried[int(rooms.argmax())], float(rooms.max())
        else:
            step = step / 2
    return centre, float(distance(centre[None], bad).min())


def _shell(freedom: Freedom, distance: Distance, centre: Array, radius: float) -> Array:
    """Places at a distance from a centre all round, or at the end of the freedom where that is nearer."""
    ways = _ways(freedom)
    ways = ways[np.isin(np.count_nonzero(ways, axis=1), (1, len(freedom.granted)))]
    unit = distance(centre + np.diag(END), centre[None])[:, 0] / END  # [m] for 1 m or rad along each axis
    ways = ways / np.where(unit > 0, unit, 1.0)
    for _ in range(4):  # a turn moves less than its arc, and no farther than its ends
        reached = distance(centre + ways, centre[None])[:, 0]
        ways = ways * np.where(reached > 0, radius / np.maximum(reached, 1e-9), 0.0)[:, None]
        ways = np.clip(centre + ways, freedom.lower, freedom.upper) - centre
    return freedom.rounded(centre + ways)


def _ways(freedom: Freedom) -> Array:
    """Directions along the granted axes and between all of them, shape (W, 4)."""
    signs = np.array([way for way in product((-1.0, 0.0, 1.0), repeat=len(freedom.granted)) if any(way)])
    ways = np.zeros((len(signs), 4))
    ways[:, freedom.granted] = signs
    return ways


def _below(enough: float) -> float:
    """The greatest margin [m] that is not enough."""
    return float(np.nextafter(enough, -np.inf))
