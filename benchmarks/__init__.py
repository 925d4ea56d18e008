"""zerorev and its peers at the same work, on one core: `python -m benchmarks.run --help`.

Threads are held to one before any library that could start some is imported; where Numba is imported already, as in a
test, it may have started them, and does not take another number.
"""

import os
import sys

if "numba" not in sys.modules:
    for _name in ("NUMBA_NUM_THREADS", "OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
        os.environ.setdefault(_name, "1")
