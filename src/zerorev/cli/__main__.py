"""`python -m zerorev.cli`, where the script `zerorev` is not on the path."""

from __future__ import annotations

import sys

from zerorev.cli import main

if __name__ == "__main__":
    sys.exit(main())
