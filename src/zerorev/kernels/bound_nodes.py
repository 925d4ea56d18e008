"""Nodes of a branch and bound: what is kept of them, the heap of those to be examined, and the log of what is left out.

`rules` and `tree` are those of `zerorev.search.bounds.tree`. No kernel raises.
"""

from __future__ import annotations

from zerorev.kernels._jit import kernel

BIG = 1e4  # more than any travel [rad]
NOTHING = 1e300

# tree.counts
HEAP, NODES, SLOPES, PASSES_DONE, LAST_LEFT, LAST_RIGHT, EXAMINED, TRIED, LOGGED, COUNTS = range(10)
# tree.values
BEST, LEFT, CANDIDATE_VALUE, GAP = range(4)
# columns of tree.nodes, and of tree.lists
NODE_LOW, NODE_HIGH, NODE_VALUE, NODE_OF_TRAVEL, NODE = range(5)
POSTURE, START, COUNT, CUTS, PARENT, LISTED = range(6)
# columns of tree.closed
CLOSED_NODE, CLOSED_LOW, CLOSED_HIGH, CLOSED_DEAD, CLOSED = range(5)


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
