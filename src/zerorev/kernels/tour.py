"""From hole to hole: the best members of a given order, and orders that are better.

Each hole has members, the motions that may drill it; each member begins and ends at joint angles of its own. What a
move between two costs is the time of a synchronous move of all axes, each with a trapezoid of speed, and something
besides where the branches differ. The cost is not symmetric, since a member's end is not its beginning.

Angles in rad, times in s. No kernel raises.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from zerorev.kernels._jit import kernel

Array = npt.NDArray[np.float64]
Whole = npt.NDArray[np.int64]

__all__ = ["Members", "anneal", "axis_time", "chain", "move_time"]

CHANGE, SWAP = (
    0.25,
    0.85,
)  # of the moves change a member, swap two neighbouring segments up to here; else one turns round
LONGEST = 1000  # holes in segments that are swapped
TURNED = 40  # holes in a segment that turns round


class Members(NamedTuple):
    """The members of all holes, M in all, those of hole h from `first[h]` to `first[h + 1]`.

    Attributes:
        first: shape (H + 1,), whole numbers.
        start: joints where a member begins [rad], shape (M, 6).
        end: where it ends, likewise.
        branch: shape (M,), whole numbers.
        own: what taking the member costs by itself, shape (M,).
        speed: of the axes [rad/s], shape (6,).
        acceleration: likewise [rad/s^2].
        change: what a change of the branch costs.
        home: joints before the first and after the last hole [rad], shape (1, 6); (0, 6): there are none.
    """

    first: Whole
    start: Array
    end: Array
    branch: Whole
    own: Array
    speed: Array
    acceleration: Array
    change: float
    home: Array


@kernel
def axis_time(angle, speed, acceleration):  # type: ignore[no-untyped-def]
    """Time of one axis from rest to rest: a trapezoid of speed, or a triangle where it is short."""
    if angle <= speed * speed / acceleration:
        return 2.0 * np.sqrt(angle / acceleration)
    return angle / speed + speed / acceleration


@kernel
def move_time(start, end, speed, acceleration):  # type: ignore[no-untyped-def]
    """Time of a move of all axes at once: that of the axis which takes longest."""
    longest = 0.0
    for i in range(6):
        longest = max(longest, axis_time(abs(end[i] - start[i]), speed[i], acceleration[i]))
    return longest


@kernel
def move_cost(members, one, other):  # type: ignore[no-untyped-def]
    """From the end of a member to the beginning of another; -1 stands for the home position."""
    speed, acceleration = members.speed, members.acceleration
    if one < 0:
        if members.home.shape[0] == 0 or other < 0:
            return 0.0
        return move_time(members.home[0], members.start[other], speed, acceleration)
    if other < 0:
        if members.home.shape[0] == 0:
            return 0.0
        return move_time(members.end[one], members.home[0], speed, acceleration)
    time = move_time(members.end[one], members.start[other], speed, acceleration)
    return time + (members.change if members.branch[one] != members.branch[other] else 0.0)


@kernel
def chain(members, order, choice):  # type: ignore[no-untyped-def]
    """The members that cost least in a given order: a shortest path through layers, so exact.

    Args:
        members: of all holes.
        order: of the holes, shape (N,).
        choice: out, for each place of the order its member, shape (N,).

    Returns:
        what they cost.
    """
    count = order.shape[0]
    most = 0
    for n in range(count):
        most = max(most, members.first[order[n] + 1] - members.first[order[n]])
    least, before = np.empty(most), np.empty(most)
    came = np.empty((count, most), dtype=np.int64)
    for n in range(count):
        low, high = members.first[order[n]], members.first[order[n] + 1]
        for m in range(low, high):
            best, best_from = np.inf, -1
            if n == 0:
                best = move_cost(members, -1, m)
            else:
                earlier = members.first[order[n - 1]]
                for k in range(members.first[order[n - 1] + 1] - earlier):
                    cost = before[k] + move_cost(members, earlier + k, m)
                    if cost < best:
                        best, best_from = cost, k
            least[m - low] = best + members.own[m]
            came[n, m - low] = best_from
        before[: high - low] = least[: high - low]
    low = members.first[order[count - 1]]
    total, at = np.inf, 0
    for k in range(members.first[order[count - 1] + 1] - low):
        cost = before[k] + move_cost(members, low + k, -1)
        if cost < total:
            total, at = cost, k
    for n in range(count - 1, -1, -1):
        choice[n] = members.first[order[n]] + at
        at = came[n, at]
    return total


@kernel
def _random(state):  # type: ignore[no-untyped-def]
    """The next number in [0, 1): xorshift64*, so that a seed means the same everywhere."""
    x = state[0]
    x ^= x >> np.uint64(12)
    x ^= x << np.uint64(25)
    x ^= x >> np.uint64(27)
    state[0] = x
    return float((x * np.uint64(2685821657736338717)) >> np.uint64(11)) / 9007199254740992.0


@kernel
def _at(choice, place):  # type: ignore[no-untyped-def]
    return choice[place] if 0 <= place < choice.shape[0] else -1


@kernel
def _turned_round(values, low, high):  # type: ignore[no-untyped-def]
    """Turn the entries from low to high round, both included."""
    while low < high:
        values[low], values[high] = values[high], values[low]
        low += 1
        high -= 1


@kernel
def _swapped(values, low, middle, high):  # type: ignore[no-untyped-def]
    """Swap the segments low..middle and middle + 1..high."""
    _turned_round(values, low, middle)
    _turned_round(values, middle + 1, high)
    _turned_round(values, low, high)


@kernel
def anneal(members, near, block, order, choice, steps, hot, cold, seed):  # type: ignore[no-untyped-def]
    """Improve an order and its members by simulated annealing; the same for the same seed.

    Args:
        members: of all holes.
        near: for each hole others that may well follow it, shape (H, K).
        block: for each place of the order the first and the last place that its hole may take, shape (N, 2).
        order: of the holes, shape (N,), changed in place.
        choice: for each place its member, shape (N,), changed in place.
        steps: moves that are tried.
        hot: temperature at the beginning [s].
        cold: at the end [s].
        seed: 1 or more.
    """
    count = order.shape[0]
    state = np.array([seed], dtype=np.uint64) * np.uint64(0x9E3779B97F4A7C15)
    place = np.empty(near.shape[0], dtype=np.int64)
    place[:] = -1
    for n in range(count):
        place[order[n]] = n
    cooling = (cold / hot) ** (1.0 / max(steps, 1))
    heat = hot
    for _ in range(steps):
        heat *= cooling
        pick = _random(state)
        n = min(int(_random(state) * count), count - 1)
        if pick < CHANGE:
            hole = order[n]
            low, high = members.first[hole], members.first[hole + 1]
            other = min(low + int(_random(state) * (high - low)), high - 1)
            now = choice[n]
            if other == now:
                continue
            one, two = _at(choice, n - 1), _at(choice, n + 1)
            more = (
                members.own[other] - members.own[now]
                + move_cost(members, one, other) - move_cost(members, one, now)
                + move_cost(members, other, two) - move_cost(members, now, two)
            )  # fmt: skip
            if more <= 0 or _random(state) < np.exp(-more / heat):
                choice[n] = other
        elif pick < SWAP:
            j = place[near[order[n], min(int(_random(state) * near.shape[1]), near.shape[1] - 1)]]
            if j < 0 or j in (n, n + 1) or block[j, 0] != block[n, 0]:
                continue
            if j > n:  # a hole further on is to come next: n | n+1 .. j-1 | j .. k
                low, middle = n + 1, j - 1
                k = j + int(_random(state) * min(block[n, 1] - j + 1, LONGEST))
                high = min(k, block[n, 1])
            else:  # one further back: j .. k | k+1 .. n
                low, high = j, n
                middle = min(j + int(_random(state) * (n - j)), n - 1)
            if high - low > LONGEST:
                continue
            before, after = _at(choice, low - 1), _at(choice, high + 1)
            more = (
                move_cost(members, before, choice[middle + 1]) + move_cost(members, choice[high], choice[low])
                + move_cost(members, choice[middle], after) - move_cost(members, before, choice[low])
                - move_cost(members, choice[middle], choice[middle + 1]) - move_cost(members, choice[high], after)
            )  # fmt: skip
            if more <= 0 or _random(state) < np.exp(-more / heat):
                _swapped(order, low, middle, high)
                _swapped(choice, low, middle, high)
                for m in range(low, high + 1):
                    place[order[m]] = m
        else:
            high = min(n + 1 + int(_random(state) * TURNED), block[n, 1])
            if high <= n:
                continue
            more = move_cost(members, _at(choice, n - 1), choice[high]) - move_cost(
                members, _at(choice, n - 1), choice[n]
            )
            more += move_cost(members, choice[n], _at(choice, high + 1)) - move_cost(
                members, choice[high], _at(choice, high + 1)
            )
            for m in range(n, high):
                more += move_cost(members, choice[m + 1], choice[m]) - move_cost(members, choice[m], choice[m + 1])
            if more <= 0 or _random(state) < np.exp(-more / heat):
                _turned_round(order, n, high)
                _turned_round(choice, n, high)
                for m in range(n, high + 1):
                    place[order[m]] = m
