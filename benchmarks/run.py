"""The benchmark, whole or in parts; what it finds goes to out/bench as JSON and to docs/benchmarks.md as a page."""

from __future__ import annotations

import argparse
import platform
import sys
from collections.abc import Callable
from dataclasses import replace
from datetime import UTC, datetime
from importlib.metadata import version
from pathlib import Path

from benchmarks.parts import (
    Options,
    cell,
    certificate,
    deepest,
    field,
    free_depth,
    holes,
    job,
    map_great,
    map_scaling,
    maps,
    optimum,
    panel,
    parameter_map,
    plan,
    proof,
    sequence,
    start,
    swarm,
    tolerance,
)
from benchmarks.table import Section, load, page, save
from zerorev.files.output import write_text

PARTS: dict[str, Callable[[Options], Section]] = {
    "field": field.run,
    "optimum": optimum.run,
    "swarm": swarm.run,
    "deepest": deepest.run,
    "proof": proof.run,
    "free_depth": free_depth.run,
    "parameter_map": parameter_map.run,
    "map": maps.run,
    "map_scaling": map_scaling.run,
    "map_great": map_great.run,
    "certificate": certificate.run,
    "cell": cell.run,
    "tolerance": tolerance.run,
    "start": start.run,
    "job": job.run,
    "plan": plan.run,
    "sequence": sequence.run,
    "panel": panel.run,
    "holes": holes.run,
}
PEERS = ("numpy", "numba", "scipy", "pymoo", "EAIK", "py-opw-kinematics", "python-flint")
ROOT = Path(__file__).parents[1]


def main() -> int:
    """Run the parts asked for, then write the page of all parts that have been run; 1 where something does not hold."""
    asked = _arguments()
    folder = asked.out / "quick" if asked.quick else asked.out
    full = Options(seeds=asked.seeds, holes=asked.holes, peer_seeds=asked.peer_seeds, cells=asked.cells)
    options = replace(Options.quick() if asked.quick else full, folder=folder, workers=asked.workers, old=asked.old)
    for name in asked.parts or PARTS:
        print(f"--- {name}", flush=True)
        section = PARTS[name](options)
        save(section, folder)
        for row in section.rows:
            print("  " + "  |  ".join(row))
        for failure in section.failures:
            print(f"  DOES NOT HOLD: {failure}")
    sections = [known for name in PARTS if (known := load(name, folder))]
    write_text(folder / "benchmarks.md" if asked.quick else asked.page, page(sections, _machine()))
    return int(any(known.failures for known in sections))


def _arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.run", description=__doc__)
    parser.add_argument("parts", nargs="*", metavar="PART", help=f"{', '.join(PARTS)}; all, if none is named")
    parser.add_argument("--quick", action="store_true", help="little of everything, to see that it runs")
    parser.add_argument("--seeds", type=int, default=Options.seeds, help="of each random peer at each position")
    parser.add_argument("--holes", type=int, default=Options.holes, help="at random places")
    parser.add_argument("--peer-seeds", type=int, default=Options.peer_seeds, help="of each random peer at each hole")
    parser.add_argument("--workers", type=int, help="processes that the holes are shared out over; one per core")
    parser.add_argument("--cells", type=int, default=Options.cells, help="of the great map; 1,000,000 is all of it")
    parser.add_argument(
        "--old", type=Path, help="a git worktree of an older commit, measured beside in `plan`, `panel`"
    )
    parser.add_argument("--out", type=Path, default=ROOT / "out" / "bench", help="folder for the JSON files")
    parser.add_argument("--page", type=Path, default=ROOT / "docs" / "benchmarks.md", help="the page that is written")
    asked = parser.parse_args()
    if unknown := set(asked.parts) - set(PARTS):
        parser.error(f"no part {', '.join(sorted(unknown))}; there are {', '.join(PARTS)}")
    return asked


def _machine() -> str:
    """Kind of machine, date and versions, in a sentence each."""
    versions = ", ".join(f"{name} {version(name)}" for name in PEERS)
    return (
        f"{_processor()}, one core of it used unless two are named; {platform.system()}; {datetime.now(UTC):%d %B %Y}."
        f" zerorev {version('zerorev')}, Python {platform.python_version()}, {versions}."
    )


def _processor() -> str:
    """The processor's family, as the operating system calls it."""
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        return platform.processor() or platform.machine()
    names = [line.partition(":")[2].strip() for line in lines if line.startswith("model name")]
    return names[0] if names else platform.machine()


if __name__ == "__main__":
    sys.exit(main())
