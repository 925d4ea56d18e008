"""Where the files lie that tests read."""

from __future__ import annotations

from pathlib import Path

__all__ = ["CASES", "DATA", "GOLDEN", "JOBS", "ROOT"]

ROOT = Path(__file__).parents[2]
JOBS = ROOT / "examples" / "jobs"
GOLDEN = ROOT / "tests" / "golden"
DATA = ROOT / "tests" / "data"
CASES = DATA / "exactness"
