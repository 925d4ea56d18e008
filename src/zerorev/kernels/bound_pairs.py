"""What two boxes of legs cost in reversals and travel at least, together a motion (theory §3).

The value of a pair is reversals x BIG + travel, so that one number orders both. Conventions are those of `bound_nodes`
and `bound_boxes`.
"""

from __future__ import annotations

from zerorev.kernels._jit import kernel
from zerorev.kernels.bound_boxes import (
    BY_PSI_HIGH,
    BY_PSI_LOW,
    BY_SLOPE,
    FITS,
    KNOWN,
    LEAST,
    TWIST,
    VALUE_OF,
)  # fmt: skip
from zerorev.kernels.bound_multipliers import terms_hold, turns_of, weighed_pair
from zerorev.kernels.bound_nodes import BIG, NODE_OF_TRAVEL, NOTHING, threshold


@kernel
def pair_cost(rules, one, other):  # type: ignore[no-untyped-def]
    """What two boxes of legs cost in reversals at least; NOTHING where no turns fit both."""
    cost = 0.0
    for i in range(6):
        cost += rules.weights[i] * turns_of(one, other, i)
        if cost > rules.most_cost + 1e-9:
            return NOTHING
    for flip in range(2):
        if not rules.flips[flip]:
            continue
        fits = True
        for i in range(6):
            fits = fits and (one[FITS + flip, i] & other[FITS + flip, i]) != 0
        if fits:
            return cost
    return NOTHING


@kernel
def pair_travel(one, other, half_psi):  # type: ignore[no-untyped-def]
    """What two boxes of legs travel at least [rad]."""
    low, high = one[BY_PSI_LOW] + other[BY_PSI_LOW], one[BY_PSI_HIGH] + other[BY_PSI_HIGH]
    varies = max(abs(low), abs(high)) * half_psi + one[BY_SLOPE] + other[BY_SLOPE]
    return max(one[LEAST] + other[LEAST] - varies * (1.0 + 1e-12), one[TWIST] + other[TWIST])


@kernel
def _same(one, other):  # type: ignore[no-untyped-def]
    for row in range(KNOWN):
        for i in range(6):
            if one[row, i] != other[row, i]:
                return False
    return True


@kernel
def best_pair(rules, tree, node, legs, known, count, half_psi, room):  # type: ignore[no-untyped-def]
    """The least value of any two of a node's boxes; each box is given the least that it is part of.

    Args:
        rules: what is asked.
        tree: whose best motion counts.
        node: whose multipliers count.
        legs: in and out, shape (N, COLUMNS).
        known: shape (N, KNOWN, 6).
        count: how many boxes there are.
        half_psi: of the node [rad].
        room: kind of each box, shape (N,), a box of each kind, shape (N,), costs of pairs of kinds, shape (N, N), and
            whether the node's terms hold for a pair with a box of the one kind as its first leg, shape (N, N).

    Returns:
        the value and the two boxes; NOTHING, -1, -1 where no pair is of interest.
    """
    kinds, samples, costs, holds = room
    terms, of_travel, limit = tree.terms[node], tree.nodes[node, NODE_OF_TRAVEL], threshold(rules, tree)
    most = 0
    for n in range(count):
        legs[n, VALUE_OF] = NOTHING
        kind = 0
        while kind < most and not _same(known[n], known[samples[kind]]):
            kind += 1
        if kind == most:
            samples[most] = n
            most += 1
        kinds[n] = kind
    for a in range(most):
        for b in range(a, most):
            one, other = known[samples[a]], known[samples[b]]
            cost = costs[a, b] = costs[b, a] = pair_cost(rules, one, other)
            # a motion that reverses one joint more is of no interest
            calm = cost + rules.least_weight > rules.most_cost + 1e-9 or BIG * (cost + rules.least_weight) >= limit
            holds[a, b] = calm and terms_hold(terms, one, other)
            holds[b, a] = calm and terms_hold(terms, other, one)
    best, first, second = NOTHING, -1, -1
    for n in range(count):
        for m in range(n, count):
            cost = costs[kinds[n], kinds[m]]
            if cost >= NOTHING:
                continue
            travel, weighed = pair_travel(legs[n], legs[m], half_psi), -NOTHING
            if holds[kinds[n], kinds[m]]:
                weighed = weighed_pair(legs[n], legs[m], half_psi)
            if holds[kinds[m], kinds[n]]:
                weighed = max(weighed, weighed_pair(legs[m], legs[n], half_psi))
            if of_travel == 0.0 and weighed > 0.0:
                continue
            value = BIG * cost + (max(travel, weighed) if of_travel == 1.0 else travel)
            if value >= limit:
                continue
            legs[n, VALUE_OF] = min(legs[n, VALUE_OF], value)
            legs[m, VALUE_OF] = min(legs[m, VALUE_OF], value)
            if value < best:
                best, first, second = value, n, m
    return best, first, second
