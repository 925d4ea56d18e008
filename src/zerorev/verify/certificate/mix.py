"""A proof for blends of which the curve is not known: that a joint keeps its direction for any mix of velocities.

It rests on the same as its sampled counterpart (`verify.mix`): on the triangle between entry, bend and exit a joint
must have its direction, moving as on the one move and as on the other; or, of the blends that turn one way alone,
moving straight on from the entry, and straight on to the exit. Both are proven on boxes that cover the triangle, by
Taylor models; a box that does not decide is quartered. What is said to turn round is shown to by one mix at one place,
in ball arithmetic. A joint that keeps its direction stays between its angles at entry and exit, so within its limits.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt
from flint import arb

from zerorev.model._arrays import Array
from zerorev.verify.certificate.arm import Setting
from zerorev.verify.certificate.piece import NIL_RATE
from zerorev.verify.certificate.range import least, lowest_at
from zerorev.verify.certificate.taylor import Taylor, no_terms
from zerorev.verify.certificate.triangle import Fan, Rates, Triangle
from zerorev.verify.certificate.walk import LostError
from zerorev.verify.mix import Mixes

__all__ = ["Counter", "Mixed", "mixed"]

Mask = npt.NDArray[np.bool_]

LEVELS = 24  # of boxes, each a quarter of one of the level before
BOXES = 4000  # examined of one triangle, and from one of its corners
FANS: dict[Mixes, tuple[Fan, ...]] = {"any": ("bend",), "one_way": ("entry", "exit")}
FINE_LEVELS = 4  # at most for a tighter bound alone
TIGHT = 0.02  # relative: how far below a rate that is met its bound may lie


class Counter(NamedTuple):
    """A place and a mix with which a joint is proven to move the other way.

    Attributes:
        left: path left on the first move [m].
        done: path done on the second [m].
        weights: of the two velocities.
        rest: `or more`, `or less` or nothing: of the first velocity's share, where the same holds of it.
    """

    left: float
    done: float
    weights: tuple[float, float]
    rest: str = ""

    def said(self, triangle: Triangle) -> str:
        """The place and the mix in words."""
        first, second = triangle.moves
        share = 100 * self.weights[0] / sum(self.weights)
        return (
            f"{triangle.place(self.left, self.done)}, for a blend with {1e3 * self.left:.4g} mm of {first} left there, "
            f"{1e3 * self.done:.4g} mm of {second} done, and {' '.join(f'{share:.3g} % {self.rest}'.split())} of its "
            f"velocity from {first}"
        )


class Mixed(NamedTuple):
    """What is proven of the blends at a bend; joints are counted from 0.

    Attributes:
        boxes: examined.
        least: no rate of a joint is less in any of the blends [rad/m], shape (6,); NaN where it is not proven to keep
            its direction.
        turns: joints proven to turn round in one of the blends.
        undecided: joints of which neither could be shown, and where: left and done [m].
        still: joints that all but stand still somewhere, and where.
    """

    boxes: int
    least: Array
    turns: dict[int, Counter]
    undecided: dict[int, tuple[float, float]]
    still: dict[int, tuple[float, float]]


def mixed(setting: Setting, triangle: Triangle, ways: Mapping[int, int], mixes: Mixes) -> Mixed:
    """Prove or refute that joints keep their direction in all blends at a bend.

    Args:
        setting: arm and posture.
        triangle: of the bend.
        ways: the sign of each joint's rate on the moves, of those that are followed; 0: it stands still there.
        mixes: which blends.

    Raises:
        LostError: a pose is out of reach, or it is not proven in reach and clear of singularities.
    """
    search = _Search(setting, triangle, dict(ways))
    for fan in FANS[mixes]:
        search.cover(fan)
    proven = [joint in search.ways for joint in range(6)]
    return Mixed(search.boxes, np.where(proven, search.least, np.nan), search.turns, search.undecided, search.still)


class _Boxes(NamedTuple):
    """Boxes of x and y (`Triangle.seen_from`), n of them: middles and half of their widths, shape (n,) each."""

    x: Array
    y: Array
    half: Array

    def quarters(self, chosen: Mask) -> _Boxes:
        """The quarters of some."""
        x, y, half = self.x[chosen], self.y[chosen], self.half[chosen] / 2
        return _Boxes(
            np.concatenate([x - half, x + half, x - half, x + half]),
            np.concatenate([y - half, y - half, y + half, y + half]),
            np.concatenate([half] * 4),
        )

    def models(self) -> tuple[Taylor, Taylor]:
        """Both variables on the boxes."""
        terms_x, terms_y = no_terms(self.x.size), no_terms(self.x.size)
        terms_x[0, 0], terms_y[0, 1] = self.half, self.half
        return Taylor.polynomial(self.x, terms_x, 0.0), Taylor.polynomial(self.y, terms_y, 0.0)


class _Bounds(NamedTuple):
    """Of the quantities on n boxes: rates by mix and joint, then three squares.

    Attributes:
        models: of all of them, one after the other.
        low: no value is less, shape (quantities, n); -inf for none.
        still: whether a rate is numerically nil all over a box.
    """

    models: Taylor
    low: Array
    still: Mask


class _Search:
    """What is known so far of one triangle; a joint that turns round, or that is undecided, leaves `ways`."""

    def __init__(self, setting: Setting, triangle: Triangle, ways: dict[int, int]) -> None:
        self.setting, self.triangle, self.ways = setting, triangle, ways
        self.boxes = 0
        self.least, self.met = np.full(6, np.inf), np.full(6, np.inf)
        self.turns: dict[int, Counter] = {}
        self.undecided: dict[int, tuple[float, float]] = {}
        self.still: dict[int, tuple[float, float]] = {}

    def cover(self, fan: Fan) -> None:
        """Prove what is asked on all of the triangle, seen from one of its corners."""
        boxes, examined = _Boxes(np.array([0.5]), np.array([0.5]), np.array([0.5])), 0
        for level in range(LEVELS):
            examined += boxes.x.size
            last = level + 1 == LEVELS or examined + 4 * boxes.x.size > BOXES
            found = self._bounds(fan, boxes)
            failed = self._failed(fan, boxes, found)
            open_ = np.asarray(failed.any(axis=0))
            if not open_.any() and level < FINE_LEVELS and not last:
                open_ = self._loose(found)
            self._note(fan, boxes, found, np.asarray(~open_ | last))
            if last or not open_.any():
                break
            boxes = boxes.quarters(open_)
        self.boxes += examined
        for joint in range(6):
            if (rows := failed[joint:-3:6].any(axis=0)).any():
                self._leaves(joint, self._middle(fan, boxes, int(rows.argmax())))
        if failed[-3:].any():
            where = self.triangle.place(*self._middle(fan, boxes, int(failed[-3:].any(axis=0).argmax())))
            what = "neither in reach and clear of singularities nor out of reach could be shown"
            raise LostError(f"{what} {where}", proven=False)

    def _bounds(self, fan: Fan, boxes: _Boxes) -> _Bounds:
        x, y = boxes.models()
        with np.errstate(all="ignore"):
            rates = self.triangle.rates(self.setting, *self.triangle.seen_from(fan, x, y))
            ways = [self.ways.get(joint, 0) or 1 for joint in range(6)]
            asked = [rate * float(way) for mix in _asked(fan, y, rates) for rate, way in zip(mix, ways, strict=True)]
            models = Taylor.side_by_side([*asked, *rates.squares])
            low, high = (least(each).reshape(-1, boxes.x.size) for each in (models, -models))
        low, high = np.where(np.isnan(low), -np.inf, low), np.where(np.isnan(high), -np.inf, high)
        return _Bounds(models, low, (low >= -NIL_RATE) & (high >= -NIL_RATE))

    def _failed(self, fan: Fan, boxes: _Boxes, found: _Bounds) -> Mask:
        """Where a quantity is not yet proven: of the joints that are still followed, and the reach."""
        failed = np.zeros(found.low.shape, dtype=bool)
        failed[-3:] = ~(found.low[-3:] > 0)
        if failed[-3:].any():
            self._must_be_in_reach(fan, boxes, found)
        for row in range(len(failed) - 3):
            joint = row % 6
            if joint not in self.ways:
                continue
            still = found.still[row]
            failed[row] = ~still if self.ways[joint] == 0 else ~(found.low[row] > 0) & ~still
            if failed[row].any():
                self._try(fan, boxes, found, row)
            if joint not in self.ways:
                failed[joint:-3:6] = False
        return failed

    def _try(self, fan: Fan, boxes: _Boxes, found: _Bounds, row: int) -> None:
        """Whether a joint turns round where a rate seems to be least, or moves, though it should stand still."""
        joint, low = row % 6, found.low[row]
        k = int(np.argmin(np.where(np.isfinite(low), low, np.inf)))
        at = lowest_at(found.models, row * low.size + k)
        x, y = (
            float(np.clip(middle[k] + boxes.half[k] * shift, 0.0, 1.0))
            for middle, shift in zip((boxes.x, boxes.y), at, strict=False)
        )
        a, b = self.triangle.seen_from(fan, arb(x), arb(y))
        rates, way = self.triangle.rates(self.setting, a, b), self.ways[joint]
        if way == 0:
            if abs(rates.before[joint]) > NIL_RATE or abs(rates.behind[joint]) > NIL_RATE:
                self._leaves(joint, (float(a), float(b)))
            return
        before, behind = rates.before[joint] * way, rates.behind[joint] * way
        if fan == "bend":
            weights, rest = _share(before, behind)
        else:
            weights, rest = ((1.0, y) if fan == "entry" else (y, 1.0)), ""
        if weights[0] * before + weights[1] * behind < 0:
            self.turns[joint] = Counter(float(a), float(b), weights, rest)
            del self.ways[joint]

    def _leaves(self, joint: int, at: tuple[float, float]) -> None:
        """A joint is undecided there."""
        self.undecided[joint] = at
        del self.ways[joint]

    def _must_be_in_reach(self, fan: Fan, boxes: _Boxes, found: _Bounds) -> None:
        """Raise where the wrist centre is proven out of reach in the middle of the box where it is farthest out."""
        out = found.models.c.reshape(len(found.low), -1)[-3:-1].min(axis=0)
        k = int(np.argmin(np.where(np.isnan(out), -np.inf, out)))
        a, b = self.triangle.seen_from(fan, arb(float(boxes.x[k])), arb(float(boxes.y[k])))
        ahead_2, height_2, _ = self.triangle.rates(self.setting, a, b).squares
        if ahead_2 < 0 or height_2 < 0:
            raise LostError(f"out of reach {self.triangle.place(float(a), float(b))}", proven=True)

    def _note(self, fan: Fan, boxes: _Boxes, found: _Bounds, chosen: Mask) -> None:
        """Keep the least rates on boxes that decide all, and where joints all but stand still."""
        if not chosen.any():
            return
        for row, low in enumerate(found.low[:-3]):
            joint = row % 6
            self.least[joint] = min(self.least[joint], max(low[chosen].min(), 0.0))
            paused = found.still[row] & ~(found.low[row] > 0) & chosen
            if self.ways.get(joint) and paused.any():
                self.still.setdefault(joint, self._middle(fan, boxes, int(paused.argmax())))

    def _loose(self, found: _Bounds) -> Mask:
        """Boxes on which a rate is proven, but not to be nearly as great as it is."""
        loose, n = np.zeros(found.low.shape[1], dtype=bool), found.low.shape[1]
        for row, low in enumerate(found.low[:-3]):
            joint, k = row % 6, int(low.argmin())
            if self.ways.get(joint) and low[k] > 0:
                self.met[joint] = min(self.met[joint], _value(found.models, row * n + k))
                loose |= low < (1 - TIGHT) * self.met[joint]
        return loose

    def _middle(self, fan: Fan, boxes: _Boxes, k: int) -> tuple[float, float]:
        """The middle of a box: left and done [m]."""
        a, b = self.triangle.seen_from(fan, arb(float(boxes.x[k])), arb(float(boxes.y[k])))
        return float(a), float(b)


def _asked(fan: Fan, y: Any, rates: Rates) -> list[list[Any]]:
    """Of one or two mixes, six rates each: where they have one sign, so have those of all blends."""
    if fan == "bend":
        return [rates.before, rates.behind]
    first, other = (rates.before, rates.behind) if fan == "entry" else (rates.behind, rates.before)
    share = 1 / (1 + y)
    return [[(rate + y * beside) * share for rate, beside in zip(first, other, strict=True)]]


def _value(models: Taylor, column: int) -> float:
    """No less than one model where it is least, or nearly; but for rounding."""
    assert models.terms is not None
    x, terms = lowest_at(models, column), models.terms[..., column]
    return float(models.c[column] + terms[0] @ x + x @ terms[1:] @ x + models.rest[column])


def _share(before: arb, behind: arb) -> tuple[tuple[float, float], str]:
    """Weights in percent with which a mix of two rates seems to be below 0, as near to a mix of both as may be."""
    edge = 100 * float(behind) / (float(behind) - float(before)) if before * behind < 0 else 0.0
    if before < 0:
        percent = min(float(np.floor(max(edge, 0.0))) + 1, 100.0)
        return (percent, 100 - percent), "or more" if percent < 100 else ""
    percent = max(float(np.ceil(edge)) - 1, 0.0)
    return (percent, 100 - percent), "or less" if percent > 0 else ""
