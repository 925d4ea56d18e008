"""The parts of the benchmark: each measures one thing and hands in a section of the page."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

__all__ = ["Options"]


@dataclass(frozen=True)
class Options:
    """How much is run.

    Attributes:
        seeds: of each random peer at each position.
        rounds: of what is timed and not random.
        holes: at random places.
        peer_seeds: of each random peer at each of those.
        workers: processes that those are shared out over; None: one per core.
        poses: in a batch.
        jobs: numbers of holes of whole jobs.
        cells: of the great map, of a million at most; those of the other maps go by it.
        panel: holes of the large job.
        old: a checkout of an older state of zerorev, measured beside this one, or None.
        folder: where what takes long is kept until it is finished, to be resumed.
    """

    seeds: int = 20
    rounds: int = 15
    holes: int = 200
    peer_seeds: int = 20
    workers: int | None = None
    poses: int = 20_000
    jobs: tuple[int, ...] = (100, 400, 1600)
    cells: int = 100_000
    panel: int = 10_000
    old: Path | None = None
    folder: Path = Path("out/bench")

    @classmethod
    def quick(cls) -> Options:
        """Enough to see that everything runs; the figures mean nothing."""
        return cls(seeds=2, rounds=3, holes=4, peer_seeds=2, poses=2_000, jobs=(60, 120), cells=400, panel=120)
