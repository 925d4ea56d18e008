"""From a place of the grid to the best one near it: small linear programmes over the worst holes, and a pattern search.

The margin of one hole is nearly everywhere a smooth function of the place; the least of all margins is not, for it has
its peaks where several holes are equally bad. So the slopes of the worst holes are measured, a linear programme says
where the least of them is greatest within a small box, and what is found there is believed only once it is examined.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy.optimize import linprog

from zerorev.model._arrays import Array
from zerorev.placement.freedom import Freedom
from zerorev.placement.margins import Margins, least

__all__ = [
    "ACTIVE", "CREEP", "END", "GAIN", "LEVER", "MOST_ROUNDS", "REACH", "SHRINK", "box", "improved", "slopes_about",
]  # fmt: skip

END = np.array([2.5e-4, 2.5e-4, 2.5e-4, np.deg2rad(0.025)])  # steps below which it is at its end [m, rad]
ACTIVE = 12  # holes, the worst, whose slopes are measured
REACH = (1.0, 2.0)  # boxes of the linear programme, in steps
MOST_ROUNDS = 60
SHRINK = 4.0  # what a step is divided by once it leads to nothing better, or hardly
CREEP = 0.01  # of a step: a gain [m] that hardly is one
LEVER = np.array([1.0, 1.0, 1.0, 0.1])  # [m] by which a turn is held against a shift
GAIN = 1e-6  # [m] less is none


def improved(
    margins: Margins, freedom: Freedom, place: Array, known: Array, step: Array, tell: Callable[[float], None]
) -> tuple[Array, Array]:
    """The best place near one, and the margins there.

    Args:
        margins: asks about places.
        freedom: that it stays in.
        place: to start from, shape (4,).
        known: the margins there [m], shape (H,).
        step: first step along each axis, shape (4,).
        tell: called after each round with the part that is done, 0 to 1.
    """
    axes = freedom.granted
    first = step
    for _ in range(MOST_ROUNDS):
        if not axes or (step <= END)[axes].all():
            break
        active = np.argsort(known, kind="stable")[:ACTIVE].tolist()
        probes, seen, slopes = slopes_about(margins, freedom, place, step, active)
        tried = [
            *_predicted(freedom, axes, place, step, known[active], slopes),
            probes[seen.min(axis=1).argmax()],
        ]
        worst = least(known)
        for there, found in zip(tried, margins(np.array(tried), worst + GAIN), strict=True):
            if least(found, worst + GAIN) > least(known):
                place, known = there, found
        if least(known) - worst < CREEP * (LEVER * step)[axes].max():
            step = step / SHRINK
        tell(min(1.0, float(np.log2(first / step)[axes[0]] / np.log2(max(2.0, (first / END)[axes].max())))))
    return place, known


def slopes_about(
    margins: Margins, freedom: Freedom, place: Array, step: Array, active: list[int]
) -> tuple[Array, Array, Array]:
    """A step to both sides of a place along each granted axis.

    Args:
        margins: asks about places.
        freedom: that it stays in.
        place: shape (4,).
        step: along each axis, shape (4,).
        active: the holes to examine, by their index.

    Returns:
        the places, shape (2 A, 4); the margins there [m], shape (2 A, K); the slopes of the margins [m per step], shape
        (K, A), of K active holes over A granted axes.
    """
    axes = freedom.granted
    probes = np.repeat(place[None], 2 * len(axes), axis=0)
    for n, axis in enumerate(axes):
        probes[2 * n : 2 * n + 2, axis] += [-step[axis], step[axis]]
    probes = freedom.rounded(probes)
    seen = np.array(list(margins(probes, holes=active)))[:, active]
    slopes = np.zeros((len(active), len(axes)))
    for n, axis in enumerate(axes):
        below, above = (probes[2 * n + side, axis] - place[axis] for side in (0, 1))
        if above - below > 0:
            slopes[:, n] = (seen[2 * n + 1] - seen[2 * n]) / (above - below) * step[axis]
    return probes, seen, slopes


def box(freedom: Freedom, place: Array, step: Array, reach: float) -> tuple[Array, Array]:
    """How far one may go from a place along the granted axes, in steps: least and greatest, shape (A,) each."""
    axes = freedom.granted
    low = np.maximum(-reach, (freedom.lower - place)[axes] / step[axes])
    return low, np.minimum(reach, (freedom.upper - place)[axes] / step[axes])


def _predicted(
    freedom: Freedom, axes: list[int], place: Array, step: Array, known: Array, slopes: Array
) -> list[Array]:
    """Where the least margin should be greatest, by the slopes, in boxes of each reach."""
    places = []
    for reach in REACH:
        bounds = [*zip(*box(freedom, place, step, reach), strict=True), (None, None)]
        rows = np.column_stack([-slopes, np.ones(known.size)])  # t - slope . move <= margin; the greatest t
        answer = linprog([*np.zeros(len(axes)), -1.0], A_ub=rows, b_ub=known, bounds=bounds, method="highs")
        if answer.success:
            there = place.copy()
            there[axes] += answer.x[:-1] * step[axes]
            places.append(freedom.rounded(there))
    return places
