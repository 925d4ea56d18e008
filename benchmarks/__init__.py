"""zerorev and its peers at the same work, on one core: `python -m benchmarks.run --help`.

Threads are held to one before any library that could start some is imported.
"""

import os

for _name in ("NUMBA_NUM_THREADS", "OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(_name, "1")
