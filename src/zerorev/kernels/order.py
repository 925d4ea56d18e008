"""The order of a few numbers.

`np.sort` and `np.argsort` are not usable in a kernel: Numba makes their inner functions again in each process and names
them by a count of that process. Where kernels that two processes have cached come together in a third, one name may
stand for both, so that one sorts numbers where it should have sorted their places, and memory is overwritten.
"""

from __future__ import annotations

import numpy as np

from zerorev.kernels._jit import kernel


@kernel
def order_of(values):  # type: ignore[no-untyped-def]
    """Places of the values, least first, shape (n,); equal ones as they stand, NaN last.

    By insertion: for some hundred values, of which many are in order.

    Args:
        values: shape (n,).
    """
    order = np.empty(values.shape[0], dtype=np.int64)
    for n in range(values.shape[0]):
        value, at = values[n], n
        while at > 0:
            before = values[order[at - 1]]
            if before <= value or np.isnan(value):
                break
            order[at] = order[at - 1]
            at -= 1
        order[at] = n
    return order
