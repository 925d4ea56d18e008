"""The parts of the benchmark: each measures one thing and hands in a section of the page."""

from __future__ import annotations

from dataclasses import dataclass

__all__ = ["Options"]


@dataclass(frozen=True)
class Options:
    """How much is run.

    Attributes:
        seeds: of each random peer at each position.
        rounds: of what is timed and not random.
        holes: at random places.
        poses: in a batch.
        jobs: numbers of holes of whole jobs.
    """

    seeds: int = 20
    rounds: int = 15
    holes: int = 200
    poses: int = 20_000
    jobs: tuple[int, ...] = (100, 400, 1600)

    @classmethod
    def quick(cls) -> Options:
        """Enough to see that everything runs; the figures mean nothing."""
        return cls(seeds=2, rounds=3, holes=4, poses=2_000, jobs=(60, 120))
