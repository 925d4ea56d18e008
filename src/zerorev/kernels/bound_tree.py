"""Branch and bound over boxes of legs: the least number of reversals, then the least travel (theory §3).

A node is a posture, an interval of spins at the target, and the intervals of slopes that are left of either leg. Its
value bounds from below what any two of its legs have: reversals x BIG + travel, so that one number orders both. The
node of the least value is examined next; what its pairs of boxes leave open is halved.

Lengths in m, angles in rad. No kernel raises. `rules` and `tree` are those of `zerorev.search.bounds.tree`.
"""

from __future__ import annotations

import numpy as np

from zerorev.kernels._jit import kernel
from zerorev.kernels.bound_boxes import GROUPS, HIGH, LOW, SAMPLES, VALUE_OF
from zerorev.kernels.bound_legs import examine, move
from zerorev.kernels.bound_multipliers import MOST_TERMS, TERM, find_terms
from zerorev.kernels.bound_nodes import (
    BEST,
    BIG,
    CANDIDATE_VALUE,
    COUNT,
    CUTS,
    EXAMINED,
    HEAP,
    LAST_LEFT,
    LEFT,
    LOGGED,
    NODE_HIGH,
    NODE_LOW,
    NODE_OF_TRAVEL,
    NODE_VALUE,
    NODES,
    NOTHING,
    PARENT,
    PASSES_DONE,
    POSTURE,
    SLOPES,
    START,
    TRIED,
    close,
    pop,
    push,
    threshold,
)  # fmt: skip
from zerorev.kernels.bound_pairs import best_pair, pair_cost, pair_travel
from zerorev.kernels.intervals import LANES

# why the loop returns
EMPTY, PROVEN, LEFT_OVER, BUDGET, CANDIDATE, FULL = range(6)

MOST_CUTS = 32
MOST_LEGS = 400
MOST_CLOSED = 32 * MOST_LEGS  # boxes that one node can close
FINE, FINEST = 0.05, 0.003  # [rad] widths of a node below which more stand-offs are examined
TRY = 0.02  # [rad] below which a motion is tried
NARROWEST = 1e-6  # [rad] below which a node is given up
LEADS, LEADS_AT_MOST = 1.005, 1.05  # what is halved: what lies so close to the best
NEAR = 0.01  # of its travel to the best motion's: where only one node in TRY_EACH is tried
TRY_EACH = 4
SLOPES_TRIED = 4  # of either leg
SELDOM = 16  # motions tried that seem to fail, of which one is reported all the same


@kernel
def examined(formulas, rules, tree, node, psi, legs, known, count, groups, cuts, room):  # type: ignore[no-untyped-def]
    """Examine boxes of a node, and log those that are dead; returns how many are left, in their order."""
    logged = tree.closed.shape[0] > 0
    before = np.empty((count if logged else 0, 2))
    for n in range(before.shape[0]):
        before[n, 0], before[n, 1] = legs[n, LOW], legs[n, HIGH]
    aim = tree.terms[node], tree.nodes[node, NODE_OF_TRAVEL], tree.shares[node]
    left, passes = examine(formulas, rules, aim, psi, legs, known, count, groups, cuts, room)
    tree.counts[PASSES_DONE] += passes
    k = 0
    for n in range(before.shape[0]):
        if k < left and legs[k, LOW] == before[n, 0]:
            k += 1
        else:
            close(tree, node, before[n, 0], before[n, 1], 1.0)
    return left


@kernel
def narrowed(formulas, rules, tree, node, work):  # type: ignore[no-untyped-def]
    """Examine a node: halve the slopes that lead, until they are as narrow as its spins.

    Returns:
        the value of the node, its best two boxes, and how many boxes are left; no boxes where none is of interest.
    """
    legs, known, fresh, fresh_known, room, pair_room = work
    psi = np.array([tree.nodes[node, NODE_LOW], tree.nodes[node, NODE_HIGH]])
    width = psi[1] - psi[0]
    groups = 4 if width < FINEST else (2 if width < FINE else 1)
    cuts = tree.cuts[node, : tree.lists[node, CUTS]]
    start, count = tree.lists[node, START], tree.lists[node, COUNT]
    for n in range(count):
        legs[n, LOW], legs[n, HIGH] = tree.slopes[start + n, 0], tree.slopes[start + n, 1]
    count = examined(formulas, rules, tree, node, psi, legs, known, count, groups, cuts, room)
    half_psi = 0.5 * width + 1e-14
    while True:
        best, first, second = best_pair(rules, tree, node, legs, known, count, half_psi, pair_room)
        if first < 0:
            for n in range(count):
                close(tree, node, legs[n, LOW], legs[n, HIGH], 0.0)
            return best, first, second, 0
        following = tree.nodes[tree.heap[0], NODE_VALUE] if tree.counts[HEAP] > 0 else NOTHING
        whole = BIG * np.floor(best / BIG + 1e-9)
        upto = max(whole + (best - whole) * LEADS, min(following, whole + (best - whole) * LEADS_AT_MOST))
        kept = halves = 0
        for n in range(count):
            if legs[n, VALUE_OF] >= NOTHING:
                close(tree, node, legs[n, LOW], legs[n, HIGH], 0.0)
                continue
            wide = (legs[n, HIGH] - legs[n, LOW]) * rules.depth > rules.aspect * width * 1.0001
            if wide and legs[n, VALUE_OF] <= upto and halves + kept + count - n < MOST_LEGS:
                middle = 0.5 * (legs[n, LOW] + legs[n, HIGH])
                fresh[halves, LOW], fresh[halves, HIGH] = legs[n, LOW], middle
                fresh[halves + 1, LOW], fresh[halves + 1, HIGH] = middle, legs[n, HIGH]
                halves += 2
            else:
                if kept < n:
                    move(legs, known, kept, legs, known, n)
                kept += 1
        count = kept
        if halves == 0:
            # those dropped have moved the others: which two are the best must be found again
            best, first, second = best_pair(rules, tree, node, legs, known, count, half_psi, pair_room)
            return best, first, second, count
        halves = examined(formulas, rules, tree, node, psi, fresh, fresh_known, halves, groups, cuts, room)
        for n in range(halves):
            move(legs, known, count, fresh, fresh_known, n)
            count += 1


@kernel
def try_motion(formulas, rules, tree, node, one, other, work, out):  # type: ignore[no-untyped-def]
    """Look for two legs near the middle of a node that seem to be of interest.

    Args:
        formulas: of the posture.
        rules: what is asked.
        tree: whose best motion counts.
        node: whose spins count.
        one: interval of slopes of a leg, shape (2,).
        other: likewise.
        work: room.
        out: spin at the target and the two slopes, shape (3,).

    Returns:
        the value of the two, as far as points on them show it; NOTHING where there are none.
    """
    _, _, legs, known, room, _ = work
    width = tree.nodes[node, NODE_HIGH] - tree.nodes[node, NODE_LOW]
    middle = 0.5 * (tree.nodes[node, NODE_LOW] + tree.nodes[node, NODE_HIGH])
    psi = np.array([middle, middle])
    aim = tree.terms[node], tree.nodes[node, NODE_OF_TRAVEL], tree.shares[node]
    cuts = tree.cuts[node, : tree.lists[node, CUTS]]
    ends = [0, 0, 0]
    for k in range(2):
        low, high = (one[0], one[1]) if k == 0 else (other[0], other[1])
        around = max(high - low, 1e-12 * width / rules.depth)
        start = ends[k]
        for e in range(SLOPES_TRIED):
            slope = 0.5 * (low + high) + 1.2 * around * (2.0 * e / (SLOPES_TRIED - 1) - 1.0)
            legs[start + e, LOW] = legs[start + e, HIGH] = slope
        count, passes = examine(
            formulas, rules, aim, psi, legs[start:], known[start:], SLOPES_TRIED, GROUPS, cuts, room
        )
        tree.counts[PASSES_DONE] += passes
        ends[k + 1] = start + count
        if count == 0:
            return NOTHING
    best, limit = NOTHING, threshold(rules, tree)
    for n in range(ends[1]):
        for m in range(ends[1], ends[2]):
            cost = pair_cost(rules, known[n], known[m])
            if cost >= NOTHING:
                continue
            value = BIG * cost + pair_travel(legs[n], legs[m], 0.0)
            if value < best and value < limit:
                best = value
                out[0], out[1], out[2] = middle, legs[n, LOW], legs[m, LOW]
    return best


@kernel
def advance(models, rules, tree, most_passes, work):  # type: ignore[no-untyped-def]
    """Examine nodes until there is something to say.

    Args:
        models: `Formulas` of the four postures.
        rules: what is asked.
        tree: in and out.
        most_passes: budget, of all so far.
        work: room.

    Returns:
        EMPTY: no node is left; PROVEN: none that could beat the best motion by more than the gap; LEFT_OVER: none but
        those that were given up; BUDGET: it is spent; CANDIDATE: `tree.candidate` seems to be better than the best,
        and the two nodes pushed last are where it came from; FULL: the tree needs more room.
    """
    legs = work[0]
    slot, terms, of_travel, shares = np.empty((2, 2)), np.zeros((MOST_TERMS, TERM)), 1.0, np.zeros(SAMPLES)
    while True:
        if tree.counts[HEAP] == 0:
            return EMPTY if tree.values[LEFT] >= NOTHING else LEFT_OVER
        top = tree.nodes[tree.heap[0], NODE_VALUE]
        if top >= threshold(rules, tree):
            return PROVEN if tree.values[LEFT] >= threshold(rules, tree) else LEFT_OVER
        if tree.values[LEFT] <= top:
            return LEFT_OVER
        if tree.counts[PASSES_DONE] >= most_passes:
            return BUDGET
        if tree.counts[NODES] + 2 > tree.nodes.shape[0] or tree.counts[SLOPES] + MOST_LEGS > tree.slopes.shape[0]:
            return FULL
        if 0 < tree.closed.shape[0] < tree.counts[LOGGED] + MOST_CLOSED:
            return FULL
        node = pop(tree)
        tree.counts[EXAMINED] += 1
        posture = tree.lists[node, POSTURE]
        value, first, second, count = narrowed(models[posture], rules, tree, node, work)
        if first < 0:
            continue
        value = max(value, tree.nodes[node, NODE_VALUE])
        low, high = tree.nodes[node, NODE_LOW], tree.nodes[node, NODE_HIGH]
        for k in range(2):
            n = first if k == 0 else second
            slot[k, 0], slot[k, 1] = legs[n, LOW], legs[n, HIGH]
        if low < high:
            pair = np.array([first, second])
            of_travel = find_terms(
                models[posture], rules, np.array([low, high]), legs, work[1], pair, terms, shares, work[4][1:]
            )
            tree.counts[PASSES_DONE] += LANES // rules.samples
        found = NOTHING
        # what a wide node lacks to the best motion, narrower ones will not: few are worth a try
        near = value >= threshold(rules, tree) - NEAR * (tree.values[BEST] - BIG * rules.most_cost)
        near = near and high - low > FINEST / 16 and rules.most_cost < rules.least_weight
        tried = high - low < TRY and (not near or tree.counts[EXAMINED] % TRY_EACH == 0)
        if tried:
            found = try_motion(models[posture], rules, tree, node, slot[0], slot[1], work, tree.candidate)
            if found >= NOTHING:
                tree.candidate[0] = 0.5 * (low + high)
                tree.candidate[1], tree.candidate[2] = 0.5 * (slot[0, 0] + slot[0, 1]), 0.5 * (slot[1, 0] + slot[1, 1])
        if high - low < NARROWEST:
            tree.values[LEFT] = min(tree.values[LEFT], value)
        else:
            _divide(tree, node, value, count, legs, terms, of_travel, shares)
        if tried:
            tree.candidate[3] = posture
            tree.values[CANDIDATE_VALUE] = found
            tree.counts[TRIED] += 1
            uncut = high - low < FINEST and tree.lists[node, CUTS] == 0
            if found < NOTHING or uncut or tree.counts[TRIED] % SELDOM == 0:
                return CANDIDATE


@kernel
def _divide(tree, node, value, count, legs, terms, of_travel, shares):  # type: ignore[no-untyped-def]
    """Halve a node; both halves share the slopes that are left, the multipliers and the stand-offs."""
    start, kept = tree.counts[SLOPES], 0
    for n in range(count):
        if legs[n, VALUE_OF] < NOTHING:
            tree.slopes[start + kept, 0], tree.slopes[start + kept, 1] = legs[n, LOW], legs[n, HIGH]
            kept += 1
        else:
            close(tree, node, legs[n, LOW], legs[n, HIGH], 0.0)
    tree.counts[SLOPES] += kept
    low, high = tree.nodes[node, NODE_LOW], tree.nodes[node, NODE_HIGH]
    middle = 0.5 * (low + high)
    for half in range(2):
        new = tree.counts[NODES]
        tree.counts[NODES] += 1
        tree.nodes[new, NODE_LOW] = low if half == 0 else middle
        tree.nodes[new, NODE_HIGH] = middle if half == 0 else high
        tree.nodes[new, NODE_VALUE], tree.nodes[new, NODE_OF_TRAVEL] = value, of_travel
        for t in range(MOST_TERMS):
            for k in range(TERM):
                tree.terms[new, t, k] = terms[t, k]
        for j in range(SAMPLES):
            tree.shares[new, j] = shares[j]
        tree.lists[new, POSTURE] = tree.lists[node, POSTURE]
        tree.lists[new, START], tree.lists[new, COUNT] = start, kept
        tree.lists[new, CUTS], tree.lists[new, PARENT] = tree.lists[node, CUTS], node
        for k in range(tree.lists[node, CUTS]):
            tree.cuts[new, k] = tree.cuts[node, k]
        tree.counts[LAST_LEFT + half] = new
        push(tree, new)
