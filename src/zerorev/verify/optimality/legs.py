"""What every leg of a box has in common, in ball arithmetic: how often its joints turn, how far they travel.

A box is examined at stand-offs: what no leg of it does at one of them, no leg of it does (theory §8.4). Written apart
from the search that it checks.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from functools import partial
from itertools import pairwise

import numpy as np
from flint import arb

from zerorev.verify.optimality.box import SIX, Box, Examiner, Extent, Look, denominators, smooth_denominators
from zerorev.verify.optimality.travel import ANY_TURN, Turns, travel_of

__all__ = ["MID_SHARES", "BoxLegs"]

SHARES = tuple(0.5 - 0.5 * float(np.cos(np.pi * j / 7)) for j in range(8))  # of the depth; both ends exactly
MID_SHARES = tuple(0.5 - 0.5 * float(np.cos(np.pi * (j + 0.5) / 8)) for j in range(8))
FIRST = tuple(SHARES[j] for j in (0, 7, 3, 5, 1, 6, 2, 4))  # those that decide most first
FIRST_TURN = 1.5 * np.pi  # [rad] of spin: where a leg goes round more than once, its first turn tells most
CHUNK = 4  # stand-offs that are examined before the box is judged again
NEVER = 100  # reversals that no joint makes


class BoxLegs:
    """The legs of a box: what they have in common, as far as it has been examined.

    Args:
        of: posture and rules.
        box: the legs.
        more: stand-offs that are examined at last, as shares of the depth.

    Attributes:
        dead: why no leg of the box keeps the rules, or None.
        forth: least turns of each joint if it leaves the target forwards.
        back: the same backwards.
        may: whether each joint may keep its direction and the threshold all along, forwards and backwards.
        least: no leg at the centre of the box travels less [rad]; likewise:
        by_psi: derivative of a lower bound of the travel by the spin.
        by_slope: likewise by the slope [m].
        turns: see `optimality_travel.Travel`.
        twist: no leg turns the tool less [rad], and none travels less than that.
    """

    def __init__(self, of: Examiner, box: Box, more: Iterable[float] = ()) -> None:
        self.of, self.box, self.extent = of, box, Extent(box)
        rest = list(more)
        self._steps: list[Callable[[], str | None]] = [self._begin, self._travel]
        self._steps += [partial(self._examine, rest[k : k + CHUNK]) for k in range(0, len(rest), CHUNK)]
        self._samples: dict[float, Look] = {}
        self._signs: dict[float, list[int]] = {}
        self._conditions: dict[tuple[int, float, float], tuple[arb, arb, arb]] = {}
        self._met = [0] * 6  # signs that are met: 1, 2, or both
        self.dead: str | None = None
        self.forth: tuple[int, ...] = (0,) * 6
        self.back: tuple[int, ...] = (0,) * 6
        self.may = [[True, True] for _ in SIX]
        self.least, self.by_psi, self.by_slope = arb(0), arb(0), arb(0)
        self.turns: tuple[Turns, Turns] = ((ANY_TURN,) * 6, (ANY_TURN,) * 6)
        self.twist = arb(max(box.least, -box.most, 0.0)) * of.depth
        steepest = max(abs(box.least), abs(box.most)) * of.claim.depth
        self._stretch = 1.0 if steepest <= FIRST_TURN else FIRST_TURN / steepest

    def sample_closer(self) -> bool:
        """Examine the box further: the signs, then travel and limits, then more stand-offs; whether there was more."""
        if self.dead is not None or not self._steps:
            return False
        self.dead = self._steps.pop(0)()
        return True

    def condition(self, i: int, share: float, direction: float) -> tuple[arb, arb, arb] | None:
        """What a joint's rate has above the least that it must have in a direction, at a stand-off.

        Returns:
            enclosures of it, in units of the rate at the centre, at the centre [rad/m], and of its derivatives by the
            spin [1/m] and by the slope; None where they may have no bound.
        """
        found = self._conditions.get((i, share, direction))
        if found is not None:
            return found
        of, extent = self.of, self.extent
        sample = self._samples.get(share) or of.sample(extent, share)
        series, centre, whole = sample.series, sample.centre, sample.whole
        if series is None or centre is None or whole is None:
            return None
        try:
            den = smooth_denominators(series)[i]
        except ValueError:
            return None
        at_centre, least = denominators(centre)[i], of.threshold if of.threshold > 0 else -of.nil
        unit = at_centre.mid()
        if not unit > 0:
            return None
        middle = direction * (centre.outwards[i] + extent.slope * centre.spinning[i]) - least * at_centre
        by_psi = direction * (series.outwards[i][1] + extent.slopes * series.spinning[i][1]) - least * den[1]
        by_slope = direction * whole.spinning[i] + sample.standoff * by_psi
        found = self._conditions[i, share, direction] = middle / unit, by_psi / unit, by_slope / unit
        return found

    def _begin(self) -> str | None:
        """The bound on the spin, and the signs at the first stand-offs; why the box is dead, or None."""
        bound, depth, extent, box = arb(self.of.claim.psi_bound), self.of.depth, self.extent, self.box
        low, high = extent.psi - extent.psi_half, extent.psi + extent.psi_half
        if bound > 0 and (low + arb(box.least) * depth > bound or high + arb(box.most) * depth < -bound):
            return "bound on the spin"
        return self._examine(share * self._stretch for share in FIRST)

    def _examine(self, shares: Iterable[float]) -> str | None:
        """Examine the signs at stand-offs; why the box is dead, or None."""
        for share in shares:
            if share not in self._samples and (dead := self._look(share)):
                return dead
        self.forth, self.back = self._turned()
        return None

    def _travel(self) -> str | None:
        """Find the least travel and the turns within the limits; why the box is dead, or None."""
        samples = [self._samples[share] for share in sorted(self._samples)]
        self.least, self.by_psi, self.by_slope, self.turns = travel_of(self.of, self.extent, samples)
        fits = (all(least <= most for least, most in self.turns[flip]) for flip in self.of.flips)
        return None if any(fits) else "limits"

    def _look(self, share: float) -> str | None:
        """Examine the box at a stand-off; why it is dead, or None."""
        sample = self._samples[share] = self.of.sample(self.extent, share)
        if sample.beyond:
            return "out of reach"
        if sample.whole is None:
            return None
        signs = self._signs[share] = [
            self._judge(i, self._rates(i, sample), den) for i, den in enumerate(denominators(sample.whole))
        ]
        for i in SIX:
            self._met[i] |= (0, 1, 2)[signs[i]]
        turning = any(met == 3 or not (may[0] or may[1]) for met, may in zip(self._met, self.may, strict=True))
        return "signs" if turning and self._least_cost() > self.of.claim.most_cost + 1e-9 else None

    def _rates(self, i: int, sample: Look) -> list[arb]:
        """Enclosures of a joint's rate times its denominator: of plain arithmetic, and of the mean-value form."""
        extent, whole, series, centre = self.extent, sample.whole, sample.series, sample.centre
        assert whole is not None
        N, M = whole.outwards[i], whole.spinning[i]
        rates = [N + extent.slopes * M]
        if series is not None and centre is not None:
            by_psi = series.outwards[i][1] + extent.slopes * series.spinning[i][1]
            middle = centre.outwards[i] + extent.slope * centre.spinning[i]
            rates.append(middle + by_psi * extent.d_psi + (M + sample.standoff * by_psi) * extent.d_slope)
        return rates

    def _judge(self, i: int, rates: list[arb], den: arb) -> int:
        """The sign of a joint's rate, where it is certain; and whether the joint may keep the threshold."""
        nil, least, may = self.of.nil * den, self.of.threshold * den, self.may[i]
        sign = 0
        for rate in rates:
            if rate > nil:
                sign = 1
            elif -rate > nil:
                sign = -1
            if self.of.threshold > 0:
                may[0] = may[0] and not rate < least
                may[1] = may[1] and not -rate < least
        if sign and self.of.threshold == 0:
            may[0 if sign < 0 else 1] = False
        return sign

    def _least_cost(self) -> float:
        """What the turns of a leg cost by themselves, at least."""
        turns = [min(f, b) or int(not any(may)) for f, b, may in zip(*self._turned(), self.may, strict=True)]
        return self.of.cost(turns)

    def _turned(self) -> tuple[tuple[int, ...], tuple[int, ...]]:
        """Least turns of each joint if it leaves the target forwards, and backwards."""
        order = sorted(self._signs)
        both: tuple[list[int], list[int]] = ([], [])
        for i in SIX:
            signs = [sign for share in order if (sign := self._signs[share][i])] if self._met[i] else []
            changes = sum(a != b for a, b in pairwise(signs))
            at_target = 0.0 in self._signs and self._signs[0.0][i] != 0
            other = 0 if not signs else NEVER if at_target else changes + 1
            forwards = not signs or signs[0] > 0
            both[0].append(changes if forwards else other)
            both[1].append(other if forwards else changes)
        return tuple(both[0]), tuple(both[1])
