"""Branch and bound over boxes of legs: the least number of reversals, then the least travel (theory §3).

A node is a posture, an interval of spins at the target, and the intervals of slopes that are left of either leg. Its
value bounds from below what any two of its legs have: reversals x BIG + travel, so that one number orders both. The
node of the least value is examined next; what its pairs of boxes leave open is halved.

Lengths in m, angles in rad. No kernel raises. `rules` and `tree` are those of `zerorev.search.bounds.tree`.
"""

from __future__ import annotations

import numpy as np

from zerorev.kernels._jit import kernel
from zerorev.kernels.bound_boxes import (
    BACK,
    BOXES,
    BY_PSI_HIGH,
    BY_PSI_LOW,
    BY_SLOPE,
    FITS,
    FORTH,
    GROUPS,
    HIGH,
    KNOWN,
    LEAST,
    LOW,
    MAY_BACK,
    MAY_FORTH,
    TWIST,
    VALUE_OF,
)  # fmt: skip
from zerorev.kernels.bound_legs import examine, move

BIG = 1e4  # more than any travel [rad]
NOTHING = 1e300

# why the loop returns
EMPTY, PROVEN, LEFT_OVER, BUDGET, CANDIDATE, FULL = range(6)
# tree.counts
HEAP, NODES, SLOPES, LOOKS_DONE, LAST_LEFT, LAST_RIGHT, EXAMINED, TRIED, LOGGED, COUNTS = range(10)
# tree.values
BEST, LEFT, CANDIDATE_VALUE, GAP = range(4)
# columns of tree.nodes, and of tree.lists
NODE_LOW, NODE_HIGH, NODE_VALUE = range(3)
POSTURE, START, COUNT, CUTS, PARENT, LISTED = range(6)
# columns of tree.closed
CLOSED_NODE, CLOSED_LOW, CLOSED_HIGH, CLOSED_DEAD, CLOSED = range(5)

MOST_CUTS = 32
MOST_LEGS = 400
MOST_CLOSED = 32 * MOST_LEGS  # boxes that one node can close
FINE, FINEST = 0.05, 0.003  # [rad] widths of a node below which more stand-offs are examined
TRY = 0.02  # [rad] below which a motion is tried
NARROWEST = 1e-6  # [rad] below which a node is given up
LEADS, LEADS_AT_MOST = 1.005, 1.05  # what is halved: what lies so close to the best
SLOPES_TRIED = BOXES  # of either leg
SELDOM = 16  # motions tried that seem to fail, of which one is reported all the same


@kernel
def push(tree, node):  # type: ignore[no-untyped-def]
    """Put a node on the heap."""
    heap, values = tree.heap, tree.nodes
    k = tree.counts[HEAP]
    tree.counts[HEAP] += 1
    while k > 0:
        above = (k - 1) // 2
        if values[heap[above], NODE_VALUE] <= values[node, NODE_VALUE]:
            break
        heap[k] = heap[above]
        k = above
    heap[k] = node


@kernel
def pop(tree):  # type: ignore[no-untyped-def]
    """Take the node of the least value off the heap."""
    heap, values = tree.heap, tree.nodes
    top = heap[0]
    tree.counts[HEAP] -= 1
    count = tree.counts[HEAP]
    node = heap[count]
    k = 0
    while 2 * k + 1 < count:
        below = 2 * k + 1
        if below + 1 < count and values[heap[below + 1], NODE_VALUE] < values[heap[below], NODE_VALUE]:
            below += 1
        if values[heap[below], NODE_VALUE] >= values[node, NODE_VALUE]:
            break
        heap[k] = heap[below]
        k = below
    heap[k] = node
    return top


@kernel
def close(tree, node, low, high, dead):  # type: ignore[no-untyped-def]
    """Log that a box is left out of a node: no leg of it may exist, or no pair with it is of interest."""
    if tree.closed.shape[0] == 0:
        return
    k = tree.counts[LOGGED]
    tree.counts[LOGGED] += 1
    if k < tree.closed.shape[0]:
        tree.closed[k, CLOSED_NODE], tree.closed[k, CLOSED_DEAD] = node, dead
        tree.closed[k, CLOSED_LOW], tree.closed[k, CLOSED_HIGH] = low, high


@kernel
def threshold(rules, tree):  # type: ignore[no-untyped-def]
    """The value from which on a node is of no interest: the best motion's, less the gap that is allowed."""
    best = tree.values[BEST]
    if best >= NOTHING:
        return NOTHING
    return BIG * rules.most_cost + (best - BIG * rules.most_cost) * (1.0 - tree.values[GAP])


@kernel
def pair_cost(rules, one, other):  # type: ignore[no-untyped-def]
    """What two boxes of legs cost in reversals at the least; NOTHING where no turns fit both."""
    cost = 0.0
    for i in range(6):
        fp, bp, fr, br = one[FORTH, i], one[BACK, i], other[FORTH, i], other[BACK, i]
        turns = min(min(fp + br, bp + fr), 1 + min(fp + fr, bp + br))
        if turns == 0 and not (
            (one[MAY_FORTH, i] and other[MAY_BACK, i]) or (one[MAY_BACK, i] and other[MAY_FORTH, i])
        ):
            turns = 1
        cost += rules.weights[i] * turns
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
    """What two boxes of legs travel at the least [rad]."""
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
def best_pair(rules, tree, legs, known, count, half_psi, room):  # type: ignore[no-untyped-def]
    """The least value of any two of a node's boxes; each box is given the least that it is part of.

    Args:
        rules: what is asked.
        tree: whose best motion counts.
        legs: in and out, shape (N, COLUMNS).
        known: shape (N, KNOWN, 6).
        count: how many boxes there are.
        half_psi: of the node [rad].
        room: kind of each box, shape (N,), a box of each kind, shape (N,), and costs of pairs of kinds, shape (N, N).

    Returns:
        the value and the two boxes; NOTHING, -1, -1 where no pair is of interest.
    """
    kinds, samples, costs = room
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
            costs[a, b] = costs[b, a] = pair_cost(rules, known[samples[a]], known[samples[b]])
    limit = threshold(rules, tree)
    best, first, second = NOTHING, -1, -1
    for n in range(count):
        for m in range(n, count):
            cost = costs[kinds[n], kinds[m]]
            if cost >= NOTHING:
                continue
            value = BIG * cost + pair_travel(legs[n], legs[m], half_psi)
            if value >= limit:
                continue
            legs[n, VALUE_OF] = min(legs[n, VALUE_OF], value)
            legs[m, VALUE_OF] = min(legs[m, VALUE_OF], value)
            if value < best:
                best, first, second = value, n, m
    return best, first, second


@kernel
def examined(formulas, rules, tree, node, psi, legs, known, count, groups, cuts, room):  # type: ignore[no-untyped-def]
    """Examine boxes of a node, and log those that are dead; returns how many are left, in their order."""
    logged = tree.closed.shape[0] > 0
    before = np.empty((count if logged else 0, 2))
    for n in range(before.shape[0]):
        before[n, 0], before[n, 1] = legs[n, LOW], legs[n, HIGH]
    left, looks = examine(formulas, rules, psi, legs, known, count, groups, cuts, room)
    tree.counts[LOOKS_DONE] += looks
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
        best, first, second = best_pair(rules, tree, legs, known, count, half_psi, pair_room)
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
            wide = (legs[n, HIGH] - legs[n, LOW]) * rules.depth > width * 1.0001
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
            best, first, second = best_pair(rules, tree, legs, known, count, half_psi, pair_room)
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
    cuts = tree.cuts[node, : tree.lists[node, CUTS]]
    ends = [0, 0, 0]
    for k in range(2):
        low, high = (one[0], one[1]) if k == 0 else (other[0], other[1])
        around = max(high - low, 1e-12 * width / rules.depth)
        start = ends[k]
        for e in range(SLOPES_TRIED):
            slope = 0.5 * (low + high) + 1.2 * around * (2.0 * e / (SLOPES_TRIED - 1) - 1.0)
            legs[start + e, LOW] = legs[start + e, HIGH] = slope
        count, looks = examine(formulas, rules, psi, legs[start:], known[start:], SLOPES_TRIED, GROUPS, cuts, room)
        tree.counts[LOOKS_DONE] += looks
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
def advance(models, rules, tree, most_looks, work):  # type: ignore[no-untyped-def]
    """Examine nodes until there is something to say.

    Args:
        models: `Formulas` of the four postures.
        rules: what is asked.
        tree: in and out.
        most_looks: budget, of all so far.
        work: room.

    Returns:
        EMPTY: no node is left; PROVEN: none that could beat the best motion by more than the gap; LEFT_OVER: none but
        those that were given up; BUDGET: it is spent; CANDIDATE: `tree.candidate` seems to be better than the best,
        and the two nodes pushed last are where it came from; FULL: the tree needs more room.
    """
    legs = work[0]
    slot = np.empty((2, 2))
    while True:
        if tree.counts[HEAP] == 0:
            return EMPTY if tree.values[LEFT] >= NOTHING else LEFT_OVER
        top = tree.nodes[tree.heap[0], NODE_VALUE]
        if top >= threshold(rules, tree):
            return PROVEN if tree.values[LEFT] >= threshold(rules, tree) else LEFT_OVER
        if tree.values[LEFT] <= top:
            return LEFT_OVER
        if tree.counts[LOOKS_DONE] >= most_looks:
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
        found = NOTHING
        tried = high - low < TRY
        if tried:
            found = try_motion(models[posture], rules, tree, node, slot[0], slot[1], work, tree.candidate)
            if found >= NOTHING:
                tree.candidate[0] = 0.5 * (low + high)
                tree.candidate[1], tree.candidate[2] = 0.5 * (slot[0, 0] + slot[0, 1]), 0.5 * (slot[1, 0] + slot[1, 1])
        if high - low < NARROWEST:
            tree.values[LEFT] = min(tree.values[LEFT], value)
        else:
            _divide(tree, node, value, count, legs)
        if tried:
            tree.candidate[3] = posture
            tree.values[CANDIDATE_VALUE] = found
            tree.counts[TRIED] += 1
            if found < NOTHING or tree.counts[TRIED] % SELDOM == 0:
                return CANDIDATE


@kernel
def _divide(tree, node, value, count, legs):  # type: ignore[no-untyped-def]
    """Halve a node; both halves share the slopes that are left."""
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
        tree.nodes[new, NODE_VALUE] = value
        tree.lists[new, POSTURE] = tree.lists[node, POSTURE]
        tree.lists[new, START], tree.lists[new, COUNT] = start, kept
        tree.lists[new, CUTS], tree.lists[new, PARENT] = tree.lists[node, CUTS], node
        for k in range(tree.lists[node, CUTS]):
            tree.cuts[new, k] = tree.cuts[node, k]
        tree.counts[LAST_LEFT + half] = new
        push(tree, new)
